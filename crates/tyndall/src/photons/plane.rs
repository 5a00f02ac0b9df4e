//! Photon planes: what two consecutive edges of a light path sweep when their lengths vary (Bitterli and Jarosz 2017).

use super::arranged::Arranged;
use super::{Arriving, Attenuation, Flux, Store, Tag};
use crate::Spectrum;
use crate::accel::Bvh;
use crate::math::lanes::{Row, WIDTH};
use crate::math::{Aabb, Ray, Vec3};
use crate::scene::medium::Medium;

/// The parallelogram `origin + s w0 + q w1`. Light runs along `w0`, is scattered after `s` metres and runs along `w1`.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    /// Start of the first edge, metres.
    pub origin: Vec3,
    /// Unit directions of the edges.
    pub directions: [Vec3; 2],
    /// Lengths of the edges, metres, finite.
    pub lengths: [f32; 2],
    /// Flux at the start times the number of light paths, over the density of `w1`; watts steradians.
    pub flux: Flux,
    /// What becomes of the flux on the first edge.
    pub attenuation: Attenuation,
    /// Rate at which the second edge ends, 1/m: it is longer than `q` with probability `exp(-rate q)`.
    pub end_rate: f32,
    /// The medium and the scatterings of the light that arrives at the second edge's end: the bend is one of them.
    pub tag: Tag,
}

/// Eight planes; lanes without one have lengths of zero.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct PlaneBlock {
    /// The corner where both edges start.
    pub origin: [Row; 3],
    /// Unit direction of the first edge.
    pub first: [Row; 3],
    /// Unit direction of the second edge.
    pub second: [Row; 3],
    /// Lengths of the edges, metres.
    pub lengths: [Row; 2],
}

impl PlaneBlock {
    const EMPTY: Self = Self {
        origin: [Row([0.0; WIDTH]); 3],
        first: [Row([0.0; WIDTH]); 3],
        second: [Row([0.0; WIDTH]); 3],
        lengths: [Row([0.0; WIDTH]); 2],
    };

    #[inline(always)]
    fn take([x, y, z]: &[Row; 3], lane: usize) -> Vec3 {
        Vec3::new(x.0[lane & 7], y.0[lane & 7], z.0[lane & 7])
    }

    /// Corner and edge directions of the plane in a lane.
    #[inline(always)]
    pub fn plane(&self, lane: usize) -> (Vec3, [Vec3; 2]) {
        (Self::take(&self.origin, lane), [Self::take(&self.first, lane), Self::take(&self.second, lane)])
    }
}

#[derive(Clone, Copy, Debug)]
struct Payload {
    flux: Flux,
    attenuation: Attenuation,
    end_rate: f32,
    tag: Tag,
}

/// Planes, indexed.
#[derive(Debug, Default)]
pub struct Planes(Arranged<PlaneBlock, Payload>);

impl Planes {
    /// Arranges the planes. Memory is re-used. The result does not depend on the number of threads.
    pub fn rebuild(&mut self, planes: &[Plane]) {
        self.0.rebuild(
            planes.len(),
            PlaneBlock::EMPTY,
            |i| {
                let Plane { origin, directions, lengths, .. } = planes[i];
                let [a, b] = [0, 1].map(|edge| directions[edge] * lengths[edge]);
                Aabb::from_points([origin, origin + a, origin + b, origin + a + b])
            },
            |i| {
                let Plane { flux, attenuation, end_rate, tag, .. } = planes[i];
                Payload { flux, attenuation, end_rate, tag }
            },
            |block, lane, i| {
                let plane = &planes[i];
                for axis in 0..3 {
                    block.origin[axis].0[lane] = plane.origin[axis];
                    block.first[axis].0[lane] = plane.directions[0][axis];
                    block.second[axis].0[lane] = plane.directions[1][axis];
                }
                for edge in 0..2 {
                    block.lengths[edge].0[lane] = plane.lengths[edge];
                }
            },
        );
    }

    /// How many planes there are.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Memory held, bytes.
    pub fn memory_bytes(&self) -> usize {
        self.0.memory_bytes()
    }
}

impl Store for Planes {
    const DIMENSION: u32 = 2;
    type Block = PlaneBlock;

    #[inline(always)]
    fn bvh(&self) -> &Bvh {
        &self.0.bvh
    }

    #[inline(always)]
    fn block(&self, leaf: u32) -> &PlaneBlock {
        &self.0.blocks[leaf as usize]
    }

    #[inline(always)]
    fn index(&self, leaf: u32, lane: usize) -> u32 {
        self.0.index(leaf, lane)
    }

    #[inline(always)]
    fn tag(&self, leaf: u32, lane: usize) -> Tag {
        self.0.payload(leaf, lane).tag
    }

    /// Transmittance of the second edge not included: it depends on what stands in the way.
    #[inline]
    fn arriving(&self, leaf: u32, lane: usize, [s, q]: [f32; 2], x: Vec3, medium: Option<&Medium>) -> Arriving {
        let payload = self.0.payload(leaf, lane);
        let (origin, [w0, w1]) = self.block(leaf).plane(lane);
        let Some(medium) = medium else { return Arriving { direction: w1, flux: Spectrum::ZERO } };
        let first = Ray { origin, direction: w0 };
        let bend = first.at(s);
        let phase = medium.phase();
        let start = payload.flux.unpack();
        let bent = medium.sigma_s(bend) * (phase.extinction_factor(bend, w0) * phase.eval(bend, w0, w1));
        let seen = medium.sigma_s(x) * phase.extinction_factor(x, w1);
        let flux =
            start * payload.attenuation.at(s, start, &first, medium) * bent * seen * (payload.end_rate * q).exp();
        Arriving { direction: w1, flux }
    }
}
