//! Copies: mip by mip between textures, whole buffers.

use super::Encoding;
use crate::engine::pool::Memory;
use crate::plan::model::{ObjectKind, Pass, View};

pub(super) fn encode(encoding: &mut Encoding<'_>, pass: &Pass, from: &View, to: &View) {
    let (source, target) = (encoding.object(from.object), encoding.object(to.object));
    let (plan, pool) = (encoding.plan, encoding.pool);
    match (pool.memory(source), pool.memory(target)) {
        (Some(Memory::Texture(a)), Some(Memory::Texture(b))) => {
            encoding.between(pass, |encoder| textures(encoder, (a, from), (b, to)));
        }
        (Some(Memory::Buffer(a)), Some(Memory::Buffer(b))) => {
            let bytes = |id: usize| match &plan.objects[id].kind {
                ObjectKind::Buffer(buffer) => buffer.bytes(),
                ObjectKind::Texture(_) => 0,
            };
            let length = bytes(source).min(bytes(target));
            encoding.between(pass, |encoder| encoder.copy_buffer_to_buffer(a, 0, b, 0, length));
        }
        // The language copies like to like.
        _ => debug_assert!(false, "a copy between a texture and a buffer"),
    }
}

fn textures(encoder: &mut wgpu::CommandEncoder, from: (&wgpu::Texture, &View), to: (&wgpu::Texture, &View)) {
    for (mip, into) in from.1.mips.clone().zip(to.1.mips.clone()) {
        let (source, first) = place(from, mip);
        let (target, second) = place(to, into);
        let extent = wgpu::Extent3d {
            width: first.width.min(second.width),
            height: first.height.min(second.height),
            depth_or_array_layers: first.depth_or_array_layers.min(second.depth_or_array_layers),
        };
        encoder.copy_texture_to_texture(source, target, extent);
    }
}

/// Where the view's part of a mip begins, and how large it is.
fn place<'a>(
    (texture, view): (&'a wgpu::Texture, &View),
    mip: u32,
) -> (wgpu::TexelCopyTextureInfo<'a>, wgpu::Extent3d) {
    let volume = texture.dimension() == wgpu::TextureDimension::D3;
    let depth = if volume { (texture.depth_or_array_layers() >> mip).max(1) } else { view.layers.len() as u32 };
    let info = wgpu::TexelCopyTextureInfo {
        texture,
        mip_level: mip,
        origin: wgpu::Origin3d { x: 0, y: 0, z: if volume { 0 } else { view.layers.start } },
        aspect: wgpu::TextureAspect::All,
    };
    let extent = wgpu::Extent3d {
        width: (texture.width() >> mip).max(1),
        height: (texture.height() >> mip).max(1),
        depth_or_array_layers: depth,
    };
    (info, extent)
}
