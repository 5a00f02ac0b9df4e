//! Bidirectional methods: light paths and camera paths, joined in every way.
//!
//! For every pixel and pass one light path and one camera path are traced. Every vertex of light's path is joined with the
//! lens, every vertex of the camera's with an emitter and with every vertex of light's; walks that run into an emitter
//! count as well. Where it is wanted, the camera's walk is also merged with points and beams of other light paths, and
//! fewer are joined with light's. The weights of all that are those of [`crate::mis`].

mod camera;
mod joint;
mod light;
mod merging;
mod options;
pub mod registry;
mod stores;

use self::camera::CameraPath;
use self::joint::Pairing;
use self::light::{LightPath, LightVertex};
use self::merging::Merger;
use self::options::Options;
use self::stores::Stores;
use super::volpath::{self, Volpath};
use super::{ByTechnique, Counts, Integrator, Job, RareEvents, Sample, sample_pixels};
use crate::estimators::joint::Joint;
use crate::film::Splats;
use crate::film::pixels::PixelSum;
use crate::math::Sampler;
use crate::mis::{Catalogue, Merging, Record, Recorder, Technique};
use crate::photons::TraceError;
use crate::scene::Scene;
use crate::walk::{Effort, Profile};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Streams of numbers for light paths that belong to pixels.
const STREAM: u64 = 1 << 62;

/// Counts of what tiles make.
#[derive(Debug, Default)]
struct Tally {
    light_paths: AtomicU64,
    vertices: AtomicU64,
}

impl Tally {
    fn add(&self, light_paths: usize, vertices: usize) {
        self.light_paths.fetch_add(light_paths as u64, Relaxed);
        self.vertices.fetch_add(vertices as u64, Relaxed);
    }

    fn counts(&self) -> Counts {
        let (light_paths, photons) = (self.light_paths.load(Relaxed), self.vertices.load(Relaxed));
        Counts { light_paths, photons, ..Counts::default() }
    }
}

/// Light tracing: the lens is all that light's vertices are joined with.
pub(super) struct LightTracing {
    options: Options,
    /// Shows emitters seen directly.
    emitted: Volpath,
    tally: Tally,
}

impl LightTracing {
    fn new(options: Options) -> Self {
        let emitted = Volpath::new(volpath::Options::emitted(options.hide_emitters));
        Self { options, emitted, tally: Tally::default() }
    }

    fn paint<R: Recorder>(
        &self,
        scene: &Scene,
        job: &Job,
        pixels: &mut [PixelSum],
        splats: &mut Splats,
        record: &R,
    ) -> RareEvents {
        let effort = Effort { lens: paths(scene), ..Effort::default() };
        let (mut light_paths, mut vertices) = (0, 0);
        let rare = sample_pixels(scene, job, pixels, |sample, sampler| {
            light_paths += 1;
            LightPath { scene, rules: &self.options.rules, effort: &effort, splats, record }
                .trace(&mut light_sampler(job.seed, &sample), |_| vertices += 1);
            let seen = self.emitted.radiance(scene, sample.film, sampler);
            record.add(Technique::Join { light: 0, camera: 2 }, seen, seen);
            record.finish(sample.place, sample.weight);
            seen
        });
        self.tally.add(light_paths, vertices);
        rare
    }
}

impl Integrator for LightTracing {
    fn warnings(&self, scene: &Scene) -> Vec<String> {
        let sharp = scene.any_delta();
        sharp
            .then(|| "light tracing does not show what is seen in smooth mirrors or through smooth glass".to_string())
            .into_iter()
            .collect()
    }

    fn counts(&self) -> Counts {
        self.tally.counts()
    }

    fn splats(&self) -> bool {
        true
    }

    fn by_technique(&self) -> Option<&dyn ByTechnique> {
        Some(self)
    }

    fn render(&self, scene: &Scene, job: &Job, pixels: &mut [PixelSum], splats: &mut Splats) -> RareEvents {
        self.paint(scene, job, pixels, splats, &())
    }
}

impl ByTechnique for LightTracing {
    fn catalogue(&self, _: &Scene, max_depth: u32) -> Catalogue {
        catalogue(&self.options, max_depth, |technique| match technique {
            Technique::Join { light, camera } => camera == 1 || light == 0 && camera == 2,
            Technique::Merge { .. } => false,
            Technique::Longer => true,
        })
    }

    fn render_recorded(
        &self,
        scene: &Scene,
        job: &Job,
        pixels: &mut [PixelSum],
        splats: &mut Splats,
        record: &Record,
    ) -> RareEvents {
        self.paint(scene, job, pixels, splats, record)
    }
}

/// Bidirectional path tracing, with merging if it is wanted.
pub(super) struct Bidirectional {
    options: Options,
    stores: Stores,
    tally: Tally,
    /// By medium; none where two points are not sampled jointly.
    joints: Vec<Joint>,
}

impl Bidirectional {
    fn new(options: Options) -> Self {
        Self { options, stores: Stores::new(), tally: Tally::default(), joints: Vec::new() }
    }

    fn paint<R: Recorder>(
        &self,
        scene: &Scene,
        job: &Job,
        pixels: &mut [PixelSum],
        splats: &mut Splats,
        record: &R,
    ) -> RareEvents {
        let Self { options, stores, tally, joints } = self;
        let effort = &stores.effort;
        let merges = options.techniques.merge();
        let mut vertices: Vec<LightVertex> = Vec::new();
        let mut profile = Profile::default();
        let mut forks = Vec::new();
        let (mut light_paths, mut left) = (0, 0);
        let rare = sample_pixels(scene, job, pixels, |sample, sampler| {
            vertices.clear();
            let joined = if merges { Effort::JOINED } else { 1.0 };
            let joins = joined == 1.0 || sampler.rng().f32() < joined;
            if options.techniques.bpt {
                LightPath { scene, rules: &options.rules, effort, splats, record }.trace(
                    &mut light_sampler(job.seed, &sample),
                    |LightVertex { mut vertex, end }| {
                        left += 1;
                        if joins {
                            vertex.throughput = vertex.throughput / joined;
                            vertices.push(LightVertex { vertex, end });
                        }
                    },
                );
                light_paths += 1;
            }
            let (max_depth, kernel) = (options.rules.max_depth, options.kernel);
            let merger = Merger { scene, stores, kernel, max_depth, profile: &mut profile, record, boost: 1.0 };
            let pairing = Pairing::new(joints);
            let film = sample.film;
            let seen =
                CameraPath::radiance(scene, options, effort, &vertices, merger, pairing, &mut forks, film, sampler);
            record.finish(sample.place, sample.weight);
            seen
        });
        tally.add(light_paths, left);
        rare
    }
}

impl Integrator for Bidirectional {
    fn warnings(&self, scene: &Scene) -> Vec<String> {
        let merges = self.options.techniques.merge();
        scene.hidden_caustics().filter(|_| !merges).into_iter().collect()
    }

    fn prepare(&mut self, scene: &Scene, seed: u64, pass: u32) -> Result<u32, TraceError> {
        let Counts { light_paths, photons, .. } = self.stores.prepare(scene, &self.options, seed, pass)?;
        self.tally.add(light_paths as usize, photons as usize);
        if self.options.joint && self.joints.is_empty() {
            self.joints = Joint::of_media(scene);
        }
        Ok(1)
    }

    fn counts(&self) -> Counts {
        self.tally.counts()
    }

    fn splats(&self) -> bool {
        self.options.techniques.bpt
    }

    fn by_technique(&self) -> Option<&dyn ByTechnique> {
        Some(self)
    }

    fn render(&self, scene: &Scene, job: &Job, pixels: &mut [PixelSum], splats: &mut Splats) -> RareEvents {
        self.paint(scene, job, pixels, splats, &())
    }
}

impl ByTechnique for Bidirectional {
    fn catalogue(&self, scene: &Scene, max_depth: u32) -> Catalogue {
        let used = self.options.techniques;
        let media = !scene.media().is_empty();
        catalogue(&self.options, max_depth, |technique| match technique {
            Technique::Join { light, camera } => used.bpt || light == 0 && camera == 2,
            Technique::Merge { merging: Merging::Surface, .. } => used.surface,
            Technique::Merge { merging: Merging::PointPoint, .. } => used.point_point && media,
            Technique::Merge { merging: Merging::BeamPoint, .. } => used.beam_point && media,
            Technique::Merge { merging: Merging::BeamBeam, .. } => used.beam_beam && media,
            Technique::Longer => used.bpt || used.merge(),
        })
    }

    fn render_recorded(
        &self,
        scene: &Scene,
        job: &Job,
        pixels: &mut [PixelSum],
        splats: &mut Splats,
        record: &Record,
    ) -> RareEvents {
        self.paint(scene, job, pixels, splats, record)
    }
}

/// The techniques that are `used`, as far as paths are that long.
fn catalogue(options: &Options, max_depth: u32, used: impl Fn(Technique) -> bool) -> Catalogue {
    let longest = options.rules.max_depth;
    let allowed = |technique: Technique| technique != Technique::Longer || longest > max_depth;
    Catalogue::new(max_depth.min(longest), |technique| allowed(technique) && used(technique))
}

/// Light paths of a pass: one for each pixel.
fn paths(scene: &Scene) -> f32 {
    let (width, height) = scene.picture_size();
    width as f32 * height as f32
}

/// The numbers of the light path that belongs to a sample.
fn light_sampler(seed: u64, sample: &Sample) -> Sampler {
    Sampler::new(seed, STREAM | u64::from(sample.pass), sample.pixel as u32)
}
