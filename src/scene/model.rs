//! What a scene file says.

use std::path::PathBuf;

use glam::DMat4;

use super::camera::{Camera, Light};
use super::particles::Taken;
use super::pointer::PointerPath;
use super::sequence::Sequence;
use crate::diagnostic::{FileId, Span};
use crate::graph::rows::Row;
use crate::graph::value::Value;
use crate::syntax::Sp;

/// One scene file. Files that it names are not looked for yet.
#[derive(Clone, Debug)]
pub struct Scene {
    pub path: PathBuf,
    pub file: FileId,
    /// The word `Scene` and its opening bracket, for labels about the whole file.
    pub span: Span,
    pub about: Option<String>,
    /// Absent only where somebody else says which graph to use.
    pub graph: Option<Sp<String>>,
    /// Absent: the particles are framed.
    pub camera: Option<Sp<Camera>>,
    /// In its place.
    pub camera_file: Option<Sp<CameraFile>>,
    pub lights: Vec<Item<Light>>,
    pub pointers: Vec<Item<PointerPath>>,
    pub particles: Vec<Item<ParticleSource>>,
    /// Bodies by the names of the inputs that they feed.
    pub meshes: Vec<Item<Vec<MeshEntry>>>,
    /// Pictures by the names of the inputs they feed; `environment:` is one of them.
    pub textures: Vec<Item<Sp<String>>>,
    /// The environment, where it is a cube.
    pub cube: Option<Item<CubeFiles>>,
    pub tables: Vec<Item<Vec<Row>>>,
    /// Values of the graph's parameters by instance path.
    pub params: Vec<Item<Value>>,
    /// Values of the parameters of the graph that turns light into a picture.
    pub present: Vec<Item<Value>>,
    /// Pixels.
    pub size: Option<[u32; 2]>,
}

/// Something that a scene gives under a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Item<T> {
    pub name: Sp<String>,
    pub value: T,
    /// Where the value stands.
    pub span: Span,
}

/// A file of particles.
#[derive(Clone, Debug, PartialEq)]
pub struct ParticleSource {
    pub file: Sp<String>,
    /// Metres; absent: the file's, else estimated.
    pub radius_m: Option<Sp<f64>>,
    /// Where its numbers stand, and what its attributes are called.
    pub taken: Taken,
    /// The file's name has a place for a number: one file for each frame.
    pub sequence: Option<Sequence>,
    /// Lowest and highest corner in metres, in place of those of the positions.
    pub bounds: Option<[[f32; 3]; 2]>,
}

/// The files of a cube that is seen from inside.
#[derive(Clone, Debug, PartialEq)]
pub enum CubeFiles {
    /// All faces in one picture, as a cross.
    Cross(Sp<String>),
    /// +x, -x, +y, -y, +z, -z.
    Faces(Box<[Sp<String>; 6]>),
}

impl CubeFiles {
    pub fn files(&self) -> &[Sp<String>] {
        match self {
            CubeFiles::Cross(file) => std::slice::from_ref(file),
            CubeFiles::Faces(files) => &files[..],
        }
    }
}

/// A mesh file, put where it stands: one body, or as many as there are transforms.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshEntry {
    pub file: Sp<String>,
    /// World from body, in metres.
    pub world_from_body: Vec<DMat4>,
    pub tags: Vec<String>,
    /// For graphs that ask for values of bodies.
    pub values: Vec<Item<Value>>,
    pub playing: Playing,
}

/// A camera of a mesh file.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraFile {
    /// Where the file is put, and what moves its nodes; nothing of it is drawn.
    pub entry: MeshEntry,
    /// Of the camera or of its node; absent: the first.
    pub name: Option<Sp<String>>,
}

/// What moves the nodes of a mesh file over time.
#[derive(Clone, Debug, PartialEq)]
pub enum Playing {
    Still,
    /// An animation by name; absent: the file's first, if it has any.
    Plays {
        animation: Option<Sp<String>>,
        loops: bool,
        /// Seconds of the animation at the scene's time 0.
        start_s: f64,
    },
}

impl MeshEntry {
    /// A file where it says itself that it stands.
    pub fn of(file: Sp<String>) -> Self {
        Self {
            file,
            world_from_body: vec![DMat4::IDENTITY],
            tags: Vec::new(),
            values: Vec::new(),
            playing: Playing::Plays { animation: None, loops: true, start_s: 0.0 },
        }
    }
}

/// Finds an item by its name.
pub fn find<'a, T>(items: &'a [Item<T>], name: &str) -> Option<&'a Item<T>> {
    items.iter().find(|item| item.name.value == name)
}

impl Scene {
    /// Names of all items that inputs may take, with the kind and place of each.
    pub fn items(&self) -> Vec<(&'static str, &Sp<String>)> {
        let lights = self.lights.iter().map(|item| ("light", &item.name));
        let particles = self.particles.iter().map(|item| ("particles", &item.name));
        let textures = self.textures.iter().map(|item| ("texture", &item.name));
        let cube = self.cube.iter().map(|item| ("texture", &item.name));
        let tables = self.tables.iter().map(|item| ("table", &item.name));
        let meshes = self.meshes.iter().map(|item| ("meshes", &item.name));
        let pointers = self.pointers.iter().map(|item| ("pointer", &item.name));
        lights.chain(pointers).chain(particles).chain(meshes).chain(textures).chain(cube).chain(tables).collect()
    }
}
