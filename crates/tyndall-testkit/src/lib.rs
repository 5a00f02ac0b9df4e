//! What Tyndall's tests measure with: chi-square and z-tests, closed forms, and a corpus of small scenes.
//!
//! This crate knows nothing of the renderer: it speaks in plain arrays and closures, so that it can judge every part.

pub mod chi2;
pub mod closed_form;
pub mod corpus;
pub mod quadrature;
pub mod random;
pub mod ztest;
