//! The names of the family.

use super::lightcuts::{self, Lightcuts};
use super::{Compensation, Options, Product, VirtualLights};
use crate::integrators::components::Components;
use crate::integrators::parameters::parameter;
use crate::integrators::photon_mapping::declared::{ABSORPTION, EXTENT, MEMORY, REUSE, photons};
use crate::integrators::volpath::common::{HIDE_EMITTERS, MAX_DEPTH, RR_DEPTH};
use crate::integrators::volpath::{self, RR_CAP, depth};
use crate::integrators::{Integrator, IntegratorInfo, ParameterError, ParameterInfo, ParameterKind, Parameters};
use crate::photons::Extent;
use crate::walk::{Media, Rules};

const LIGHTS: ParameterInfo = ParameterInfo {
    name: "lights",
    kind: ParameterKind::Integer,
    default: "64",
    unit: "",
    description: "Virtual lights of each kind that a ray or a surface is connected with, chosen by their power; 0 is all.",
};
const SAMPLES: ParameterInfo = ParameterInfo {
    name: "samples",
    kind: ParameterKind::Integer,
    default: "1",
    unit: "",
    description: "Points on a ray through a medium, and on a ray light, for each pair that is connected.",
};
const PRODUCT: ParameterInfo = ParameterInfo {
    name: "product",
    kind: ParameterKind::Choice(&["auto", "always", "never"]),
    default: "auto",
    unit: "",
    description: "Whether points on ray lights and rays are chosen by phase functions and transmittance too, from a table, or by \
                  their distance alone; auto is where phase functions are uneven or rays optically long.",
};
const LIGHT_SEED: ParameterInfo = ParameterInfo {
    name: "light_seed",
    kind: ParameterKind::Integer,
    default: "-1",
    unit: "",
    description: "Seed of light paths, so that the frames of an animation share them; -1 is the picture's.",
};
const CLAMP: ParameterInfo = ParameterInfo {
    name: "clamp",
    kind: ParameterKind::Float,
    default: "0",
    unit: "1/m^2",
    description: "Bound on one over the squared distance between lights and what they light; 0 is none.",
};
const COMPENSATION: ParameterInfo = ParameterInfo {
    name: "compensation",
    kind: ParameterKind::Choice(&["path", "approximate", "none"]),
    default: "path",
    unit: "",
    description: "Whether paths are traced for the light that `clamp` cuts off (Kollig and Keller 2004), or the lights give it \
                  within media (Engelhardt et al. 2012), or it is missing.",
};
const TRACED: ParameterInfo = parameter(
    "compensation",
    ParameterKind::Choice(&["path", "none"]),
    "path",
    "",
    "Whether paths are traced for the light that `clamp` cuts off (Kollig and Keller 2004), or it is missing.",
);
const RADIUS: ParameterInfo = ParameterInfo {
    name: "radius",
    kind: ParameterKind::Float,
    default: "0",
    unit: "m",
    description: "Radius of the lights in the first pass; 0 is a tenth of the mean length of light's segments in media, for `vbl` a hundredth.",
};

const ERROR: ParameterInfo = parameter(
    "error",
    ParameterKind::Float,
    "0.01",
    "",
    "Clusters are refined until none may give more than this share of the pixel's light: nearly all pixels are within twice of it. 0 joins all lights.",
);
const MAX_CUT: ParameterInfo = parameter(
    "max_cut",
    ParameterKind::Integer,
    "0",
    "",
    "Most pairs of clusters that a pixel is refined to, whatever their bounds, for speed; 0 is no limit.",
);
const PIXEL_SAMPLES: ParameterInfo =
    parameter("samples", ParameterKind::Integer, "4", "", "Camera samples of a pixel in each pass: they share a cut.");
const POINTS: ParameterInfo = parameter(
    "points",
    ParameterKind::Integer,
    "8",
    "",
    "Points at which light is gathered on each stretch of a camera's ray through a dense medium; fewer in thin ones.",
);
const NEARNESS: ParameterInfo = parameter(
    "clamp",
    ParameterKind::Float,
    "-1",
    "1/m^2",
    "Bound on one over the squared distance between lights and what they light; 0 is none, -1 follows from how densely \
     the lights lie.",
);

/// Which lights there are.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Points,
    Spheres,
    Rays,
    Beams,
}

impl Kind {
    /// Whether lights in media are segments rather than vertices.
    fn has_rays(self) -> bool {
        matches!(self, Self::Rays | Self::Beams)
    }

    /// Whether lights have a radius.
    fn has_radius(self) -> bool {
        matches!(self, Self::Spheres | Self::Beams)
    }
}

fn make(parameters: &Parameters, kind: Kind) -> Result<Box<dyn Integrator>, ParameterError> {
    let max_depth = depth(parameters, "max_depth")?;
    let camera_rules = Rules { max_depth, rr_depth: u32::MAX, rr_cap: RR_CAP, media: Media::Attenuate };
    let (rr_depth, rr_cap) = roulette(parameters);
    let from_zero = "a number from 0";
    let components = Components::read(parameters)?;
    let clamp = if kind.has_radius() { 0.0 } else { parameters.number("clamp", |c| c >= 0.0, from_zero)? };
    let compensation = match clamp > 0.0 {
        true => match parameters.text("compensation").as_str() {
            "path" => Compensation::Path,
            "approximate" => Compensation::Approximate,
            _ => Compensation::None,
        },
        false => Compensation::None,
    };
    let product = match kind.has_rays() {
        true => match parameters.text("product").as_str() {
            "always" => Product::Always,
            "never" => Product::Never,
            _ => Product::Automatic,
        },
        false => Product::Never,
    };
    let light_seed = match parameters.integer("light_seed") {
        -1 => None,
        seed => Some(
            u64::try_from(seed).map_err(|_| parameters.out_of_range("light_seed", "-1 or a whole number from 0"))?,
        ),
    };
    let options = Options {
        camera_rules,
        light_rules: Rules { max_depth, rr_depth, rr_cap, media: Media::Scatter },
        photons: parameters.count("photons", 1, "a whole number from 1")?,
        rays: kind.has_rays(),
        extent: if kind.has_rays() && parameters.text("extent") == "long" { Extent::Long } else { Extent::Short },
        lights: parameters.count("lights", 0, "a whole number from 0")?,
        samples: parameters.count("samples", 1, "a whole number from 1")?,
        product,
        clamp,
        compensation,
        radius: match kind.has_radius() {
            true => Some(parameters.number("radius", |r| r >= 0.0, from_zero)?),
            false => None,
        },
        reuse: parameters.count("reuse", 0, "a whole number from 0")?,
        light_seed,
        components,
        memory: usize::try_from(parameters.bytes("memory")).unwrap_or(usize::MAX),
    };
    let given = match compensation {
        Compensation::None => Components::STRAIGHT,
        Compensation::Approximate => Components::STRAIGHT.intersection(Components::MULTIPLE),
        Compensation::Path => Components::NONE,
    };
    let bound = if compensation == Compensation::None { 0.0 } else { clamp };
    let path = volpath::Options::beside(parameters, components.intersection(given.complement()), bound)?;
    Ok(Box::new(VirtualLights::new(options, path)))
}

fn make_lightcuts(parameters: &Parameters) -> Result<Box<dyn Integrator>, ParameterError> {
    let max_depth = depth(parameters, "max_depth")?;
    let (rr_depth, rr_cap) = roulette(parameters);
    let components = Components::read(parameters)?;
    let clamp = parameters.number("clamp", |c| c >= 0.0 || c == -1.0, "-1 or a number from 0")?;
    let compensates = clamp != 0.0 && parameters.text("compensation") == "path";
    let options = lightcuts::Options {
        camera_rules: Rules { max_depth, rr_depth: u32::MAX, rr_cap: RR_CAP, media: Media::Attenuate },
        light_rules: Rules { max_depth, rr_depth, rr_cap, media: Media::Scatter },
        photons: parameters.count("photons", 1, "a whole number from 1")?,
        error: parameters.number("error", |e| e >= 0.0, "a number from 0")?,
        max_cut: parameters.count("max_cut", 0, "a whole number from 0")?,
        samples: parameters.count("samples", 1, "a whole number from 1")?,
        points: parameters.count("points", 1, "a whole number from 1")?,
        clamp: (clamp >= 0.0).then_some(clamp),
        compensates,
        reuse: parameters.count("reuse", 0, "a whole number from 0")?,
        components,
        memory: usize::try_from(parameters.bytes("memory")).unwrap_or(usize::MAX),
    };
    let given = if compensates { Components::NONE } else { Components::STRAIGHT };
    let path = volpath::Options::beside(parameters, components.intersection(given.complement()), clamp.max(0.0))?;
    Ok(Box::new(Lightcuts::new(options, path)))
}

/// When and how roulette ends light paths.
fn roulette(parameters: &Parameters) -> (u32, f32) {
    if parameters.text("absorption") == "weight" { (5, RR_CAP) } else { (0, 1.0) }
}

/// Declares an entry: what all have, and what it has besides.
macro_rules! entry {
    ($name:literal, $summary:literal, $source:literal, $kind:expr, [$($parameter:expr),* $(,)?]) => {
        IntegratorInfo {
            name: $name,
            aliases: &[],
            summary: $summary,
            source: $source,
            parameters: {
                const PARAMETERS: &[ParameterInfo] = &[
                    photons("1000"), LIGHTS, SAMPLES, $($parameter,)* ABSORPTION, REUSE, LIGHT_SEED, Components::PARAMETER,
                    MAX_DEPTH, RR_DEPTH, HIDE_EMITTERS, MEMORY,
                ];
                PARAMETERS
            },
            make: |parameters| make(parameters, $kind),
        }
    };
}

/// The registry's entry of `vpl`.
pub const VPL: IntegratorInfo = entry!(
    "vpl",
    "Virtual point lights: vertices of light paths light surfaces and camera rays.",
    "Keller 1997; Raab, Seibert and Keller 2008; Kollig and Keller 2004; Engelhardt, Novak, Schmidt and Dachsbacher 2012",
    Kind::Points,
    [CLAMP, COMPENSATION]
);

/// The registry's entry of `vsl`.
pub const VSL: IntegratorInfo = entry!(
    "vsl",
    "Progressive virtual spherical lights: point lights with a radius that shrinks from pass to pass.",
    "Hasan, Krivanek, Walter and Bala 2009",
    Kind::Spheres,
    [RADIUS]
);

/// The registry's entry of `vrl`.
pub const VRL: IntegratorInfo = entry!(
    "vrl",
    "Virtual ray lights: segments of light paths in media light surfaces and camera rays.",
    "Novak, Nowrouzezahrai, Dachsbacher and Jarosz 2012",
    Kind::Rays,
    [PRODUCT, EXTENT, CLAMP, COMPENSATION]
);

/// The registry's entry of `vbl`.
pub const VBL: IntegratorInfo = entry!(
    "vbl",
    "Progressive virtual beam lights: ray lights with a radius that shrinks from pass to pass.",
    "Novak, Nowrouzezahrai, Dachsbacher and Jarosz 2012; Hasan, Krivanek, Walter and Bala 2009",
    Kind::Beams,
    [PRODUCT, EXTENT, RADIUS]
);

/// The registry's entry of `lightcuts`.
pub const LIGHTCUTS: IntegratorInfo = IntegratorInfo {
    name: "lightcuts",
    aliases: &[],
    summary: "Multidimensional lightcuts: all virtual point lights at once, in clusters as fine as a pixel needs.",
    source: "Walter, Arbree, Bala and Greenberg 2006; Kollig and Keller 2004",
    parameters: &[
        photons("10000"),
        ERROR,
        MAX_CUT,
        PIXEL_SAMPLES,
        POINTS,
        NEARNESS,
        TRACED,
        ABSORPTION,
        REUSE,
        Components::PARAMETER,
        MAX_DEPTH,
        RR_DEPTH,
        HIDE_EMITTERS,
        MEMORY,
    ],
    make: make_lightcuts,
};
