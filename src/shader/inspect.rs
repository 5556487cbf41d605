//! Reflection: from a validated naga module to [`Module`].

use std::borrow::Cow;
use std::cell::Cell;
use std::sync::Arc;

use naga::valid::{FunctionInfo, ModuleInfo};
use naga::{ArraySize, Binding, BuiltIn, ShaderStage, TypeInner};
use twox_hash::XxHash3_128;

use super::assemble::Assembled;
use super::declare;
use super::map::SourceMap;
use super::parse::Parsed;
use super::reflect::{Entry, Global, Io, Module, Override, Stage, Use};
use super::types::{self, Types};
use super::walk::{self, Doings};
use crate::diagnostic::Span;

/// Members of structs that are spelt out in one module, all told.
const MEMBERS: u32 = 100_000;

pub(super) fn inspect(assembled: Assembled, parsed: Parsed) -> Module {
    let Assembled { whole, map, declarations, .. } = assembled;
    let inspector = Inspector {
        types: Types { module: &parsed.module, map: &map, declarations: &declarations, budget: Cell::new(MEMBERS) },
        parsed: &parsed,
        functions: walk::functions(&parsed.module, &parsed.info),
    };
    let (globals, entries, overrides) = (inspector.globals(), inspector.entries(), inspector.overrides());
    let named = map.named();
    Module {
        path: named.path.clone(),
        file: named.file,
        files: map.paths().collect(),
        hash: XxHash3_128::oneshot(whole.as_bytes()),
        globals,
        entries,
        overrides,
        naga: Arc::new(parsed.module),
        info: Arc::new(parsed.info),
        map: Arc::new(map),
    }
}

struct Inspector<'a> {
    types: Types<'a>,
    parsed: &'a Parsed,
    functions: Vec<Doings>,
}

impl Inspector<'_> {
    fn map(&self) -> &SourceMap {
        self.types.map
    }

    fn globals(&self) -> Vec<Global> {
        let variables = self.parsed.globals.iter().map(|handle| &self.parsed.module.global_variables[*handle]);
        variables
            .enumerate()
            .map(|(binding, variable)| {
                let name = variable.name.clone().unwrap_or_default();
                let span = self.value(&name);
                Global { name: name.into(), span, binding: binding as u32, kind: self.types.global(variable) }
            })
            .collect()
    }

    fn value(&self, name: &str) -> Span {
        self.types.declarations.values.get(name).copied().unwrap_or_else(|| self.map().start())
    }

    fn overrides(&self) -> Vec<Override> {
        let module = &self.parsed.module;
        // Without a name it is an expression in an array's size, which nobody can set.
        let named = module.overrides.iter().filter_map(|(_, o)| Some((o, o.name.clone()?)));
        named
            .map(|(o, name)| Override {
                span: self.value(&name),
                scalar: match module.types[o.ty].inner {
                    TypeInner::Scalar(naga::Scalar::BOOL) => None,
                    TypeInner::Scalar(scalar) => Some(types::scalar(scalar)),
                    _ => None,
                },
                has_default: o.init.is_some(),
                key: o.id.map_or_else(|| name.clone(), |id| id.to_string()),
                name,
            })
            .collect()
    }

    fn entries(&self) -> Vec<Arc<Entry>> {
        let file = self.map().named().file;
        let points = self.parsed.module.entry_points.iter().enumerate();
        points
            .filter_map(|(index, point)| {
                let declared = self.types.declarations.functions.get(&point.name)?;
                let stage = match point.stage {
                    ShaderStage::Vertex => Stage::Vertex,
                    ShaderStage::Fragment => Stage::Fragment,
                    ShaderStage::Compute => Stage::Compute,
                    _ => return None,
                };
                (declared.name.file == file).then(|| Arc::new(self.entry(index, point, stage, declared)))
            })
            .collect()
    }

    fn entry(&self, index: usize, point: &naga::EntryPoint, stage: Stage, declared: &declare::Function) -> Entry {
        let info = self.parsed.info.get_entry_point(index);
        let doings = walk::doings(&self.parsed.module, &point.function, info, &self.functions);
        let mut io = Interface::default();
        for (argument, field) in point.function.arguments.iter().zip(&declared.arguments) {
            let name = argument.name.as_deref().unwrap_or_default();
            self.io(&mut io.inputs, argument.ty, argument.binding.as_ref(), name, field.span);
        }
        if let Some(result) = &point.function.result {
            let span = declared.result.unwrap_or(declared.name);
            io.frag_depth = self.io(&mut io.outputs, result.ty, result.binding.as_ref(), "", span);
        }
        Entry {
            name: point.name.clone(),
            span: declared.name,
            stage,
            workgroup_size: point.workgroup_size,
            uses: self.uses(&doings, info),
            sampled: self.sampled(info),
            inputs: io.inputs,
            outputs: io.outputs,
            writes_frag_depth: io.frag_depth,
            discards: doings.discards,
            calls: doings.calls.into_iter().collect(),
            features: self.parsed.features,
            workgroup_memory: workgroup_memory(&self.parsed.module, info),
        }
    }

    fn uses(&self, doings: &Doings, info: &FunctionInfo) -> Vec<Use> {
        let handles = self.parsed.globals.iter().enumerate();
        handles
            .filter(|(_, handle)| !info[**handle].is_empty() || doings.of(handle.index()).is_some())
            .map(|(global, handle)| {
                let access = doings.of(handle.index()).unwrap_or_default();
                Use {
                    global,
                    read: access.read,
                    write: access.write,
                    atomic: access.atomic,
                    atomic_result: access.shows_order(),
                }
            })
            .collect()
    }

    fn sampled(&self, info: &FunctionInfo) -> Vec<(usize, usize)> {
        let index = |handle| self.parsed.globals.iter().position(|g| *g == handle);
        let pairs = info.sampling_set.iter();
        let mut pairs: Vec<_> = pairs.filter_map(|key| Some((index(key.image)?, index(key.sampler)?))).collect();
        pairs.sort_unstable();
        pairs
    }

    /// Collects the user-defined parts of an argument or result; whether the fragment's depth
    /// is among the rest.
    fn io(
        &self,
        into: &mut Vec<Io>,
        ty: naga::Handle<naga::Type>,
        binding: Option<&Binding>,
        name: &str,
        span: Span,
    ) -> bool {
        match (binding, &self.parsed.module.types[ty].inner) {
            (Some(Binding::BuiltIn(built_in)), _) => *built_in == BuiltIn::FragDepth,
            (Some(Binding::Location { location, .. }), _) => {
                if let Some(ty) = self.types.host(ty) {
                    into.push(Io { location: *location, name: name.to_owned(), ty, span });
                }
                false
            }
            (None, TypeInner::Struct { members, .. }) => {
                let of = self.parsed.module.types[ty].name.as_deref().unwrap_or_default();
                members.iter().fold(false, |depth, member| {
                    let name = member.name.as_deref().unwrap_or_default();
                    let span = self.types.declarations.member(of, name).unwrap_or(span);
                    self.io(into, member.ty, member.binding.as_ref(), name, span) || depth
                })
            }
            (None, _) => false,
        }
    }
}

#[derive(Default)]
struct Interface {
    inputs: Vec<Io>,
    outputs: Vec<Io>,
    frag_depth: bool,
}

/// As WebGPU counts it: each variable's size, rounded up to 16 bytes.
fn workgroup_memory(module: &naga::Module, info: &FunctionInfo) -> u32 {
    let mut layouter = naga::proc::Layouter::default();
    let variables = module.global_variables.iter();
    let mut used = variables
        .filter(|(handle, v)| v.space == naga::AddressSpace::WorkGroup && !info[*handle].is_empty())
        .peekable();
    if used.peek().is_none() || layouter.update(module.to_ctx()).is_err() {
        return 0;
    }
    let sizes = used.map(|(_, variable)| layouter[variable.ty].size.next_multiple_of(16));
    sizes.fold(0, u32::saturating_add)
}

/// What overrides decide. `constants` are by [`Override::key`]; those that are not given take
/// their defaults.
impl Module {
    /// The workgroup size of a compute entry point.
    ///
    /// # Errors
    /// If a constant is unknown, does not fit its type, is missing without a default, or makes a
    /// size that is not positive.
    pub fn workgroup_size(&self, entry: &Entry, constants: &[(String, f64)]) -> Result<[u32; 3], String> {
        let mut points = self.naga.entry_points.iter();
        let is_decided = |point: &naga::EntryPoint| {
            point.name == entry.name && point.stage == ShaderStage::Compute && point.workgroup_size_overrides.is_some()
        };
        if !points.any(is_decided) {
            return Ok(entry.workgroup_size);
        }
        let (module, _) = self.resolved(entry, constants)?;
        // Only the entry point that is asked for is left.
        Ok(module.entry_points.first().map_or(entry.workgroup_size, |point| point.workgroup_size))
    }

    /// Bytes of `var<workgroup>` memory, as [`Entry::workgroup_memory`], of a compute entry point.
    ///
    /// # Errors
    /// As [`Module::workgroup_size`].
    pub fn workgroup_memory(&self, entry: &Entry, constants: &[(String, f64)]) -> Result<u32, String> {
        let is_decided = |ty: &naga::Type| matches!(ty.inner, TypeInner::Array { size: ArraySize::Pending(_), .. });
        if entry.workgroup_memory == 0 || !self.naga.types.iter().any(|(_, ty)| is_decided(ty)) {
            return Ok(entry.workgroup_memory);
        }
        let (module, info) = self.resolved(entry, constants)?;
        Ok(workgroup_memory(&module, info.get_entry_point(0)))
    }

    /// The module with nothing but a compute entry point and without overrides.
    fn resolved(&self, entry: &Entry, constants: &[(String, f64)]) -> Result<Resolved<'_>, String> {
        let constants = constants.iter().cloned().collect();
        let selected = Some((ShaderStage::Compute, entry.name.as_str()));
        naga::back::pipeline_constants::process_overrides(&self.naga, &self.info, selected, &constants)
            .map_err(|error| super::message::sentence(&error))
    }
}

type Resolved<'a> = (Cow<'a, naga::Module>, Cow<'a, ModuleInfo>);
