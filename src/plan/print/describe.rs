//! One line each for the things of a plan.

use crate::format;
use crate::plan::insert::describe as arguments;
use crate::plan::memory;
use crate::plan::model::{
    Access, Argument, Dispatch, Draw, Geometry, Object, ObjectKind, ObjectRef, Pass, PassKind, Plan, Texture,
};

/// `1.5 MiB`, `640 B`.
pub fn bytes(n: u64) -> String {
    const UNITS: [(&str, u64); 3] = [("GiB", 1 << 30), ("MiB", 1 << 20), ("KiB", 1 << 10)];
    match UNITS.iter().find(|(_, size)| n >= *size) {
        Some((unit, size)) => format!("{:.1} {unit}", n as f64 / *size as f64),
        None => format!("{n} B"),
    }
}

/// What an object is with its bytes.
pub fn object(object: &Object) -> String {
    format!("{}, {}", shape(object), bytes(memory::bytes(&object.kind)))
}

/// What an object is: format and size, or items.
pub(super) fn shape(object: &Object) -> String {
    match &object.kind {
        ObjectKind::Texture(t) => format!("{} {}", format::name(t.format), texture_size(t)),
        ObjectKind::Buffer(b) => {
            let what = if b.counted { "up to " } else { "" };
            format!("{what}{} x {} B", b.items, b.stride)
        }
    }
}

fn texture_size(t: &Texture) -> String {
    let mut text = format!("{} x {}", t.width, t.height);
    if t.is_3d || t.layers > 1 {
        text.push_str(&format!(" x {}", t.layers));
    }
    if t.is_3d {
        text.push_str(" (3D)");
    }
    if t.mips > 1 {
        text.push_str(&format!(", {} mips", t.mips));
    }
    if t.samples > 1 {
        text.push_str(&format!(", {} samples", t.samples));
    }
    text
}

/// The path behind a reference; state that swaps shows its place in the ring.
pub fn name(plan: &Plan, object: ObjectRef) -> String {
    match object {
        ObjectRef::Fixed(id) => plan.objects[id].path.clone(),
        ObjectRef::Ring { ring, index } => format!("{} (turns)", plan.objects[plan.rings[ring].objects[index]].path),
    }
}

/// What a pass does, without what it reads and writes.
pub fn pass(pass: &Pass) -> String {
    match &pass.kind {
        PassKind::Compute { dispatch: Dispatch::Groups([x, y, z]), .. } => format!("compute {x} x {y} x {z} groups"),
        PassKind::Compute { dispatch: Dispatch::Indirect { slot }, .. } => format!("compute indirect #{slot}"),
        PassKind::Draw(draw) => draw_line(draw),
        PassKind::Clear { value, .. } => match value {
            [r, g, b, a] if r == g && g == b && b == a => format!("clear to {r}"),
            [r, g, b, a] => format!("clear to ({r}, {g}, {b}, {a})"),
        },
        PassKind::Copy { .. } => "copy".into(),
        PassKind::Mips { .. } => "make mips".into(),
        PassKind::Settle { arguments: all, .. } => {
            let each: Vec<String> =
                all.iter().map(|Argument { slot, kind }| format!("#{slot} {}", arguments(kind))).collect();
            if each.is_empty() { "settle".into() } else { format!("settle {}", each.join(", ")) }
        }
        PassKind::Arguments { slot, offset, .. } => format!("arguments #{slot} from byte {offset}"),
    }
}

fn draw_line(draw: &Draw) -> String {
    let geometry = match &draw.geometry {
        Geometry::Fullscreen => "fullscreen".to_owned(),
        Geometry::Direct { vertices, instances } => format!("draw {vertices} vertices, {instances} instances"),
        Geometry::Indexed { count, instances, .. } => format!("draw {count} indices, {instances} instances"),
        Geometry::Indirect { slot, .. } => format!("draw indirect #{slot}"),
        Geometry::Meshes(meshes) => {
            let calls = match meshes.draws.len() {
                1 => "1 call".to_owned(),
                n => format!("{n} calls"),
            };
            format!("draw {} triangles of meshes in {calls}", meshes.triangles())
        }
    };
    let [w, h] = draw.extent;
    let samples = if draw.samples > 1 { format!(", {} samples", draw.samples) } else { String::new() };
    format!("{geometry}, to {w} x {h}{samples}")
}

/// `body.z[mip 0, layer 1]`, with only what is not whole in brackets.
pub fn access(plan: &Plan, access: &Access) -> String {
    let ObjectRef::Fixed(id) = access.object else { return name(plan, access.object) };
    let object = &plan.objects[id];
    let ObjectKind::Texture(t) = &object.kind else { return object.path.clone() };
    let layers = if t.is_3d { 1 } else { t.layers };
    let part = |what: &str, range: &std::ops::Range<u32>, all: u32| match range.len() {
        _ if range.start == 0 && range.end == all => None,
        1 => Some(format!("{what} {}", range.start)),
        _ => Some(format!("{what}s {} to {}", range.start, range.end - 1)),
    };
    let parts: Vec<String> =
        [part("mip", &access.mips, t.mips), part("layer", &access.layers, layers)].into_iter().flatten().collect();
    if parts.is_empty() { object.path.clone() } else { format!("{}[{}]", object.path, parts.join(", ")) }
}
