//! Parameters that path tracers share.

use crate::integrators::{ParameterInfo, ParameterKind};

/// Longest paths.
pub const MAX_DEPTH: ParameterInfo = ParameterInfo {
    name: "max_depth",
    kind: ParameterKind::Integer,
    default: "-1",
    unit: "",
    description: "Longest paths: 1 is emission seen directly, each real scattering adds one; -1 is no limit.",
};
/// Start of Russian roulette.
pub const RR_DEPTH: ParameterInfo = ParameterInfo {
    name: "rr_depth",
    kind: ParameterKind::Integer,
    default: "5",
    unit: "",
    description: "Russian roulette starts beyond this depth.",
};
/// Invisible emitters.
pub const HIDE_EMITTERS: ParameterInfo = ParameterInfo {
    name: "hide_emitters",
    kind: ParameterKind::Boolean,
    default: "false",
    unit: "",
    description: "Emitters seen directly are black.",
};
