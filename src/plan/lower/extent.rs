//! How much a pass does: workgroups from threads, items and texels, also where only the GPU knows.

use std::sync::Arc;

use wgpu_types::{BufferUsages, ShaderStages};

use super::bind::Stages;
use super::names::Entity;
use super::nodes::Draft;
use super::{CauseSet, Lowering, Result, ScopeId, fault, traced};
use crate::diagnostic::{Code, Span};
use crate::graph::expr::Expr;
use crate::graph::model::{self as ast, Extent, Name, Node, ShaderRef};
use crate::graph::value::Value;
use crate::plan::model::{ArgumentKind, Dispatch, ObjectKind, ObjectRef, PassKind, ShaderUse};
use crate::shader::reflect::{Entry, Module, Stage};

/// WebGPU's limit on workgroups in one direction.
const MAX_GROUPS: u64 = 65_535;

/// Items of something that a pass runs over.
pub(super) enum Items {
    Known(u64),
    /// The count of a counted buffer, at most its capacity.
    Counted(ObjectRef, u64),
}

impl Lowering<'_> {
    pub(super) fn compute(&mut self, s: ScopeId, compute: &ast::Compute, node: &Node) -> Result<Draft> {
        let module = self.shader_module(s, &compute.shader)?;
        let entry = self.entry(s, &module, &compute.shader, Stage::Compute, true)?;
        let Some(entry) = entry else { unreachable!("a required entry point is an error if it is missing") };
        let stages =
            Stages { module, entries: vec![(ShaderStages::COMPUTE, entry.clone())], at: node.word, meshes: None };
        let mut draft = Draft::new(PassKind::Compute {
            shader: ShaderUse {
                module: 0,
                compute: None,
                vertex: None,
                fragment: None,
                constants: Vec::new(),
                bindings: Vec::new(),
            },
            dispatch: Dispatch::Groups([0; 3]),
        });
        let shader = self.feed(s, &stages, &compute.bind, &mut draft);
        let size = stages.module.workgroup_size(&entry, &shader.constants).map_err(|error| {
            let message = format!("the workgroup size of `{}` cannot be worked out: {error}", entry.name);
            traced(fault(Code::SHADER, message, entry.span, "the entry point"), &self.scopes[s].trace)
        })?;
        let dispatch = self.dispatch(s, &compute.extent, &entry, size, node.word, &mut draft)?;
        draft.kind = PassKind::Compute { shader, dispatch };
        Ok(draft)
    }

    fn dispatch(
        &mut self,
        s: ScopeId,
        extent: &Extent,
        entry: &Entry,
        size: [u32; 3],
        word: Span,
        draft: &mut Draft,
    ) -> Result<Dispatch> {
        match extent {
            Extent::Texel(view) => {
                let viewed = self.view(s, view)?;
                let ObjectKind::Texture(t) = &self.object(viewed.view.object).object.kind else {
                    let message = format!("`{}` is a buffer and has no texels", view.of.value);
                    let diagnostic = fault(Code::WRONG_KIND, message, view.span, "a buffer").hint("say `Item(...)`");
                    return Err(traced(diagnostic, &self.scopes[s].trace));
                };
                let mip = viewed.view.mips.start;
                let edge = |n: u32| u64::from((n >> mip).max(1));
                let depth = if t.is_3d { edge(t.layers) } else { viewed.view.layers.len() as u64 };
                let threads = [edge(t.width), edge(t.height), depth];
                draft.causes.add(&viewed.causes);
                self.groups(s, threads, size, view.span)
            }
            Extent::Threads(exprs) => {
                let threads = self.triple(s, exprs, "threads", draft)?;
                let at = exprs.first().map_or(word, |e| e.span);
                if threads[1] == 1 && threads[2] == 1 && size[1] == 1 && size[2] == 1 {
                    return self.linear(s, Items::Known(threads[0]), u64::from(size[0]), entry, at, draft);
                }
                self.groups(s, threads, size, at)
            }
            Extent::Groups(exprs) => {
                let groups = self.triple(s, exprs, "workgroups", draft)?;
                let at = exprs.first().map_or(word, |e| e.span);
                if groups[1] == 1 && groups[2] == 1 {
                    return self.linear(s, Items::Known(groups[0]), 1, entry, at, draft);
                }
                self.groups(s, groups, [1; 3], at)
            }
            Extent::Item(name) | Extent::GroupsEach(name) => {
                let items = self.items(s, name, draft)?;
                let per_group = matches!(extent, Extent::Item(_));
                if per_group && (size[1] != 1 || size[2] != 1) {
                    let message = format!(
                        "threads over items are counted along x, and the workgroup is {} x {} x {}",
                        size[0], size[1], size[2]
                    );
                    let diagnostic = fault(Code::BAD_PASS, message, entry.span, "the entry point")
                        .see(name.span, "over these items")
                        .hint("declare `@workgroup_size(N)`");
                    return Err(traced(diagnostic, &self.scopes[s].trace));
                }
                let threads = if per_group { u64::from(size[0]) } else { 1 };
                self.linear(s, items, threads, entry, name.span, draft)
            }
        }
    }

    /// Workgroups in three directions; none of them is folded.
    fn groups(&self, s: ScopeId, threads: [u64; 3], size: [u32; 3], at: Span) -> Result<Dispatch> {
        let mut groups = [0u32; 3];
        for axis in 0..3 {
            let n = threads[axis].div_ceil(u64::from(size[axis]).max(1));
            if n > MAX_GROUPS {
                let message = format!("{n} workgroups along {} are above {MAX_GROUPS}", ["x", "y", "z"][axis]);
                let diagnostic = fault(Code::OUT_OF_RANGE, message, at, "so many")
                    .hint("make the workgroup larger, or count threads along x alone, which folds");
                return Err(traced(diagnostic, &self.scopes[s].trace));
            }
            groups[axis] = n as u32;
        }
        Ok(Dispatch::Groups(groups))
    }

    /// Workgroups along x, folded into y above the limit.
    fn linear(
        &mut self,
        s: ScopeId,
        items: Items,
        threads: u64,
        entry: &Entry,
        at: Span,
        draft: &mut Draft,
    ) -> Result<Dispatch> {
        let most = match items {
            Items::Known(n) | Items::Counted(_, n) => n.div_ceil(threads.max(1)),
        };
        if most > MAX_GROUPS && !entry.calls.iter().any(|call| call.starts_with("linear_")) {
            let message =
                format!("{most} workgroups are folded into rows, and `{}` does not use the linear index", entry.name);
            let diagnostic = fault(Code::FOLDED_DISPATCH, message, entry.span, "the entry point")
                .see(at, "so many items")
                .hint("import \"lib/dispatch.wgsl\" and take the index from `linear_index(...)`");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        if most.div_ceil(MAX_GROUPS) > MAX_GROUPS {
            let message = format!("{most} workgroups are more than can be folded into rows");
            return Err(traced(fault(Code::OUT_OF_RANGE, message, at, "so many"), &self.scopes[s].trace));
        }
        match items {
            Items::Known(_) if most <= MAX_GROUPS => Ok(Dispatch::Groups([most as u32, 1, 1])),
            Items::Known(_) => Ok(Dispatch::Groups([MAX_GROUPS as u32, most.div_ceil(MAX_GROUPS) as u32, 1])),
            Items::Counted(object, _) => {
                let threads = u32::try_from(threads).unwrap_or(u32::MAX);
                draft.counted.push((object, ArgumentKind::Dispatch { threads }));
                // The slot is given out when the engine's kernels are put in.
                Ok(Dispatch::Indirect { slot: u32::MAX })
            }
        }
    }

    /// How many items a name stands for.
    pub(super) fn items(&mut self, s: ScopeId, name: &Name, draft: &mut Draft) -> Result<Items> {
        let entity = self.resolve(s, &name.value, name.span)?;
        if let Entity::Var(var) = entity {
            let object = self.vars[var].now;
            let building = self.object(object);
            draft.causes.add(&building.causes);
            if let ObjectKind::Buffer(buffer) = &building.object.kind {
                return Ok(if buffer.counted {
                    Items::Counted(object, buffer.items)
                } else {
                    Items::Known(buffer.items)
                });
            }
        } else if let Entity::Input { .. } = entity
            && let Ok(Entity::Scalar(scalar)) = self.resolve(s, &format!("{}.count", name.value), name.span)
            && let crate::plan::model::UniformValue::Known(Value::Int(count)) = scalar.value
        {
            draft.causes.add(&scalar.causes);
            return Ok(Items::Known(count.max(0) as u64));
        }
        let message = format!("`{}` is {} and has no items", name.value, self.what(&entity));
        let diagnostic = fault(Code::WRONG_KIND, message, name.span, "no items").hint("for a texture say `Texel(...)`");
        Err(traced(diagnostic, &self.scopes[s].trace))
    }

    /// One to three counts, from one to three expressions or a vector.
    fn triple(&mut self, s: ScopeId, exprs: &[Expr], what: &str, draft: &mut Draft) -> Result<[u64; 3]> {
        let mut counts = Vec::new();
        for expr in exprs {
            let (value, causes) = self.known(s, expr)?;
            draft.causes.add(&causes);
            for component in value.components() {
                match component {
                    Value::Int(n) if n >= 0 => counts.push(n as u64),
                    Value::Int(n) => {
                        let message = format!("the number of {what} must be at least 0, and is {n}");
                        let diagnostic = fault(Code::OUT_OF_RANGE, message, expr.span, format!("this is {value}"));
                        return Err(traced(diagnostic, &self.scopes[s].trace));
                    }
                    Value::Float(x) => {
                        let message = format!("the number of {what} must be whole, and may be fractional");
                        let diagnostic = fault(Code::FRACTIONAL, message, expr.span, format!("this is {x}"))
                            .hint("say `floor(...)`, `ceil(...)` or `ceil_div(a, b)`");
                        return Err(traced(diagnostic, &self.scopes[s].trace));
                    }
                    other => return Err(self.mistyped(s, expr, "a number", &other)),
                }
            }
        }
        match counts.as_slice() {
            [x] => Ok([*x, 1, 1]),
            [x, y] => Ok([*x, *y, 1]),
            [x, y, z] => Ok([*x, *y, *z]),
            _ => {
                let at = exprs.first().map_or(self.scopes[s].graph.span, |e| e.span);
                let message = format!("{what} are 1 to 3 numbers, not {}", counts.len());
                Err(traced(fault(Code::WRONG_VALUE, message, at, "here"), &self.scopes[s].trace))
            }
        }
    }

    pub(super) fn shader_module(&self, s: ScopeId, shader: &ShaderRef) -> Result<Arc<Module>> {
        let graph = &self.scopes[s].graph;
        match self.program.shader(graph, &shader.path.value) {
            Some(module) => Ok(module.clone()),
            None => {
                let message = format!("the shader `{}` was not read", shader.path.value);
                Err(Box::new(fault(Code::FILE_MISSING, message, shader.path.span, "named here")))
            }
        }
    }

    /// The entry point of a stage: the named one, else the only one.
    pub(super) fn entry(
        &self,
        s: ScopeId,
        module: &Module,
        shader: &ShaderRef,
        stage: Stage,
        required: bool,
    ) -> Result<Option<Arc<Entry>>> {
        let what = stage_name(stage);
        let all: Vec<&Arc<Entry>> = module.stage(stage).collect();
        let named = |e: &&&Arc<Entry>| shader.entries.iter().any(|n| n.value == e.name);
        for name in &shader.entries {
            if !module.entries.iter().any(|e| e.name == name.value) {
                let names: Vec<String> = module.entries.iter().map(|e| e.name.clone()).collect();
                let message = format!("`{}` has no entry point `{}`", shader.path.value, name.value);
                let diagnostic = fault(Code::ENTRY_POINT, message, name.span, "no such entry point")
                    .nearest(&name.value, names.iter().map(String::as_str))
                    .hint(format!("it has {}", super::names::list(&names)));
                return Err(traced(diagnostic, &self.scopes[s].trace));
            }
        }
        let chosen: Vec<&&Arc<Entry>> =
            if shader.entries.is_empty() { all.iter().collect() } else { all.iter().filter(named).collect() };
        match chosen.as_slice() {
            [one] => Ok(Some(Arc::clone(one))),
            [] if !required => Ok(None),
            [] => {
                let message = format!("`{}` has no {what} entry point", shader.path.value);
                let mut diagnostic = fault(Code::ENTRY_POINT, message, shader.path.span, format!("needs `@{what}`"));
                for entry in &module.entries {
                    diagnostic = diagnostic.see(entry.span, format!("a {} entry point", stage_name(entry.stage)));
                }
                Err(traced(diagnostic, &self.scopes[s].trace))
            }
            several => {
                let message = format!("`{}` has {} {what} entry points", shader.path.value, several.len());
                let mut diagnostic = fault(Code::ENTRY_POINT, message, shader.path.span, "which one?");
                for entry in several {
                    diagnostic = diagnostic.see(entry.span, format!("`{}`", entry.name));
                }
                let name = &several[0].name;
                let diagnostic = diagnostic.hint(format!("say `\"{}#{name}\"`", shader.path.value));
                Err(traced(diagnostic, &self.scopes[s].trace))
            }
        }
    }

    pub(super) fn buffer_usage(&mut self, object: ObjectRef, usage: BufferUsages) {
        for id in self.object_ids(object) {
            if let ObjectKind::Buffer(buffer) = &mut self.objects[id].object.kind {
                buffer.usages |= usage;
            }
        }
    }

    /// A count of vertices, instances or indices: known, or that of a counted buffer.
    pub(super) fn count(&mut self, s: ScopeId, count: &ast::Count, what: &str, draft: &mut Draft) -> Result<Items> {
        match count {
            ast::Count::Each(name) => self.items(s, name, draft),
            ast::Count::Expr(expr) => {
                let (n, causes): (i64, CauseSet) = self.whole(s, expr, what, 0)?;
                draft.causes.add(&causes);
                Ok(Items::Known(n as u64))
            }
        }
    }
}

fn stage_name(stage: Stage) -> &'static str {
    match stage {
        Stage::Vertex => "vertex",
        Stage::Fragment => "fragment",
        Stage::Compute => "compute",
    }
}
