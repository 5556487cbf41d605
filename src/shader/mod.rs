//! WGSL modules: imports, a map back to what the person wrote, and reflection.
//!
//! [`load`] takes a file's name to a [`Module`](reflect::Module) or to what is wrong with it, in
//! steps that each stand in a file of their own: the file and its imports become one text with a
//! [`SourceMap`]; naga parses and validates it; what naga knows, and the places in the text that
//! it does not keep, become [`reflect`]'s plain data.
//!
//! [`reflect`] is the shape of what a module tells: its globals with binding numbers that this
//! program assigned, the layouts of what they hold, and for each entry point what it reads,
//! writes, takes in and puts out. Everything else in the program asks these and never a
//! hand-kept list.

mod assemble;
mod declare;
mod inspect;
mod limits;
mod load;
mod map;
mod message;
mod parse;
pub mod reflect;
mod scan;
mod types;
mod walk;

pub(crate) use load::Gathered;
pub use load::{Loaded, load};
pub use map::SourceMap;
