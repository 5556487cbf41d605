//! A picture for screens: what a runner made, encoded as sRGB into a texture that windows show.
//! It is a copy, so that the last good picture stays while what made it is built anew.

use super::errors;
use super::gpu::Gpu;
use super::prepare::Runner;
use crate::diagnostic::{Code, Diagnostic};
use crate::plan::model::ObjectRef;

const ENCODE: &str = include_str!("screen.wgsl");

/// Holds the picture that is shown.
#[derive(Debug)]
pub struct Screen {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    shown: Option<wgpu::Texture>,
    /// For the texture that was taken last, and the one that is shown.
    bound: Option<Bound>,
}

#[derive(Debug)]
struct Bound {
    source: wgpu::Texture,
    shown: wgpu::Texture,
    group: wgpu::BindGroup,
    target: wgpu::TextureView,
}

impl Screen {
    /// # Errors
    /// If the device refuses what turns light into a screen's values.
    pub fn new(gpu: &Gpu) -> Result<Self, Diagnostic> {
        let made = errors::scoped(gpu, || {
            let device = gpu.device();
            let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("screen"),
                entries: &[wgpu::BindGroupLayoutEntry {
                    binding: 0,
                    visibility: wgpu::ShaderStages::FRAGMENT,
                    ty: wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Float { filterable: false },
                        view_dimension: wgpu::TextureViewDimension::D2,
                        multisampled: false,
                    },
                    count: None,
                }],
            });
            (pipeline(device, &layout), layout)
        });
        let (pipeline, layout) = made.map_err(|e| refused(&e))?;
        Ok(Self { pipeline, layout, shown: None, bound: None })
    }

    /// The encoded picture, `Rgba8Unorm`; absent before the first.
    pub fn texture(&self) -> Option<&wgpu::Texture> {
        self.shown.as_ref()
    }

    /// Takes a runner's texture, linear from 0 to 1. Waits for nothing. Tells whether the texture
    /// that is shown is another one now.
    ///
    /// # Errors
    /// If the runner has no such texture, or the device refuses.
    pub fn take(&mut self, gpu: &Gpu, runner: &Runner, object: ObjectRef) -> Result<bool, Diagnostic> {
        let source = runner.texture(object).ok_or_else(|| refused("there is no picture"))?;
        let size = wgpu::Extent3d { width: source.width(), height: source.height(), depth_or_array_layers: 1 };
        let kept = self.shown.take().filter(|shown| shown.size() == size);
        let is_new = kept.is_none();
        let bound = self.bound.take().filter(|b| b.source == *source && kept.as_ref() == Some(&b.shown));
        let bound = errors::scoped(gpu, || {
            let bound =
                bound.unwrap_or_else(|| self.bind(gpu, source, kept.unwrap_or_else(|| texture(gpu.device(), size))));
            self.encode(gpu, &bound);
            bound
        });
        let bound = bound.map_err(|e| refused(&e))?;
        self.shown = Some(bound.shown.clone());
        self.bound = Some(bound);
        Ok(is_new)
    }

    fn bind(&self, gpu: &Gpu, source: &wgpu::Texture, shown: wgpu::Texture) -> Bound {
        let view = |texture: &wgpu::Texture| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2),
                mip_level_count: Some(1),
                array_layer_count: Some(1),
                ..wgpu::TextureViewDescriptor::default()
            })
        };
        let group = gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("screen"),
            layout: &self.layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(&view(source)),
            }],
        });
        Bound { source: source.clone(), target: view(&shown), shown, group }
    }

    fn encode(&self, gpu: &Gpu, bound: &Bound) {
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("screen"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &bound.target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
            })],
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &bound.group, &[]);
        pass.draw(0..3, 0..1);
        drop(pass);
        gpu.queue().submit([encoder.finish()]);
    }
}

fn texture(device: &wgpu::Device, size: wgpu::Extent3d) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("screen"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    })
}

fn pipeline(device: &wgpu::Device, layout: &wgpu::BindGroupLayout) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("screen"),
        source: wgpu::ShaderSource::Wgsl(ENCODE.into()),
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("screen"),
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("screen"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(wgpu::TextureFormat::Rgba8Unorm.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn refused(why: &str) -> Diagnostic {
    Diagnostic::error(Code::DEVICE, format!("the device refused the picture for the screen: {why}"))
}
