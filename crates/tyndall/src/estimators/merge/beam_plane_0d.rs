//! **Meets.** A camera's ray and a photon plane that it crosses.
//!
//! **Formula.** `L = 1/N sum Phi [sigma_s A0(s)](x_a) [sigma_s A1(q)](x_b) f Tr(t) V(x_a, x_b) / |w0 . (w1 x d)|`: light runs `s`
//! along `w0` to the bend `x_a`, then `q` along `w1` to the ray.
//!
//! **Measure and Jacobian.** None is left; the triple product is that of `(s, q, t)` to volume.
//!
//! **Residual.** 0.
//!
//! **Extent.** The first edge up to its flight's end, the second to an exponential distance that ignores geometry. Sweeping
//! `s` moves the second edge, so what lies between bend and ray is looked through for every meeting.
//!
//! **Bias.** None where both edges and the ray lie in one medium; light that crosses an index-matched boundary into another
//! medium after the bend is lost. The inverse triple product has no variance: rare bright dots where ray and plane are nearly parallel.
//!
//! **Reference.** Bitterli and Jarosz 2017, eq. 13.

use super::{BeamProbe, Meet, Merge, cross, dot, load, minus, splat};
use crate::math::Rng;
use crate::math::lanes::{Lanes, Mask};
use crate::photons::{PlaneBlock, Planes, Store};

/// Whether `0 <= x < length`, where `x` was multiplied by `square`.
#[inline(always)]
fn inside<L: Lanes>(x: L, length: L, square: L) -> L::Mask {
    L::splat(0.0).le(x).and(x.lt(length.mul(square)))
}

/// Beam query, photon planes, no blur.
#[derive(Clone, Copy, Debug)]
pub struct BeamPlane0D;

impl Merge for BeamPlane0D {
    type Probe = BeamProbe;
    type Store = Planes;
    const BLUR: u32 = 0;
    const SHADOWED: bool = true;

    #[inline(always)]
    fn touches<L: Lanes>(&self, probe: &BeamProbe, block: &PlaneBlock) -> u32 {
        // origin + s w0 + q w1 = o + t d by Cramer's rule, all multiplied by the square of the determinant.
        let d = splat::<L>(probe.ray.direction);
        let (w0, w1) = (load::<L>(&block.first), load::<L>(&block.second));
        let v = minus(splat(probe.ray.origin), load(&block.origin));
        let p = cross(w1, d);
        let determinant = dot(w0, p);
        let square = determinant.mul(determinant);
        let s = dot(v, p).mul(determinant);
        let r = cross(w0, v);
        let q = dot(d, r).mul(determinant);
        let t = dot(w1, r).mul(determinant);
        let [first, second] = &block.lengths;
        let on_plane = inside(s, L::load(first), square).and(inside(q, L::load(second), square));
        on_plane.and(inside(t, L::splat(probe.length), square)).bits()
    }

    #[inline(always)]
    fn meet(&self, probe: &BeamProbe, store: &Planes, leaf: u32, lane: usize, _rng: &mut Rng) -> Option<Meet> {
        let (origin, [w0, w1]) = store.block(leaf).plane(lane);
        let d = probe.ray.direction;
        let v = probe.ray.origin - origin;
        let p = w1.cross(d);
        let determinant = w0.dot(p);
        let r = w0.cross(v);
        let weight = 1.0 / determinant.abs();
        let [s, q, t] = [v.dot(p), d.dot(r), w1.dot(r)].map(|x| x / determinant);
        weight.is_finite().then_some(Meet { t, s: [s, q], weight })
    }
}
