//! Triangle meshes, compiled to world space.

use super::geometry::LocalPoint;
use crate::Spectrum;
use crate::math::{Frame, Ray, Vec2, Vec3};
use glam::{DVec2, DVec3};

/// A triangle mesh in world space (or in the space of its shape group).
#[derive(Debug, Default)]
pub struct Mesh {
    /// Vertex positions, metres.
    pub positions: Vec<Vec3>,
    /// Unit vertex normals: empty or one per position. Already turned when the shape flips its normals.
    pub normals: Vec<Vec3>,
    /// Texture coordinates: empty or one per position.
    pub uvs: Vec<Vec2>,
    /// Three positions each. Already reordered so that the cross product of the edges is the geometric normal.
    pub triangles: Vec<[u32; 3]>,
    /// Named data.
    pub attributes: Vec<Attribute>,
}

/// Named data of a mesh.
#[derive(Debug)]
pub struct Attribute {
    /// Full name, `vertex_...` or `face_...`.
    pub name: Box<str>,
    /// One value per triangle instead of one per vertex.
    pub per_face: bool,
    /// The values; grey ones repeat their channel.
    pub values: Vec<Spectrum>,
}

impl Mesh {
    /// The corners of a triangle.
    #[inline(always)]
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|i| self.positions[i as usize])
    }

    /// Area of a triangle, m^2.
    pub fn triangle_area(&self, triangle: usize) -> f64 {
        let [a, b, c] = self.corners(triangle).map(Vec3::as_dvec3);
        0.5 * (b - a).cross(c - a).length()
    }

    /// Where the ray meets a triangle that it is known to hit. The point lies inside the triangle and, where that is
    /// large enough, at least `2 margin` from its edges: a ray that leaves from within `margin` of the surface then
    /// cannot pass by a neighbour, unless the surface folds sharply.
    pub(super) fn meet(&self, ray: &Ray, triangle: u32, margin: f64) -> LocalPoint {
        let corners = self.corners(triangle as usize).map(Vec3::as_dvec3);
        let o = ray.origin.as_dvec3();
        let d = ray.direction.as_dvec3();
        let [a, b, c] = corners.map(|p| p - o);
        let weights = DVec3::new(d.dot(c.cross(b)), d.dot(a.cross(c)), d.dot(b.cross(a)));
        let sum = weights.element_sum();
        let weights = if sum != 0.0 { weights / sum } else { DVec3::splat(1.0 / 3.0) };
        let edges = DVec3::new((c - b).length(), (a - c).length(), (b - a).length());
        let double_area = (b - a).cross(c - a).length();
        let least = (2.0 * margin / double_area * edges).min(DVec3::splat(0.25));
        let weights = weights.max(least);
        let weights = weights / weights.element_sum();
        self.point(triangle, DVec2::new(weights.y, weights.z))
    }

    /// The point of given barycentric coordinates.
    pub(super) fn point(&self, triangle: u32, barycentrics: DVec2) -> LocalPoint {
        let indices = self.triangles[triangle as usize].map(|i| i as usize);
        let [a, b, c] = indices.map(|i| self.positions[i].as_dvec3());
        let DVec2 { x: wb, y: wc } = barycentrics;
        let wa = 1.0 - wb - wc;
        let (ab, ac) = (b - a, c - a);
        let normal = ab.cross(ac).normalize_or_zero();
        let mut shading_normal = normal;
        if !self.normals.is_empty() {
            let [na, nb, nc] = indices.map(|i| self.normals[i].as_dvec3());
            shading_normal = (wa * na + wb * nb + wc * nc).try_normalize().unwrap_or(normal);
        }
        let (mut uv, mut dp_du, mut dp_dv) = (barycentrics, ab, ac);
        if !self.uvs.is_empty() {
            let [ta, tb, tc] = indices.map(|i| self.uvs[i].as_dvec2());
            uv = wa * ta + wb * tb + wc * tc;
            let (tab, tac) = (tb - ta, tc - ta);
            let determinant = tab.perp_dot(tac);
            if determinant != 0.0 {
                dp_du = (tac.y * ab - tab.y * ac) / determinant;
                dp_dv = (tab.x * ac - tac.x * ab) / determinant;
            } else {
                let frame = Frame::from_normal(normal.as_vec3());
                (dp_du, dp_dv) = (frame.s.as_dvec3(), frame.t.as_dvec3());
            }
        }
        let position = wa * a + wb * b + wc * c;
        let (uv, barycentrics) = (uv.as_vec2(), barycentrics.as_vec2());
        LocalPoint { position, normal, shading_normal, uv, dp_du, dp_dv, barycentrics }
    }

    /// The interpolated attribute, if the mesh has it.
    pub fn attribute(&self, name: &str, triangle: u32, barycentrics: Vec2) -> Option<Spectrum> {
        let attribute = self.attributes.iter().find(|a| &*a.name == name)?;
        if attribute.per_face {
            return Some(attribute.values[triangle as usize]);
        }
        let [a, b, c] = self.triangles[triangle as usize].map(|i| attribute.values[i as usize]);
        Some(a * (1.0 - barycentrics.x - barycentrics.y) + b * barycentrics.x + c * barycentrics.y)
    }
}
