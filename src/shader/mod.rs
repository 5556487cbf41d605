//! WGSL modules: imports, a map back to what the person wrote, and reflection.
//!
//! [`reflect`] is the shape of what a module tells: its globals with binding numbers that this
//! program assigned, the layouts of what they hold, and for each entry point what it reads,
//! writes, takes in and puts out. Everything else in the program asks these and never a
//! hand-kept list.

pub mod reflect;
