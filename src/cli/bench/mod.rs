//! `meniscus bench`: the time of each pass on the GPU, of encoding and submitting on the CPU,
//! counters and memory; and whether two measurements differ.

mod changes;
mod compare;
mod print;
mod saved;

use std::collections::BTreeMap;

use super::args::{BenchArgs, BenchFormat, SceneArgs};
use super::report::{Exit, print as print_out, report};
use super::session::{Opening, job};
use crate::diagnostic::{Diagnostics, Sources};
use crate::engine::{Gpu, Report};
use crate::files::DiskFiles;
use crate::host::{Cache, Content, Moment, Session, load};
use crate::plan::stats::Statistic;
use changes::Change;
use compare::Comparison;

/// Frames before the first that counts: drivers compile late.
const WARM_UP: u32 = 2;

pub fn run(args: &BenchArgs) -> Exit {
    let mut sources = Sources::new();
    match bench(args, &mut sources) {
        Ok((measured, comparison, notes)) => {
            report(&notes, &sources);
            let shown = match args.format {
                BenchFormat::Table => print::table(&measured, comparison.as_ref()),
                BenchFormat::Json => format!("{:#}\n", saved::json(&measured, comparison.as_ref())),
                BenchFormat::Csv => print::csv(&measured),
            };
            match print_out(&shown) {
                Exit::Done if args.deny_slower && comparison.is_some_and(|c| c.is_slower()) => Exit::Findings,
                exit => exit,
            }
        }
        Err(found) => report(&found, &sources),
    }
}

/// What was measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Measured {
    pub scene: String,
    pub adapter: String,
    pub graph: String,
    /// Values of all parameters, as text by their instance paths.
    pub params: BTreeMap<String, String>,
    pub size: [u32; 2],
    pub frames: u32,
    /// In the order of the first frame.
    pub passes: Vec<PassTimes>,
    /// Milliseconds of each frame.
    pub gpu_ms: Vec<f64>,
    pub encode_ms: Vec<f64>,
    pub submit_ms: Vec<f64>,
    pub counters: Counters,
    pub memory: Memory,
    /// Of the picture that was measured, drawn once more with what only statistics need.
    pub statistics: Vec<Statistic>,
    /// What runs when only one thing changes.
    changes: Vec<Change>,
}

/// A pass's milliseconds in each frame: on the GPU, and of recording it on the CPU.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct PassTimes {
    pub path: String,
    pub gpu_ms: Vec<f64>,
    pub record_ms: Vec<f64>,
    pub timed_with: Option<String>,
}

/// Of the last frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Counters {
    pub passes: usize,
    pub compute_passes: u32,
    pub render_passes: u32,
    pub submissions: u32,
    pub uploaded_bytes: u64,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Memory {
    /// "keep", "share" or "smallest", of the graph.
    pub policy: String,
    pub held_bytes: u64,
    pub unshared_bytes: u64,
    pub lower_bound_bytes: u64,
}

type Answer = (Measured, Option<Comparison>, Diagnostics);

fn bench(args: &BenchArgs, sources: &mut Sources) -> Result<Answer, Diagnostics> {
    let before = args.compare.as_deref().map(saved::read).transpose()?;
    let opening = Opening::begin(args.scene.backend.as_deref());
    let mut notes = Diagnostics::new();
    let mut subject = Subject::load(&args.scene, sources, &mut notes)?;
    let other = args.against.as_ref().map(|scene| SceneArgs { scene: scene.clone(), ..args.scene.clone() });
    let mut other = other.map(|scene| Subject::load(&scene, sources, &mut notes)).transpose()?;
    let gpu = opening.wait()?;
    let second = other.as_ref().map(|_| Opening::begin(args.scene.backend.as_deref()).wait()).transpose()?;
    subject.build(gpu, &mut notes)?;
    if let (Some(other), Some(gpu)) = (&mut other, second) {
        other.build(gpu, &mut notes)?;
    }
    for frame in 0..WARM_UP + args.frames {
        let counts = frame >= WARM_UP;
        // The two take turns, and in going first too.
        let mut both: Vec<&mut Subject> = std::iter::once(&mut subject).chain(&mut other).collect();
        if frame % 2 == 1 {
            both.reverse();
        }
        for one in both {
            one.frame(counts, &mut notes)?;
        }
    }
    subject.try_changes()?;
    subject.look(&mut notes)?;
    let measured = subject.end(args.frames);
    let comparison = match (other, before) {
        (Some(other), _) => Some(Comparison::paired(&other.end(args.frames), &measured)),
        (None, Some(before)) => Some(Comparison::apart(&before, &measured)),
        (None, None) => None,
    };
    Ok((measured, comparison, notes))
}

/// A scene that is measured.
struct Subject {
    content: Option<Content>,
    session: Option<Session>,
    index: BTreeMap<String, usize>,
    /// How many frames were drawn: time goes on, so that steps run as they do in a window.
    drawn: u64,
    measured: Measured,
}

impl Subject {
    fn load(args: &SceneArgs, sources: &mut Sources, notes: &mut Diagnostics) -> Result<Self, Diagnostics> {
        let loaded = load(&DiskFiles, sources, &job(args), &mut Cache::default());
        let Some(content) = loaded.content else { return Err(loaded.diagnostics) };
        notes.extend(loaded.diagnostics);
        let scene = args.scene.display().to_string();
        let measured = Measured { scene, size: content.viewport, ..Measured::default() };
        Ok(Self { content: Some(content), session: None, index: BTreeMap::new(), drawn: 0, measured })
    }

    fn build(&mut self, gpu: Gpu, notes: &mut Diagnostics) -> Result<(), Diagnostics> {
        let mut session = Session::new(gpu);
        if let Some(content) = self.content.take() {
            let built = session.build(content)?;
            session.run_all(true);
            notes.extend(built.diagnostics);
            self.measured.memory.held_bytes = built.memory_bytes;
        }
        self.measured.adapter = session.gpu().info().name;
        if let Some(plan) = session.plan() {
            self.measured.graph = plan.graph.display().to_string();
            self.measured.params = plan.params.iter().map(|p| (p.path.clone(), p.value.to_string())).collect();
            self.measured.memory.policy = plan.memory.policy.name().into();
            self.measured.memory.unshared_bytes = plan.memory.unshared;
            self.measured.memory.lower_bound_bytes = plan.memory.lower_bound;
        }
        self.session = Some(session);
        Ok(())
    }

    /// Draws two frames that follow those before: one timing its passes, one not, for what the CPU does.
    fn frame(&mut self, counts: bool, notes: &mut Diagnostics) -> Result<(), Diagnostics> {
        let Some(session) = &mut self.session else { return Ok(()) };
        session.time_passes(true);
        let timed = session.draw_next(Moment::at_frame(self.drawn), true)?;
        session.time_passes(false);
        let bare = session.draw_next(Moment::at_frame(self.drawn + 1), true)?;
        self.drawn += 2;
        notes.extend(timed.diagnostics);
        if counts {
            self.measured.add_timed(&timed.reports, &mut self.index);
            self.measured.add_bare(&bare.reports);
        }
        Ok(())
    }

    /// Draws the picture once more for its statistics, which what was measured had no part in.
    fn look(&mut self, notes: &mut Diagnostics) -> Result<(), Diagnostics> {
        let Some(session) = self.session.as_mut().filter(|s| s.plan().is_some_and(|plan| !plan.stats.is_empty()))
        else {
            return Ok(());
        };
        let Some(content) = session.content().cloned() else { return Ok(()) };
        session.build(Content { stats: true, ..content })?;
        notes.extend(session.draw(Moment::default(), true)?.diagnostics);
        self.measured.statistics = session.statistics()?;
        Ok(())
    }

    fn try_changes(&mut self) -> Result<(), Diagnostics> {
        if let Some(session) = &mut self.session {
            self.measured.changes = changes::look(session, self.drawn)?;
        }
        Ok(())
    }

    fn end(mut self, frames: u32) -> Measured {
        self.measured.frames = frames;
        self.measured
    }
}

impl Measured {
    fn add_timed(&mut self, reports: &[Report], index: &mut BTreeMap<String, usize>) {
        let total: Option<f64> = reports.iter().map(Report::gpu_ms).sum();
        self.gpu_ms.extend(total);
        for pass in reports.iter().flat_map(|r| &r.passes) {
            let at = *index.entry(pass.path.clone()).or_insert_with(|| {
                self.passes.push(PassTimes { path: pass.path.clone(), ..PassTimes::default() });
                self.passes.len() - 1
            });
            self.passes[at].gpu_ms.extend(pass.gpu_ms);
            self.passes[at].record_ms.extend(pass.record_ms);
            self.passes[at].timed_with.clone_from(&pass.timed_with);
        }
    }

    fn add_bare(&mut self, reports: &[Report]) {
        self.encode_ms.push(reports.iter().map(|r| r.encode_ms).sum());
        self.submit_ms.push(reports.iter().map(|r| r.submit_ms).sum());
        self.counters = Counters {
            passes: reports.iter().map(|r| r.passes.len()).sum(),
            compute_passes: reports.iter().map(|r| r.compute_passes).sum(),
            render_passes: reports.iter().map(|r| r.render_passes).sum(),
            submissions: reports.iter().map(|r| r.submissions).sum(),
            uploaded_bytes: reports.iter().map(|r| r.uploaded_bytes).sum(),
        };
    }
}

/// The value that `part` of the sorted values do not exceed; `None` without values.
pub(super) fn quantile(values: &[f64], part: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = ((sorted.len() as f64 * part).ceil() as usize).saturating_sub(1);
    sorted.get(at).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_that_were_measured() {
        let values: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        assert_eq!(quantile(&values, 0.5), Some(50.0));
        assert_eq!(quantile(&values, 0.99), Some(99.0));
        assert_eq!(quantile(&[3.0], 0.99), Some(3.0));
        assert_eq!(quantile(&[], 0.5), None);
    }
}
