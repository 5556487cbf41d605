//! The plan's words as wgpu's.

use wgpu_types as wgt;

use crate::format::SampleKind;
use crate::graph::model as graph;
use crate::plan::model::{Binding, Bound, ColorTarget, DepthTarget, Draw, Geometry, Plan};
use crate::shader::reflect::TextureDimension;

pub(super) fn compare(compare: graph::Compare) -> wgt::CompareFunction {
    match compare {
        graph::Compare::Never => wgt::CompareFunction::Never,
        graph::Compare::Less => wgt::CompareFunction::Less,
        graph::Compare::Equal => wgt::CompareFunction::Equal,
        graph::Compare::LessEqual => wgt::CompareFunction::LessEqual,
        graph::Compare::Greater => wgt::CompareFunction::Greater,
        graph::Compare::NotEqual => wgt::CompareFunction::NotEqual,
        graph::Compare::GreaterEqual => wgt::CompareFunction::GreaterEqual,
        graph::Compare::Always => wgt::CompareFunction::Always,
    }
}

pub(super) fn view_dimension(dimension: TextureDimension) -> wgt::TextureViewDimension {
    match dimension {
        TextureDimension::D1 => wgt::TextureViewDimension::D1,
        TextureDimension::D2 => wgt::TextureViewDimension::D2,
        TextureDimension::D2Array => wgt::TextureViewDimension::D2Array,
        TextureDimension::Cube => wgt::TextureViewDimension::Cube,
        TextureDimension::CubeArray => wgt::TextureViewDimension::CubeArray,
        TextureDimension::D3 => wgt::TextureViewDimension::D3,
    }
}

pub(super) fn sampler(sampler: &graph::Sampler) -> wgt::SamplerDescriptor<Option<&str>> {
    let filter = |linear| if linear { wgt::FilterMode::Linear } else { wgt::FilterMode::Nearest };
    let address = match sampler.address {
        graph::Address::Clamp => wgt::AddressMode::ClampToEdge,
        graph::Address::Repeat => wgt::AddressMode::Repeat,
        graph::Address::Mirror => wgt::AddressMode::MirrorRepeat,
    };
    wgt::SamplerDescriptor {
        label: Some(sampler.name.value.as_str()),
        address_mode_u: address,
        address_mode_v: address,
        address_mode_w: address,
        mag_filter: filter(sampler.linear),
        min_filter: filter(sampler.linear),
        mipmap_filter: if sampler.mip_linear { wgt::MipmapFilterMode::Linear } else { wgt::MipmapFilterMode::Nearest },
        compare: sampler.compare.map(compare),
        anisotropy_clamp: sampler.anisotropy.max(1),
        ..wgt::SamplerDescriptor::default()
    }
}

/// What bind group 0 looks like, in the order of binding numbers.
pub(super) fn layout(plan: &Plan, bindings: &[Binding]) -> Vec<wgt::BindGroupLayoutEntry> {
    let mut entries: Vec<_> = bindings
        .iter()
        .map(|b| wgt::BindGroupLayoutEntry {
            binding: b.binding,
            visibility: b.stages,
            ty: binding_type(plan, &b.bound),
            count: None,
        })
        .collect();
    entries.sort_by_key(|e| e.binding);
    entries
}

pub(super) fn buffer_type(ty: wgt::BufferBindingType) -> wgt::BindingType {
    wgt::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None }
}

fn binding_type(plan: &Plan, bound: &Bound) -> wgt::BindingType {
    match bound {
        Bound::Uniform { .. } | Bound::UniformBuffer { .. } | Bound::Material { .. } => {
            buffer_type(wgt::BufferBindingType::Uniform)
        }
        Bound::Storage { writable, .. } => buffer_type(wgt::BufferBindingType::Storage { read_only: !writable }),
        Bound::Texture { view, sample, filtered, multisampled } => wgt::BindingType::Texture {
            sample_type: match sample {
                SampleKind::Float => wgt::TextureSampleType::Float { filterable: *filtered && !multisampled },
                SampleKind::Sint => wgt::TextureSampleType::Sint,
                SampleKind::Uint => wgt::TextureSampleType::Uint,
                SampleKind::Depth => wgt::TextureSampleType::Depth,
            },
            view_dimension: view_dimension(view.dimension),
            multisampled: *multisampled,
        },
        Bound::StorageTexture { view, format, read, write } => wgt::BindingType::StorageTexture {
            access: match (read, write) {
                (true, true) => wgt::StorageTextureAccess::ReadWrite,
                (true, false) => wgt::StorageTextureAccess::ReadOnly,
                (false, _) => wgt::StorageTextureAccess::WriteOnly,
            },
            format: *format,
            view_dimension: view_dimension(view.dimension),
        },
        Bound::Sampler { sampler } => wgt::BindingType::Sampler(sampler_type(plan.samplers.get(*sampler))),
        Bound::MaterialTexture { .. } => wgt::BindingType::Texture {
            sample_type: wgt::TextureSampleType::Float { filterable: true },
            view_dimension: wgt::TextureViewDimension::D2,
            multisampled: false,
        },
        Bound::MaterialSampler { .. } => wgt::BindingType::Sampler(wgt::SamplerBindingType::Filtering),
    }
}

fn sampler_type(sampler: Option<&graph::Sampler>) -> wgt::SamplerBindingType {
    match sampler {
        Some(s) if s.compare.is_some() => wgt::SamplerBindingType::Comparison,
        Some(s) if !s.linear && !s.mip_linear && s.anisotropy <= 1 => wgt::SamplerBindingType::NonFiltering,
        _ => wgt::SamplerBindingType::Filtering,
    }
}

pub(super) fn primitive(draw: &Draw) -> wgt::PrimitiveState {
    let (topology, strip) = match draw.topology {
        graph::Topology::PointList => (wgt::PrimitiveTopology::PointList, false),
        graph::Topology::LineList => (wgt::PrimitiveTopology::LineList, false),
        graph::Topology::LineStrip => (wgt::PrimitiveTopology::LineStrip, true),
        graph::Topology::TriangleList => (wgt::PrimitiveTopology::TriangleList, false),
        graph::Topology::TriangleStrip => (wgt::PrimitiveTopology::TriangleStrip, true),
    };
    let fullscreen = matches!(draw.geometry, Geometry::Fullscreen);
    let indexed = matches!(draw.geometry, Geometry::Indexed { .. } | Geometry::Indirect { indices: Some(_), .. });
    wgt::PrimitiveState {
        topology: if fullscreen { wgt::PrimitiveTopology::TriangleList } else { topology },
        strip_index_format: (strip && indexed).then_some(wgt::IndexFormat::Uint32),
        front_face: if draw.front_ccw { wgt::FrontFace::Ccw } else { wgt::FrontFace::Cw },
        cull_mode: draw.cull.filter(|_| !fullscreen).map(|face| match face {
            graph::Face::Front => wgt::Face::Front,
            graph::Face::Back => wgt::Face::Back,
        }),
        ..wgt::PrimitiveState::default()
    }
}

pub(super) fn color_target(target: &ColorTarget) -> wgt::ColorTargetState {
    let channels = [wgt::ColorWrites::RED, wgt::ColorWrites::GREEN, wgt::ColorWrites::BLUE, wgt::ColorWrites::ALPHA];
    wgt::ColorTargetState {
        format: target.format,
        blend: target
            .blend
            .map(|b| wgt::BlendState { color: blend_component(b.color), alpha: blend_component(b.alpha) }),
        write_mask: channels.into_iter().zip(target.write).filter(|(_, on)| *on).map(|(c, _)| c).collect(),
    }
}

fn blend_component(component: graph::BlendComponent) -> wgt::BlendComponent {
    let operation = match component.operation {
        graph::Operation::Add => wgt::BlendOperation::Add,
        graph::Operation::Subtract => wgt::BlendOperation::Subtract,
        graph::Operation::ReverseSubtract => wgt::BlendOperation::ReverseSubtract,
        graph::Operation::Min => wgt::BlendOperation::Min,
        graph::Operation::Max => wgt::BlendOperation::Max,
    };
    if matches!(component.operation, graph::Operation::Min | graph::Operation::Max) {
        // Factors have no part in these, and must be one.
        let one = wgt::BlendFactor::One;
        return wgt::BlendComponent { src_factor: one, dst_factor: one, operation };
    }
    wgt::BlendComponent { src_factor: factor(component.source), dst_factor: factor(component.target), operation }
}

fn factor(factor: graph::Factor) -> wgt::BlendFactor {
    match factor {
        graph::Factor::Zero => wgt::BlendFactor::Zero,
        graph::Factor::One => wgt::BlendFactor::One,
        graph::Factor::Src => wgt::BlendFactor::Src,
        graph::Factor::OneMinusSrc => wgt::BlendFactor::OneMinusSrc,
        graph::Factor::SrcAlpha => wgt::BlendFactor::SrcAlpha,
        graph::Factor::OneMinusSrcAlpha => wgt::BlendFactor::OneMinusSrcAlpha,
        graph::Factor::Dst => wgt::BlendFactor::Dst,
        graph::Factor::OneMinusDst => wgt::BlendFactor::OneMinusDst,
        graph::Factor::DstAlpha => wgt::BlendFactor::DstAlpha,
        graph::Factor::OneMinusDstAlpha => wgt::BlendFactor::OneMinusDstAlpha,
    }
}

pub(super) fn depth_stencil(target: &DepthTarget) -> wgt::DepthStencilState {
    let has_depth = target.format.has_depth_aspect();
    wgt::DepthStencilState {
        format: target.format,
        depth_write_enabled: has_depth.then_some(target.write),
        depth_compare: has_depth.then(|| compare(target.compare)),
        stencil: target.stencil.as_ref().map(stencil).unwrap_or_default(),
        bias: wgt::DepthBiasState { constant: target.bias.0, slope_scale: target.bias.1, clamp: 0.0 },
    }
}

fn stencil(stencil: &crate::plan::model::Stencil) -> wgt::StencilState {
    let face = wgt::StencilFaceState {
        compare: compare(stencil.compare),
        fail_op: stencil_operation(stencil.fail),
        depth_fail_op: stencil_operation(stencil.depth_fail),
        pass_op: stencil_operation(stencil.pass),
    };
    wgt::StencilState { front: face, back: face, read_mask: stencil.read_mask, write_mask: stencil.write_mask }
}

fn stencil_operation(operation: graph::StencilOperation) -> wgt::StencilOperation {
    match operation {
        graph::StencilOperation::Keep => wgt::StencilOperation::Keep,
        graph::StencilOperation::Zero => wgt::StencilOperation::Zero,
        graph::StencilOperation::Replace => wgt::StencilOperation::Replace,
        graph::StencilOperation::Invert => wgt::StencilOperation::Invert,
        graph::StencilOperation::IncrementClamp => wgt::StencilOperation::IncrementClamp,
        graph::StencilOperation::DecrementClamp => wgt::StencilOperation::DecrementClamp,
        graph::StencilOperation::IncrementWrap => wgt::StencilOperation::IncrementWrap,
        graph::StencilOperation::DecrementWrap => wgt::StencilOperation::DecrementWrap,
    }
}
