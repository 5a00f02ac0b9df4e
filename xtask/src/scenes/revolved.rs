//! Surfaces of revolution.

use super::mesh::Mesh;
use std::f64::consts::TAU;

/// A surface of revolution about the y axis: one ([radius, height], normal) after another along the profile.
pub(super) struct Revolved {
    pub(super) profile: Vec<([f64; 2], [f64; 2])>,
}

impl Revolved {
    /// Straight pieces between (radius, height) points, each with normals of its own, to the right of the way along it.
    pub(super) fn pieces(points: &[[f64; 2]]) -> Mesh {
        points.windows(2).fold(Mesh::default(), |mesh, ends| {
            let normal = [ends[1][1] - ends[0][1], ends[0][0] - ends[1][0]];
            let length = normal[0].hypot(normal[1]);
            let profile = ends.iter().map(|&end| (end, normal.map(|x| x / length))).collect();
            mesh.with(&Self { profile }.mesh(36))
        })
    }

    /// The mesh, with vertex normals, in `around` steps about the axis; faces wind such that their normals agree with those.
    pub(super) fn mesh(&self, around: usize) -> Mesh {
        let mut mesh = Mesh::default();
        for ([r, y], [nr, ny]) in &self.profile {
            for i in 0..around {
                let (sin, cos) = (TAU * i as f64 / around as f64).sin_cos();
                mesh.positions.push([r * cos, *y, r * sin]);
                mesh.normals.push([nr * cos, *ny, nr * sin]);
            }
        }
        for row in 0..self.profile.len() - 1 {
            let (p, q) = (&self.profile[row], &self.profile[row + 1]);
            // the geometric normal of a step (dr, dy) along the profile is (dy, -dr), for the winding (a, b, c) below
            let (dr, dy) = (q.0[0] - p.0[0], q.0[1] - p.0[1]);
            let outwards = dy * (p.1[0] + q.1[0]) - dr * (p.1[1] + q.1[1]) > 0.0;
            for i in 0..around {
                let j = (i + 1) % around;
                let [a, b] = [i, j].map(|i| row * around + i);
                let [d, c] = [a, b].map(|v| v + around);
                // on the axis a quadrilateral is a triangle
                let halves = [(q.0[0] > 0.0, [a, d, c]), (p.0[0] > 0.0, [a, c, b])];
                for (_, [x, y, z]) in halves.into_iter().filter(|half| half.0) {
                    mesh.triangles.push(if outwards { [x, y, z] } else { [x, z, y] });
                }
            }
        }
        mesh
    }
}
