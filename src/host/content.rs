//! Everything that a picture is made of, and what planning asks of it.

use std::collections::BTreeMap;

use wgpu_types::{Features, Limits};

use super::inputs::Input;
use super::sequence::Track;
use super::viewpoint::Viewpoint;
use crate::graph::value::Value;
use crate::plan::model::{InputInfo, MemoryRequest, Request, Texture};
use crate::program::Program;
use crate::scene::Camera;

/// The presenting graph's input for the picture.
pub(super) const COLOR: &str = "color";

/// Everything that a picture is made of: both graphs, what feeds them, and from where it is seen.
#[derive(Clone, Debug)]
pub struct Content {
    pub program: Program,
    pub present: Program,
    pub inputs: BTreeMap<String, Input>,
    /// What feeds the presenting graph, besides the picture.
    pub present_inputs: BTreeMap<String, Input>,
    pub camera: Camera,
    /// What the camera is of a file's, and moves with; none if somebody said it otherwise.
    pub viewpoint: Option<Viewpoint>,
    /// Pixels.
    pub viewport: [u32; 2],
    pub params: BTreeMap<String, Value>,
    pub present_params: BTreeMap<String, Value>,
    pub roots: Vec<String>,
    /// Numbered files that inputs are frames of, in the order of the scene.
    pub tracks: Vec<Track>,
    /// What is asked of memory.
    pub memory: MemoryRequest,
    /// Whether statistics are wanted: passes that only they need run then.
    pub stats: bool,
}

impl Content {
    /// Puts other inputs in the place of those of the same names.
    pub fn feed(&mut self, inputs: BTreeMap<String, Input>) {
        for (name, input) in inputs {
            let takers = [&mut self.inputs, &mut self.present_inputs];
            for taken in takers.into_iter().filter_map(|taker| taker.get_mut(&name)) {
                *taken = input.clone();
            }
        }
    }

    /// What planning the graph needs to know.
    pub fn request(&self, features: Features, limits: Limits, capacities: &BTreeMap<String, u64>) -> Request {
        Request {
            viewport: self.viewport,
            params: self.params.clone(),
            inputs: self.inputs.iter().map(|(name, input)| (name.clone(), input.info())).collect(),
            capacities: capacities.clone(),
            roots: self.roots.clone(),
            stats: self.stats,
            // The budget is looked at once it is known what the rest takes.
            memory: MemoryRequest { budget: None, ..self.memory.clone() },
            features,
            limits,
        }
    }

    /// The same for the presenting graph, which takes the picture as its input `color`.
    pub fn present_request(&self, color: Texture, features: Features, limits: Limits) -> Request {
        let mut inputs: BTreeMap<String, InputInfo> =
            self.present_inputs.iter().map(|(name, input)| (name.clone(), input.info())).collect();
        inputs.insert(COLOR.into(), InputInfo::Texture(color));
        Request { params: self.present_params.clone(), inputs, ..Request::new(self.viewport, features, limits) }
    }
}
