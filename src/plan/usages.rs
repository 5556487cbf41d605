//! What the engine itself does with memory that somebody hands in, so that they know what to make it for: clearing,
//! copying, settling counts, making mips.

use wgpu_types::{BufferUsages, Features, TextureUsages};

use super::model::{ObjectKind, ObjectRef, Origin, PassKind, Plan, Texture};
use crate::format;

/// What is done with an object.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Use {
    CopiedFrom,
    CopiedTo,
    /// To zero, if it is a buffer, or to a word.
    Cleared {
        to_zero: bool,
    },
    Settled,
    Mips,
}

/// Adds the usages to what comes from outside. The engine's own memory is made for all of it anyway.
pub(super) fn of_the_engine(plan: &mut Plan, features: Features) {
    let mut uses: Vec<(ObjectRef, Use)> = Vec::new();
    for pass in &plan.passes {
        match &pass.kind {
            PassKind::Copy { from, to } => uses.extend([(from.object, Use::CopiedFrom), (to.object, Use::CopiedTo)]),
            PassKind::Clear { view, value } => uses.push((view.object, Use::Cleared { to_zero: value[0] == 0.0 })),
            PassKind::Settle { counted, .. } => uses.push((*counted, Use::Settled)),
            PassKind::Mips { texture } => uses.push((*texture, Use::Mips)),
            PassKind::Arguments { from, .. } => uses.push((*from, Use::CopiedFrom)),
            PassKind::Compute { .. } | PassKind::Draw(_) => {}
        }
    }
    for (object, used) in uses {
        // Members of rings are state, which nobody hands in.
        let ObjectRef::Fixed(id) = object else { continue };
        let object = &mut plan.objects[id];
        if matches!(object.origin, Origin::Frame | Origin::State(_)) {
            continue;
        }
        match &mut object.kind {
            ObjectKind::Buffer(buffer) => buffer.usages |= of_buffer(used),
            ObjectKind::Texture(texture) => texture.usages |= of_texture(texture, used, features),
        }
    }
}

fn of_buffer(used: Use) -> BufferUsages {
    match used {
        Use::CopiedFrom => BufferUsages::COPY_SRC,
        Use::CopiedTo | Use::Cleared { to_zero: true } => BufferUsages::COPY_DST,
        Use::Cleared { to_zero: false } | Use::Settled => BufferUsages::STORAGE,
        Use::Mips => BufferUsages::empty(),
    }
}

fn of_texture(texture: &Texture, used: Use, features: Features) -> TextureUsages {
    let is_target = !texture.is_3d && format::is_renderable(texture.format, features);
    match used {
        Use::CopiedFrom => TextureUsages::COPY_SRC,
        Use::CopiedTo => TextureUsages::COPY_DST,
        Use::Cleared { .. } if is_target => TextureUsages::RENDER_ATTACHMENT,
        Use::Cleared { .. } => TextureUsages::COPY_DST,
        Use::Mips if is_target => TextureUsages::TEXTURE_BINDING | TextureUsages::RENDER_ATTACHMENT,
        Use::Mips => TextureUsages::TEXTURE_BINDING | TextureUsages::STORAGE_BINDING,
        Use::Settled => TextureUsages::empty(),
    }
}
