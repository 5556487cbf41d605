//! The graph language: what a graph file says, as plain data with spans.
//!
//! [`model`] is the shape, [`read`] makes it from RON text and reports every mistake of form,
//! [`expr`] is the small language inside strings, and [`eval`] gives expressions their values.
//! Nothing here looks at shaders or knows what names stand for; `plan` does.

pub(crate) mod declared;
pub mod eval;
pub mod expr;
pub mod model;
mod read;
pub mod rows;
pub mod value;

pub use read::{SAMPLERS, SCALARS, read};
