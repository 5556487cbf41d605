//! Drawing for a window: a frame is submitted and nobody waits for it; times and counts come
//! later. Steps are done as time passes, and a frame that is drawn again runs none.

use super::build::{Session, is_color};
use super::draw::nothing;
use super::inputs::Input;
use super::live_values::LiveValues;
use super::moving::Moving;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::engine::{Due, Engine, Frame, Report, Runner, Screen, TextureData};
use crate::plan::model::{ObjectRef, Plan};
use crate::scene::Camera;

/// One frame of a window.
#[derive(Clone, Copy, Debug)]
pub struct Live<'a> {
    pub camera: Camera,
    /// Seconds since the start.
    pub time_s: f64,
    /// Since the frame before.
    pub delta_s: f64,
    pub frame: u64,
    /// How many steps each of the plan's `Steps` runs; see [`Session::steps_due`].
    pub steps: &'a [u32],
    /// Which passes run, by index into the plan's; absent: all.
    pub only: Option<&'a [bool]>,
}

/// What was read of an object.
#[derive(Clone, Debug)]
pub enum Read {
    Texture(TextureData),
    /// With the header of a counted one.
    Buffer(Vec<u8>),
}

impl Session {
    /// Submits what has to run for a frame of the graph, and tells which units do and why. Waits for
    /// nothing.
    ///
    /// # Errors
    /// If nothing was built, or the device refuses something or is lost.
    pub fn submit(&mut self, live: &Live<'_>) -> Result<Report, Diagnostics> {
        self.frame(live, Runner::run)
    }

    /// The same without a report, which [`Session::answers`] has once the GPU is done: a frame in
    /// which nothing new comes up allocates nothing.
    ///
    /// # Errors
    /// As [`Session::submit`].
    pub fn advance(&mut self, live: &Live<'_>) -> Result<(), Diagnostics> {
        self.frame(live, Runner::advance)
    }

    fn frame<T>(
        &mut self,
        live: &Live<'_>,
        run: impl FnOnce(&mut Runner, &Engine, &Frame<'_>) -> Result<T, Diagnostics>,
    ) -> Result<T, Diagnostics> {
        let (Some(content), Some(runner)) = (&mut self.content, &mut self.graph) else { return Err(nothing().into()) };
        content.camera = live.camera;
        let values = LiveValues::new(content, &content.inputs, &self.pointed, live.time_s);
        let frame = Frame {
            time: live.time_s,
            delta: live.delta_s,
            frame: live.frame,
            steps: live.steps,
            live: &|name, step| values.at(name, step),
            only: live.only,
        };
        let (inputs, camera, standing) = (&content.inputs, &content.camera, &mut self.standing);
        Moving { inputs, camera, standing }.run(&self.engine, runner, &frame, run)
    }

    /// Presents what the graph made last, and puts it on a screen. Tells whether the screen's
    /// texture is another one now.
    ///
    /// # Errors
    /// As [`Session::submit`].
    pub fn show(&mut self, live: &Live<'_>, screen: &mut Screen) -> Result<bool, Diagnostics> {
        let (Some(content), Some(graph), Some(present)) = (&mut self.content, &self.graph, &mut self.present) else {
            return Err(nothing().into());
        };
        content.camera = live.camera;
        let values = LiveValues::new(content, &content.present_inputs, &self.pointed, live.time_s);
        let input = present.plan().objects.iter().position(is_color);
        if let (Some(input), Some(output)) = (input, graph.plan().outputs.first()) {
            present.share(input, graph, output.object)?;
        }
        let frame = Frame {
            time: live.time_s,
            delta: live.delta_s,
            frame: live.frame,
            steps: &[],
            live: &|name, step| values.at(name, step),
            only: None,
        };
        present.advance(&self.engine, &frame)?;
        let picture = present.plan().outputs.first().map(|o| o.object).ok_or_else(nothing)?;
        Ok(screen.take(self.engine.gpu(), present, picture)?)
    }

    /// Runs chosen passes whether or not anything changed, and waits for nothing.
    ///
    /// # Errors
    /// As [`Session::submit`].
    pub fn run_part(&mut self, live: &Live<'_>) -> Result<(), Diagnostics> {
        self.run_all(true);
        let ran = self.submit(live);
        self.run_all(false);
        ran.map(|_| ())
    }

    /// What an object has now, of a texture one layer of one mip. Waits for the device.
    ///
    /// # Errors
    /// If it has no such part or cannot be read, or the device fails.
    pub fn read(&mut self, object: ObjectRef, mip: u32, layer: u32) -> Result<Read, Diagnostic> {
        let graph = self.graph.take().ok_or_else(nothing)?;
        let is_texture = graph.texture(object).is_some();
        let read = if is_texture {
            graph.read_texture(&mut self.engine, object, mip, Some(layer)).map(Read::Texture)
        } else {
            graph.read_buffer(&self.engine, object).map(Read::Buffer)
        };
        self.graph = Some(graph);
        read
    }

    /// Times and counts that have come since the last call: of the graph and of the presenting one.
    /// Does not wait.
    pub fn answers(&mut self) -> [Option<Report>; 2] {
        let engine = &self.engine;
        [&mut self.graph, &mut self.present].map(|runner| runner.as_mut().and_then(|r| r.poll(engine)))
    }

    /// Whether counted buffers had too little room: they get it with the next plan of
    /// [`Session::builder`].
    ///
    /// # Errors
    /// For those that cannot grow.
    pub fn wants_room(&mut self, report: &Report) -> Result<Option<Diagnostics>, Diagnostics> {
        let mut notes = Diagnostics::new();
        let grown = self.has_grown(report, &mut notes)?;
        Ok(grown.then_some(notes))
    }

    /// The steps to run until a time, `most` of each `Steps` at a time; `is_new` says that a new frame
    /// begins, which those once a frame count.
    pub fn steps_due(&self, time_s: f64, is_new: bool, most: u32) -> Due {
        self.graph.as_ref().map_or_else(Due::default, |graph| graph.steps_due(time_s, is_new, most))
    }

    /// Starts all state anew.
    ///
    /// # Errors
    /// If the device refuses the memory.
    pub fn reset(&mut self) -> Result<(), Diagnostic> {
        self.graph.as_mut().map_or(Ok(()), |graph| graph.reset_state(&self.engine))
    }

    /// Whether anything of the graph depends on time.
    pub fn changes_over_time(&self) -> bool {
        let mut inputs = self.content.iter().flat_map(|content| content.inputs.values());
        let moves = inputs.any(|input| matches!(input, Input::Meshes(meshes) if meshes.info.animated));
        moves || !self.tracks().is_empty() || self.plan().is_some_and(changes_over_time)
    }
}

fn changes_over_time(plan: &Plan) -> bool {
    let mut live = plan.units.iter().flat_map(|u| &u.causes.live);
    !plan.steps.is_empty() || live.any(|name| ["time", "delta", "frame", "step"].contains(&name.as_str()))
}
