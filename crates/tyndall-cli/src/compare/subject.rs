//! A scene of a comparison, read and checked against every method before anything is rendered.

use super::experiment::{Experiment, Kind, Method, SceneEntry};
use crate::args::SceneFile;
use crate::choice;
use crate::console::{Console, Level};
use crate::failure::Failure;
use crate::{fingerprint, load};
use std::path::PathBuf;
use tyndall::scene::Scene;
use tyndall::scene::desc::{IntegratorDesc, SceneDesc};
use tyndall_formats::mitsuba::Loaded;

/// Finds what `volpath` meets only by chance.
const REFERENCE_METHOD: &str = "volpath";
const REFERENCE_METHOD_OF_CAUSTICS: &str = "ppb";

/// A scene that can be rendered by every method.
#[derive(Debug)]
pub(crate) struct Subject {
    pub(crate) name: String,
    /// As it was given.
    pub(crate) shown: PathBuf,
    /// From the root.
    pub(crate) path: PathBuf,
    pub(crate) define: Vec<(String, String)>,
    pub(crate) size: [u32; 2],
    /// Of everything that the picture depends on except integrator and seed.
    pub(crate) hash: u64,
    /// Of the first repeat.
    pub(crate) seed: u64,
    /// All parameters of each method; the template of another renderer.
    pub(crate) descriptions: Vec<String>,
    /// What an automatic reference is rendered with, all parameters, and a word on the choice.
    pub(crate) reference_method: [String; 2],
    pub(crate) reference_note: Option<String>,
}

impl Subject {
    /// Reads a scene and checks what is asked of it.
    pub(crate) fn new(entry: &SceneEntry, experiment: &Experiment) -> Result<Self, Failure> {
        let quiet = Console { level: Level::Quiet };
        let loaded = load::load(&SceneFile { path: entry.path.clone(), define: entry.define.clone() }, quiet)?;
        let film = load::film(loaded.scene.film, experiment.size, None)?;
        let size = film.crop.map_or([film.width, film.height], |[_, _, width, height]| [width, height]);
        let describe = |method: &Method| describe(method, &loaded);
        let descriptions = experiment.methods.iter().map(describe).collect::<Result<Vec<_>, _>>()?;
        if let Some([x, y, w, h]) = entry.insets.iter().find(|[x, y, w, h]| {
            u64::from(*x) + u64::from(*w) > u64::from(size[0]) || u64::from(*y) + u64::from(*h) > u64::from(size[1])
        }) {
            let [width, height] = size;
            return Err(Failure::usage(format_args!(
                "the inset {x},{y},{w},{h} leaves the picture of {}, which has {width}x{height} pixels",
                entry.name
            )));
        }
        let path = std::path::absolute(&entry.path)
            .map_err(|error| Failure::other(format_args!("{}: {error}", entry.path.display())))?;
        let (name, reference_note) = match experiment.reference_method {
            Some(info) => (info.name, None),
            None => usual_reference(&loaded.scene)?,
        };
        let info = choice::find(name)?;
        let reference = choice::choose(&loaded, Some(info), &[], quiet)?;
        let reference_method = [info.name.to_owned(), choice::parameters(&reference)];
        let seed = experiment.seed.unwrap_or(loaded.scene.sampler.seed);
        let mut bare = SceneDesc { film, integrator: IntegratorDesc::default(), ..loaded.scene };
        bare.sampler.seed = 0;
        Ok(Self {
            name: entry.name.clone(),
            shown: entry.path.clone(),
            path,
            define: entry.define.clone(),
            size,
            hash: fingerprint::of_scene(&bare),
            seed,
            descriptions,
            reference_method,
            reference_note,
        })
    }
}

/// A method that a path tracer's luck does not decide about, and why it was chosen.
fn usual_reference(desc: &SceneDesc) -> Result<(&'static str, Option<String>), Failure> {
    let scene = Scene::build(desc).map_err(Failure::other)?;
    Ok(match scene.hidden_caustics() {
        None => (REFERENCE_METHOD, None),
        Some(_) => {
            let note = format!(
                "`{REFERENCE_METHOD}` would find light behind smooth glass only by chance, so the reference is by \
                 `{REFERENCE_METHOD_OF_CAUSTICS}`: its blur falls with time and is not quite gone"
            );
            (REFERENCE_METHOD_OF_CAUSTICS, Some(note))
        }
    })
}

fn describe(method: &Method, loaded: &Loaded) -> Result<String, Failure> {
    match &method.kind {
        Kind::External(template) => Ok(template.text().to_owned()),
        Kind::Integrator { info, set } => {
            let quiet = Console { level: Level::Quiet };
            let chosen = choice::choose(loaded, Some(info), set, quiet).map_err(|failure| match failure {
                Failure::Usage(message) => Failure::Usage(format!("{}{message}", method.place)),
                other => other,
            });
            chosen.map(|desc| format!("{} {}", desc.name, choice::parameters(&desc)))
        }
    }
}
