//! The host of graphs: it loads what a scene names, plans the scene's graph and the graph that
//! turns light into a picture, has the engine run both, and hands out pictures and contents.
//!
//! [`load`] reads, without a device; a [`Session`] builds what was loaded on a device and draws
//! it. A load or a build that fails leaves a session as it was.

mod assets;
mod build;
mod content;
mod draw;
pub mod dump;
mod frames;
mod inputs;
mod live;
mod live_values;
mod load;
mod meshes;
mod models;
mod moving;
pub mod params;
pub mod picture;
pub mod player;
pub mod sequence;
mod source;
mod state;
mod stepping;
mod viewpoint;

pub use crate::engine::Due;
pub use assets::{Cache, Particles};
pub use build::{Builder, Built, Planned, Session};
pub use content::Content;
pub use draw::{Drawn, Moment};
pub(crate) use frames::numbered_files;
pub use inputs::Input;
pub use live::{Live, Read};
pub use load::{Job, Loaded, load};
pub use player::Player;
pub use sequence::{Frames, Track, When};
pub(crate) use source::named;
pub use source::renderable;
