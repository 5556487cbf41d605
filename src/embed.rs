//! What a program of your own needs to draw with graphs on its own wgpu device: `docs/embedding.md` tells how, and
//! `examples/embed.rs` does it. Whoever embeds needs nothing else of this crate; what lies elsewhere is for its tools and
//! changes more freely.
//!
//! ```no_run
//! use meniscus::embed::{
//!     Camera, Diagnostics, DiskFiles, Engine, Frame, Gpu, InputInfo, Request, Sources, instantiate, load, wanted_features,
//! };
//!
//! # fn embed(
//! #     adapter: wgpu::Adapter, device: wgpu::Device, queue: wgpu::Queue, camera: Camera, particles: InputInfo,
//! # ) -> Result<(), Diagnostics> {
//! // Once: an engine on your device, opened with `wanted_features()` as far as the adapter has them.
//! let mut engine = Engine::new(Gpu::from_parts(Some(adapter), device.clone(), queue.clone()));
//!
//! // A graph with its parts and shaders: from the disk, from memory, or one that the library carries.
//! let loaded = load(&DiskFiles, &mut Sources::new(), "graphs/mine.ron", None);
//! let program = loaded.program.ok_or(loaded.diagnostics)?;
//!
//! // A plan: plain data, made without the device, for a size and for what feeds its inputs.
//! let size = [640, 480];
//! let mut request = Request::new(size, device.features(), device.limits());
//! request.inputs.insert("camera".into(), InputInfo::Camera);
//! request.inputs.insert("sun".into(), InputInfo::Light);
//! request.inputs.insert("particles".into(), particles);
//! let plan = instantiate(&program, &request)?;
//!
//! // Pipelines and memory.
//! let mut runner = engine.prepare(plan, None).map_err(|refused| refused.diagnostics)?;
//!
//! // Each frame:
//! let frame = Frame {
//!     time: 0.0,
//!     delta: 1.0 / 60.0,
//!     frame: 0,
//!     steps: &runner.steps_due(0.0, true, 4).steps,
//!     live: &|name, _| camera.field(name.strip_prefix("camera.")?, size),
//!     only: None,
//! };
//! let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
//! runner.encode(&engine, &frame, &mut encoder)?;
//! let picture = runner.texture(runner.plan().outputs[0].object);
//! # _ = picture;
//! queue.submit([encoder.finish()]);
//! # Ok(())
//! # }
//! ```

pub use crate::diagnostic::{Code, Diagnostic, Diagnostics, Severity, Sources, Style, render_all, to_json};
pub use crate::engine::{
    BuildReport, Compiler, CountReport, Due, Engine, Frame, Gpu, PassReport, Policy, Refused, Report, Runner, StepInfo,
    TextureData, UnitReport, any_device_gone, is_device_gone, wanted_features,
};
pub use crate::files::{DiskFiles, Files, MemoryFiles};
pub use crate::format::TextureFormat;
pub use crate::graph::value::Value;
pub use crate::plan::instantiate;
pub use crate::plan::model::{InputInfo, MemoryRequest, ObjectId, ObjectKind, ObjectRef, Plan, Request, Texture};
pub use crate::program::{Loaded, Program, load};
pub use crate::scene::{Camera, Light};
