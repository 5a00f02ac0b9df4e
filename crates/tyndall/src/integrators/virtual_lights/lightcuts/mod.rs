//! Multidimensional lightcuts (Walter et al. 2006): all virtual point lights light all that a pixel sees, cluster by cluster.
//!
//! Lights are clusters of a tree, and so are the points that a pixel gathers light at: surfaces that its camera rays meet, and
//! points of these rays in media. A cut is a set of pairs of clusters that together are all pairs of lights and points.
//! It is refined where the bound of what a pair may give is above a share of the pixel's light. For each of its pairs
//! one light and one point are then joined, chosen by their strengths and divided by the probability.
//!
//! What the share is taken of comes from a few pairs joined beforehand. The final choices are independent of it, so
//! that the mean over them is the sum over all pairs, whatever the bound: the bound decides about noise alone.

mod bounds;
mod clusters;
mod cut;
mod gather;
mod member;
#[cfg(test)]
mod tests;

use self::bounds::Bounds;
use self::clusters::{Clusters, Member};
use self::cut::{Cut, Graph};
use self::gather::Gatherer;
use super::{PILOT_SET, lit};
use crate::Spectrum;
use crate::estimators::connect::Way;
use crate::film::Splats;
use crate::film::pixels::PixelSum;
use crate::integrators::components::Components;
use crate::integrators::volpath::{self, Volpath};
use crate::integrators::{Counts, Integrator, Job, Pixel, RareEvents, each_pixel, light_set};
use crate::math::{Rng, Sampler, Vec2, Vec3};
use crate::photons::{LightPaths, TraceError, Tracing, Wanted};
use crate::scene::Scene;
use crate::walk::{Profile, Rules, Vertex};
use std::sync::atomic::{AtomicU64, Ordering};

/// All choices.
#[derive(Clone, Copy, Debug)]
pub(super) struct Options {
    /// Rules of the camera's walk.
    pub(super) camera_rules: Rules,
    /// Rules of light's walk.
    pub(super) light_rules: Rules,
    /// Light paths of a set.
    pub(super) photons: u32,
    /// Bound of a pair, as a share of the pixel's light; 0 joins all pairs.
    pub(super) error: f32,
    /// Most pairs of a cut; 0: no limit.
    pub(super) max_cut: u32,
    /// Camera samples that share a cut.
    pub(super) samples: u32,
    /// Points on a stretch of a camera's ray that scatters all light.
    pub(super) points: u32,
    /// Bound on 1/d^2, 1/m^2, 0 for none; `None`: an automatic one.
    pub(super) clamp: Option<f32>,
    /// Whether paths are traced for the light that the bound cuts off.
    pub(super) compensates: bool,
    /// Passes that share a set of light paths; 0: all.
    pub(super) reuse: u32,
    pub(super) components: Components,
    pub(super) memory: usize,
}

impl Options {
    /// Whether light scattered `scatterings` times may scatter at a light and at a camera's vertex with that many before.
    #[inline(always)]
    fn counts(&self, scatterings: u32, before: u32) -> bool {
        scatterings.saturating_add(before).saturating_add(3) <= self.camera_rules.max_depth
    }
}

/// Pairs joined beforehand, for a first look at the pixel's light.
const FIRST_LOOK: usize = 64;

/// Streams of numbers for the choice of members; those of pixels have smaller names, those of light paths greater ones.
const STREAM: u64 = 1 << 62;

/// Light paths from which an automatic clamp is found, and places of the film that tell what is dark.
const PILOT_PATHS: u32 = 1000;
const PILOT_LOOKS: u32 = 256;

/// Share of a picture's usual radiance below which nobody tells 2 %.
const DARK: f32 = 0.05;

/// Automatic least distance of lights in units of their spread, for as many as there are to the power of -1/3: a ball of that
/// radius holds about half a light.
const USUAL_DISTANCE: f64 = 1.0;

/// The integrator.
pub(super) struct Lightcuts {
    options: Options,
    path_options: volpath::Options,
    path: Volpath,
    paths: LightPaths,
    lights: Clusters,
    /// Bound on 1/d^2, 1/m^2; 0: none.
    clamp: f32,
    /// Pixels of less radiance are refined as if they had that much.
    dark: f32,
    /// The set of light paths at hand.
    set: Option<u32>,
    counts: Counts,
    connections: AtomicU64,
    capped: AtomicU64,
}

/// What a thread keeps from pixel to pixel.
#[derive(Default)]
struct Scratch {
    profile: Profile,
    vertices: Vec<Vertex>,
    points: Clusters,
    cut: Cut,
    connections: u64,
    capped: u64,
}

impl Lightcuts {
    /// With the path tracer of what virtual lights do not give; of all, if it compensates for the clamp.
    pub(super) fn new(options: Options, path_options: volpath::Options) -> Self {
        Self {
            options,
            path_options,
            path: Volpath::new(path_options),
            paths: LightPaths::default(),
            lights: Clusters::default(),
            clamp: 0.0,
            dark: 0.0,
            set: None,
            counts: Counts::default(),
            connections: AtomicU64::new(0),
            capped: AtomicU64::new(0),
        }
    }

    fn tracing(&self, seed: u64, set: u32) -> Tracing<'static> {
        let Options { photons, light_rules, memory, .. } = self.options;
        let wanted = Wanted { vertices: [true, true], ..Wanted::default() };
        Tracing { seed, set, wanted, memory, ..Tracing::of(photons, light_rules) }
    }

    /// Finds the bound on 1/d^2, if it is an automatic one, and what counts as dark, from a few light paths of their own: the
    /// same whatever pass comes first, and independent of the lights of any.
    fn pilot(&mut self, scene: &Scene, seed: u64) -> Result<(), TraceError> {
        let paths = self.options.photons.min(PILOT_PATHS);
        self.paths.trace(scene, &Tracing { paths, ..self.tracing(seed, PILOT_SET) })?;
        let share = f64::from(self.options.photons) / f64::from(paths);
        let usual = || {
            let diagonal = scene.geometry.bounds().extent().length();
            let fallback = if diagonal > 0.0 && diagonal.is_finite() { 1e4 / (diagonal * diagonal) } else { 1e4 };
            usual_clamp(&self.paths.vertices, share).unwrap_or(fallback)
        };
        let clamp = self.options.clamp.unwrap_or_else(usual);
        self.clamp = clamp;
        if self.options.compensates {
            self.path = Volpath::new(self.path_options.bounded(clamp));
        }
        if self.options.error > 0.0 {
            self.lights.rebuild(members(scene, &self.paths.vertices));
            // As coarse as a cut can be.
            self.dark = f32::INFINITY;
            self.dark = DARK * self.usual_radiance(scene, paths, seed);
        }
        Ok(())
    }

    /// Mean radiance of a few places of the film, of `paths` light paths.
    fn usual_radiance(&self, scene: &Scene, paths: u32, seed: u64) -> f32 {
        let (bounds, mut scratch) = (Bounds::new(scene, self.clamp), Scratch::default());
        let size = Vec2::new(scene.film.width as f32, scene.film.height as f32);
        let mut sum = Spectrum::ZERO;
        for look in 0..PILOT_LOOKS {
            let mut sampler = Sampler::new(seed, STREAM | u64::from(u32::MAX), look);
            let film = sampler.vec2() * size;
            let traced = self.path.radiance(scene, film, &mut sampler);
            let Scratch { profile, vertices, .. } = &mut scratch;
            vertices.clear();
            let mut gatherer = Gatherer { options: &self.options, scene, profile, points: vertices };
            gatherer.gather(film, 1.0 / paths as f32, &mut sampler);
            let radiance = traced + self.lit(scene, &bounds, &mut scratch, traced, sampler.rng());
            // One bright spot should not make a picture's rest dark.
            sum += if radiance.is_finite() { radiance.map(|x| x.max(0.0).sqrt()) } else { Spectrum::ZERO };
        }
        let root = sum.max_channel() / PILOT_LOOKS as f32;
        root * root
    }

    /// Radiance of a pixel in one pass.
    fn pixel(
        &self,
        scene: &Scene,
        bounds: &Bounds,
        scratch: &mut Scratch,
        pixel: Pixel,
        pass: u32,
        seed: u64,
    ) -> Spectrum {
        let Options { samples, .. } = self.options;
        let straight = self.options.components.intersection(Components::STRAIGHT) != Components::NONE;
        let Scratch { profile, vertices, .. } = scratch;
        vertices.clear();
        let mut gatherer = Gatherer { options: &self.options, scene, profile, points: vertices };
        let mut traced = Spectrum::ZERO;
        let first = pass.wrapping_mul(samples);
        for sample in 0..samples {
            let mut sampler = Sampler::new(seed, pixel.index, first.wrapping_add(sample));
            let (film, weight) = pixel.sample(scene, &mut sampler);
            let share = weight / samples as f32;
            traced += share * self.path.radiance(scene, film, &mut sampler);
            if straight && !self.lights.is_empty() {
                gatherer.gather(film, share / self.options.photons as f32, &mut sampler);
            }
        }
        let mut rng = Rng::keyed(seed, STREAM | pixel.index, u64::from(first));
        traced + self.lit(scene, bounds, scratch, traced, &mut rng)
    }

    /// What all lights give by way of all the points in `scratch`, beside the light `traced`.
    fn lit(&self, scene: &Scene, bounds: &Bounds, scratch: &mut Scratch, traced: Spectrum, rng: &mut Rng) -> Spectrum {
        let Options { error, max_cut, .. } = self.options;
        let Scratch { vertices, points, cut, connections, capped, .. } = scratch;
        points.rebuild(vertices.iter().enumerate().filter_map(|(i, vertex)| member::point(scene, vertex, i as u32)));
        if points.is_empty() {
            return Spectrum::ZERO;
        }
        let all = self.lights.members.len().saturating_mul(points.members.len());
        let most = if max_cut == 0 { usize::MAX } else { max_cut as usize };
        let mut sum = Spectrum::ZERO;
        if all <= most && (error == 0.0 || all <= FIRST_LOOK) {
            *connections += all as u64;
            for light in &self.lights.members {
                for point in &points.members {
                    sum += self.join(scene, light.index, &vertices[point.index as usize], rng);
                }
            }
            return sum;
        }
        let graph = Graph { lights: &self.lights, points, bounds };
        let mut join_pairs = |cut: &Cut, rng: &mut Rng| {
            *connections += cut.len() as u64;
            let mut sum = Spectrum::ZERO;
            for pair in cut.pairs() {
                let (light, of_lights) = self.lights.choose(pair.light, rng);
                let (point, of_points) = points.choose(pair.point, rng);
                sum += self.join(scene, light, &vertices[point as usize], rng) / (of_lights * of_points);
            }
            sum
        };
        cut.start(&graph);
        let mut threshold = 0.0;
        if error > 0.0 {
            cut.refine(&graph, 0.0, FIRST_LOOK.min(most));
            threshold = error * (traced + join_pairs(cut, rng)).map(f32::abs).max_channel().max(self.dark);
        }
        cut.refine(&graph, threshold, most);
        *capped += u64::from(cut.error() > threshold);
        join_pairs(cut, rng)
    }

    /// What a light gives by way of a point.
    #[inline]
    fn join(&self, scene: &Scene, light: u32, point: &Vertex, rng: &mut Rng) -> Spectrum {
        let light = &self.paths.vertices[light as usize];
        if !self.options.counts(light.scatterings, point.scatterings) {
            return Spectrum::ZERO;
        }
        lit(scene, Way::new(light.position, point.position), light, point, self.clamp, rng)
    }
}

/// The vertices of light's walks that scatter anything.
fn members<'a>(scene: &'a Scene, lights: &'a [Vertex]) -> impl Iterator<Item = Member> + 'a {
    lights.iter().enumerate().filter_map(|(i, vertex)| member::light(scene, vertex, i as u32))
}

/// The bound on 1/d^2 (1/m^2) for `share` times as many lights as these; `None` if they all are in one place, or none.
fn usual_clamp(lights: &[Vertex], share: f64) -> Option<f32> {
    let weight = |vertex: &Vertex| f64::from(vertex.throughput.max_channel());
    let total: f64 = lights.iter().map(weight).sum();
    let mean = |value: &dyn Fn(Vec3) -> glam::DVec3| {
        lights.iter().map(|vertex| value(vertex.position) * weight(vertex)).sum::<glam::DVec3>() / total
    };
    let centre = mean(&|x| x.as_dvec3());
    let variance = mean(&|x| (x.as_dvec3() - centre) * (x.as_dvec3() - centre)).element_sum() / 3.0;
    let count = share * lights.len() as f64;
    let distance2 = USUAL_DISTANCE * USUAL_DISTANCE * variance * count.powf(-2.0 / 3.0);
    let clamp = (1.0 / distance2) as f32;
    (clamp > 0.0 && clamp.is_finite()).then_some(clamp)
}

impl Integrator for Lightcuts {
    fn warnings(&self, scene: &Scene) -> Vec<String> {
        self.path.warnings(scene)
    }

    fn prepare(&mut self, scene: &Scene, seed: u64, pass: u32) -> Result<u32, TraceError> {
        let (set, serves) = light_set(self.options.reuse, pass);
        if self.set == Some(set) {
            return Ok(serves);
        }
        if self.set.is_none() {
            self.pilot(scene, seed)?;
        }
        self.paths.trace(scene, &self.tracing(seed, set))?;
        let vertices = &self.paths.vertices;
        if vertices.len() * (2 * size_of::<Vertex>() + Clusters::BYTES) > self.options.memory {
            return Err(TraceError::Memory { limit: self.options.memory });
        }
        self.lights.rebuild(members(scene, vertices));
        self.counts.light_paths += u64::from(self.options.photons);
        self.counts.photons += vertices.len() as u64;
        self.set = Some(set);
        Ok(serves)
    }

    fn counts(&self) -> Counts {
        let [connections, capped] = [&self.connections, &self.capped].map(|count| count.load(Ordering::Relaxed));
        Counts { connections, capped, ..self.counts }
    }

    fn render(&self, scene: &Scene, job: &Job, pixels: &mut [PixelSum], _: &mut Splats) -> RareEvents {
        let bounds = Bounds::new(scene, self.clamp);
        let mut scratch = Scratch::default();
        let rare = each_pixel(scene, job, pixels, |pixel, pass| {
            self.pixel(scene, &bounds, &mut scratch, pixel, pass, job.seed)
        });
        self.connections.fetch_add(scratch.connections, Ordering::Relaxed);
        self.capped.fetch_add(scratch.capped, Ordering::Relaxed);
        rare
    }
}
