//! What can be chosen.

use crate::integrators::volpath::depth;
use crate::integrators::{ParameterError, ParameterInfo, ParameterKind, Parameters};
use crate::math::Kernel;
use crate::walk::{Media, Rules};

/// Largest probability of surviving a turn of the roulette: higher than that of path tracing, since in bright media walks that
/// outlive it count ever more, all vertices of a walk of light with all of the camera's.
const RR_CAP: f32 = 0.99;

/// Ways to find a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::integrators) struct Techniques {
    /// Connections and hits: bidirectional path tracing.
    pub(super) bpt: bool,
    /// Merging of points on surfaces.
    pub(super) surface: bool,
    /// Merging of points in media.
    pub(super) point_point: bool,
    /// Merging of camera beams and points.
    pub(super) beam_point: bool,
    /// Merging of beams.
    pub(super) beam_beam: bool,
}

impl Techniques {
    /// Joining only.
    pub(super) const BPT: Self =
        Self { bpt: true, surface: false, point_point: false, beam_point: false, beam_beam: false };

    /// From names joined by commas.
    fn parse(text: &str) -> Option<Self> {
        let none = Self { bpt: false, ..Self::BPT };
        text.split(',').try_fold(none, |set, name| {
            Some(match name.trim() {
                "bpt" => Self { bpt: true, ..set },
                "surf" => Self { surface: true, ..set },
                "pp3d" => Self { point_point: true, ..set },
                "bp2d" => Self { beam_point: true, ..set },
                "bb1d" => Self { beam_beam: true, ..set },
                _ => return None,
            })
        })
    }

    /// Whether anything is merged.
    pub(super) fn merge(self) -> bool {
        self.surface || self.point_point || self.beam_point || self.beam_beam
    }
}

/// All choices.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrators) struct Options {
    pub(super) rules: Rules,
    pub(super) hide_emitters: bool,
    pub(super) techniques: Techniques,
    /// Light paths that leave points; 0 for one for each pixel.
    pub(super) photons: u32,
    /// Light paths that leave beams; 0 for fewer than points by a fixed share.
    pub(super) beams: u32,
    /// First radii, metres; 0 for automatic ones.
    pub(super) radius: f32,
    pub(super) surface_radius: f32,
    /// Exponent of progressive radii; 0 for the best.
    pub(super) alpha: f32,
    pub(super) kernel: Kernel,
    /// Least share of the camera's walks that go on.
    pub(super) continuation: f32,
    /// Whether two points are sampled jointly as well.
    pub(super) joint: bool,
    pub(super) memory: usize,
}

/// Declarations that the registry puts together.
pub(super) mod declared {
    use super::{ParameterInfo, ParameterKind};
    use crate::integrators::parameters::parameter;

    pub(in super::super) const fn techniques(default: &'static str) -> ParameterInfo {
        parameter(
            "techniques",
            ParameterKind::Text,
            default,
            "",
            "Ways to find a path, joined by commas: bpt (connections and hits), surf, pp3d, bp2d, bb1d (merging on \
             surfaces, of points, of camera beams and points, of beams).",
        )
    }
    pub(in super::super) const PHOTONS: ParameterInfo = parameter(
        "photons",
        ParameterKind::Integer,
        "0",
        "",
        "Light paths of a pass that leave points; 0 is so many that a pixel sees one point: 2 to 8 for each pixel, \
         but no more than 2 where those leave 24 points, at most a million.",
    );
    pub(in super::super) const BEAMS: ParameterInfo = parameter(
        "beams",
        ParameterKind::Integer,
        "0",
        "",
        "Light paths of a pass that leave beams; 0 is a 64th of those that leave points.",
    );
    pub(in super::super) const RADIUS: ParameterInfo = parameter(
        "radius",
        ParameterKind::Float,
        "0",
        "m",
        "First radius of the blur in media; 0 takes the smaller of a tenth of the mean free path and two pixels, where the light is.",
    );
    pub(in super::super) const SURFACE_RADIUS: ParameterInfo = parameter(
        "surface_radius",
        ParameterKind::Float,
        "0",
        "m",
        "First radius of the blur on surfaces; 0 takes two pixels, up to six times as many where little light arrives.",
    );
    pub(in super::super) const ALPHA: ParameterInfo = parameter(
        "alpha",
        ParameterKind::Float,
        "0",
        "",
        "How slowly radii shrink, in (0, 1]; 1 keeps them, 0 takes the best for each blur, 4 / (dimension + 4).",
    );
    pub(in super::super) const CONTINUATION: ParameterInfo = parameter(
        "continuation",
        ParameterKind::Float,
        "0.125",
        "",
        "Least share of the camera's walks that go on from their first vertex; 1 is all. Fewer go on the more has been merged \
         there.",
    );
    pub(in super::super) const MEMORY: ParameterInfo = parameter(
        "memory",
        ParameterKind::Bytes,
        "4G",
        "bytes",
        "Most memory that the light paths of a pass may take.",
    );
}

impl Options {
    /// From the parameters; those that an entry does not declare are not used by it.
    pub(super) fn read(parameters: &Parameters) -> Result<Self, ParameterError> {
        let rr_depth = parameters.count("rr_depth", 1, "a whole number from 1")?;
        let max_depth = depth(parameters, "max_depth")?;
        let mut options = Self {
            rules: Rules { max_depth, rr_depth, rr_cap: RR_CAP, media: Media::Scatter },
            hide_emitters: parameters.boolean("hide_emitters"),
            techniques: Techniques::BPT,
            photons: 0,
            beams: 0,
            radius: 0.0,
            surface_radius: 0.0,
            alpha: 0.0,
            kernel: Kernel::default(),
            continuation: 1.0,
            joint: parameters.declares("joint") && parameters.boolean("joint"),
            memory: usize::MAX,
        };
        if !parameters.declares("techniques") {
            return Ok(options);
        }
        let known = "some of bpt, surf, pp3d, bp2d, bb1d, joined by commas";
        options.techniques = Techniques::parse(&parameters.text("techniques"))
            .ok_or_else(|| parameters.out_of_range("techniques", known))?;
        options.photons = parameters.count("photons", 0, "a whole number from 0")?;
        options.beams = parameters.count("beams", 0, "a whole number from 0")?;
        options.radius = parameters.number("radius", |r| r >= 0.0, "a number from 0")?;
        options.surface_radius = parameters.number("surface_radius", |r| r >= 0.0, "a number from 0")?;
        options.alpha = parameters.number("alpha", |a| (0.0..=1.0).contains(&a), "a number from 0 to 1")?;
        options.continuation =
            parameters.number("continuation", |p| p > 0.0 && p <= 1.0, "a number above 0, up to 1")?;
        options.kernel = Kernel::named(&parameters.text("kernel")).unwrap_or_default();
        options.memory = usize::try_from(parameters.bytes("memory")).unwrap_or(usize::MAX);
        Ok(options)
    }
}
