//! What a plan is asked for, and what there is to feed it.

use std::collections::BTreeMap;

use wgpu_types::{Features, Limits};

use super::{MemoryRequest, Texture};
use crate::graph::rows::Row;
use crate::graph::value::Value;
use crate::plan::meshes::MeshesInfo;

/// Everything that planning needs to know from outside the graph.
#[derive(Clone, Debug)]
pub struct Request {
    pub viewport: [u32; 2],
    /// Parameter values by instance path; others have their defaults.
    pub params: BTreeMap<String, Value>,
    pub inputs: BTreeMap<String, InputInfo>,
    /// Capacities of counted buffers by instance path, in place of the declared ones.
    pub capacities: BTreeMap<String, u64>,
    /// Instance paths that somebody asks for besides the first output.
    pub roots: Vec<String>,
    /// Whether statistics are asked for, so that what they read is made and kept.
    pub stats: bool,
    pub memory: MemoryRequest,
    pub features: Features,
    pub limits: Limits,
}

impl Request {
    /// For a picture of this size on a device with these features and limits; parameters at their
    /// defaults, and no input yet.
    pub fn new(viewport: [u32; 2], features: Features, limits: Limits) -> Self {
        Self {
            viewport,
            params: BTreeMap::new(),
            inputs: BTreeMap::new(),
            capacities: BTreeMap::new(),
            roots: Vec::new(),
            stats: false,
            memory: MemoryRequest::default(),
            features,
            limits,
        }
    }
}

/// What feeds an input, as far as planning needs it.
#[derive(Clone, Debug, PartialEq)]
pub enum InputInfo {
    Camera,
    Light,
    Pointer,
    Particles {
        count: u64,
        /// Metres.
        radius: f64,
        min: [f64; 3],
        max: [f64; 3],
        /// Names and numbers of components.
        attributes: Vec<(String, u32)>,
    },
    Texture(Texture),
    Buffer {
        items: u64,
        stride: u32,
    },
    /// Rows, each with named values.
    Table {
        rows: Vec<Row>,
    },
    Meshes(MeshesInfo),
}
