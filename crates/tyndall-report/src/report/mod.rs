//! A comparison: scenes by methods, as plain data. The page, the tables and `report.json` are made from it.

mod csv;
mod latex;
pub mod page;
mod pictures;
mod pyramid;
mod quantity;

use crate::agreement::Agreement;
use crate::split::Split;
use crate::summary::{Figure, PowerLaw};
pub use csv::csv;
pub use latex::latex;
pub use pictures::{Embedded, Pictures};
pub use pyramid::{Grid, Part, PyramidPage};
pub use quantity::Quantity;
use serde::Serialize;
use std::collections::BTreeMap;

/// A comparison.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Report {
    /// Title.
    pub title: String,
    /// Program and version.
    pub program: String,
    /// When it was written, RFC 3339.
    pub created: String,
    /// What it was made on.
    pub machine: Machine,
    /// What every method was given: `30 s each`.
    pub budget: String,
    /// Renders of each method.
    pub repeats: u32,
    /// The command that makes the report.
    pub command: String,
    /// The scenes.
    pub scenes: Vec<Scene>,
    /// All quantities, for whoever reads the figures.
    pub quantities: Vec<quantity::Description>,
    /// How the methods of each scene lie in a grid, where they are techniques of one picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grid: Option<Grid>,
}

/// What was computed on.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Machine {
    /// Name of the processor, as far as known.
    pub processor: String,
    /// Threads that every method used.
    pub threads: usize,
    /// Operating system and architecture.
    pub system: String,
}

/// A scene with all methods.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Scene {
    /// Name.
    pub name: String,
    /// Its file; empty where pictures are only looked at.
    pub file: String,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Values given to the scene's variables.
    pub variables: Vec<(String, String)>,
    /// What errors are measured against.
    pub reference: Option<Reference>,
    /// The methods.
    pub methods: Vec<Method>,
    /// Regions to look at closely.
    pub insets: Vec<Inset>,
    /// The largest relMSE that all methods came to: what `Quantity::TimeToEqual` is the time to.
    pub equal_error: Option<f64>,
}

/// What errors are measured against.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Reference {
    /// Where it comes from: a file, or a method.
    pub source: String,
    /// The commands that render its halves.
    pub commands: Vec<String>,
    /// Number of its picture on the page.
    pub picture: Option<usize>,
    /// Estimate of its own relMSE.
    pub own_error: Option<f64>,
    /// The relMSE that was aimed at.
    pub aim: Option<f64>,
    /// Samples per pixel of both halves.
    pub samples: Option<u64>,
    /// Rendering time of both halves.
    pub seconds: Option<f64>,
    /// Whether its halves are the same picture.
    pub agreement: Option<Agreement>,
    /// What a reader should know of it.
    pub warnings: Vec<String>,
}

/// A method on a scene.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Method {
    /// Name in the report.
    pub name: String,
    /// Integrator and parameters, or the template of another renderer.
    pub description: String,
    /// Whether it is another renderer, measured as a whole process.
    pub external: bool,
    /// Why there are no figures.
    pub failure: Option<String>,
    /// What a reader should know.
    pub warnings: Vec<String>,
    /// Its renders.
    pub runs: Vec<Run>,
    /// Medians and spreads by the keys of [`Quantity`].
    pub figures: BTreeMap<&'static str, Figure>,
    /// Bias against noise.
    pub split: Option<Split>,
    /// The method against itself with another seed.
    pub agreement: Option<Agreement>,
    /// Errors over time of the first repeat.
    pub curve: Vec<Point>,
    /// relMSE over rendering time as a power law.
    pub slope: Option<PowerLaw>,
    /// Number of its picture on the page.
    pub picture: Option<usize>,
    /// Number of its map of FLIP on the page.
    pub flip: Option<usize>,
}

/// One render.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Run {
    /// From 1.
    pub repeat: u32,
    /// Seed, where the method has one.
    pub seed: Option<u64>,
    /// The command that repeats it.
    pub command: String,
    /// Why it failed.
    pub failure: Option<String>,
    /// Figures by the keys of [`Quantity`].
    pub figures: BTreeMap<&'static str, f64>,
}

/// Errors at a time.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Point {
    /// Since the start, loading included.
    pub seconds: f64,
    /// Of which rendering; for another renderer since the start too.
    pub render_seconds: f64,
    /// Samples per pixel.
    pub samples: u64,
    /// Errors by the keys of [`Quantity`].
    pub errors: BTreeMap<&'static str, f64>,
}

/// A region of a picture, pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Inset {
    /// Left.
    pub x: u32,
    /// Top.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Report {
    /// As JSON, for other programs.
    pub fn json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("plain data with string keys");
        text.push('\n');
        text
    }
}
