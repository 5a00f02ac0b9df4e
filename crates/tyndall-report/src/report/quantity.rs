//! What is measured of a render: the one list of names, units and which way is better.

use serde::Serialize;

/// A measured quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "`describe` says what each is")]
pub enum Quantity {
    RelMse,
    RobustRelMse,
    Mape,
    Smape,
    Psnr,
    Flip,
    HdrFlip,
    Seconds,
    Load,
    Build,
    Render,
    TimeToEqual,
    Efficiency,
    Samples,
    SampleRate,
    LightPaths,
    Photons,
    PhotonRate,
    Memory,
}

/// A quantity for readers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Description {
    /// Key in files.
    pub key: &'static str,
    /// Heading.
    pub label: &'static str,
    /// Unit; empty for pure numbers.
    pub unit: &'static str,
    /// What it is, one sentence.
    pub meaning: &'static str,
    /// `low` or `high` where one is better.
    pub better: Option<&'static str>,
}

impl Quantity {
    /// All of them, in the order of tables.
    pub const ALL: [Self; 19] = [
        Self::RelMse,
        Self::RobustRelMse,
        Self::Mape,
        Self::Smape,
        Self::Psnr,
        Self::Flip,
        Self::HdrFlip,
        Self::Efficiency,
        Self::TimeToEqual,
        Self::Seconds,
        Self::Load,
        Self::Build,
        Self::Render,
        Self::Samples,
        Self::SampleRate,
        Self::LightPaths,
        Self::Photons,
        Self::PhotonRate,
        Self::Memory,
    ];

    /// The errors that are followed over time.
    pub const OVER_TIME: [Self; 4] = [Self::RelMse, Self::RobustRelMse, Self::Mape, Self::Smape];

    /// Key in files.
    pub fn key(self) -> &'static str {
        self.describe().key
    }

    /// What it is.
    pub fn describe(self) -> Description {
        let (low, high) = (Some("low"), Some("high"));
        let (key, label, unit, better, meaning) = match self {
            Self::RelMse => ("relmse", "relMSE", "", low, "mean of (I - R)\u{b2} / (R\u{b2} + 0.001)"),
            Self::RobustRelMse => {
                ("robust_relmse", "relMSE, robust", "", low, "relMSE without the worst 0.1 % of the pixels")
            }
            Self::Mape => ("mape", "MAPE", "", low, "mean of |I - R| / (|R| + 0.01)"),
            Self::Smape => ("smape", "SMAPE", "", low, "mean of |I - R| / (|I| + |R| + 0.01)"),
            Self::Psnr => (
                "psnr",
                "PSNR",
                "dB",
                high,
                "peak signal-to-noise ratio, the peak being the largest value of the reference",
            ),
            Self::Flip => (
                "flip",
                "FLIP",
                "",
                low,
                "what a viewer sees on a screen when the pictures alternate (Andersson et al. 2020)",
            ),
            Self::HdrFlip => {
                ("hdr_flip", "HDR-FLIP", "", low, "FLIP at the worst of all exposures (Andersson et al. 2021)")
            }
            Self::Seconds => ("seconds", "time", "s", low, "from the start of loading to the last sample"),
            Self::Load => ("load_seconds", "load", "s", low, "reading the scene's files"),
            Self::Build => ("build_seconds", "build", "s", low, "building the scene from what was read"),
            Self::Render => ("render_seconds", "render", "s", None, "rendering alone"),
            Self::TimeToEqual => (
                "time_to_equal",
                "equal error after",
                "s",
                low,
                "time to the largest relMSE that all methods of the scene came to",
            ),
            Self::Efficiency => ("efficiency", "efficiency", "1/s", high, "1 / (relMSE \u{d7} time)"),
            Self::Samples => ("samples", "samples", "per pixel", None, "camera samples per pixel"),
            Self::SampleRate => ("sample_rate", "sample rate", "1/s", None, "camera samples per second of rendering"),
            Self::LightPaths => ("light_paths", "light paths", "", None, "light paths traced"),
            Self::Photons => {
                ("photons", "photons", "", None, "points, beams, planes and vertices that light paths left")
            }
            Self::PhotonRate => ("photon_rate", "photon rate", "1/s", None, "photons per second of rendering"),
            Self::Memory => ("memory", "memory", "B", low, "peak resident memory of the process"),
        };
        Description { key, label, unit, meaning, better }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_unique() {
        let mut keys: Vec<&str> = Quantity::ALL.iter().map(|q| q.key()).collect();
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), Quantity::ALL.len());
    }
}
