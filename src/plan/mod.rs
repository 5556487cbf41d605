//! Planning: from a checked graph and the facts of a frame to a plan of plain data.
//!
//! Planning is a pure function. It touches no device and no file.

pub mod model;
