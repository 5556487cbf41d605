//! Commands on their way to the device. A compute pass stays open for as long as nothing but
//! dispatches comes: wgpu keeps the order of dispatches inside a pass, so that what one writes
//! the next one reads, and each pass that is not begun is time saved.

use std::sync::LazyLock;
use std::time::Instant;

use crate::diagnostic::Diagnostic;
use crate::engine::gpu::Gpu;

/// Passes to a submission, so that a thousand steps do not make one huge one.
const PASSES_TO_A_SUBMISSION: usize = 512;

/// Whether commands bear the names of passes, for graphics debuggers: where wgpu's own debug
/// flag is set (in debug builds, or by `WGPU_DEBUG=1`).
static NAMED: LazyLock<bool> =
    LazyLock::new(|| wgpu::InstanceFlags::from_env_or_default().contains(wgpu::InstanceFlags::DEBUG));

/// Whose encoder it is.
enum Commands<'a> {
    Own(wgpu::CommandEncoder),
    /// An embedder's, who submits it.
    Theirs(&'a mut wgpu::CommandEncoder),
}

impl Commands<'_> {
    fn encoder(&mut self) -> &mut wgpu::CommandEncoder {
        match self {
            Commands::Own(encoder) => encoder,
            Commands::Theirs(encoder) => encoder,
        }
    }
}

pub(in crate::engine) struct Recorder<'a> {
    /// Before the encoder, so that it ends first.
    compute: Option<wgpu::ComputePass<'static>>,
    commands: Commands<'a>,
    pub named: bool,
    passes: usize,
    begun: Begun,
}

/// What recording a frame began, and how long handing it over took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::engine) struct Begun {
    pub compute_passes: u32,
    pub render_passes: u32,
    pub submissions: u32,
    pub submit_ms: f64,
}

impl<'a> Recorder<'a> {
    pub fn new(gpu: &Gpu) -> Self {
        Self::of(Commands::Own(own(gpu)))
    }

    /// Records into somebody else's commands.
    pub fn within(encoder: &'a mut wgpu::CommandEncoder) -> Self {
        Self::of(Commands::Theirs(encoder))
    }

    fn of(commands: Commands<'a>) -> Self {
        Self { compute: None, commands, named: *NAMED, passes: 0, begun: Begun::default() }
    }

    /// For everything but dispatches: ends the compute pass that is open.
    pub fn encoder(&mut self) -> &mut wgpu::CommandEncoder {
        self.compute = None;
        self.commands.encoder()
    }

    /// Whether it submits what it records.
    pub fn is_own(&self) -> bool {
        matches!(self.commands, Commands::Own(_))
    }

    /// Whether the next dispatch joins those before it.
    pub fn is_computing(&self) -> bool {
        self.compute.is_some()
    }

    /// The compute pass that is open, or a new one.
    pub fn compute(&mut self, descriptor: &wgpu::ComputePassDescriptor<'_>) -> &mut wgpu::ComputePass<'static> {
        let (commands, begun) = (&mut self.commands, &mut self.begun);
        self.compute.get_or_insert_with(|| {
            begun.compute_passes += 1;
            commands.encoder().begin_compute_pass(descriptor).forget_lifetime()
        })
    }

    pub fn render(&mut self, descriptor: &wgpu::RenderPassDescriptor<'_>) -> wgpu::RenderPass<'_> {
        self.compute = None;
        self.begun.render_passes += 1;
        self.commands.encoder().begin_render_pass(descriptor)
    }

    /// Counts passes, and submits now and then what is its own.
    pub fn count(&mut self, gpu: &Gpu, passes: usize) {
        self.passes += passes;
        if self.passes < PASSES_TO_A_SUBMISSION {
            return;
        }
        self.submit(gpu);
    }

    /// Submits what is its own, and goes on with new commands.
    pub fn submit(&mut self, gpu: &Gpu) {
        self.compute = None;
        if let Commands::Own(encoder) = &mut self.commands {
            let full = std::mem::replace(encoder, own(gpu));
            self.begun.submit(gpu, full);
            self.passes = 0;
        }
    }

    /// Waits until the device is done with all that was submitted; that counts as submitting.
    ///
    /// # Errors
    /// If it does not end.
    pub fn wait(&mut self, gpu: &Gpu) -> Result<(), Diagnostic> {
        let began = Instant::now();
        let waited = gpu.drain();
        self.begun.submit_ms += began.elapsed().as_secs_f64() * 1e3;
        waited
    }

    /// The commands, if they are its own.
    pub fn finish(mut self) -> Option<wgpu::CommandBuffer> {
        self.compute = None;
        match self.commands {
            Commands::Own(encoder) => Some(encoder.finish()),
            Commands::Theirs(_) => None,
        }
    }

    /// Submits what is its own, and gives what all of the frame up to here began.
    pub fn end(mut self, gpu: &Gpu) -> Begun {
        self.compute = None;
        if let Commands::Own(encoder) = self.commands {
            self.begun.submit(gpu, encoder);
        }
        self.begun
    }
}

impl Begun {
    fn submit(&mut self, gpu: &Gpu, encoder: wgpu::CommandEncoder) {
        let commands = encoder.finish();
        let began = Instant::now();
        gpu.queue().submit([commands]);
        self.submissions += 1;
        self.submit_ms += began.elapsed().as_secs_f64() * 1e3;
    }
}

fn own(gpu: &Gpu) -> wgpu::CommandEncoder {
    gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") })
}
