//! Feeding shaders: every variable of a WGSL module gets the thing of its name.

use std::sync::Arc;

use wgpu_types::{BufferUsages, Features, ShaderStages, TextureUsages};

use super::names::Entity;
use super::nodes::{Draft, Viewed};
use super::{Layout, Lowering, Place, Result, ScopeId, fault, traced};
use crate::diagnostic::{Code, Diagnostic, Label, Span};
use crate::format::{self, SampleKind, TextureFormat};
use crate::graph::expr::ExprKind;
use crate::graph::model::{self as ast, Address, Compare, Name, Sampler, Sp};
use crate::plan::model::{Access, Binding, Bound, ObjectKind, ObjectRef, Origin, ShaderUse, View};
use crate::shader::reflect::{Entry, Global, GlobalKind, Module, Scalar, TextureDimension, Type, Use};

/// A pass's shader: the module and the entry points that it runs.
#[derive(Clone)]
pub(super) struct Stages {
    pub module: Arc<Module>,
    pub entries: Vec<(ShaderStages, Entry)>,
    /// The pass, for labels.
    pub at: Span,
}

/// One variable of a shader as a pass uses it.
struct Wanted<'a> {
    global: &'a Global,
    stages: ShaderStages,
    used: Use,
    filtered: bool,
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
        let mut bindings = Vec::new();
        for wanted in self.wanted(s, stages, bind) {
            let bound = self.feed_one(s, stages, bind, &wanted, draft);
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
            self.features |= entry.features;
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
        match bind.iter().find(|(name, _)| name.value == global.name) {
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

    fn feed_one(
        &mut self,
        s: ScopeId,
        stages: &Stages,
        bind: &[(Name, ast::Bound)],
        wanted: &Wanted<'_>,
        draft: &mut Draft,
    ) -> Result<Bound> {
        let global = wanted.global;
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

    /// An optional input that a shader takes as if it were always there.
    pub(super) fn absent_fed_to(&self, s: ScopeId, place: &Feed<'_>) -> Box<Diagnostic> {
        let bound = place.bind.iter().find(|(name, _)| name.value == place.global().name);
        let (name, span) = match bound {
            Some((_, ast::Bound::View(view))) => (view.of.value.as_str(), view.of.span),
            Some((_, ast::Bound::Expr(expr))) => match &expr.kind {
                ExprKind::Name(path) => (path.as_str(), expr.span),
                _ => (place.global().name.as_str(), place.at),
            },
            None => (place.global().name.as_str(), place.at),
        };
        let mut diagnostic = self.absent_here(s, name, span);
        diagnostic
            .labels
            .insert(1, Label { span: place.global().span, text: "the shader's variable".into(), primary: false });
        diagnostic
    }

    /// A whole object as a view.
    fn whole_object(&self, object: ObjectRef) -> Viewed {
        let building = self.object(object);
        let (mips, layers, dimension) = match &building.object.kind {
            ObjectKind::Texture(t) => {
                (t.mips, if t.is_3d { 1 } else { t.layers }, super::nodes::natural_dimension(t.is_3d, t.layers))
            }
            ObjectKind::Buffer(_) => (1, 1, TextureDimension::D2),
        };
        let view = View { object, mips: 0..mips, layers: 0..layers, dimension };
        Viewed { view, mip_said: false, layer_said: false, causes: building.causes.clone() }
    }

    fn feed_storage(
        &mut self,
        s: ScopeId,
        place: &Feed<'_>,
        writable: bool,
        ty: &Type,
        viewed: &Viewed,
        draft: &mut Draft,
    ) -> Result<Bound> {
        let object = viewed.view.object;
        if !matches!(self.object(object).object.kind, ObjectKind::Buffer(_)) {
            return Err(self.mismatch_object(s, place, object));
        }
        self.agree(s, place, object, ty)?;
        let used = place.wanted.used;
        if used.write
            && !matches!(self.object(object).object.origin, Origin::Frame | Origin::State(_))
            && !self.stand_in
        {
            return Err(self.writes_input(s, place, object));
        }
        for id in self.object_ids(object) {
            if let ObjectKind::Buffer(buffer) = &mut self.objects[id].object.kind {
                buffer.usages |= BufferUsages::STORAGE;
            }
        }
        draft.accesses.push(self.access(place, &viewed.view, used, false));
        Ok(Bound::Storage { buffer: object, writable })
    }

    fn writes_input(&self, s: ScopeId, place: &Feed<'_>, object: ObjectRef) -> Box<Diagnostic> {
        let name = &self.object(object).object.path;
        let message = format!("the shader writes `{name}`, which is an input of the graph");
        let diagnostic = fault(Code::BINDING_MISMATCH, message, place.at, "written by this pass")
            .see(place.wanted.global.span, "the shader's variable")
            .see(self.object(object).object.span, "declared here")
            .hint("copy it to a resource first");
        traced(diagnostic, &self.scopes[s].trace)
    }

    fn access(&self, place: &Feed<'_>, view: &View, used: Use, samples_mips: bool) -> (Access, Place) {
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

    /// All shaders that bind a buffer must agree on what it holds.
    pub(super) fn agree(&mut self, s: ScopeId, place: &Feed<'_>, object: ObjectRef, ty: &Type) -> Result<()> {
        let global = place.wanted.global;
        let building = self.object(object);
        let ObjectKind::Buffer(buffer) = &building.object.kind else { return Ok(()) };
        let found = if buffer.counted { counted_layout(ty, global.span) } else { plain_layout(ty, global.span) };
        let Some(mut layout) = found else {
            let message =
                format!("`{}` is a counted buffer, and the shader sees `{}`", building.object.path, ty.wgsl());
            let diagnostic = fault(Code::COUNTED, message, global.span, "the shader's variable")
                .see(place.at, "fed by this pass")
                .see(building.object.span, "declared here")
                .hint("a writer declares `struct { count: atomic<u32>, items: array<T> }`, a reader `count: u32`");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        };
        if let Origin::Attribute { attribute, input, .. } = &building.object.origin {
            let components = self.attribute_components(input, attribute);
            layout = self.attribute_layout(s, place, layout, components)?;
        }
        if let Some(first) = &building.layout
            && !(first.header == layout.header && first.stride == layout.stride && same_type(&first.item, &layout.item))
        {
            let name = &building.object.path;
            let message = format!("two shaders disagree about what `{name}` holds");
            let diagnostic = fault(
                Code::LAYOUT_DISAGREEMENT,
                message,
                global.span,
                format!("`{}`, {} bytes each", layout.item.wgsl(), layout.stride),
            )
            .see(first.span, format!("`{}`, {} bytes each", first.item.wgsl(), first.stride))
            .see(building.object.span, "declared here")
            .hint(difference(&first.item, &layout.item));
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        let items = fixed_items(ty);
        if let Some(needed) = items
            && buffer.items < u64::from(needed)
            && matches!(building.object.origin, Origin::Frame | Origin::State(_))
        {
            let message =
                format!("the shader needs {needed} items of `{}`, which has {}", building.object.path, buffer.items);
            let diagnostic = fault(Code::BINDING_MISMATCH, message, global.span, "so many items")
                .see(building.object.span, "declared here");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        for id in self.object_ids(object) {
            let building = &mut self.objects[id];
            let ObjectKind::Buffer(buffer) = &mut building.object.kind else { continue };
            if building.layout.is_none() {
                buffer.header = layout.header;
                buffer.stride = layout.stride;
                buffer.item = Some(layout.item.clone());
                building.layout = Some(layout.clone());
            }
        }
        Ok(())
    }

    fn attribute_components(&self, input: &str, attribute: &str) -> Option<u32> {
        match self.request.inputs.get(input) {
            Some(crate::plan::model::InputInfo::Particles { attributes, .. }) => {
                attributes.iter().find(|(name, _)| name == attribute).map(|(_, n)| *n).filter(|n| *n > 0)
            }
            _ => None,
        }
    }

    /// Attributes are tightly packed: three numbers take 12 bytes, which `array<vec3<f32>>` does not have.
    fn attribute_layout(
        &self,
        s: ScopeId,
        place: &Feed<'_>,
        layout: Layout,
        components: Option<u32>,
    ) -> Result<Layout> {
        let global = place.wanted.global;
        if let Type::Vector { components: 3, .. } = layout.item {
            let message =
                format!("`{}` is tightly packed, 12 bytes each, and `array<vec3<...>>` takes 16", global.name);
            let diagnostic = fault(Code::BINDING_MISMATCH, message, global.span, "16 bytes each")
                .see(place.at, "fed by this pass")
                .hint("import \"lib/packed.wgsl\" and declare `array<Packed3>`");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        let Some(components) = components else { return Ok(layout) };
        let lanes = lanes(&layout.item);
        if lanes == Some(components) || lanes == Some(1) {
            return Ok(layout);
        }
        let message = format!(
            "`{}` has {components} numbers for each particle, and the shader sees `{}`",
            global.name,
            layout.item.wgsl()
        );
        let diagnostic = fault(Code::BINDING_MISMATCH, message, global.span, "does not fit");
        let diagnostic = diagnostic.see(place.at, "fed by this pass").hint(match components {
            1 => "declare `array<f32>`, `array<u32>` or `array<i32>`".to_owned(),
            3 => "import \"lib/packed.wgsl\" and declare `array<Packed3>`".to_owned(),
            n => format!("declare `array<vec{n}<f32>>`"),
        });
        Err(traced(diagnostic, &self.scopes[s].trace))
    }

    fn feed_texture(&mut self, s: ScopeId, place: &Feed<'_>, mut viewed: Viewed, draft: &mut Draft) -> Result<Bound> {
        let GlobalKind::Texture { dimension, multisampled, sample } = place.wanted.global.kind else {
            return Err(self.mismatch_object(s, place, viewed.view.object));
        };
        let object = viewed.view.object;
        self.adapt(object, dimension, multisampled, stand_in_format(sample), &mut viewed);
        let ObjectKind::Texture(texture) = self.object(object).object.kind.clone() else {
            return Err(self.mismatch_object(s, place, object));
        };
        if format::sample_kind(texture.format) != sample || (texture.samples > 1) != multisampled {
            return Err(self.mismatch_object(s, place, object));
        }
        self.fit_dimension(s, place, &mut viewed.view, dimension)?;
        let filtered = place.wanted.filtered && sample == SampleKind::Float;
        if filtered && !format::is_filterable(texture.format, Features::empty()) {
            if !format::is_float32(texture.format) {
                let message = format!("{} cannot be filtered", format::name(texture.format));
                let diagnostic =
                    fault(Code::FORMAT, message, place.wanted.global.span, "sampled with a linear sampler")
                        .see(place.at, "in this pass")
                        .see(self.object(object).object.span, "declared here")
                        .hint("use a nearest sampler or `textureLoad`");
                return Err(traced(diagnostic, &self.scopes[s].trace));
            }
            self.features |= Features::FLOAT32_FILTERABLE;
        }
        self.texture_usage(object, TextureUsages::TEXTURE_BINDING);
        let auto = self.object(object).mips_auto && viewed.view.mips.len() > 1;
        let used = Use { read: true, write: false, ..place.wanted.used };
        let mut access = self.access(place, &viewed.view, used, auto);
        // Until the planner has made them, only mip 0 has content.
        if auto {
            access.0.mips = 0..viewed.view.mips.end;
        }
        draft.accesses.push(access);
        Ok(Bound::Texture { view: viewed.view, sample, filtered, multisampled })
    }

    fn feed_storage_texture(
        &mut self,
        s: ScopeId,
        place: &Feed<'_>,
        mut viewed: Viewed,
        draft: &mut Draft,
    ) -> Result<Bound> {
        let GlobalKind::StorageTexture { dimension, format, read, write } = place.wanted.global.kind else {
            return Err(self.mismatch_object(s, place, viewed.view.object));
        };
        let object = viewed.view.object;
        self.adapt(object, dimension, false, format, &mut viewed);
        let ObjectKind::Texture(texture) = self.object(object).object.kind.clone() else {
            return Err(self.mismatch_object(s, place, object));
        };
        if texture.format != format || texture.samples > 1 {
            return Err(self.mismatch_object(s, place, object));
        }
        if !viewed.mip_said {
            viewed.view.mips = 0..1;
        }
        self.fit_dimension(s, place, &mut viewed.view, dimension)?;
        let storable = format.guaranteed_format_features(Features::empty()).allowed_usages;
        let read_write = read
            && write
            && !matches!(format, TextureFormat::R32Float | TextureFormat::R32Uint | TextureFormat::R32Sint);
        if !storable.contains(TextureUsages::STORAGE_BINDING) || read_write {
            self.features |= Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES;
        }
        self.texture_usage(object, TextureUsages::STORAGE_BINDING);
        draft.accesses.push(self.access(place, &viewed.view, place.wanted.used, false));
        Ok(Bound::StorageTexture { view: viewed.view, format, read, write })
    }

    pub(super) fn texture_usage(&mut self, object: ObjectRef, usage: TextureUsages) {
        for id in self.object_ids(object) {
            if let ObjectKind::Texture(texture) = &mut self.objects[id].object.kind {
                texture.usages |= usage;
            }
        }
    }

    /// A stand-in for an input takes the shape that the first shader wants.
    fn adapt(
        &mut self,
        object: ObjectRef,
        dimension: TextureDimension,
        multisampled: bool,
        format: TextureFormat,
        viewed: &mut Viewed,
    ) {
        let id = self.object_id(object);
        let building = &mut self.objects[id];
        if !building.adapts {
            return;
        }
        let ObjectKind::Texture(texture) = &mut building.object.kind else { return };
        building.adapts = false;
        texture.format = format;
        texture.samples = if multisampled { 4 } else { 1 };
        texture.is_3d = dimension == TextureDimension::D3;
        texture.layers = match dimension {
            TextureDimension::D1 | TextureDimension::D2 => texture.layers,
            TextureDimension::D2Array => texture.layers.max(2),
            TextureDimension::Cube => 6,
            TextureDimension::CubeArray => 12,
            TextureDimension::D3 => 64,
        };
        if !viewed.layer_said {
            viewed.view.layers = 0..if texture.is_3d { 1 } else { texture.layers };
        }
    }

    fn fit_dimension(&self, s: ScopeId, place: &Feed<'_>, view: &mut View, wanted: TextureDimension) -> Result<()> {
        let ObjectKind::Texture(t) = &self.object(view.object).object.kind else {
            return Err(self.mismatch_object(s, place, view.object));
        };
        let layers = view.layers.len();
        let fits = match wanted {
            TextureDimension::D1 => false,
            TextureDimension::D2 => !t.is_3d && layers == 1,
            TextureDimension::D2Array => !t.is_3d,
            TextureDimension::Cube => !t.is_3d && layers == 6 && t.width == t.height,
            TextureDimension::CubeArray => !t.is_3d && layers.is_multiple_of(6) && t.width == t.height,
            TextureDimension::D3 => t.is_3d,
        };
        if !fits {
            return Err(self.mismatch_object(s, place, view.object));
        }
        view.dimension = wanted;
        Ok(())
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

    pub(super) fn unbound(&mut self, s: ScopeId, place: &Feed<'_>) -> Box<Diagnostic> {
        let global = place.wanted.global;
        let names: Vec<String> = self.visible(s).into_iter().map(|name| name.replace('.', "_")).collect();
        let message = format!("nothing feeds the shader's `{}`, {}", global.name, describe(&global.kind));
        let diagnostic = fault(Code::UNBOUND, message, global.span, "the shader's variable")
            .see(place.stages.at, "run by this pass")
            .nearest(&global.name, names.iter().map(String::as_str))
            .hint(format!("declare `{0}` in the graph, or say `bind: {{\"{0}\": \"...\"}}`", global.name));
        traced(diagnostic, &self.scopes[s].trace)
    }

    pub(super) fn mismatch(&self, s: ScopeId, place: &Feed<'_>, entity: &Entity) -> Box<Diagnostic> {
        match entity {
            Entity::Var(var) => self.mismatch_object(s, place, self.vars[*var].now),
            other => self.mismatched(s, place, &self.what(other), None),
        }
    }

    fn mismatch_object(&self, s: ScopeId, place: &Feed<'_>, object: ObjectRef) -> Box<Diagnostic> {
        let declared = self.object(object).object.span;
        self.mismatched(s, place, &self.describe_object(object), Some(declared))
    }

    fn mismatched(&self, s: ScopeId, place: &Feed<'_>, is: &str, declared: Option<Span>) -> Box<Diagnostic> {
        let global = place.wanted.global;
        let wants = describe(&global.kind);
        let message = format!("the shader's `{}` wants {wants}, and is fed {is}", global.name);
        let mut diagnostic = fault(Code::BINDING_MISMATCH, message, place.at, is.to_owned())
            .see(global.span, format!("the shader wants {wants}"));
        if let Some(span) = declared.filter(|span| *span != place.at) {
            diagnostic = diagnostic.see(span, "declared here");
        }
        traced(diagnostic, &self.scopes[s].trace)
    }

    /// Every entry of `bind` must name something of the shader.
    fn check_bind_names(&mut self, s: ScopeId, stages: &Stages, bind: &[(Name, ast::Bound)]) {
        let mut known: Vec<&str> = Vec::new();
        for global in &stages.module.globals {
            known.push(&global.name);
            if let GlobalKind::Uniform(Type::Struct { members, .. }) = &global.kind {
                known.extend(members.iter().map(|m| m.name.as_str()));
            }
        }
        known.extend(stages.module.overrides.iter().map(|o| o.name.as_str()));
        for (name, _) in bind {
            if !known.contains(&name.value.as_str()) {
                let message = format!("the shader has no `{}` to bind", name.value);
                let mut diagnostic = fault(Code::UNKNOWN_BINDING, message, name.span, "not in the shader")
                    .nearest(&name.value, known.iter().copied());
                if let Some((_, entry)) = stages.entries.first() {
                    diagnostic = diagnostic.see(entry.span, "in this shader");
                }
                if known.len() <= 12 {
                    let names: Vec<String> = known.iter().map(|name| (*name).to_owned()).collect();
                    diagnostic = diagnostic.hint(format!("it has {}", super::names::list(&names)));
                }
                self.diagnostics.push(*traced(diagnostic, &self.scopes[s].trace));
            }
        }
    }
}

/// Everything about one variable while it is fed.
pub(super) struct Feed<'a> {
    pub stages: &'a Stages,
    pub bind: &'a [(Name, ast::Bound)],
    wanted: &'a Wanted<'a>,
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

/// `{ count, items }` as counted buffers are seen.
fn counted_layout(ty: &Type, span: Span) -> Option<Layout> {
    let Type::Struct { members, .. } = ty else { return None };
    let [count, items] = members.as_slice() else { return None };
    let is_count = count.name == "count"
        && matches!(count.ty, Type::Scalar(Scalar::U32) | Type::Atomic(Scalar::U32))
        && count.offset == 0;
    let (offset, stride, item) = items.ty.runtime_array()?;
    (is_count && items.name == "items").then(|| Layout {
        header: items.offset + offset,
        stride,
        item: item.clone(),
        span,
    })
}

fn plain_layout(ty: &Type, span: Span) -> Option<Layout> {
    let layout = |header, stride, item: &Type| Some(Layout { header, stride, item: item.clone(), span });
    match (ty.runtime_array(), ty) {
        (Some((offset, stride, item)), _) => layout(offset, stride, item),
        (None, Type::Array { element, stride, .. }) => layout(0, *stride, element),
        (None, ty) => layout(0, ty.size(), ty),
    }
}

/// How many items a type of fixed size takes.
fn fixed_items(ty: &Type) -> Option<u32> {
    match ty {
        Type::Array { count: Some(n), .. } => Some(*n),
        other if other.runtime_array().is_none() => Some(1),
        _ => None,
    }
}

/// Number of scalars in a tightly packed item: a scalar, a vector, or a struct of scalars.
fn lanes(ty: &Type) -> Option<u32> {
    match ty {
        Type::Scalar(_) | Type::Atomic(_) => Some(1),
        Type::Vector { components, .. } => Some(*components),
        Type::Struct { members, size, .. } => {
            let all_scalars = members.iter().all(|m| matches!(m.ty, Type::Scalar(_)));
            (all_scalars && *size == 4 * members.len() as u32).then_some(members.len() as u32)
        }
        _ => None,
    }
}

/// Equal names, offsets and types; `atomic<T>` counts as `T`, struct names do not count.
pub(super) fn same_type(a: &Type, b: &Type) -> bool {
    match (a, b) {
        (Type::Scalar(x) | Type::Atomic(x), Type::Scalar(y) | Type::Atomic(y)) => x == y,
        (Type::Array { element: x, count: n, stride: p }, Type::Array { element: y, count: m, stride: q }) => {
            n == m && p == q && same_type(x, y)
        }
        (Type::Struct { members: x, size: p, .. }, Type::Struct { members: y, size: q, .. }) => {
            p == q
                && x.len() == y.len()
                && x.iter().zip(y).all(|(m, n)| m.name == n.name && m.offset == n.offset && same_type(&m.ty, &n.ty))
        }
        _ => a == b,
    }
}

/// Where two item types differ, as a hint.
fn difference(a: &Type, b: &Type) -> String {
    if let (Type::Struct { members: x, .. }, Type::Struct { members: y, .. }) = (a, b) {
        for (m, n) in x.iter().zip(y) {
            if m.name != n.name || m.offset != n.offset || !same_type(&m.ty, &n.ty) {
                return format!(
                    "one has `{}: {}` at byte {}, the other `{}: {}` at byte {}",
                    n.name,
                    n.ty.wgsl(),
                    n.offset,
                    m.name,
                    m.ty.wgsl(),
                    m.offset
                );
            }
        }
    }
    "declare the item's type once, in a module that both import".to_owned()
}

/// What a shader's variable wants, for messages.
pub(super) fn describe(kind: &GlobalKind) -> String {
    let dimension = |d: TextureDimension| match d {
        TextureDimension::D1 => "1D",
        TextureDimension::D2 => "2D",
        TextureDimension::D2Array => "2D array",
        TextureDimension::Cube => "cube",
        TextureDimension::CubeArray => "cube array",
        TextureDimension::D3 => "3D",
    };
    match kind {
        GlobalKind::Uniform(ty) => format!("a uniform `{}`", ty.wgsl()),
        GlobalKind::Storage { ty, .. } => format!("a buffer of `{}`", ty.wgsl()),
        GlobalKind::Texture { dimension: d, multisampled, sample } => {
            let sample = match sample {
                SampleKind::Float => "floats",
                SampleKind::Sint => "signed integers",
                SampleKind::Uint => "unsigned integers",
                SampleKind::Depth => "depth",
            };
            let many = if *multisampled { " with 4 samples" } else { "" };
            format!("a {} texture of {sample}{many}", dimension(*d))
        }
        GlobalKind::StorageTexture { dimension: d, format, .. } => {
            format!("a {} storage texture of {}", dimension(*d), format::name(*format))
        }
        GlobalKind::Sampler { comparison: true } => "a comparison sampler".to_owned(),
        GlobalKind::Sampler { comparison: false } => "a sampler".to_owned(),
        GlobalKind::Other(what) => what.clone(),
    }
}

fn stand_in_format(sample: SampleKind) -> TextureFormat {
    match sample {
        SampleKind::Float => TextureFormat::Rgba16Float,
        SampleKind::Sint => TextureFormat::R32Sint,
        SampleKind::Uint => TextureFormat::R32Uint,
        SampleKind::Depth => TextureFormat::Depth32Float,
    }
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
