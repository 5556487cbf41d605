//! What the window knows, as plain data.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use glam::DVec3;

use super::clock::Clock;
use super::core::{Hunt, Recording};
use super::history::Times;
use super::look::{Look, Seen};
use super::params::{Group, Overrides};
use crate::diagnostic::{Diagnostics, Severity, Sources};
use crate::engine::UnitReport;
use crate::graph::value::Value;
use crate::host::{Content, Input, Job};
use crate::plan::stats::Statistic;
use crate::scene::Camera;

/// Reloads that are listed.
const LOGGED: usize = 200;

#[derive(Debug, Default)]
pub struct State {
    /// What is open; absent: the page that lists scenes.
    pub job: Option<Job>,
    /// The adapter's name and interface.
    pub device: String,
    pub overrides: Overrides,
    pub groups: Vec<Group>,
    /// Values as the scene has them, by path as people give it.
    pub in_scene: BTreeMap<String, Value>,
    pub clock: Clock,
    pub changes_over_time: bool,
    /// The graph has an input for what a person points at.
    pub takes_pointer: bool,
    pub camera: Option<Camera>,
    /// As the scene has it, or as the content is framed.
    pub home: Option<Camera>,
    /// The box around the content.
    pub bounds: Option<[DVec3; 2]>,
    pub viewpoints: BTreeMap<u8, Camera>,
    /// Pixels of the picture that is shown.
    pub viewport: [u32; 2],
    pub memory_bytes: u64,
    /// Instance paths of passes that a person switched off.
    pub switched_off: BTreeSet<String>,
    /// Of the graph, and of the presenting one.
    pub times: [Times; 2],
    /// Which units ran in the last frame, and why.
    pub units: Vec<UnitReport>,
    /// Every pass runs in each frame, also those whose results are there.
    pub runs_all: bool,
    /// Whether the graph's statistics are looked at.
    pub counts: bool,
    /// Those of the last frame, in the order of the plan.
    pub statistics: Vec<Statistic>,
    pub findings: Option<Findings>,
    /// The newest first.
    pub reloads: VecDeque<Reload>,
    /// Since when the worker has something to do.
    pub busy: Option<Instant>,
    /// A frame that takes longer is told.
    pub patience: Duration,
    /// How long the driver took to take the last frame's commands.
    pub handing_over: Duration,
    /// For how long a frame has been drawn, as it was told last.
    pub waited_s: u64,
    /// A line for the person, with its time.
    pub notice: Option<(String, Instant)>,
    pub look: Option<Look>,
    pub seen: Option<Seen>,
    pub hunt: Option<Hunt>,
    pub recording: Option<Recording>,
    /// Frames that were drawn since the start.
    pub frames: u64,
}

/// What the last work found.
#[derive(Clone, Debug)]
pub struct Findings {
    pub diagnostics: Diagnostics,
    pub sources: Sources,
    /// The picture is of an earlier state.
    pub is_stale: bool,
}

impl Findings {
    pub fn counts(&self) -> (usize, usize) {
        (self.diagnostics.count(Severity::Error), self.diagnostics.count(Severity::Warning))
    }
}

/// One reload, for the list.
#[derive(Clone, Debug)]
pub struct Reload {
    pub at: Instant,
    pub what: String,
    pub is_good: bool,
    pub errors: usize,
    pub warnings: usize,
    /// Milliseconds; drawing is not known before the picture is there.
    pub noticing_ms: f64,
    pub checking_ms: f64,
    pub building_ms: f64,
    pub drawing_ms: Option<f64>,
    pub pipelines_built: usize,
    pub pipelines_kept: usize,
    /// State that started anew, and why.
    pub resets: Vec<String>,
    /// Built by the interface's thread, which then waited for them.
    pub pipelines_late: usize,
}

impl Reload {
    pub fn all_ms(&self) -> f64 {
        self.noticing_ms + self.checking_ms + self.building_ms + self.drawing_ms.unwrap_or(0.0)
    }
}

impl State {
    pub fn log(&mut self, reload: Reload) {
        self.reloads.push_front(reload);
        self.reloads.truncate(LOGGED);
    }

    pub fn say(&mut self, text: impl Into<String>) {
        self.notice = Some((text.into(), Instant::now()));
    }

    /// What the title bar says.
    pub fn title(&self) -> String {
        match &self.job {
            Some(job) => format!("{} - meniscus", short(&job.source)),
            None => "meniscus".into(),
        }
    }
}

/// A file by its name.
pub fn short(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}

/// Files as a line: up to three names.
pub fn listed(files: &[PathBuf]) -> String {
    let names: Vec<String> = files.iter().take(3).map(|f| short(f)).collect();
    let more = files.len().saturating_sub(3);
    if more > 0 { format!("{} and {more} more", names.join(", ")) } else { names.join(", ") }
}

/// The box around everything that has a place.
pub fn bounds(content: &Content) -> Option<[DVec3; 2]> {
    let boxes = content.inputs.values().filter_map(|input| match input {
        Input::Particles(particles) if particles.set.count > 0 => {
            let r = DVec3::splat(particles.radius_m);
            let corner = |at: [f32; 3]| DVec3::from_array(at.map(f64::from));
            Some([corner(particles.set.min) - r, corner(particles.set.max) + r])
        }
        Input::Meshes(meshes) if meshes.info.instances > 0 => {
            Some([DVec3::from_array(meshes.info.min), DVec3::from_array(meshes.info.max)])
        }
        _ => None,
    });
    let finite = boxes.filter(|ends| ends.iter().all(|end| end.is_finite()));
    finite.reduce(|[a, b], [low, high]| [a.min(low), b.max(high)])
}
