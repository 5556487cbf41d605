//! What a scene brings: cameras, lights, particles, images, and their file formats.
//!
//! [`read()`] makes a [`Scene`] from RON text. Nothing here knows a device: images become texels,
//! particles become rows of bytes as a shader's type wants them, and the host hands both over.

pub mod camera;
pub mod convert;
pub mod cube;
pub mod edit;
pub mod framing;
pub mod image;
pub mod meshes;
mod model;
pub mod particles;
pub mod placement;
mod pointer;
mod read;
pub mod sequence;
pub mod sun;

pub use camera::{Camera, Light};
pub use model::{CameraFile, CubeFiles, Item, MeshEntry, ParticleSource, Playing, Scene, find};
pub use pointer::{PointerPath, Pointing};
pub use read::{DEFAULT_FOV_DEGREES, read};
