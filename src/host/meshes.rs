//! Bodies of a scene as one input of a graph: all their vertices one after the other, a list of
//! calls that draw them, and where they are at a time.

mod materials;
mod poses;

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use glam::{DMat4, Mat4, Vec3};

use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::graph::value::Value;
use crate::plan::meshes::{Faces, MaterialTexture, MeshDraw, MeshesInfo, VertexAttribute};
use crate::plan::packing;
use crate::scene::MeshEntry;
use crate::scene::image::Stored;
use crate::scene::meshes::{AlphaMode, Bounds, FARTHEST_M, Material, Model, Pose, Primitive, is_mirrored};
use crate::shader::reflect::Type;
use materials::slots;
pub(super) use poses::{Entry, Standing, animation, choice};

/// Bodies ready to be handed to a device.
#[derive(Debug, Default)]
pub struct Meshes {
    pub info: MeshesInfo,
    vertices: Vertices,
    materials: Vec<Material>,
    /// Which of the images each material's textures are, in the order of `MaterialTexture::ALL`.
    pub(super) textures: Vec<[Option<usize>; 5]>,
    pub(super) images: Vec<(Arc<Stored>, bool)>,
    bodies: Vec<Mat4>,
    /// An entry of the scene for each group of instances that moves together.
    entries: Vec<Entry>,
    instances: Vec<Instance>,
    /// Instances that blend, each with the middle of its box in the space of its node.
    blended: Vec<(u32, Vec3)>,
}

#[derive(Debug, Default)]
struct Vertices {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    tangents: Vec<[f32; 4]>,
    uv0: Vec<[f32; 2]>,
    uv1: Vec<[f32; 2]>,
    color0: Vec<[f32; 4]>,
    indices: Vec<u32>,
}

/// A primitive placed in a body.
#[derive(Clone, Copy, Debug)]
struct Instance {
    entry: usize,
    node: usize,
    body: u32,
    first_triangle: u32,
    triangles: u32,
    material: u32,
}

/// Where a model's primitives and materials lie among all.
struct Placed {
    /// By mesh and primitive.
    indices: Vec<Vec<Range<u32>>>,
    first_material: u32,
}

impl Meshes {
    /// Puts bodies together.
    ///
    /// # Errors
    /// If an entry asks for an animation that its file does not have, or there is more than can be
    /// counted.
    pub fn new(parts: &[(&MeshEntry, Arc<Model>)]) -> Result<Self, Diagnostics> {
        let mut meshes = Self::default();
        let mut placed: Vec<(Arc<Model>, Placed)> = Vec::new();
        let mut found = Diagnostics::new();
        for (entry, model) in parts {
            let known = placed.iter().position(|(other, _)| Arc::ptr_eq(other, model));
            let at = match known {
                Some(at) => at,
                None => {
                    placed.push((Arc::clone(model), meshes.place(model)));
                    placed.len() - 1
                }
            };
            match animation(entry, model) {
                Ok((animation, loops, start_s)) => {
                    meshes.entries.push(Entry { model: Arc::clone(model), animation, loops, start_s });
                    meshes.add(entry, &placed[at].1);
                }
                Err(error) => found.push(error),
            }
        }
        if u32::try_from(meshes.vertices.indices.len()).is_err() {
            found.push(Diagnostic::error(Code::ASSET, "the scene's meshes have more than 4,294,967,295 indices"));
        }
        if !found.is_empty() {
            return Err(found);
        }
        let (bounds, far) = meshes.extent();
        if let Some(far) = far {
            return Err(too_far(parts, far).into());
        }
        meshes.sort_draws();
        meshes.fill_info(parts, bounds);
        Ok(meshes)
    }

    /// Appends a model's vertices, triangles and materials.
    fn place(&mut self, model: &Model) -> Placed {
        let indices = model
            .meshes
            .iter()
            .map(|mesh| mesh.primitives.iter().map(|primitive| self.vertices.append(primitive)).collect())
            .collect();
        let first_material = self.materials.len() as u32;
        self.materials.extend(model.materials.iter().cloned());
        for material in &model.materials {
            let slots = slots(material).map(|(slot, used)| {
                let image = model.images.get(used?.image)?;
                Some(self.image(image, matches!(slot, MaterialTexture::BaseColor | MaterialTexture::Emissive)))
            });
            self.textures.push(slots);
        }
        Placed { indices, first_material }
    }

    /// An image among all, once for each way that its numbers are read.
    fn image(&mut self, image: &Arc<Stored>, is_srgb: bool) -> usize {
        let same = |(other, way): &(Arc<Stored>, bool)| Arc::ptr_eq(other, image) && *way == is_srgb;
        self.images.iter().position(same).unwrap_or_else(|| {
            self.images.push((Arc::clone(image), is_srgb));
            self.images.len() - 1
        })
    }

    /// Adds the bodies of the last entry, with a call for each primitive that they show.
    fn add(&mut self, about: &MeshEntry, placed: &Placed) {
        let entry = self.entries.len() - 1;
        let model = Arc::clone(&self.entries[entry].model);
        let first_body = self.bodies.len() as u32;
        self.bodies.extend(about.world_from_body.iter().map(DMat4::as_mat4));
        let pose = self.entries[entry].pose(0.0);
        let turning = model.turning(self.entries[entry].animation);
        for (node, body_from_node) in pose.iter().enumerate() {
            let Some((mesh, ranges)) =
                model.nodes[node].mesh.and_then(|m| Some((model.meshes.get(m)?, placed.indices.get(m)?)))
            else {
                continue;
            };
            for (primitive, range) in mesh.primitives.iter().zip(ranges) {
                let material = placed.first_material + primitive.material as u32;
                let (first_index, indices) = (range.start, range.end - range.start);
                let of = &self.materials[material as usize];
                // What turns inside out on its way has no side that is its front all the time.
                let (double_sided, blended) = (of.double_sided || turning[node], of.alpha_mode == AlphaMode::Blend);
                // Mirrored and other bodies have calls of their own, since their fronts differ.
                for mirrored in [false, true] {
                    let first_instance = self.instances.len() as u32;
                    for (i, world) in about.world_from_body.iter().enumerate() {
                        if is_mirrored(world.as_mat4() * *body_from_node) == mirrored {
                            let body = first_body + i as u32;
                            let (first_triangle, triangles) = (first_index / 3, indices / 3);
                            self.instances.push(Instance { entry, node, body, first_triangle, triangles, material });
                        }
                    }
                    let all = first_instance..self.instances.len() as u32;
                    // What blends is sorted by depth, each by itself.
                    let at_once = if blended { 1 } else { all.end - all.start };
                    for first_instance in all.step_by(at_once.max(1) as usize).filter(|_| indices > 0) {
                        self.info.draws.push(MeshDraw {
                            first_index,
                            indices,
                            first_instance,
                            instances: at_once,
                            material,
                            faces: Faces { double_sided, mirrored },
                            blended,
                            tags: about.tags.clone(),
                        });
                    }
                }
            }
        }
    }

    /// What is opaque first, with few changes of pipelines and materials; what blends as the scene has it.
    fn sort_draws(&mut self) {
        let alike = |draw: &MeshDraw| (!draw.blended).then_some((draw.faces, draw.material));
        self.info.draws.sort_by_key(|draw| (draw.blended, alike(draw)));
    }

    /// Whether it matters from where blended primitives are seen.
    pub(super) fn blends_several(&self) -> bool {
        self.blended.len() > 1
    }

    fn fill_info(&mut self, parts: &[(&MeshEntry, Arc<Model>)], Bounds { min, max }: Bounds) {
        let blended = self.info.draws.iter().filter(|draw| draw.blended).map(|draw| draw.first_instance);
        let middle = |at: u32| {
            let of = self.vertices.bounds(&self.instances[at as usize]);
            (at, of.map_or(Vec3::ZERO, |of| (of.min + of.max) * 0.5))
        };
        self.blended = blended.map(middle).collect();
        self.info = MeshesInfo {
            bodies: self.bodies.len() as u64,
            instances: self.instances.len() as u64,
            vertices: self.vertices.positions.len() as u64,
            triangles: self.vertices.indices.len() as u64 / 3,
            materials: self.materials.len() as u32,
            draws: std::mem::take(&mut self.info.draws),
            min: min.as_dvec3().to_array(),
            max: max.as_dvec3().to_array(),
            animated: self.entries.iter().any(|entry| entry.animation.is_some()),
            values: values(parts),
        };
    }

    /// The box around all bodies wherever they come in their animations, and the first instance
    /// that comes too far for anything to be reckoned with it.
    fn extent(&self) -> (Bounds, Option<Instance>) {
        let mut boxes: BTreeMap<u32, Option<Bounds>> = BTreeMap::new();
        for instance in &self.instances {
            boxes.entry(instance.first_triangle).or_insert_with(|| self.vertices.bounds(instance));
        }
        let (mut all, mut far) = (None, None);
        let mut pose = Pose::default();
        for instances in self.instances.chunk_by(|a, b| a.entry == b.entry) {
            let entry = &self.entries[instances[0].entry];
            for time_s in entry.times_s() {
                entry.model.pose_into(entry.animation, time_s, &mut pose);
                for instance in instances {
                    let Some(own) = boxes.get(&instance.first_triangle).copied().flatten() else { continue };
                    let world = self.bodies[instance.body as usize] * pose.world[instance.node];
                    if far.is_none() && !own.stays_within(FARTHEST_M, world) {
                        far = Some(*instance);
                    }
                    let here = own.moved(world);
                    all = Some(all.map_or(here, |all: Bounds| all.with(here)));
                }
            }
        }
        (all.unwrap_or(Bounds { min: Vec3::ZERO, max: Vec3::ZERO }), far)
    }

    pub(super) fn vertices(&self, attribute: VertexAttribute) -> &[u8] {
        match attribute {
            VertexAttribute::Position => bytemuck::cast_slice(&self.vertices.positions),
            VertexAttribute::Normal => bytemuck::cast_slice(&self.vertices.normals),
            VertexAttribute::Tangent => bytemuck::cast_slice(&self.vertices.tangents),
            VertexAttribute::Uv0 => bytemuck::cast_slice(&self.vertices.uv0),
            VertexAttribute::Uv1 => bytemuck::cast_slice(&self.vertices.uv1),
            VertexAttribute::Color0 => bytemuck::cast_slice(&self.vertices.color0),
            VertexAttribute::Instance => &[],
        }
    }

    pub(super) fn triangles(&self) -> &[u8] {
        bytemuck::cast_slice(&self.vertices.indices)
    }

    pub(super) fn bodies(&self) -> Vec<u8> {
        self.bodies.iter().flat_map(|m| bytemuck::bytes_of(&m.to_cols_array()).to_vec()).collect()
    }

    /// A value of each body, as a shader's type wants it.
    pub(super) fn value(
        &self,
        name: &str,
        default: Option<&Value>,
        item: Option<&Type>,
        stride: u32,
    ) -> Result<Vec<u8>, String> {
        let ty = item.ok_or("no shader says what a value is")?;
        let given = self.info.values.get(name);
        let mut bytes = vec![0; self.bodies.len() * stride as usize];
        for (body, out) in bytes.chunks_exact_mut(stride.max(1) as usize).enumerate() {
            let value = given.and_then(|all| all.get(body)?.as_ref()).or(default);
            let value = value.ok_or_else(|| format!("body {body} has no value `{name}`"))?;
            packing::encode(value, ty, out).map_err(|why| format!("`{name}` of body {body}: {why}"))?;
        }
        Ok(bytes)
    }
}

impl Vertices {
    /// Appends a primitive; gives the range of its indices.
    fn append(&mut self, primitive: &Primitive) -> Range<u32> {
        let first = self.positions.len() as u32;
        let start = self.indices.len() as u32;
        self.positions.extend_from_slice(&primitive.positions);
        self.normals.extend_from_slice(&primitive.normals);
        self.tangents.extend_from_slice(&primitive.tangents);
        self.uv0.extend_from_slice(&primitive.uv0);
        self.uv1.extend_from_slice(&primitive.uv1);
        self.color0.extend_from_slice(&primitive.color0);
        self.indices.extend(primitive.indices.iter().map(|index| first + index));
        start..self.indices.len() as u32
    }

    /// The box around a primitive in the space of its node; none without triangles.
    fn bounds(&self, instance: &Instance) -> Option<Bounds> {
        let first = instance.first_triangle as usize * 3;
        let indices = self.indices.get(first..first + instance.triangles as usize * 3).unwrap_or_default();
        let points = indices.iter().filter_map(|i| self.positions.get(*i as usize)).map(|p| Vec3::from_array(*p));
        points.map(|p| Bounds { min: p, max: p }).reduce(Bounds::with)
    }
}

fn too_far(parts: &[(&MeshEntry, Arc<Model>)], far: Instance) -> Diagnostic {
    let Some((entry, model)) = parts.get(far.entry) else {
        return Diagnostic::error(Code::ASSET, "a body is too far away");
    };
    let name = model.nodes.get(far.node).map_or("", |node| &node.name);
    let node = if name.is_empty() { String::new() } else { format!(": node `{name}`") };
    let why = "where the scene or an animation puts it, it reaches beyond";
    let message = format!("`{}`{node}: {why} {FARTHEST_M:e} m, with which nothing can be reckoned", entry.file.value);
    Diagnostic::error(Code::ASSET, message).at(entry.file.span, "named here")
}

/// Values by name: for each body what the scene gives.
fn values(parts: &[(&MeshEntry, Arc<Model>)]) -> BTreeMap<String, Vec<Option<Value>>> {
    let names = parts.iter().flat_map(|(entry, _)| &entry.values).map(|item| item.name.value.clone());
    let mut all: BTreeMap<String, Vec<Option<Value>>> = names.map(|name| (name, Vec::new())).collect();
    for (name, values) in &mut all {
        for (entry, _) in parts {
            let given = crate::scene::find(&entry.values, name).map(|item| item.value.clone());
            values.extend(std::iter::repeat_n(given, entry.world_from_body.len()));
        }
    }
    all
}
