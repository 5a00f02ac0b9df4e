//! Data arranged by a hierarchy: rows of eight for tests, the rest apart.

use crate::accel::{Bvh, CurveBuilder};
use crate::math::Aabb;
use rayon::prelude::*;

/// Blocks of eight by leaf, and payloads in the order of the leaves' items.
#[derive(Debug)]
pub(super) struct Arranged<B, P> {
    pub(super) bvh: Bvh,
    pub(super) blocks: Vec<B>,
    payloads: Vec<P>,
    builder: CurveBuilder,
}

impl<B, P> Default for Arranged<B, P> {
    fn default() -> Self {
        Self { bvh: Bvh::default(), blocks: Vec::new(), payloads: Vec::new(), builder: CurveBuilder::default() }
    }
}

impl<B: Copy + Send + Sync, P: Send> Arranged<B, P> {
    /// Arranges `count` items by their bounds: each gives its payload and fills a lane of a block that starts as `empty`.
    /// Memory is re-used. The result does not depend on the number of threads.
    pub(super) fn rebuild(
        &mut self,
        count: usize,
        empty: B,
        bounds: impl Fn(usize) -> Aabb + Sync,
        payload: impl Fn(usize) -> P + Sync,
        fill: impl Fn(&mut B, usize, usize) + Sync,
    ) {
        self.builder.rebuild(&mut self.bvh, count, bounds);
        let order = self.bvh.order();
        self.payloads.clear();
        self.payloads.par_extend(order.par_iter().map(|&i| payload(i as usize)));
        self.blocks.clear();
        self.blocks.par_extend((0..self.bvh.leaf_count()).into_par_iter().map(|leaf| {
            let mut block = empty;
            for (lane, at) in self.bvh.leaf(leaf as u32).enumerate() {
                fill(&mut block, lane, order[at] as usize);
            }
            block
        }));
    }

    /// Arranges the items of `other` as they are there, in `changed` blocks with `bounds`. Memory is re-used.
    pub(super) fn rebuild_like(
        &mut self,
        other: &Self,
        changed: impl Fn(&B) -> B + Send + Sync,
        bounds: impl Fn(&B) -> Aabb + Sync,
    ) where
        P: Clone,
    {
        self.payloads.clone_from(&other.payloads);
        self.blocks.clear();
        self.blocks.par_extend(other.blocks.par_iter().map(changed));
        let blocks = &self.blocks;
        self.builder.rebuild_like(&mut self.bvh, &other.bvh, |leaf| bounds(&blocks[leaf]));
    }

    #[inline(always)]
    pub(super) fn payload(&self, leaf: u32, lane: usize) -> &P {
        &self.payloads[self.bvh.leaf(leaf).start + lane]
    }

    #[inline(always)]
    pub(super) fn index(&self, leaf: u32, lane: usize) -> u32 {
        self.bvh.order()[self.bvh.leaf(leaf).start + lane]
    }

    pub(super) fn len(&self) -> usize {
        self.payloads.len()
    }

    /// Memory held, bytes.
    pub(super) fn memory_bytes(&self) -> usize {
        self.bvh.memory_bytes()
            + self.builder.memory_bytes()
            + self.blocks.capacity() * size_of::<B>()
            + self.payloads.capacity() * size_of::<P>()
    }
}
