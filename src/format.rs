//! Texture formats and what WebGPU guarantees of them, as plain data.

pub use wgpu_types::TextureFormat;
use wgpu_types::{Features, TextureFormatFeatureFlags, TextureSampleType, TextureUsages};

/// Formats that graphs may name, by the words of the language.
pub const NAMED: &[(&str, TextureFormat)] = &[
    ("R8Unorm", TextureFormat::R8Unorm),
    ("R8Uint", TextureFormat::R8Uint),
    ("R8Sint", TextureFormat::R8Sint),
    ("R8Snorm", TextureFormat::R8Snorm),
    ("R16Uint", TextureFormat::R16Uint),
    ("R16Sint", TextureFormat::R16Sint),
    ("R16Float", TextureFormat::R16Float),
    ("Rg8Unorm", TextureFormat::Rg8Unorm),
    ("Rg8Uint", TextureFormat::Rg8Uint),
    ("Rg16Uint", TextureFormat::Rg16Uint),
    ("Rg16Float", TextureFormat::Rg16Float),
    ("R32Uint", TextureFormat::R32Uint),
    ("R32Sint", TextureFormat::R32Sint),
    ("R32Float", TextureFormat::R32Float),
    ("Rg32Uint", TextureFormat::Rg32Uint),
    ("Rg32Float", TextureFormat::Rg32Float),
    ("Rgba8Unorm", TextureFormat::Rgba8Unorm),
    ("Rgba8UnormSrgb", TextureFormat::Rgba8UnormSrgb),
    ("Rgba8Snorm", TextureFormat::Rgba8Snorm),
    ("Rgba8Uint", TextureFormat::Rgba8Uint),
    ("Rgba8Sint", TextureFormat::Rgba8Sint),
    ("Bgra8Unorm", TextureFormat::Bgra8Unorm),
    ("Rgb10a2Unorm", TextureFormat::Rgb10a2Unorm),
    ("Rg11b10Ufloat", TextureFormat::Rg11b10Ufloat),
    ("Rgba16Uint", TextureFormat::Rgba16Uint),
    ("Rgba16Sint", TextureFormat::Rgba16Sint),
    ("Rgba16Float", TextureFormat::Rgba16Float),
    ("Rgba32Uint", TextureFormat::Rgba32Uint),
    ("Rgba32Sint", TextureFormat::Rgba32Sint),
    ("Rgba32Float", TextureFormat::Rgba32Float),
    ("Depth16Unorm", TextureFormat::Depth16Unorm),
    ("Depth24Plus", TextureFormat::Depth24Plus),
    ("Depth24PlusStencil8", TextureFormat::Depth24PlusStencil8),
    ("Depth32Float", TextureFormat::Depth32Float),
    ("Depth32FloatStencil8", TextureFormat::Depth32FloatStencil8),
    ("Stencil8", TextureFormat::Stencil8),
];

/// The word of the language for a format.
pub fn name(format: TextureFormat) -> &'static str {
    NAMED.iter().find(|(_, f)| *f == format).map_or("an unnamed format", |(name, _)| name)
}

/// What a shader that samples the format declares.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SampleKind {
    Float,
    Sint,
    Uint,
    Depth,
}

/// What a shader sees when it samples the format (of a depth-stencil format: its depth).
pub fn sample_kind(format: TextureFormat) -> SampleKind {
    match format
        .sample_type(Some(wgpu_types::TextureAspect::DepthOnly), None)
        .or_else(|| format.sample_type(None, None))
    {
        Some(TextureSampleType::Sint) => SampleKind::Sint,
        Some(TextureSampleType::Uint) => SampleKind::Uint,
        Some(TextureSampleType::Depth) => SampleKind::Depth,
        _ => SampleKind::Float,
    }
}

/// Whether linear samplers may read it, given features beyond WebGPU's defaults.
pub fn is_filterable(format: TextureFormat, features: Features) -> bool {
    matches!(format.sample_type(None, Some(features)), Some(TextureSampleType::Float { filterable: true }))
}

/// Whether the format can be a colour target that blends, given features.
pub fn is_blendable(format: TextureFormat, features: Features) -> bool {
    let flags = format.guaranteed_format_features(features).flags;
    flags.contains(TextureFormatFeatureFlags::BLENDABLE)
        || (features.contains(Features::FLOAT32_BLENDABLE) && is_float32(format))
}

pub fn is_float32(format: TextureFormat) -> bool {
    matches!(format, TextureFormat::R32Float | TextureFormat::Rg32Float | TextureFormat::Rgba32Float)
}

/// Whether the format can be a target of a draw.
pub fn is_renderable(format: TextureFormat, features: Features) -> bool {
    format.guaranteed_format_features(features).allowed_usages.contains(TextureUsages::RENDER_ATTACHMENT)
}

/// Number of colour channels; 1 for depth and stencil.
pub fn channels(format: TextureFormat) -> u32 {
    u32::from(format.components())
}
