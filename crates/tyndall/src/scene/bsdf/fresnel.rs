//! Reflectance of smooth interfaces, unpolarised.

use crate::Spectrum;
use crate::math::Vec3;

/// Reflectance of a dielectric interface and cosine of the refracted direction, for `cos >= 0` on the side of the
/// light and relative index `eta` (far side divided by near side). Total reflection gives (1, 0).
#[inline(always)]
pub fn dielectric(cos: f32, eta: f32) -> (f32, f32) {
    if eta == 1.0 {
        return (0.0, cos);
    }
    let sin2_t = (1.0 - cos * cos) / (eta * eta);
    if cos <= 0.0 || sin2_t >= 1.0 {
        return (1.0, (1.0 - sin2_t).max(0.0).sqrt());
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let s = (cos - eta * cos_t) / (cos + eta * cos_t);
    let p = (eta * cos - cos_t) / (eta * cos + cos_t);
    (0.5 * (s * s + p * p), cos_t)
}

/// Reflectance of a conductor seen from vacuum or air at `cos >= 0`, channel by channel (Moeller 1988, as given in
/// the appendix of Lazanyi and Szirmay-Kalos 2005).
#[inline(always)]
pub fn conductor(cos: f32, eta: Spectrum, k: Spectrum) -> Spectrum {
    // Keeps the quotients finite where numerator and denominator vanish together.
    let tiny = Spectrum::grey(f32::MIN_POSITIVE);
    let cos2 = cos * cos;
    let sin2 = 1.0 - cos2;
    let (eta2, k2) = (eta * eta, k * k);
    let d = eta2 - k2 - Spectrum::grey(sin2);
    // |(eta + ik)^2 - sin^2| and the real part of its root.
    let modulus = (d * d + eta2 * k2 * 4.0).sqrt();
    let real = ((modulus + d) * 0.5).max(Spectrum::ZERO).sqrt();
    let cross = real * (2.0 * cos);
    let sum = modulus + Spectrum::grey(cos2);
    let s = (sum - cross) / (sum + cross).max(tiny);
    let sum = modulus * cos2 + Spectrum::grey(sin2 * sin2);
    let cross = cross * sin2;
    let p = s * (sum - cross) / (sum + cross).max(tiny);
    // Rounding can leave an index-matched conductor slightly negative.
    ((s + p) * 0.5).max(Spectrum::ZERO)
}

/// Mean reflectance of a dielectric interface under diffuse light, relative index `eta`.
///
/// Below 1 the fit of Egan and Hilgeman 1973, above it that of d'Eon and Irving 2011 (equation 13).
pub fn diffuse_mean(eta: f32) -> f32 {
    let inverse = 1.0 / eta;
    if eta < 1.0 {
        return ((-1.4399 * eta + 0.7099) * eta + 0.6681) + 0.0636 * inverse;
    }
    [-1.36881, 4.98554, -7.80989, 6.75335, -3.4793, 0.919_317].iter().fold(0.0, |sum, c| sum * inverse + c)
}

/// Weight of the grazing colour in Schlick's approximation (Schlick 1994).
#[inline(always)]
pub fn schlick_weight(cos: f32) -> f32 {
    let x = (1.0 - cos).clamp(0.0, 1.0);
    let x2 = x * x;
    x2 * x2 * x
}

/// `v` mirrored about the unit vector `m`.
#[inline(always)]
pub fn reflect(v: Vec3, m: Vec3) -> Vec3 {
    m * (2.0 * v.dot(m)) - v
}

/// `v` refracted at a facet of normal `m` on its side, with `cos = v . m >= 0`, the cosine `cos_t` beyond and the
/// relative index `eta`.
#[inline(always)]
pub fn refract(v: Vec3, m: Vec3, cos: f32, cos_t: f32, eta: f32) -> Vec3 {
    let inverse = 1.0 / eta;
    m * (cos * inverse - cos_t) - v * inverse
}
