//! Spectra to linear sRGB.

use super::cie;

/// Light of the same power at every wavelength, in linear sRGB.
pub(crate) const EQUAL_ENERGY: [f64; 3] = [1.204_794, 0.948_291, 0.908_916];

/// XYZ to linear sRGB with white point D65 (ITU-R BT.709).
const FROM_XYZ: [[f64; 3]; 3] =
    [[3.240_479, -1.537_150, -0.498_535], [-0.969_256, 1.875_991, 0.041_556], [0.055_648, -0.204_043, 1.057_311]];

/// The light a spectrum is seen under.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Illuminant {
    /// None: the spectrum is itself light.
    Equal,
    /// Daylight.
    D65,
}

/// The colour of `(wavelength in nm, value)` pairs, linear in between and zero outside; not negative.
pub(crate) fn from_wavelengths(pairs: &[[f64; 2]], illuminant: Illuminant) -> [f64; 3] {
    let (Some(first), Some(last)) = (pairs.first(), pairs.last()) else { return [0.0; 3] };
    let value = |wavelength: f64| {
        let above = pairs.partition_point(|p| p[0] < wavelength).clamp(1, pairs.len() - 1);
        let ([x0, y0], [x1, y1]) = (pairs[above - 1], pairs[above]);
        y0 + (y1 - y0) * (wavelength - x0) / (x1 - x0)
    };
    integrate(first[0], last[0], value, illuminant).map(|c| c.max(0.0))
}

/// Planck's law, W/(m^2 sr nm), between two wavelengths (nm). `None` for an impossible temperature.
pub(crate) fn blackbody(temperature: f64, from: f64, to: f64) -> Option<[f64; 3]> {
    if !(temperature > 0.0 && temperature < 1e8) {
        return None;
    }
    const PLANCK: f64 = 6.626_070_15e-34;
    const LIGHT: f64 = 299_792_458.0;
    const BOLTZMANN: f64 = 1.380_649e-23;
    let radiance = |nanometres: f64| {
        let wavelength = nanometres * 1e-9;
        let exponent = PLANCK * LIGHT / (wavelength * BOLTZMANN * temperature);
        1e-9 * 2.0 * PLANCK * LIGHT * LIGHT / (wavelength.powi(5) * exponent.exp_m1())
    };
    Some(integrate(from, to, radiance, Illuminant::Equal).map(|c| c.max(0.0)))
}

fn integrate(from: f64, to: f64, value: impl Fn(f64) -> f64, illuminant: Illuminant) -> [f64; 3] {
    const STEPS: u32 = 2000;
    let end = cie::FIRST + cie::STEP * (cie::TABLE.len() - 1) as f64;
    let (from, to) = (from.max(cie::FIRST), to.min(end));
    if !(from < to) {
        return [0.0; 3];
    }
    let width = (to - from) / f64::from(STEPS);
    let mut xyz = [0.0; 3];
    for step in 0..STEPS {
        let wavelength = from + width * (f64::from(step) + 0.5);
        let [x, y, z, d65] = row(wavelength);
        let light = if illuminant == Illuminant::D65 { d65 * cie::D65_FACTOR } else { 1.0 };
        let weight = value(wavelength) * light * width / cie::Y_INTEGRAL;
        for (sum, matching) in xyz.iter_mut().zip([x, y, z]) {
            *sum += weight * matching;
        }
    }
    FROM_XYZ.map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2])
}

/// The table between its rows.
fn row(wavelength: f64) -> [f64; 4] {
    let position = ((wavelength - cie::FIRST) / cie::STEP).clamp(0.0, (cie::TABLE.len() - 1) as f64);
    let below = (position as usize).min(cie::TABLE.len() - 2);
    let t = position - below as f64;
    std::array::from_fn(|i| cie::TABLE[below][i] * (1.0 - t) + cie::TABLE[below + 1][i] * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: [f64; 3], expected: [f64; 3], tolerance: f64) {
        for (f, e) in found.iter().zip(expected) {
            assert!((f - e).abs() <= tolerance * e.abs().max(1.0), "{found:?}, expected {expected:?}");
        }
    }

    #[test]
    fn wavelength_lists_match_mitsuba() {
        let pairs = [[400.0, 0.0], [500.0, 0.3], [600.0, 0.8], [700.0, 1.1]];
        close(from_wavelengths(&pairs, Illuminant::Equal), [1.126_87, 0.488_194, 0.088_034_3], 2e-4);
        close(from_wavelengths(&pairs, Illuminant::D65), [0.970_898, 0.510_187, 0.108_601], 2e-4);
        let steep = [[400.0, 0.0], [500.0, 0.3], [600.0, 1.8], [700.0, 3.1]];
        close(from_wavelengths(&steep, Illuminant::Equal), [2.778_95, 0.863_838, 0.013_908], 2e-4);
        close(from_wavelengths(&steep, Illuminant::D65), [2.416_43, 0.901_256, 0.037_140_6], 2e-4);
    }

    #[test]
    fn whites_are_white() {
        let flat = [[300.0, 1.0], [900.0, 1.0]];
        // Mitsuba 3.9.1: its tables make daylight one part in a thousand darker than white.
        close(from_wavelengths(&flat, Illuminant::Equal), [1.204_88, 0.948_228, 0.909_267], 1e-5);
        close(from_wavelengths(&flat, Illuminant::D65), [0.998_985, 0.998_874, 0.998_802], 2e-4);
    }

    #[test]
    fn hot_bodies_have_the_colours_of_the_planckian_locus() {
        let cool = blackbody(2000.0, 360.0, 830.0).unwrap();
        let hot = blackbody(20_000.0, 360.0, 830.0).unwrap();
        assert!(cool[0] > cool[2] && hot[2] > hot[0]);
        // Chromaticity x = 0.3135, y = 0.3237 at 6500 K, in linear sRGB.
        let [r, g, b] = blackbody(6500.0, 360.0, 830.0).unwrap();
        close([r / g, 1.0, b / g], [1.0596, 1.0, 1.0518], 3e-3);
        assert!(blackbody(-1.0, 360.0, 830.0).is_none());
    }
}
