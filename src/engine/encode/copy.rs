//! Copies: mip by mip between textures, whole buffers.

use std::ops::Range;

use super::Encoding;
use crate::engine::pool::Memory;
use crate::plan::model::{ObjectKind, Pass, View};

pub(super) fn encode(encoding: &mut Encoding<'_, '_>, pass: &Pass, from: &View, to: &View) {
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

/// One mip and layer at a time: wgpu 30.0.1 panics where the layers of one copy were last used
/// in more than two ways.
fn textures(encoder: &mut wgpu::CommandEncoder, from: (&wgpu::Texture, &View), to: (&wgpu::Texture, &View)) {
    for (mip, into) in from.1.mips.clone().zip(to.1.mips.clone()) {
        for (layer, onto) in layers(from).zip(layers(to)) {
            let (source, first) = place(from.0, mip, layer);
            let (target, second) = place(to.0, into, onto);
            let extent = wgpu::Extent3d {
                width: first.width.min(second.width),
                height: first.height.min(second.height),
                depth_or_array_layers: first.depth_or_array_layers.min(second.depth_or_array_layers),
            };
            encoder.copy_texture_to_texture(source, target, extent);
        }
    }
}

/// The view's layers; a volume is one.
fn layers((texture, view): (&wgpu::Texture, &View)) -> Range<u32> {
    if texture.dimension() == wgpu::TextureDimension::D3 { 0..1 } else { view.layers.clone() }
}

/// Where a layer of a mip begins, and how large it is.
fn place(texture: &wgpu::Texture, mip: u32, layer: u32) -> (wgpu::TexelCopyTextureInfo<'_>, wgpu::Extent3d) {
    let volume = texture.dimension() == wgpu::TextureDimension::D3;
    let info = wgpu::TexelCopyTextureInfo {
        texture,
        mip_level: mip,
        origin: wgpu::Origin3d { x: 0, y: 0, z: layer },
        aspect: wgpu::TextureAspect::All,
    };
    let extent = wgpu::Extent3d {
        width: (texture.width() >> mip).max(1),
        height: (texture.height() >> mip).max(1),
        depth_or_array_layers: if volume { (texture.depth_or_array_layers() >> mip).max(1) } else { 1 },
    };
    (info, extent)
}
