//! Virtual lights: what light paths leave is connected with what the camera sees.
//!
//! Vertices of light paths are point lights, segments of them ray lights. They give the light that goes straight from its
//! last scattering but one to the last; path tracing gives the rest: emitters, direct light, single scattering, what comes
//! over smooth mirrors and glass, and what a bound on the lights' nearness cuts off.

mod batch;
mod camera;
mod chosen;
mod lightcuts;
mod nearby;
pub mod registry;

use self::batch::{PointLight, RayLight};
use self::camera::Seeker;
use self::chosen::Choice;
use self::nearby::Nearby;
use super::components::Components;
use super::volpath::{self, Volpath};
use super::{Counts, Integrator, Job, RareEvents, light_set, sample_pixels};
use crate::Spectrum;
use crate::estimators::connect::{Way, transfer};
use crate::film::Splats;
use crate::film::pixels::PixelSum;
use crate::math::Rng;
use crate::photons::{Beam, Extent, LightPaths, TraceError, Tracing, Wanted};
use crate::scene::Scene;
use crate::scene::desc::MediumId;
use crate::walk::{Profile, Rules, Scattering, Vertex};
use rayon::prelude::*;
use std::cell::Cell;
use std::sync::atomic::{AtomicU64, Ordering};

/// Whether points on rays are chosen by what phase functions and transmittance make of them, besides their distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Product {
    /// Where that pays.
    Automatic,
    Always,
    Never,
}

/// What becomes of light that the bound on nearness cuts off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Compensation {
    /// It is missing.
    None,
    /// Paths are traced for it.
    Path,
    /// In media the lights themselves give it, from steps as short as the bound's reach; on surfaces paths.
    Approximate,
}

/// All choices.
#[derive(Clone, Copy, Debug)]
pub(super) struct Options {
    /// Rules of the camera's walk.
    camera_rules: Rules,
    /// Rules of light's walk.
    light_rules: Rules,
    /// Light paths of a set.
    photons: u32,
    /// Whether segments are lights in media, or vertices.
    rays: bool,
    extent: Extent,
    /// Lights that a query visits; 0: all.
    lights: u32,
    /// Points on a camera's ray for each light, or pairs of points for ray lights.
    samples: u32,
    product: Product,
    /// Bound on 1/d^2, 1/m^2; 0: none.
    clamp: f32,
    compensation: Compensation,
    /// First radius of lights that are balls, metres: 0 for an automatic one, `None` for points and rays.
    radius: Option<f32>,
    /// Passes that share a set of light paths; 0: all.
    reuse: u32,
    /// What light paths are keyed by instead of the picture's seed.
    light_seed: Option<u64>,
    components: Components,
    memory: usize,
}

/// The integrator.
pub(super) struct VirtualLights {
    options: Options,
    path: Volpath,
    paths: LightPaths,
    /// The vertices as point lights, those of one manner together.
    lights: Vec<PointLight>,
    /// The beams in media.
    ray_lights: Vec<RayLight>,
    /// Which vertices and which beams a query visits.
    points: Choice,
    rays: Choice,
    /// Whether the phase function of each medium is so uneven that points are better chosen by it.
    uneven: Vec<bool>,
    first_radius: Option<f32>,
    /// Radius of lights, metres; 0 for points and rays.
    radius: f32,
    /// The set of light paths at hand.
    set: Option<u32>,
    counts: Counts,
    /// Edges between lights and what they light.
    connections: AtomicU64,
}

/// Automatic radius of vertices and of rays, in units of the mean length of light's segments in media. The singularity of
/// rays is weaker: a wider ball has more noise of its own than it takes away.
const USUAL_RADIUS: [f32; 2] = [0.1, 0.01];
/// Automatic radius without media, in units of the scene's diagonal.
const SURFACE_RADIUS: f32 = 0.01;

/// Contrast of a phase function, and optical depth of a camera's ray, from which on a table of turns pays.
const UNEVEN: f32 = 1.5;
const DEEP: f32 = 1.0;

/// The set of light paths from which a radius is found.
const PILOT_SET: u32 = u32::MAX;

impl VirtualLights {
    fn new(options: Options, path: volpath::Options) -> Self {
        Self {
            options,
            path: Volpath::new(path),
            paths: LightPaths::default(),
            lights: Vec::new(),
            ray_lights: Vec::new(),
            points: Choice::default(),
            rays: Choice::default(),
            uneven: Vec::new(),
            first_radius: None,
            radius: 0.0,
            set: None,
            counts: Counts::default(),
            connections: AtomicU64::new(0),
        }
    }

    fn tracing(&self, seed: u64, set: u32) -> Tracing<'static> {
        let Options { photons, light_rules, rays, extent, memory, .. } = self.options;
        let seed = self.options.light_seed.unwrap_or(seed);
        let wanted = Wanted { beams: rays, vertices: [!rays, true], ..Wanted::default() };
        Tracing { seed, set, extent, wanted, memory, ..Tracing::of(photons, light_rules) }
    }

    /// Whether points on rays in these media are chosen by how light turns there, on a camera's ray of that optical depth.
    #[inline(always)]
    fn turns_matter(&self, media: [MediumId; 2], depth: f32) -> bool {
        match self.options.product {
            Product::Automatic => depth > DEEP || media.iter().any(|id| self.uneven[id.0]),
            product => product == Product::Always,
        }
    }

    /// The radius to begin with: as given, or from a few light paths; 0 for points and rays.
    fn first_radius(&mut self, scene: &Scene, seed: u64) -> Result<f32, TraceError> {
        let radius = match (self.first_radius, self.options.radius) {
            (Some(known), _) => known,
            (None, None) => 0.0,
            (None, Some(given)) if given > 0.0 => given,
            (None, Some(_)) => {
                let pilot = self.tracing(seed, PILOT_SET);
                self.paths.trace(scene, &Tracing { wanted: Wanted { beams: true, ..pilot.wanted }, ..pilot })?;
                let usual = f64::from(USUAL_RADIUS[usize::from(self.options.rays)]);
                let lengths: f64 = self.paths.beams.iter().map(|beam| f64::from(beam.length)).sum();
                match self.paths.beams.len() {
                    0 => SURFACE_RADIUS * scene.geometry.bounds().extent().length(),
                    count => (usual * lengths / count as f64) as f32,
                }
            }
        };
        self.first_radius = Some(radius);
        Ok(radius)
    }
}

impl Integrator for VirtualLights {
    fn warnings(&self, scene: &Scene) -> Vec<String> {
        self.path.warnings(scene)
    }

    fn prepare(&mut self, scene: &Scene, seed: u64, pass: u32) -> Result<u32, TraceError> {
        let (set, serves) = light_set(self.options.reuse, pass);
        if self.set == Some(set) {
            return Ok(serves);
        }
        let first_radius = self.first_radius(scene, seed)?;
        if self.uneven.is_empty() {
            self.uneven.extend(scene.media().iter().map(|medium| medium.phase().contrast() > UNEVEN));
        }
        self.paths.trace(scene, &self.tracing(seed, set))?;
        let vertices = &self.paths.vertices;
        self.lights.clear();
        self.lights.par_extend(vertices.par_iter().enumerate().map(|(i, v)| PointLight::new(scene, v, i as u32)));
        self.lights.sort_by_key(PointLight::manner);
        self.points.of(self.lights.iter().map(|light| vertices[light.vertex()].throughput.max_channel()));
        let beams = &self.paths.beams;
        self.ray_lights.clear();
        self.ray_lights.extend(beams.iter().enumerate().filter_map(|(i, beam)| RayLight::new(scene, beam, i as u32)));
        let power = |beam: &Beam| beam.flux.unpack().max_channel() * beam.length;
        self.rays.of(self.ray_lights.iter().map(|light| power(&beams[light.beam()])));
        // The bias is of second order in the radius and the variance bounded: it may shrink fast.
        self.radius = first_radius / (set as f32 + 1.0).sqrt();
        self.counts.light_paths += u64::from(self.options.photons);
        self.counts.photons += self.paths.data() as u64;
        self.set = Some(set);
        Ok(serves)
    }

    fn counts(&self) -> Counts {
        Counts { connections: self.connections.load(Ordering::Relaxed), ..self.counts }
    }

    fn render(&self, scene: &Scene, job: &Job, pixels: &mut [PixelSum], _: &mut Splats) -> RareEvents {
        let mut profile = Profile::default();
        let connections = Cell::new(0);
        let straight = self.options.components.intersection(Components::STRAIGHT) != Components::NONE;
        let rare = sample_pixels(scene, job, pixels, |sample, sampler| {
            let traced = self.path.radiance(scene, sample.film, sampler);
            if !straight {
                return traced;
            }
            let lit = traced + Seeker::radiance(self, scene, &mut profile, &connections, sample.film, sampler);
            match self.options.compensation {
                Compensation::Approximate => {
                    lit + Nearby::radiance(self, scene, &mut profile, &connections, sample.film, sampler)
                }
                _ => lit,
            }
        });
        self.connections.fetch_add(connections.get(), Ordering::Relaxed);
        rare
    }
}

/// Light from `light` that scatters at `camera`, times the number of light paths; 1/d^2 is bounded by `clamp` (1/m^2; 0: not).
#[inline]
fn lit(scene: &Scene, way: Option<Way>, light: &Vertex, camera: &Vertex, clamp: f32, rng: &mut Rng) -> Spectrum {
    let Some(way) = way else { return Spectrum::ZERO };
    match transfer(scene, &way, light, camera, rng) {
        Some(value) => light.throughput * camera.throughput * value * kept(clamp, way.spread),
        None => Spectrum::ZERO,
    }
}

/// The part of 1/d^2 below `clamp` (1/m^2; 0 is none), as a share.
fn kept(clamp: f32, spread: f32) -> f32 {
    if clamp > 0.0 { (clamp / spread).min(1.0) } else { 1.0 }
}

/// Whether light that scatters there is wanted.
fn wanted(components: Components, scattering: &Scattering) -> bool {
    let part = match scattering {
        Scattering::Medium { .. } => Components::MULTIPLE,
        Scattering::Surface { .. } => Components::INDIRECT,
    };
    components.intersection(Components::STRAIGHT).has(part)
}
