//! Numbers, colours and transforms in attributes.

use super::source::{Place, SceneError};
use super::xml::{Attribute, Node};
use tyndall::math::Transform;
use tyndall::scene::desc::Rgb;

pub(crate) fn float(attribute: &Attribute) -> Result<f64, SceneError> {
    parse(attribute.value.trim(), &attribute.place)
}

fn parse(text: &str, place: &Place) -> Result<f64, SceneError> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(place.error(format!("\"{text}\", expected a finite number"))),
    }
}

pub(crate) fn integer(attribute: &Attribute) -> Result<i64, SceneError> {
    let text = attribute.value.trim();
    text.parse().map_err(|_| attribute.place.error(format!("\"{text}\", expected a whole number")))
}

pub(crate) fn boolean(attribute: &Attribute) -> Result<bool, SceneError> {
    match attribute.value.trim().to_ascii_lowercase().as_str() {
        "true" => Ok(true),
        "false" => Ok(false),
        _ => Err(attribute.place.error(format!("\"{}\", expected true or false", attribute.value))),
    }
}

/// Numbers with spaces or commas between them.
pub(crate) fn list(text: &str, place: &Place) -> Result<Vec<f64>, SceneError> {
    words(text).map(|word| parse(word, place)).collect()
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty())
}

/// `wavelength:value` pairs, wavelengths ascending.
pub(crate) fn wavelengths(attribute: &Attribute) -> Result<Vec<[f64; 2]>, SceneError> {
    let place = &attribute.place;
    let mut pairs = Vec::new();
    for word in words(&attribute.value) {
        let Some((wavelength, value)) = word.split_once(':') else {
            return Err(place.error(format!("\"{word}\", expected wavelength:value")));
        };
        pairs.push([parse(wavelength, place)?, parse(value, place)?]);
    }
    check_wavelengths(&pairs, place)?;
    Ok(pairs)
}

/// At least two pairs, ascending.
pub(crate) fn check_wavelengths(pairs: &[[f64; 2]], place: &Place) -> Result<(), SceneError> {
    if pairs.len() < 2 {
        return Err(place.error(format!("{} wavelengths, expected at least 2", pairs.len())));
    }
    match pairs.windows(2).find(|w| !(w[0][0] < w[1][0])) {
        Some(w) => Err(place.error(format!("wavelength {} after {}, expected ascending ones", w[1][0], w[0][0]))),
        None => Ok(()),
    }
}

/// The text of an .spd file: a wavelength and a value per line, `#` for comments.
pub(crate) fn spd(text: &str, name: &str, place: &Place) -> Result<Vec<[f64; 2]>, SceneError> {
    let mut pairs = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let content = line.split('#').next().unwrap_or_default();
        let numbers: Result<Vec<f64>, _> = words(content).map(str::parse::<f64>).collect();
        match numbers.as_deref() {
            Ok([]) => {}
            Ok([wavelength, value]) if wavelength.is_finite() && value.is_finite() => pairs.push([*wavelength, *value]),
            _ => {
                return Err(place.error(format!(
                    "{name}:{}: \"{}\", expected a wavelength and a value",
                    number + 1,
                    line.trim()
                )));
            }
        }
    }
    check_wavelengths(&pairs, place)?;
    Ok(pairs)
}

/// One or three numbers, or `#rrggbb`, which `from_srgb` decodes.
pub(crate) fn rgb(attribute: &Attribute, from_srgb: bool) -> Result<Rgb, SceneError> {
    let place = &attribute.place;
    let text = attribute.value.trim();
    let encoded = if let Some(digits) = text.strip_prefix('#') {
        match u32::from_str_radix(digits, 16) {
            Ok(code) if digits.len() == 6 => [16, 8, 0].map(|shift| f64::from(code >> shift & 255) / 255.0),
            _ => return Err(place.error(format!("\"{text}\", expected #rrggbb"))),
        }
    } else {
        match list(text, place)?.as_slice() {
            [grey] => [*grey; 3],
            [r, g, b] => [*r, *g, *b],
            other => return Err(place.error(format!("{} numbers, expected 1 or 3", other.len()))),
        }
    };
    let linear = if from_srgb { encoded.map(decode_srgb) } else { encoded };
    narrow(linear, place)
}

fn decode_srgb(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// Single precision, if the numbers fit.
pub(crate) fn narrow<const N: usize>(numbers: [f64; N], place: &Place) -> Result<[f32; N], SceneError> {
    let narrowed = numbers.map(|n| n as f32);
    match narrowed.iter().position(|n| !n.is_finite()) {
        Some(i) => Err(place.error(format!("{:e}, expected a number below 3e38", numbers[i]))),
        None => Ok(narrowed),
    }
}

/// `value` with one or three numbers, or x, y and z; those missing take `missing`, if there is such.
pub(crate) fn triple(node: &Node, missing: Option<f64>) -> Result<[f64; 3], SceneError> {
    let axes = ["x", "y", "z"].map(|axis| node.attribute(axis));
    if let Some(value) = node.attribute("value") {
        if axes.iter().any(Option::is_some) {
            return Err(node
                .place
                .error(format!("<{}> with \"value\" and \"x\", \"y\", \"z\", expected either", node.tag)));
        }
        return match list(&value.value, &value.place)?.as_slice() {
            [all] => Ok([*all; 3]),
            [x, y, z] => Ok([*x, *y, *z]),
            other => Err(value.place.error(format!("{} numbers, expected 1 or 3", other.len()))),
        };
    }
    let mut out = [0.0; 3];
    for (i, axis) in axes.iter().enumerate() {
        out[i] = match (axis, missing) {
            (Some(attribute), _) => float(attribute)?,
            (None, Some(value)) => value,
            (None, None) => {
                let name = ["x", "y", "z"][i];
                return Err(node.place.error(format!("<{}> without \"{name}\", expected x, y and z", node.tag)));
            }
        };
    }
    Ok(out)
}

/// The operations in a `<transform>`, the first one applied first.
pub(crate) fn transform(node: &Node) -> Result<Transform, SceneError> {
    let mut whole = Transform::IDENTITY;
    for child in &node.children {
        let next = match child.tag.as_str() {
            "translate" => Transform::translate(triple(child, Some(0.0))?),
            "scale" => Transform::scale(triple(child, Some(1.0))?),
            "rotate" => {
                let angle = float(child.required("angle")?)?;
                let axis = triple(child, Some(0.0))?;
                Transform::rotate(axis, angle)
                    .ok_or_else(|| child.place.error("rotation about a zero axis, expected an axis other than zero"))?
            }
            "lookat" | "lookAt" => look_at(child)?,
            "matrix" => matrix(child.required("value")?)?,
            tag => {
                return Err(child
                    .place
                    .error(format!("<{tag}> in <transform>, expected translate, rotate, scale, lookat or matrix")));
            }
        };
        whole = whole.then(&next);
    }
    if !whole.is_finite() {
        return Err(node.place.error("transform that overflows, expected finite numbers"));
    }
    if whole.inverse().is_none() {
        return Err(node.place.error("singular transform, expected an invertible one"));
    }
    Ok(whole)
}

fn look_at(node: &Node) -> Result<Transform, SceneError> {
    let point = |name| {
        let attribute = node.required(name)?;
        match list(&attribute.value, &attribute.place)?.as_slice() {
            [x, y, z] => Ok([*x, *y, *z]),
            other => Err(attribute.place.error(format!("{} numbers, expected 3", other.len()))),
        }
    };
    let (origin, target) = (point("origin")?, point("target")?);
    let up = match node.attribute("up") {
        Some(_) => point("up")?,
        None => perpendicular([0, 1, 2].map(|i| target[i] - origin[i])),
    };
    Transform::look_at(origin, target, up)
        .ok_or_else(|| node.place.error("look-at without direction, expected target and up that differ from origin"))
}

/// Some vector at right angles, continuous but for the -z axis (Duff et al. 2017).
pub(crate) fn perpendicular(v: [f64; 3]) -> [f64; 3] {
    let length = v.iter().map(|c| c * c).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
    let [x, y, z] = v.map(|c| c / length);
    let sign = 1f64.copysign(z);
    let a = -1.0 / (sign + z);
    [1.0 + sign * x * x * a, sign * x * y * a, -sign * x]
}

fn matrix(attribute: &Attribute) -> Result<Transform, SceneError> {
    let m = list(&attribute.value, &attribute.place)?;
    let row = |i: usize| match m.len() {
        9 if i == 3 => [0.0, 0.0, 0.0, 1.0],
        9 => [m[3 * i], m[3 * i + 1], m[3 * i + 2], 0.0],
        _ => [m[4 * i], m[4 * i + 1], m[4 * i + 2], m[4 * i + 3]],
    };
    match m.len() {
        9 | 16 => Ok(Transform::from_rows([row(0), row(1), row(2), row(3)])),
        count => Err(attribute.place.error(format!("{count} numbers, expected a matrix of 9 or 16"))),
    }
}
