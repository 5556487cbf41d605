//! Textures and samplers of materials: what a mesh input's draws bind besides the plan's objects.
//!
//! How many there are and how large is known only to files, so that they are no objects of plans.
//! Where a material has none, white stands, or a normal that is straight up.

use std::collections::BTreeMap;
use std::sync::Arc;

use wgpu_types as wgt;

use super::bind::layer_view;
use super::errors;
use super::gpu::Gpu;
use super::kernels::{self, MipWay};
use super::pipeline::PipelineKind;
use super::prepare::{Engine, Runner};
use crate::diagnostic::{Code, Diagnostic};
use crate::format::TextureFormat;
use crate::plan::meshes::MaterialTexture;
use crate::plan::model::Plan;

/// An image as a file stores it, 8 bits each way, rows from the top.
#[derive(Clone, Copy, Debug)]
pub struct MaterialImage<'a> {
    pub width: u32,
    pub height: u32,
    /// The numbers of red, green and blue grow as eyes see, not as light does.
    pub is_srgb: bool,
    pub texels: &'a [[u8; 4]],
}

/// How a texture is looked up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MaterialSampler {
    pub wrap_u: wgt::AddressMode,
    pub wrap_v: wgt::AddressMode,
    pub mag: wgt::FilterMode,
    pub min: wgt::FilterMode,
    /// Absent: only the largest mip is looked at.
    pub mip: Option<wgt::MipmapFilterMode>,
}

/// A material's textures in the order of [`MaterialTexture::ALL`]: which image, looked up how.
pub type MaterialSlots = [Option<(usize, MaterialSampler)>; 5];

/// What stands for the textures of an input's materials.
#[derive(Debug)]
struct Set {
    textures: Vec<wgpu::TextureView>,
    samplers: Vec<(MaterialSampler, wgpu::Sampler)>,
    of: Vec<MaterialSlots>,
    bytes: u64,
}

/// Textures of materials by input, and what stands in for them.
#[derive(Clone, Debug, Default)]
pub(super) struct Materials {
    sets: BTreeMap<String, Arc<Set>>,
    standing_in: Option<Arc<StandIns>>,
}

#[derive(Debug)]
struct StandIns {
    white: wgpu::TextureView,
    flat: wgpu::TextureView,
    sampler: wgpu::Sampler,
}

const REPEATED: MaterialSampler = MaterialSampler {
    wrap_u: wgt::AddressMode::Repeat,
    wrap_v: wgt::AddressMode::Repeat,
    mag: wgt::FilterMode::Linear,
    min: wgt::FilterMode::Linear,
    mip: Some(wgt::MipmapFilterMode::Linear),
};

impl Materials {
    /// Those of the plan before, with what stands in where a plan draws with materials.
    pub fn new(gpu: &Gpu, plan: &Plan, previous: Option<&Materials>) -> Self {
        let mut materials = previous.cloned().unwrap_or_default();
        materials.sets.retain(|input, _| plan.binds_materials(input));
        if materials.standing_in.is_none() && plan.materials().next().is_some() {
            let one = |label, texel: [u8; 4]| {
                let texture = texture(gpu, label, [1, 1], TextureFormat::Rgba8Unorm);
                write(gpu, &texture, &[texel]);
                texture.create_view(&wgpu::TextureViewDescriptor::default())
            };
            materials.standing_in = Some(Arc::new(StandIns {
                white: one("white", [255; 4]),
                flat: one("a flat normal", [128, 128, 255, 255]),
                sampler: sampler(gpu, REPEATED),
            }));
        }
        materials
    }

    pub fn has(&self, input: &str) -> bool {
        self.sets.contains_key(input)
    }

    pub fn bytes(&self) -> u64 {
        self.sets.values().map(|set| set.bytes).sum()
    }

    pub fn texture(&self, input: &str, material: u32, of: MaterialTexture) -> Result<&wgpu::TextureView, String> {
        let standing_in = self.standing_in.as_ref().ok_or("no material was expected")?;
        let found = self.sets.get(input).and_then(|set| {
            let (image, _) = (*set.of.get(material as usize)?)[of as usize]?;
            set.textures.get(image)
        });
        Ok(found.unwrap_or(match of {
            MaterialTexture::Normal => &standing_in.flat,
            _ => &standing_in.white,
        }))
    }

    pub fn sampler(&self, input: &str, material: u32, of: MaterialTexture) -> Result<&wgpu::Sampler, String> {
        let standing_in = self.standing_in.as_ref().ok_or("no material was expected")?;
        let found = self.sets.get(input).and_then(|set| {
            let (_, wanted) = (*set.of.get(material as usize)?)[of as usize]?;
            set.samplers.iter().find(|(about, _)| *about == wanted).map(|(_, sampler)| sampler)
        });
        Ok(found.unwrap_or(&standing_in.sampler))
    }
}

impl Runner {
    /// Whether draws bind textures of this input's materials.
    pub fn wants_materials(&self, input: &str) -> bool {
        self.plan.binds_materials(input)
    }

    /// Whether the textures of this input's materials are there already.
    pub fn has_materials(&self, input: &str) -> bool {
        self.materials.has(input)
    }

    /// Gives the materials of an input their textures, with mips.
    ///
    /// # Errors
    /// If the device refuses one of them.
    pub fn upload_materials(
        &mut self,
        engine: &Engine,
        input: &str,
        images: &[MaterialImage<'_>],
        materials: Vec<MaterialSlots>,
    ) -> Result<(), Diagnostic> {
        let mut kinds: Vec<MaterialSampler> = Vec::new();
        for (_, kind) in materials.iter().flatten().flatten() {
            if !kinds.contains(kind) {
                kinds.push(*kind);
            }
        }
        let refused = |error: String| {
            Diagnostic::error(Code::DEVICE, format!("the device refused the textures of `{input}`: {error}"))
        };
        let mut textures = Vec::with_capacity(images.len());
        let mut bytes = 0;
        for image in images {
            let texture = upload(engine, image).map_err(refused)?;
            bytes += u64::from(texture.width()) * u64::from(texture.height()) * 16 / 3;
            textures.push(texture.create_view(&wgpu::TextureViewDescriptor::default()));
        }
        let gpu = engine.gpu();
        let samplers = errors::scoped(gpu, || kinds.iter().map(|kind| (*kind, sampler(gpu, *kind))).collect());
        let set = Set { textures, samplers: samplers.map_err(refused)?, of: materials, bytes };
        self.materials.sets.insert(input.to_owned(), Arc::new(set));
        self.forget_materials(input);
        self.changes.note_input(input);
        Ok(())
    }
}

/// A texture of an image and its mips. What is larger than the device can do is halved until it
/// fits: a model is drawn coarser rather than not at all.
fn upload(engine: &Engine, image: &MaterialImage<'_>) -> Result<wgpu::Texture, String> {
    let most = engine.gpu().limits().max_texture_dimension_2d;
    let (mut width, mut height) = (image.width.max(1), image.height.max(1));
    let mut halved: Option<Vec<[u8; 4]>> = None;
    while width > most || height > most {
        halved = Some(half(halved.as_deref().unwrap_or(image.texels), width, height));
        (width, height) = ((width / 2).max(1), (height / 2).max(1));
    }
    let texels = halved.as_deref().unwrap_or(image.texels);
    if texels.len() as u64 != u64::from(width) * u64::from(height) {
        return Err(format!("an image of {width} x {height} has {} texels", texels.len()));
    }
    let format = if image.is_srgb { TextureFormat::Rgba8UnormSrgb } else { TextureFormat::Rgba8Unorm };
    let gpu = engine.gpu();
    let texture = errors::scoped(gpu, || {
        let texture = texture(gpu, "a material's texture", [width, height], format);
        write(gpu, &texture, texels);
        texture
    })?;
    make_mips(engine, &texture)?;
    Ok(texture)
}

/// Every second texel each way.
fn half(texels: &[[u8; 4]], width: u32, height: u32) -> Vec<[u8; 4]> {
    let (w, h) = ((width / 2).max(1) as usize, (height / 2).max(1) as usize);
    let at = |x: usize, y: usize| texels.get(2 * y * width as usize + 2 * x).copied().unwrap_or_default();
    (0..w * h).map(|i| at(i % w, i / w)).collect()
}

fn texture(gpu: &Gpu, label: &str, [width, height]: [u32; 2], format: TextureFormat) -> wgpu::Texture {
    gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: width.max(height).ilog2() + 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgt::TextureUsages::TEXTURE_BINDING
            | wgt::TextureUsages::COPY_DST
            | wgt::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    })
}

fn write(gpu: &Gpu, texture: &wgpu::Texture, texels: &[[u8; 4]]) {
    gpu.queue().write_texture(
        texture.as_image_copy(),
        texels.as_flattened(),
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(texture.width() * 4),
            rows_per_image: Some(texture.height()),
        },
        texture.size(),
    );
}

fn make_mips(engine: &Engine, texture: &wgpu::Texture) -> Result<(), String> {
    if texture.mip_level_count() < 2 {
        return Ok(());
    }
    let pipeline = engine.kernel(&kernels::reduce(texture.format(), MipWay::Draw), "mips of materials")?;
    let (PipelineKind::Draw(draw), Some(layout)) = (&pipeline.kind, &pipeline.layout) else {
        return Err("the mip kernel is no draw".into());
    };
    let gpu = engine.gpu();
    errors::scoped(gpu, || {
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        for mip in 1..texture.mip_level_count() {
            let above = layer_view(texture, mip - 1, 0);
            let made = layer_view(texture, mip, 0);
            let resource = wgpu::BindingResource::TextureView(&above);
            let entries = [wgpu::BindGroupEntry { binding: 0, resource }];
            let group =
                gpu.device().create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries });
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("mips of materials"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &made,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgt::Operations {
                        load: wgt::LoadOp::Clear(wgt::Color::TRANSPARENT),
                        store: wgt::StoreOp::Store,
                    },
                })],
                ..wgpu::RenderPassDescriptor::default()
            });
            pass.set_pipeline(draw);
            pass.set_bind_group(0, &group, &[]);
            pass.draw(0..3, 0..1);
        }
        gpu.queue().submit([encoder.finish()]);
    })
}

fn sampler(gpu: &Gpu, about: MaterialSampler) -> wgpu::Sampler {
    gpu.device().create_sampler(&wgpu::SamplerDescriptor {
        label: Some("a material's sampler"),
        address_mode_u: about.wrap_u,
        address_mode_v: about.wrap_v,
        mag_filter: about.mag,
        min_filter: about.min,
        mipmap_filter: about.mip.unwrap_or(wgt::MipmapFilterMode::Nearest),
        lod_max_clamp: if about.mip.is_some() { 32.0 } else { 0.0 },
        ..wgpu::SamplerDescriptor::default()
    })
}
