//! Bidirectional methods: light paths and camera paths, joined in every way.
//!
//! For every pixel and pass one light path and one camera path are traced. Every vertex of light's path is joined with the
//! lens, every vertex of the camera's with an emitter and with every vertex of light's; walks that run into an emitter
//! count as well. The weights of all that are those of [`crate::mis`].

mod camera;
mod light;
pub mod registry;

use self::camera::CameraPath;
use self::light::{LightPath, LightVertex};
use super::volpath::{self, Volpath};
use super::{Integrator, Job, RareEvents, Sample, sample_pixels};
use crate::film::Splats;
use crate::film::pixels::PixelSum;
use crate::math::Sampler;
use crate::scene::Scene;
use crate::walk::{Effort, Rules};

/// Streams of numbers for light paths that belong to pixels.
const STREAM: u64 = 1 << 62;

/// What can be chosen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Options {
    pub(super) rules: Rules,
    pub(super) hide_emitters: bool,
}

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

/// Bidirectional path tracing.
pub(super) struct Bidirectional {
    options: Options,
}

impl Integrator for Bidirectional {
    fn warnings(&self, scene: &Scene) -> Vec<String> {
        scene.hidden_caustics().into_iter().collect()
    }

    fn splats(&self) -> bool {
        true
    }

    fn render(&self, scene: &Scene, job: &Job, pixels: &mut [PixelSum], splats: &mut Splats) -> RareEvents {
        let effort = Effort { connect: 1.0, lens: paths(scene), ..Effort::default() };
        let mut vertices: Vec<LightVertex> = Vec::new();
        sample_pixels(scene, job, pixels, |sample, sampler| {
            vertices.clear();
            LightPath { scene, rules: &self.options.rules, effort: &effort, splats }
                .trace(&mut light_sampler(job.seed, &sample), |vertex| vertices.push(vertex));
            CameraPath::radiance(scene, &self.options, &effort, &vertices, sample.film, sampler)
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
