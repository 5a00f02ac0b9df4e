//! What can be chosen.

use crate::integrators::components::Components;
use crate::integrators::volpath::{RR_CAP, depth};
use crate::integrators::{ParameterError, ParameterInfo, ParameterKind, Parameters};
use crate::math::Kernel;
use crate::photons::Extent;
use crate::scene::Scene;
use crate::walk::{Media, Rules};

/// How light in media is gathered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "each is documented at its estimator")]
pub(in crate::integrators) enum Estimator {
    PointPoint3D,
    BeamPoint2D,
    BeamPoint3D,
    PointBeam3D,
    PointBeam2D,
    BeamBeam3D,
    BeamBeam2DAboutBeam,
    BeamBeam2DAboutQuery,
    BeamBeam1D,
    BeamPlane0D,
}

impl Estimator {
    /// Names, as the parameter has them.
    pub(in crate::integrators) const NAMES: [&'static str; 10] = [
        "point-point-3d",
        "beam-point-2d",
        "beam-point-3d",
        "point-beam-3d",
        "point-beam-2d",
        "beam-beam-3d",
        "beam-beam-2d-beam",
        "beam-beam-2d-query",
        "beam-beam-1d",
        "beam-plane-0d",
    ];

    const ALL: [Self; 10] = [
        Self::PointPoint3D,
        Self::BeamPoint2D,
        Self::BeamPoint3D,
        Self::PointBeam3D,
        Self::PointBeam2D,
        Self::BeamBeam3D,
        Self::BeamBeam2DAboutBeam,
        Self::BeamBeam2DAboutQuery,
        Self::BeamBeam1D,
        Self::BeamPlane0D,
    ];

    fn named(name: &str) -> Option<Self> {
        Self::NAMES.iter().position(|known| *known == name).map(|i| Self::ALL[i])
    }

    /// Whether light leaves points.
    pub(super) fn uses_points(self) -> bool {
        matches!(self, Self::PointPoint3D | Self::BeamPoint2D | Self::BeamPoint3D)
    }

    /// Whether light leaves beams.
    pub(super) fn uses_beams(self) -> bool {
        !self.uses_points()
    }

    /// Dimension of the blur; with planes that of the beams beside them.
    pub(super) fn blur(self) -> u32 {
        match self {
            Self::PointPoint3D | Self::BeamPoint3D | Self::PointBeam3D | Self::BeamBeam3D => 3,
            Self::BeamPoint2D | Self::PointBeam2D | Self::BeamBeam2DAboutBeam | Self::BeamBeam2DAboutQuery => 2,
            Self::BeamBeam1D | Self::BeamPlane0D => 1,
        }
    }
}

/// Which radius a photon point has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::integrators) enum Selection {
    /// All the same.
    Fixed,
    /// By the density around the photon: about so many others lie within.
    Neighbours(u32),
    /// By the density around the query: the distance of its k-th nearest photon.
    Nearest(u32),
}

/// All choices.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrators) struct Options {
    /// Rules of the camera's walk.
    pub(super) camera_rules: Rules,
    /// Rules of light's walk.
    pub(super) light_rules: Rules,
    pub(super) hide_emitters: bool,
    /// Light paths of a set.
    pub(super) photons: u32,
    /// How media are gathered; `None`: not at all.
    pub(super) estimator: Option<Estimator>,
    pub(super) kernel: Kernel,
    /// First radii, metres; 0 for automatic ones.
    pub(super) radius: f32,
    pub(super) surface_radius: f32,
    /// Factor of automatic radii.
    pub(super) blur: f32,
    pub(super) selection: Selection,
    pub(super) extent: Extent,
    /// Overlap of beams whose width follows from their neighbours' (photon differentials); 0 for the same width.
    pub(super) footprint: f32,
    /// Marching: steps on a segment, and whether they are jittered.
    pub(super) steps: u32,
    pub(super) jitter: bool,
    /// Exponent of progressive radii, 0 for the best; `None`: radii stay.
    pub(super) alpha: Option<f32>,
    /// Passes that share a set of light paths; 0: all.
    pub(super) reuse: u32,
    pub(super) final_gather: bool,
    pub(super) components: Components,
    pub(super) memory: usize,
}

/// Declarations that the registry puts together.
pub(in crate::integrators) mod declared {
    use super::*;
    use crate::integrators::parameters::parameter;
    use ParameterKind::{Boolean, Bytes, Choice, Float, Integer};

    pub(in crate::integrators) const fn photons(default: &'static str) -> ParameterInfo {
        parameter("photons", Integer, default, "", "Light paths of a set.")
    }
    pub(in crate::integrators) const RADIUS: ParameterInfo =
        parameter("radius", Float, "0", "m", "Radius of the blur in media; 0 follows from the density of the light.");
    pub(in crate::integrators) const SURFACE_RADIUS: ParameterInfo = parameter(
        "surface_radius",
        Float,
        "0",
        "m",
        "Radius of the blur on surfaces; 0 follows from the density of the light.",
    );
    pub(in crate::integrators) const BLUR: ParameterInfo =
        parameter("blur", Float, "1", "", "Factor of the radii that follow from the density of the light.");
    pub(in crate::integrators) const KERNEL: ParameterInfo = parameter(
        "kernel",
        Choice(&["constant", "epanechnikov", "biweight"]),
        "epanechnikov",
        "",
        "Shape of the blur.",
    );
    pub(in crate::integrators) const ABSORPTION: ParameterInfo = parameter(
        "absorption",
        Choice(&["analogue", "weight"]),
        "analogue",
        "",
        "Whether absorption ends light paths, which keeps their flux equal, or lowers their flux.",
    );
    pub(in crate::integrators) const REUSE: ParameterInfo =
        parameter("reuse", Integer, "1", "", "Passes that share a set of light paths; 0 is all.");
    pub(in crate::integrators) const ALPHA: ParameterInfo = parameter(
        "alpha",
        Float,
        "0",
        "",
        "How slowly the radius shrinks, in (0, 1); 0 takes the best for the blur's dimension, 4 / (dimension + 4).",
    );
    pub(in crate::integrators) const fn neighbours(default: &'static str) -> ParameterInfo {
        parameter(
            "neighbours",
            Integer,
            default,
            "",
            "Photons within a radius, which adapts it to their density; 0 takes one radius for all.",
        )
    }
    pub(in crate::integrators) const EXTENT: ParameterInfo = parameter(
        "extent",
        Choice(&["short", "long"]),
        "short",
        "",
        "Whether beams end with the flight that was sampled or run on to the next surface.",
    );
    pub(in crate::integrators) const FOOTPRINT: ParameterInfo = parameter(
        "footprint",
        Float,
        "0",
        "",
        "Width of beams in units of their distance to their neighbours (photon differentials), up to the radius; 0 gives \
         all the radius.",
    );
    pub(in crate::integrators) const STEPS: ParameterInfo =
        parameter("steps", Integer, "32", "", "Points on each stretch of a ray inside a medium.");
    pub(in crate::integrators) const JITTER: ParameterInfo =
        parameter("jitter", Boolean, "true", "", "Whether the points of a ray are shifted at random; else they band.");
    pub(in crate::integrators) const FINAL_GATHER: ParameterInfo = parameter(
        "final_gather",
        Boolean,
        "false",
        "",
        "Whether indirect light of surfaces is gathered one bounce farther away.",
    );
    pub(in crate::integrators) const MEMORY: ParameterInfo =
        parameter("memory", Bytes, "4G", "bytes", "Most memory that light paths may take.");
    pub(in crate::integrators) const fn estimator(default: &'static str) -> ParameterInfo {
        parameter("estimator", Choice(&Estimator::NAMES), default, "", "Query, data and dimension of the blur.")
    }
}

impl Options {
    /// From the parameters; those that an entry does not declare take the value that `given` answers with.
    pub(super) fn read(
        parameters: &Parameters,
        estimator: Option<Estimator>,
        progressive: bool,
    ) -> Result<Self, ParameterError> {
        let has = |name| parameters.declares(name);
        let max_depth = depth(parameters, "max_depth")?;
        let weighted = parameters.text("absorption") == "weight";
        let rules = Rules { max_depth, rr_depth: u32::MAX, rr_cap: RR_CAP, media: Media::Attenuate };
        let light = if weighted { (5, RR_CAP) } else { (0, 1.0) };
        let positive_or_zero = "a number from 0";
        let neighbours =
            if has("neighbours") { parameters.count("neighbours", 0, "a whole number from 0")? } else { 0 };
        Ok(Self {
            camera_rules: rules,
            light_rules: Rules { rr_depth: light.0, rr_cap: light.1, media: Media::Scatter, ..rules },
            hide_emitters: parameters.boolean("hide_emitters"),
            photons: parameters.count("photons", 1, "a whole number from 1")?,
            estimator: if has("estimator") { Estimator::named(&parameters.text("estimator")) } else { estimator },
            kernel: Kernel::named(&parameters.text("kernel")).unwrap_or_default(),
            radius: parameters.number("radius", |r| r >= 0.0, positive_or_zero)?,
            surface_radius: parameters.number("surface_radius", |r| r >= 0.0, positive_or_zero)?,
            blur: parameters.number("blur", |b| b > 0.0, "a number above 0")?,
            selection: match neighbours {
                0 => Selection::Fixed,
                k if estimator == Some(Estimator::PointPoint3D) => Selection::Nearest(k),
                k => Selection::Neighbours(k),
            },
            extent: if has("extent") && parameters.text("extent") == "long" { Extent::Long } else { Extent::Short },
            footprint: match has("footprint") {
                true => parameters.number("footprint", |f| f >= 0.0, positive_or_zero)?,
                false => 0.0,
            },
            steps: if has("steps") { parameters.count("steps", 1, "a whole number from 1")? } else { 1 },
            jitter: !has("jitter") || parameters.boolean("jitter"),
            alpha: match progressive {
                true => Some(parameters.number("alpha", |a| (0.0..1.0).contains(&a), "a number from 0 to below 1")?),
                false => None,
            },
            reuse: if has("reuse") { parameters.count("reuse", 0, "a whole number from 0")? } else { 1 },
            final_gather: has("final_gather") && parameters.boolean("final_gather"),
            components: Components::read(parameters)?,
            memory: usize::try_from(parameters.bytes("memory")).unwrap_or(usize::MAX),
        })
    }

    /// Whether photons on surfaces are wanted.
    pub(super) fn gathers_on_surfaces(&self) -> bool {
        self.components.has(Components::INDIRECT.union(Components::CAUSTIC))
    }

    /// What a user should know.
    pub(super) fn warnings(&self, scene: &Scene) -> Vec<String> {
        let in_media = self.components.has(Components::SINGLE.union(Components::MULTIPLE));
        let media = scene.media().len();
        match self.estimator {
            _ if media == 0 || !in_media => Vec::new(),
            None => vec![format!("this integrator shows no light scattered in the scene's media ({media})")],
            Some(Estimator::BeamPlane0D) if media > 1 => vec![
                "photon planes lose light that crosses from one medium into another between its last two scatterings"
                    .to_string(),
            ],
            Some(_) => Vec::new(),
        }
    }
}
