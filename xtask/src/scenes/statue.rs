//! A statue: a knotted band on a pedestal.

use super::mesh::{Mesh, Vector, add, cross, dot, scale, sub, unit};
use super::revolved::Revolved;
use std::f64::consts::TAU;

/// The trefoil that the band follows, upright; `t` in turns.
fn knot(t: f64) -> Vector {
    let (a, b) = (2.0 * TAU * t, 3.0 * TAU * t);
    let r = 0.36 + 0.17 * b.cos();
    [r * a.cos(), 1.3 * r * a.sin() + 1.72, 0.24 * b.sin()]
}

/// A band with rounded edges that turns about the knot as it goes, standing at y = 1.
pub(super) fn figure() -> Mesh {
    const ALONG: usize = 250;
    const AROUND: usize = 40;
    Mesh::grid(AROUND, ALONG, [true, true], |i, j| {
        let t = j as f64 / ALONG as f64;
        let centre = knot(t);
        let along = unit(sub(knot(t + 1e-4), knot(t - 1e-4)));
        // a frame from the way to the knot's middle, free of jumps since the band never points there
        let middle = sub(centre, [0.0, 1.72, 0.0]);
        let side = unit(sub(middle, scale(dot(middle, along), along)));
        let up = cross(along, side);
        // a superellipse that turns twice, so that its ends meet
        let (sin, cos) = (TAU * i as f64 / AROUND as f64).sin_cos();
        let power = |x: f64| x.signum() * x.abs().powf(0.6);
        let (u, v) = (0.125 * power(cos), 0.055 * power(sin));
        let (s, c) = (2.0 * TAU * t).sin_cos();
        add(centre, add(scale(u * c - v * s, side), scale(u * s + v * c, up)))
    })
}

/// The pedestal, from the floor to y = 1.
pub(super) fn pedestal() -> Mesh {
    Revolved::pieces(&[
        [0.46, 0.0],
        [0.46, 0.1],
        [0.42, 0.14],
        [0.36, 0.17],
        [0.33, 0.22],
        [0.28, 0.8],
        [0.31, 0.84],
        [0.36, 0.87],
        [0.38, 0.9],
        [0.38, 0.98],
        [0.36, 1.0],
        [0.0, 1.0],
    ])
}
