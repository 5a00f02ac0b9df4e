//! The command line.

use crate::compare::Compare;
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;
use std::time::Duration;

/// A renderer for participating media.
#[derive(Debug, Parser)]
#[command(name = "tyndall", version, max_term_width = 100, subcommand_required = true, arg_required_else_help = true)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// What the program can do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Render a scene to a picture
    Render(Box<Render>),
    /// Read a scene without rendering it and say what is in it
    Check(Check),
    /// List the integrators, or describe one of them with its parameters
    Integrators(Integrators),
    /// Compare methods at equal time, equal samples or equal error, and write a report
    Compare(Box<Compare>),
    /// Write a page that shows pictures side by side, and open it
    View(View),
    /// Look at, convert, compare and merge pictures
    #[command(subcommand)]
    Image(Image),
    /// Become a command that ends when the program that started it does
    #[command(hide = true)]
    Leash {
        /// The command
        #[arg(required = true, trailing_var_arg = true, allow_hyphen_values = true)]
        command: Vec<std::ffi::OsString>,
    },
}

/// `tyndall render`.
#[derive(Debug, Args)]
pub(crate) struct Render {
    #[command(flatten)]
    pub(crate) scene: SceneFile,

    /// The algorithm (see `tyndall integrators`); the scene's own if not given
    #[arg(short, long, value_name = "NAME")]
    pub(crate) integrator: Option<String>,

    /// A parameter of the integrator; can be given several times
    #[arg(long, value_name = "KEY=VALUE", value_parser = pair)]
    pub(crate) set: Vec<(String, String)>,

    /// Samples per pixel; the scene's own number if no budget is given
    ///
    /// A pass is one sample per pixel and, where light paths are needed, one new set of them.
    #[arg(long, visible_alias = "passes", value_name = "N", value_parser = count,
          group = "budget", help_heading = "Budget")]
    pub(crate) spp: Option<u32>,

    /// Render for this long: 30s, 5m, 1h30m
    #[arg(long, value_name = "DURATION", value_parser = duration, group = "budget", help_heading = "Budget")]
    pub(crate) time: Option<Duration>,

    /// Render until the estimated relative error is this small, such as 0.02
    #[arg(long, value_name = "ERROR", value_parser = positive, group = "budget", help_heading = "Budget")]
    pub(crate) error: Option<f64>,

    /// Size of the film in pixels
    ///
    /// The horizontal field of view stays, the vertical one follows the new aspect. The scene's crop is dropped.
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub(crate) size: Option<[u32; 2]>,

    /// Render only this part of the film, pixels: left, top, width, height
    #[arg(long, value_name = "X,Y,W,H", value_parser = crop)]
    pub(crate) crop: Option<[u32; 4]>,

    /// Seed of the random numbers; the scene's own if not given
    ///
    /// The same seed gives the same picture, bit for bit.
    #[arg(long, value_name = "N", value_parser = seed)]
    pub(crate) seed: Option<u64>,

    /// Number of threads; all processors if not given
    ///
    /// The picture does not depend on it, bit for bit.
    #[arg(long, value_name = "N", value_parser = count)]
    pub(crate) threads: Option<u32>,

    /// The picture: .exr, .pfm, .hdr or .png; by default the scene's name with .exr, in the current folder
    ///
    /// Beside an .exr lies a .png to look at. An .exr also says how it was made: the scene and its variables, the
    /// integrator and its parameters, seed, samples, seconds and program; only `seconds` differs between equal renders.
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    pub(crate) output: Option<PathBuf>,

    /// Add the variance of every pixel's mean to an .exr, as the layer `variance`
    #[arg(long, help_heading = "Output")]
    pub(crate) variance: bool,

    /// Also write what each technique of a bidirectional method adds to the picture into this folder
    ///
    /// For every technique there is NAME-weighted.exr, its part of the picture, and NAME-unweighted.exr, what it would show
    /// if it were the only one; index.html shows all of them, pyramid.json lists them.
    #[arg(long, value_name = "FOLDER", help_heading = "Output",
          conflicts_with_all = ["checkpoint", "resume", "keep_checkpoint"])]
    pub(crate) pyramid: Option<PathBuf>,

    /// Depth of paths up to which techniques are told apart, 1 to 32 [default: 6]
    ///
    /// 1 is emitted light seen directly. Each technique takes 48 bytes of memory for every pixel.
    #[arg(long, value_name = "N", requires = "pyramid", help_heading = "Output",
          value_parser = clap::value_parser!(u32).range(1..=32))]
    pub(crate) pyramid_depth: Option<u32>,

    #[command(flatten)]
    pub(crate) encoding: Encoding,

    /// Do not write a .png beside an .exr
    #[arg(long, help_heading = "Output")]
    pub(crate) no_preview: bool,

    /// Save the state of the rendering to OUTPUT.checkpoint this often
    ///
    /// It is complete at any moment and removed when the picture is finished.
    #[arg(long, value_name = "DURATION", value_parser = duration, help_heading = "Checkpoints")]
    pub(crate) checkpoint: Option<Duration>,

    /// Continue from OUTPUT.checkpoint if it is there; implies --checkpoint 60s
    ///
    /// The picture becomes bit for bit that of a rendering that was never interrupted. Budget and number of threads may
    /// differ; everything else, files that the scene loads included, has to be as it was.
    #[arg(long, help_heading = "Checkpoints")]
    pub(crate) resume: bool,

    /// Keep the checkpoint of a finished picture: with --resume and a larger budget it goes on from there
    #[arg(long, help_heading = "Checkpoints")]
    pub(crate) keep_checkpoint: bool,

    #[command(flatten)]
    pub(crate) measuring: Measuring,

    /// Say nothing but errors
    #[arg(short, long, conflicts_with = "verbose")]
    pub(crate) quiet: bool,

    /// Say more
    #[arg(short, long)]
    pub(crate) verbose: bool,
}

/// What is measured along the way.
#[derive(Debug, Args)]
#[command(next_help_heading = "Measuring")]
pub(crate) struct Measuring {
    /// Let --time count loading and building the scene as well
    #[arg(long, requires = "time")]
    pub(crate) include_load: bool,

    /// Write times, samples, light paths and peak memory as JSON
    #[arg(long, value_name = "FILE")]
    pub(crate) statistics: Option<PathBuf>,

    /// Keep the picture at doubling times in this folder
    ///
    /// The time that writing takes does not count.
    #[arg(long, value_name = "FOLDER")]
    pub(crate) series: Option<PathBuf>,
}

/// `tyndall check`.
#[derive(Debug, Args)]
pub(crate) struct Check {
    #[command(flatten)]
    pub(crate) scene: SceneFile,
}

/// The scene and its variables.
#[derive(Debug, Args)]
pub(crate) struct SceneFile {
    /// The scene, a Mitsuba XML file
    #[arg(value_name = "SCENE")]
    pub(crate) path: PathBuf,

    /// The value of a `$NAME` in the scene; can be given several times
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = pair)]
    pub(crate) define: Vec<(String, String)>,
}

/// `tyndall integrators`.
#[derive(Debug, Args)]
pub(crate) struct Integrators {
    /// The integrator to describe
    pub(crate) name: Option<String>,

    /// Write the pages of the manual
    #[arg(long)]
    pub(crate) markdown: bool,
}

/// `tyndall view`.
#[derive(Debug, Args)]
pub(crate) struct View {
    /// The pictures; those of one size are shown together
    #[arg(required = true, value_name = "FILE")]
    pub(crate) pictures: Vec<PathBuf>,

    /// A picture that the others are compared with
    #[arg(long, value_name = "FILE")]
    pub(crate) reference: Option<PathBuf>,

    /// The page
    #[arg(short, long, value_name = "FILE", default_value = "view.html")]
    pub(crate) output: PathBuf,

    /// Title of the page
    #[arg(long, value_name = "TEXT")]
    pub(crate) title: Option<String>,

    /// Write the page, do not open it
    #[arg(long)]
    pub(crate) no_open: bool,
}

/// `tyndall image`.
#[derive(Debug, Subcommand)]
pub(crate) enum Image {
    /// Size, layers, range of the values and metadata
    Info {
        /// The picture
        file: PathBuf,
    },
    /// Write a picture in another format, by the ending of OUT: .exr, .pfm, .hdr or .png
    Convert {
        /// The picture to read
        #[arg(value_name = "IN")]
        input: PathBuf,
        /// The picture to write
        #[arg(value_name = "OUT")]
        output: PathBuf,
        #[command(flatten)]
        encoding: Encoding,
    },
    /// Measure the error of a picture against a reference
    Diff {
        /// The picture
        #[arg(value_name = "A")]
        picture: PathBuf,
        /// The reference
        #[arg(value_name = "B")]
        reference: PathBuf,
        /// The error to measure: relMSE, robust (relMSE without the worst 0.1 % of the pixels), MAPE, SMAPE, MSE, PSNR (the
        /// peak is that of B), FLIP or HDR-FLIP; can be given several times, all if not given
        #[arg(long, value_name = "NAME")]
        metric: Vec<String>,
        /// Also write the error of every pixel, grey: of the first metric named, FLIP if none is
        #[arg(short, long, value_name = "FILE")]
        output: Option<PathBuf>,
    },
    /// Average renders of one scene with different seeds, weighted by their samples
    Merge {
        /// The pictures, .exr as `tyndall render` writes them
        #[arg(required = true, num_args = 2.., value_name = "FILE")]
        inputs: Vec<PathBuf>,
        /// The picture to write, .exr
        #[arg(short, long, value_name = "OUT")]
        output: PathBuf,
    },
}

/// How values are encoded.
#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct Encoding {
    /// Brighten the .png by this many stops
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_negative_numbers = true, value_parser = finite)]
    pub(crate) exposure: f32,

    /// Curve of the .png: clamp, reinhard or filmic [default: clamp]
    #[arg(long, value_name = "NAME")]
    pub(crate) tonemap: Option<String>,

    /// Half floats in an .exr
    #[arg(long)]
    pub(crate) half: bool,
}

/// `KEY=VALUE`.
pub(crate) fn pair(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() => Ok((key.trim().to_owned(), value.to_owned())),
        _ => Err("expected NAME=VALUE".into()),
    }
}

/// `640x480`, both positive and no larger than any picture format takes.
pub(crate) fn size(text: &str) -> Result<[u32; 2], String> {
    let fail = || "expected a width and a height from 1 to 65535, such as 640x480".to_owned();
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(fail)?;
    let parse = |word: &str| word.trim().parse::<u16>().ok().filter(|n| *n > 0).map(u32::from).ok_or_else(fail);
    Ok([parse(width)?, parse(height)?])
}

/// `0,0,64,32`.
pub(crate) fn crop(text: &str) -> Result<[u32; 4], String> {
    let fail = |_| "expected left, top, width and height in pixels, such as 16,0,64,32".to_owned();
    let numbers = text.split(',').map(|word| word.trim().parse().map_err(|_| ())).collect::<Result<Vec<u32>, ()>>();
    let crop: [u32; 4] = numbers.and_then(|numbers| numbers.try_into().map_err(|_| ())).map_err(fail)?;
    if crop[2] == 0 || crop[3] == 0 { Err(fail(())) } else { Ok(crop) }
}

pub(crate) fn count(text: &str) -> Result<u32, String> {
    text.parse().ok().filter(|n| *n > 0).ok_or_else(|| "expected a whole number from 1".into())
}

pub(crate) fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| "expected a whole number from 0".into())
}

fn finite(text: &str) -> Result<f32, String> {
    text.parse().ok().filter(|x: &f32| x.is_finite()).ok_or_else(|| "expected a number".into())
}

pub(crate) fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|x: &f64| x.is_finite() && *x > 0.0);
    number.ok_or_else(|| "expected a number above 0, such as 0.02".into())
}

/// Numbers with the units h, m, s or ms, the largest first; a number alone is in seconds.
pub(crate) fn duration(text: &str) -> Result<Duration, String> {
    const UNITS: [(&str, f64); 4] = [("h", 3600.0), ("m", 60.0), ("s", 1.0), ("ms", 1e-3)];
    let fail = || "expected a duration, such as 30s, 5m or 1h30m".to_owned();
    let mut seconds = 0.0;
    let mut rest = text.trim();
    let mut units = &UNITS[..];
    while !rest.is_empty() {
        let digits = rest.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(rest.len());
        let number: f64 = rest[..digits].parse().map_err(|_| fail())?;
        let letters = rest[digits..].find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(rest.len() - digits);
        let unit = match &rest[digits..digits + letters] {
            "" if digits == text.trim().len() => "s",
            unit => unit,
        };
        let index = units.iter().position(|(name, _)| *name == unit).ok_or_else(fail)?;
        seconds += number * units[index].1;
        units = &units[index + 1..];
        rest = &rest[digits + letters..];
    }
    Duration::try_from_secs_f64(seconds).ok().filter(|d| !d.is_zero()).ok_or_else(fail)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn durations() {
        let seconds = |text: &str| duration(text).map(|d| d.as_secs_f64());
        assert_eq!(seconds("30s"), Ok(30.0));
        assert_eq!(seconds("30"), Ok(30.0));
        assert_eq!(seconds("1.5"), Ok(1.5));
        assert_eq!(seconds("1h30m"), Ok(5400.0));
        assert_eq!(seconds("2m5s"), Ok(125.0));
        assert_eq!(seconds("250ms"), Ok(0.25));
        for bad in
            ["", "s", "0s", "-3s", "5 m", "30m1h", "3m20", "1e3", "3 days", "1.2.3s", "1s1s", "9999999999999999999999s"]
        {
            assert!(duration(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn sizes_and_crops() {
        assert_eq!(size("640x480"), Ok([640, 480]));
        for bad in ["640", "0x480", "640x", "x", "-1x4", "640x480x3", "70000x2"] {
            assert!(size(bad).is_err(), "{bad}");
        }
        assert_eq!(crop("1, 2,3,4"), Ok([1, 2, 3, 4]));
        for bad in ["1,2,3", "1,2,0,4", "1,2,3,4,5", "a,2,3,4", "-1,2,3,4", ""] {
            assert!(crop(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn pairs() {
        assert_eq!(pair("a=b=c"), Ok(("a".into(), "b=c".into())));
        assert_eq!(pair("a="), Ok(("a".into(), String::new())));
        assert!(pair("=b").is_err() && pair("a").is_err());
    }
}
