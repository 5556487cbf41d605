//! Reloading: watching exactly what was read.
//!
//! [`Watch`] tells when one of a set of files may have changed. Building aside and swapping is
//! what its user does with a [`crate::host::Session`]: a session whose load fails keeps the last
//! good picture.

mod watch;

pub use watch::{Change, Waker, Watch};
