//! Cameras.

use super::Reader;
use super::properties::Bag;
use super::source::SceneError;
use super::xml::Node;
use tyndall::math::Transform;
use tyndall::scene::desc::{SamplerDesc, SensorDesc, SensorKind};

const KNOWN: &[&str] = &["perspective", "thinlens", "orthographic"];
const UNSUPPORTED: &[&str] = &[
    "distant",
    "irradiancemeter",
    "radiancemeter",
    "batch",
    "telecentric",
    "perspective_rdist",
    "spherical",
    "fluencemeter",
];
const SAMPLERS: &[&str] =
    &["independent", "stratified", "multijitter", "orthogonal", "ldsampler", "halton", "hammersley", "sobol"];

impl<'t> Reader<'t> {
    /// The scene's first sensor with its film and sampler.
    pub(super) fn sensors(&mut self, scene: &Bag<'t>) -> Result<(), SceneError> {
        let sensors = scene.children("sensor");
        match sensors.as_slice() {
            [] => self.warn(&scene.node.place, "no sensor: the default camera stands at the origin and looks along +z"),
            [_] => {}
            [_, (second, _), ..] => self.warn(&second.place, "further sensors are ignored: the first one is used"),
        }
        for (number, (_, node)) in sensors.into_iter().enumerate() {
            let kept = (self.scene.film, self.scene.sampler);
            let sensor = self.sensor(node)?;
            if number == 0 {
                self.scene.sensor = sensor;
            } else {
                (self.scene.film, self.scene.sampler) = kept;
            }
        }
        Ok(())
    }

    fn sensor(&mut self, node: &'t Node) -> Result<SensorDesc, SceneError> {
        let bag = self.open(node)?;
        if !KNOWN.contains(&bag.plugin) {
            return Err(bag.unknown(KNOWN, UNSUPPORTED));
        }
        if let Some(film) = bag.child("film")? {
            self.scene.film = self.film(film)?;
        }
        if let Some(sampler) = bag.child("sampler")? {
            self.scene.sampler = self.sampler(sampler)?;
        }
        let near_clip = bag.checked("near_clip", 1e-2, |n| n > 0.0, "a number above 0")?;
        let allowed = format!("a number above near_clip, {near_clip}");
        let far_clip = bag.checked("far_clip", 1e4, |f| f > near_clip, &allowed)?;
        let aspect = f64::from(self.scene.film.width) / f64::from(self.scene.film.height);
        let kind = match bag.plugin {
            "perspective" => SensorKind::Perspective {
                fov_x: self.fov(&bag, aspect)?,
                principal_point: [
                    bag.float("principal_point_offset_x", 0.0)?,
                    bag.float("principal_point_offset_y", 0.0)?,
                ],
            },
            "thinlens" => {
                if bag.find("aperture_radius").is_none() {
                    return Err(bag.missing("aperture_radius"));
                }
                SensorKind::ThinLens {
                    fov_x: self.fov(&bag, aspect)?,
                    aperture_radius: bag.checked("aperture_radius", 0.0, |r| r > 0.0, "a number above 0")?,
                    focus_distance: bag.checked("focus_distance", far_clip, |d| d > 0.0, "a number above 0")?,
                }
            }
            _ => SensorKind::Orthographic,
        };
        // These have no meaning without motion or depth of field.
        bag.ignore(&["shutter_open", "shutter_close", "focus_distance"]);
        let to_world = bag.to_world()?;
        if kind != SensorKind::Orthographic
            && !keeps_lengths(&to_world)
            && let Some((_, place)) = bag.transform("to_world")?
        {
            return Err(place.error("to_world that scales, expected only rotations and translations"));
        }
        let medium = self.surrounding(&bag)?;
        self.close(&bag)?;
        Ok(SensorDesc { kind, to_world, near_clip, far_clip, medium })
    }

    fn fov(&mut self, bag: &Bag, aspect: f64) -> Result<f32, SceneError> {
        let view = field_of_view(bag, aspect)?;
        if let (true, Some(axis)) = (view.by_focal_length, bag.find("fov_axis")) {
            self.warn(&axis.place, "fov_axis without fov has no meaning and is ignored");
        }
        Ok(view.fov_x)
    }

    fn sampler(&mut self, node: &'t Node) -> Result<SamplerDesc, SceneError> {
        let bag = self.open(node)?;
        if !SAMPLERS.contains(&bag.plugin) {
            return Err(bag.unknown(SAMPLERS, &[]));
        }
        let sample_count = bag.whole("sample_count", 4, 1, u32::MAX)?;
        let seed = match bag.integer("seed")? {
            None => 0,
            Some((seed, place)) => u64::try_from(seed)
                .map_err(|_| place.error(format!("seed {seed}, expected a whole number not below 0")))?,
        };
        bag.ignore(&["jitter", "strength"]);
        if node.old {
            bag.ignore(&["dimension", "scramble"]);
        }
        self.close(&bag)?;
        Ok(SamplerDesc { sample_count, seed })
    }
}

/// Whether all axes keep their length.
fn keeps_lengths(transform: &Transform) -> bool {
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].into_iter().all(|axis| {
        let length = transform.vector(axis).iter().map(|c| c * c).sum::<f64>().sqrt();
        (length - 1.0).abs() < 1e-3
    })
}

/// How wide a camera sees.
pub(super) struct FieldOfView {
    /// Horizontal, degrees.
    pub(super) fov_x: f32,
    /// Given by a focal length.
    by_focal_length: bool,
}

/// The horizontal field of view from `fov` and `fov_axis` or from `focal_length`; `aspect` is width by height.
pub(super) fn field_of_view(bag: &Bag, aspect: f64) -> Result<FieldOfView, SceneError> {
    #[derive(Clone, Copy)]
    enum Axis {
        X,
        Y,
        Diagonal,
        Smaller,
        Larger,
    }
    /// Of the 35 mm format, 36 mm by 24 mm.
    const DIAGONAL: f64 = 43.266_615;
    let words = [
        ("x", Axis::X),
        ("y", Axis::Y),
        ("diagonal", Axis::Diagonal),
        ("smaller", Axis::Smaller),
        ("larger", Axis::Larger),
    ];
    let axis = bag.choice("fov_axis", &words, Axis::X)?;
    let focal_length = bag.text("focal_length")?;
    let (tangent, axis) = match (bag.number("fov")?, focal_length) {
        (Some((_, place)), Some(_)) => return Err(place.error("\"fov\" beside \"focal_length\", expected either")),
        (Some((fov, place)), None) => {
            if !(fov > 0.0 && fov < 180.0) {
                return Err(place.error(format!("fov {fov}, expected degrees between 0 and 180")));
            }
            ((fov.to_radians() / 2.0).tan(), axis)
        }
        (None, text) => {
            let words = text.map_or("50mm", |t| t.value.trim());
            let millimetres = words.strip_suffix("mm").unwrap_or(words).trim().parse::<f64>();
            let (Ok(length), place) = (millimetres, text.map_or(bag.place(), |t| &t.place)) else {
                return Err(text
                    .map_or(bag.place(), |t| &t.place)
                    .error(format!("focal_length \"{words}\", expected millimetres such as \"50mm\"")));
            };
            if !(length > 0.0 && length.is_finite()) {
                return Err(place.error(format!("focal_length \"{words}\", expected millimetres above 0")));
            }
            (DIAGONAL / (2.0 * length), Axis::Diagonal)
        }
    };
    let tangent_x = match axis {
        Axis::X => tangent,
        Axis::Y => tangent * aspect,
        Axis::Diagonal => tangent / (1.0 + 1.0 / (aspect * aspect)).sqrt(),
        Axis::Smaller => tangent * aspect.max(1.0),
        Axis::Larger => tangent * aspect.min(1.0),
    };
    Ok(FieldOfView {
        fov_x: (2.0 * tangent_x.atan()).to_degrees() as f32,
        by_focal_length: focal_length.is_some() || bag.number("fov")?.is_none(),
    })
}
