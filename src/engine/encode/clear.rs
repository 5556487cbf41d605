//! Clears.

use wgpu_types as wgt;

use super::{Encoding, compute_pipeline};
use crate::engine::clear::{ClearVariant, Slice};
use crate::engine::pipeline::Pipeline;
use crate::plan::model::{Pass, View};

pub(super) fn encode(
    encoding: &mut Encoding<'_, '_>,
    pass: &Pass,
    view: &View,
    pipeline: Option<&Pipeline>,
    variant: &ClearVariant,
) {
    let object = encoding.object(view.object);
    match variant {
        ClearVariant::Color { views, value } => {
            for (at, view) in views.iter().enumerate() {
                color(encoding, pass, view, *value, (at == 0, at + 1 == views.len()));
            }
        }
        ClearVariant::Depth { views, depth: d, stencil } => {
            for (at, view) in views.iter().enumerate() {
                depth(encoding, pass, view, (*d, *stencil), (at == 0, at + 1 == views.len()));
            }
        }
        ClearVariant::Texels { source, row, slices } => {
            let Some(texture) = encoding.pool.texture(object) else { return };
            encoding.between(pass, |encoder| texels(encoder, texture, source, *row, slices));
        }
        ClearVariant::Zero { bytes } => {
            let Some(buffer) = encoding.pool.buffer(object) else { return };
            encoding.between(pass, |encoder| encoder.clear_buffer(buffer, 0, Some(*bytes)));
        }
        ClearVariant::Words { group, groups } => {
            let Some(pipeline) = compute_pipeline(pipeline) else { return };
            encoding.dispatches(pass, (true, true), |compute| {
                compute.set_pipeline(pipeline);
                compute.set_bind_group(0, group, &[]);
                compute.dispatch_workgroups(groups[0], groups[1], 1);
            });
        }
    }
}

fn color(
    encoding: &mut Encoding<'_, '_>,
    pass: &Pass,
    view: &wgpu::TextureView,
    value: wgt::Color,
    (first, last): (bool, bool),
) {
    let ops = wgt::Operations { load: wgt::LoadOp::Clear(value), store: wgt::StoreOp::Store };
    encoding.recorder.render(&wgpu::RenderPassDescriptor {
        label: Some(&pass.path),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops,
        })],
        timestamp_writes: encoding.timing.render(encoding.pair, first, last),
        ..wgpu::RenderPassDescriptor::default()
    });
}

fn depth(
    encoding: &mut Encoding<'_, '_>,
    pass: &Pass,
    view: &wgpu::TextureView,
    (depth, stencil): (Option<f32>, Option<u32>),
    (first, last): (bool, bool),
) {
    let store = wgt::StoreOp::Store;
    encoding.recorder.render(&wgpu::RenderPassDescriptor {
        label: Some(&pass.path),
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view,
            depth_ops: depth.map(|d| wgt::Operations { load: wgt::LoadOp::Clear(d), store }),
            stencil_ops: stencil.map(|s| wgt::Operations { load: wgt::LoadOp::Clear(s), store }),
        }),
        timestamp_writes: encoding.timing.render(encoding.pair, first, last),
        ..wgpu::RenderPassDescriptor::default()
    });
}

fn texels(
    encoder: &mut wgpu::CommandEncoder,
    texture: &wgpu::Texture,
    source: &wgpu::Buffer,
    row: u32,
    slices: &[Slice],
) {
    for slice in slices {
        let [width, height] = slice.extent;
        encoder.copy_buffer_to_texture(
            wgpu::TexelCopyBufferInfo {
                buffer: source,
                layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None },
            },
            wgpu::TexelCopyTextureInfo {
                texture,
                mip_level: slice.mip,
                origin: wgpu::Origin3d { x: 0, y: 0, z: slice.layer },
                aspect: wgpu::TextureAspect::All,
            },
            wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        );
    }
}
