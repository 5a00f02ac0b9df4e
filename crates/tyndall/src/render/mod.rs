//! Passes over tiles: drives an integrator until a budget is spent.

pub mod budget;
pub mod checkpoint;
pub mod picture;
pub mod pyramid;

pub use budget::{Budget, Progress};
pub use checkpoint::CheckpointError;
pub use picture::Picture;
pub use pyramid::{PyramidError, TechniquePicture};

use crate::film::Splats;
use crate::film::layers::LayerSplat;
use crate::film::pixels::{PixelSum, Pixels, Tile};
use crate::film::splats::{Screen, SplatSums};
use crate::integrators::{self, Counts, Integrator, Job, ParameterError, RareEvents};
use crate::mis::Record;
use crate::photons::TraceError;
use crate::scene::Scene;
use crate::scene::desc::IntegratorDesc;
use pyramid::Pyramid;
use rayon::prelude::*;
use std::ops::{ControlFlow, Range};
use std::time::{Duration, Instant};

/// How to render.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The algorithm; the scene's own when `None`.
    pub integrator: Option<IntegratorDesc>,
    /// The seed; the scene's own when `None`.
    pub seed: Option<u64>,
    /// Number of threads; as many as the machine has when `None`.
    pub threads: Option<usize>,
}

/// The settings of a scene file.
impl Default for Settings {
    fn default() -> Self {
        Self { integrator: None, seed: None, threads: None }
    }
}

/// Why a rendering cannot begin.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The integrator's name or parameters.
    #[error(transparent)]
    Parameters(#[from] ParameterError),
    /// The light paths.
    #[error(transparent)]
    LightPaths(#[from] TraceError),
    /// The thread pool.
    #[error("could not start {threads} threads: {reason}")]
    Threads {
        /// How many were asked for.
        threads: usize,
        /// What the system said.
        reason: String,
    },
}

/// Tiles rendered before their splats are summed up: enough for all threads, few enough for little memory.
const SPLATTING_TILES: usize = 256;

/// A picture in the making: passes can be added at any time, and the result never depends on how they were grouped or
/// on the number of threads.
pub struct Rendering<'s> {
    scene: &'s Scene,
    integrator: Box<dyn Integrator>,
    desc: IntegratorDesc,
    seed: u64,
    pool: rayon::ThreadPool,
    pixels: Pixels,
    passes: u32,
    busy: Duration,
    rare: RareEvents,
    pyramid: Option<Pyramid>,
}

/// What a tile brought besides its pixels.
struct Rendered<'a> {
    splats: Splats<'a>,
    layers: Vec<LayerSplat>,
    events: RareEvents,
}

impl<'s> Rendering<'s> {
    /// A black picture of `scene`.
    pub fn new(scene: &'s Scene, settings: &Settings) -> Result<Self, RenderError> {
        let desc = settings.integrator.clone().unwrap_or_else(|| scene.integrator.clone());
        let integrator = integrators::make(&desc)?;
        let threads = settings.threads.unwrap_or(0);
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|error| RenderError::Threads { threads, reason: error.to_string() })?;
        let (width, height) = scene.picture_size();
        Ok(Self {
            scene,
            integrator,
            desc,
            seed: settings.seed.unwrap_or(scene.sampler.seed),
            pool,
            pixels: Pixels::new(width, height),
            passes: 0,
            busy: Duration::ZERO,
            rare: RareEvents::default(),
            pyramid: None,
        })
    }

    /// What a user should know before rendering.
    pub fn warnings(&self) -> Vec<String> {
        self.integrator.warnings(self.scene)
    }

    /// The integrator and its parameters as given.
    pub fn integrator(&self) -> &IntegratorDesc {
        &self.desc
    }

    /// The seed in use.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Number of threads.
    pub fn threads(&self) -> usize {
        self.pool.current_num_threads()
    }

    /// Passes done: samples per pixel.
    pub fn passes(&self) -> u32 {
        self.passes
    }

    /// Time spent rendering, without pauses.
    pub fn seconds(&self) -> f64 {
        self.busy.as_secs_f64()
    }

    /// Counts of rare events so far.
    pub fn rare_events(&self) -> RareEvents {
        self.rare
    }

    /// What the integrator made beside the pixels, since it was set up: a render that was continued starts from nothing.
    pub fn counts(&self) -> Counts {
        self.integrator.counts()
    }

    /// Renders `count` more passes. After an error the picture is what it was before the pass that failed.
    pub fn add_passes(&mut self, count: u32) -> Result<(), RenderError> {
        let started = Instant::now();
        let end = self.passes + count;
        while self.passes < end {
            let (scene, seed, first) = (self.scene, self.seed, self.passes);
            let serves = self.pool.install(|| self.integrator.prepare(scene, seed, first))?;
            let serves = if self.integrator.splats() { 1 } else { serves };
            let passes = first..end.min(first.saturating_add(serves));
            self.rare.non_finite += self.render_passes(passes.clone());
            self.passes = passes.end;
        }
        self.busy += started.elapsed();
        Ok(())
    }

    /// Adds passes that share what was prepared. Answers how many samples were not finite.
    fn render_passes(&mut self, passes: Range<u32>) -> u64 {
        let Self { scene, integrator, seed, pool, pixels, pyramid, .. } = self;
        let (scene, seed) = (*scene, *seed);
        let screen = Screen { filter: &scene.filter, origin: scene.crop_origin(), size: scene.picture_size() };
        // Pixels of the tiles so far.
        let mut first = 0;
        let mut render = |tiles: &mut [(Tile, &mut [PixelSum])]| -> Vec<Rendered> {
            let job = |tile| Job { seed, passes: passes.clone(), tile };
            let count: usize = tiles.iter().map(|(tile, _)| tile.pixels()).sum();
            let kept = match pyramid {
                Some(pyramid) => pyramid.tiles(first, tiles),
                None => tiles.iter().map(|_| None).collect(),
            };
            let rendered = tiles.par_iter_mut().zip(kept).with_max_len(1).map(|((tile, sums), kept)| {
                let mut splats = Splats::new(screen);
                let (events, layers) = match (integrator.by_technique(), kept) {
                    (Some(apart), Some((catalogue, layers))) => {
                        let record = Record::new(catalogue, layers);
                        let events = apart.render_recorded(scene, &job(*tile), sums, &mut splats, &record);
                        (events, record.into_splats())
                    }
                    _ => (integrator.render(scene, &job(*tile), sums, &mut splats), Vec::new()),
                };
                Rendered { splats, layers, events }
            });
            let rendered: Vec<Rendered> = pool.install(|| rendered.collect());
            if let Some(pyramid) = pyramid {
                rendered.iter().for_each(|tile| pyramid.add(&tile.layers));
            }
            first += count;
            rendered
        };
        let count = |tile: &Rendered| tile.splats.non_finite + tile.events.non_finite;
        let mut non_finite = 0;
        if integrator.splats() {
            // A pixel's sample is what its camera path brings and what light paths of the whole picture add.
            let mut samples = Pixels::new(pixels.width(), pixels.height());
            let mut light = SplatSums::new(samples.sums().len());
            for tiles in samples.tiles_mut().chunks_mut(SPLATTING_TILES) {
                let rendered = render(tiles);
                rendered.iter().for_each(|tile| light.add(&tile.splats));
                non_finite += rendered.iter().map(count).sum::<u64>();
            }
            for ((pixel, sample), light) in pixels.sums_mut().iter_mut().zip(samples.sums()).zip(light.values()) {
                pixel.add_values(std::array::from_fn(|c| sample.sum[c] + light[c]));
            }
        } else {
            non_finite += render(&mut pixels.tiles_mut()).iter().map(count).sum::<u64>();
        }
        if let Some(pyramid) = pyramid {
            pyramid.end_passes(passes.end - passes.start);
        }
        non_finite
    }

    /// Renders until `budget` is spent or `observe` breaks off. `observe` is called after every group of passes, at
    /// most a few times a second; it may read the picture so far.
    pub fn run(
        &mut self,
        budget: Budget,
        mut observe: impl FnMut(&Self, Progress) -> ControlFlow<()>,
    ) -> Result<(), RenderError> {
        let mut group = budget::Group::new();
        while let Some(count) = group.next(&budget, self) {
            self.add_passes(count)?;
            if observe(self, budget.progress(self)).is_break() {
                break;
            }
        }
        Ok(())
    }

    /// The picture so far; black before the first pass.
    pub fn picture(&self) -> Picture {
        Picture::new(&self.pixels, self.passes)
    }

    /// Everything needed to go on later, see [`Rendering::resume`].
    pub fn checkpoint(&self, fingerprint: u64) -> Vec<u8> {
        checkpoint::write(self, fingerprint)
    }

    /// Continues from a checkpoint of the same scene and settings, which `fingerprint` stands for: the picture becomes
    /// bit for bit the one of a rendering that was never interrupted.
    pub fn resume(&mut self, bytes: &[u8], fingerprint: u64) -> Result<(), CheckpointError> {
        checkpoint::read(self, bytes, fingerprint)
    }
}
