//! Triangle meshes, compiled to world space.

use super::geometry::LocalPoint;
use crate::Spectrum;
use crate::math::{Frame, Vec2, Vec3};
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

/// The weights of a point that lies at least `2 margin` from the edges, or well inside a small triangle.
#[cold]
fn kept_inside(weights: DVec3, edges_squared: DVec3, cross: DVec3, margin: f64) -> DVec3 {
    let edges = edges_squared.map(f64::sqrt);
    let least = (2.0 * margin / cross.length() * edges).min(DVec3::splat(0.25));
    let weights = weights.max(least);
    weights / weights.element_sum()
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

    /// The point of given barycentric coordinates, moved inwards so that, where the triangle is large enough, it keeps
    /// `2 margin` from the edges: a ray that leaves from within `margin` of the surface then cannot pass by a neighbour,
    /// unless the surface folds sharply.
    #[inline]
    pub(super) fn meet(&self, triangle: u32, barycentrics: Vec2, margin: f64) -> LocalPoint {
        let [a, b, c] = self.corners(triangle as usize).map(Vec3::as_dvec3);
        let DVec2 { x: wb, y: wc } = barycentrics.as_dvec2();
        let weights = DVec3::new(1.0 - wb - wc, wb, wc);
        let edges_squared = DVec3::new((c - b).length_squared(), (a - c).length_squared(), (b - a).length_squared());
        let cross = (b - a).cross(c - a);
        // The squares of: distance from an edge = weight * double area / edge >= 2 margin.
        let far = weights * weights * cross.length_squared();
        let near = edges_squared * (4.0 * margin * margin);
        let inside = weights.cmpge(DVec3::ZERO).all() && far.cmpge(near).all();
        let weights = if inside { weights } else { kept_inside(weights, edges_squared, cross, margin) };
        self.point(triangle, DVec2::new(weights.y, weights.z))
    }

    /// The point of given barycentric coordinates.
    #[inline]
    pub(super) fn point(&self, triangle: u32, barycentrics: DVec2) -> LocalPoint {
        let indices = self.triangles[triangle as usize].map(|i| i as usize);
        let [a, b, c] = indices.map(|i| self.positions[i].as_dvec3());
        let DVec2 { x: wb, y: wc } = barycentrics;
        let (ab, ac) = (b - a, c - a);
        let position = a + wb * ab + wc * ac;
        let normal = ab.cross(ac).normalize_or_zero();
        let barycentrics = barycentrics.as_vec2();
        let wa = 1.0 - barycentrics.x - barycentrics.y;
        let weights = [wa, barycentrics.x, barycentrics.y];
        let mut shading_normal = normal.as_vec3();
        if !self.normals.is_empty() {
            let [na, nb, nc] = indices.map(|i| self.normals[i]);
            let sum = weights[0] * na + weights[1] * nb + weights[2] * nc;
            shading_normal = sum.try_normalize().unwrap_or(shading_normal);
        }
        let (ab, ac) = (ab.as_vec3(), ac.as_vec3());
        let (mut uv, mut dp_du, mut dp_dv) = (barycentrics, ab, ac);
        if !self.uvs.is_empty() {
            let [ta, tb, tc] = indices.map(|i| self.uvs[i]);
            uv = weights[0] * ta + weights[1] * tb + weights[2] * tc;
            let (tab, tac) = (tb - ta, tc - ta);
            let inverse = tab.perp_dot(tac).recip();
            if inverse.is_finite() {
                dp_du = (tac.y * ab - tab.y * ac) * inverse;
                dp_dv = (tab.x * ac - tac.x * ab) * inverse;
            } else {
                let frame = Frame::from_normal(normal.as_vec3());
                (dp_du, dp_dv) = (frame.s, frame.t);
            }
        }
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
