//! FLIP: the difference that a viewer sees when two pictures alternate on a screen (Andersson et al. 2020).
//!
//! Colours are filtered as the eye filters them and compared in a perceptual space; differences of edges and points then
//! raise the error. For pictures of low dynamic range.

use crate::view::{MetricError, View};

/// Pixels per degree of the paper's viewer: 0.7 m before a screen 0.7 m wide of 3840 pixels.
pub const PIXELS_PER_DEGREE: f64 = 3840.0 * std::f64::consts::PI / 180.0;

/// Exponent of the colour difference (section 4.1.3).
const COLOUR_EXPONENT: f64 = 0.7;
/// Fraction of the largest colour difference that is mapped linearly to `KNEE_ERROR`.
const KNEE: f64 = 0.4;
const KNEE_ERROR: f64 = 0.95;
/// Exponent of the feature difference (section 4.2).
const FEATURE_EXPONENT: f64 = 0.5;
/// Width of the feature detector, degrees.
const FEATURE_WIDTH: f64 = 0.082;
/// Contrast sensitivity as sums of Gaussians, (amplitude, width), for luminance, red-green and blue-yellow (table 1).
const SENSITIVITY: [[(f64, f64); 2]; 3] =
    [[(1.0, 0.0047), (0.0, 1e-5)], [(1.0, 0.0053), (0.0, 1e-5)], [(34.1, 0.04), (13.5, 0.025)]];

/// Linear sRGB to CIE XYZ, from the primaries and white point of IEC 61966-2-1.
const XYZ_OF_RGB: [[f64; 3]; 3] = [
    [0.412_386_563_252_991_9, 0.357_591_490_920_624_96, 0.180_450_491_203_563_7],
    [0.212_636_821_677_324_1, 0.715_182_981_841_249_9, 0.072_180_196_481_425_44],
    [0.019_330_620_152_483_97, 0.119_197_163_640_208_37, 0.950_372_587_005_435_4],
];

type Plane = Vec<f64>;

/// The error of every pixel, in [0, 1]. Values are linear; what lies outside [0, 1] is cut off, as a screen does.
pub fn map(picture: View, reference: View, pixels_per_degree: f64) -> Result<Vec<f64>, MetricError> {
    picture.check_same_size(&reference)?;
    let width = picture.width();
    let [a, b] = [picture, reference].map(opponent);
    let colours = [&a, &b].map(|planes| perceived(planes, width, pixels_per_degree));
    let features = [&a, &b].map(|planes| features(&planes[0], width, pixels_per_degree));
    let largest = largest_difference();
    let error = |i: usize| {
        let colour = remap(distance(colours[0][i], colours[1][i]).powf(COLOUR_EXPONENT), largest);
        let ([edge_a, point_a], [edge_b, point_b]) = (features[0][i], features[1][i]);
        let feature = (edge_a - edge_b).abs().max((point_a - point_b).abs()) / std::f64::consts::SQRT_2;
        colour.powf(1.0 - feature.powf(FEATURE_EXPONENT))
    };
    Ok((0..picture.pixels().len()).map(error).collect())
}

/// The mean of the map.
pub fn mean(picture: View, reference: View, pixels_per_degree: f64) -> Result<f64, MetricError> {
    let errors = map(picture, reference, pixels_per_degree)?;
    Ok(errors.iter().sum::<f64>() / errors.len() as f64)
}

/// Luminance, red-green and blue-yellow: linear relatives of CIE L*, a*, b* ("YCxCz").
fn opponent(view: View) -> [Plane; 3] {
    let pixels: Vec<[f64; 3]> =
        view.pixels().iter().map(|p| opponent_of_rgb(p.map(|x| f64::from(x).clamp(0.0, 1.0)))).collect();
    [0, 1, 2].map(|channel| pixels.iter().map(|p| p[channel]).collect())
}

fn opponent_of_rgb(rgb: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = relative_xyz(rgb);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn rgb_of_opponent([luminance, red_green, blue_yellow]: [f64; 3]) -> [f64; 3] {
    let y = (luminance + 16.0) / 116.0;
    let relative = [y + red_green / 500.0, y, y - blue_yellow / 200.0];
    let xyz = [0, 1, 2].map(|i| relative[i] * white()[i]);
    // Cramer's rule.
    let column = |j: usize| [0, 1, 2].map(|i| XYZ_OF_RGB[i][j]);
    let determinant = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    let (r, g, b) = (column(0), column(1), column(2));
    let all = determinant(r, g, b);
    [determinant(xyz, g, b) / all, determinant(r, xyz, b) / all, determinant(r, g, xyz) / all]
}

fn white() -> [f64; 3] {
    XYZ_OF_RGB.map(|row| row.iter().sum())
}

/// XYZ divided by that of white.
fn relative_xyz(rgb: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| XYZ_OF_RGB[i].iter().zip(rgb).map(|(m, x)| m * x).sum::<f64>() / white()[i])
}

/// CIE L*, a*, b*, the chromatic ones scaled down in the dark (Hunt effect).
fn perceptual(rgb: [f64; 3]) -> [f64; 3] {
    let curve = |t: f64| {
        const KINK: f64 = 6.0 / 29.0;
        if t > KINK * KINK * KINK { t.cbrt() } else { t / (3.0 * KINK * KINK) + 4.0 / 29.0 }
    };
    let [x, y, z] = relative_xyz(rgb).map(curve);
    let lightness = 116.0 * y - 16.0;
    let hunt = 0.01 * lightness;
    [lightness, hunt * 500.0 * (x - y), hunt * 200.0 * (y - z)]
}

/// City-block in lightness, Euclidean in colour ("HyAB", Abasi et al. 2020).
fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

/// The difference of the primaries green and blue, which no other pair exceeds.
fn largest_difference() -> f64 {
    distance(perceptual([0.0, 1.0, 0.0]), perceptual([0.0, 0.0, 1.0])).powf(COLOUR_EXPONENT)
}

/// Spreads the common small differences over most of [0, 1] (equation 8).
fn remap(difference: f64, largest: f64) -> f64 {
    let knee = KNEE * largest;
    if difference < knee {
        KNEE_ERROR * difference / knee
    } else {
        KNEE_ERROR + (1.0 - KNEE_ERROR) * (difference - knee) / (largest - knee)
    }
}

/// The colours as the eye resolves them.
fn perceived(planes: &[Plane; 3], width: usize, pixels_per_degree: f64) -> Vec<[f64; 3]> {
    use std::f64::consts::PI;
    let widest = SENSITIVITY.as_flattened().iter().fold(0.0f64, |m, g| m.max(g.1));
    let radius = (3.0 * (widest / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as i64;
    let mut filtered = [0, 1, 2].map(|i| vec![0.0; planes[i].len()]);
    for ((plane, gaussians), out) in planes.iter().zip(SENSITIVITY).zip(&mut filtered) {
        let kernels = gaussians.map(|(amplitude, b)| {
            let degrees = |i: i64| i as f64 / pixels_per_degree;
            let kernel: Vec<f64> = (-radius..=radius).map(|i| (-(PI * degrees(i)).powi(2) / b).exp()).collect();
            let sum: f64 = kernel.iter().sum();
            (amplitude * (PI / b).sqrt() * sum * sum, kernel.iter().map(|k| k / sum).collect::<Vec<f64>>())
        });
        let total: f64 = kernels.iter().map(|k| k.0).sum();
        for (weight, kernel) in kernels.iter().filter(|k| k.0 > 0.0) {
            for (out, x) in out.iter_mut().zip(convolve(plane, width, kernel, kernel)) {
                *out += weight / total * x;
            }
        }
    }
    let pixel = |i: usize| perceptual(rgb_of_opponent([0, 1, 2].map(|c| filtered[c][i])).map(|x| x.clamp(0.0, 1.0)));
    (0..planes[0].len()).map(pixel).collect()
}

/// Strength of edges and of points at every pixel.
fn features(luminance: &Plane, width: usize, pixels_per_degree: f64) -> Vec<[f64; 2]> {
    let grey: Plane = luminance.iter().map(|y| (y + 16.0) / 116.0).collect();
    let deviation = 0.5 * FEATURE_WIDTH * pixels_per_degree;
    let radius = (3.0 * deviation).ceil() as i64;
    let kernel = |factor: &dyn Fn(f64) -> f64| -> Vec<f64> {
        let value = |i: i64| {
            let t = i as f64 / deviation;
            factor(t) * (-0.5 * t * t).exp()
        };
        let kernel: Vec<f64> = (-radius..=radius).map(value).collect();
        let sum = |sign: f64| kernel.iter().map(|k| (sign * k).max(0.0)).sum::<f64>();
        let (positive, negative) = (sum(1.0), sum(-1.0));
        kernel.iter().map(|&k| if k > 0.0 { k / positive } else { k / negative.max(f64::MIN_POSITIVE) }).collect()
    };
    let (smooth, first, second) = (kernel(&|_| 1.0), kernel(&|t| -t), kernel(&|t| t * t - 1.0));
    let strength = |derivative: &[f64]| -> Plane {
        let (x, y) = (convolve(&grey, width, derivative, &smooth), convolve(&grey, width, &smooth, derivative));
        x.iter().zip(y).map(|(x, y)| x.hypot(y)).collect()
    };
    strength(&first).into_iter().zip(strength(&second)).map(|(edge, point)| [edge, point]).collect()
}

/// Filters rows, then columns; the border's pixels go on outside.
fn convolve(plane: &[f64], width: usize, row_kernel: &[f64], column_kernel: &[f64]) -> Plane {
    let height = plane.len() / width;
    let near = |i: usize, k: usize, kernel: &[f64], n: usize| (i + k).saturating_sub(kernel.len() / 2).min(n - 1);
    let mut rows = vec![0.0; plane.len()];
    for (out, row) in rows.chunks_exact_mut(width).zip(plane.chunks_exact(width)) {
        for (x, out) in out.iter_mut().enumerate() {
            *out = row_kernel.iter().enumerate().map(|(k, w)| w * row[near(x, k, row_kernel, width)]).sum();
        }
    }
    let mut columns = vec![0.0; plane.len()];
    for (y, out) in columns.chunks_exact_mut(width).enumerate() {
        for (k, w) in column_kernel.iter().enumerate() {
            let row = near(y, k, column_kernel, height) * width;
            for (out, x) in out.iter_mut().zip(&rows[row..row + width]) {
                *out += w * x;
            }
        }
    }
    columns
}
