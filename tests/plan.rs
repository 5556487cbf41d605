//! Planning: culling, order, what the planner puts in, units and their causes, memory; plans of
//! every shipped graph as text; random graphs.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "support/generate.rs"]
mod generate;
#[path = "support/golden.rs"]
mod golden;
#[path = "support/planning.rs"]
mod planning;

mod plan {
    mod culling;
    mod cuts;
    mod inserted;
    mod memory;
    mod order;
    mod parts;
    mod points;
    mod printed;
    mod random;
    mod shipped;
    mod state;
    mod units;
    mod unstored;
}
