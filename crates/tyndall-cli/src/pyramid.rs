//! `tyndall render --pyramid`: what each technique adds to the picture.

use crate::args::{Render, SceneFile};
use crate::choice;
use crate::compare::own_command;
use crate::console::Console;
use crate::failure::Failure;
use crate::output::Target;
use crate::render::metadata;
use crate::state;
use serde::Serialize;
use std::path::{Path, PathBuf};
use tyndall::render::Rendering;
use tyndall_formats::file::write_atomically;
use tyndall_formats::image::Picture;
use tyndall_report::View;
use tyndall_report::report::{Part, PyramidPage, Report};

/// Techniques are told apart up to this depth.
const DEPTH: u32 = 6;

/// Most memory that their pictures may take, bytes.
const MEMORY: usize = 4 << 30;

/// The folder of the pictures.
pub(crate) struct Pyramid {
    folder: PathBuf,
}

/// `pyramid.json`.
#[derive(Serialize)]
struct Listing<'a> {
    scene: &'a Path,
    integrator: &'a str,
    parameters: String,
    samples: u32,
    techniques: Vec<Files<'a>>,
}

#[derive(Serialize)]
struct Files<'a> {
    #[serde(flatten)]
    part: &'a Part,
    weighted: String,
    unweighted: Option<String>,
}

impl Pyramid {
    /// Has techniques kept, if that is wanted, and makes the folder.
    pub(crate) fn begin(args: &Render, rendering: &mut Rendering) -> Result<Option<Self>, Failure> {
        let Some(folder) = args.pyramid.clone() else { return Ok(None) };
        let problem = |error| Failure::usage(format_args!("--pyramid: {error}"));
        rendering.keep_techniques(args.pyramid_depth.unwrap_or(DEPTH), MEMORY).map_err(problem)?;
        std::fs::create_dir_all(&folder)
            .map_err(|error| Failure::other(format_args!("cannot make the folder {}: {error}", folder.display())))?;
        Ok(Some(Self { folder }))
    }

    /// Writes pictures, list and page.
    pub(crate) fn write(&self, rendering: &Rendering, scene: &SceneFile, console: Console) -> Result<(), Failure> {
        let whole = rendering.picture();
        let (width, height) = (whole.width as usize, whole.height as usize);
        let name = scene.path.file_stem().unwrap_or_default().to_string_lossy();
        let integrator = rendering.integrator();
        let (samples, parameters) = (rendering.passes(), choice::parameters(integrator));
        let report = Report {
            title: format!("{name}: the pyramid of {}", integrator.name),
            program: concat!("tyndall ", env!("CARGO_PKG_VERSION")).into(),
            budget: format!("{width} × {height} pixels  ·  {samples} samples each  ·  {parameters}"),
            command: own_command(),
            ..Report::default()
        };
        let view = View::new(width, height, &whole.pixels).map_err(Failure::other)?;
        let mut page = PyramidPage::new(report, view, rendering.pyramid().count());
        let attributes = metadata(rendering, scene);
        let save = |file: String, technique: &str, pixels: &[[f32; 3]]| {
            let mut picture = Picture::from_rgb(width, height, pixels);
            picture.attributes.clone_from(&attributes);
            picture.attributes.push(("technique".into(), technique.into()));
            Target::plain(&self.folder.join(file))?.write(&picture)
        };
        for found in rendering.pyramid() {
            page.add(width, &found);
            let Some(part) = page.parts().last() else { continue };
            save(weighted(part), &part.name, &found.weighted)?;
            if let Some(file) = unweighted(part) {
                save(file, &part.name, &found.alone)?;
            }
        }
        let files = |part| Files { part, weighted: weighted(part), unweighted: unweighted(part) };
        let listing = Listing {
            scene: &scene.path,
            integrator: &integrator.name,
            parameters,
            samples,
            techniques: page.parts().iter().map(files).collect(),
        };
        state::write(&self.folder.join("pyramid.json"), &listing)?;
        let count = listing.techniques.len();
        let path = self.folder.join("index.html");
        write_atomically(&path, page.finish().as_bytes()).map_err(Failure::other)?;
        console.say(format_args!("wrote {} with {count} techniques", path.display()));
        Ok(())
    }
}

fn weighted(part: &Part) -> String {
    format!("{}-weighted.exr", part.name)
}

/// Techniques taken together have none.
fn unweighted(part: &Part) -> Option<String> {
    part.mean_unweighted.map(|_| format!("{}-unweighted.exr", part.name))
}
