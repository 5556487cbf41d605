//! Draws. One of nothing still clears its targets.

use wgpu_types as wgt;

use super::{Encoding, render_pipeline};
use crate::engine::bind::DrawVariant;
use crate::engine::meshes;
use crate::engine::pipeline::Pipeline;
use crate::plan::model::{ColorTarget, DepthTarget, Draw, Geometry, Pass};

/// A draw of a render pass.
#[derive(Clone, Copy)]
pub(in crate::engine) struct Part<'a> {
    pub pass: &'a Pass,
    pub draw: &'a Draw,
    pub pipeline: Option<&'a Pipeline>,
    pub variant: &'a DrawVariant,
}

/// As many as wgpu allows.
const MOST_TARGETS: usize = 8;

/// Encodes draws that share their targets as one render pass: it loads as the first says, and
/// resolves and stores for all.
pub(in crate::engine) fn encode<'a>(encoding: &mut Encoding<'_, '_>, parts: impl Iterator<Item = Part<'a>> + Clone) {
    let (Some(first), Some(last)) = (parts.clone().next(), parts.clone().last()) else { return };
    let count = parts.clone().count();
    let (timing, pair, named) = (encoding.timing, encoding.pair, encoding.recorder.named && count > 1);
    let mut colors = [const { None }; MOST_TARGETS];
    let targets = attachments(&first, &last, encoding.loads_are_free);
    let filled = colors.iter_mut().zip(targets).map(|(place, color)| *place = Some(color)).count();
    let depth = first.draw.depth.as_ref().zip(first.variant.depth.as_ref());
    let mut render = encoding.recorder.render(&wgpu::RenderPassDescriptor {
        label: Some(&first.pass.path),
        color_attachments: &colors[..filled],
        depth_stencil_attachment: depth.map(|(target, view)| depth_attachment(target, view, parts.clone())),
        timestamp_writes: timing.render_of(pair, count),
        ..wgpu::RenderPassDescriptor::default()
    });
    let mut in_region = false;
    for (nth, part) in parts.enumerate() {
        timing.write_between_draws(&mut render, pair, nth);
        if named {
            render.push_debug_group(&part.pass.path);
        }
        if part.draw.region.is_some() || in_region {
            in_region = part.draw.region.is_some();
            region(&mut render, part.draw);
        }
        if !matches!(part.draw.region, Some([_, _, 0, _] | [_, _, _, 0])) {
            draw(&mut render, &part, &encoding.fixed.arguments);
        }
        if named {
            render.pop_debug_group();
        }
    }
}

fn attachments<'a>(
    first: &Part<'a>,
    last: &Part<'a>,
    loads_are_free: bool,
) -> impl Iterator<Item = wgpu::RenderPassColorAttachment<'a>> {
    let views = first.variant.color.iter().zip(&last.variant.color);
    first.draw.color.iter().zip(views).map(move |(target, ((view, _), (_, resolve)))| wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: resolve.as_ref(),
        ops: wgt::Operations { load: load(target, loads_are_free), store: wgt::StoreOp::Store },
    })
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
    parts: impl Iterator<Item = Part<'a>> + Clone,
) -> wgpu::RenderPassDepthStencilAttachment<'a> {
    let store = wgt::StoreOp::Store;
    let all = || parts.clone().filter_map(|p| p.draw.depth.as_ref());
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
