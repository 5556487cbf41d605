//! Drawing a moment: steps from the start, one picture, more room where counts ask for it.

use std::time::Instant;

use super::build::{Session, is_color};
use super::live_values::LiveValues;
use super::moving::Moving;
use super::picture::{self, PictureKind, Texels};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::engine::{Frame, Report, Runner, TextureData};
use crate::plan::model::{Object, ObjectKind, ObjectRef};
use crate::plan::stats::Statistic;

/// Frames a second, where nobody says.
pub(super) const FRAMES_PER_SECOND: f64 = 60.0;
/// A frame is repeated with more room at most so often.
const MOST_REPEATS: usize = 12;

/// When a picture is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moment {
    pub frame: u64,
    /// Seconds since the start.
    pub time_s: f64,
}

impl Moment {
    pub fn at_frame(frame: u64) -> Self {
        Self { frame, time_s: frame as f64 / FRAMES_PER_SECOND }
    }

    pub fn at_time(time_s: f64) -> Self {
        Self { frame: (time_s * FRAMES_PER_SECOND).floor() as u64, time_s }
    }
}

/// What drawing did.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// Of the graph, then of the presenting graph if it ran.
    pub reports: Vec<Report>,
    /// Frames that were repeated with more room.
    pub repeats: usize,
    /// From the first pass to the GPU's last answer, in milliseconds.
    pub drawing_ms: f64,
    /// Notes about buffers that grew, warnings about those that stayed empty.
    pub diagnostics: Diagnostics,
}

impl Session {
    /// Runs all steps up to a moment from the start, then draws it; `present` also turns the light
    /// into a picture for screens. All steps see what shows now: see [`Session::draw_at`].
    ///
    /// # Errors
    /// If the device refuses something or is lost, or a counted buffer cannot get the room that it
    /// needs.
    pub fn draw(&mut self, moment: Moment, present: bool) -> Result<Drawn, Diagnostics> {
        self.draw_by(present, moment, |session, notes| session.come_to(moment, None, true, notes))
    }

    /// Draws a moment after the one that was drawn last: steps go on from there.
    ///
    /// # Errors
    /// As [`Session::draw`].
    pub fn draw_next(&mut self, moment: Moment, present: bool) -> Result<Drawn, Diagnostics> {
        let mut is_new = true;
        self.draw_by(present, moment, |session, _| {
            let due = session.steps_due(moment.time_s, std::mem::take(&mut is_new), u32::MAX);
            session.run_moment(moment, &due.steps, None).map(|()| true)
        })
    }

    /// Draws by what runs the graph for a moment, and tells whether that is to be repeated with more room.
    pub(super) fn draw_by(
        &mut self,
        present: bool,
        moment: Moment,
        run: impl FnMut(&mut Self, &mut Diagnostics) -> Result<bool, Diagnostics>,
    ) -> Result<Drawn, Diagnostics> {
        let (began, mut notes) = (Instant::now(), Diagnostics::new());
        match self.draw_until_whole(present, moment, &mut notes, run) {
            Ok((reports, repeats)) => {
                let drawing_ms = began.elapsed().as_secs_f64() * 1e3;
                Ok(Drawn { reports, repeats, drawing_ms, diagnostics: notes })
            }
            Err(found) => {
                // What was found before stays before what ended the work.
                notes.extend(found);
                Err(notes)
            }
        }
    }

    fn draw_until_whole(
        &mut self,
        present: bool,
        moment: Moment,
        notes: &mut Diagnostics,
        mut run: impl FnMut(&mut Self, &mut Diagnostics) -> Result<bool, Diagnostics>,
    ) -> Result<(Vec<Report>, usize), Diagnostics> {
        for repeats in 0..=MOST_REPEATS {
            if !run(self, notes)? {
                self.grow()?;
                continue;
            }
            if present {
                self.run_present(moment)?;
            }
            let report = finish(&mut self.graph, &self.engine)?;
            if self.has_grown(&report, notes)? {
                self.grow()?;
                continue;
            }
            notes.extend(self.stayed_empty(&report));
            let mut reports = vec![report];
            if present {
                reports.push(finish(&mut self.present, &self.engine)?);
            }
            return Ok((reports, repeats));
        }
        let endless = format!("counted buffers still have too little room after {MOST_REPEATS} repeats");
        Err(Diagnostic::error(Code::OVERFLOW, endless).into())
    }

    /// Waits for what runs, and tells whether counted buffers had too little room, which they get when the graph
    /// is built again.
    pub(super) fn lacked_room(&mut self, notes: &mut Diagnostics) -> Result<bool, Diagnostics> {
        let report = finish(&mut self.graph, &self.engine)?;
        self.has_grown(&report, notes)
    }

    /// Runs the graph for one moment, with so many of each of its `Steps`; `only` some passes, or all.
    pub(super) fn run_moment(&mut self, now: Moment, steps: &[u32], only: Option<&[bool]>) -> Result<(), Diagnostics> {
        let (Some(content), Some(runner)) = (&mut self.content, &mut self.graph) else { return Err(nothing().into()) };
        if let Some(camera) = content.viewpoint.as_ref().and_then(|viewpoint| viewpoint.at(now.time_s)) {
            content.camera = camera;
        }
        let content = &*content;
        let live = LiveValues::new(content, &content.inputs, &self.pointed, now.time_s);
        let frame = Frame {
            time: now.time_s,
            delta: 1.0 / FRAMES_PER_SECOND,
            frame: now.frame,
            steps,
            live: &|name, step| live.at(name, step),
            only,
        };
        let (inputs, camera, standing) = (&content.inputs, &content.camera, &mut self.standing);
        Moving { inputs, camera, standing }.run(&self.engine, runner, &frame, Runner::advance)
    }

    fn run_present(&mut self, moment: Moment) -> Result<(), Diagnostics> {
        let (Some(content), Some(graph), Some(present)) = (&self.content, &self.graph, &mut self.present) else {
            return Err(nothing().into());
        };
        let live = LiveValues::new(content, &content.present_inputs, &self.pointed, moment.time_s);
        let input = present.plan().objects.iter().position(is_color);
        if let (Some(input), Some(output)) = (input, graph.plan().outputs.first()) {
            present.share(input, graph, output.object)?;
        }
        let frame = Frame {
            time: moment.time_s,
            delta: 1.0 / FRAMES_PER_SECOND,
            frame: moment.frame,
            steps: &[],
            live: &|name, step| live.at(name, step),
            only: None,
        };
        present.advance(&self.engine, &frame)
    }

    /// Whether counted buffers need more room than they had, which they get.
    pub(super) fn has_grown(&mut self, report: &Report, notes: &mut Diagnostics) -> Result<bool, Diagnostics> {
        let mut errors = Diagnostics::new();
        let mut grown = false;
        for count in report.overflows() {
            let (path, raw, room) = (&count.path, count.raw, count.capacity);
            if count.in_steps {
                let message = format!("`{path}` has room for {room} items, and {raw} were appended in a step");
                let hint = "what is appended to inside `Steps` never grows: raise its capacity in the graph";
                errors.push(Diagnostic::error(Code::OVERFLOW, message).hint(hint));
            } else {
                // Some room to spare: what comes after may count more once this one is whole.
                let wanted = u64::from(raw) + u64::from(raw) / 8;
                self.capacities.insert(path.clone(), wanted);
                let message = format!("`{path}` had room for {room} items, and {raw} came: the frame was repeated");
                notes.push(
                    Diagnostic::note(Code::OVERFLOW, message).hint("raise its capacity in the graph to save the time"),
                );
                grown = true;
            }
        }
        if errors.is_empty() { Ok(grown) } else { Err(errors) }
    }

    /// Warnings about counted buffers to which nothing came, where the graph says what that means.
    pub(super) fn stayed_empty(&self, report: &Report) -> Diagnostics {
        let mut found = Diagnostics::new();
        let Some(plan) = self.plan() else { return found };
        for count in report.counts.iter().filter(|count| count.raw == 0) {
            let object = plan.objects.iter().find(|object| object.path == count.path);
            // What has no room was not meant to hold anything.
            let has_room = |object: &&Object| !matches!(&object.kind, ObjectKind::Buffer(buffer) if buffer.items == 0);
            if let Some((object, text)) =
                object.filter(has_room).and_then(|object| Some((object, object.empty.as_ref()?)))
            {
                let message = format!("nothing came to `{}`: {text}", count.path);
                found.push(Diagnostic::warning(Code::EMPTY, message).at(object.span, "stayed empty"));
            }
        }
        found
    }

    /// The presented picture: `Rgba16Float` texels, linear, 0 to 1.
    ///
    /// # Errors
    /// If nothing was presented, or the device fails.
    pub fn presented(&mut self) -> Result<TextureData, Diagnostic> {
        let present = self.present.take().ok_or_else(nothing)?;
        let read = match present.plan().outputs.first().map(|o| o.object) {
            Some(output) => present.read_texture(&mut self.engine, output, 0, None),
            None => Err(nothing()),
        };
        self.present = Some(present);
        read
    }

    /// The graph's own picture: light, alpha multiplied in.
    ///
    /// # Errors
    /// If nothing was drawn, or the device fails.
    pub fn light(&mut self) -> Result<Texels, Diagnostic> {
        let output = self.graph.as_ref().and_then(|g| g.plan().outputs.first()).ok_or_else(nothing)?;
        self.texels(output.object)
    }

    /// The picture that was drawn last, as a file's bytes.
    ///
    /// # Errors
    /// If nothing was drawn, or the device or the encoder fails.
    pub fn encoded(&mut self, kind: PictureKind, transparent: bool) -> Result<Vec<u8>, Diagnostic> {
        let encoded = match kind {
            PictureKind::Png => {
                let data = self.presented()?;
                if data.format != crate::format::TextureFormat::Rgba16Float {
                    let message = "the presenting graph's output is not `Rgba16Float`";
                    return Err(Diagnostic::error(Code::FORMAT, message));
                }
                picture::presented_png([data.width, data.height], &data.bytes, transparent)
            }
            PictureKind::Exr => picture::exr(&self.light()?),
        };
        encoded.map_err(|why| Diagnostic::error(Code::OUTPUT, format!("the picture cannot be encoded: {why}")))
    }

    /// Any texture's first mip, layers one below the other.
    ///
    /// # Errors
    /// If it is no texture, or the device fails.
    pub fn texels(&mut self, object: ObjectRef) -> Result<Texels, Diagnostic> {
        let graph = self.graph.take().ok_or_else(nothing)?;
        let read = graph.read_texture(&mut self.engine, object, 0, None);
        self.graph = Some(graph);
        read.map(|data| Texels {
            width: data.width,
            height: data.height * data.layers,
            channels: crate::format::channels(data.format),
            rgba: data.to_rgba_f32(),
        })
    }

    /// The statistics of the picture that was drawn last, if the content asked for them. Waits for them.
    ///
    /// # Errors
    /// If nothing was drawn, or the device fails.
    pub fn statistics(&mut self) -> Result<Vec<Statistic>, Diagnostic> {
        self.graph.as_mut().ok_or_else(nothing)?.statistics(&self.engine)
    }

    /// Asks for the statistics of the frame that was submitted last, for [`Session::poll_statistics`].
    /// They have values if the content says `stats`. Waits for nothing.
    ///
    /// # Errors
    /// If nothing was built, or the device fails.
    pub fn ask_statistics(&mut self) -> Result<(), Diagnostic> {
        self.graph.as_mut().ok_or_else(nothing)?.ask_statistics(&self.engine)
    }

    /// The statistics that were asked for, once, as soon as they are there.
    pub fn poll_statistics(&mut self) -> Option<Vec<Statistic>> {
        self.graph.as_mut()?.poll_statistics(&self.engine)
    }

    /// Any buffer's bytes, with the header of a counted one.
    ///
    /// # Errors
    /// If it is no buffer, or the device fails.
    pub fn bytes(&self, object: ObjectRef) -> Result<Vec<u8>, Diagnostic> {
        self.graph.as_ref().ok_or_else(nothing)?.read_buffer(&self.engine, object)
    }

    /// What an instance path of the graph names after the last pass.
    pub fn object(&self, path: &str) -> Option<(ObjectRef, &ObjectKind)> {
        let plan = self.plan()?;
        let found = *plan.names.get(path)?;
        let id = match found {
            ObjectRef::Fixed(id) => id,
            ObjectRef::Ring { ring, index } => *plan.rings.get(ring)?.objects.get(index)?,
        };
        Some((found, &plan.objects.get(id)?.kind))
    }
}

pub(super) fn nothing() -> Diagnostic {
    Diagnostic::error(Code::DEVICE, "nothing was drawn yet")
}

fn finish(runner: &mut Option<Runner>, engine: &crate::engine::Engine) -> Result<Report, Diagnostic> {
    runner.as_mut().ok_or_else(nothing)?.finish(engine)
}
