//! Named algorithms: the one registry.

pub mod parameters;
pub mod path;
pub mod volpath;

use crate::film::pixels::{PixelSum, Tile};
use crate::scene::Scene;
use crate::scene::desc::IntegratorDesc;
pub use parameters::{ParameterError, ParameterInfo, ParameterKind, Parameters};
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

/// An algorithm that renders tiles.
pub trait Integrator: Send + Sync {
    /// What a user should know before rendering `scene`, one line each.
    fn warnings(&self, scene: &Scene) -> Vec<String>;

    /// Adds the job's passes to the tile's pixels. The result depends on the job alone.
    fn render(&self, scene: &Scene, job: &Job, pixels: &mut [PixelSum]) -> RareEvents;
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

/// Every integrator.
pub static REGISTRY: &[IntegratorInfo] = &[volpath::INFO, path::PATH, path::DIRECT];

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
