//! Photon beams.

use super::{Arriving, Flux, Store, Tag};
use crate::Spectrum;
use crate::accel::{Bvh, CurveBuilder};
use crate::math::lanes::{Row, WIDTH};
use crate::math::{Aabb, Ray, Vec3};
use crate::scene::Scene;
use crate::scene::medium::{Extinction, Medium};
use crate::walk::flight::Uniform;
use crate::walk::{Scattering, Vertex};
use rayon::prelude::*;

/// How the flux of a beam changes along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Attenuation {
    /// `exp(-rate s)`, rate in 1/m; zero for beams that end where their flight ended.
    Rate(f32),
    /// The transmittance of the homogeneous medium.
    Transmittance,
    /// That, divided by the probability that a flight gets so far.
    Survivors,
}

/// A straight piece of a light path inside one medium.
#[derive(Clone, Copy, Debug)]
pub struct Beam {
    /// Start, metres.
    pub origin: Vec3,
    /// Unit direction of travel.
    pub direction: Vec3,
    /// Length, metres, finite.
    pub length: f32,
    /// Flux at the start, before any attenuation, watts times the number of light paths.
    pub flux: Flux,
    /// What becomes of the flux.
    pub attenuation: Attenuation,
    /// Where it is and how it came.
    pub tag: Tag,
    /// Its footprint.
    pub width: Width,
}

/// The footprint of a beam: two vectors across it, each linear in the distance (Igehy 1999).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Width {
    /// The vectors at the start, metres.
    pub start: [Vec3; 2],
    /// Their change along the beam.
    pub slope: [Vec3; 2],
}

impl Width {
    /// The same footprint, told from `s` metres farther on.
    pub fn from(mut self, s: f32) -> Self {
        for (start, slope) in self.start.iter_mut().zip(self.slope) {
            *start += s * slope;
        }
        self
    }

    /// Half the extent along the unit vector `across` of the ellipse that the vectors span at distance `s`, metres.
    #[inline]
    pub fn along(&self, s: f32, across: Vec3) -> f32 {
        let [u, v] = [0, 1].map(|i| (self.start[i] + s * self.slope[i]).dot(across));
        (u * u + v * v).sqrt()
    }

    /// Upper bound of [`Width::along`] at distance `s` over all directions, metres.
    #[inline]
    pub fn largest(&self, s: f32) -> f32 {
        let [u, v] = [0, 1].map(|i| (self.start[i] + s * self.slope[i]).length_squared());
        (u + v).sqrt()
    }
}

/// How wide beams are blurred.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BeamRadius {
    /// All alike, metres.
    Fixed(f32),
    /// By their footprints times `factor`, but no less than `least` and no more than `most` metres.
    Footprint {
        /// Overlap of neighbours; 1 makes footprints touch.
        factor: f32,
        /// Lower bound, metres.
        least: f32,
        /// Upper bound, metres.
        most: f32,
    },
}

/// Eight pieces of beams; lanes without one have a negative radius.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct BeamBlock {
    /// Start of the whole beam: x, y, z, metres.
    pub origin: [Row; 3],
    /// Unit direction: x, y, z.
    pub direction: [Row; 3],
    /// Distance along the beam where the piece begins, metres; it belongs to the piece.
    pub s0: Row,
    /// Distance where it ends; it does not belong to the piece.
    pub s1: Row,
    /// Largest radius of the blur anywhere on the piece, metres.
    pub radius: Row,
    /// The beam.
    pub beam: [u32; WIDTH],
}

impl BeamBlock {
    const EMPTY: Self = Self {
        origin: [Row([0.0; WIDTH]); 3],
        direction: [Row([1.0; WIDTH]), Row([0.0; WIDTH]), Row([0.0; WIDTH])],
        s0: Row([0.0; WIDTH]),
        s1: Row([0.0; WIDTH]),
        radius: Row([-1.0; WIDTH]),
        beam: [0; WIDTH],
    };

    /// Start and direction of the beam in a lane.
    #[inline(always)]
    pub fn ray(&self, lane: usize) -> Ray {
        let take = |[x, y, z]: &[Row; 3]| Vec3::new(x.0[lane & 7], y.0[lane & 7], z.0[lane & 7]);
        Ray { origin: take(&self.origin), direction: take(&self.direction) }
    }
}

/// What a hit needs to know of a beam.
#[derive(Clone, Copy, Debug)]
struct Payload {
    flux: Flux,
    attenuation: Attenuation,
    tag: Tag,
}

/// Beams in pieces short enough for tight boxes.
#[derive(Debug)]
pub struct Beams {
    bvh: Bvh,
    blocks: Vec<BeamBlock>,
    payloads: Vec<Payload>,
    widths: Vec<Width>,
    pieces: Vec<Piece>,
    builder: CurveBuilder,
    radius: BeamRadius,
}

#[derive(Clone, Copy, Debug)]
struct Piece {
    beam: u32,
    s0: f32,
    s1: f32,
    radius: f32,
}

/// Most pieces of one beam.
const MAX_PIECES: f32 = 64.0;

impl Default for Beams {
    fn default() -> Self {
        Self {
            bvh: Bvh::default(),
            blocks: Vec::new(),
            payloads: Vec::new(),
            widths: Vec::new(),
            pieces: Vec::new(),
            builder: CurveBuilder::default(),
            radius: BeamRadius::Fixed(0.0),
        }
    }
}

impl Beams {
    /// Arranges the beams, blurred by `radius`. Memory is re-used. The result does not depend on the number of threads.
    pub fn rebuild(&mut self, beams: &[Beam], radius: BeamRadius) {
        self.radius = radius;
        self.payloads.clear();
        self.payloads.par_extend(beams.par_iter().map(|&Beam { flux, attenuation, tag, .. }| Payload {
            flux,
            attenuation,
            tag,
        }));
        self.widths.clear();
        if let BeamRadius::Footprint { .. } = radius {
            self.widths.extend(beams.iter().map(|b| b.width));
        }
        self.cut(beams);
        self.builder.rebuild(&mut self.bvh, self.pieces.len(), |i| {
            let Piece { beam, s0, s1, radius } = self.pieces[i];
            let Beam { origin, direction, .. } = beams[beam as usize];
            let bounds = Aabb::from_points([origin + s0 * direction, origin + s1 * direction]);
            Aabb { min: bounds.min - radius, max: bounds.max + radius }
        });
        let order = self.bvh.order();
        self.blocks.clear();
        self.blocks.par_extend((0..self.bvh.leaf_count()).into_par_iter().map(|leaf| {
            let mut block = BeamBlock::EMPTY;
            for (lane, at) in self.bvh.leaf(leaf as u32).enumerate() {
                let piece = &self.pieces[order[at] as usize];
                let beam = &beams[piece.beam as usize];
                for axis in 0..3 {
                    block.origin[axis].0[lane] = beam.origin[axis];
                    block.direction[axis].0[lane] = beam.direction[axis];
                }
                block.s0.0[lane] = piece.s0;
                block.s1.0[lane] = piece.s1;
                block.radius.0[lane] = piece.radius;
                block.beam[lane] = piece.beam;
            }
            block
        }));
    }

    /// Cuts the beams into pieces about a third of the mean length long, but not below twice their width.
    fn cut(&mut self, beams: &[Beam]) {
        let total: f64 = beams.iter().map(|b| f64::from(b.length)).sum();
        let usual = (total / beams.len().max(1) as f64) as f32 / 3.0;
        self.pieces.clear();
        for (index, beam) in (0..).zip(beams) {
            let widest = self.radius.largest(&beam.width, 0.0, beam.length);
            let pieces = (beam.length / usual.max(4.0 * widest)).ceil().clamp(1.0, MAX_PIECES);
            let step = beam.length / pieces;
            for i in 0..pieces as u32 {
                let s0 = step * i as f32;
                let s1 = if i + 1 == pieces as u32 { beam.length } else { step * (i + 1) as f32 };
                let radius = self.radius.largest(&beam.width, s0, s1);
                self.pieces.push(Piece { beam: index, s0, s1, radius });
            }
        }
    }

    /// How many beams there are.
    pub fn len(&self) -> usize {
        self.payloads.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.payloads.is_empty()
    }

    /// How many pieces they are cut into.
    pub fn piece_count(&self) -> usize {
        self.pieces.len()
    }

    /// Memory held, bytes.
    pub fn memory_bytes(&self) -> usize {
        self.bvh.memory_bytes()
            + self.blocks.capacity() * size_of::<BeamBlock>()
            + self.payloads.capacity() * size_of::<Payload>()
            + self.widths.capacity() * size_of::<Width>()
            + self.pieces.capacity() * size_of::<Piece>()
            + self.builder.memory_bytes()
    }

    /// Radius of the blur of the beam in a lane at distance `s`, measured along the unit vector `across`; metres.
    #[inline(always)]
    pub fn radius_at(&self, leaf: u32, lane: usize, s: f32, across: Vec3) -> f32 {
        let block = &self.blocks[leaf as usize];
        match self.radius {
            BeamRadius::Fixed(radius) => radius,
            BeamRadius::Footprint { factor, least, most } => {
                (factor * self.widths[block.beam[lane & 7] as usize].along(s, across)).clamp(least, most)
            }
        }
    }
}

impl BeamRadius {
    /// Upper bound over a stretch of a beam.
    fn largest(&self, width: &Width, s0: f32, s1: f32) -> f32 {
        match *self {
            Self::Fixed(radius) => radius,
            // The length of a linear function is convex: it is largest at an end.
            Self::Footprint { factor, least, most } => {
                (factor * width.largest(s0).max(width.largest(s1))).clamp(least, most)
            }
        }
    }
}

/// Flux that is scattered per metre of a beam along `ray`, at the point `x` at distance `s`, watts per metre.
#[inline(always)]
fn scattered_flux(flux: Flux, attenuation: Attenuation, ray: &Ray, s: f32, x: Vec3, medium: &Medium) -> Spectrum {
    let start = flux.unpack();
    let sigma_s = medium.sigma_s(x) * medium.phase().extinction_factor(x, ray.direction);
    start * sigma_s * attenuation.at(s, start, ray, medium)
}

impl Beam {
    /// The beam as a ray.
    #[inline]
    pub fn ray(&self) -> Ray {
        Ray { origin: self.origin, direction: self.direction }
    }

    /// The point at distance `s` and the flux that `medium`, in which the beam is, scatters there, watts per metre.
    #[inline]
    pub fn scattered(&self, medium: &Medium, s: f32) -> (Vec3, Spectrum) {
        let ray = self.ray();
        let position = ray.at(s);
        (position, scattered_flux(self.flux, self.attenuation, &ray, s, position, medium))
    }

    /// The vertex that light's walk would have at distance `s`, if the flight had ended there with a density of 1 per
    /// metre; `None` for beams outside of media.
    #[inline]
    pub fn vertex(&self, scene: &Scene, s: f32) -> Option<Vertex> {
        let medium = self.tag.medium()?;
        let (position, throughput) = self.scattered(scene.medium(medium), s);
        let scattering = Scattering::Medium { medium };
        let scatterings = self.tag.scatterings();
        Some(Vertex { position, direction: self.direction, throughput, scatterings, leg: 0, scattering })
    }
}

impl Store for Beams {
    const DIMENSION: u32 = 1;
    type Block = BeamBlock;

    #[inline(always)]
    fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    #[inline(always)]
    fn block(&self, leaf: u32) -> &BeamBlock {
        &self.blocks[leaf as usize]
    }

    #[inline(always)]
    fn index(&self, leaf: u32, lane: usize) -> u32 {
        self.blocks[leaf as usize].beam[lane & 7]
    }

    #[inline(always)]
    fn tag(&self, leaf: u32, lane: usize) -> Tag {
        self.payloads[self.blocks[leaf as usize].beam[lane & 7] as usize].tag
    }

    #[inline(always)]
    fn arriving(&self, leaf: u32, lane: usize, [s, _]: [f32; 2], x: Vec3, medium: Option<&Medium>) -> Arriving {
        let block = &self.blocks[leaf as usize];
        let payload = &self.payloads[block.beam[lane & 7] as usize];
        let ray = block.ray(lane);
        let Some(medium) = medium else { return Arriving { direction: ray.direction, flux: Spectrum::ZERO } };
        let flux = scattered_flux(payload.flux, payload.attenuation, &ray, s, x, medium);
        Arriving { direction: ray.direction, flux }
    }
}

impl Attenuation {
    /// The factor of the flux at distance `s` on a beam along `ray` that starts with the flux `start`.
    #[inline(always)]
    pub fn at(self, s: f32, start: Spectrum, ray: &Ray, medium: &Medium) -> Spectrum {
        if let Self::Rate(rate) = self {
            return if rate == 0.0 { Spectrum::ONE } else { Spectrum::grey((-rate * s).exp()) };
        }
        self.chromatic(s, start, ray, medium)
    }

    #[inline(never)]
    fn chromatic(self, s: f32, start: Spectrum, ray: &Ray, medium: &Medium) -> Spectrum {
        let Extinction::Homogeneous(model) = medium.kind() else { return Spectrum::ZERO };
        let uniform = Uniform::along(model, medium.phase(), ray);
        match self {
            Self::Rate(rate) => Spectrum::grey((-rate * s).exp()),
            Self::Transmittance => uniform.transmittance(s),
            Self::Survivors => uniform.survivor_weight(start, s),
        }
    }
}
