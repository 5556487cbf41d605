//! The window: a picture that follows its files, the camera and every parameter, and a look at
//! whatever makes it.
//!
//! [`core`] holds what happens, without a window: it takes news from `worker` (a thread that
//! loads, checks, plans and compiles), submits frames to a [`crate::host::Session`], and keeps
//! [`state`]. `ui` draws that state with egui and gives back [`action::Action`]s. `app` is the
//! event loop. Only `app`, `painter` and `ui` know winit and egui, so that the rest is tested
//! without a display.

pub mod action;
mod app;
mod camera;
pub mod clock;
pub mod core;
mod dropped;
mod editor;
pub mod graph;
pub mod history;
mod inspect;
pub mod look;
mod pace;
mod painter;
pub mod params;
mod sequences;
pub mod state;
mod ui;
mod viewpoints;
mod worker;

pub use pace::Pace;

use crate::diagnostic::Diagnostics;
use crate::host::Job;

/// What the window opens with.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Absent: a page that lists scenes.
    pub job: Option<Job>,
    /// The graphics interface to use.
    pub backend: Option<String>,
}

/// Opens the window and stays until it is closed; then tells how the interface's thread kept pace.
///
/// # Errors
/// If there is no display or no usable adapter, or the device was lost for good.
pub fn run(options: Options) -> Result<Pace, Diagnostics> {
    app::run(options)
}
