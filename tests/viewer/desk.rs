//! The window's core without a window: what a person would wait for and look at.

use std::time::{Duration, Instant};

use meniscus::engine::{Gpu, GpuOptions};
use meniscus::host::Job;
use meniscus::viewer::action::Action;
use meniscus::viewer::core::{Core, Tick};

use crate::project::Project;

pub const PATIENCE: Duration = Duration::from_secs(60);
pub const SCENE: &str = "scenes/dots.ron";
const SIZE: &str = "160x120";

/// A window's core at work on a project.
pub struct Desk {
    pub core: Core,
    pub project: Project,
    shots: u32,
}

impl Desk {
    /// Opens what `meniscus new` makes, and waits for the first picture.
    pub fn new() -> Self {
        Self::of(Project::new())
    }

    /// Opens what `meniscus new --state` makes.
    pub fn stateful() -> Self {
        let project = Project::empty();
        let made = project.run(&["new", "dots", "--state"]);
        assert_eq!(made.code, 0, "{}", made.stderr);
        Self::of(project)
    }

    /// One whose picture follows the window.
    pub fn resizable() -> Self {
        let project = Project::new();
        project.edit(SCENE, "    size: (800, 600),\n", "");
        Self::sized(project, None)
    }

    /// Opens the scene of a project.
    pub fn of(project: Project) -> Self {
        Self::sized(project, Some([160, 120]))
    }

    /// A window with nothing in it.
    pub fn empty() -> Self {
        let gpu = Gpu::open(&GpuOptions::default()).unwrap();
        let mut core = Core::new(gpu, None, || {}).unwrap();
        core.want_size([160, 120]);
        Self { core, project: Project::empty(), shots: 0 }
    }

    fn sized(project: Project, size: Option<[u32; 2]>) -> Self {
        Self::in_window(project, size, [160, 120])
    }

    /// Opens the scene of a project in a window of a size.
    pub fn resized(project: Project, window: [u32; 2]) -> Self {
        Self::in_window(project, None, window)
    }

    fn in_window(project: Project, size: Option<[u32; 2]>, window: [u32; 2]) -> Self {
        let gpu = Gpu::open(&GpuOptions::default()).unwrap();
        let job = Job { source: project.path(SCENE), size, ..Job::default() };
        let mut desk = Self { core: Core::new(gpu, Some(job), || {}).unwrap(), project, shots: 0 };
        desk.core.want_size(window);
        desk.until("the first picture", |core| core.state.frames > 0);
        desk
    }

    pub fn until(&mut self, what: &str, is_so: impl Fn(&Core) -> bool) {
        let began = Instant::now();
        while !is_so(&self.core) {
            assert!(began.elapsed() < PATIENCE, "waited in vain for {what}: {:?}", self.core.state.findings);
            let tick = self.core.tick(Instant::now());
            assert!(!tick.is_lost, "the device was lost");
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    /// Lets it work until nothing is left to do.
    pub fn rest(&mut self) {
        let began = Instant::now();
        while self.core.tick(Instant::now()) != Tick::default() || self.core.state.busy.is_some() {
            assert!(began.elapsed() < PATIENCE, "it does not come to rest");
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    /// The picture as a file's bytes.
    pub fn picture(&mut self) -> Vec<u8> {
        self.rest();
        self.shots += 1;
        let path = self.project.path(&format!("shot{}.png", self.shots));
        self.core.act(Action::Shoot(path.clone()));
        self.rest();
        std::fs::read(path).unwrap()
    }

    /// What `render` draws.
    pub fn fresh(&self) -> Vec<u8> {
        self.fresh_with(&[])
    }

    pub fn fresh_with(&self, more: &[&str]) -> Vec<u8> {
        let all = ["render", SCENE, "-o", "fresh.png", "--size", SIZE];
        let fresh = self.project.run(&[&all, more].concat());
        assert_eq!(fresh.code, 0, "{}", fresh.stderr);
        std::fs::read(self.project.path("fresh.png")).unwrap()
    }

    /// Edits a file, and waits until that was taken, for good or bad.
    pub fn edit(&mut self, name: &str, from: &str, to: &str) {
        self.rest();
        let before = self.core.state.reloads.len();
        self.project.edit(name, from, to);
        self.until("a reload", |core| core.state.reloads.len() > before);
    }

    pub fn notice(&self) -> &str {
        self.core.state.notice.as_ref().map_or("", |(text, _)| text)
    }
}
