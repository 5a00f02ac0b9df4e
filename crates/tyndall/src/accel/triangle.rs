//! Packets of eight triangles and their watertight intersection.
//!
//! The test is that of Woop, Benthin and Wald 2013: vertices are sheared into a space where the ray is the z axis, each
//! by the same arithmetic whichever triangle it belongs to, so that a closed mesh stays closed there; the signs of the
//! edge functions about the origin decide. Rounding to nearest is monotone: a difference of two rounded products has
//! the sign of the exact one or is zero, and zero counts as inside for either neighbour. So no ray slips between
//! triangles that share an edge or a vertex, and no second pass in double precision is needed.

use crate::math::lanes::{Lanes, Mask, Row, WIDTH};
use crate::math::{Ray, Vec2, Vec3};
use glam::DVec3;

/// Eight triangles; `vertices[corner][axis]`. Lanes without a triangle hold NaN, which nothing hits.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct TrianglePacket {
    vertices: [[Row; 3]; 3],
    /// A number of the user's for each lane.
    pub ids: [u32; WIDTH],
}

/// A ray made ready for triangle tests.
#[derive(Clone, Copy, Debug)]
pub struct TriangleRay<'a> {
    ray: &'a Ray,
    /// The axes, the one with the largest direction component last: bytes from the first row of a corner.
    rows: [usize; 3],
    /// The origin, by these axes.
    origin: [f32; 3],
    shear: Vec2,
    scale: f32,
}

/// A triangle met by a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleHit {
    /// Distance in units of the direction's length.
    pub t: f32,
    /// Lane in the packet.
    pub lane: usize,
    /// Barycentric coordinates of the second and third vertex.
    pub barycentrics: Vec2,
}

impl<'a> TriangleRay<'a> {
    /// Prepares the ray; its direction need not be a unit vector but must not be zero.
    #[inline(always)]
    pub fn new(ray: &'a Ray) -> Self {
        const NEXT: [usize; 3] = [1, 2, 0];
        let (d, o, a) = (ray.direction.to_array(), ray.origin.to_array(), ray.direction.abs());
        let z = match a.x >= a.y {
            true => 2 * usize::from(!(a.x >= a.z)),
            false => 1 + usize::from(!(a.y >= a.z)),
        };
        let x = NEXT[z];
        let y = NEXT[x];
        let scale = 1.0 / d[z];
        Self {
            ray,
            rows: [x, y, z].map(|axis| axis * size_of::<Row>()),
            origin: [o[x], o[y], o[z]],
            shear: Vec2::new(d[x] * scale, d[y] * scale),
            scale,
        }
    }
}

impl TrianglePacket {
    /// A packet without triangles.
    pub const EMPTY: Self = Self { vertices: [[Row([f32::NAN; WIDTH]); 3]; 3], ids: [u32::MAX; WIDTH] };

    /// Puts a triangle into a lane.
    pub fn set(&mut self, lane: usize, triangle: [Vec3; 3], id: u32) {
        for (corner, rows) in triangle.iter().zip(&mut self.vertices) {
            for (x, row) in corner.to_array().iter().zip(rows) {
                row.0[lane] = *x;
            }
        }
        self.ids[lane] = id;
    }

    /// The triangle in a lane.
    #[inline(always)]
    pub fn triangle(&self, lane: usize) -> [Vec3; 3] {
        self.vertices.map(|rows| Vec3::from_array(rows.map(|row| row.0[lane])))
    }

    /// The vertices `corner` seen from the ray, sheared so that it is the z axis.
    #[inline(always)]
    fn sheared<L: Lanes>(&self, corner: usize, ray: &TriangleRay) -> (L, L, L) {
        let rows = self.vertices[corner].as_ptr();
        // SAFETY: `rows` holds the places of the rows 0, 1, 2.
        let [x, y, z] = ray.rows.map(|row| unsafe { &*rows.byte_add(row) });
        let z = L::load(z).sub(L::splat(ray.origin[2]));
        let x = L::load(x).sub(L::splat(ray.origin[0])).sub(L::splat(ray.shear.x).mul(z));
        let y = L::load(y).sub(L::splat(ray.origin[1])).sub(L::splat(ray.shear.y).mul(z));
        (x, y, z)
    }

    /// Tells `found` of every triangle that the ray meets in (0, t_max), in the order of the lanes; `found` gets the
    /// present `t_max` and answers with the new one. Returns the last one.
    #[inline(always)]
    pub fn meet<L: Lanes>(&self, ray: &TriangleRay, t_max: f32, mut found: impl FnMut(TriangleHit, f32) -> f32) -> f32 {
        let (ax, ay, az) = self.sheared::<L>(0, ray);
        let (bx, by, bz) = self.sheared::<L>(1, ray);
        let (cx, cy, cz) = self.sheared::<L>(2, ray);
        let u = cx.mul(by).sub(cy.mul(bx));
        let v = ax.mul(cy).sub(ay.mul(cx));
        let w = bx.mul(ay).sub(by.mul(ax));
        let zero = L::splat(0.0);
        let inside = zero.le(u.min(v).min(w)).or(u.max(v).max(w).le(zero));
        if inside.bits() == 0 {
            return t_max;
        }
        // The distance is depth / sum; with the sign of the sum in the depth it need not be divided to be compared.
        let scale = L::splat(ray.scale);
        let sum = u.add(v).add(w);
        let magnitude = sum.abs();
        let depth = u.mul(az).add(v.mul(bz)).add(w.mul(cz)).mul(scale);
        let depth = zero.sub(depth).select(sum.lt(zero), depth);
        // Rounded up, so that this drops nothing near t_max; it drops triangles without area, whose sum is zero.
        let near = inside.and(depth.lt(magnitude.mul(L::splat(t_max * (1.0 + 4.0 * f32::EPSILON)))));
        if near.bits() == 0 {
            return t_max;
        }
        // Bound of the error of the depth: a few units in the last place, of z and of the weights u, v, w.
        let size = ax.abs().max(bx.abs()).max(cx.abs()).max(ay.abs().max(by.abs()).max(cy.abs()));
        let reach = az.abs().max(bz.abs()).max(cz.abs()).mul(scale.abs());
        let ulps = L::splat(8.0 * f32::EPSILON);
        let error = reach.mul(ulps).mul(magnitude.add(size.mul(size)));
        let mut hits = near.and(zero.sub(error).le(depth)).bits();
        if hits == 0 {
            return t_max;
        }
        let mut t_max = t_max;
        let (depth, error, v, w, sum) = (depth.store().0, error.store().0, v.store().0, w.store().0, sum.store().0);
        while hits != 0 {
            let lane = hits.trailing_zeros() as usize & 7;
            hits &= hits - 1;
            // Where rounding could turn "just behind" into "just ahead", double precision decides.
            let t = match depth[lane] > error[lane] {
                true => depth[lane] / sum[lane].abs(),
                false => self.exact_distance(ray.ray, lane),
            };
            if t > 0.0 && t < t_max {
                let barycentrics = Vec2::new(v[lane] / sum[lane], w[lane] / sum[lane]);
                t_max = found(TriangleHit { t, lane, barycentrics }, t_max);
            }
        }
        t_max
    }

    /// Distance to the triangle's plane in double precision.
    #[inline(never)]
    fn exact_distance(&self, ray: &Ray, lane: usize) -> f32 {
        let [a, b, c] = self.triangle(lane).map(Vec3::as_dvec3);
        let normal = (b - a).cross(c - a);
        let o: DVec3 = ray.origin.as_dvec3();
        ((a - o).dot(normal) / ray.direction.as_dvec3().dot(normal)) as f32
    }
}

#[cfg(test)]
#[path = "triangle_tests.rs"]
mod tests;
