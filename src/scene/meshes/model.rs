//! What a mesh file holds, whatever its format.

use std::sync::Arc;

use glam::{Mat4, Quat, Vec3};

use crate::diagnostic::Diagnostics;
use crate::scene::image::Stored;

/// One mesh file. All indices in it are valid: of vertices, materials, images, meshes and nodes.
#[derive(Clone, Debug, Default)]
pub struct Model {
    pub meshes: Vec<Mesh>,
    pub materials: Vec<Material>,
    /// As the files store them: whether the bytes are sRGB depends on the slot that uses them.
    pub images: Vec<Arc<Stored>>,
    /// Every parent stands before its children.
    pub nodes: Vec<Node>,
    /// Nodes without a parent.
    pub roots: Vec<usize>,
    pub cameras: Vec<Lens>,
    pub lights: Vec<Lamp>,
    pub animations: Vec<Animation>,
    /// Warnings and notes; a model with errors is not made.
    pub diagnostics: Diagnostics,
}

impl Model {
    /// A model of formats that have no nodes.
    pub(super) fn of_one_mesh(mesh: Mesh) -> Self {
        let node = Node { mesh: Some(0), ..Node::default() };
        Self { meshes: vec![mesh], nodes: vec![node], roots: vec![0], ..Self::default() }
    }
}

/// What one node draws.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    pub name: String,
    pub primitives: Vec<Primitive>,
}

/// Triangles of one material, in the space of their node. All attributes have the length of
/// `positions`; counter-clockwise is the front.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Primitive {
    /// Finite.
    pub positions: Vec<[f32; 3]>,
    /// Of length 1.
    pub normals: Vec<[f32; 3]>,
    /// Of length 1, along growing u; `w` is 1 or -1: the bitangent is `w * cross(normal, tangent)`.
    pub tangents: Vec<[f32; 4]>,
    /// (0, 0) is the first texel of the first row: v grows downwards, as in glTF. 0 if absent.
    pub uv0: Vec<[f32; 2]>,
    /// 0 if absent.
    pub uv1: Vec<[f32; 2]>,
    /// Linear, not premultiplied; multiplies the base colour. 1 if absent.
    pub color0: Vec<[f32; 4]>,
    /// Three for each triangle.
    pub indices: Vec<u32>,
    /// Which of the model's materials.
    pub material: usize,
}

/// How light meets a surface: glTF 2.0's metallic-roughness model, its names and its defaults.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    pub name: String,
    /// Linear, times the texture and the vertex colour.
    pub base_color_factor: [f32; 4],
    pub metallic_factor: f32,
    pub roughness_factor: f32,
    /// Linear, times the texture and `emissive_strength`.
    pub emissive_factor: [f32; 3],
    pub emissive_strength: f32,
    /// Scales x and y of the normal texture.
    pub normal_scale: f32,
    pub occlusion_strength: f32,
    pub alpha_mode: AlphaMode,
    /// Below this a `Mask` is a hole.
    pub alpha_cutoff: f32,
    pub double_sided: bool,
    pub ior: f32,
    /// The part of light that goes through rather than being scattered.
    pub transmission_factor: f32,
    /// The base colour is what is seen, whatever the light.
    pub unlit: bool,
    /// sRGB; alpha is coverage.
    pub base_color_texture: Option<TextureUse>,
    /// Linear: green is roughness, blue is metallic.
    pub metallic_roughness_texture: Option<TextureUse>,
    /// Linear: tangent space, y along growing -v.
    pub normal_texture: Option<TextureUse>,
    /// Linear: red.
    pub occlusion_texture: Option<TextureUse>,
    /// sRGB.
    pub emissive_texture: Option<TextureUse>,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color_factor: [1.0; 4],
            metallic_factor: 1.0,
            roughness_factor: 1.0,
            emissive_factor: [0.0; 3],
            emissive_strength: 1.0,
            normal_scale: 1.0,
            occlusion_strength: 1.0,
            alpha_mode: AlphaMode::Opaque,
            alpha_cutoff: 0.5,
            double_sided: false,
            ior: 1.5,
            transmission_factor: 0.0,
            unlit: false,
            base_color_texture: None,
            metallic_roughness_texture: None,
            normal_texture: None,
            occlusion_texture: None,
            emissive_texture: None,
        }
    }
}

impl Material {
    /// Like plaster: what has no material in a file whose format knows none, or does not say.
    pub fn plain() -> Self {
        Self { base_color_factor: [0.8, 0.8, 0.8, 1.0], metallic_factor: 0.0, ..Self::default() }
    }
}

/// What a material's alpha means.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AlphaMode {
    /// Nothing.
    #[default]
    Opaque,
    /// A hole where it is below the cutoff.
    Mask,
    /// Coverage.
    Blend,
}

/// A material's use of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureUse {
    /// Which of the model's images.
    pub image: usize,
    pub sampler: Sampler,
    /// 0 or 1: `uv0` or `uv1`.
    pub uv_set: u32,
    pub transform: UvTransform,
}

/// Where a texture is looked up: `offset + rotate(scale * uv)` (`KHR_texture_transform`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvTransform {
    pub offset: [f32; 2],
    /// Radians, counter-clockwise.
    pub rotation: f32,
    pub scale: [f32; 2],
}

impl Default for UvTransform {
    fn default() -> Self {
        Self { offset: [0.0; 2], rotation: 0.0, scale: [1.0; 2] }
    }
}

/// How texels become a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Sampler {
    pub wrap_u: Wrap,
    pub wrap_v: Wrap,
    pub mag: Filter,
    pub min: Filter,
    /// Between mip levels; absent: only the largest level is looked at.
    pub mip: Option<Filter>,
}

impl Default for Sampler {
    fn default() -> Self {
        Self {
            wrap_u: Wrap::Repeat,
            wrap_v: Wrap::Repeat,
            mag: Filter::Linear,
            min: Filter::Linear,
            mip: Some(Filter::Linear),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Wrap {
    Repeat,
    Mirror,
    Clamp,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Filter {
    Nearest,
    Linear,
}

/// A place in the tree.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Node {
    pub name: String,
    /// From this node's space to its parent's.
    pub local: Local,
    pub parent: Option<usize>,
    pub children: Vec<usize>,
    pub mesh: Option<usize>,
    pub camera: Option<usize>,
    pub light: Option<usize>,
}

/// A transform of a node. Only the first form can be animated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Local {
    Parts { translation: Vec3, rotation: Quat, scale: Vec3 },
    Matrix(Mat4),
}

impl Default for Local {
    fn default() -> Self {
        Self::Parts { translation: Vec3::ZERO, rotation: Quat::IDENTITY, scale: Vec3::ONE }
    }
}

/// A camera of the file. It looks along -z of its node, y up.
#[derive(Clone, Debug, PartialEq)]
pub struct Lens {
    pub name: String,
    pub kind: LensKind,
    /// What keeps it from making a picture, if anything does.
    pub fault: Option<&'static str>,
}

/// Lengths in metres, angles in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LensKind {
    /// `zfar` absent: endless.
    Perspective { yfov: f32, aspect: Option<f32>, znear: f32, zfar: Option<f32> },
    /// Half of the width and of the height that are seen.
    Orthographic { xmag: f32, ymag: f32, znear: f32, zfar: f32 },
}

/// A light of the file (`KHR_lights_punctual`). It shines along -z of its node.
#[derive(Clone, Debug, PartialEq)]
pub struct Lamp {
    pub name: String,
    pub kind: LampKind,
    /// Linear.
    pub color: [f32; 3],
    /// Lux for `Directional`, else candela.
    pub intensity: f32,
    /// Metres after which nothing is left; absent: endless.
    pub range: Option<f32>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LampKind {
    Directional,
    Point,
    /// Radians from the axis.
    Spot {
        inner_cone_angle: f32,
        outer_cone_angle: f32,
    },
}

/// Nodes that move.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Animation {
    pub name: String,
    /// Seconds: the last key of all channels.
    pub duration_s: f32,
    pub channels: Vec<Channel>,
}

/// One property of one node over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    pub node: usize,
    /// Seconds, growing; at least one.
    pub times_s: Vec<f32>,
    pub interpolation: Interpolation,
    pub keys: Keys,
}

/// A value for each time, or three if the interpolation is `Cubic`: the tangent that arrives, the
/// value, the tangent that leaves.
#[derive(Clone, Debug, PartialEq)]
pub enum Keys {
    Translation(Vec<Vec3>),
    Rotation(Vec<Quat>),
    Scale(Vec<Vec3>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// Rotations along the shorter arc.
    Linear,
    /// The last key's value.
    Step,
    Cubic,
}

/// A box along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    pub min: Vec3,
    pub max: Vec3,
}
