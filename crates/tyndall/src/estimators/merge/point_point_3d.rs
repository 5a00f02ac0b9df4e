//! **Meets.** A point of the camera's ray and a photon point less than the photon's radius away.
//!
//! **Formula.** `sigma_s L_s = 1/N sum f Phi K3(|x - x_p|)`, `Phi` the flux that leaves the collision.
//!
//! **Measure and Jacobian.** Volume; none.
//!
//! **Residual.** 0. The integral along the ray is the query's: it marches.
//!
//! **Extent.** None.
//!
//! **Bias.** `m r^2 / 2` times the Laplacian; loss within `r` of a boundary.
//!
//! **Reference.** Jensen and Christensen 1998, eq. 8; Jarosz et al. 2011, table 1.

use super::{Meet, Merge, PointProbe, dot, load, minus, splat};
use crate::math::Rng;
use crate::math::kernels::Kernel;
use crate::math::lanes::{Lanes, Mask};
use crate::photons::{PointBlock, Points, Store};

/// Point query, photon points, blur over a ball.
#[derive(Clone, Copy, Debug)]
pub struct PointPoint3D {
    /// Shape of the blur.
    pub kernel: Kernel,
}

impl Merge for PointPoint3D {
    type Probe = PointProbe;
    type Store = Points;
    const BLUR: u32 = 3;

    #[inline(always)]
    fn touches<L: Lanes>(&self, probe: &PointProbe, block: &PointBlock) -> u32 {
        let offset = minus(load::<L>(&block.position), splat(probe.position));
        let radius = L::load(&block.radius);
        // A negative radius stays below every distance.
        dot(offset, offset).lt(radius.mul(radius.abs())).bits()
    }

    #[inline(always)]
    fn meet(&self, probe: &PointProbe, store: &Points, leaf: u32, lane: usize, _rng: &mut Rng) -> Option<Meet> {
        let block = store.block(leaf);
        let radius = block.radius.0[lane];
        let squared = (block.position(lane) - probe.position).length_squared() / (radius * radius);
        let weight = self.kernel.value::<3>(squared, radius);
        Some(Meet { t: 0.0, s: [0.0; 2], weight })
    }
}
