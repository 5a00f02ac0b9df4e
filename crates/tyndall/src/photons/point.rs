//! Photon points.

use super::{Arriving, Flux, Store, Tag};
use crate::accel::{Bvh, CurveBuilder};
use crate::math::lanes::{Row, WIDTH};
use crate::math::octahedral::Octahedral;
use crate::math::{Aabb, Vec3};
use crate::scene::medium::Medium;
use rayon::prelude::*;

/// A vertex of a light path. Its flux is what *leaves* the collision in a medium (watts, the albedo applied), and what
/// *arrives* on a surface.
#[derive(Clone, Copy, Debug)]
pub struct Photon {
    /// Position, metres.
    pub position: Vec3,
    /// Radius of its blur, metres.
    pub radius: f32,
    /// Flux, watts times the number of light paths.
    pub flux: Flux,
    /// Direction of travel on arrival.
    pub direction: Octahedral,
    /// Where it is and how it came.
    pub tag: Tag,
}

/// Eight photons; lanes without one have a negative radius.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct PointBlock {
    /// x, y, z, metres.
    pub position: [Row; 3],
    /// Radius of the blur, metres.
    pub radius: Row,
}

impl PointBlock {
    const EMPTY: Self = Self { position: [Row([0.0; WIDTH]); 3], radius: Row([-1.0; WIDTH]) };

    /// The photon's position in a lane.
    #[inline(always)]
    pub fn position(&self, lane: usize) -> Vec3 {
        let [x, y, z] = &self.position;
        Vec3::new(x.0[lane & 7], y.0[lane & 7], z.0[lane & 7])
    }
}

#[derive(Clone, Copy, Debug)]
struct Payload {
    flux: Flux,
    direction: Octahedral,
    tag: Tag,
}

/// Photons around which a query may lie within their radius.
#[derive(Debug, Default)]
pub struct Points {
    bvh: Bvh,
    blocks: Vec<PointBlock>,
    payloads: Vec<Payload>,
    builder: CurveBuilder,
}

impl Points {
    /// Bytes held for each photon, the hierarchy's nodes apart.
    pub const BYTES: usize = size_of::<PointBlock>() / WIDTH + size_of::<Payload>();

    /// Arranges the photons. Memory is re-used. The result does not depend on the number of threads.
    pub fn rebuild(&mut self, photons: &[Photon]) {
        self.builder.rebuild(&mut self.bvh, photons.len(), |i| {
            let Photon { position, radius, .. } = photons[i];
            Aabb { min: position - radius, max: position + radius }
        });
        let order = self.bvh.order();
        self.payloads.clear();
        self.payloads.par_extend(order.par_iter().map(|&i| {
            let Photon { flux, direction, tag, .. } = photons[i as usize];
            Payload { flux, direction, tag }
        }));
        self.blocks.clear();
        self.blocks.par_extend((0..self.bvh.leaf_count()).into_par_iter().map(|leaf| {
            let mut block = PointBlock::EMPTY;
            for (lane, at) in self.bvh.leaf(leaf as u32).enumerate() {
                let photon = &photons[order[at] as usize];
                for (row, x) in block.position.iter_mut().zip(photon.position.to_array()) {
                    row.0[lane] = x;
                }
                block.radius.0[lane] = photon.radius;
            }
            block
        }));
    }

    /// How many photons there are.
    pub fn len(&self) -> usize {
        self.payloads.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.payloads.is_empty()
    }

    /// Memory held, bytes.
    pub fn memory_bytes(&self) -> usize {
        self.bvh.memory_bytes()
            + self.blocks.capacity() * size_of::<PointBlock>()
            + self.payloads.capacity() * size_of::<Payload>()
            + self.builder.memory_bytes()
    }

    #[inline(always)]
    fn payload(&self, leaf: u32, lane: usize) -> &Payload {
        &self.payloads[self.bvh.leaf(leaf).start + lane]
    }
}

impl Store for Points {
    const DIMENSION: u32 = 0;
    type Block = PointBlock;

    #[inline(always)]
    fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    #[inline(always)]
    fn block(&self, leaf: u32) -> &PointBlock {
        &self.blocks[leaf as usize]
    }

    #[inline(always)]
    fn tag(&self, leaf: u32, lane: usize) -> Tag {
        self.payload(leaf, lane).tag
    }

    #[inline(always)]
    fn arriving(&self, leaf: u32, lane: usize, _s: [f32; 2], _x: Vec3, _medium: Option<&Medium>) -> Arriving {
        let payload = self.payload(leaf, lane);
        Arriving { direction: payload.direction.unpack(), flux: payload.flux.unpack() }
    }
}
