//! What a pass is, as a number: equal for passes that do the same to things of the same names,
//! also where two plans number their objects, modules, blocks and slots differently.

use std::collections::HashMap;
use std::fmt::Write as _;

use wgpu_types::{BufferUsages, TextureUsages};

use super::objects;
use crate::graph::expr::{Expr, ExprKind};
use crate::plan::model::{
    Bound, ObjectId, ObjectKind, ObjectRef, Pass, PassKind, Plan, ShaderUse, UniformBlock, UniformValue, each_ref,
};

/// For each pass of a plan.
pub(super) fn passes(plan: &Plan) -> Vec<u128> {
    let blocks: Vec<String> = plan.uniforms.iter().map(block).collect();
    let shapes: Vec<String> = (0..plan.objects.len()).map(|id| shape(plan, id)).collect();
    let counts = counts(plan);
    let print = |pass: &Pass| {
        let mut text = text(plan, pass, &blocks, &shapes);
        text.extend(pass.kind.slot().and_then(|slot| counts.get(&slot)).into_iter().map(String::as_str));
        twox_hash::XxHash3_128::oneshot(text.as_bytes())
    };
    plan.passes.iter().map(print).collect()
}

/// What each slot's arguments follow from: that is of those who draw by them, and not of who settles.
fn counts(plan: &Plan) -> HashMap<u32, String> {
    let mut counts = HashMap::new();
    for pass in &plan.passes {
        if let PassKind::Settle { counted, arguments } = &pass.kind {
            let names: String = objects(plan, counted).iter().map(|id| plan.objects[*id].path.as_str()).collect();
            counts.extend(arguments.iter().map(|argument| (argument.slot, format!("|{names} {:?}", argument.kind))));
        }
    }
    counts
}

/// The pass with the things that it names by number spelt out behind it.
fn text(plan: &Plan, pass: &Pass, blocks: &[String], shapes: &[String]) -> String {
    let mut kind = pass.kind.clone();
    let mut named = String::new();
    if let Some(steps) = pass.steps {
        named.push_str(&plan.steps[steps].path);
    }
    each_ref(&mut kind, &mut |object| {
        for id in objects(plan, object) {
            named.push_str(&shapes[id]);
        }
        *object = match *object {
            ObjectRef::Fixed(_) => ObjectRef::Fixed(0),
            ObjectRef::Ring { index, .. } => ObjectRef::Ring { ring: 0, index },
        };
    });
    kind.slot_mut().into_iter().for_each(|slot| *slot = 0);
    match &mut kind {
        PassKind::Compute { shader: used, .. } => shader(plan, used, blocks, &mut named),
        PassKind::Draw(draw) => shader(plan, &mut draw.shader, blocks, &mut named),
        // Whom it writes arguments for is nothing to those who read the count: see `counts` and `Answers`.
        PassKind::Settle { arguments, .. } => arguments.clear(),
        PassKind::Arguments { slot, .. } => *slot = 0,
        PassKind::Clear { .. } | PassKind::Copy { .. } | PassKind::Mips { .. } => {}
    }
    format!("{kind:?}{named}")
}

fn shader(plan: &Plan, shader: &mut ShaderUse, blocks: &[String], named: &mut String) {
    _ = write!(named, "{:x}", plan.modules.get(shader.module).map_or(0, |module| module.hash));
    shader.module = 0;
    for binding in &mut shader.bindings {
        match &mut binding.bound {
            Bound::Uniform { block } => {
                named.push_str(blocks.get(*block).map_or("", String::as_str));
                *block = 0;
            }
            Bound::Sampler { sampler } => {
                if let Some(s) = plan.samplers.get(*sampler) {
                    _ = write!(named, "{:?}", (s.linear, s.mip_linear, &s.address, &s.compare, s.anisotropy));
                }
                *sampler = 0;
            }
            _ => {}
        }
    }
}

/// An object's name and what it is, whoever else uses it.
fn shape(plan: &Plan, id: ObjectId) -> String {
    let object = &plan.objects[id];
    let kind = match object.kind.clone() {
        ObjectKind::Texture(mut texture) => {
            texture.usages = TextureUsages::empty();
            ObjectKind::Texture(texture)
        }
        ObjectKind::Buffer(mut buffer) => {
            buffer.usages = BufferUsages::empty();
            ObjectKind::Buffer(buffer)
        }
    };
    format!("|{} {kind:?}", object.path)
}

fn block(block: &UniformBlock) -> String {
    let mut text = format!("|{}", block.size);
    for member in &block.members {
        _ = write!(text, ";{} {} {:?} ", member.name, member.offset, member.ty);
        match &member.value {
            UniformValue::Known(value) => _ = write!(text, "{value:?}"),
            UniformValue::Live(expr) => expression(expr, &mut text),
        }
    }
    text
}

/// An expression without its places in the file.
fn expression(expr: &Expr, out: &mut String) {
    let mut list = |what: &dyn std::fmt::Debug, parts: &[&Expr]| {
        _ = write!(out, "({what:?}");
        for part in parts {
            out.push(' ');
            expression(part, out);
        }
        out.push(')');
    };
    match &expr.kind {
        ExprKind::Literal(value) => list(value, &[]),
        ExprKind::Name(name) => list(name, &[]),
        ExprKind::Component(inner, c) => list(c, &[inner]),
        ExprKind::Unary(op, inner) => list(op, &[inner]),
        ExprKind::Binary(op, a, b) => list(op, &[a, b]),
        ExprKind::Call(function, parts) => list(function, &parts.iter().collect::<Vec<_>>()),
        ExprKind::Item(of, index, members) => list(members, &[of, index]),
        ExprKind::Vector(parts) => list(&"vector", &parts.iter().collect::<Vec<_>>()),
    }
}
