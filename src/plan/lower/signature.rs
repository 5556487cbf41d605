//! Whether what feeds the inputs of a graph instance is of the kinds that they want.

use super::names::Entity;
use super::{Lowering, ScopeId, fault};
use crate::diagnostic::{Code, Diagnostic};
use crate::graph::model::{InputKind, ViewDimension};
use crate::plan::model::{ObjectKind, Texture};

impl Lowering<'_> {
    /// Checks that every input of a graph instance is fed by the right kind of thing.
    /// Tells whether all are.
    pub(super) fn check_inputs(&mut self, s: ScopeId) -> bool {
        let mut all_fit = true;
        let graph = self.scopes[s].graph.clone();
        for (i, input) in graph.inputs.iter().enumerate() {
            // Asking for it must not count as a use.
            let used = self.used.contains(&input.name.span);
            let fed = self.resolve(s, &input.name.value, input.name.span);
            if !used {
                self.used.remove(&input.name.span);
            }
            let Some(entity) = self.report(fed) else {
                all_fit = false;
                continue;
            };
            if self.scopes[s].parent.is_none() {
                continue;
            }
            if self.is_absent(&entity) && !input.optional {
                all_fit = false;
                let diagnostic = self.absent_fed(s, i);
                self.diagnostics.push(diagnostic);
            } else if !self.fits_input(&entity, &input.kind) {
                all_fit = false;
                let fed = self.what(&entity);
                let name = &input.name.value;
                let message = format!("the input `{name}` wants {}, and is fed {fed}", wanted(&input.kind));
                let bound = self.scopes[s].binds.get(name).map(|n| n.span);
                let at = bound.or(self.scopes[s].trace.last().copied()).unwrap_or(input.name.span);
                self.diagnostics
                    .push(fault(Code::WRONG_KIND, message, at, "fed here").see(input.name.span, "declared here"));
            }
        }
        all_fit
    }

    fn absent_fed(&self, s: ScopeId, i: usize) -> Diagnostic {
        let input = &self.scopes[s].graph.inputs[i];
        let name = &input.name.value;
        let at = self.scopes[s].trace.last().copied().unwrap_or(input.name.span);
        let message = format!("the part needs `{name}`, and what feeds it may be absent");
        fault(Code::OPTIONAL_INPUT, message, at, "used here")
            .see(input.name.span, "not optional here")
            .hint("use the part inside `If(test: \"has(...)\", then: [...])`, or make its input optional")
    }

    fn fits_input(&self, entity: &Entity, kind: &InputKind) -> bool {
        let object = match entity {
            Entity::Var(var) => Some(&self.object(self.vars[*var].now).object.kind),
            _ => None,
        };
        match (kind, entity, object) {
            (_, Entity::Absent, _) => true,
            (InputKind::Camera, Entity::Input { kind: InputKind::Camera, .. }, _)
            | (InputKind::Light, Entity::Input { kind: InputKind::Light, .. }, _)
            | (InputKind::Pointer, Entity::Input { kind: InputKind::Pointer, .. }, _)
            | (InputKind::Meshes { .. }, Entity::Input { kind: InputKind::Meshes { .. }, .. }, _)
            | (InputKind::Particles { .. }, Entity::Input { kind: InputKind::Particles { .. }, .. }, _) => true,
            // A camera or light that a shader wrote.
            (InputKind::Camera | InputKind::Light, Entity::Var(_), Some(ObjectKind::Buffer(b))) => !b.counted,
            (InputKind::Texture { dimension }, Entity::Var(_), Some(ObjectKind::Texture(texture))) => {
                dimension.as_ref().is_none_or(|d| has_dimension(texture, d.value))
            }
            (InputKind::Buffer | InputKind::Table, Entity::Var(_), Some(ObjectKind::Buffer(b))) => !b.counted,
            (InputKind::Counted, Entity::Var(_), Some(ObjectKind::Buffer(b))) => b.counted,
            _ => false,
        }
    }
}

/// What an input wants, with its article.
pub(super) fn wanted(kind: &InputKind) -> String {
    let dimension = match kind {
        InputKind::Texture { dimension: Some(d) } => match d.value {
            ViewDimension::D2 => "2D ",
            ViewDimension::D2Array => "2D array ",
            ViewDimension::Cube => "cube ",
            ViewDimension::CubeArray => "cube array ",
            ViewDimension::D3 => "3D ",
        },
        _ => "",
    };
    match kind {
        InputKind::Particles { .. } | InputKind::Meshes { .. } => kind.name().to_owned(),
        other => format!("a {dimension}{}", other.name()),
    }
}

/// Whether a texture can be seen so.
fn has_dimension(texture: &Texture, dimension: ViewDimension) -> bool {
    let is_square = texture.width == texture.height;
    match dimension {
        ViewDimension::D3 => texture.is_3d,
        ViewDimension::D2 => !texture.is_3d && texture.layers == 1,
        ViewDimension::D2Array => !texture.is_3d,
        ViewDimension::Cube => !texture.is_3d && texture.layers == 6 && is_square,
        ViewDimension::CubeArray => !texture.is_3d && texture.layers.is_multiple_of(6) && is_square,
    }
}
