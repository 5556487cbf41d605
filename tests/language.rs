//! The graph language: form, expressions, and what is said about mistakes.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "support/golden.rs"]
mod golden;

mod language {
    pub mod cases;
    mod expressions;
    mod reading;
    mod robust;
    mod ron_reference;
}
