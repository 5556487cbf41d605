//! What `render`, `watch` and `bench` share: from arguments to a job and a device.

use std::thread::{self, JoinHandle};

use super::args::{SceneArgs, UpArg, WhenArgs};
use crate::diagnostic::{Code, Diagnostic};
use crate::engine::{Gpu, GpuOptions};
pub use crate::host::picture::numbered;
use crate::host::{Job, When};

/// What the arguments ask to see.
pub fn job(args: &SceneArgs) -> Job {
    Job {
        source: args.scene.clone(),
        graph: args.graph.clone(),
        particles: args.particles.clone(),
        radius_m: args.radius,
        up: args.up.map(UpArg::axis),
        scale: args.scale,
        size: args.size,
        set: args.set.clone(),
        eye: args.eye,
        target: args.target,
        fov_degrees: args.fov,
        pointer: args.pointer,
        transparent: false,
        roots: Vec::new(),
        when: When::Start,
        policy: args.memory.policy(),
        memory_budget: args.memory.memory_budget,
        ..Job::default()
    }
}

pub fn when(args: WhenArgs) -> When {
    match (args.frame, args.time) {
        (_, Some(time)) => When::Time(time),
        (Some(frame), None) => When::Frame(frame),
        (None, None) => When::Start,
    }
}

/// A device that is being opened while files are read. Dropping it waits too: a program that ends
/// while a driver is still setting itself up may never end.
#[derive(Debug)]
pub struct Opening(Option<JoinHandle<Result<Gpu, Diagnostic>>>);

impl Opening {
    pub fn begin(backend: Option<&str>) -> Self {
        let options = GpuOptions { backend: backend.map(str::to_owned), ..GpuOptions::default() };
        Self(Some(thread::spawn(move || Gpu::open(&options))))
    }

    /// # Errors
    /// If no adapter is usable.
    pub fn wait(mut self) -> Result<Gpu, Diagnostic> {
        self.0.take().and_then(|thread| thread.join().ok()).unwrap_or_else(|| {
            Err(Diagnostic::error(Code::DEVICE, "no usable graphics adapter: opening one failed")
                .hint("another may work: `--backend NAME`"))
        })
    }
}

impl Drop for Opening {
    fn drop(&mut self) {
        if let Some(thread) = self.0.take() {
            // Whether it opened does not matter any more.
            _ = thread.join();
        }
    }
}
