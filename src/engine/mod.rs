//! Carrying out plans on wgpu.
//!
//! The engine decides nothing: a [`crate::plan::model::Plan`] says what happens, in what order
//! and on which memory. [`Engine::prepare`] makes a plan ready beside whatever runs; the
//! [`Runner`] it gives runs frames, takes inputs and gives results. Frames wait for nothing; only
//! reading back does.
//!
//! Outside this module the only wgpu types are those that embedders hand in and take out.

mod bind;
mod carry;
mod census;
mod claims;
mod clear;
mod compile;
mod convert;
mod cuts;
mod draws;
mod due;
mod encode;
mod errors;
mod gpu;
mod kernels;
mod materials;
mod meshes;
mod mips;
mod pipeline;
mod pool;
mod prepare;
mod readback;
mod report;
mod run;
mod screen;
mod statistics;
pub mod texel;
mod timing;
mod uniform;
mod upload;

pub use census::Census;
pub use compile::{Compiled, Compiler};
pub use due::Due;
pub use errors::{any_device_gone, is_device_gone};
pub use gpu::{AdapterSummary, Gpu, GpuOptions, wanted_features};
pub use materials::{MaterialImage, MaterialSampler, MaterialSlots};
pub use prepare::{Engine, Refused, Runner};
pub use readback::TextureData;
pub use report::{BuildReport, CountReport, PassReport, Report, UnitReport};
pub use run::{Frame, StepInfo};
pub use screen::Screen;

pub use crate::plan::model::Policy;
