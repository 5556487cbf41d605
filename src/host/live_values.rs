//! What cameras, lights and pointers say while a frame runs: the same for all of it, but for what steps
//! see at times of their own. Nothing is kept: a frame asks once for each name that its graph reads.

use std::collections::BTreeMap;

use super::content::Content;
use super::inputs::Input;
use crate::engine::StepInfo;
use crate::graph::value::Value;
use crate::scene::{Camera, PointerPath};

pub(super) struct LiveValues<'a> {
    inputs: &'a BTreeMap<String, Input>,
    camera: &'a Camera,
    viewport: [u32; 2],
    /// What was pointed at while pictures were shown; in place of the scene's pointers if there is any.
    pointed: &'a PointerPath,
    time_s: f64,
}

impl<'a> LiveValues<'a> {
    pub fn new(
        content: &'a Content,
        inputs: &'a BTreeMap<String, Input>,
        pointed: &'a PointerPath,
        time_s: f64,
    ) -> Self {
        Self { inputs, camera: &content.camera, viewport: content.viewport, pointed, time_s }
    }

    /// A field's value in the frame, or in a step of it.
    pub fn at(&self, name: &str, step: Option<&StepInfo>) -> Option<Value> {
        let (input, field) = name.split_once('.')?;
        let path = match self.inputs.get(input)? {
            Input::Pointer(path) if self.pointed.is_empty() => path,
            Input::Pointer(_) => self.pointed,
            input => return input.field(field, self.camera, self.viewport),
        };
        path.field(field, step.map_or(self.time_s, |step| step.time))
    }
}
