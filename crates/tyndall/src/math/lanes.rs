//! Eight-wide lanes of `f32`, at a SIMD level chosen once at start-up.
