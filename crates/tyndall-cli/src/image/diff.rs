//! `tyndall image diff`: the error of a picture against a reference.

use super::{check_sizes, colours, read};
use crate::console::print;
use crate::failure::Failure;
use crate::output::Target;
use std::path::Path;
use tyndall_formats::image::Picture;
use tyndall_report::flip::{self, PIXELS_PER_DEGREE};
use tyndall_report::metrics::{Metric, peak, psnr};
use tyndall_report::{MetricError, View, hdr_flip};

/// A way to measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Measure {
    /// A mean over values.
    Mean(Metric),
    /// A mean without the worst pixels.
    Robust(Metric),
    /// Peak signal-to-noise ratio, the peak being the largest value of the reference.
    Psnr,
    /// What a viewer sees.
    Flip,
    /// The same at the worst of all exposures.
    HdrFlip,
}

/// All of them by their names.
const MEASURES: [(&str, Measure); 8] = [
    ("relMSE", Measure::Mean(Metric::RelMse)),
    ("robust", Measure::Robust(Metric::RelMse)),
    ("MAPE", Measure::Mean(Metric::Mape)),
    ("SMAPE", Measure::Mean(Metric::Smape)),
    ("MSE", Measure::Mean(Metric::Mse)),
    ("PSNR", Measure::Psnr),
    ("FLIP", Measure::Flip),
    ("HDR-FLIP", Measure::HdrFlip),
];

/// Prints the errors: with one name only the number, for scripts.
pub(super) fn run(picture: &Path, reference: &Path, names: &[String], map: Option<&Path>) -> Result<(), Failure> {
    let measures = names.iter().map(|name| find(name)).collect::<Result<Vec<_>, _>>()?;
    let target = map.map(Target::plain).transpose()?;
    let (a, b) = (read(picture)?, read(reference)?);
    check_sizes((picture, &a), (reference, &b))?;
    let pixels = (colours(picture, &a)?, colours(reference, &b)?);
    let view = |path: &Path, pixels| {
        View::new(a.width, a.height, pixels)
            .map_err(|error| Failure::other(format_args!("{}: {error}", path.display())))
    };
    let (a, b) = (view(picture, &pixels.0)?, view(reference, &pixels.1)?);

    let text = match &measures[..] {
        [one] => format!("{}\n", one.1.of(a, b).map_err(Failure::other)?),
        [] => table(&MEASURES, a, b)?,
        some => table(some, a, b)?,
    };
    if let Some(target) = target {
        let chosen = measures.first().map_or(Measure::Flip, |(_, measure)| *measure);
        let errors = chosen.map(a, b).map_err(Failure::other)?;
        let grey: Vec<[f32; 3]> = errors.into_iter().map(|error| [error as f32; 3]).collect();
        target.write(&Picture::from_rgb(a.width(), a.height(), &grey))?;
    }
    print(&text)
}

fn find(name: &str) -> Result<(&'static str, Measure), Failure> {
    let found = MEASURES.iter().find(|(known, _)| known.eq_ignore_ascii_case(name));
    found.copied().ok_or_else(|| Failure::unknown("metric", name, MEASURES.map(|(known, _)| known)))
}

fn table(measures: &[(&str, Measure)], a: View, b: View) -> Result<String, Failure> {
    let short = |x: f64| if x == 0.0 || (1e-2..1e3).contains(&x) { format!("{x:.4}") } else { format!("{x:.4e}") };
    let line = |(name, measure): &(&str, Measure)| {
        Ok(format!("{name:<9} {}\n", short(measure.of(a, b).map_err(Failure::other)?)))
    };
    measures.iter().map(line).collect()
}

impl Measure {
    fn of(self, a: View, b: View) -> Result<f64, MetricError> {
        match self {
            Self::Mean(metric) => metric.mean(a, b),
            Self::Robust(metric) => metric.robust_mean(a, b),
            Self::Psnr => psnr(a, b, peak(b)),
            Self::HdrFlip => hdr_flip::mean(a, b, PIXELS_PER_DEGREE),
            Self::Flip => flip::mean(a, b, PIXELS_PER_DEGREE),
        }
    }

    /// The error of every pixel.
    fn map(self, a: View, b: View) -> Result<Vec<f64>, MetricError> {
        match self {
            Self::Mean(metric) | Self::Robust(metric) => metric.map(a, b),
            Self::HdrFlip => hdr_flip::map(a, b, PIXELS_PER_DEGREE),
            Self::Psnr => Metric::Mse.map(a, b),
            Self::Flip => flip::map(a, b, PIXELS_PER_DEGREE),
        }
    }
}
