//! The command line of `tyndall compare`.

use crate::args::{count, crop, duration, pair, positive, seed, size};
use clap::Args;
use std::path::PathBuf;
use std::time::Duration;

/// `tyndall compare`.
#[derive(Debug, Args)]
#[command(
    after_help = "Interrupted at any point, the same command goes on: finished renders are kept in OUTPUT/runs and \
references in OUTPUT/references. Remove a folder there to have it rendered again; failed renders are tried again."
)]
pub(crate) struct Compare {
    /// A scene (.xml), or an experiment (.toml) with scenes, methods and everything else
    #[arg(value_name = "SCENE|EXPERIMENT")]
    pub(crate) source: PathBuf,

    /// The integrators, separated by commas; NAME=INTEGRATOR gives one another name
    #[arg(long, value_name = "NAMES", value_delimiter = ',', help_heading = "Methods")]
    pub(crate) with: Vec<String>,

    /// A parameter of one of them, such as bre.photons=1e6; can be given several times
    #[arg(long, value_name = "METHOD.KEY=VALUE", value_parser = pair, help_heading = "Methods")]
    pub(crate) set: Vec<(String, String)>,

    /// Another renderer; can be given several times
    ///
    /// COMMAND has places: {scene}, {out} (a picture to write, .exr) and {spp} have to be there; {seed}, {threads}, {width},
    /// {height} and {defines} (the scene's variables as -DNAME=VALUE) can be. It is timed as a whole process.
    #[arg(long, value_name = "NAME=COMMAND", value_parser = pair, help_heading = "Methods")]
    pub(crate) external: Vec<(String, String)>,

    /// Equal time: from the start of loading to the last sample [default: 30s]
    #[arg(long, value_name = "DURATION", value_parser = duration, group = "measure", help_heading = "Budget")]
    pub(crate) time: Option<Duration>,

    /// Equal samples per pixel
    #[arg(long, value_name = "N", value_parser = count, group = "measure", help_heading = "Budget")]
    pub(crate) samples: Option<u32>,

    /// Equal error: until the square root of the relMSE against the reference is this small
    #[arg(long, value_name = "ERROR", value_parser = positive, group = "measure", help_heading = "Budget")]
    pub(crate) error: Option<f64>,

    /// With --error, the longest that a render may take; another renderer is ended after ten times its budget in any case
    /// [default: 10m]
    #[arg(long, value_name = "DURATION", value_parser = duration, help_heading = "Budget")]
    pub(crate) limit: Option<Duration>,

    /// Renders of each method, with different seeds [default: 1]
    #[arg(long, value_name = "N", value_parser = count, help_heading = "Budget")]
    pub(crate) repeat: Option<u32>,

    /// What errors are measured against: a picture, `auto` to render one, or `none` [default: auto]
    #[arg(long, value_name = "FILE|auto|none", help_heading = "Reference")]
    pub(crate) reference: Option<String>,

    /// The integrator of an automatic reference [default: volpath, or ppb where volpath warns that it finds light only by
    /// chance]
    #[arg(long, value_name = "NAME", help_heading = "Reference")]
    pub(crate) reference_method: Option<String>,

    /// The longest rendering time of an automatic reference [default: 40 times the budget, or 10m]
    #[arg(long, value_name = "DURATION", value_parser = duration, help_heading = "Reference")]
    pub(crate) reference_limit: Option<Duration>,

    /// Where automatic references are kept [default: OUTPUT/references]
    #[arg(long, value_name = "FOLDER", help_heading = "Reference")]
    pub(crate) reference_cache: Option<PathBuf>,

    /// The value of a `$NAME` in the scene; can be given several times
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = pair, help_heading = "Scene")]
    pub(crate) define: Vec<(String, String)>,

    /// Size of the film in pixels
    #[arg(long, value_name = "WxH", value_parser = size, help_heading = "Scene")]
    pub(crate) size: Option<[u32; 2]>,

    /// A region to look at closely, pixels: left, top, width, height; can be given several times
    #[arg(long, value_name = "X,Y,W,H", value_parser = crop, help_heading = "Scene")]
    pub(crate) inset: Vec<[u32; 4]>,

    /// Seed of the first repeat; the scene's own if not given
    #[arg(long, value_name = "N", value_parser = seed)]
    pub(crate) seed: Option<u64>,

    /// Threads of every method; all processors if not given
    #[arg(long, value_name = "N", value_parser = count)]
    pub(crate) threads: Option<u32>,

    /// Title of the report
    #[arg(long, value_name = "TEXT")]
    pub(crate) title: Option<String>,

    /// Folder of the report [default: report, or the experiment's own]
    #[arg(short, long, value_name = "OUTPUT")]
    pub(crate) output: Option<PathBuf>,

    /// Say nothing but errors
    #[arg(short, long)]
    pub(crate) quiet: bool,
}
