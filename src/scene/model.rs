//! What a scene file says.

use std::collections::BTreeMap;
use std::path::PathBuf;

use super::camera::{Camera, Light};
use crate::diagnostic::{FileId, Span};
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
    pub lights: Vec<Item<Light>>,
    pub particles: Vec<Item<ParticleSource>>,
    /// Pictures by the names of the inputs they feed; `environment:` is one of them.
    pub textures: Vec<Item<Sp<String>>>,
    pub tables: Vec<Item<Vec<BTreeMap<String, Value>>>>,
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
        let tables = self.tables.iter().map(|item| ("table", &item.name));
        lights.chain(particles).chain(textures).chain(tables).collect()
    }
}
