//! The names of the family.

use super::options::declared::{ALPHA, BEAMS, CONTINUATION, MEMORY, PHOTONS, RADIUS, SURFACE_RADIUS, techniques};
use super::{Bidirectional, LightTracing, Options};
use crate::integrators::photon_mapping::declared::KERNEL;
use crate::integrators::volpath::common::{HIDE_EMITTERS, MAX_DEPTH, RR_DEPTH};
use crate::integrators::volpath::joint::JOINT;
use crate::integrators::{IntegratorInfo, ParameterInfo};

const PARAMETERS: &[ParameterInfo] = &[MAX_DEPTH, RR_DEPTH, HIDE_EMITTERS];

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
    parameters: &[MAX_DEPTH, RR_DEPTH, HIDE_EMITTERS, JOINT],
    make: |parameters| Ok(Box::new(Bidirectional::new(Options::read(parameters)?))),
};

/// The registry's entry of `vcm`.
pub const VCM: IntegratorInfo = IntegratorInfo {
    name: "vcm",
    aliases: &[],
    summary: "Vertex connection and merging: bidirectional path tracing and progressive photon mapping of surfaces.",
    source: "Georgiev et al. 2012; Hachisuka, Pantaleoni and Jensen 2012",
    parameters: &[
        techniques("bpt,surf"),
        PHOTONS,
        BEAMS,
        RADIUS,
        SURFACE_RADIUS,
        ALPHA,
        KERNEL,
        CONTINUATION,
        MAX_DEPTH,
        RR_DEPTH,
        HIDE_EMITTERS,
        MEMORY,
    ],
    make: |parameters| Ok(Box::new(Bidirectional::new(Options::read(parameters)?))),
};

/// The registry's entry of `upbp`.
pub const UPBP: IntegratorInfo = IntegratorInfo {
    name: "upbp",
    aliases: &[],
    summary: "Unified points, beams and paths: bidirectional path tracing and merging on surfaces and in media.",
    source: "Krivanek et al. 2014",
    parameters: &[
        techniques("bpt,surf,pp3d,bp2d,bb1d"),
        PHOTONS,
        BEAMS,
        RADIUS,
        SURFACE_RADIUS,
        ALPHA,
        KERNEL,
        CONTINUATION,
        MAX_DEPTH,
        RR_DEPTH,
        HIDE_EMITTERS,
        MEMORY,
    ],
    make: |parameters| Ok(Box::new(Bidirectional::new(Options::read(parameters)?))),
};
