//! **Meets.** A camera's ray and a photon point less than the photon's radius away from it; each photon at its foot on the
//! ray.
//!
//! **Formula.** `L = 1/N sum Tr(t_p) f Phi K2(|x_p - x(t_p)|)`, `t_p` the foot, `Phi` the flux that leaves the collision.
//!
//! **Measure and Jacobian.** Area at right angles to the ray; none.
//!
//! **Residual.** 0.
//!
//! **Extent.** The whole ray, with its transmittance.
//!
//! **Bias.** `m r^2 / 2` times the Laplacian across the ray.
//!
//! **Reference.** Jarosz, Zwicker and Jensen 2008, eq. 14; Jarosz et al. 2011, table 1.

use super::{BeamProbe, Meet, Merge, feet, load, minus, splat};
use crate::math::Rng;
use crate::math::kernels::Kernel;
use crate::math::lanes::{Lanes, Mask};
use crate::photons::{PointBlock, Points, Store};

/// Beam query, photon points, blur over a disc across the ray: the beam radiance estimate.
#[derive(Clone, Copy, Debug)]
pub struct BeamPoint2D {
    /// Shape of the blur.
    pub kernel: Kernel,
}

impl Merge for BeamPoint2D {
    type Probe = BeamProbe;
    type Store = Points;
    const BLUR: u32 = 2;

    #[inline(always)]
    fn touches<L: Lanes>(&self, probe: &BeamProbe, block: &PointBlock) -> u32 {
        let direction = splat::<L>(probe.ray.direction);
        let offset = minus(load::<L>(&block.position), splat(probe.ray.origin));
        let radius = L::load(&block.radius);
        let (t, near) = feet(offset, direction, radius);
        near.and(L::splat(0.0).le(t)).and(t.lt(L::splat(probe.length))).bits()
    }

    #[inline(always)]
    fn meet(&self, probe: &BeamProbe, store: &Points, leaf: u32, lane: usize, _rng: &mut Rng) -> Option<Meet> {
        let block = store.block(leaf);
        let offset = block.position(lane) - probe.ray.origin;
        let t = offset.dot(probe.ray.direction);
        let radius = block.radius.0[lane];
        let squared = (offset - t * probe.ray.direction).length_squared() / (radius * radius);
        Some(Meet { t, s: [0.0; 2], weight: self.kernel.value::<2>(squared, radius) })
    }
}
