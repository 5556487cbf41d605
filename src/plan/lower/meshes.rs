//! Meshes: their buffers and scalars by name, vertex inputs, and the materials that draws bind.

use std::sync::LazyLock;

use wgpu_types::BufferUsages;

use super::bind::{Feed, Stages};
use super::buffers::same_type;
use super::inputs::{input_fields, values};
use super::names::{Entity, list};
use super::nodes::Draft;
use super::{Building, CauseKind, CauseSet, Layout, Lowering, Place, Result, Scalar, ScopeId, VarId, fault, traced};
use crate::diagnostic::{Code, Span};
use crate::graph::model::{self as ast, Covering, InputKind, Name, Param};
use crate::graph::value::Value;
use crate::plan::meshes::{
    MeshBuffer, MeshDraw, MeshGeometry, MeshesInfo, VertexAttribute, VertexBuffer, instance_type,
};
use crate::plan::model::{Access, Buffer, Geometry, InputInfo, Object, ObjectKind, ObjectRef, Origin};
use crate::shader::reflect::{Entry, Type};

/// The meshes that a draw shows.
#[derive(Clone, Debug)]
pub(super) struct MeshInput {
    /// The root's input; empty where nothing feeds a part's.
    pub root: String,
    /// How the pass calls them.
    pub name: Name,
}

impl<'p> Lowering<'p> {
    /// What feeds an input of the root; no bodies where nothing does.
    pub(super) fn mesh_info(&self, root: &str) -> &'p MeshesInfo {
        static NONE: LazyLock<MeshesInfo> = LazyLock::new(MeshesInfo::default);
        match self.request.inputs.get(root) {
            Some(InputInfo::Meshes(info)) => info,
            _ => &NONE,
        }
    }

    /// What depends on an input; on nothing where nothing feeds it.
    pub(super) fn causes_of(&mut self, root: &str) -> CauseSet {
        if root.is_empty() { CauseSet::default() } else { self.causes.set(CauseKind::Input, root) }
    }

    /// Whether nothing feeds an optional input: meshes then are no bodies, and stand all the same.
    pub(super) fn is_absent(&self, entity: &Entity) -> bool {
        match entity {
            Entity::Absent => true,
            Entity::Input { root, kind: InputKind::Meshes { .. } } => !self.request.inputs.contains_key(&**root),
            _ => false,
        }
    }

    /// An input of meshes, or a field of it. `kind` is what the asking graph wants.
    pub(super) fn mesh_thing(
        &mut self,
        s: ScopeId,
        root: &str,
        kind: &InputKind,
        field: Option<&str>,
        span: Span,
    ) -> Result<Entity> {
        let Some(field) = field else { return Ok(Entity::Input { root: root.into(), kind: kind.clone() }) };
        let info = self.mesh_info(root);
        let causes = self.causes_of(root);
        let scalar = match field {
            "count" => Some(Value::Int(i64::try_from(info.bodies).unwrap_or(i64::MAX))),
            "blended" => Some(Value::Int(
                info.draws.iter().filter(|call| call.blended).map(|call| i64::from(call.instances)).sum(),
            )),
            "min" => Some(Value::vec(info.min)),
            "max" => Some(Value::vec(info.max)),
            _ => None,
        };
        if let Some(value) = scalar {
            return Ok(Entity::Scalar(Scalar::caused(value, causes)));
        }
        if let Some((_, buffer)) = MeshBuffer::NAMED.iter().find(|(name, _)| *name == field) {
            return Ok(Entity::Var(self.mesh_var(root, info, buffer.clone(), span)));
        }
        let Some(value) = values(kind).iter().find(|v| v.name.value == field) else {
            let names: Vec<String> = input_fields(kind).map(str::to_owned).collect();
            let message = format!("meshes have no field `{field}`");
            let diagnostic = fault(Code::UNKNOWN_NAME, message, span, "unknown field")
                .nearest(field, names.iter().map(String::as_str))
                .hint(format!("their fields are {}", list(&names)));
            return Err(traced(diagnostic, &self.scopes[s].trace));
        };
        self.used.insert(value.name.span);
        self.check_values(root, info, value)?;
        let default = value.default.as_ref().map(|d| d.value.clone());
        let buffer = MeshBuffer::Value { name: field.to_owned(), default };
        Ok(Entity::Var(self.mesh_var(root, info, buffer, value.name.span)))
    }

    /// Every body must have a value that fits, or the declaration a default.
    fn check_values(&self, root: &str, info: &MeshesInfo, value: &Param) -> Result<()> {
        if self.stand_in {
            return Ok(());
        }
        let name = &value.name.value;
        let given = info.values.get(name);
        for body in 0..info.bodies as usize {
            match given.and_then(|all| all.get(body)).and_then(Option::as_ref) {
                Some(found) => {
                    let scalar = Scalar::known(found.clone());
                    self.fit(scalar, value, value.name.span)?;
                }
                None if value.default.is_none() => {
                    let message = format!("body {body} of `{root}` has no value `{name}`");
                    let diagnostic = fault(Code::MISSING_INPUT, message, value.name.span, "asked for here")
                        .hint(format!("say `values: {{\"{name}\": ...}}` in the scene, or give it a `default` here"));
                    return Err(Box::new(diagnostic));
                }
                None => {}
            }
        }
        Ok(())
    }

    /// The variable of a buffer of meshes.
    fn mesh_var(&mut self, root: &str, info: &MeshesInfo, buffer: MeshBuffer, span: Span) -> VarId {
        let path = format!("{}.{}", if root.is_empty() { "(none)" } else { root }, buffer.name());
        if let Some(var) = self.input_vars.get(&path) {
            return *var;
        }
        let var = self.add_mesh_var(root, info, buffer, path.clone(), span);
        self.input_vars.insert(path, var);
        var
    }

    pub(super) fn add_mesh_var(
        &mut self,
        root: &str,
        info: &MeshesInfo,
        buffer: MeshBuffer,
        path: String,
        at: Span,
    ) -> VarId {
        let mut causes = self.causes_of(root);
        if buffer.moves() && info.animated {
            causes.add(&self.causes.set(CauseKind::Live, "time"));
        }
        let declared = self.program.root.inputs.iter().find(|i| i.name.value == root).map(|i| i.name.span);
        let object = Object {
            path,
            kind: ObjectKind::Buffer(Buffer {
                stride: buffer.item().map_or(4, |(bytes, _)| bytes),
                items: buffer.items(info),
                header: 0,
                counted: false,
                item: None,
                usages: BufferUsages::empty(),
            }),
            origin: Origin::Mesh { input: root.to_owned(), buffer },
            empty: None,
            lifetime: None,
            span: declared.unwrap_or(at),
        };
        self.add_var(Building { object, layout: None, mips_auto: false, adapts: false, causes })
    }

    /// What a shader sees a buffer of meshes as must be what the engine fills it with.
    pub(super) fn mesh_layout(
        &self,
        s: ScopeId,
        place: &Feed<'_>,
        buffer: &MeshBuffer,
        path: &str,
        layout: &Layout,
    ) -> Result<()> {
        let Some((bytes, wanted)) = buffer.item() else { return Ok(()) };
        let fits = match buffer {
            MeshBuffer::Bodies => matches!(layout.item, Type::Matrix { columns: 4, rows: 4, .. }),
            MeshBuffer::Instances => same_type(&layout.item, &instance_type()),
            _ => layout.item.size() == bytes,
        };
        if fits && layout.stride == bytes && layout.header == 0 {
            return Ok(());
        }
        let global = place.global();
        let message = format!(
            "`{path}` has {bytes} bytes an item, and the shader sees `array<{}>`, {} bytes each",
            layout.item.wgsl(),
            layout.stride
        );
        let diagnostic = fault(Code::BINDING_MISMATCH, message, global.span, "does not fit")
            .see(place.at, "fed by this pass")
            .hint(format!("declare {wanted}"));
        Err(traced(diagnostic, &self.scopes[s].trace))
    }

    /// The meshes that a draw names.
    pub(super) fn mesh_input(&mut self, s: ScopeId, name: &Name) -> Result<MeshInput> {
        match self.resolve(s, &name.value, name.span)? {
            Entity::Input { root, kind: InputKind::Meshes { .. } } => {
                Ok(MeshInput { root: root.to_string(), name: name.clone() })
            }
            other => {
                let message = format!("`{}` is {}, not meshes", name.value, self.what(&other));
                let diagnostic =
                    fault(Code::WRONG_KIND, message, name.span, "not meshes").hint("declare an input of kind `Meshes`");
                Err(traced(diagnostic, &self.scopes[s].trace))
            }
        }
    }

    /// The vertex inputs and calls of a draw of meshes.
    pub(super) fn mesh_geometry(
        &mut self,
        s: ScopeId,
        meshes: &MeshInput,
        draw: &ast::Draw,
        vertex: Option<&Entry>,
        stages: &Stages,
        draft: &mut Draft,
    ) -> Result<Geometry> {
        let info = self.mesh_info(&meshes.root);
        let mut vertices = Vec::new();
        for input in vertex.iter().flat_map(|v| &v.inputs) {
            let attribute = self.vertex_attribute(s, stages, &input.name, &input.ty, input.span)?;
            let buffer = (attribute != VertexAttribute::Instance)
                .then(|| self.mesh_read(meshes, info, MeshBuffer::Vertices(attribute), BufferUsages::VERTEX, draft));
            vertices.push(VertexBuffer { location: input.location, attribute, buffer });
        }
        let indices = self.mesh_read(meshes, info, MeshBuffer::Triangles, BufferUsages::INDEX, draft);
        let tagged = |call: &MeshDraw| match &draw.tags {
            Some(tags) => tags.iter().any(|tag| call.tags.contains(&tag.value)),
            None => true,
        };
        let covers = |call: &MeshDraw| draw.only.is_none_or(|only| call.blended == (only == Covering::Blended));
        let draws = info.draws.iter().filter(|call| tagged(call) && covers(call)).cloned().collect();
        Ok(Geometry::Meshes(MeshGeometry { input: meshes.root.clone(), indices, vertices, draws }))
    }

    /// A buffer that a draw takes vertices or indices from.
    fn mesh_read(
        &mut self,
        meshes: &MeshInput,
        info: &MeshesInfo,
        buffer: MeshBuffer,
        usage: BufferUsages,
        draft: &mut Draft,
    ) -> ObjectRef {
        let var = self.mesh_var(&meshes.root, info, buffer, meshes.name.span);
        let object = self.vars[var].now;
        self.buffer_usage(object, usage);
        let access = Access { object, mips: 0..1, layers: 0..1, read: true, write: false, whole: false };
        draft.accesses.push((access, Place::at(meshes.name.span, &meshes.name.value, false)));
        draft.causes.add(&self.object(object).causes);
        object
    }

    fn vertex_attribute(
        &self,
        s: ScopeId,
        stages: &Stages,
        name: &str,
        ty: &Type,
        span: Span,
    ) -> Result<VertexAttribute> {
        let found = VertexAttribute::ALL.into_iter().find(|attribute| attribute.name() == name);
        let diagnostic = match found {
            Some(attribute) if attribute.ty() == *ty => return Ok(attribute),
            Some(attribute) => {
                let wanted = attribute.ty().wgsl();
                let message = format!("the vertex input `{name}` is `{}`, and meshes have `{wanted}`", ty.wgsl());
                fault(Code::BINDING_MISMATCH, message, span, format!("`{}`", ty.wgsl()))
                    .see(stages.at, "run by this pass")
                    .hint(format!("declare `{name}: {wanted}`"))
            }
            None => {
                let names: Vec<String> = VertexAttribute::ALL.iter().map(|a| a.name().to_owned()).collect();
                let message = format!("nothing feeds the vertex input `{name}`: meshes have no such attribute");
                fault(Code::UNBOUND, message, span, "vertex input")
                    .see(stages.at, "run by this pass")
                    .nearest(name, names.iter().map(String::as_str))
                    .hint(format!("vertices have {}", list(&names)))
            }
        };
        Err(traced(diagnostic, &self.scopes[s].trace))
    }
}
