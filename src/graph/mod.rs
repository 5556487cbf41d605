//! The graph language: what a graph file says, as plain data with spans.
//!
//! [`model`] is the shape, [`read`] makes it from RON text and reports every mistake of form,
//! [`expr`] is the small language inside strings. Nothing here looks at shaders or evaluates
//! anything; `plan` does.

pub mod expr;
pub mod model;
mod read;
pub mod value;

pub use read::{SAMPLERS, SCALARS, read};
