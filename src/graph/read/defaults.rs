//! `default:` of inputs: what feeds them where a scene does not.

use super::values::tagged;
use crate::diagnostic::{Code, Diagnostic};
use crate::graph::model::InputDefault;
use crate::graph::rows;
use crate::syntax::{Body, Decoder, Fields, Kind, Node, Tagged};

/// `default: Light(direction: ..., color: ..., intensity: ...)`.
pub(super) fn light(d: &mut Decoder<'_>, fields: &Fields<'_>) -> Option<InputDefault> {
    let node = fields.get("default")?;
    let what = "`default` of `Light`";
    let (word, tag) = tagged(d, node, what, "`Light(direction: (x, y, z))`")?;
    if word.value != "Light" {
        d.unknown_word(word, what, &["Light"]);
        return None;
    }
    let fields = d.body_fields(tag, "`Light`", &["direction", "color", "intensity"])?;
    let direction = fields.require(d, "direction").and_then(|n| d.floats::<3>(n, "`direction`"));
    let color = fields.get("color").map_or(Some([1.0; 3]), |n| d.floats::<3>(n, "`color`"));
    let intensity = fields.get("intensity").map_or(Some(1.0), |n| d.float(n, "`intensity`"));
    let (direction, color, intensity) = (direction?, color?, intensity?);
    if direction == [0.0; 3] {
        d.push(
            Diagnostic::error(Code::OUT_OF_RANGE, "a light's direction must not be zero").at(fields.head, "this light"),
        );
        return None;
    }
    Some(InputDefault::Light { direction, color, intensity })
}

/// `default: (r, g, b)` or `(r, g, b, a)`: one texel, linear.
pub(super) fn texture(d: &mut Decoder<'_>, fields: &Fields<'_>) -> Option<InputDefault> {
    let node = fields.get("default")?;
    let what = "`default` of `Texture`";
    let color = match is_tuple_of(node, 4) {
        true => d.floats::<4>(node, what)?,
        false => {
            let [r, g, b] = d.floats::<3>(node, what)?;
            [r, g, b, 1.0]
        }
    };
    Some(InputDefault::Texture(color))
}

/// `default: None`: no particles.
pub(super) fn particles(d: &mut Decoder<'_>, fields: &Fields<'_>) -> Option<InputDefault> {
    let node = fields.get("default")?;
    d.choice(node, "`default` of `Particles`", &[("None", ())]).map(|()| InputDefault::NoParticles)
}

/// `default: [(name: value, ...), ...]`: rows, as a scene writes them.
pub(super) fn table(d: &mut Decoder<'_>, fields: &Fields<'_>) -> Option<InputDefault> {
    rows::rows(d, fields.get("default")?, "`default` of `Table`").map(InputDefault::Table)
}

fn is_tuple_of(node: &Node, n: usize) -> bool {
    matches!(&node.kind, Kind::Tagged(Tagged { body: Body::Items(items), .. }) if items.len() == n)
}

/// What has a default is always there.
pub(super) fn not_optional(d: &mut Decoder<'_>, fields: &Fields<'_>) {
    if let (Some(default), Some(optional)) = (fields.get("default"), fields.get("optional")) {
        let diagnostic = Diagnostic::error(Code::WRONG_VALUE, "an input with a default is always there")
            .at(optional.span, "and cannot be optional")
            .see(default.span, "the default")
            .hint("keep one of them: without it, the graph asks `has(...)` and goes another way");
        d.push(diagnostic);
    }
}
