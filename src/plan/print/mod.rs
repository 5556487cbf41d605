//! Plans as text, for people and for tests; as JSON, for programs; as DOT and SVG, to look at.

mod describe;
mod dot;
mod json;
mod rows;
mod svg;
mod text;

pub use describe::{bytes, object, pass};
pub use dot::dot;
pub use json::json;
pub(crate) use rows::id as object_id;
pub use svg::svg;
pub use text::text;
