//! The engine's own shaders, for what plans ask for without a shader of a graph.

use std::borrow::Cow;

use wgpu_types as wgt;
use wgpu_types::{BufferBindingType, ShaderStages, TextureFormat};

use super::convert::buffer_type;
use super::pipeline::{Recipe, RecipeKind, Stage};
use crate::format::{self, SampleKind};

const FULLSCREEN: &str = include_str!("kernels/fullscreen.wgsl");
const SETTLE: &str = include_str!("kernels/settle.wgsl");
const FILL: &str = include_str!("kernels/fill.wgsl");
const REDUCE: &str = include_str!("kernels/reduce.wgsl");
const REDUCE_STORAGE: &str = include_str!("kernels/reduce_storage.wgsl");
const DEPTH: &str = include_str!("kernels/depth.wgsl");

/// Threads to a workgroup of the fill kernel.
pub(super) const FILL_THREADS: u32 = 256;
/// Edge of a workgroup of the storage variant of the mip kernel.
pub(super) const REDUCE_EDGE: u32 = 4;

/// The vertex stage of `Fullscreen`.
pub(super) fn fullscreen() -> Stage {
    Stage::text(FULLSCREEN, "fullscreen")
}

fn entry(binding: u32, visibility: ShaderStages, ty: wgt::BindingType) -> wgt::BindGroupLayoutEntry {
    wgt::BindGroupLayoutEntry { binding, visibility, ty, count: None }
}

fn storage(read_only: bool) -> wgt::BindingType {
    buffer_type(BufferBindingType::Storage { read_only })
}

/// Counted buffer, argument slots, statistics, its constants, its consumers.
pub(super) fn settle() -> Recipe {
    let stage = ShaderStages::COMPUTE;
    Recipe {
        layout: vec![
            entry(0, stage, storage(false)),
            entry(1, stage, storage(false)),
            entry(2, stage, storage(false)),
            entry(3, stage, buffer_type(BufferBindingType::Uniform)),
            entry(4, stage, storage(true)),
        ],
        kind: RecipeKind::Compute(Stage::text(SETTLE, "main")),
    }
}

/// The buffer to fill, and with what.
pub(super) fn fill() -> Recipe {
    Recipe {
        layout: vec![
            entry(0, ShaderStages::COMPUTE, storage(false)),
            entry(1, ShaderStages::COMPUTE, buffer_type(BufferBindingType::Uniform)),
        ],
        kind: RecipeKind::Compute(Stage::text(FILL, "main")),
    }
}

/// How mips of a texture can be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MipWay {
    /// By drawing into each layer.
    Draw,
    /// By storing, layer by layer.
    Store2d,
    Store3d,
}

fn scalar(format: TextureFormat) -> (&'static str, wgt::TextureSampleType) {
    match format::sample_kind(format) {
        SampleKind::Sint => ("i32", wgt::TextureSampleType::Sint),
        SampleKind::Uint => ("u32", wgt::TextureSampleType::Uint),
        _ => ("f32", wgt::TextureSampleType::Float { filterable: false }),
    }
}

/// The level above, and for stores the level to make.
pub(super) fn reduce(format: TextureFormat, way: MipWay) -> Recipe {
    let (scalar, sample_type) = scalar(format);
    let (stage, dimension) = match way {
        MipWay::Draw => (ShaderStages::FRAGMENT, wgt::TextureViewDimension::D2),
        MipWay::Store2d => (ShaderStages::COMPUTE, wgt::TextureViewDimension::D2),
        MipWay::Store3d => (ShaderStages::COMPUTE, wgt::TextureViewDimension::D3),
    };
    let texture = wgt::BindingType::Texture { sample_type, view_dimension: dimension, multisampled: false };
    let above = entry(0, stage, texture);
    if way == MipWay::Draw {
        let text = REDUCE.replace("SCALAR", scalar);
        return draw_one(vec![above], Stage::text(Cow::Owned(text), "reduce"), format);
    }
    let (word, extent, swizzle) = match way {
        MipWay::Store3d => ("3d", "textureDimensions(above)", "xyz"),
        _ => ("2d", "vec3<u32>(textureDimensions(above), 1u)", "xy"),
    };
    let text = REDUCE_STORAGE
        .replace("EXTENT_ABOVE", extent)
        .replace("SWIZZLE", swizzle)
        .replace("SCALAR", scalar)
        .replace("FORMAT", &wgsl_format(format))
        .replace("DIMENSION", word);
    let access = wgt::StorageTextureAccess::WriteOnly;
    let reduced = entry(1, stage, wgt::BindingType::StorageTexture { access, format, view_dimension: dimension });
    Recipe { layout: vec![above, reduced], kind: RecipeKind::Compute(Stage::text(Cow::Owned(text), "main")) }
}

/// Depth, drawn into a target of `R32Float`.
pub(super) fn depth() -> Recipe {
    let texture = wgt::BindingType::Texture {
        sample_type: wgt::TextureSampleType::Depth,
        view_dimension: wgt::TextureViewDimension::D2,
        multisampled: false,
    };
    let layout = vec![entry(0, ShaderStages::FRAGMENT, texture)];
    draw_one(layout, Stage::text(DEPTH, "depth_as_color"), TextureFormat::R32Float)
}

fn draw_one(layout: Vec<wgt::BindGroupLayoutEntry>, fragment: Stage, format: TextureFormat) -> Recipe {
    Recipe {
        layout,
        kind: RecipeKind::Draw {
            vertex: fullscreen(),
            fragment: Some(fragment),
            vertices: Vec::new(),
            targets: vec![Some(format.into())],
            primitive: wgt::PrimitiveState::default(),
            depth: None,
            samples: 1,
        },
    }
}

/// WGSL's storage formats are the names of WebGPU's in lower case.
fn wgsl_format(format: TextureFormat) -> String {
    format!("{format:?}").to_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The text of a recipe's stages.
    fn texts(recipe: &Recipe) -> Vec<String> {
        let stages: Vec<&Stage> = match &recipe.kind {
            RecipeKind::Compute(stage) => vec![stage],
            RecipeKind::Draw { vertex, fragment, .. } => std::iter::once(vertex).chain(fragment).collect(),
        };
        let text = |s: &Stage| match &s.source {
            super::super::pipeline::Source::Text(text) => text.to_string(),
            super::super::pipeline::Source::Module(_) => String::new(),
        };
        stages.into_iter().map(text).collect()
    }

    #[test]
    fn every_kernel_is_valid_wgsl() {
        let formats = [TextureFormat::Rgba16Float, TextureFormat::R32Uint, TextureFormat::Rgba32Sint];
        let ways = [MipWay::Draw, MipWay::Store2d, MipWay::Store3d];
        let reduces = formats.into_iter().flat_map(|f| ways.map(|w| reduce(f, w)));
        for recipe in [settle(), fill(), depth()].into_iter().chain(reduces) {
            for text in texts(&recipe) {
                let module = naga::front::wgsl::parse_str(&text).unwrap_or_else(|e| panic!("{e}\n{text}"));
                let capabilities = naga::valid::Capabilities::all();
                let flags = naga::valid::ValidationFlags::all();
                let valid = naga::valid::Validator::new(flags, capabilities).validate(&module);
                assert!(valid.is_ok(), "{:?}\n{text}", valid.err());
            }
        }
    }
}
