//! Feeding shaders: every variable of a WGSL module gets the thing of its name.

use std::sync::Arc;

use wgpu_types::ShaderStages;

use super::meshes::MeshInput;
use super::names::Entity;
use super::nodes::Draft;
use super::view::Viewed;
use super::{Lowering, Packed, Place, Result, ScopeId, fault, traced};
use crate::diagnostic::{Code, Span};
use crate::graph::expr::ExprKind;
use crate::graph::model::{self as ast, Address, Compare, Name, Sampler, Sp};
use crate::plan::model::{Access, Binding, Bound, ObjectKind, ObjectRef, ShaderUse, View};
use crate::shader::reflect::{Entry, Global, GlobalKind, Module, TextureDimension, Use};

/// A pass's shader: the module and the entry points that it runs.
#[derive(Clone)]
pub(super) struct Stages {
    pub module: Arc<Module>,
    pub entries: Vec<(ShaderStages, Arc<Entry>)>,
    /// The pass, for labels.
    pub at: Span,
    /// The mesh input whose materials it is drawn with.
    pub meshes: Option<MeshInput>,
}

/// One variable of a shader as a pass uses it.
pub(super) struct Wanted<'a> {
    pub global: &'a Global,
    pub stages: ShaderStages,
    pub used: Use,
    pub filtered: bool,
}

impl Lowering<'_> {
    /// Binds everything that the entry points use; adds accesses and causes to the draft.
    pub(super) fn feed(
        &mut self,
        s: ScopeId,
        stages: &Stages,
        bind: &[(Name, ast::Bound)],
        draft: &mut Draft,
    ) -> ShaderUse {
        let module = self.module(&stages.module);
        let wanted = self.wanted(s, stages, bind);
        let mut bindings = Vec::with_capacity(wanted.len());
        for wanted in wanted {
            let bound = self.feed_again(s, stages, bind, &wanted, draft);
            if let Some(bound) = self.report(bound) {
                bindings.push(Binding {
                    binding: wanted.global.binding,
                    name: wanted.global.name.clone(),
                    stages: wanted.stages,
                    bound,
                });
            }
        }
        let constants = self.constants(s, stages, bind, draft);
        self.check_bind_names(s, stages, bind);
        for (_, entry) in &stages.entries {
            self.need(s, entry.features, entry.span, "this shader needs it");
            draft.unordered |= entry.uses.iter().any(|u| u.atomic_result);
        }
        let entry = |stage| stages.entries.iter().find(|(s, _)| *s == stage).map(|(_, e)| e.name.clone());
        ShaderUse {
            module,
            compute: entry(ShaderStages::COMPUTE),
            vertex: entry(ShaderStages::VERTEX),
            fragment: entry(ShaderStages::FRAGMENT),
            constants,
            bindings,
        }
    }

    fn module(&mut self, module: &Arc<Module>) -> usize {
        match self.modules.iter().position(|m| m.hash == module.hash) {
            Some(index) => index,
            None => {
                self.modules.push(module.clone());
                self.modules.len() - 1
            }
        }
    }

    /// The variables that any of the entry points use, in the order of declaration.
    fn wanted<'a>(&mut self, s: ScopeId, stages: &'a Stages, bind: &[(Name, ast::Bound)]) -> Vec<Wanted<'a>> {
        let mut all: Vec<Wanted<'a>> = Vec::new();
        for (i, global) in stages.module.globals.iter().enumerate() {
            let mut seen = ShaderStages::empty();
            let mut used = Use { global: i, read: false, write: false, atomic: false, atomic_result: false };
            let mut filtered = false;
            for (stage, entry) in &stages.entries {
                for u in entry.uses.iter().filter(|u| u.global == i) {
                    seen |= *stage;
                    used.read |= u.read;
                    used.write |= u.write;
                    used.atomic |= u.atomic;
                    used.atomic_result |= u.atomic_result;
                }
                for (_, sampler) in entry.sampled.iter().filter(|(texture, _)| *texture == i) {
                    filtered |= self.filters(s, &stages.module.globals[*sampler], bind);
                }
            }
            if !seen.is_empty() {
                all.push(Wanted { global, stages: seen, used, filtered });
            }
        }
        all
    }

    fn filters(&mut self, s: ScopeId, sampler: &Global, bind: &[(Name, ast::Bound)]) -> bool {
        match self.bound_entity(s, sampler, bind) {
            Ok(Some((Entity::StandardSampler(name), _))) => standard_sampler(name).linear,
            Ok(Some((Entity::Sampler { scope, index }, _))) => self.scopes[scope].graph.samplers[index].linear,
            _ => true,
        }
    }

    /// What `bind`, else the variable's own name, says; with the place that said it.
    fn bound_entity(
        &mut self,
        s: ScopeId,
        global: &Global,
        bind: &[(Name, ast::Bound)],
    ) -> Result<Option<(Entity, Option<ast::View>)>> {
        match bind.iter().find(|(name, _)| *name.value == *global.name) {
            Some((_, ast::Bound::View(view))) => {
                Ok(Some((self.resolve(s, &view.of.value, view.of.span)?, Some(view.clone()))))
            }
            Some((_, ast::Bound::Expr(expr))) => match &expr.kind {
                ExprKind::Name(path) => Ok(Some((self.resolve(s, path, expr.span)?, None))),
                _ => Ok(Some((Entity::Scalar(self.scalar(s, expr)?), None))),
            },
            None => Ok(self.resolve_wgsl(s, &global.name, global.span)?.map(|(_, entity)| (entity, None))),
        }
    }

    /// As [`Self::feed_one`], but blocks of scalars are put together once for all iterations of a
    /// loop, if no counter is among what they are made from.
    fn feed_again(
        &mut self,
        s: ScopeId,
        stages: &Stages,
        bind: &[(Name, ast::Bound)],
        wanted: &Wanted<'_>,
        draft: &mut Draft,
    ) -> Result<Bound> {
        let key = (stages.at, wanted.used.global);
        if let Some(packed) = self.scopes[s].packed.get(&key).filter(|packed| packed.given_anew == self.given_anew) {
            draft.causes.add(&packed.causes);
            return Ok(Bound::Uniform { block: packed.block });
        }
        let saw_counter = std::mem::take(&mut self.saw_counter);
        let before = std::mem::take(&mut draft.causes);
        let bound = self.feed_one(s, stages, bind, wanted, draft);
        let causes = std::mem::replace(&mut draft.causes, before);
        draft.causes.add(&causes);
        if let (Ok(Bound::Uniform { block }), false) = (&bound, self.saw_counter) {
            let packed = Packed { block: *block, causes, given_anew: self.given_anew };
            self.scopes[s].packed.insert(key, packed);
        }
        self.saw_counter |= saw_counter;
        bound
    }

    fn feed_one(
        &mut self,
        s: ScopeId,
        stages: &Stages,
        bind: &[(Name, ast::Bound)],
        wanted: &Wanted<'_>,
        draft: &mut Draft,
    ) -> Result<Bound> {
        let global = wanted.global;
        if let Some(meshes) = stages.meshes.as_ref().filter(|_| place_of(bind, &global.name).is_none()) {
            let place = Feed { stages, bind, wanted, at: stages.at };
            if let Some(bound) = self.feed_material(s, meshes, &place, draft)? {
                return Ok(bound);
            }
        }
        let found = self.bound_entity(s, global, bind)?;
        let place = Feed { stages, bind, wanted, at: place_of(bind, &global.name).unwrap_or(stages.at) };
        match &global.kind {
            GlobalKind::Uniform(ty) => self.feed_uniform(s, &place, ty, found.map(|(e, _)| e), draft),
            GlobalKind::Sampler { comparison } => self.feed_sampler(s, &place, *comparison, found.map(|(e, _)| e)),
            GlobalKind::Other(what) => {
                let message = format!("a graph cannot feed {what}");
                let diagnostic = fault(Code::BINDING_MISMATCH, message, global.span, "this variable");
                Err(traced(diagnostic.see(stages.at, "run by this pass"), &self.scopes[s].trace))
            }
            GlobalKind::Storage { .. } | GlobalKind::Texture { .. } | GlobalKind::StorageTexture { .. } => {
                let Some((entity, view)) = found else { return Err(self.unbound(s, &place)) };
                if matches!(entity, Entity::Absent) {
                    return Err(self.absent_fed_to(s, &place));
                }
                let Entity::Var(var) = entity else { return Err(self.mismatch(s, &place, &entity)) };
                let viewed = match view {
                    Some(view) => self.view(s, &view)?,
                    None => self.whole_object(self.vars[var].now),
                };
                draft.causes.add(&viewed.causes);
                match &global.kind {
                    GlobalKind::Storage { writable, ty } => self.feed_storage(s, &place, *writable, ty, &viewed, draft),
                    GlobalKind::Texture { .. } => self.feed_texture(s, &place, viewed, draft),
                    _ => self.feed_storage_texture(s, &place, viewed, draft),
                }
            }
        }
    }

    /// A whole object as a view.
    fn whole_object(&self, object: ObjectRef) -> Viewed {
        let building = self.object(object);
        let (mips, layers, dimension) = match &building.object.kind {
            ObjectKind::Texture(t) => {
                (t.mips, if t.is_3d { 1 } else { t.layers }, super::view::natural_dimension(t.is_3d, t.layers))
            }
            ObjectKind::Buffer(_) => (1, 1, TextureDimension::D2),
        };
        let view = View { object, mips: 0..mips, layers: 0..layers, dimension };
        Viewed { view, mip_said: false, layer_said: false, causes: building.causes.clone() }
    }

    pub(super) fn access(&self, place: &Feed<'_>, view: &View, used: Use, samples_mips: bool) -> (Access, Place) {
        let counted = matches!(&self.object(view.object).object.kind, ObjectKind::Buffer(b) if b.counted);
        let access = Access {
            object: view.object,
            mips: view.mips.clone(),
            layers: view.layers.clone(),
            read: used.read,
            write: used.write,
            whole: used.write && !used.read,
        };
        let place = Place {
            graph: place.at,
            shader: Some(place.wanted.global.span),
            name: place.wanted.global.name.clone(),
            samples_mips,
            appends: counted && used.write,
        };
        (access, place)
    }

    fn feed_sampler(&mut self, s: ScopeId, place: &Feed<'_>, comparison: bool, found: Option<Entity>) -> Result<Bound> {
        let sampler = match found {
            Some(Entity::StandardSampler(name)) => standard_sampler(name),
            Some(Entity::Sampler { scope, index }) => self.scopes[scope].graph.samplers[index].clone(),
            Some(other) => return Err(self.mismatch(s, place, &other)),
            None => return Err(self.unbound(s, place)),
        };
        if sampler.compare.is_some() != comparison {
            let (is, wants) =
                if comparison { ("does not compare", "compares") } else { ("compares", "does not compare") };
            let message = format!("`{}` {is}, and the shader wants one that {wants}", sampler.name.value);
            let diagnostic = fault(Code::BINDING_MISMATCH, message, place.wanted.global.span, "the shader's sampler")
                .see(place.at, "fed by this pass")
                .hint(if comparison {
                    "`depth_compare` compares; so does a sampler that is declared with `compare:`"
                } else {
                    "declare it as `sampler_comparison`, or bind a sampler without `compare:`"
                });
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        let same = |other: &Sampler| {
            (other.linear, other.mip_linear, other.address, other.compare, other.anisotropy)
                == (sampler.linear, sampler.mip_linear, sampler.address, sampler.compare, sampler.anisotropy)
        };
        let index = self.samplers.iter().position(same).unwrap_or_else(|| {
            self.samplers.push(sampler.clone());
            self.samplers.len() - 1
        });
        Ok(Bound::Sampler { sampler: index })
    }
}

/// Everything about one variable while it is fed.
pub(super) struct Feed<'a> {
    pub stages: &'a Stages,
    pub bind: &'a [(Name, ast::Bound)],
    pub wanted: &'a Wanted<'a>,
    /// The `bind` entry, else the pass.
    pub at: Span,
}

impl Feed<'_> {
    pub fn global(&self) -> &Global {
        self.wanted.global
    }
}

pub(super) fn place_of(bind: &[(Name, ast::Bound)], name: &str) -> Option<Span> {
    bind.iter().find(|(n, _)| n.value == name).map(|(n, _)| n.span)
}

/// The samplers with reserved names. Depth is reversed: `depth_compare` passes what is as near or
/// nearer.
fn standard_sampler(name: &str) -> Sampler {
    let span = Span { file: crate::diagnostic::FileId(0), start: 0, end: 0 };
    let linear = name.starts_with("linear") || name == "depth_compare";
    Sampler {
        name: Sp { value: name.to_owned(), span },
        linear,
        mip_linear: linear && name != "depth_compare",
        address: match name.rsplit('_').next() {
            Some("repeat") => Address::Repeat,
            Some("mirror") => Address::Mirror,
            _ => Address::Clamp,
        },
        compare: (name == "depth_compare").then_some(Compare::GreaterEqual),
        anisotropy: 1,
    }
}
