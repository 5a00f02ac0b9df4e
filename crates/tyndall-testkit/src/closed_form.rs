//! Exact answers: transport problems whose solution is a formula, a quadrature or a published table.
//!
//! Unless said otherwise sigma_t = 1 and the source emits 1 W. For another extinction q keep the optical distances and
//! multiply fluence and radiance by q^2.

use crate::quadrature::integrate;
use std::f64::consts::{FRAC_PI_2, PI};

/// Fluence [W/m^2] at distance `r` from an isotropic point source in an infinite isotropically scattering medium, of the
/// light scattered exactly `order` times, albedo 1 (multiply by `albedo^order`).
///
/// Inverse Fourier transform of the powers of `arctan(k)/k`, its contour bent onto the branch cut (Case, de Hoffmann,
/// Placzek 1953).
pub fn fluence(order: u32, r: f64) -> f64 {
    if order == 0 {
        return (-r).exp() / (4.0 * PI * r * r);
    }
    let power = |(re, im): (f64, f64)| {
        let angle = f64::from(order + 1) * im.atan2(re);
        re.hypot(im).powi(order as i32 + 1) * angle.sin()
    };
    branch_cut(r, power) / (2.0 * PI * PI * r)
}

/// [`fluence`] of all orders together, the unscattered light included, 0 < `albedo` < 1.
pub fn fluence_total(albedo: f64, r: f64) -> f64 {
    let c = albedo;
    let k = decay(c);
    let slope = 1.0 / (k * (1.0 - k * k)) - k.atanh() / (k * k);
    let diffuse = k * (-k * r).exp() / (2.0 * PI * r * c * c * slope);
    // imaginary part of G / (1 - c G)
    let rest = branch_cut(r, |(re, im)| im / ((1.0 - c * re).powi(2) + (c * im).powi(2)));
    diffuse + rest / (2.0 * PI * PI * r)
}

/// The root k of `1 = (albedo / k) artanh(k)`: far from the source, fluence falls as `exp(-k r) / r`.
pub fn decay(albedo: f64) -> f64 {
    let (mut low, mut high) = (1e-12f64, 1.0 - 1e-15);
    for _ in 0..200 {
        let mid = 0.5 * (low + high);
        if 1.0 - albedo * mid.atanh() / mid > 0.0 {
            low = mid;
        } else {
            high = mid;
        }
    }
    0.5 * (low + high)
}

/// Integral over k from 1 to infinity of `k exp(-k r) f(G)`, `G = (artanh(1/k) + i pi/2) / k`.
fn branch_cut(r: f64, f: impl Fn((f64, f64)) -> f64) -> f64 {
    // k = 1 + exp(y) takes the logarithmic end point
    let integrand = |y: f64| {
        let x = y.exp();
        let k = 1.0 + x;
        let q = 0.5 * ((2.0 + x) / x).ln();
        x * k * (-k * r).exp() * f((q / k, FRAC_PI_2 / k))
    };
    integrate(&integrand, -60.0, (60.0 / r + 60.0).ln(), 1e-12)
}

/// Radiance [W/(m^2 sr)] along an infinite ray that passes an isotropic point source at distance `h`, seen from `a` before
/// the foot of the perpendicular; light scattered exactly `order` >= 1 times, isotropic, albedo 1 (multiply by
/// `albedo^order`).
pub fn ray_radiance(order: u32, a: f64, h: f64) -> f64 {
    along_ray(a, h, |r| fluence(order - 1, r) / (4.0 * PI))
}

/// [`ray_radiance`] of all orders >= 1 together, 0 < `albedo` < 1.
pub fn ray_radiance_total(albedo: f64, a: f64, h: f64) -> f64 {
    along_ray(a, h, |r| albedo * fluence_total(albedo, r) / (4.0 * PI))
}

/// Integral of `exp(-t) f(r(t))` over the ray, in the angle at the source.
fn along_ray(a: f64, h: f64, f: impl Fn(f64) -> f64) -> f64 {
    let integrand = |theta: f64| {
        let t = a + h * theta.tan();
        let r = h / theta.cos();
        (-t).exp() * f(r) * r * r / h
    };
    integrate(&integrand, (-a).atan2(h), (60.0f64 - a).atan2(h), 1e-10)
}

/// [`ray_radiance`] of order 1 for a Henyey-Greenstein phase function.
pub fn ray_radiance_hg(g: f64, a: f64, h: f64) -> f64 {
    let integrand = |theta: f64| {
        let (t, r) = (a + h * theta.tan(), h / theta.cos());
        // from the source towards the point, and from the point towards the eye
        let cos = (a - t) / r;
        (-t - r).exp() * henyey_greenstein(g, cos) / (4.0 * PI * h)
    };
    integrate(&integrand, (-a).atan2(h), (60.0f64 - a).atan2(h), 1e-12)
}

/// Henyey and Greenstein (1941) [1/sr]; `cos` between the two directions of propagation.
pub fn henyey_greenstein(g: f64, cos: f64) -> f64 {
    (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cos).powf(1.5))
}

/// A ray of the T-infinity problem: [`ray_radiance`] at `a`, `h`.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Distance from the eye to the foot of the perpendicular.
    pub a: f64,
    /// Distance of the source from the ray.
    pub h: f64,
    /// Radiance of orders 1 to 5, isotropic, albedo 1.
    pub orders: [f64; 5],
    /// Radiance of all orders for albedo 0.5, 0.8, 0.9.
    pub total: [f64; 3],
    /// Radiance of order 1 for Henyey-Greenstein g = 0.5, 0.8, -0.5, albedo 1.
    pub hg: [f64; 3],
}

/// Tabulated rays; the functions above reproduce every digit.
pub const RAYS: [Ray; 4] = [
    Ray {
        a: 2.0,
        h: 0.5,
        orders: [2.5426840e-3, 2.4540747e-3, 1.8890726e-3, 1.4047327e-3, 1.0603378e-3],
        total: [2.2634479e-3, 6.1299290e-3, 8.9996968e-3],
        hg: [4.0006110e-3, 4.0392347e-3, 1.5444483e-3],
    },
    Ray {
        a: 2.0,
        h: 0.1,
        orders: [2.1700736e-2, 7.7335048e-3, 3.3027530e-3, 1.8634380e-3, 1.2462643e-3],
        total: [1.3375519e-2, 2.5854160e-2, 3.2069846e-2],
        hg: [3.3671261e-2, 6.7370148e-2, 2.1582904e-2],
    },
    Ray {
        a: 0.0,
        h: 0.5,
        orders: [5.6866728e-3, 4.8665955e-3, 3.2881481e-3, 2.1607640e-3, 1.4691752e-3],
        total: [4.6785369e-3, 1.1464906e-2, 1.5811609e-2],
        hg: [2.0648335e-3, 6.1803607e-4, 7.3276888e-3],
    },
    Ray {
        a: 1.0,
        h: 1.0,
        orders: [1.3893144e-3, 1.7679440e-3, 1.6395909e-3, 1.3610755e-3, 1.0871583e-3],
        total: [1.4832890e-3, 4.6632141e-3, 7.2941865e-3],
        hg: [1.1878346e-3, 4.7620367e-4, 8.0144550e-4],
    },
];

/// Radiance of order 2 on the ray a = 2, h = 0.5 for Henyey-Greenstein g, with its standard error (Monte Carlo).
pub const RAY_HG_ORDER_2: [(f64, f64, f64); 3] =
    [(0.5, 3.7948e-3, 2e-6), (0.8, 5.606e-3, 4e-6), (-0.5, 2.4443e-3, 1.2e-6)];

/// Fluence of orders 0 to 4 at a distance: `(r, phi_n)`.
pub const FLUENCE: [(f64, [f64; 5]); 5] = [
    (0.25, [9.91599954e-1, 4.37668405e-1, 1.68200934e-1, 7.22693807e-2, 3.69396123e-2]),
    (0.5, [1.93064705e-1, 1.43656001e-1, 8.41321497e-2, 4.84274730e-2, 2.94541084e-2]),
    (1.0, [2.92749158e-2, 3.45382269e-2, 2.98325541e-2, 2.32446460e-2, 1.75946289e-2]),
    (2.0, [2.69240991e-3, 4.70629054e-3, 5.77232264e-3, 6.07430724e-3, 5.89676312e-3]),
    (4.0, [9.10945145e-5, 2.20409243e-4, 3.67915242e-4, 5.14780629e-4, 6.47250602e-4]),
];

/// Singly scattered radiance from an isotropic point light of intensity `intensity` [W/sr] at distance `d` from the eye,
/// on a ray at angle `gamma` from the light's direction that ends at `z`; isotropic phase function (Sun et al. 2005).
pub fn airlight(sigma_s: f64, sigma_t: f64, intensity: f64, d: f64, gamma: f64, z: f64) -> f64 {
    let (t, tz) = (sigma_t * d, sigma_t * z);
    let (sin, cos) = gamma.sin_cos();
    let a1 = t * sin;
    let f = |v: f64| integrate(&|x: f64| (-a1 * x.tan()).exp(), 0.0, v, 1e-13);
    let end = 0.25 * PI + 0.5 * ((tz - t * cos) / a1).atan();
    sigma_s * intensity / (4.0 * PI) * (2.0 * (-t * cos).exp() / (d * sin)) * (f(end) - f(0.5 * gamma))
}

/// Chandrasekhar's H function of an isotropically scattering half-space (1960, ch. V), 0 < albedo <= 1.
#[derive(Clone, Debug)]
pub struct HalfSpace {
    albedo: f64,
    nodes: Vec<(f64, f64, f64)>,
}

impl HalfSpace {
    /// Solves the integral equation for H by iteration on a quadrature.
    pub fn new(albedo: f64) -> Self {
        // 20 panels of five-point Gauss, finer towards mu = 0, where H is steep: mu = s^2
        let mut nodes = Vec::new();
        for panel in 0..20 {
            for (x, w) in crate::quadrature::NODES.iter().zip(crate::quadrature::WEIGHTS) {
                let s = (f64::from(panel) + 0.5 + 0.5 * x) / 20.0;
                nodes.push((s * s, 2.0 * s * w * 0.5 / 20.0, 1.0));
            }
        }
        let mut half = Self { albedo, nodes };
        for _ in 0..20_000 {
            let next: Vec<f64> = half.nodes.iter().map(|n| 0.5 * (n.2 + half.h(n.0))).collect();
            let change = next.iter().zip(&half.nodes).map(|(h, n)| (h - n.2).abs()).fold(0.0, f64::max);
            half.nodes.iter_mut().zip(next).for_each(|(n, h)| n.2 = h);
            if change < 1e-13 {
                break;
            }
        }
        half
    }

    /// H(mu).
    pub fn h(&self, mu: f64) -> f64 {
        let sum: f64 = self.nodes.iter().map(|&(m, w, h)| w * m * h / (mu + m)).sum();
        1.0 / ((1.0 - self.albedo).sqrt() + 0.5 * self.albedo * sum)
    }

    /// Reflectance distribution [1/sr] for cosines `mu` out and `mu0` in.
    pub fn brdf(&self, mu: f64, mu0: f64) -> f64 {
        self.albedo / (4.0 * PI) * self.h(mu) * self.h(mu0) / (mu + mu0)
    }

    /// Part of a collimated beam at cosine `mu0` that comes back.
    pub fn plane_albedo(&self, mu0: f64) -> f64 {
        1.0 - (1.0 - self.albedo).sqrt() * self.h(mu0)
    }

    /// Part of diffuse (Lambertian) light that comes back.
    pub fn diffuse_albedo(&self) -> f64 {
        2.0 * integrate(&|mu| mu * self.plane_albedo(mu), 0.0, 1.0, 1e-10)
    }
}

/// A slab, or a half-space if `tau` is infinite, lit from one side.
#[derive(Clone, Copy, Debug)]
pub struct Slab {
    /// Optical thickness.
    pub tau: f64,
    /// Single-scattering albedo.
    pub albedo: f64,
    /// Henyey-Greenstein asymmetry.
    pub g: f64,
    /// Index of refraction inside (outside 1).
    pub ior: f64,
    /// Whether the light is diffuse (Lambertian) or collimated at normal incidence.
    pub diffuse: bool,
    /// Part reflected, the specular reflection not included.
    pub reflected: f64,
    /// Part transmitted, the unscattered light included.
    pub transmitted: f64,
    /// Standard error of both.
    pub error: f64,
}

const fn slab(tau: f64, albedo: f64, diffuse: bool, reflected: f64, transmitted: f64, error: f64) -> Slab {
    Slab { tau, albedo, g: 0.0, ior: 1.0, diffuse, reflected, transmitted, error }
}

/// Slabs; diffuse illumination by an exact integral equation, collimated by 2e7 photons and (first two) as in van de Hulst
/// (1980) and Giovanelli (1955).
pub const SLABS: [Slab; 14] = [
    Slab { g: 0.75, error: 8e-5, ..slab(2.0, 0.9, false, 0.09737, 0.66104, 0.0) },
    Slab { ior: 1.5, error: 6e-5, ..slab(f64::INFINITY, 0.9, false, 0.21996, 0.0, 0.0) },
    slab(f64::INFINITY, 0.9, false, 0.41495, 0.0, 8e-5),
    slab(1.0, 0.9, false, 0.26746, 0.59162, 1e-4),
    slab(1.0, 1.0, false, 0.34137, 0.65863, 1.3e-4),
    slab(4.0, 0.9, false, 0.40828, 0.12849, 7e-5),
    slab(0.1, 1.0, true, 0.08430, 0.91570, 1e-5),
    slab(0.5, 1.0, true, 0.29583, 0.70417, 1e-5),
    slab(1.0, 1.0, true, 0.44659, 0.55341, 1e-5),
    slab(2.0, 1.0, true, 0.60994, 0.39006, 1e-5),
    slab(5.0, 1.0, true, 0.79234, 0.20766, 1e-5),
    slab(1.0, 0.5, true, 0.13417, 0.30671, 1e-5),
    slab(1.0, 0.9, true, 0.35271, 0.47475, 1e-5),
    slab(4.0, 0.9, true, 0.47318, 0.09056, 1e-5),
];

/// Exponential integral E3: a purely absorbing slab of thickness `tau` lets `2 E3(tau)` of diffuse light through.
pub fn e3(tau: f64) -> f64 {
    integrate(&|mu: f64| if mu > 0.0 { mu * (-tau / mu).exp() } else { 0.0 }, 0.0, 1.0, 1e-13)
}

/// Form factor between two equal squares of side 1, parallel and facing each other at distance `d` (Howell, C-11).
pub fn form_factor_opposite(d: f64) -> f64 {
    let x = 1.0 / d;
    let y = 1.0 + x * x;
    let log = 0.5 * (y * y / (1.0 + 2.0 * x * x)).ln();
    2.0 / (PI * x * x) * (log + 2.0 * x * y.sqrt() * (x / y.sqrt()).atan() - 2.0 * x * x.atan())
}

/// Form factor between two unit squares that share an edge at a right angle (Howell, C-14).
pub fn form_factor_adjacent() -> f64 {
    let log = 0.25 * 0.75f64.ln();
    (FRAC_PI_2 - 2f64.sqrt() * 0.5f64.sqrt().atan() + log) / PI
}

/// A unit cube of medium whose face z = 0 emits 1 W diffusely, with walls of reflectance `rho`.
#[derive(Clone, Copy, Debug)]
pub struct Enclosure {
    /// Optical thickness of the side.
    pub tau: f64,
    /// Single-scattering albedo, isotropic.
    pub albedo: f64,
    /// Reflectance of the walls.
    pub rho: f64,
    /// Power absorbed by the emitting face, the opposite face, the four sides together, and the medium; each +-0.0002.
    pub absorbed: [f64; 4],
}

const fn enclosure(tau: f64, albedo: f64, rho: f64, absorbed: [f64; 4]) -> Enclosure {
    Enclosure { tau, albedo, rho, absorbed }
}

/// Enclosures, by Monte Carlo.
pub const ENCLOSURES: [Enclosure; 10] = [
    enclosure(0.0, 0.0, 0.5, [0.1043, 0.1713, 0.7244, 0.0]),
    enclosure(1.0, 0.0, 0.0, [0.0, 0.06618, 0.48782, 0.44600]),
    enclosure(1.0, 0.5, 0.0, [0.05578, 0.08071, 0.59680, 0.26671]),
    enclosure(1.0, 0.9, 0.0, [0.11476, 0.09924, 0.72249, 0.06351]),
    enclosure(1.0, 1.0, 0.0, [0.13232, 0.10537, 0.76232, 0.0]),
    enclosure(2.0, 0.9, 0.0, [0.18966, 0.05358, 0.63703, 0.11973]),
    enclosure(5.0, 0.9, 0.0, [0.30762, 0.01111, 0.43553, 0.24574]),
    enclosure(10.0, 1.0, 0.0, [0.55158, 0.01056, 0.43786, 0.0]),
    enclosure(1.0, 0.9, 0.5, [0.14958, 0.10340, 0.62792, 0.11910]),
    enclosure(1.0, 1.0, 0.8, [0.17889, 0.14065, 0.68045, 0.0]),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn close(value: f64, table: f64, relative: f64) {
        assert!((value / table - 1.0).abs() < relative, "{value:.10e} is not {table:.10e}");
    }

    #[test]
    fn point_source() {
        for (r, orders) in FLUENCE {
            for (n, phi) in (0..).zip(orders) {
                close(fluence(n, r), phi, 6e-9);
            }
        }
        for (c, k) in [(0.5, 0.95750402), (0.8, 0.71041178), (0.9, 0.52542951), (0.99, 0.17251107)] {
            close(decay(c), k, 2e-8);
        }
        let total = [(0.25, 1.264881, 1.518878), (1.0, 5.869514e-2, 1.074126e-1), (4.0, 4.493863e-4, 2.452642e-3)];
        for (r, half, most) in total {
            close(fluence_total(0.5, r), half, 5e-7);
            close(fluence_total(0.8, r), most, 5e-7);
        }
        // the orders add up to the total, and the total holds 1 / (1 - albedo) of the power
        let sum: f64 = (0..12).map(|n| 0.2f64.powi(n as i32) * fluence(n, 1.0)).sum();
        close(sum, fluence_total(0.2, 1.0), 1e-8);
        let all = integrate(&|r| 4.0 * PI * r * r * fluence_total(0.8, r), 1e-6, 60.0, 1e-4);
        close(all, 5.0, 1e-4);
    }

    #[test]
    fn rays_past_a_point_source() {
        for ray in RAYS {
            close(ray_radiance_hg(0.0, ray.a, ray.h), ray.orders[0], 5e-8);
            for (g, table) in [0.5, 0.8, -0.5].into_iter().zip(ray.hg) {
                close(ray_radiance_hg(g, ray.a, ray.h), table, 5e-8);
            }
            close(ray_radiance(1, ray.a, ray.h), ray.orders[0], 5e-8);
            close(ray_radiance(2, ray.a, ray.h), ray.orders[1], 5e-8);
            close(ray_radiance_total(0.8, ray.a, ray.h), ray.total[1], 5e-8);
        }
        close(ray_radiance(5, 2.0, 0.5), RAYS[0].orders[4], 5e-8);
    }

    #[test]
    fn single_scattering() {
        close(airlight(0.3, 0.5, 2.0, 3.0, 0.4, 5.0), 1.2596957565e-2, 1e-9);
        close(airlight(0.9, 1.0, 1.0, 2.0, 2.2, 7.0), 1.0571518556e-3, 1e-9);
        let d = 4.25f64.sqrt();
        close(airlight(1.0, 1.0, 0.25 / PI, d, (0.5f64 / d).asin(), 60.0), RAYS[0].orders[0], 5e-8);
    }

    #[test]
    fn half_spaces() {
        let table = [
            (0.5, [1.113461, 1.187735, 1.251260], 0.11523, 0.146544, 0.056131),
            (0.9, [1.291434, 1.556034, 1.850099], 0.41495, 0.478024, 0.173409),
            (0.99, [1.399767, 1.848601, 2.472793], 0.75272, 0.794564, 0.269223),
            (1.0, [1.450351, 2.012779, 2.907811], 1.0, 1.0, 0.322390),
        ];
        for (c, h, plane, diffuse, brdf) in table {
            let half = HalfSpace::new(c);
            for (mu, h) in [0.2, 0.5, 1.0].into_iter().zip(h) {
                close(half.h(mu), h, 1e-6);
            }
            close(half.plane_albedo(1.0), plane, 5e-5);
            close(half.diffuse_albedo(), diffuse, 5e-6);
            close(half.brdf(0.5, 0.5), brdf, 1e-5);
            let mean = integrate(&|mu| half.h(mu), 0.0, 1.0, 1e-10);
            close(mean, 2.0 / c * (1.0 - (1.0 - c).sqrt()), 1e-7);
        }
    }

    #[test]
    fn slabs_and_enclosures_keep_their_energy() {
        for s in SLABS.iter().filter(|s| s.albedo == 1.0) {
            close(s.reflected + s.transmitted, 1.0, 2e-5);
        }
        for e in ENCLOSURES {
            close(e.absorbed.iter().sum(), 1.0, 4e-4);
        }
        close(e3(0.0), 0.5, 1e-12);
        // by the recurrence n E_(n+1)(x) = exp(-x) - x E_n(x), E3(1) = E1(1) / 2
        close(e3(1.0), 0.5 * 0.219_383_934_395_520, 1e-9);
    }

    #[test]
    fn form_factors_of_a_cube() {
        close(form_factor_opposite(1.0), 0.199825, 1e-5);
        close(form_factor_opposite(1.0) + 4.0 * form_factor_adjacent(), 1.0, 1e-12);
    }
}
