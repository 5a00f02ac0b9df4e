//! What a rendering took, as numbers for other programs.

use serde::{Deserialize, Serialize};

/// A rendering in numbers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Statistics {
    /// Name of the integrator.
    pub(crate) integrator: String,
    /// All its parameters.
    pub(crate) parameters: String,
    /// Seed of the random numbers.
    pub(crate) seed: u64,
    /// Threads in use.
    pub(crate) threads: usize,
    /// Samples per pixel.
    pub(crate) samples: u32,
    /// Reading files.
    pub(crate) load_seconds: f64,
    /// Building the scene from what was read.
    pub(crate) build_seconds: f64,
    /// Rendering, without pauses; across interruptions.
    pub(crate) render_seconds: f64,
    /// Light paths traced by this process.
    pub(crate) light_paths: u64,
    /// Points, beams and planes that they left.
    pub(crate) photons: u64,
    /// Edges between lights and what they light, where their number is the method's choice (`lightcuts`), ...
    #[serde(default)]
    pub(crate) connections: u64,
    /// ... and how often a pixel in a pass would have needed more than allowed.
    #[serde(default)]
    pub(crate) capped: u64,
    /// Samples that were not finite.
    pub(crate) non_finite: u64,
    /// Most memory that this process had at once, bytes; where the system tells.
    pub(crate) peak_memory: Option<u64>,
    /// Whether it ended before its budget.
    pub(crate) interrupted: bool,
    /// Pictures kept along the way.
    pub(crate) series: Vec<Moment>,
}

/// A picture kept along the way.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Moment {
    /// Its file, in the folder of the series.
    pub(crate) file: String,
    /// Samples per pixel.
    pub(crate) samples: u32,
    /// Rendering time until then.
    pub(crate) render_seconds: f64,
}

/// Most memory that a process had at once, bytes: this one, or another by its number. Known on Linux.
///
/// The kernel's own figure for finished children is of no use: it begins with the memory of the parent.
pub(crate) fn peak_memory(process: Option<u32>) -> Option<u64> {
    let process = process.map_or("self".into(), |id| id.to_string());
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}

#[cfg(test)]
mod tests {
    use super::Statistics;

    /// Comparisons begun by an earlier program go on.
    #[test]
    fn statistics_from_before_connections_were_counted_are_read() {
        let mut old = serde_json::to_value(Statistics { samples: 3, ..Statistics::default() }).unwrap();
        let fields = old.as_object_mut().unwrap();
        assert!(fields.remove("connections").is_some() && fields.remove("capped").is_some());
        let read: Statistics = serde_json::from_value(old).unwrap();
        assert_eq!(read, Statistics { samples: 3, ..Statistics::default() });
    }
}
