//! Commands on their way to the device. A compute pass stays open for as long as nothing but
//! dispatches comes: wgpu keeps the order of dispatches inside a pass, so that what one writes
//! the next one reads, and each pass that is not begun is time saved.

use std::sync::LazyLock;
use std::time::Instant;

use crate::engine::gpu::Gpu;

/// Passes to a submission, so that a thousand steps do not make one huge one.
const PASSES_TO_A_SUBMISSION: usize = 512;

/// Whether commands bear the names of passes, for graphics debuggers: where wgpu's own debug
/// flag is set (in debug builds, or by `WGPU_DEBUG=1`).
static NAMED: LazyLock<bool> =
    LazyLock::new(|| wgpu::InstanceFlags::from_env_or_default().contains(wgpu::InstanceFlags::DEBUG));

pub(in crate::engine) struct Recorder {
    encoder: wgpu::CommandEncoder,
    compute: Option<wgpu::ComputePass<'static>>,
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

impl Recorder {
    pub fn new(gpu: &Gpu) -> Self {
        let label = Some("frame");
        let encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
        Self { encoder, compute: None, named: *NAMED, passes: 0, begun: Begun::default() }
    }

    /// For everything but dispatches: ends the compute pass that is open.
    pub fn encoder(&mut self) -> &mut wgpu::CommandEncoder {
        self.compute = None;
        &mut self.encoder
    }

    /// Whether the next dispatch joins those before it.
    pub fn is_computing(&self) -> bool {
        self.compute.is_some()
    }

    /// The compute pass that is open, or a new one.
    pub fn compute(&mut self, descriptor: &wgpu::ComputePassDescriptor<'_>) -> &mut wgpu::ComputePass<'static> {
        let (encoder, begun) = (&mut self.encoder, &mut self.begun);
        self.compute.get_or_insert_with(|| {
            begun.compute_passes += 1;
            encoder.begin_compute_pass(descriptor).forget_lifetime()
        })
    }

    pub fn render(&mut self, descriptor: &wgpu::RenderPassDescriptor<'_>) -> wgpu::RenderPass<'_> {
        self.compute = None;
        self.begun.render_passes += 1;
        self.encoder.begin_render_pass(descriptor)
    }

    /// Counts passes, and submits now and then.
    pub fn count(&mut self, gpu: &Gpu, passes: usize) {
        self.passes += passes;
        if self.passes >= PASSES_TO_A_SUBMISSION {
            let full = std::mem::replace(self, Self::new(gpu));
            self.begun = full.submit(gpu);
        }
    }

    pub fn finish(mut self) -> wgpu::CommandBuffer {
        self.compute = None;
        self.encoder.finish()
    }

    /// Submits, and gives what all of the frame up to here began.
    pub fn submit(self, gpu: &Gpu) -> Begun {
        let mut begun = self.begun;
        let commands = self.finish();
        let began = Instant::now();
        gpu.queue().submit([commands]);
        begun.submissions += 1;
        begun.submit_ms += began.elapsed().as_secs_f64() * 1e3;
        begun
    }
}
