//! **Meets.** A point on a surface and a photon that arrived on the surface less than the photon's radius away.
//!
//! **Formula.** `L = 1/N sum f_r Phi K2(|x - x_p|)`, `Phi` the flux that arrives.
//!
//! **Measure and Jacobian.** Area of the surface; none. The density of photons already contains their cosine.
//!
//! **Residual.** 0, on surfaces.
//!
//! **Extent.** None.
//!
//! **Bias.** `m r^2 / 2` times the Laplacian on the surface; loss within `r` of edges; photons of other surfaces nearby
//! count unless they lie more than three tenths of the radius above or below the tangent plane.
//!
//! **Reference.** Jensen 1996; Jensen 2001, eq. 7.6.

use super::{Meet, Merge, SurfaceProbe, dot, load, minus, splat};
use crate::math::Rng;
use crate::math::kernels::Kernel;
use crate::math::lanes::{Lanes, Mask};
use crate::photons::{PointBlock, Points, Store};

/// Photons farther above or below the tangent plane, in units of the radius, belong to another surface. A ball is flat enough
/// up to six tenths of its own radius.
const FLATNESS: f32 = 0.3;

/// Query on a surface, photon points, blur over a disc on the surface.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint2D {
    /// Shape of the blur.
    pub kernel: Kernel,
}

impl Merge for SurfacePoint2D {
    type Probe = SurfaceProbe;
    type Store = Points;
    const BLUR: u32 = 2;

    #[inline(always)]
    fn touches<L: Lanes>(&self, probe: &SurfaceProbe, block: &PointBlock) -> u32 {
        let offset = minus(load::<L>(&block.position), splat(probe.position));
        let radius = L::load(&block.radius);
        let near = dot(offset, offset).lt(radius.mul(radius.abs()));
        let above = dot(offset, splat(probe.normal)).abs();
        near.and(above.le(radius.mul(L::splat(FLATNESS)))).bits()
    }

    #[inline(always)]
    fn meet(&self, probe: &SurfaceProbe, store: &Points, leaf: u32, lane: usize, _rng: &mut Rng) -> Option<Meet> {
        let block = store.block(leaf);
        let radius = block.radius.0[lane];
        let squared = (block.position(lane) - probe.position).length_squared() / (radius * radius);
        Some(Meet { t: 0.0, s: [0.0; 2], weight: self.kernel.value::<2>(squared, radius) })
    }
}
