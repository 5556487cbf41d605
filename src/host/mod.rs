pub mod dump;
pub mod picture;
pub mod texels;
