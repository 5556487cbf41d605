//! Draws of meshes: vertex buffers, one pipeline for each way triangles face, and a bind group for
//! each material.

use std::collections::BTreeMap;
use std::sync::Arc;

use wgpu_types as wgt;

use super::bind::Bench;
use super::pipeline::{Pipeline, PipelineKind, Recipe, RecipeKind, VertexSlot};
use super::prepare::Runner;
use crate::plan::meshes::{Faces, MeshDraw, MeshGeometry, VertexAttribute};
use crate::plan::model::{Binding, Bound, Draw, Geometry, Pass, PassKind};

/// The pipelines of a pass by [`Faces::index`]; absent where nothing faces so.
pub(super) type ByFaces = [Option<Arc<Pipeline>>; 4];

/// What a draw of meshes needs at hand.
#[derive(Debug)]
pub(super) struct MeshVariant {
    /// By material; one for all if the shader binds nothing of materials.
    groups: BTreeMap<u32, wgpu::BindGroup>,
    /// In the order of the plan's vertex buffers.
    vertices: Vec<wgpu::Buffer>,
    indices: wgpu::Buffer,
    pipelines: ByFaces,
}

/// How vertices are read.
pub(super) fn slots(draw: &Draw) -> Vec<VertexSlot> {
    let Geometry::Meshes(meshes) = &draw.geometry else { return Vec::new() };
    let slot = |vertex: &crate::plan::meshes::VertexBuffer| {
        let components = vertex.attribute.components();
        VertexSlot {
            stride: u64::from(4 * components),
            step: match vertex.attribute {
                VertexAttribute::Instance => wgt::VertexStepMode::Instance,
                _ => wgt::VertexStepMode::Vertex,
            },
            format: match (vertex.attribute, components) {
                (VertexAttribute::Instance, _) => wgt::VertexFormat::Uint32,
                (_, 2) => wgt::VertexFormat::Float32x2,
                (_, 3) => wgt::VertexFormat::Float32x3,
                _ => wgt::VertexFormat::Float32x4,
            },
            location: vertex.location,
        }
    };
    meshes.vertices.iter().map(slot).collect()
}

/// Pipelines for the ways in which a draw's triangles face, from that of the pass.
pub(super) fn by_faces(
    recipe: &Recipe,
    pass: &Pass,
    get: &mut dyn FnMut(&Recipe) -> Result<Arc<Pipeline>, String>,
) -> Result<Option<ByFaces>, String> {
    let PassKind::Draw(draw) = &pass.kind else { return Ok(None) };
    let Geometry::Meshes(meshes) = &draw.geometry else { return Ok(None) };
    let mut pipelines = ByFaces::default();
    for faces in Faces::ALL {
        if meshes.draws.iter().any(|call| call.faces == faces) {
            pipelines[faces.index()] = Some(get(&facing(recipe.clone(), faces))?);
        }
    }
    Ok(Some(pipelines))
}

fn facing(mut recipe: Recipe, faces: Faces) -> Recipe {
    if let RecipeKind::Draw { primitive, .. } = &mut recipe.kind {
        if faces.double_sided {
            primitive.cull_mode = None;
        }
        if faces.mirrored {
            primitive.front_face = match primitive.front_face {
                wgt::FrontFace::Ccw => wgt::FrontFace::Cw,
                wgt::FrontFace::Cw => wgt::FrontFace::Ccw,
            };
        }
    }
    recipe
}

impl Bench<'_> {
    /// What a draw of meshes needs; nothing for other draws.
    pub fn meshes(
        &self,
        index: usize,
        pass: &Pass,
        draw: &Draw,
        pipeline: Option<&Pipeline>,
    ) -> Result<Option<MeshVariant>, String> {
        let Geometry::Meshes(meshes) = &draw.geometry else { return Ok(None) };
        let bindings = &draw.shader.bindings;
        let mut groups = BTreeMap::new();
        for call in &meshes.draws {
            let material = material_of(bindings, call.material);
            if !groups.contains_key(&material)
                && let Some(group) = self.group(pass, pipeline, bindings, material)?
            {
                groups.insert(material, group);
            }
        }
        let mut vertices = Vec::with_capacity(meshes.vertices.len());
        for vertex in &meshes.vertices {
            vertices.push(match vertex.buffer {
                Some(buffer) => self.buffer(buffer)?.clone(),
                None => self.counting(pass, meshes),
            });
        }
        let indices = self.buffer(meshes.indices)?.clone();
        let pipelines = self.by_faces.get(index).cloned().flatten().unwrap_or_default();
        Ok(Some(MeshVariant { groups, vertices, indices, pipelines }))
    }

    /// 0, 1, 2 and so on: the instances of all calls.
    fn counting(&self, pass: &Pass, meshes: &MeshGeometry) -> wgpu::Buffer {
        let most = meshes.draws.iter().map(|call| call.first_instance + call.instances).max().unwrap_or(0);
        let words: Vec<u32> = (0..most.max(1)).collect();
        self.constant(&pass.path, &words, wgpu::BufferUsages::VERTEX)
    }
}

impl Runner {
    /// Draws the blended primitives of an input from back to front; `away` tells how far from the eye an instance is.
    pub fn sort_blended(&mut self, input: &str, away: &dyn Fn(u32) -> f32) {
        for pass in &mut self.plan.passes {
            let PassKind::Draw(draw) = &mut pass.kind else { continue };
            let Geometry::Meshes(meshes) = &mut draw.geometry else { continue };
            if meshes.input == input {
                let first = meshes.draws.partition_point(|call| !call.blended);
                let order = |a: &MeshDraw, b: &MeshDraw| {
                    let [from_a, from_b] = [a, b].map(|call| away(call.first_instance));
                    from_b.total_cmp(&from_a).then(a.first_instance.cmp(&b.first_instance))
                };
                // A stable sort would allocate, in every frame.
                meshes.draws[first..].sort_unstable_by(order);
            }
        }
    }

    /// Forgets bind groups with textures of an input's materials.
    pub(super) fn forget_materials(&mut self, input: &str) {
        for (pass, variants) in self.plan.passes.iter().zip(&mut self.variants) {
            let PassKind::Draw(draw) = &pass.kind else { continue };
            if matches!(&draw.geometry, Geometry::Meshes(meshes) if meshes.input == input) {
                variants.clear();
            }
        }
    }
}

/// The material whose group a call binds: the first for all, if none makes a difference.
fn material_of(bindings: &[Binding], material: u32) -> u32 {
    let differs = |bound: &Bound| {
        matches!(bound, Bound::Material { .. } | Bound::MaterialTexture { .. } | Bound::MaterialSampler { .. })
    };
    if bindings.iter().any(|b| differs(&b.bound)) { material } else { 0 }
}

/// Encodes all calls of a draw. `first_instance` stays 0: `instance` is counted by a vertex buffer.
pub(super) fn encode(render: &mut wgpu::RenderPass<'_>, draw: &Draw, variant: &MeshVariant) {
    let Geometry::Meshes(meshes) = &draw.geometry else { return };
    render.set_index_buffer(variant.indices.slice(..), wgt::IndexFormat::Uint32);
    for (slot, (vertex, buffer)) in (0..).zip(meshes.vertices.iter().zip(&variant.vertices)) {
        if vertex.buffer.is_some() {
            render.set_vertex_buffer(slot, buffer.slice(..));
        }
    }
    let (mut faces, mut material) = (None, None);
    for call in meshes.draws.iter().filter(|call| call.indices > 0 && call.instances > 0) {
        if faces != Some(call.faces) {
            let pipeline = variant.pipelines[call.faces.index()].as_deref();
            let Some(PipelineKind::Draw(pipeline)) = pipeline.map(|p| &p.kind) else { continue };
            render.set_pipeline(pipeline);
            faces = Some(call.faces);
        }
        let wanted = material_of(&draw.shader.bindings, call.material);
        if material != Some(wanted) {
            if let Some(group) = variant.groups.get(&wanted) {
                render.set_bind_group(0, group, &[]);
            }
            material = Some(wanted);
        }
        for (slot, (vertex, buffer)) in (0..).zip(meshes.vertices.iter().zip(&variant.vertices)) {
            if vertex.buffer.is_none() {
                render.set_vertex_buffer(slot, buffer.slice(u64::from(call.first_instance) * 4..));
            }
        }
        render.draw_indexed(call.first_index..call.first_index + call.indices, 0, 0..call.instances);
    }
}
