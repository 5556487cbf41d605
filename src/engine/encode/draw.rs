//! Draws. One of nothing still clears its targets.

use wgpu_types as wgt;

use super::Encoding;
use crate::engine::draws::{DepthAttachment, DrawVariant, Vertices};
use crate::engine::meshes;
use crate::plan::model::{Pass, PassKind};

/// A draw of a render pass.
#[derive(Clone, Copy)]
pub(in crate::engine) struct Part<'a> {
    pub pass: &'a Pass,
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
    let targets = attachments(first.variant, last.variant);
    let filled = colors.iter_mut().zip(targets).map(|(place, color)| *place = Some(color)).count();
    let depth = first.variant.depth.as_ref();
    let mut render = encoding.recorder.render(&wgpu::RenderPassDescriptor {
        label: Some(&first.pass.path),
        color_attachments: &colors[..filled],
        depth_stencil_attachment: depth.map(|first| depth_attachment(first, parts.clone())),
        timestamp_writes: timing.render_of(pair, count),
        ..wgpu::RenderPassDescriptor::default()
    });
    let mut in_region = false;
    for (nth, part) in parts.enumerate() {
        let variant = part.variant;
        timing.write_between_draws(&mut render, pair, nth);
        if named {
            render.push_debug_group(&part.pass.path);
        }
        if variant.region.is_some() || in_region {
            in_region = variant.region.is_some();
            region(&mut render, variant);
        }
        if !matches!(variant.region, Some([_, _, 0, _] | [_, _, _, 0])) {
            draw(&mut render, part, &encoding.fixed.arguments);
        }
        if named {
            render.pop_debug_group();
        }
    }
}

fn attachments<'a>(
    first: &'a DrawVariant,
    last: &'a DrawVariant,
) -> impl Iterator<Item = wgpu::RenderPassColorAttachment<'a>> {
    first.color.iter().zip(&last.color).map(|(first, last)| wgpu::RenderPassColorAttachment {
        view: &first.view,
        depth_slice: None,
        resolve_target: last.resolve.as_ref(),
        ops: wgt::Operations { load: first.load, store: first.store },
    })
}

fn region(render: &mut wgpu::RenderPass<'_>, draw: &DrawVariant) {
    let [x, y, width, height] = draw.region.unwrap_or([0, 0, draw.extent[0], draw.extent[1]]);
    if width > 0 && height > 0 {
        render.set_viewport(x as f32, y as f32, width as f32, height as f32, 0.0, 1.0);
        render.set_scissor_rect(x, y, width, height);
    }
}

fn draw(render: &mut wgpu::RenderPass<'_>, Part { pass, variant }: Part<'_>, arguments: &wgpu::Buffer) {
    let Some(pipeline) = &variant.pipeline else { return };
    render.set_pipeline(pipeline);
    if variant.group.is_some() {
        render.set_bind_group(0, variant.group.as_ref(), &[]);
    }
    if let Some(reference) = variant.stencil_reference {
        render.set_stencil_reference(reference);
    }
    if let Some(indices) = &variant.indices {
        render.set_index_buffer(indices.slice(..), wgt::IndexFormat::Uint32);
    }
    if let (Some(meshes), PassKind::Draw(draw)) = (&variant.meshes, &pass.kind) {
        return meshes::encode(render, draw, meshes);
    }
    match variant.vertices {
        Vertices::Nothing => {}
        Vertices::Direct { vertices, instances } => render.draw(0..vertices, 0..instances),
        Vertices::Indexed { count, instances } => render.draw_indexed(0..count, 0, 0..instances),
        Vertices::Indirect { slot } => render.draw_indirect(arguments, u64::from(slot) * 32),
        Vertices::IndexedIndirect { slot } => render.draw_indexed_indirect(arguments, u64::from(slot) * 32),
    }
}

/// An aspect is written if one of the draws writes it.
fn depth_attachment<'a>(
    first: &'a DepthAttachment,
    parts: impl Iterator<Item = Part<'a>> + Clone,
) -> wgpu::RenderPassDepthStencilAttachment<'a> {
    let store = first.store;
    let all = || parts.clone().filter_map(|part| part.variant.depth.as_ref());
    let (depth, stencil) = (all().any(|d| d.depth.is_some()), all().any(|d| d.stencil.is_some()));
    wgpu::RenderPassDepthStencilAttachment {
        view: &first.view,
        depth_ops: depth.then(|| wgt::Operations { load: first.depth.unwrap_or(wgt::LoadOp::Load), store }),
        stencil_ops: stencil.then(|| wgt::Operations { load: first.stencil.unwrap_or(wgt::LoadOp::Load), store }),
    }
}
