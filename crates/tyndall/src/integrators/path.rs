//! `path` and `direct`: surfaces only.

use super::volpath::{Options, Volpath, common};
use super::{IntegratorInfo, ParameterInfo};
use crate::scene::Scene;

const PARAMETERS: &[ParameterInfo] = &[common::MAX_DEPTH, common::RR_DEPTH, common::HIDE_EMITTERS];

/// The registry's entry of `path`.
pub const PATH: IntegratorInfo = IntegratorInfo {
    name: "path",
    aliases: &[],
    summary: "Path tracing of surfaces; media are ignored.",
    source: "Kajiya 1986; Veach and Guibas 1995",
    parameters: PARAMETERS,
    make: |parameters| Ok(Box::new(Volpath::new(Options::read(parameters, false)?))),
};

/// The registry's entry of `direct`.
pub const DIRECT: IntegratorInfo = IntegratorInfo {
    name: "direct",
    aliases: &[],
    summary: "Emission and direct light of surfaces; media are ignored.",
    source: "Veach and Guibas 1995",
    parameters: &[common::HIDE_EMITTERS],
    make: |parameters| Ok(Box::new(Volpath::new(Options::direct(parameters)))),
};

/// What a user of a scene with media should know.
pub(super) fn warnings(scene: &Scene) -> Vec<String> {
    if scene.media().is_empty() {
        return Vec::new();
    }
    vec![format!("this integrator ignores the scene's media ({}); `volpath` renders them", scene.media().len())]
}
