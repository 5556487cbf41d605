//! Draws. One of nothing still clears its targets.

use wgpu_types as wgt;

use super::{Encoding, render_pipeline};
use crate::engine::bind::DrawVariant;
use crate::engine::pipeline::Pipeline;
use crate::plan::model::{ColorTarget, DepthTarget, Draw, Geometry, Pass};

pub(super) fn encode(
    encoding: &mut Encoding<'_>,
    pass: &Pass,
    draw: &Draw,
    pipeline: Option<&Pipeline>,
    variant: &DrawVariant,
) {
    let Some(pipeline) = render_pipeline(pipeline) else { return };
    let colors: Vec<_> = draw
        .color
        .iter()
        .zip(&variant.color)
        .map(|(target, (view, resolve))| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: resolve.as_ref(),
                ops: wgt::Operations { load: load(target, encoding.loads_are_free), store: wgt::StoreOp::Store },
            })
        })
        .collect();
    let depth = draw.depth.as_ref().zip(variant.depth.as_ref());
    let mut render = encoding.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(&pass.path),
        color_attachments: &colors,
        depth_stencil_attachment: depth.map(|(target, view)| depth_attachment(target, view)),
        timestamp_writes: encoding.timing.render(encoding.pair, true, true),
        ..wgpu::RenderPassDescriptor::default()
    });
    if let Some([x, y, width, height]) = draw.region {
        if width == 0 || height == 0 {
            return;
        }
        render.set_viewport(x as f32, y as f32, width as f32, height as f32, 0.0, 1.0);
        render.set_scissor_rect(x, y, width, height);
    }
    render.set_pipeline(pipeline);
    if variant.group.is_some() {
        render.set_bind_group(0, variant.group.as_ref(), &[]);
    }
    if let Some(stencil) = draw.depth.as_ref().and_then(|d| d.stencil.as_ref()) {
        render.set_stencil_reference(stencil.reference);
    }
    if let Some(indices) = &variant.indices {
        render.set_index_buffer(indices.slice(..), wgt::IndexFormat::Uint32);
    }
    geometry(&mut render, &draw.geometry, &encoding.fixed.arguments);
}

fn geometry(render: &mut wgpu::RenderPass<'_>, geometry: &Geometry, arguments: &wgpu::Buffer) {
    match *geometry {
        Geometry::Fullscreen => render.draw(0..3, 0..1),
        Geometry::Direct { vertices, instances } if vertices > 0 && instances > 0 => {
            render.draw(0..vertices, 0..instances);
        }
        Geometry::Indexed { count, instances, .. } if count > 0 && instances > 0 => {
            render.draw_indexed(0..count, 0, 0..instances);
        }
        Geometry::Direct { .. } | Geometry::Indexed { .. } => {}
        Geometry::Indirect { slot, indices: None } => render.draw_indirect(arguments, u64::from(slot) * 32),
        Geometry::Indirect { slot, indices: Some(_) } => {
            render.draw_indexed_indirect(arguments, u64::from(slot) * 32);
        }
    }
}

fn load(target: &ColorTarget, loads_are_free: bool) -> wgt::LoadOp<wgt::Color> {
    match target.clear {
        Some([r, g, b, a]) => wgt::LoadOp::Clear(wgt::Color { r, g, b, a }),
        None if target.discard_before && !loads_are_free => wgt::LoadOp::Clear(wgt::Color::TRANSPARENT),
        None => wgt::LoadOp::Load,
    }
}

/// Aspects that the draw does not write are read only, so that the pass may sample them.
fn depth_attachment<'a>(
    target: &DepthTarget,
    view: &'a wgpu::TextureView,
) -> wgpu::RenderPassDepthStencilAttachment<'a> {
    let store = wgt::StoreOp::Store;
    let depth = target.format.has_depth_aspect() && (target.write || target.clear.is_some());
    let stencil = target.stencil.as_ref().filter(|s| s.write_mask != 0 || s.clear.is_some());
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: depth
            .then(|| wgt::Operations { load: target.clear.map_or(wgt::LoadOp::Load, wgt::LoadOp::Clear), store }),
        stencil_ops: stencil
            .filter(|_| target.format.has_stencil_aspect())
            .map(|s| wgt::Operations { load: s.clear.map_or(wgt::LoadOp::Load, wgt::LoadOp::Clear), store }),
    }
}
