//! A data-driven render graph: graphs of passes and resources in RON, shaders in WGSL, and one
//! executor that checks, schedules, runs and reloads them.
//!
//! Data flows one way: files → graph (with spans) → check against reflected shaders → plan →
//! engine → picture. Each step is a function from one value to the next, and everything up to
//! and including the plan works without a GPU.
//!
//! Whoever draws with graphs in a program of their own finds all that they need in [`embed`]. The other modules are what the
//! command line, the window and the tests are made of.

pub mod check;
pub mod cli;
pub mod diagnostic;
pub mod embed;
pub mod engine;
pub mod files;
pub mod format;
pub mod graph;
pub mod host;
mod output;
mod parallel;
pub mod plan;
pub mod program;
pub mod reload;
pub mod scene;
pub mod shader;
pub mod syntax;
#[cfg(feature = "viewer")]
pub mod viewer;
mod words;
