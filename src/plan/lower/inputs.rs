//! Inputs of a graph instance: what feeds them, their fields, and whether it fits.

use super::names::{Entity, list};
use super::signature::wanted;
use super::vars::{buffer, stand_in_texture};
use super::{Building, CauseKind, Lowering, Result, Scalar, ScopeId, VarId, fault, traced};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::graph::model::{Attribute, Input, InputKind, Param};
use crate::graph::value::Value;
use crate::plan::fields;
use crate::plan::meshes::MeshBuffer;
use crate::plan::model::{InputInfo, Object, ObjectKind, Origin};

impl Lowering<'_> {
    /// What an input, or a field of it, stands for: the thing outside that feeds it.
    pub(super) fn input(&mut self, s: ScopeId, i: usize, field: Option<&str>, span: Span) -> Result<Entity> {
        let graph = self.scopes[s].graph.clone();
        let input = &graph.inputs[i];
        self.used.insert(input.name.span);
        let Some(parent) = self.scopes[s].parent else {
            return self.root_input(s, i, attributes(&input.kind), field, span);
        };
        let outer = self.fed(s, i, parent, span)?;
        match (outer, field) {
            // Absent meshes are no bodies.
            (Entity::Absent, field) if matches!(input.kind, InputKind::Meshes { .. }) => {
                self.mesh_thing(s, "", &input.kind, field, span)
            }
            (Entity::Input { root, kind: InputKind::Meshes { .. } }, Some(field)) => {
                self.mesh_thing(s, &root, &input.kind, Some(field), span)
            }
            (entity, None) => Ok(entity),
            (Entity::Input { root, .. }, Some(field)) => {
                let root_graph = self.program.root.clone();
                let index = root_graph.inputs.iter().position(|i| *i.name.value == *root);
                match index {
                    Some(index) => self.root_input(s, index, attributes(&input.kind), Some(field), span),
                    None => Err(self.unknown(s, field, span)),
                }
            }
            (Entity::Absent, Some(_)) => Err(self.absent(s, i, span)),
            (entity, Some(field)) => {
                let message = format!("`{}` has no field `{field}`: it is {}", input.name.value, entity.what());
                Err(traced(fault(Code::WRONG_KIND, message, span, "no such field"), &self.scopes[s].trace))
            }
        }
    }

    /// The thing outside that feeds an input of a part: the same wherever the part asks for it.
    fn fed(&mut self, s: ScopeId, i: usize, parent: ScopeId, span: Span) -> Result<Entity> {
        if let Some(known) = &self.scopes[s].fed[i] {
            return Ok(known.clone());
        }
        let graph = self.scopes[s].graph.clone();
        let input = &graph.inputs[i];
        let entity = match self.scopes[s].binds.get(&input.name.value).cloned() {
            Some(bound) => self.resolve(parent, &bound.value, bound.span)?,
            None if self.scopes[parent].locals.contains_key(&input.name.value) => {
                self.resolve(parent, &input.name.value, span)?
            }
            None if input.optional => Entity::Absent,
            None => return Err(self.missing_input(s, i)),
        };
        // Scalars may be others in another iteration.
        if !matches!(entity, Entity::Scalar(_)) {
            self.scopes[s].fed[i] = Some(entity.clone());
        }
        Ok(entity)
    }

    pub(super) fn missing_input(&self, s: ScopeId, i: usize) -> Box<Diagnostic> {
        let input = &self.scopes[s].graph.inputs[i];
        let message = format!("nothing feeds the input `{}` ({})", input.name.value, input.kind.name());
        let mut diagnostic = Diagnostic::error(Code::MISSING_INPUT, message);
        diagnostic = match self.scopes[s].trace.last() {
            Some(used) => diagnostic.at(*used, "used here").see(input.name.span, "the input"),
            None => diagnostic.at(input.name.span, "the input"),
        };
        let hint = match self.scopes[s].parent {
            Some(_) => format!(
                "where the part is used, declare something called `{0}` or say `bind: {{\"{0}\": \"...\"}}`",
                input.name.value
            ),
            None => format!("give the scene an item called `{}`", input.name.value),
        };
        Box::new(diagnostic.hint(hint))
    }

    pub(super) fn absent(&self, s: ScopeId, i: usize, span: Span) -> Box<Diagnostic> {
        let input = &self.scopes[s].graph.inputs[i];
        let name = &input.name.value;
        let diagnostic =
            fault(Code::OPTIONAL_INPUT, format!("the optional input `{name}` may be absent here"), span, "needs it")
                .see(input.name.span, "declared optional")
                .hint(format!("put what needs it inside `If(test: \"has({name})\", then: [...])`"));
        traced(diagnostic, &self.scopes[s].trace)
    }

    /// As [`Self::absent`], for a name of the scope that leads to such an input.
    pub(super) fn absent_here(&self, s: ScopeId, name: &str, span: Span) -> Box<Diagnostic> {
        let input = self.scopes[s].graph.inputs.iter().position(|i| i.name.value == name);
        match input {
            Some(i) if self.scopes[s].graph.inputs[i].optional => self.absent(s, i, span),
            _ => {
                let message = format!("the optional input `{name}` may be absent here");
                let diagnostic = fault(Code::OPTIONAL_INPUT, message, span, "needs it")
                    .hint("put what needs it inside `If(test: \"has(...)\", then: [...])`");
                traced(diagnostic, &self.scopes[s].trace)
            }
        }
    }

    /// An input of the root: what the request says of it.
    /// `attributes` are those that the asking graph declares.
    fn root_input(
        &mut self,
        s: ScopeId,
        i: usize,
        attributes: &[Attribute],
        field: Option<&str>,
        span: Span,
    ) -> Result<Entity> {
        let graph = self.program.root.clone();
        let input = &graph.inputs[i];
        self.used.insert(input.name.span);
        let name = input.name.value.clone();
        let request = self.request;
        let info = request.inputs.get(&name);
        if matches!(input.kind, InputKind::Meshes { .. }) && (info.is_some() || input.optional) {
            return match info {
                Some(InputInfo::Meshes(_)) | None => self.mesh_thing(s, &name, &input.kind, field, span),
                Some(_) => Err(self.wrongly_fed(&name, input)),
            };
        }
        if info.is_none() && (input.optional || !self.stand_in) {
            return match (input.optional, field) {
                (true, None) => Ok(Entity::Absent),
                (true, Some(_)) => Err(self.absent(0, i, span)),
                (false, _) => Err(self.missing_input(0, i)),
            };
        }
        let table = match &input.kind {
            InputKind::Camera => fields::CAMERA,
            InputKind::Light => fields::LIGHT,
            InputKind::Pointer => fields::POINTER,
            InputKind::Particles { .. } => return self.particles(s, i, attributes, info, field, span),
            _ => return Ok(Entity::Var(self.input_var(&name, i, info)?)),
        };
        match field {
            None => Ok(Entity::Input { root: name.into(), kind: input.kind.clone() }),
            Some(field) if table.iter().any(|(known, _)| *known == field) => {
                Ok(Entity::Scalar(self.live(&format!("{name}.{field}"), span)))
            }
            Some(field) => Err(self.unknown_field(s, &name, field, table, span)),
        }
    }

    pub(super) fn unknown_field(
        &self,
        s: ScopeId,
        name: &str,
        field: &str,
        table: &[(&str, fields::FieldType)],
        span: Span,
    ) -> Box<Diagnostic> {
        let names: Vec<String> = table.iter().map(|(known, _)| (*known).to_owned()).collect();
        let diagnostic = fault(Code::UNKNOWN_NAME, format!("`{name}` has no field `{field}`"), span, "unknown field")
            .nearest(field, names.iter().map(String::as_str))
            .hint(format!("its fields are {}", list(&names)));
        traced(diagnostic, &self.scopes[s].trace)
    }

    fn wrongly_fed(&self, name: &str, input: &Input) -> Box<Diagnostic> {
        let message = format!("the input `{name}` wants {}, and is fed something else", wanted(&input.kind));
        Box::new(fault(Code::WRONG_KIND, message, input.name.span, "declared here"))
    }

    fn particles(
        &mut self,
        s: ScopeId,
        i: usize,
        declared: &[Attribute],
        info: Option<&InputInfo>,
        field: Option<&str>,
        span: Span,
    ) -> Result<Entity> {
        let graph = self.program.root.clone();
        let input = &graph.inputs[i];
        let name = input.name.value.clone();
        let Some(InputInfo::Particles { count, radius, min, max, attributes }) = info else {
            if info.is_none() {
                return Err(self.missing_input(0, i));
            }
            return Err(self.wrongly_fed(&name, input));
        };
        let Some(field) = field else { return Ok(Entity::Input { root: name.into(), kind: input.kind.clone() }) };
        let value = match field {
            "count" => Value::Int(i64::try_from(*count).unwrap_or(i64::MAX)),
            "radius" => Value::Float(*radius),
            "min" => Value::vec(*min),
            "max" => Value::vec(*max),
            attribute => {
                let Some(declaration) = declared.iter().find(|a| a.name.value == attribute) else {
                    return Err(self.unknown_field(s, &name, field, fields::PARTICLES, span));
                };
                let present = attributes.iter().find(|(known, _)| known == attribute);
                if present.is_none() && !declaration.optional {
                    let names: Vec<String> = attributes.iter().map(|(known, _)| known.clone()).collect();
                    let message = format!("the particles have no attribute `{attribute}`");
                    let diagnostic = fault(Code::MISSING_INPUT, message, declaration.name.span, "asked for here")
                        .hint(format!("they have {}; `\"{attribute}?\"` makes it optional", list(&names)));
                    return Err(Box::new(diagnostic));
                }
                return Ok(Entity::Var(self.attribute_var(&name, attribute, *count, present.is_some(), input.span)));
            }
        };
        let causes = self.causes.set(CauseKind::Input, &name);
        Ok(Entity::Scalar(Scalar::caused(value, causes)))
    }

    /// The variable of a root input that is memory: texture, buffer, counted, table.
    pub(super) fn input_var(&mut self, name: &str, i: usize, info: Option<&InputInfo>) -> Result<VarId> {
        if let Some(var) = self.input_vars.get(name) {
            return Ok(*var);
        }
        let graph = self.program.root.clone();
        let input = &graph.inputs[i];
        let counted = matches!(input.kind, InputKind::Counted);
        let kind = match (&input.kind, info) {
            (InputKind::Texture { .. }, Some(InputInfo::Texture(texture))) => ObjectKind::Texture(texture.clone()),
            (InputKind::Texture { dimension }, None) if self.stand_in => {
                ObjectKind::Texture(stand_in_texture(dimension.as_ref().map(|d| d.value)))
            }
            (InputKind::Buffer | InputKind::Counted, Some(InputInfo::Buffer { items, stride })) => {
                let mut kind = buffer(*items, counted);
                if let ObjectKind::Buffer(b) = &mut kind {
                    b.stride = *stride;
                }
                kind
            }
            (InputKind::Table, Some(InputInfo::Table { rows })) => buffer(rows.len() as u64, false),
            (InputKind::Buffer | InputKind::Counted | InputKind::Table, None) if self.stand_in => buffer(1000, counted),
            (_, Some(_)) => return Err(self.wrongly_fed(name, input)),
            (_, None) => return Err(self.missing_input(0, i)),
        };
        let causes = self.causes.set(CauseKind::Input, name);
        let object = Object {
            path: name.to_owned(),
            kind,
            origin: Origin::Input(name.to_owned()),
            empty: None,
            lifetime: None,
            span: input.name.span,
        };
        let building = Building { object, layout: None, mips_auto: false, adapts: self.stand_in, causes };
        let var = self.add_var(building);
        self.input_vars.insert(name.to_owned(), var);
        Ok(var)
    }

    pub(super) fn attribute_var(
        &mut self,
        input: &str,
        attribute: &str,
        count: u64,
        present: bool,
        span: Span,
    ) -> VarId {
        let path = format!("{input}.{attribute}");
        if let Some(var) = self.input_vars.get(&path) {
            return *var;
        }
        let causes = self.causes.set(CauseKind::Input, input);
        let object = Object {
            path: path.clone(),
            kind: buffer(count, false),
            origin: Origin::Attribute { input: input.to_owned(), attribute: attribute.to_owned(), present },
            empty: None,
            lifetime: None,
            span,
        };
        let var = self.add_var(Building { object, layout: None, mips_auto: false, adapts: false, causes });
        self.input_vars.insert(path, var);
        var
    }
}

/// The fields of an input of a kind: what follows its name and a dot.
pub(crate) fn input_fields(kind: &InputKind) -> impl Iterator<Item = &str> {
    let buffers: &[(&str, MeshBuffer)] = match kind {
        InputKind::Meshes { .. } => &MeshBuffer::NAMED,
        _ => &[],
    };
    let of_meshes = buffers.iter().map(|(name, _)| *name).chain(values(kind).iter().map(|v| v.name.value.as_str()));
    let (table, attributes): (&[(&str, fields::FieldType)], &[Attribute]) = match kind {
        InputKind::Camera => (fields::CAMERA, &[]),
        InputKind::Light => (fields::LIGHT, &[]),
        InputKind::Pointer => (fields::POINTER, &[]),
        InputKind::Particles { attributes } => (fields::PARTICLES, attributes),
        InputKind::Meshes { .. } => (fields::MESHES, &[]),
        _ => (&[], &[]),
    };
    let names = table.iter().map(|(name, _)| *name).chain(attributes.iter().map(|a| a.name.value.as_str()));
    names.chain(of_meshes)
}

/// What an input of meshes wants of each body.
pub(super) fn values(kind: &InputKind) -> &[Param] {
    match kind {
        InputKind::Meshes { values } => values,
        _ => &[],
    }
}

fn attributes(kind: &InputKind) -> &[Attribute] {
    match kind {
        InputKind::Particles { attributes } => attributes,
        _ => &[],
    }
}
