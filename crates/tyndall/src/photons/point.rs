//! Photon points.

use super::arranged::Arranged;
use super::{Arriving, Flux, Store, Tag};
use crate::accel::Bvh;
use crate::math::lanes::{Row, WIDTH};
use crate::math::octahedral::Octahedral;
use crate::math::{Aabb, Vec3};
use crate::scene::medium::Medium;

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

    /// Lanes with a photon.
    fn filled(&self) -> impl Iterator<Item = usize> + '_ {
        (0..WIDTH).filter(|lane| self.radius.0[*lane] >= 0.0)
    }

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
pub struct Points(Arranged<PointBlock, Payload>);

impl Points {
    /// Bytes held for each photon, the hierarchy's nodes apart.
    pub const BYTES: usize = size_of::<PointBlock>() / WIDTH + size_of::<Payload>();

    /// Arranges the photons. Memory is re-used. The result does not depend on the number of threads.
    pub fn rebuild(&mut self, photons: &[Photon]) {
        self.0.rebuild(
            photons.len(),
            PointBlock::EMPTY,
            |i| {
                let Photon { position, radius, .. } = photons[i];
                Aabb { min: position - radius, max: position + radius }
            },
            |i| {
                let Photon { flux, direction, tag, .. } = photons[i];
                Payload { flux, direction, tag }
            },
            |block, lane, i| {
                for (row, x) in block.position.iter_mut().zip(photons[i].position.to_array()) {
                    row.0[lane] = x;
                }
                block.radius.0[lane] = photons[i].radius;
            },
        );
    }

    /// Arranges the photons of `other` with radii of their own, as a function of the position. Memory is re-used.
    pub fn rebuild_with_radii(&mut self, other: &Self, radius: impl Fn(Vec3) -> f32 + Sync) {
        self.0.rebuild_like(
            &other.0,
            |block| {
                let mut changed = *block;
                for lane in block.filled() {
                    changed.radius.0[lane] = radius(block.position(lane));
                }
                changed
            },
            |block| {
                block.filled().fold(Aabb::EMPTY, |all, lane| {
                    let (x, radius) = (block.position(lane), block.radius.0[lane]);
                    all.union(Aabb { min: x - radius, max: x + radius })
                })
            },
        );
    }

    /// How many photons there are.
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

impl Store for Points {
    const DIMENSION: u32 = 0;
    type Block = PointBlock;

    #[inline(always)]
    fn bvh(&self) -> &Bvh {
        &self.0.bvh
    }

    #[inline(always)]
    fn block(&self, leaf: u32) -> &PointBlock {
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

    #[inline(always)]
    fn arriving(&self, leaf: u32, lane: usize, _s: [f32; 2], _x: Vec3, _medium: Option<&Medium>) -> Arriving {
        let payload = self.0.payload(leaf, lane);
        Arriving { direction: payload.direction.unpack(), flux: payload.flux.unpack() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Rng, warp};

    #[test]
    fn the_same_photons_with_other_radii() {
        let photons: Vec<Photon> = (0..1003)
            .map(|i| {
                let mut rng = Rng::keyed(1, 2, i);
                let position = Vec3::new(rng.f32(), rng.f32(), rng.f32());
                let direction = Octahedral::new(warp::square_to_sphere(rng.vec2()));
                let flux = Flux::new(crate::Spectrum::ONE);
                Photon {
                    position,
                    radius: 0.01,
                    flux,
                    direction,
                    tag: Tag::new(None, 0, crate::photons::Origin::Direct),
                }
            })
            .collect();
        let [mut points, mut other] = [Points::default(), Points::default()];
        points.rebuild(&photons);
        other.rebuild_with_radii(&points, |x| 0.3 * x.x);
        assert_eq!(other.len(), photons.len());
        let mut bounds = Aabb::EMPTY;
        for leaf in 0..other.bvh().leaf_count() as u32 {
            let block = other.block(leaf);
            for lane in 0..WIDTH {
                if points.block(leaf).radius.0[lane] < 0.0 {
                    assert!(block.radius.0[lane] < 0.0, "nothing is there");
                    continue;
                }
                let photon = &photons[other.index(leaf, lane) as usize];
                let (x, radius) = (block.position(lane), block.radius.0[lane]);
                assert_eq!((x, radius), (photon.position, 0.3 * photon.position.x));
                bounds = bounds.union(Aabb { min: x - radius, max: x + radius });
            }
        }
        assert_eq!(other.bvh().bounds(), bounds);
    }
}
