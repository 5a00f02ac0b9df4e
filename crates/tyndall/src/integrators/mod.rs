//! Named algorithms: the one registry.

mod bidirectional;
pub mod components;
mod composite;
pub mod parameters;
pub mod path;
mod photon_mapping;
mod shrinking;
mod virtual_lights;
pub mod volpath;

use crate::Spectrum;
use crate::film::Splats;
use crate::film::pixels::{PixelSum, Tile};
use crate::math::{Sampler, Vec2};
use crate::mis::{Catalogue, Record};
use crate::photons::TraceError;
use crate::scene::Scene;
use crate::scene::desc::IntegratorDesc;
pub use parameters::{ParameterError, ParameterInfo, ParameterKind, Parameters};
use photon_mapping::registry;
use std::ops::Range;

/// What a tile is rendered with.
#[derive(Clone, Debug)]
pub struct Job {
    /// The picture's seed.
    pub seed: u64,
    /// The passes to add: one camera sample per pixel each.
    pub passes: Range<u32>,
    /// The pixels.
    pub tile: Tile,
}

/// Counts of rare events; the picture is wrong when they are not rare.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RareEvents {
    /// Samples that were not finite and were dropped.
    pub non_finite: u64,
}

/// What an integrator made beside the pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Light paths traced.
    pub light_paths: u64,
    /// Points, beams, planes and vertices that they left.
    pub photons: u64,
    /// Edges between lights and what they light, where their number is the method's choice.
    pub connections: u64,
    /// Pixels in whose passes that number was not enough for the bound on the error.
    pub capped: u64,
}

/// An algorithm that renders tiles.
pub trait Integrator: Send + Sync {
    /// What a user should know before rendering `scene`, one line each.
    fn warnings(&self, scene: &Scene) -> Vec<String>;

    /// Makes what the pixels of pass number `pass` share: light paths, if there are any. Answers how many passes from this
    /// one on it serves. Called in the thread pool, before the tiles.
    fn prepare(&mut self, _scene: &Scene, _seed: u64, _pass: u32) -> Result<u32, TraceError> {
        Ok(u32::MAX)
    }

    /// What it made so far.
    fn counts(&self) -> Counts {
        Counts::default()
    }

    /// Whether it adds light to pixels anywhere. Its passes are then rendered one by one.
    fn splats(&self) -> bool {
        false
    }

    /// The same, which tells its techniques apart; `None` where there is but one way to find a path.
    fn by_technique(&self) -> Option<&dyn ByTechnique> {
        None
    }

    /// Adds the job's passes to the tile's pixels, and to `splats` what belongs to any pixel. The result depends on the
    /// job alone.
    fn render(&self, scene: &Scene, job: &Job, pixels: &mut [PixelSum], splats: &mut Splats) -> RareEvents;
}

/// An integrator whose techniques can be told apart.
pub trait ByTechnique {
    /// Its techniques in `scene` for paths of at most `max_depth`, and one for all that are longer if there are such.
    fn catalogue(&self, scene: &Scene, max_depth: u32) -> Catalogue;

    /// What [`Integrator::render`] does, to the bit, telling `record` every contribution.
    fn render_recorded(
        &self,
        scene: &Scene,
        job: &Job,
        pixels: &mut [PixelSum],
        splats: &mut Splats,
        record: &Record,
    ) -> RareEvents;
}

/// An entry of the registry.
pub struct IntegratorInfo {
    /// Name in scene files and on the command line.
    pub name: &'static str,
    /// Other names that mean the same.
    pub aliases: &'static [&'static str],
    /// What it does, one sentence.
    pub summary: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// Its parameters.
    pub parameters: &'static [ParameterInfo],
    make: fn(&Parameters) -> Result<Box<dyn Integrator>, ParameterError>,
}

impl std::fmt::Debug for IntegratorInfo {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("IntegratorInfo").field(&self.name).finish()
    }
}

impl IntegratorInfo {
    /// Whether `key` is one of its parameters, or `part.parameter` of an integrator that is a part of it.
    pub fn takes(&self, key: &str) -> bool {
        let part = key.split_once('.').map_or("", |(part, _)| part);
        self.parameters.iter().any(|info| info.name == key || (info.name == part && find(part).is_some()))
    }
}

/// Every integrator.
pub static REGISTRY: &[IntegratorInfo] = &[
    volpath::INFO,
    volpath::joint::INFO,
    path::PATH,
    path::DIRECT,
    registry::PHOTONMAP,
    registry::VPM,
    registry::BRE,
    registry::BEAMS,
    registry::PLANES,
    registry::PPM,
    registry::PVPM,
    registry::PBRE,
    registry::PPB,
    bidirectional::registry::PTRACER,
    bidirectional::registry::BDPT,
    bidirectional::registry::VCM,
    bidirectional::registry::UPBP,
    virtual_lights::registry::VPL,
    virtual_lights::registry::VSL,
    virtual_lights::registry::VRL,
    virtual_lights::registry::VBL,
    virtual_lights::registry::LIGHTCUTS,
    composite::INFO,
];

/// Names of the integrators whose techniques can be told apart.
pub fn by_technique() -> impl Iterator<Item = &'static str> {
    let apart = |info: &&IntegratorInfo| {
        let desc = IntegratorDesc { name: info.name.into(), parameters: Vec::new() };
        make(&desc).is_ok_and(|integrator| integrator.by_technique().is_some())
    };
    REGISTRY.iter().filter(apart).map(|info| info.name)
}

/// The entry called `name`, also by an alias.
pub fn find(name: &str) -> Option<&'static IntegratorInfo> {
    REGISTRY.iter().find(|info| info.name == name || info.aliases.contains(&name))
}

/// The integrator that `desc` names, with its parameters.
pub fn make(desc: &IntegratorDesc) -> Result<Box<dyn Integrator>, ParameterError> {
    let Some(info) = find(&desc.name) else {
        let known = REGISTRY.iter().map(|info| info.name).collect::<Vec<_>>().join(", ");
        return Err(ParameterError::UnknownIntegrator { name: desc.name.clone(), known });
    };
    (info.make)(&Parameters::new(info.name, info.parameters, desc)?)
}

/// A sample of a pixel.
#[derive(Clone, Copy, Debug)]
struct Sample {
    /// Position on the whole film, pixels.
    film: Vec2,
    /// Index of the pixel on the whole film, row by row.
    pixel: u64,
    /// The pass.
    pass: u32,
    /// Number of the pixel in the tile, row by row.
    place: usize,
    /// Weight of the filter.
    weight: f32,
}

/// The set of light paths of a pass, where `reuse` passes share one (0: all do), and how many passes from this one on it serves.
fn light_set(reuse: u32, pass: u32) -> (u32, u32) {
    match reuse {
        0 => (0, u32::MAX),
        reuse => (pass / reuse, reuse - pass % reuse),
    }
}

/// A pixel of the tile.
#[derive(Clone, Copy, Debug)]
struct Pixel {
    /// Column and row on the whole film.
    at: [u32; 2],
    /// Index on the whole film, row by row: a crop shows the same samples.
    index: u64,
    /// Number in the tile, row by row.
    place: usize,
}

impl Pixel {
    /// A position on the whole film that the filter chooses, pixels, and the weight of what is seen there.
    #[inline(always)]
    fn sample(&self, scene: &Scene, sampler: &mut Sampler) -> (Vec2, f32) {
        let (offset, weight) = scene.filter.sample(sampler.vec2());
        (Vec2::new(self.at[0] as f32 + 0.5, self.at[1] as f32 + 0.5) + offset, weight)
    }
}

/// Adds one sample of `radiance` per pass to every pixel of the tile.
#[inline(always)]
fn sample_pixels(
    scene: &Scene,
    job: &Job,
    pixels: &mut [PixelSum],
    mut radiance: impl FnMut(Sample, &mut Sampler) -> Spectrum,
) -> RareEvents {
    each_pixel(scene, job, pixels, |pixel, pass| {
        let mut sampler = Sampler::new(job.seed, pixel.index, pass);
        let (film, weight) = pixel.sample(scene, &mut sampler);
        weight * radiance(Sample { film, pixel: pixel.index, pass, place: pixel.place, weight }, &mut sampler)
    })
}

/// Adds a `radiance` per pass to every pixel of the tile.
#[inline(always)]
fn each_pixel(
    scene: &Scene,
    job: &Job,
    pixels: &mut [PixelSum],
    mut radiance: impl FnMut(Pixel, u32) -> Spectrum,
) -> RareEvents {
    let mut rare = RareEvents::default();
    let (crop_x, crop_y) = scene.crop_origin();
    let width = u64::from(scene.film.width);
    for (i, sum) in pixels.iter_mut().enumerate() {
        let at = [crop_x + job.tile.x + i as u32 % job.tile.width, crop_y + job.tile.y + i as u32 / job.tile.width];
        let pixel = Pixel { at, index: u64::from(at[1]) * width + u64::from(at[0]), place: i };
        for pass in job.passes.clone() {
            let radiance = radiance(pixel, pass);
            if radiance.is_finite() {
                sum.add(radiance);
            } else {
                rare.non_finite += 1;
                sum.add(Spectrum::ZERO);
            }
        }
    }
    rare
}
