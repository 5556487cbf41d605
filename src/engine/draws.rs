//! A draw made ready: all that encoding it looks at in a frame.

use wgpu_types as wgt;

use super::bind::Bench;
use super::meshes::MeshVariant;
use super::pipeline::{Pipeline, PipelineKind};
use crate::plan::model::{ColorTarget, DepthTarget, Draw, Geometry, Pass, View};

#[derive(Debug)]
pub(super) struct DrawVariant {
    pub pipeline: Option<wgpu::RenderPipeline>,
    pub group: Option<wgpu::BindGroup>,
    pub vertices: Vertices,
    /// Pixels: x, y, width, height. Absent: all of the targets.
    pub region: Option<[u32; 4]>,
    pub extent: [u32; 2],
    pub stencil_reference: Option<u32>,
    pub color: Vec<ColorAttachment>,
    pub depth: Option<DepthAttachment>,
    pub indices: Option<wgpu::Buffer>,
    pub meshes: Option<Box<MeshVariant>>,
}

/// What a draw without meshes draws. None of nothing is made.
#[derive(Clone, Copy, Debug)]
pub(super) enum Vertices {
    Nothing,
    Direct { vertices: u32, instances: u32 },
    Indexed { count: u32, instances: u32 },
    Indirect { slot: u32 },
    IndexedIndirect { slot: u32 },
}

#[derive(Debug)]
pub(super) struct ColorAttachment {
    pub view: wgpu::TextureView,
    pub resolve: Option<wgpu::TextureView>,
    pub load: wgt::LoadOp<wgt::Color>,
    pub store: wgt::StoreOp,
}

#[derive(Debug)]
pub(super) struct DepthAttachment {
    pub view: wgpu::TextureView,
    /// How each aspect is loaded that the draw writes. Others are read only, so that the pass may
    /// sample them.
    pub depth: Option<wgt::LoadOp<f32>>,
    pub stencil: Option<wgt::LoadOp<u32>>,
    pub store: wgt::StoreOp,
}

impl Bench<'_> {
    /// # Errors
    /// A message if the plan refers to something that is not there.
    pub fn draw(
        &self,
        index: usize,
        pass: &Pass,
        pipeline: Option<&Pipeline>,
        draw: &Draw,
    ) -> Result<DrawVariant, String> {
        let indices = match draw.geometry {
            Geometry::Indexed { indices, .. } | Geometry::Indirect { indices: Some(indices), .. } => {
                Some(self.buffer(indices)?.clone())
            }
            _ => None,
        };
        let meshes = self.meshes(index, pass, draw, pipeline)?;
        let group = if meshes.is_some() { None } else { self.group(pass, pipeline, &draw.shader.bindings, 0)? };
        let pipeline = match pipeline.map(|p| &p.kind) {
            Some(PipelineKind::Draw(pipeline)) => Some(pipeline.clone()),
            _ => None,
        };
        Ok(DrawVariant {
            pipeline,
            group,
            vertices: vertices(&draw.geometry),
            region: draw.region,
            extent: draw.extent,
            stencil_reference: draw.depth.as_ref().and_then(|d| d.stencil.as_ref()).map(|s| s.reference),
            color: draw.color.iter().map(|target| self.color(target)).collect::<Result<_, String>>()?,
            depth: draw.depth.as_ref().map(|target| self.depth(target)).transpose()?,
            indices,
            meshes: meshes.map(Box::new),
        })
    }

    fn color(&self, target: &ColorTarget) -> Result<ColorAttachment, String> {
        let load = match target.clear {
            Some([r, g, b, a]) => wgt::LoadOp::Clear(wgt::Color { r, g, b, a }),
            // On a processor, keeping what is there costs less than clearing it.
            None if target.discard_before && self.gpu.info().device_type != wgt::DeviceType::Cpu => {
                wgt::LoadOp::Clear(wgt::Color::TRANSPARENT)
            }
            // Whoever chose this draw without the first one of its render pass.
            None if self.is_unstored(&target.view) => wgt::LoadOp::Clear(wgt::Color::TRANSPARENT),
            None => wgt::LoadOp::Load,
        };
        let resolve = target.resolve.as_ref().map(|v| self.attachment(v)).transpose()?;
        Ok(ColorAttachment { view: self.attachment(&target.view)?, resolve, load, store: self.store(&target.view) })
    }

    fn depth(&self, target: &DepthTarget) -> Result<DepthAttachment, String> {
        let stencil = target.stencil.as_ref();
        let is_unstored = self.is_unstored(&target.view);
        let writes_depth = target.write || target.clear.is_some() || is_unstored;
        let writes_stencil = stencil.is_some_and(|s| s.write_mask != 0 || s.clear.is_some());
        let load = target.clear.or(is_unstored.then_some(0.0)).map_or(wgt::LoadOp::Load, wgt::LoadOp::Clear);
        let load_stencil = stencil.and_then(|s| s.clear).map_or(wgt::LoadOp::Load, wgt::LoadOp::Clear);
        Ok(DepthAttachment {
            view: self.attachment(&target.view)?,
            depth: (target.format.has_depth_aspect() && writes_depth).then_some(load),
            stencil: (target.format.has_stencil_aspect() && writes_stencil).then_some(load_stencil),
            store: self.store(&target.view),
        })
    }

    fn is_unstored(&self, view: &View) -> bool {
        self.pool.is_unstored(self.object(view.object))
    }

    fn store(&self, view: &View) -> wgt::StoreOp {
        if self.is_unstored(view) { wgt::StoreOp::Discard } else { wgt::StoreOp::Store }
    }
}

fn vertices(geometry: &Geometry) -> Vertices {
    match *geometry {
        Geometry::Fullscreen => Vertices::Direct { vertices: 3, instances: 1 },
        Geometry::Direct { vertices, instances } if vertices > 0 && instances > 0 => {
            Vertices::Direct { vertices, instances }
        }
        Geometry::Indexed { count, instances, .. } if count > 0 && instances > 0 => {
            Vertices::Indexed { count, instances }
        }
        Geometry::Direct { .. } | Geometry::Indexed { .. } | Geometry::Meshes(_) => Vertices::Nothing,
        Geometry::Indirect { slot, indices: None } => Vertices::Indirect { slot },
        Geometry::Indirect { slot, indices: Some(_) } => Vertices::IndexedIndirect { slot },
    }
}
