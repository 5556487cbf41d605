//! What cameras, lights and pointers say while a frame runs: the same for all of it, but for what steps
//! see at times of their own.

use std::collections::BTreeMap;

use super::inputs::Input;
use super::load::Content;
use crate::engine::StepInfo;
use crate::graph::value::Value;
use crate::scene::PointerPath;

pub(super) struct LiveValues<'a> {
    inputs: &'a BTreeMap<String, Input>,
    /// By `input.field`.
    values: BTreeMap<String, Value>,
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
        let mut values = BTreeMap::new();
        for (name, input) in inputs {
            for field in input.fields() {
                if let Some(value) = input.field(field, &content.camera, content.viewport) {
                    values.insert(format!("{name}.{field}"), value);
                }
            }
        }
        Self { inputs, values, pointed, time_s }
    }

    /// A field's value in the frame, or in a step of it.
    pub fn at(&self, name: &str, step: Option<&StepInfo>) -> Option<Value> {
        if let Some(value) = self.values.get(name) {
            return Some(value.clone());
        }
        let (input, field) = name.split_once('.')?;
        let Input::Pointer(path) = self.inputs.get(input)? else { return None };
        let path = if self.pointed.is_empty() { path } else { self.pointed };
        path.field(field, step.map_or(self.time_s, |step| step.time))
    }
}
