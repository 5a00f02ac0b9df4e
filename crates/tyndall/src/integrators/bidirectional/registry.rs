//! The names of the family.

use super::{Bidirectional, LightTracing, Options};
use crate::integrators::volpath::common::{HIDE_EMITTERS, MAX_DEPTH, RR_DEPTH};
use crate::integrators::volpath::{RR_CAP, depth};
use crate::integrators::{IntegratorInfo, ParameterError, ParameterInfo, Parameters};
use crate::walk::{Media, Rules};

const PARAMETERS: &[ParameterInfo] = &[MAX_DEPTH, RR_DEPTH, HIDE_EMITTERS];

impl Options {
    fn read(parameters: &Parameters) -> Result<Self, ParameterError> {
        let rr_depth = parameters.count("rr_depth", 1, "a whole number from 1")?;
        let max_depth = depth(parameters, "max_depth")?;
        Ok(Self {
            rules: Rules { max_depth, rr_depth, rr_cap: RR_CAP, media: Media::Scatter },
            hide_emitters: parameters.boolean("hide_emitters"),
        })
    }
}

/// The registry's entry of `ptracer`.
pub const PTRACER: IntegratorInfo = IntegratorInfo {
    name: "ptracer",
    aliases: &[],
    summary: "Light tracing: paths from emitters, joined with the lens at surfaces and in media.",
    source: "Dutre, Lafortune and Willems 1993",
    parameters: PARAMETERS,
    make: |parameters| Ok(Box::new(LightTracing::new(Options::read(parameters)?))),
};

/// The registry's entry of `bdpt`.
pub const BDPT: IntegratorInfo = IntegratorInfo {
    name: "bdpt",
    aliases: &[],
    summary: "Bidirectional path tracing: paths from the camera and from emitters, joined in every way.",
    source: "Lafortune and Willems 1993, 1996; Veach and Guibas 1995",
    parameters: PARAMETERS,
    make: |parameters| Ok(Box::new(Bidirectional { options: Options::read(parameters)? })),
};
