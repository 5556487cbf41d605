//! Particle files.
