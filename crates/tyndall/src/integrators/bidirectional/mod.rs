//! Bidirectional methods: light paths and camera paths, joined in every way.
//!
//! For every pixel and pass one light path and one camera path are traced. Every vertex of light's path is joined with the
//! lens, every vertex of the camera's with an emitter and with every vertex of light's; walks that run into an emitter
//! count as well. Where it is wanted, the camera's walk is also merged with points and beams of other light paths. The
//! weights of all that are those of [`crate::mis`].

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
use super::{Integrator, Job, RareEvents, Sample, sample_pixels};
use crate::estimators::joint::Joint;
use crate::film::Splats;
use crate::film::pixels::PixelSum;
use crate::math::Sampler;
use crate::photons::TraceError;
use crate::scene::Scene;
use crate::walk::{Effort, Profile};

/// Streams of numbers for light paths that belong to pixels.
const STREAM: u64 = 1 << 62;

/// Light tracing: the lens is all that light's vertices are joined with.
pub(super) struct LightTracing {
    options: Options,
    /// Shows emitters seen directly.
    emitted: Volpath,
}

impl LightTracing {
    fn new(options: Options) -> Self {
        Self { options, emitted: Volpath::new(volpath::Options::emitted(options.hide_emitters)) }
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

    fn splats(&self) -> bool {
        true
    }

    fn render(&self, scene: &Scene, job: &Job, pixels: &mut [PixelSum], splats: &mut Splats) -> RareEvents {
        let effort = Effort { lens: paths(scene), ..Effort::default() };
        sample_pixels(scene, job, pixels, |sample, sampler| {
            LightPath { scene, rules: &self.options.rules, effort: &effort, splats }
                .trace(&mut light_sampler(job.seed, &sample), |_| ());
            self.emitted.radiance(scene, sample.film, sampler)
        })
    }
}

/// Bidirectional path tracing, with merging if it is wanted.
pub(super) struct Bidirectional {
    options: Options,
    stores: Stores,
    /// By medium; none where two points are not sampled jointly.
    joints: Vec<Joint>,
}

impl Bidirectional {
    fn new(options: Options) -> Self {
        Self { options, stores: Stores::new(), joints: Vec::new() }
    }
}

impl Integrator for Bidirectional {
    fn warnings(&self, scene: &Scene) -> Vec<String> {
        let merges = self.options.techniques.merge();
        scene.hidden_caustics().filter(|_| !merges).into_iter().collect()
    }

    fn prepare(&mut self, scene: &Scene, seed: u64, pass: u32) -> Result<u32, TraceError> {
        self.stores.prepare(scene, &self.options, seed, pass)?;
        if self.options.joint && self.joints.is_empty() {
            self.joints = Joint::of_media(scene);
        }
        Ok(1)
    }

    fn splats(&self) -> bool {
        self.options.techniques.bpt
    }

    fn render(&self, scene: &Scene, job: &Job, pixels: &mut [PixelSum], splats: &mut Splats) -> RareEvents {
        let Self { options, stores, joints } = self;
        let effort = &stores.effort;
        let mut vertices: Vec<LightVertex> = Vec::new();
        let mut profile = Profile::default();
        sample_pixels(scene, job, pixels, |sample, sampler| {
            vertices.clear();
            if options.techniques.bpt {
                LightPath { scene, rules: &options.rules, effort, splats }
                    .trace(&mut light_sampler(job.seed, &sample), |vertex| vertices.push(vertex));
            }
            let (max_depth, kernel) = (options.rules.max_depth, options.kernel);
            let merger = Merger { scene, stores, kernel, max_depth, profile: &mut profile };
            let pairing = Pairing::new(joints);
            CameraPath::radiance(scene, options, effort, &vertices, merger, pairing, sample.film, sampler)
        })
    }
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
