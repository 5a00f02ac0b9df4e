//! Bidirectional methods: against closed forms and against path tracing.

#[path = "../common/mod.rs"]
mod common;

mod closed_forms;
mod merging;
mod pyramid;
mod reciprocity;
mod weights;
