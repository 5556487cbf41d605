//! A plan as JSON: all that its text says and more, under names that stay.
//!
//! Objects, passes, units and steps are named by their place in `resources`, `passes`, `units`
//! and `steps`. Ranges are `[first, past the last]`, but for lifetimes, which are the first and
//! the last pass. Sizes are in bytes.

use std::collections::BTreeMap;
use std::ops::Range;

use serde_json::{Value as Json, json};

use crate::format;
use crate::graph::value::Value;
use crate::plan::memory;
use crate::plan::merge::SharedKind;
use crate::plan::model::{
    Access, Argument, ArgumentKind, Binding, Bound, Causes, Dispatch, Draw, Geometry, Object, ObjectKind, ObjectRef,
    Origin, Param, Pass, PassKind, Plan, ShaderUse, Slot, UniformValue, View,
};
use crate::plan::needs::feature_names;

/// Changes when what is there is renamed or gone, not when something is added.
const VERSION: u32 = 1;

/// The whole plan as JSON, with two spaces to a level and a newline at the end.
pub fn json(plan: &Plan) -> String {
    format!("{:#}\n", value(plan))
}

fn value(plan: &Plan) -> Json {
    json!({
        "version": VERSION,
        "graph": plan.graph.display().to_string(),
        "viewport": plan.viewport,
        "passes": plan.passes.iter().map(|p| pass(plan, p)).collect::<Vec<_>>(),
        "culled": plan.culled.iter().map(|c| json!({ "path": c.path, "why": c.why })).collect::<Vec<_>>(),
        "passes_of_device": super::rows::shared_passes(plan).iter().map(|s| json!({
            "passes": range_of(&s.passes),
            "kind": match s.kind {
                SharedKind::Compute => "compute",
                SharedKind::Render => "render",
                SharedKind::Alone => "alone",
            },
        })).collect::<Vec<_>>(),
        "moved": plan.order.moved.iter().map(|m| json!({ "passes": range_of(&m.passes), "before": m.before }))
            .collect::<Vec<_>>(),
        "folded_clears": plan.order.folded.iter().map(|f| json!({ "clear": f.clear, "into": f.into }))
            .collect::<Vec<_>>(),
        "units": plan.units.iter().map(|u| json!({ "passes": u.passes, "causes": causes(&u.causes) })).collect::<Vec<_>>(),
        "resources": plan.objects.iter().enumerate().map(|(id, o)| resource(plan, id, o)).collect::<Vec<_>>(),
        "steps": plan.steps.iter().map(|s| json!({
            "path": s.path,
            "rate_hz": s.rate,
            "passes": range_of(&s.passes),
            "state": s.state,
        })).collect::<Vec<_>>(),
        "rings": plan.rings.iter().map(|r| json!({ "resources": r.objects, "turn": r.turn, "steps": r.steps }))
            .collect::<Vec<_>>(),
        "outputs": plan.outputs.iter().map(|o| json!({ "name": o.name, "resource": reference(plan, o.object) }))
            .collect::<Vec<_>>(),
        "names": plan.names.iter().map(|(name, object)| (name.clone(), reference(plan, *object)))
            .collect::<BTreeMap<_, _>>(),
        "uniforms": plan.uniforms.iter().map(|block| json!({
            "bytes": block.size,
            "members": block.members.iter().map(|m| json!({
                "name": &*m.name,
                "offset": m.offset,
                "type": m.ty.wgsl(),
                "value": match &m.value {
                    UniformValue::Known(value) => scalar(value),
                    UniformValue::Live(_) => Json::Null,
                },
                "live": matches!(m.value, UniformValue::Live(_)),
            })).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "memory": {
            "policy": plan.memory.policy.name(),
            "why": plan.memory.why.to_string(),
            "held_bytes": plan.memory.held(plan.memory.policy),
            "budget_bytes": plan.memory.budget,
            "inputs_and_state_bytes": plan.memory.outside,
            "keep": slots(&plan.memory.keep),
            "share": slots(&plan.memory.share),
            "smallest": slots(&plan.memory.smallest),
            "cuts": plan.memory.cuts.iter()
                .map(|cut| json!({ "before": cut.before, "gives": cut.gives, "makes": cut.makes }))
                .collect::<Vec<_>>(),
            "parts_bytes": plan.memory.parts,
            "unshared_bytes": plan.memory.unshared,
            "alike_live_sets_bytes": plan.memory.alike_bound,
            "largest_live_set_bytes": plan.memory.lower_bound,
            "largest_live_set_at": plan.memory.largest_at,
        },
        "statistics": plan.stats.iter().map(|s| json!({ "path": s.path, "expression": s.text, "missing": s.missing }))
            .collect::<Vec<_>>(),
        "argument_slots": plan.argument_slots,
        "needs": {
            "features": feature_names(plan.needs.features),
            "limits": plan.needs.limits.iter()
                .map(|(name, needed, default)| json!({ "name": name, "needed": needed, "default": default }))
                .collect::<Vec<_>>(),
        },
        "params": plan.params.iter().map(param).collect::<Vec<_>>(),
        "structural_params": plan.structural,
        "arithmetic_params": plan.arithmetic,
        "files": plan.taken.iter().map(|(name, path)| (name.clone(), path.display().to_string()))
            .collect::<BTreeMap<_, _>>(),
        "warnings": plan.warnings.iter().map(|d| json!({ "id": d.id.as_str(), "message": d.message }))
            .collect::<Vec<_>>(),
    })
}

fn pass(plan: &Plan, pass: &Pass) -> Json {
    let side = |wanted: &dyn Fn(&Access) -> bool| -> Vec<Json> {
        pass.accesses.iter().filter(|a| wanted(a)).map(|a| access(plan, a)).collect()
    };
    json!({
        "path": pass.path,
        "unit": pass.unit,
        "steps": pass.steps,
        "what": super::describe::pass(pass),
        "do": kind(plan, &pass.kind),
        "reads": side(&|a| a.read),
        "writes": side(&|a| a.write),
        "unordered": pass.unordered,
    })
}

fn access(plan: &Plan, access: &Access) -> Json {
    json!({
        "resource": reference(plan, access.object),
        "mips": range(&access.mips),
        "layers": range(&access.layers),
        "whole": access.whole,
    })
}

/// An object's number, or the place in a ring that turns.
fn reference(plan: &Plan, object: ObjectRef) -> Json {
    match object {
        ObjectRef::Fixed(id) => json!({ "id": id, "path": plan.objects[id].path }),
        ObjectRef::Ring { ring, index } => {
            json!({ "ring": ring, "index": index, "path": plan.objects[plan.rings[ring].objects[index]].path })
        }
    }
}

fn kind(plan: &Plan, kind: &PassKind) -> Json {
    match kind {
        PassKind::Compute { shader: used, dispatch } => json!({
            "kind": "compute",
            "shader": shader(plan, used),
            "groups": match dispatch { Dispatch::Groups(groups) => json!(groups), Dispatch::Indirect { .. } => Json::Null },
            "slot": match dispatch { Dispatch::Groups(_) => Json::Null, Dispatch::Indirect { slot } => json!(slot) },
        }),
        PassKind::Draw(draw) => draw_kind(plan, draw),
        PassKind::Clear { view: of, value } => json!({ "kind": "clear", "of": view(plan, of), "value": value }),
        PassKind::Copy { from, to } => json!({ "kind": "copy", "from": view(plan, from), "to": view(plan, to) }),
        PassKind::Mips { texture } => json!({ "kind": "mips", "of": reference(plan, *texture) }),
        PassKind::Settle { counted, arguments } => json!({
            "kind": "settle",
            "of": reference(plan, *counted),
            "arguments": arguments.iter().map(argument).collect::<Vec<_>>(),
        }),
        PassKind::Arguments { from, offset, indexed, slot } => json!({
            "kind": "arguments",
            "from": reference(plan, *from),
            "offset": offset,
            "indexed": indexed,
            "slot": slot,
        }),
    }
}

fn argument(argument: &Argument) -> Json {
    match &argument.kind {
        ArgumentKind::Dispatch { threads } => json!({ "slot": argument.slot, "kind": "dispatch", "threads": threads }),
        ArgumentKind::Draw { vertices, instances, indexed } => json!({
            "slot": argument.slot,
            "kind": "draw",
            "vertices": vertices,
            "instances": instances,
            "indexed": indexed,
        }),
    }
}

fn draw_kind(plan: &Plan, draw: &Draw) -> Json {
    let geometry = match &draw.geometry {
        Geometry::Fullscreen => json!({ "kind": "fullscreen" }),
        Geometry::Direct { vertices, instances } => {
            json!({ "kind": "direct", "vertices": vertices, "instances": instances })
        }
        Geometry::Indexed { indices, count, instances } => json!({
            "kind": "indexed",
            "indices": reference(plan, *indices),
            "count": count,
            "instances": instances,
        }),
        Geometry::Indirect { slot, indices } => json!({
            "kind": "indirect",
            "slot": slot,
            "indices": indices.map(|object| reference(plan, object)),
        }),
        Geometry::Meshes(meshes) => json!({
            "kind": "meshes",
            "input": meshes.input,
            "indices": reference(plan, meshes.indices),
            "vertices": meshes.vertices.iter().map(|v| json!({
                "location": v.location,
                "attribute": v.attribute.name(),
                "buffer": v.buffer.map(|object| reference(plan, object)),
            })).collect::<Vec<_>>(),
            "draws": meshes.draws.iter().map(|d| json!({
                "first_index": d.first_index,
                "indices": d.indices,
                "first_instance": d.first_instance,
                "instances": d.instances,
                "material": d.material,
                "double_sided": d.faces.double_sided,
                "mirrored": d.faces.mirrored,
                "blended": d.blended,
                "tags": d.tags,
            })).collect::<Vec<_>>(),
        }),
    };
    let color = |target: &crate::plan::model::ColorTarget| {
        json!({
            "to": view(plan, &target.view),
            "format": format::name(target.format),
            "clear": target.clear,
            "loads": target.clear.is_none() && !target.discard_before,
            "blend": target.blend.map(|blend| format!("{blend:?}")),
            "write": target.write,
            "resolve": target.resolve.as_ref().map(|to| view(plan, to)),
        })
    };
    json!({
        "kind": "draw",
        "shader": shader(plan, &draw.shader),
        "geometry": geometry,
        "topology": format!("{:?}", draw.topology),
        "cull": draw.cull.map(|face| format!("{face:?}")),
        "front": if draw.front_ccw { "Ccw" } else { "Cw" },
        "color": draw.color.iter().map(color).collect::<Vec<_>>(),
        "depth": draw.depth.as_ref().map(|depth| json!({
            "to": view(plan, &depth.view),
            "format": format::name(depth.format),
            "compare": format!("{:?}", depth.compare),
            "write": depth.write,
            "clear": depth.clear,
            "bias": [f64::from(depth.bias.0), f64::from(depth.bias.1)],
            "stencil": depth.stencil.as_ref().map(|stencil| format!("{stencil:?}")),
        })),
        "samples": draw.samples,
        "region": draw.region,
        "extent": draw.extent,
    })
}

fn shader(plan: &Plan, used: &ShaderUse) -> Json {
    json!({
        "file": plan.modules.get(used.module).map(|module| module.path.display().to_string()),
        "compute": used.compute,
        "vertex": used.vertex,
        "fragment": used.fragment,
        "constants": used.constants.iter().cloned().collect::<BTreeMap<String, f64>>(),
        "bindings": used.bindings.iter().map(|b| binding(plan, b)).collect::<Vec<_>>(),
    })
}

fn binding(plan: &Plan, binding: &Binding) -> Json {
    let bound = match &binding.bound {
        Bound::Uniform { block } => json!({ "kind": "uniform", "block": block }),
        Bound::UniformBuffer { buffer } => json!({ "kind": "uniform buffer", "resource": reference(plan, *buffer) }),
        Bound::Storage { buffer, writable } => {
            json!({ "kind": "storage", "resource": reference(plan, *buffer), "writable": writable })
        }
        Bound::Texture { view: of, sample, filtered, multisampled } => json!({
            "kind": "texture",
            "view": view(plan, of),
            "sample": format!("{sample:?}"),
            "filtered": filtered,
            "multisampled": multisampled,
        }),
        Bound::StorageTexture { view: of, format, read, write } => json!({
            "kind": "storage texture",
            "view": view(plan, of),
            "format": format::name(*format),
            "read": read,
            "write": write,
        }),
        Bound::Sampler { sampler } => {
            json!({ "kind": "sampler", "sampler": plan.samplers.get(*sampler).map(|s| s.name.value.clone()) })
        }
        Bound::Material { buffer, bytes } => {
            json!({ "kind": "material", "resource": reference(plan, *buffer), "bytes": bytes })
        }
        Bound::MaterialTexture { input, texture } => {
            json!({ "kind": "material texture", "input": input, "texture": texture.stem() })
        }
        Bound::MaterialSampler { input, texture } => {
            json!({ "kind": "material sampler", "input": input, "texture": texture.stem() })
        }
    };
    json!({ "name": &*binding.name, "binding": binding.binding, "bound": bound })
}

fn view(plan: &Plan, view: &View) -> Json {
    json!({
        "resource": reference(plan, view.object),
        "mips": range(&view.mips),
        "layers": range(&view.layers),
        "dimension": format!("{:?}", view.dimension),
    })
}

fn resource(plan: &Plan, id: usize, object: &Object) -> Json {
    let description = match &object.kind {
        ObjectKind::Texture(t) => json!({
            "kind": "texture",
            "format": format::name(t.format),
            "width": t.width,
            "height": t.height,
            "layers": if t.is_3d { 1 } else { t.layers },
            "depth": if t.is_3d { t.layers } else { 1 },
            "mips": t.mips,
            "samples": t.samples,
            "usages": t.usages.iter_names().map(|(name, _)| name.to_ascii_lowercase()).collect::<Vec<_>>(),
        }),
        ObjectKind::Buffer(b) => json!({
            "kind": if b.counted { "counted" } else { "buffer" },
            "items": b.items,
            "stride": b.stride,
            "header": b.header,
            "item": b.item.as_ref().map(|item| item.wgsl()),
            "usages": b.usages.iter_names().map(|(name, _)| name.to_ascii_lowercase()).collect::<Vec<_>>(),
        }),
    };
    let origin = match &object.origin {
        Origin::Frame => json!({ "kind": "frame" }),
        Origin::State(steps) => json!({ "kind": "state", "steps": steps }),
        Origin::Input(input) => json!({ "kind": "input", "input": input }),
        Origin::Attribute { input, attribute, present } => {
            json!({ "kind": "attribute", "input": input, "attribute": attribute, "present": present })
        }
        Origin::Mesh { input, buffer } => json!({ "kind": "mesh", "input": input, "buffer": buffer.name() }),
    };
    let slot = |slots: &[Slot]| slots.iter().position(|slot| slot.objects.contains(&id));
    json!({
        "path": object.path,
        "description": description,
        "bytes": memory::bytes(&object.kind),
        "origin": origin,
        "lifetime": object.lifetime.map(|(first, last)| [first, last]),
        "keep_slot": slot(&plan.memory.keep),
        "transient": plan.memory.unstored.contains(&id),
        "share_slot": slot(&plan.memory.share),
        "smallest_slot": slot(&plan.memory.smallest),
    })
}

fn causes(causes: &Causes) -> Json {
    json!({
        "inputs": causes.inputs,
        "frame": causes.live,
        "params": causes.params,
        "viewport": causes.viewport,
    })
}

fn slots(slots: &[Slot]) -> Json {
    slots.iter().map(|slot| json!({ "bytes": slot.bytes, "resources": slot.objects })).collect()
}

fn param(param: &Param) -> Json {
    json!({
        "path": param.path,
        "kind": param.kind.name(),
        "value": scalar(&param.value),
        "default": param.default.as_ref().map(scalar),
        "min": param.min.as_ref().map(scalar),
        "max": param.max.as_ref().map(scalar),
        "unit": param.unit,
        "about": param.about,
    })
}

fn scalar(value: &Value) -> Json {
    match value {
        Value::Int(n) => json!(n),
        Value::Float(x) => json!(x),
        Value::Bool(b) => json!(b),
        Value::Word(word) => json!(word),
        Value::Vector(components) => components.iter().map(|component| scalar(&component)).collect(),
    }
}

fn range(range: &Range<u32>) -> [u32; 2] {
    [range.start, range.end]
}

fn range_of(range: &Range<usize>) -> [usize; 2] {
    [range.start, range.end]
}
