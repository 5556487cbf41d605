//! Plans as text, for people and for tests; as JSON, for programs; as DOT and SVG, to look at.

mod describe;
mod dot;
mod explained;
mod json;
mod memory;
mod rows;
mod svg;
mod text;

pub use describe::{bytes, object, pass};
pub use dot::dot;
pub use explained::{explained, explained_json};
pub use json::json;
pub(crate) use rows::{id as object_id, rows, shared_handles};
pub use svg::svg;
pub(crate) use text::causes;
pub use text::text;
