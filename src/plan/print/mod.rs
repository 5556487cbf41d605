//! Plans as text, for people and for tests.

mod describe;
mod text;

pub use describe::{bytes, object, pass};
pub use text::text;
