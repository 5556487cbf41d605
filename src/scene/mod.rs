//! What a scene brings: cameras, lights, particles, images, and their file formats.

pub mod particles;
