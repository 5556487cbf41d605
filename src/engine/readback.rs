//! Reading results back. These wait for the GPU.

use std::ops::Range;
use std::sync::mpsc;

use wgpu_types::TextureFormat;

use super::bind::{depth_needs_draw, layer_view};
use super::errors;
use super::kernels;
use super::mips::padded_row;
use super::pipeline::PipelineKind;
use super::prepare::{Engine, Runner};
use super::texel;
use crate::diagnostic::{Code, Diagnostic};
use crate::plan::model::{ObjectKind, ObjectRef};

/// Texels of one mip, rows from the top, layers (or slices) one after another, nothing between.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureData {
    /// Of what is in `bytes`: depth of 24 bits comes as `R32Float`, depth with stencil without
    /// its stencil.
    pub format: TextureFormat,
    pub width: u32,
    pub height: u32,
    pub layers: u32,
    pub bytes: Vec<u8>,
}

impl TextureData {
    /// Each texel as red, green, blue, alpha; what the format lacks is 0, alpha 1. Formats that
    /// store sRGB come out linear.
    pub fn to_rgba_f32(&self) -> Vec<[f32; 4]> {
        let Some(size) = texel::size(self.format) else { return Vec::new() };
        self.bytes.chunks_exact(size).filter_map(|t| texel::decode(self.format, t)).collect()
    }
}

impl Runner {
    /// The content of one mip; of one layer (or slice), or of all.
    ///
    /// # Errors
    /// If it is no texture or has no such part, or the device fails.
    pub fn read_texture(
        &self,
        engine: &mut Engine,
        object: ObjectRef,
        mip: u32,
        layer: Option<u32>,
    ) -> Result<TextureData, Diagnostic> {
        let id = self.resolved(object)?;
        let about = &self.plan.objects[id];
        let fail = |why: &str| {
            Diagnostic::error(Code::OUT_OF_RANGE, format!("`{}` {why}", about.path)).at(about.span, "declared here")
        };
        let ObjectKind::Texture(planned) = &about.kind else { return Err(fail("is no texture")) };
        let texture = self.pool.texture(id).ok_or_else(|| fail("has no content yet"))?;
        if self.pool.is_unstored(id) {
            return Err(fail("is never stored: no pass needs it after it was drawn")
                .hint("ask for it when planning, by `roots`"));
        }
        if mip >= planned.mips {
            return Err(fail(&format!("has {} mips, and no mip {mip}", planned.mips)));
        }
        let all = if planned.is_3d { (planned.layers >> mip).max(1) } else { planned.layers };
        let layers = match layer {
            Some(layer) if layer >= all => {
                return Err(fail(&format!("has {all} layers in mip {mip}, and no layer {layer}")));
            }
            Some(layer) => layer..layer + 1,
            None => 0..all,
        };
        if planned.samples > 1 {
            return Err(fail("has several samples").hint("resolve it into another texture, and read that"));
        }
        let read = if depth_needs_draw(planned.format) {
            read_drawn_depth(engine, texture, mip, layers)
        } else {
            read_layers(engine, texture, mip, layers)
        };
        read.map_err(|failure| failure.at_object(&about.path, about.span))
    }

    /// The bytes of a buffer, with the header of a counted one.
    ///
    /// # Errors
    /// If it is no buffer, or the device fails.
    pub fn read_buffer(&self, engine: &Engine, object: ObjectRef) -> Result<Vec<u8>, Diagnostic> {
        let id = self.resolved(object)?;
        let about = &self.plan.objects[id];
        let (ObjectKind::Buffer(planned), Some(buffer)) = (&about.kind, self.pool.buffer(id)) else {
            return Err(Diagnostic::error(Code::OUT_OF_RANGE, format!("`{}` is no buffer with content", about.path))
                .at(about.span, "declared here"));
        };
        let bytes = planned.bytes();
        let read = fetch(engine, bytes, |encoder, target| encoder.copy_buffer_to_buffer(buffer, 0, target, 0, bytes));
        read.map_err(|failure| failure.at_object(&about.path, about.span))
    }
}

/// Why reading failed.
enum Failure {
    /// The device says so, wherever it came from.
    Device(Diagnostic),
    /// wgpu refused the copy.
    Copy(String),
}

impl Failure {
    fn at_object(self, path: &str, span: crate::diagnostic::Span) -> Diagnostic {
        match self {
            Failure::Device(diagnostic) => diagnostic,
            Failure::Copy(error) => errors::refused("reading", path, span, &error),
        }
    }
}

fn read_layers(engine: &Engine, texture: &wgpu::Texture, mip: u32, layers: Range<u32>) -> Result<TextureData, Failure> {
    let source = texture.format();
    let format = match source {
        TextureFormat::Depth32FloatStencil8 => TextureFormat::Depth32Float,
        other => other,
    };
    let aspect = if source.has_depth_aspect() { wgpu::TextureAspect::DepthOnly } else { wgpu::TextureAspect::All };
    let texel = texel::size(format).ok_or_else(|| Failure::Copy(format!("{format:?} cannot be read back")))?;
    let (width, height) = ((texture.width() >> mip).max(1), (texture.height() >> mip).max(1));
    let row = padded_row(format, width, texel);
    let count = layers.len() as u32;
    let bytes = u64::from(row) * u64::from(height) * u64::from(count);
    let padded = fetch(engine, bytes, |encoder, target| {
        encoder.copy_texture_to_buffer(
            wgpu::TexelCopyTextureInfo {
                texture,
                mip_level: mip,
                origin: wgpu::Origin3d { x: 0, y: 0, z: layers.start },
                aspect,
            },
            wgpu::TexelCopyBufferInfo {
                buffer: target,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(row),
                    rows_per_image: Some(height),
                },
            },
            wgpu::Extent3d { width, height, depth_or_array_layers: count },
        );
    })?;
    let mut tight = Vec::with_capacity(width as usize * height as usize * count as usize * texel);
    for line in padded.chunks_exact(row as usize) {
        tight.extend_from_slice(&line[..width as usize * texel]);
    }
    Ok(TextureData { format, width, height, layers: count, bytes: tight })
}

/// Draws depth into a float texture, and reads that.
fn read_drawn_depth(
    engine: &mut Engine,
    texture: &wgpu::Texture,
    mip: u32,
    layers: Range<u32>,
) -> Result<TextureData, Failure> {
    let (width, height) = ((texture.width() >> mip).max(1), (texture.height() >> mip).max(1));
    let count = layers.len() as u32;
    let pipeline = engine.kernel(&kernels::depth(), "depth").map_err(Failure::Copy)?;
    let gpu = engine.gpu();
    let drawn = errors::scoped(gpu, || {
        let color = gpu.device().create_texture(&wgpu::TextureDescriptor {
            label: Some("depth"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: count },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: TextureFormat::R32Float,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        for (into, layer) in (0..).zip(layers) {
            let depth = texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2),
                aspect: wgpu::TextureAspect::DepthOnly,
                base_mip_level: mip,
                mip_level_count: Some(1),
                base_array_layer: layer,
                array_layer_count: Some(1),
                ..wgpu::TextureViewDescriptor::default()
            });
            let (PipelineKind::Draw(draw), Some(layout)) = (&pipeline.kind, &pipeline.layout) else { continue };
            let group = gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("depth"),
                layout,
                entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&depth) }],
            });
            let view = layer_view(&color, 0, into);
            let ops = wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store };
            let mut render = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("depth"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops,
                })],
                ..wgpu::RenderPassDescriptor::default()
            });
            render.set_pipeline(draw);
            render.set_bind_group(0, &group, &[]);
            render.draw(0..3, 0..1);
        }
        gpu.queue().submit([encoder.finish()]);
        color
    });
    read_layers(engine, &drawn.map_err(Failure::Copy)?, 0, 0..count)
}

/// Runs a copy into a buffer that can be read, waits, and gives its bytes.
fn fetch(
    engine: &Engine,
    bytes: u64,
    copy: impl FnOnce(&mut wgpu::CommandEncoder, &wgpu::Buffer),
) -> Result<Vec<u8>, Failure> {
    let gpu = engine.gpu();
    gpu.check().map_err(Failure::Device)?;
    let (sender, receiver) = mpsc::channel();
    let buffer = errors::scoped(gpu, || {
        let buffer = gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some("readback"),
            size: bytes,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        copy(&mut encoder, &buffer);
        gpu.queue().submit([encoder.finish()]);
        buffer.map_async(wgpu::MapMode::Read, .., move |mapped| {
            // The receiver is gone only if nobody waits any more.
            _ = sender.send(mapped);
        });
        buffer
    })
    .map_err(Failure::Copy)?;
    gpu.wait().map_err(Failure::Device)?;
    match receiver.try_recv() {
        Ok(Ok(())) => {}
        Ok(Err(error)) => return Err(Failure::Copy(error.to_string())),
        Err(_) => return Err(Failure::Copy("the buffer was not mapped".into())),
    }
    let view = buffer.get_mapped_range(..).map_err(|e| Failure::Copy(e.to_string()))?;
    Ok(view.to_vec())
}
