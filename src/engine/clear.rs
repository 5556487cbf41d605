//! Clearing: targets by a render pass without draws, other textures by copies from a buffer of
//! equal texels, buffers by zeroes or words.

use wgpu_types::TextureUsages;

use super::bind::{Bench, layer_view};
use super::kernels::FILL_THREADS;
use super::mips::padded_row;
use super::pipeline::Pipeline;
use super::texel;
use crate::plan::model::{Buffer, ObjectKind, Pass, Plan, View};
use crate::shader::reflect::{Scalar, Type};

#[derive(Debug)]
pub(super) enum ClearVariant {
    Color {
        views: Vec<wgpu::TextureView>,
        value: wgpu::Color,
    },
    Depth {
        views: Vec<wgpu::TextureView>,
        depth: Option<f32>,
        stencil: Option<u32>,
    },
    /// Rows of equal texels, copied into each slice.
    Texels {
        source: wgpu::Buffer,
        row: u32,
        slices: Vec<Slice>,
    },
    /// So many bytes from the start.
    Zero {
        bytes: u64,
    },
    Words {
        group: wgpu::BindGroup,
        groups: [u32; 2],
    },
}

#[derive(Debug)]
pub(super) struct Slice {
    pub mip: u32,
    pub layer: u32,
    pub extent: [u32; 2],
}

pub(super) fn variant(
    bench: &Bench<'_>,
    pass: &Pass,
    pipeline: Option<&Pipeline>,
    view: &View,
    value: [f64; 4],
) -> Result<ClearVariant, String> {
    match &bench.plan.objects[bench.object(view.object)].kind {
        ObjectKind::Texture(_) => texture(bench, view, value),
        ObjectKind::Buffer(buffer) => words(bench, pass, pipeline, view, buffer, value[0]),
    }
}

fn texture(bench: &Bench<'_>, view: &View, value: [f64; 4]) -> Result<ClearVariant, String> {
    let texture = bench.texture(view.object)?;
    let target =
        texture.dimension() == wgpu::TextureDimension::D2 && texture.usage().contains(TextureUsages::RENDER_ATTACHMENT);
    if !target {
        return texels(bench, view, value);
    }
    let parts = view.mips.clone().flat_map(|mip| view.layers.clone().map(move |layer| (mip, layer)));
    let views = parts.map(|(mip, layer)| layer_view(texture, mip, layer)).collect();
    let format = texture.format();
    if format.is_depth_stencil_format() {
        let both = format.is_combined_depth_stencil_format();
        return Ok(ClearVariant::Depth {
            views,
            depth: format.has_depth_aspect().then_some(value[0] as f32),
            stencil: format.has_stencil_aspect().then_some(if both { value[1] } else { value[0] } as u32),
        });
    }
    let [r, g, b, a] = value;
    Ok(ClearVariant::Color { views, value: wgpu::Color { r, g, b, a } })
}

fn texels(bench: &Bench<'_>, view: &View, value: [f64; 4]) -> Result<ClearVariant, String> {
    let texture = bench.texture(view.object)?;
    let format = texture.format();
    let volume = texture.dimension() == wgpu::TextureDimension::D3;
    let extent = |mip: u32| [(texture.width() >> mip).max(1), (texture.height() >> mip).max(1)];
    let mut slices = Vec::new();
    for mip in view.mips.clone() {
        let depth = (texture.depth_or_array_layers() >> mip).max(1);
        let layers = if volume { 0..depth } else { view.layers.clone() };
        slices.extend(layers.map(|layer| Slice { mip, layer, extent: extent(mip) }));
    }
    let one = texel::encode(format, value).ok_or_else(|| format!("{format:?} cannot be cleared"))?;
    let [width, height] = extent(view.mips.start);
    let row = padded_row(format, width, one.len());
    let bytes: Vec<u8> = one.iter().copied().cycle().take(row as usize).collect();
    let source = bench.gpu.device().create_buffer(&wgpu::BufferDescriptor {
        label: Some("clear value"),
        size: u64::from(row) * u64::from(height),
        usage: wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    bench.gpu.queue().write_buffer(&source, 0, &bytes.repeat(height as usize));
    Ok(ClearVariant::Texels { source, row, slices })
}

fn words(
    bench: &Bench<'_>,
    pass: &Pass,
    pipeline: Option<&Pipeline>,
    view: &View,
    buffer: &Buffer,
    value: f64,
) -> Result<ClearVariant, String> {
    let word = word(buffer.item.as_ref(), value);
    if word == 0 {
        // What is behind the count of an empty counted buffer is nobody's.
        return Ok(ClearVariant::Zero { bytes: if buffer.counted { 4 } else { buffer.bytes() } });
    }
    let layout = pipeline.and_then(|p| p.layout.as_ref()).ok_or("the filling kernel has no layout")?;
    let words = u32::try_from(buffer.bytes() / 4).map_err(|_| "more than 16 GiB to fill".to_owned())?;
    let all = words.div_ceil(FILL_THREADS);
    let groups = [all.clamp(1, 65_535), all.div_ceil(65_535).max(1)];
    let constants = [word, words, groups[0] * FILL_THREADS, 0];
    let fill = bench.constant(&pass.path, &constants, wgpu::BufferUsages::UNIFORM);
    let entries = [
        wgpu::BindGroupEntry { binding: 0, resource: bench.whole(view.object)? },
        wgpu::BindGroupEntry { binding: 1, resource: fill.as_entire_binding() },
    ];
    Ok(ClearVariant::Words { group: bench.make_group(&pass.path, layout, &entries), groups })
}

/// The bits of a value as the first scalar of an item has it.
fn word(item: Option<&Type>, value: f64) -> u32 {
    match item.and_then(first_scalar) {
        Some(Scalar::F32) => (value as f32).to_bits(),
        Some(Scalar::I32) => (value as i32).cast_unsigned(),
        _ => value as u32,
    }
}

fn first_scalar(ty: &Type) -> Option<Scalar> {
    match ty {
        Type::Scalar(s) | Type::Atomic(s) => Some(*s),
        Type::Vector { scalar, .. } | Type::Matrix { scalar, .. } => Some(*scalar),
        Type::Array { element, .. } => first_scalar(element),
        Type::Struct { members, .. } => members.first().and_then(|m| first_scalar(&m.ty)),
    }
}

/// Whether a clear needs the filling kernel.
pub(super) fn needs_fill(plan: &Plan, view: &View, value: [f64; 4]) -> bool {
    let objects = super::pool::candidates(plan, view.object);
    objects.first().is_some_and(|id| match &plan.objects[*id].kind {
        ObjectKind::Buffer(buffer) => word(buffer.item.as_ref(), value[0]) != 0,
        ObjectKind::Texture(_) => false,
    })
}
