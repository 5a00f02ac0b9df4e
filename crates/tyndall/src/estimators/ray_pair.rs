//! Sampling of a point on each of two rays, for light that goes from one to the other (Novak et al. 2012a, section 4):
//! eight rays of light at once with a ray of the camera.

use super::equiangular::EquiangularLanes;
use crate::math::functions::{exp_minus_one, ln_quotient};
use crate::math::lanes::{Lanes, Row, WIDTH};
use crate::math::triples::{Lines, along, load, minus, splat};
use crate::math::{Ray, Vec3};

/// Eight rays.
#[derive(Clone, Copy, Debug)]
pub struct EightRays {
    /// Their starts: x, y, z, metres.
    pub(super) origin: [Row; 3],
    /// Unit directions: x, y, z.
    pub(super) direction: [Row; 3],
    /// Lengths, metres, positive and finite.
    pub(super) length: Row,
}

impl Default for EightRays {
    /// Rays that nothing is done with.
    fn default() -> Self {
        let [zero, one] = [0.0, 1.0].map(|x| Row([x; WIDTH]));
        Self { origin: [zero; 3], direction: [one, zero, zero], length: one }
    }
}

impl EightRays {
    /// The same ray in all lanes.
    pub fn all(ray: &Ray, length: f32) -> Self {
        let rows = |v: Vec3| v.to_array().map(|x| Row([x; WIDTH]));
        Self { origin: rows(ray.origin), direction: rows(ray.direction), length: Row([length; WIDTH]) }
    }

    /// Puts a ray of that length into a lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, ray: &Ray, length: f32) {
        let put = |rows: &mut [Row; 3], v: Vec3| {
            let [x, y, z] = rows;
            (x.0[lane & 7], y.0[lane & 7], z.0[lane & 7]) = (v.x, v.y, v.z);
        };
        put(&mut self.origin, ray.origin);
        put(&mut self.direction, ray.direction);
        self.length.0[lane & 7] = length;
    }
}

/// Pairs of distances, eight at once: `s` on a ray of light, `t` on the first `camera_length` metres of the camera's. The
/// density of `s` is proportional to the integral of 1/d^2 over the camera's whole line, d the distance between the points,
/// that of `t` given `s` to 1/d^2.
#[derive(Clone, Copy, Debug)]
pub(super) struct RayPair<L: Lanes> {
    pub(super) camera: [L; 3],
    camera_length: L,
    /// From the start of the camera's ray to that of light's.
    between: [L; 3],
    pub(super) light: [L; 3],
    light_length: L,
    /// Distance on light's ray where the lines are closest, metres.
    foot: L,
    /// Least distance of the lines over the sine between them, metres.
    width: L,
    /// The variable is `asinh` of the distance from the foot in widths, taken from the end nearer to the foot: its exponential
    /// at that end, and its range.
    start: L,
    range: L,
    /// Whether light's end is the nearer one.
    turned: L::Mask,
    /// Whether the lines are so nearly parallel that `s` is uniform.
    parallel: L::Mask,
    /// Added to distances, as a square root of the sum of squares, metres.
    radius: f32,
}

/// Lines whose squared sine is less count as parallel.
const PARALLEL: f32 = 1e-6;

impl<L: Lanes> RayPair<L> {
    /// `radius` bounds the density where the rays come close: 0 for none.
    #[inline(always)]
    pub(super) fn new(camera: &Ray, camera_length: f32, rays: &EightRays, radius: f32) -> Self {
        let (one, direction) = (L::splat(1.0), splat::<L>(camera.direction));
        let (light, length) = (load::<L>(&rays.direction), L::load(&rays.length));
        let between = minus(load(&rays.origin), splat(camera.origin));
        let Lines { s, sin2, across, .. } = Lines::new(direction, between, light);
        let parallel = sin2.lt(L::splat(PARALLEL));
        let sin2 = sin2.max(L::splat(PARALLEL));
        let apart = across.mul(across).div(sin2).add(L::splat(radius * radius));
        let width = apart.div(sin2).sqrt().max(L::splat(1e-6).mul(length));
        let foot = s.div(sin2);
        // Both ends, in widths from the foot; turned round when the far end is the one before the foot.
        let (first, last) = (L::splat(0.0).sub(foot).div(width), length.sub(foot).div(width));
        let turned = first.add(last).lt(L::splat(0.0));
        let [near, far] =
            [L::splat(0.0).sub(last).select(turned, first), L::splat(0.0).sub(first).select(turned, last)];
        let [near_root, far_root] = [near, far].map(|x| x.mul(x).add(one).sqrt());
        let start = one.div(near_root.sub(near)).select(near.lt(L::splat(0.0)), near_root.add(near));
        // The difference of exp(asinh) between the ends, without cancellation.
        let rise = length.div(width).mul(one.add(near.add(far).div(near_root.add(far_root))));
        let range = ln_quotient(rise, start);
        Self {
            camera: direction,
            camera_length: L::splat(camera_length),
            between,
            light,
            light_length: length,
            foot,
            width,
            start,
            range,
            turned,
            parallel,
            radius,
        }
    }

    /// The distances on light's rays for `u` in [0, 1).
    #[inline(always)]
    pub(super) fn on_light(&self, u: L) -> L {
        // From the nearer end: sinh(a + x) - sinh(a) by exponentials.
        let rise = exp_minus_one(u.mul(self.range));
        let grown = self.start.mul(rise.add(L::splat(1.0)));
        let away = self.width.mul(L::splat(0.5)).mul(rise).mul(self.start.add(L::splat(1.0).div(grown)));
        let s = self.light_length.sub(away).select(self.turned, away);
        let s = u.mul(self.light_length).select(self.parallel, s);
        s.max(L::splat(0.0)).min(self.light_length)
    }

    /// The `u` that give the distances `s` on light's rays.
    #[cfg(test)]
    #[inline(always)]
    pub(super) fn position_on_light(&self, s: L) -> L {
        let away = self.light_length.sub(s).select(self.turned, s);
        let near = self.start.sub(L::splat(1.0).div(self.start)).mul(L::splat(0.5));
        let at = near.add(away.div(self.width));
        let root = at.mul(at).add(L::splat(1.0)).sqrt();
        let near_root = near.mul(near).add(L::splat(1.0)).sqrt();
        let rise = at.sub(near).mul(L::splat(1.0).add(near.add(at).div(near_root.add(root))));
        let u = ln_quotient(rise.max(L::splat(0.0)), self.start).div(self.range);
        s.div(self.light_length).select(self.parallel, u).min(L::splat(1.0))
    }

    /// Distances on the camera's ray, seen from the distances `s` on light's, and the way from their feet to there.
    #[inline(always)]
    pub(super) fn across(&self, s: L) -> (EquiangularLanes<L>, [L; 3]) {
        EquiangularLanes::new(self.camera, self.camera_length, along(self.between, s, self.light), self.radius)
    }

    /// Density of the distances `s` on light's rays, 1/m.
    #[inline(always)]
    pub(super) fn density_on_light(&self, s: L) -> L {
        let off = s.sub(self.foot);
        let hypotenuse = self.width.mul(self.width).add(off.mul(off)).sqrt();
        let reach = self.light_length.select(self.parallel, self.range.mul(hypotenuse));
        L::splat(1.0).div(reach)
    }
}
