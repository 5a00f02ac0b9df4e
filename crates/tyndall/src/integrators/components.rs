//! The parts of light transport that an integrator can be asked for.
//!
//! A path is sorted by what the camera sees first, smooth mirrors and glass apart: an emitter, a surface or a medium;
//! and by how light came there.

use super::{ParameterError, ParameterInfo, ParameterKind, Parameters};

/// A set of parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Components(u32);

impl Components {
    /// Emitters seen directly or over smooth mirrors and glass.
    pub const EMITTED: Self = Self(1);
    /// A surface lit straight by an emitter.
    pub const DIRECT: Self = Self(2);
    /// A surface lit over other surfaces or media.
    pub const INDIRECT: Self = Self(4 | 64);
    /// A surface lit over smooth mirrors and glass.
    pub const CAUSTIC: Self = Self(8);
    /// A medium lit straight, or over smooth mirrors and glass.
    pub const SINGLE: Self = Self(16);
    /// A medium lit over surfaces or media.
    pub const MULTIPLE: Self = Self(32 | 128);
    /// What of indirect light and multiple scattering goes straight from the last scattering but one to the last, rather
    /// than over smooth mirrors and glass: light that an edge can connect.
    pub(super) const STRAIGHT: Self = Self(4 | 32);
    /// Nothing.
    pub const NONE: Self = Self(0);
    /// Everything.
    pub const ALL: Self = Self(255);

    /// Every part with its name.
    pub const NAMES: [(&'static str, Self); 6] = [
        ("emitted", Self::EMITTED),
        ("direct", Self::DIRECT),
        ("indirect", Self::INDIRECT),
        ("caustic", Self::CAUSTIC),
        ("single", Self::SINGLE),
        ("multiple", Self::MULTIPLE),
    ];

    /// The parameter that names them.
    pub const PARAMETER: ParameterInfo = ParameterInfo {
        name: "components",
        kind: ParameterKind::Text,
        default: "all",
        unit: "",
        description: "Parts of the transport to render, joined by +: emitted, direct, indirect, caustic, single, multiple.",
    };

    /// Whether a part of `other` is in the set.
    #[inline(always)]
    pub fn has(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// Both sets.
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// The parts of both.
    pub fn intersection(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    /// The parts not in the set.
    pub fn complement(self) -> Self {
        Self(Self::ALL.0 & !self.0)
    }

    /// From names joined by `+`, or `all`.
    pub fn parse(text: &str) -> Option<Self> {
        if text == "all" {
            return Some(Self::ALL);
        }
        let find = |name: &str| Self::NAMES.iter().find(|(known, _)| *known == name.trim()).map(|(_, part)| *part);
        text.split('+').try_fold(Self::NONE, |set, name| Some(set.union(find(name)?)))
    }

    /// From the parameter.
    pub(super) fn read(parameters: &Parameters) -> Result<Self, ParameterError> {
        Self::parse(&parameters.text("components")).ok_or_else(|| {
            parameters.out_of_range(
                "components",
                "all, or some of emitted, direct, indirect, caustic, single, multiple, joined by +",
            )
        })
    }
}

/// How a camera's walk has gone, as far as it decides about components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum History {
    /// Over smooth mirrors and glass.
    Specular,
    /// From a surface, ...
    Surface,
    /// ... then over smooth mirrors and glass.
    SurfaceSpecular,
    /// From a surface, then scattered again, ...
    SurfaceScattered,
    /// ... with smooth mirrors and glass between.
    SurfaceSpecularScattered,
    /// From a medium, ...
    Medium,
    /// ... then over smooth mirrors and glass.
    MediumSpecular,
    /// From a medium, then scattered again, ...
    MediumScattered,
    /// ... with smooth mirrors and glass between.
    MediumSpecularScattered,
}

impl History {
    /// At the camera.
    pub(super) const START: Self = Self::Specular;

    /// Goes on from a vertex `in_medium` or on a surface, by a `delta` distribution or not.
    #[inline(always)]
    pub(super) fn scatter(&mut self, in_medium: bool, delta: bool) {
        *self = match (*self, delta) {
            (Self::Specular, true) => Self::Specular,
            (Self::Specular, false) if in_medium => Self::Medium,
            (Self::Specular, false) => Self::Surface,
            (Self::Surface | Self::SurfaceSpecular, true) => Self::SurfaceSpecular,
            (Self::Surface, false) => Self::SurfaceScattered,
            (Self::SurfaceSpecular, false) => Self::SurfaceSpecularScattered,
            (Self::Medium | Self::MediumSpecular, true) => Self::MediumSpecular,
            (Self::Medium, false) => Self::MediumScattered,
            (Self::MediumSpecular, false) => Self::MediumSpecularScattered,
            (scattered, _) => scattered,
        };
    }

    /// The component of an emitter found now.
    #[inline(always)]
    pub(super) fn ends_at_emitter(self) -> Components {
        match self {
            Self::Specular => Components::EMITTED,
            Self::Surface => Components::DIRECT,
            Self::SurfaceSpecular => Components::CAUSTIC,
            Self::SurfaceScattered => Components(4),
            Self::SurfaceSpecularScattered => Components(64),
            Self::Medium | Self::MediumSpecular => Components::SINGLE,
            Self::MediumScattered => Components(32),
            Self::MediumSpecularScattered => Components(128),
        }
    }

    /// Whether the last vertex was the first one that is no smooth mirror or glass.
    #[inline(always)]
    pub(super) fn leaves_first(self) -> bool {
        matches!(self, Self::Surface | Self::Medium)
    }

    /// The component of light that comes straight from an emitter to the next vertex, `in_medium` or on a surface.
    #[inline(always)]
    pub(super) fn lit_straight(mut self, in_medium: bool) -> Components {
        self.scatter(in_medium, false);
        self.ends_at_emitter()
    }

    /// The components that the walk may still find.
    #[inline(always)]
    pub(super) fn reachable(self) -> Components {
        match self {
            Self::Specular => Components::ALL,
            Self::Surface => Components(2 | 4 | 8 | 64),
            Self::SurfaceSpecular => Components(8 | 64),
            Self::Medium => Components(16 | 32 | 128),
            Self::MediumSpecular => Components(16 | 128),
            scattered => scattered.ends_at_emitter(),
        }
    }
}

impl std::fmt::Display for Components {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let names: Vec<_> = Self::NAMES.iter().filter(|(_, part)| self.has(*part)).map(|(name, _)| *name).collect();
        f.write_str(&names.join("+"))
    }
}
