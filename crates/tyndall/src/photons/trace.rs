//! Tracing light paths and keeping what they leave behind.

use super::footprint::Footprint;
use super::{Attenuation, Beam, BeamTerms, Flux, Origin, Photon, Plane, Tag};
use crate::Spectrum;
use crate::math::lanes::{Kernel, Lanes, Level};
use crate::math::octahedral::Octahedral;
use crate::math::{Ray, Sampler, Vec3};
use crate::scene::Scene;
use crate::scene::medium::{Extinction, Medium};
use crate::walk::flight::{self, Uniform};
use crate::walk::{
    Account, Arrival, Effort, FromLight, Onward, Profile, Rules, Scattering, Segment, Sink, Start, Vertex, walk,
};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// How long beams are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// To the end of the flight that was sampled.
    Short,
    /// To the next surface, or until the medium is opaque.
    Long,
}

/// Which data are kept.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wanted {
    /// Points in media.
    pub points: bool,
    /// Points on surfaces that have more than delta scattering.
    pub surfaces: bool,
    /// On surfaces also what comes straight from an emitter.
    pub direct: bool,
    /// Beams; with planes only those that do not start at a scattering in a medium.
    pub beams: bool,
    /// Planes.
    pub planes: bool,
    /// Vertices as the walk had them, in media and on surfaces that have more than delta scattering: to be connected with.
    pub vertices: [bool; 2],
}

/// What to trace.
#[derive(Clone, Copy, Debug)]
pub struct Tracing<'a> {
    /// How many light paths.
    pub paths: u32,
    /// When they end.
    pub rules: Rules,
    /// The picture's seed.
    pub seed: u64,
    /// Number of the set of light paths: each is independent of the others.
    pub set: u32,
    /// How long beams are.
    pub extent: Extent,
    /// Whether beams get the width of their footprints.
    pub footprints: bool,
    /// Radius of points in media, metres.
    pub point_radius: f32,
    /// Radius of points on surfaces, metres.
    pub surface_radius: f32,
    /// What is kept.
    pub wanted: Wanted,
    /// The techniques for whose weights terms are kept; `None`: none are.
    pub effort: Option<&'a Effort>,
    /// Memory that all data with their hierarchies may take, bytes.
    pub memory: usize,
}

impl Tracing<'_> {
    /// So many light paths of which nothing is kept: short, of no width, in any memory.
    pub fn of(paths: u32, rules: Rules) -> Self {
        Self {
            paths,
            rules,
            seed: 0,
            set: 0,
            extent: Extent::Short,
            footprints: false,
            point_radius: 0.0,
            surface_radius: 0.0,
            wanted: Wanted::default(),
            effort: None,
            memory: usize::MAX,
        }
    }
}

/// Why light paths cannot be kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TraceError {
    /// They take more memory than allowed.
    #[error("the light paths need more than the {} MiB that `memory` allows: trace fewer `photons`, or allow more", .limit >> 20)]
    Memory {
        /// The limit, bytes.
        limit: usize,
    },
    /// More media than data can name.
    #[error("the scene has {found} media, light paths can tell {} apart", Tag::MAX_MEDIA)]
    Media {
        /// How many there are.
        found: usize,
    },
}

/// Light paths a chunk: enough to keep a thread busy, few enough to balance.
const CHUNK: u32 = 2048;

/// Bytes that a datum takes in all: as traced twice, its place along the curve, its place in a block.
const BYTES: [usize; 3] = [120, 650, 400];

/// The memory that data take is looked at before each path and after so many scatterings.
const MEASURED: u32 = 16;

/// Streams of numbers for light paths; those of pixels have smaller names.
const STREAM: u64 = 1 << 63;

/// Vectors of data, in the order of the light paths.
#[derive(Debug, Default)]
pub struct LightPaths {
    /// Points in media.
    pub points: Vec<Photon>,
    /// Points on surfaces.
    pub surfaces: Vec<Photon>,
    /// Beams.
    pub beams: Vec<Beam>,
    /// Planes.
    pub planes: Vec<Plane>,
    /// Vertices.
    pub vertices: Vec<Vertex>,
    /// What light's walk carried at the points in media, where it is wanted.
    pub point_terms: Vec<Arrival>,
    /// The same at the points on surfaces.
    pub surface_terms: Vec<Arrival>,
    /// The same on the legs of the beams.
    pub beam_terms: Vec<BeamTerms>,
    chunks: Vec<Data>,
}

/// What a chunk of light paths leaves.
#[derive(Debug, Default)]
struct Data {
    points: Vec<Photon>,
    surfaces: Vec<Photon>,
    beams: Vec<Beam>,
    planes: Vec<Plane>,
    vertices: Vec<Vertex>,
    point_terms: Vec<Arrival>,
    surface_terms: Vec<Arrival>,
    beam_terms: Vec<BeamTerms>,
    profile: Profile,
}

impl Data {
    fn clear(&mut self) {
        self.points.clear();
        self.surfaces.clear();
        self.beams.clear();
        self.planes.clear();
        self.vertices.clear();
        self.point_terms.clear();
        self.surface_terms.clear();
        self.beam_terms.clear();
    }

    #[inline(always)]
    fn bytes(&self) -> usize {
        (self.points.len() + self.surfaces.len()) * BYTES[0]
            + self.beams.len() * BYTES[1]
            + self.planes.len() * BYTES[2]
            + self.vertices.len() * 2 * size_of::<Vertex>()
            + (self.point_terms.len() + self.surface_terms.len()) * 2 * size_of::<Arrival>()
            + self.beam_terms.len() * 2 * size_of::<BeamTerms>()
    }
}

impl LightPaths {
    /// Points, beams, planes and vertices together.
    pub fn data(&self) -> usize {
        self.points.len() + self.surfaces.len() + self.beams.len() + self.planes.len() + self.vertices.len()
    }

    /// Traces. The data depend on the scene and `tracing` alone, not on the number of threads. Memory is re-used.
    pub fn trace(&mut self, scene: &Scene, tracing: &Tracing) -> Result<(), TraceError> {
        if scene.media().len() >= Tag::MAX_MEDIA {
            return Err(TraceError::Media { found: scene.media().len() });
        }
        let count = tracing.paths.div_ceil(CHUNK) as usize;
        self.chunks.resize_with(count, Data::default);
        let bytes = AtomicUsize::new(0);
        self.chunks.par_iter_mut().enumerate().for_each(|(i, data)| {
            data.clear();
            if bytes.load(Ordering::Relaxed) > tracing.memory {
                return;
            }
            let first = i as u32 * CHUNK;
            let paths = first..first.saturating_add(CHUNK).min(tracing.paths);
            Level::dispatch(Chunk { scene, tracing, paths, data });
            bytes.fetch_add(data.bytes(), Ordering::Relaxed);
        });
        if bytes.into_inner() > tracing.memory {
            self.chunks = Vec::new();
            return Err(TraceError::Memory { limit: tracing.memory });
        }
        concatenate(&mut self.points, &mut self.chunks, |data| &mut data.points);
        concatenate(&mut self.surfaces, &mut self.chunks, |data| &mut data.surfaces);
        concatenate(&mut self.beams, &mut self.chunks, |data| &mut data.beams);
        concatenate(&mut self.planes, &mut self.chunks, |data| &mut data.planes);
        concatenate(&mut self.vertices, &mut self.chunks, |data| &mut data.vertices);
        concatenate(&mut self.point_terms, &mut self.chunks, |data| &mut data.point_terms);
        concatenate(&mut self.surface_terms, &mut self.chunks, |data| &mut data.surface_terms);
        concatenate(&mut self.beam_terms, &mut self.chunks, |data| &mut data.beam_terms);
        Ok(())
    }
}

/// Data of more bytes are given up chunk by chunk when they are put together.
const LARGE: usize = 256 << 20;

fn concatenate<T: Copy>(all: &mut Vec<T>, chunks: &mut [Data], part: impl Fn(&mut Data) -> &mut Vec<T>) {
    all.clear();
    let total: usize = chunks.iter_mut().map(|data| part(data).len()).sum();
    all.reserve_exact(total);
    for data in chunks {
        let part = part(data);
        all.extend_from_slice(part);
        if total * size_of::<T>() > LARGE {
            *part = Vec::new();
        }
    }
}

/// Some of the light paths.
struct Chunk<'a> {
    scene: &'a Scene,
    tracing: &'a Tracing<'a>,
    paths: Range<u32>,
    data: &'a mut Data,
}

/// A kernel though nothing here is in lanes: whatever the walk calls is compiled for the machine's instructions, and the
/// kernels among it need not be entered anew for every ray.
impl Kernel for Chunk<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        for path in self.paths {
            if self.data.bytes() > self.tracing.memory {
                return;
            }
            trace_path(self.scene, self.tracing, path, self.data);
        }
    }
}

#[inline(always)]
fn trace_path(scene: &Scene, tracing: &Tracing, path: u32, data: &mut Data) {
    let mut sampler = Sampler::new(tracing.seed, STREAM | u64::from(tracing.set), path);
    let (u_position, u_direction, choice) = (sampler.vec2(), sampler.vec2(), sampler.f32());
    let Some(emission) = scene.sample_emission(choice, u_position, u_direction) else { return };
    let footprint =
        if tracing.footprints { Footprint::emitted(&emission, tracing.paths) } else { Footprint::default() };
    let start = Start::emitted(&emission);
    let account = tracing.effort.map(|effort| Account::of_light(scene, effort, &emission));
    let (origin, anchor) = (Origin::Direct, start.ray.origin);
    let mut deposit = Deposit { scene, tracing, data, origin, bent: false, footprint, anchor, account };
    walk::<FromLight, _>(scene, start, &tracing.rules, &mut sampler, &mut deposit);
}

/// The sink that keeps data.
struct Deposit<'a> {
    scene: &'a Scene,
    tracing: &'a Tracing<'a>,
    data: &'a mut Data,
    /// How the light has come so far.
    origin: Origin,
    /// Whether the last vertex was in a medium.
    bent: bool,
    /// What the path shares with its neighbours, and where it was last brought up to date.
    footprint: Footprint,
    anchor: Vec3,
    /// What the walk carries for weights, where they are wanted.
    account: Option<Account<'a, FromLight>>,
}

impl Deposit<'_> {
    /// Brings the footprint up to date.
    #[inline(always)]
    fn travel_to(&mut self, position: Vec3) {
        if self.tracing.footprints {
            self.footprint.travel(self.anchor.distance(position));
            self.anchor = position;
        }
    }

    #[inline(always)]
    fn photon(&self, vertex: &Vertex, radius: f32, tag: Tag) -> Photon {
        Photon {
            position: vertex.position,
            radius,
            flux: Flux::new(vertex.throughput),
            direction: Octahedral::new(vertex.direction),
            tag,
        }
    }
}

impl Sink for Deposit<'_> {
    #[inline(always)]
    fn looks_beyond(&self, _leg: u32) -> bool {
        self.tracing.extent == Extent::Long && (self.tracing.wanted.beams || self.tracing.wanted.planes)
    }

    #[inline(always)]
    fn segment(&mut self, segment: &Segment, sampler: &mut Sampler) {
        let terms = self.account.as_ref().map(|account| BeamTerms::new(account, segment.ray));
        if let Some(account) = &mut self.account {
            account.pass(segment);
        }
        let wanted = self.tracing.wanted;
        let beams = wanted.beams && !(wanted.planes && self.bent);
        if !(beams || wanted.planes) || segment.scatterings + 2 > self.tracing.rules.max_depth {
            return;
        }
        self.travel_to(segment.ray.origin);
        let footprint = self.footprint;
        let medium = self.scene.medium(segment.medium);
        let tag = Tag::new(Some(segment.medium), segment.scatterings, self.origin);
        let planes = wanted.planes && segment.scatterings + 3 <= self.tracing.rules.max_depth;
        let Data { beams: kept_beams, planes: kept_planes, beam_terms, profile, .. } = &mut *self.data;
        pieces(medium, segment, self.tracing.extent, profile, sampler, |piece, sampler| {
            let flux = Flux::new(piece.flux);
            let Ray { origin, direction } = piece.ray;
            let (length, attenuation) = (piece.length, piece.attenuation);
            if beams {
                let width = footprint.width().from(origin.distance(segment.ray.origin));
                beam_terms.extend(terms);
                kept_beams.push(Beam { origin, direction, length, flux, attenuation, tag, width });
            }
            if planes {
                let tag = Tag::new(Some(segment.medium), segment.scatterings + 1, Origin::Scattered);
                kept_planes.extend(bend(medium, &piece, tag, sampler));
            }
        });
    }

    #[inline(always)]
    fn vertex(&mut self, vertex: &Vertex, _sampler: &mut Sampler) {
        self.travel_to(vertex.position);
        let [in_media, on_surfaces] = self.tracing.wanted.vertices;
        let connects = match &vertex.scattering {
            Scattering::Medium { .. } => in_media,
            Scattering::Surface { point, .. } => on_surfaces && self.scene.is_smooth(point.shape),
        };
        if connects {
            self.data.vertices.push(*vertex);
        }
        let arrival = self.account.as_mut().map(|account| account.arrive(vertex).arrival);
        match &vertex.scattering {
            Scattering::Medium { medium } if self.tracing.wanted.points => {
                let tag = Tag::new(Some(*medium), vertex.scatterings, self.origin);
                let photon = self.photon(vertex, self.tracing.point_radius, tag);
                self.data.points.push(photon);
                self.data.point_terms.extend(arrival);
            }
            // What comes straight is left to the camera, which looks for emitters itself.
            Scattering::Surface { point, .. }
                if self.tracing.wanted.surfaces
                    && (self.origin != Origin::Direct || self.tracing.wanted.direct)
                    && self.scene.is_smooth(point.shape) =>
            {
                let tag = Tag::new(None, vertex.scatterings, self.origin);
                let photon = self.photon(vertex, self.tracing.surface_radius, tag);
                self.data.surfaces.push(photon);
                self.data.surface_terms.extend(arrival);
            }
            _ => {}
        }
    }

    #[inline(always)]
    fn scattered(&mut self, vertex: &Vertex, onward: &Onward) -> bool {
        if let Some(account) = &mut self.account {
            account.depart(vertex, onward);
        }
        self.bent = matches!(vertex.scattering, Scattering::Medium { .. });
        self.origin = match (self.origin, onward.pdf) {
            (Origin::Direct | Origin::Specular, None) => Origin::Specular,
            _ => Origin::Scattered,
        };
        if self.tracing.footprints {
            match (&vertex.scattering, onward.pdf) {
                (Scattering::Surface { point, .. }, None) => {
                    let (d_in, d_out) = (vertex.direction, onward.direction);
                    self.footprint.bounce(&self.scene.geometry, point, d_in, d_out, onward.eta);
                }
                (_, Some(pdf)) => self.footprint.scatter(onward.direction, pdf, self.tracing.paths),
                _ => {}
            }
        }
        // Beyond, nothing can be kept.
        vertex.scatterings + 3 <= self.tracing.rules.max_depth
            && (vertex.scatterings % MEASURED != MEASURED - 1 || self.data.bytes() <= self.tracing.memory)
    }
}

/// A stretch of a segment on which the flux follows one law.
struct Piece {
    ray: Ray,
    length: f32,
    flux: Spectrum,
    attenuation: Attenuation,
}

/// The stretches of a segment as beams. In heterogeneous media long ones, and those of chromatic media, become steps of an
/// estimated transmittance.
fn pieces(
    medium: &Medium,
    segment: &Segment,
    extent: Extent,
    profile: &mut Profile,
    sampler: &mut Sampler,
    mut keep: impl FnMut(Piece, &mut Sampler),
) {
    let ray = *segment.ray;
    let flux = segment.throughput;
    let reach = |length| flight::reach(medium, &ray, length);
    match medium.kind() {
        Extinction::Homogeneous(model) => {
            let uniform = Uniform::along(model, medium.phase(), &ray);
            let end = match extent {
                Extent::Short => segment.flight.distance,
                Extent::Long => segment.length,
            };
            let attenuation = match (extent, uniform.is_grey()) {
                (Extent::Short, true) => Attenuation::Rate(0.0),
                (Extent::Short, false) => Attenuation::Survivors,
                (Extent::Long, true) => Attenuation::Rate(uniform.sigma_t[0]),
                (Extent::Long, false) => Attenuation::Transmittance,
            };
            if let Some((_, length)) = reach(end) {
                keep(Piece { ray, length, flux, attenuation }, sampler);
            }
        }
        Extinction::Heterogeneous(model) => {
            if extent == Extent::Short && model.is_grey() {
                if let Some((near, far)) = reach(segment.flight.distance) {
                    let ray = Ray { origin: ray.at(near), ..ray };
                    keep(Piece { ray, length: far - near, flux, attenuation: Attenuation::Rate(0.0) }, sampler);
                }
                return;
            }
            let Some((_, far)) = reach(segment.length) else { return };
            profile.trace(medium, &ray, far, sampler.rng());
            let steps = profile.steps();
            for (i, step) in steps.iter().enumerate() {
                let until = steps.get(i + 1).map_or(far, |next| next.from);
                let (length, flux) = (until - step.from, flux * step.value);
                if length > 0.0 && !flux.is_black() {
                    let ray = Ray { origin: ray.at(step.from), ..ray };
                    keep(Piece { ray, length, flux, attenuation: Attenuation::Rate(step.rate) }, sampler);
                }
            }
        }
    }
}

/// A plane whose first edge is `piece`: the direction of the second edge is sampled from the phase function at the start,
/// its length from an exponential distribution.
fn bend(medium: &Medium, piece: &Piece, tag: Tag, sampler: &mut Sampler) -> Option<Plane> {
    let phase = medium.phase();
    let Ray { origin, direction } = piece.ray;
    let (second, density) = phase.sample(origin, direction, sampler.f32(), sampler.vec2());
    let end_rate = match medium.kind() {
        Extinction::Homogeneous(model) => model.sigma_t().mean(),
        // Between the extremes: the rate decides about noise only.
        Extinction::Heterogeneous(model) => 0.5 * model.majorants().max(),
    };
    let length = -(1.0 - sampler.f32()).ln() / end_rate;
    let flux = Flux::new(piece.flux / density.0);
    let plane = Plane {
        origin,
        directions: [direction, second],
        lengths: [piece.length, length],
        flux,
        attenuation: piece.attenuation,
        end_rate,
        tag,
    };
    (length > 0.0 && length.is_finite()).then_some(plane)
}
