//! Mips from mip 0: each the mean over the area that its texels cover, drawn where the format
//! can be a target, else stored.

use wgpu_types::{TextureFormat, TextureUsages};

use super::bind::{Bench, layer_view};
use super::gpu::Gpu;
use super::kernels::{self, MipWay, REDUCE_EDGE};
use super::pipeline::{Pipeline, Recipe};
use crate::format;
use crate::plan::model::{ObjectKind, ObjectRef, Pass, Plan, Texture};

/// One mip of one layer.
#[derive(Debug)]
pub(super) struct MipStep {
    pub group: wgpu::BindGroup,
    /// What to draw into, or how many workgroups store.
    pub into: MipInto,
}

#[derive(Debug)]
pub(super) enum MipInto {
    Target(wgpu::TextureView),
    Groups([u32; 3]),
}

fn way(gpu: &Gpu, texture: &Texture) -> Result<MipWay, String> {
    let features = gpu.features();
    if texture.format.is_depth_stencil_format() {
        return Err("depth formats have no automatic mips".into());
    }
    if !texture.is_3d && format::is_renderable(texture.format, features) {
        return Ok(MipWay::Draw);
    }
    let allowed = texture.format.guaranteed_format_features(features).allowed_usages;
    if !allowed.contains(TextureUsages::STORAGE_BINDING) {
        return Err(format!("mips of {} can be neither drawn nor stored", format::name(texture.format)));
    }
    Ok(if texture.is_3d { MipWay::Store3d } else { MipWay::Store2d })
}

fn description(plan: &Plan, object: usize) -> Result<&Texture, String> {
    match &plan.objects[object].kind {
        ObjectKind::Texture(texture) => Ok(texture),
        ObjectKind::Buffer(_) => Err(format!("`{}` is no texture", plan.objects[object].path)),
    }
}

/// The pipeline for the mips of an object.
///
/// # Errors
/// A message if its format has no way.
pub(super) fn recipe(gpu: &Gpu, plan: &Plan, object: usize) -> Result<Recipe, String> {
    let texture = description(plan, object)?;
    Ok(kernels::reduce(texture.format, way(gpu, texture)?))
}

pub(super) fn variant(
    bench: &Bench<'_>,
    pass: &Pass,
    pipeline: Option<&Pipeline>,
    object: ObjectRef,
) -> Result<Vec<MipStep>, String> {
    let about = description(bench.plan, bench.object(object))?;
    let way = way(bench.gpu, about)?;
    let texture = bench.texture(object)?;
    let layout = pipeline.and_then(|p| p.layout.as_ref()).ok_or("the mip kernel has no layout")?;
    let layers = if about.is_3d { 1 } else { about.layers };
    let mut steps = Vec::new();
    for layer in 0..layers {
        for mip in 1..about.mips {
            let above = level(texture, about.is_3d, mip - 1, layer);
            let made = level(texture, about.is_3d, mip, layer);
            let mut entries =
                vec![wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&above) }];
            if way != MipWay::Draw {
                let resource = wgpu::BindingResource::TextureView(&made);
                entries.push(wgpu::BindGroupEntry { binding: 1, resource });
            }
            let group = bench.make_group(&pass.path, layout, &entries);
            let into = if way == MipWay::Draw { MipInto::Target(made) } else { MipInto::Groups(groups(about, mip)) };
            steps.push(MipStep { group, into });
        }
    }
    Ok(steps)
}

fn level(texture: &wgpu::Texture, is_3d: bool, mip: u32, layer: u32) -> wgpu::TextureView {
    if !is_3d {
        return layer_view(texture, mip, layer);
    }
    texture.create_view(&wgpu::TextureViewDescriptor {
        base_mip_level: mip,
        mip_level_count: Some(1),
        ..wgpu::TextureViewDescriptor::default()
    })
}

fn groups(texture: &Texture, mip: u32) -> [u32; 3] {
    let depth = if texture.is_3d { texture.layers } else { 1 };
    [texture.width, texture.height, depth].map(|n| (n >> mip).max(1).div_ceil(REDUCE_EDGE))
}

/// Bytes to a row of texels in a buffer that copies read or write.
pub(super) fn padded_row(format: TextureFormat, width: u32, texel: usize) -> u32 {
    debug_assert!(!format.is_compressed());
    (width * texel as u32).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}
