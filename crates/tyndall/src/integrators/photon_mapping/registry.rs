//! The names of the family.

use super::options::declared::{
    ABSORPTION, ALPHA, BLUR, EXTENT, FINAL_GATHER, FOOTPRINT, JITTER, KERNEL, MEMORY, RADIUS, REUSE, STEPS,
    SURFACE_RADIUS, estimator, neighbours, photons,
};
use super::{Estimator, Options, PhotonMapping};
use crate::integrators::components::Components;
use crate::integrators::volpath::common::{HIDE_EMITTERS, MAX_DEPTH};
use crate::integrators::{Integrator, IntegratorInfo, ParameterError, ParameterInfo, Parameters};

/// Declares an entry: what all have, and what it has besides.
macro_rules! entry {
    ($name:literal, $summary:literal, $source:literal, $photons:literal, $estimator:expr, $progressive:literal,
     [$($parameter:expr),* $(,)?]) => {
        IntegratorInfo {
            name: $name,
            aliases: &[],
            summary: $summary,
            source: $source,
            parameters: {
                const PARAMETERS: &[ParameterInfo] = &[
                    photons($photons), $($parameter,)* RADIUS, SURFACE_RADIUS, BLUR, KERNEL, ABSORPTION,
                    Components::PARAMETER, MAX_DEPTH, HIDE_EMITTERS, MEMORY,
                ];
                PARAMETERS
            },
            make: |parameters| make(parameters, $estimator, $progressive),
        }
    };
}

fn make(
    parameters: &Parameters,
    estimator: Option<Estimator>,
    progressive: bool,
) -> Result<Box<dyn Integrator>, ParameterError> {
    Ok(Box::new(PhotonMapping::new(Options::read(parameters, estimator, progressive)?)))
}

/// The registry's entry of `photonmap`.
pub const PHOTONMAP: IntegratorInfo = entry!(
    "photonmap",
    "Photon mapping: density estimation on surfaces, and in media at points along the ray.",
    "Jensen 1996; Jensen and Christensen 1998",
    "200000",
    Some(Estimator::PointPoint3D),
    false,
    [FINAL_GATHER, STEPS, JITTER, neighbours("0"), REUSE]
);

/// The registry's entry of `vpm`.
pub const VPM: IntegratorInfo = entry!(
    "vpm",
    "Volumetric photon mapping: density estimation at points along the ray.",
    "Jensen and Christensen 1998",
    "200000",
    Some(Estimator::PointPoint3D),
    false,
    [STEPS, JITTER, neighbours("0"), REUSE]
);

/// The registry's entry of `bre`.
pub const BRE: IntegratorInfo = entry!(
    "bre",
    "Beam radiance estimate: all photons along the ray at once.",
    "Jarosz, Zwicker and Jensen 2008",
    "200000",
    Some(Estimator::BeamPoint2D),
    false,
    [neighbours("32"), REUSE]
);

/// The registry's entry of `beams`.
pub const BEAMS: IntegratorInfo = entry!(
    "beams",
    "Photon beams, and every other pair of points and beams.",
    "Jarosz et al. 2011",
    "20000",
    None,
    false,
    [estimator("beam-beam-1d"), EXTENT, FOOTPRINT, STEPS, JITTER, REUSE]
);

/// The registry's entry of `planes`.
pub const PLANES: IntegratorInfo = entry!(
    "planes",
    "Photon planes, with photon beams for what is scattered in a medium once.",
    "Bitterli and Jarosz 2017",
    "5000",
    Some(Estimator::BeamPlane0D),
    false,
    [EXTENT, REUSE]
);

/// The registry's entry of `ppm`.
pub const PPM: IntegratorInfo = entry!(
    "ppm",
    "Progressive photon mapping of surfaces.",
    "Hachisuka et al. 2008; Knaus and Zwicker 2011",
    "200000",
    None,
    true,
    [ALPHA, FINAL_GATHER]
);

/// The registry's entry of `pvpm`.
pub const PVPM: IntegratorInfo = entry!(
    "pvpm",
    "Progressive volumetric photon mapping.",
    "Knaus and Zwicker 2011",
    "200000",
    Some(Estimator::PointPoint3D),
    true,
    [ALPHA, STEPS, JITTER]
);

/// The registry's entry of `pbre`.
pub const PBRE: IntegratorInfo = entry!(
    "pbre",
    "Progressive beam radiance estimate.",
    "Jarosz, Zwicker and Jensen 2008; Knaus and Zwicker 2011",
    "200000",
    Some(Estimator::BeamPoint2D),
    true,
    [ALPHA, neighbours("0")]
);

/// The registry's entry of `ppb`.
pub const PPB: IntegratorInfo = entry!(
    "ppb",
    "Progressive photon beams.",
    "Jarosz et al. 2011",
    "20000",
    None,
    true,
    [ALPHA, estimator("beam-beam-1d"), EXTENT, FOOTPRINT, STEPS, JITTER]
);
