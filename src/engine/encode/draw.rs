//! Draws. One of nothing still clears its targets.

use wgpu_types as wgt;

use super::{Encoding, render_pipeline};
use crate::engine::bind::DrawVariant;
use crate::engine::meshes;
use crate::engine::pipeline::Pipeline;
use crate::plan::model::{ColorTarget, DepthTarget, Draw, Geometry, Pass};

/// A draw of a render pass.
pub(in crate::engine) struct Part<'a> {
    pub pass: &'a Pass,
    pub draw: &'a Draw,
    pub pipeline: Option<&'a Pipeline>,
    pub variant: &'a DrawVariant,
}

/// Encodes draws that share their targets as one render pass: it loads as the first says, and
/// resolves and stores for all.
pub(in crate::engine) fn encode(encoding: &mut Encoding<'_>, parts: &[Part<'_>]) {
    let (Some(first), Some(last)) = (parts.first(), parts.last()) else { return };
    let free = encoding.loads_are_free;
    let colors: Vec<_> = first
        .draw
        .color
        .iter()
        .zip(first.variant.color.iter().zip(&last.variant.color))
        .map(|(target, ((view, _), (_, resolve)))| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: resolve.as_ref(),
                ops: wgt::Operations { load: load(target, free), store: wgt::StoreOp::Store },
            })
        })
        .collect();
    let depth = first.draw.depth.as_ref().zip(first.variant.depth.as_ref());
    let mut render = encoding.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(&first.pass.path),
        color_attachments: &colors,
        depth_stencil_attachment: depth.map(|(target, view)| depth_attachment(target, view, parts)),
        timestamp_writes: encoding.timing.render(encoding.pair, true, true),
        ..wgpu::RenderPassDescriptor::default()
    });
    let mut in_region = false;
    for part in parts {
        if parts.len() > 1 {
            render.push_debug_group(&part.pass.path);
        }
        if part.draw.region.is_some() || in_region {
            in_region = part.draw.region.is_some();
            region(&mut render, part.draw);
        }
        if !matches!(part.draw.region, Some([_, _, 0, _] | [_, _, _, 0])) {
            draw(&mut render, part, &encoding.fixed.arguments);
        }
        if parts.len() > 1 {
            render.pop_debug_group();
        }
    }
}

fn region(render: &mut wgpu::RenderPass<'_>, draw: &Draw) {
    let [x, y, width, height] = draw.region.unwrap_or([0, 0, draw.extent[0], draw.extent[1]]);
    if width > 0 && height > 0 {
        render.set_viewport(x as f32, y as f32, width as f32, height as f32, 0.0, 1.0);
        render.set_scissor_rect(x, y, width, height);
    }
}

fn draw(render: &mut wgpu::RenderPass<'_>, part: &Part<'_>, arguments: &wgpu::Buffer) {
    let Some(pipeline) = render_pipeline(part.pipeline) else { return };
    render.set_pipeline(pipeline);
    if part.variant.group.is_some() {
        render.set_bind_group(0, part.variant.group.as_ref(), &[]);
    }
    if let Some(stencil) = part.draw.depth.as_ref().and_then(|d| d.stencil.as_ref()) {
        render.set_stencil_reference(stencil.reference);
    }
    if let Some(indices) = &part.variant.indices {
        render.set_index_buffer(indices.slice(..), wgt::IndexFormat::Uint32);
    }
    match &part.variant.meshes {
        Some(variant) => meshes::encode(render, part.draw, variant),
        None => geometry(render, &part.draw.geometry, arguments),
    }
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
        Geometry::Direct { .. } | Geometry::Indexed { .. } | Geometry::Meshes(_) => {}
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

/// Aspects that no draw writes are read only, so that the pass may sample them.
fn depth_attachment<'a>(
    target: &DepthTarget,
    view: &'a wgpu::TextureView,
    parts: &[Part<'_>],
) -> wgpu::RenderPassDepthStencilAttachment<'a> {
    let store = wgt::StoreOp::Store;
    let all = || parts.iter().filter_map(|p| p.draw.depth.as_ref());
    let depth = target.format.has_depth_aspect() && all().any(|d| d.write || d.clear.is_some());
    let stencil = target.format.has_stencil_aspect()
        && all().filter_map(|d| d.stencil.as_ref()).any(|s| s.write_mask != 0 || s.clear.is_some());
    let clear = target.stencil.as_ref().and_then(|s| s.clear);
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: depth
            .then(|| wgt::Operations { load: target.clear.map_or(wgt::LoadOp::Load, wgt::LoadOp::Clear), store }),
        stencil_ops: stencil
            .then(|| wgt::Operations { load: clear.map_or(wgt::LoadOp::Load, wgt::LoadOp::Clear), store }),
    }
}
