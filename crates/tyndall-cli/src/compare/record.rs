//! What is kept of a render, as `run.json` in its folder. The file is written last: where it is, the render is finished.

use serde::{Deserialize, Serialize};

/// A render that ended.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Record {
    /// Why there is no picture.
    pub(crate) failure: Option<String>,
    /// Seed, where the method has one.
    pub(crate) seed: Option<u64>,
    /// What a person would type.
    pub(crate) command: String,
    /// From the start of loading to the last sample; of another renderer the whole process.
    pub(crate) seconds: f64,
    /// Reading files.
    pub(crate) load: Option<f64>,
    /// Building the scene.
    pub(crate) build: Option<f64>,
    /// Rendering.
    pub(crate) render: Option<f64>,
    /// Samples per pixel.
    pub(crate) samples: u64,
    /// Light paths traced.
    pub(crate) light_paths: u64,
    /// What they left.
    pub(crate) photons: u64,
    /// Peak memory, bytes.
    pub(crate) memory: Option<u64>,
    /// What the render warned of.
    pub(crate) warnings: Vec<String>,
    /// Pictures along the way, the last one included.
    pub(crate) moments: Vec<Moment>,
}

/// A picture at a time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Moment {
    /// In the render's folder.
    pub(crate) file: String,
    /// Samples per pixel.
    pub(crate) samples: u64,
    /// Since the start.
    pub(crate) seconds: f64,
    /// Of which rendering.
    pub(crate) render_seconds: f64,
}

impl Record {
    /// The finished picture's file.
    pub(crate) const PICTURE: &str = "picture.exr";
    /// The record's file.
    pub(crate) const FILE: &str = "run.json";

    /// A render that failed.
    pub(crate) fn failed(message: String, command: String, seed: Option<u64>) -> Self {
        Self { failure: Some(message), command, seed, ..Self::default() }
    }
}
