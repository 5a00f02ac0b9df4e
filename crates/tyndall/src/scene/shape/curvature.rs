//! How normals change along surfaces.

use super::{Form, Geometry, SurfacePoint};
use crate::math::Vec3;

impl Geometry {
    /// The change of the unit shading normal when the point moves by the small `offset` along the surface: exact for spheres
    /// and tubes, that of the interpolated vertex normals on meshes. Meshes placed as instances count as flat.
    pub fn normal_change(&self, point: &SurfacePoint, offset: Vec3) -> Vec3 {
        match self.form(point.shape) {
            Form::Sphere(sphere) => offset * (sphere.side / sphere.radius) as f32,
            Form::Cylinder(cylinder) => {
                let axis = cylinder.axes[2].as_vec3();
                (offset - axis * axis.dot(offset)) * (cylinder.side / cylinder.radius) as f32
            }
            Form::Mesh(mesh) if !mesh.normals.is_empty() => {
                let triangle = point.triangle as usize;
                let [a, b, c] = mesh.corners(triangle);
                let (ab, ac) = (b - a, c - a);
                let cross = ab.cross(ac);
                let area2 = cross.length_squared();
                let in_plane = (point.position - a).dot(cross).abs() <= 1e-3 * area2.sqrt() * ab.length();
                if !(area2 > 0.0 && in_plane) {
                    return Vec3::ZERO;
                }
                // The offset in barycentric coordinates, by Cramer's rule in the triangle's plane.
                let (wb, wc) = (offset.cross(ac).dot(cross) / area2, ab.cross(offset).dot(cross) / area2);
                let [na, nb, nc] = mesh.triangles[triangle].map(|i| mesh.normals[i as usize]);
                let weights = point.barycentrics;
                let sum = na + weights.x * (nb - na) + weights.y * (nc - na);
                let change = wb * (nb - na) + wc * (nc - na);
                let n = point.shading.n;
                // The change of the length does not count, and the frame may look to the other side.
                let turned = (change - n * n.dot(change)) / sum.length();
                if sum.dot(n) < 0.0 { -turned } else { turned }
            }
            _ => Vec3::ZERO,
        }
    }
}
