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
    /// What is the same all over each triangle, noted for meshes without normals that are small.
    pub(crate) facets: Vec<(Facet, Frame)>,
}

/// Meshes of so many triangles have their facets noted.
const NOTED: usize = 256;

/// What is the same all over a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facet {
    corner: DVec3,
    /// From the first corner to the others, metres.
    edges: [DVec3; 2],
    /// Squared lengths of the edges opposite to the corners, m^2.
    edges_squared: DVec3,
    /// Squared length of the cross product of the edges, m^4.
    cross_squared: f64,
    normal: DVec3,
    dp_du: Vec3,
    dp_dv: Vec3,
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
fn kept_inside(weights: DVec3, facet: &Facet, margin: f64) -> DVec3 {
    let edges = facet.edges_squared.map(f64::sqrt);
    let least = (2.0 * margin / facet.cross_squared.sqrt() * edges).min(DVec3::splat(0.25));
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

    /// Notes the facets where that is worth their memory.
    pub(super) fn note_facets(&mut self) {
        if self.normals.is_empty() && self.triangles.len() <= NOTED {
            let note = |triangle| {
                let facet = self.facet(triangle);
                (facet, Frame::from_normal_and_tangent(facet.normal.as_vec3(), facet.dp_du))
            };
            self.facets = (0..self.triangles.len()).map(note).collect();
        }
    }

    #[inline(always)]
    fn facet(&self, triangle: usize) -> Facet {
        let indices = self.triangles[triangle].map(|i| i as usize);
        let [a, b, c] = indices.map(|i| self.positions[i].as_dvec3());
        let (ab, ac) = (b - a, c - a);
        let edges_squared = DVec3::new((c - b).length_squared(), (a - c).length_squared(), ab.length_squared());
        let cross = ab.cross(ac);
        let normal = cross.normalize_or_zero();
        let (mut dp_du, mut dp_dv) = (ab.as_vec3(), ac.as_vec3());
        if !self.uvs.is_empty() {
            let [ta, tb, tc] = indices.map(|i| self.uvs[i]);
            let (tab, tac) = (tb - ta, tc - ta);
            let inverse = tab.perp_dot(tac).recip();
            (dp_du, dp_dv) = if inverse.is_finite() {
                ((tac.y * dp_du - tab.y * dp_dv) * inverse, (tab.x * dp_dv - tac.x * dp_du) * inverse)
            } else {
                let frame = Frame::from_normal(normal.as_vec3());
                (frame.s, frame.t)
            };
        }
        let cross_squared = cross.length_squared();
        Facet { corner: a, edges: [ab, ac], edges_squared, cross_squared, normal, dp_du, dp_dv }
    }

    /// The point of given barycentric coordinates, moved inwards so that, where the triangle is large enough, it keeps
    /// `2 margin` from the edges: a ray that leaves from within `margin` of the surface then cannot pass by a neighbour,
    /// unless the surface folds sharply. With its shading frame where that is noted.
    #[inline(always)]
    pub(super) fn meet(&self, triangle: u32, barycentrics: Vec2, margin: f64) -> (LocalPoint, Option<&Frame>) {
        let computed;
        let (facet, frame) = match self.facets.get(triangle as usize) {
            Some((facet, frame)) => (facet, Some(frame)),
            None => {
                computed = self.facet(triangle as usize);
                (&computed, None)
            }
        };
        let DVec2 { x: wb, y: wc } = barycentrics.as_dvec2();
        let weights = DVec3::new(1.0 - wb - wc, wb, wc);
        // The squares of: distance from an edge = weight * double area / edge >= 2 margin.
        let far = weights * weights * facet.cross_squared;
        let near = facet.edges_squared * (4.0 * margin * margin);
        let inside = weights.cmpge(DVec3::ZERO).all() && far.cmpge(near).all();
        let weights = if inside { weights } else { kept_inside(weights, facet, margin) };
        (self.point(triangle, facet, DVec2::new(weights.y, weights.z)), frame)
    }

    /// The point of given barycentric coordinates.
    #[inline(always)]
    fn point(&self, triangle: u32, facet: &Facet, barycentrics: DVec2) -> LocalPoint {
        let &Facet { corner, edges: [ab, ac], normal, dp_du, dp_dv, .. } = facet;
        let position = corner + barycentrics.x * ab + barycentrics.y * ac;
        let barycentrics = barycentrics.as_vec2();
        let weights = [1.0 - barycentrics.x - barycentrics.y, barycentrics.x, barycentrics.y];
        let indices = self.triangles[triangle as usize].map(|i| i as usize);
        let mut shading_normal = normal.as_vec3();
        if !self.normals.is_empty() {
            let [na, nb, nc] = indices.map(|i| self.normals[i]);
            let sum = weights[0] * na + weights[1] * nb + weights[2] * nc;
            shading_normal = sum.try_normalize().unwrap_or(shading_normal);
        }
        let mut uv = barycentrics;
        if !self.uvs.is_empty() {
            let [ta, tb, tc] = indices.map(|i| self.uvs[i]);
            uv = weights[0] * ta + weights[1] * tb + weights[2] * tc;
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
