//! Sampling of the points where light turns, by what its turns make of it: tables of the product of two phase functions
//! (Novak et al. 2012a).
//!
//! In the angle of equiangular sampling the factor 1/d^2 is gone, and what is left of the integrand is smooth: both phase
//! functions and the transmittance. It is tabulated at a few angles, and the density is linear between them. The same
//! holds for the variable of the point on light's ray, whose table has the sums of the others. Whatever is in the tables,
//! samples have exactly the density that they are given with.

use super::equiangular::Equiangular;
use super::ray_pair::{PairSample, RayPair};
use crate::math::polyline::{Polyline, integral};
use crate::math::{PerLength, Ray, Vec3};
use crate::scene::phase::Phase;

/// Nodes over the angle at a point.
const ANGLES: usize = 12;
/// Nodes over a ray of light, and over the angle at each of them.
const PLACES: usize = 5;
const ANGLES_AT_PLACE: usize = 5;
/// What tables are lifted by, in units of their mean: between the nodes there may be more than at them.
const FLOOR: f32 = 0.05;

/// What is left of the integrand beside 1/d^2, for light between a point and a ray.
#[derive(Clone, Copy, Debug)]
pub struct Turns<'a> {
    /// Phase function along the ray.
    pub on_ray: &'a Phase,
    /// Phase function at the point, and the unit direction of travel with which a walk arrives there, to go on to the ray.
    pub at_point: Option<(&'a Phase, Vec3)>,
    /// Rate at which the ray dims with the distance from its start, 1/m.
    pub along: f32,
    /// Rate at which light dims between point and ray, 1/m.
    pub between: f32,
}

/// About `exp(-depth)`, but with a long tail.
#[inline(always)]
fn dimmed(depth: f32) -> f32 {
    let root = 1.0 / (1.0 + 0.125 * depth);
    let square = root * root;
    let fourth = square * square;
    fourth * fourth
}

impl Turns<'_> {
    /// The product at equidistant angles, in any unit.
    #[inline]
    fn table<const N: usize>(&self, ray: &Ray, point: Vec3, angles: &Equiangular) -> [f32; N] {
        let Equiangular { delta, height, span } = *angles;
        let (sin_step, cos_step) = (span / (N - 1) as f32).sin_cos();
        let start = (height * height + delta * delta).sqrt();
        // Cosine and sine of the angle between the perpendicular from the point and the way to the ray.
        let (mut cosines, mut sines) = ([height / start; N], [-delta / start; N]);
        for i in 1..N {
            cosines[i] = cosines[i - 1] * cos_step - sines[i - 1] * sin_step;
            sines[i] = sines[i - 1] * cos_step + cosines[i - 1] * sin_step;
        }
        let mut values = [1.0; N];
        if self.along + self.between > 0.0 {
            for i in 0..N {
                let distance = height / cosines[i].max(1e-4);
                let t = (delta + distance * sines[i]).max(0.0);
                values[i] = dimmed(self.along * t + self.between * distance);
            }
        }
        // Whichever way light goes, one of the two directions of the turn on the ray points along it, the other off.
        self.on_ray.scale_table(&sines.map(|sin| -sin), &mut values);
        if let Some((phase, arrival)) = self.at_point {
            let aside = (ray.at(delta) - point).normalize_or_zero().dot(arrival);
            let along = ray.direction.dot(arrival);
            let mut turns = [0.0; N];
            for i in 0..N {
                turns[i] = cosines[i] * aside + sines[i] * along;
            }
            phase.scale_table(&turns, &mut values);
        }
        values
    }
}

/// Distances along a ray by [`Turns`] and 1/d^2.
#[derive(Clone, Copy, Debug)]
pub struct TurnsOnRay {
    angles: Equiangular,
    table: Polyline<ANGLES>,
}

impl TurnsOnRay {
    /// For the point that `angles` were made for.
    #[inline]
    pub fn new(turns: &Turns, ray: &Ray, point: Vec3, angles: Equiangular) -> Self {
        Self { angles, table: Polyline::new(&turns.table(ray, point, &angles), FLOOR) }
    }

    /// The distance for `u` in [0, 1), and its density.
    #[inline]
    pub fn sample(&self, u: f32) -> (f32, PerLength) {
        let (position, density) = self.table.sample(u);
        let t = self.angles.sample(position);
        (t, PerLength(density * self.angles.density(t).0))
    }

    /// Density of the distance `t`.
    #[inline]
    pub fn density(&self, t: f32) -> PerLength {
        PerLength(self.table.density(self.angles.position(t)) * self.angles.density(t).0)
    }
}

/// Pairs of distances, on a ray of light and on the camera's, by [`Turns`] and 1/d^2.
#[derive(Clone, Copy, Debug)]
pub struct TurningPair<'a> {
    pair: RayPair,
    turns: Turns<'a>,
    light: Polyline<PLACES>,
}

impl<'a> TurningPair<'a> {
    /// For a pair of rays; `turns` are those between a point on light's ray and the camera's. Light's dims at `rate`, 1/m.
    #[inline]
    pub fn new(pair: RayPair, turns: Turns<'a>, rate: f32) -> Self {
        let mut sums = [0.0; PLACES];
        let [light, camera] = pair.rays();
        for (i, sum) in sums.iter_mut().enumerate() {
            let s = pair.on_light(i as f32 / (PLACES - 1) as f32);
            let angles = pair.across(s);
            let row = turns.table::<ANGLES_AT_PLACE>(camera, light.at(s), &angles);
            *sum = integral(&row) * angles.span * dimmed(rate * s);
        }
        Self { pair, turns, light: Polyline::new(&sums, FLOOR) }
    }

    fn across(&self, s: f32) -> TurnsOnRay {
        let [light, camera] = self.pair.rays();
        TurnsOnRay::new(&self.turns, camera, light.at(s), self.pair.across(s))
    }

    /// The pair for `u` in [0, 1)^2.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> PairSample {
        let (position, density) = self.light.sample(u[0]);
        let s = self.pair.on_light(position);
        let (t, across) = self.across(s).sample(u[1]);
        PairSample { s, t, pdf: density * self.pair.density_on_light(s) * across.0 }
    }

    /// Density of the pair, 1/m^2.
    pub fn density(&self, s: f32, t: f32) -> f32 {
        let on_light = self.light.density(self.pair.position_on_light(s)) * self.pair.density_on_light(s);
        on_light * self.across(s).density(t).0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rng;
    use crate::scene::desc::PhaseDesc;
    use tyndall_testkit::chi2;
    use tyndall_testkit::ztest::{Moments, sidak, two_sided_p};

    const CAMERA_LENGTH: f32 = 4.0;
    const LIGHT_LENGTH: f32 = 3.0;

    fn ray(origin: [f32; 3], direction: [f32; 3]) -> Ray {
        Ray { origin: Vec3::from(origin), direction: Vec3::from(direction).normalize() }
    }

    fn camera() -> Ray {
        ray([0.0; 3], [1.0, 0.0, 0.0])
    }

    /// Rays of light past the camera's: at some distance, close by, parallel, beyond its end.
    fn lights() -> [Ray; 4] {
        [
            ray([1.0, 0.3, -0.8], [0.3, 0.2, 0.9]),
            ray([1.0, 0.01, -0.5], [0.1, 0.0, 1.0]),
            ray([3.0, 0.5, 0.0], [-1.0, 0.0, 0.0]),
            ray([6.0, 2.0, 1.0], [0.0, 1.0, 0.2]),
        ]
    }

    fn hg(g: f32) -> Phase {
        Phase::compile(&PhaseDesc::HenyeyGreenstein { g }).unwrap()
    }

    fn pair<'a>(light: &Ray, phase: &'a Phase, sigma_t: f32, radius: f32) -> TurningPair<'a> {
        let pair = RayPair::new(&camera(), CAMERA_LENGTH, light, LIGHT_LENGTH, radius);
        let turns = Turns { on_ray: phase, at_point: Some((phase, light.direction)), along: sigma_t, between: sigma_t };
        TurningPair::new(pair, turns, sigma_t)
    }

    #[test]
    fn pairs_follow_their_density() {
        let gs = [0.5, 0.8, -0.5];
        let tests = gs.len() * lights().len() * 2;
        for (case, g) in (0..).zip(gs) {
            let phase = hg(g);
            for (way, light) in (0..).zip(lights()) {
                for (kind, (sigma_t, radius)) in [(0.0, 0.0), (2.0, 0.1)].into_iter().enumerate() {
                    let pair = pair(&light, &phase, sigma_t, radius);
                    let sample = |u: [f32; 2]| {
                        let PairSample { s, t, pdf } = pair.sample(u);
                        let density = pair.density(s, t);
                        assert!((pdf - density).abs() < 2e-3 * density, "{g} {light:?}: {pdf} {density}");
                        Some([s / LIGHT_LENGTH, t / CAMERA_LENGTH])
                    };
                    let density = |[s, t]: [f32; 2]| {
                        f64::from(pair.density(s * LIGHT_LENGTH, t * CAMERA_LENGTH) * LIGHT_LENGTH * CAMERA_LENGTH)
                    };
                    let outcome = chi2::square(sample, density, 100_000, case * 100 + way * 10 + kind as u64);
                    assert!((outcome.integral - 1.0).abs() < 1e-3, "{g} {light:?}: {outcome:?}");
                    assert!(outcome.passes(0.01, tests), "{g} {light:?}: {outcome:?}");
                }
            }
        }
    }

    #[test]
    fn distances_follow_their_density() {
        let gs = [0.0, 0.8, -0.5];
        let points = [Vec3::new(1.0, 0.3, -0.8), Vec3::new(2.0, 1e-3, 0.0), Vec3::new(-1.0, 0.2, 0.0)];
        for (case, g) in (0..).zip(gs) {
            let phase = hg(g);
            for (place, point) in (0..).zip(points) {
                let arrival = Vec3::new(0.3, 0.2, 0.9).normalize();
                let turns = Turns { on_ray: &phase, at_point: Some((&phase, arrival)), along: 1.0, between: 0.5 };
                let angles = Equiangular::new(&camera(), CAMERA_LENGTH, point);
                let distances = TurnsOnRay::new(&turns, &camera(), point, angles);
                let sample = |u| Some(f64::from(distances.sample(u).0));
                let density = |t: f64| f64::from(distances.density(t as f32).0);
                let outcome =
                    chi2::interval(sample, density, 0.0, f64::from(CAMERA_LENGTH), 100_000, case * 10 + place);
                assert!((outcome.integral - 1.0).abs() < 1e-4, "{g} {point}: {outcome:?}");
                assert!(outcome.passes(0.01, gs.len() * points.len()), "{g} {point}: {outcome:?}");
            }
        }
    }

    /// The integrand of both turns with its transmittances, over the density.
    fn weight(light: &Ray, phase: &Phase, sample: PairSample) -> f64 {
        let PairSample { s, t, pdf } = sample;
        let between = camera().at(t) - light.at(s);
        let (distance, direction) = (between.length(), between.normalize());
        let turned =
            phase.eval(light.at(s), light.direction, direction) * phase.eval(camera().at(t), direction, -Vec3::X);
        f64::from(turned * (-(s + t + distance)).exp() / (distance * distance * pdf))
    }

    /// Mean and standard deviation over the mean.
    fn moments(seed: u64, n: u32, sample: impl Fn([f32; 2]) -> f64) -> Moments {
        let mut rng = Rng::keyed(seed, 0, 0);
        let mut moments = Moments::default();
        (0..n).for_each(|_| moments.push(sample([rng.f32(), rng.f32()])));
        moments
    }

    /// Quadrature of both turns, all extinctions and lengths one, 4 and 3, by a rule independent of the samplers.
    #[test]
    fn estimates_agree_with_quadrature_and_vary_less() {
        let light = lights()[0];
        let rows = [
            (0.0, 3.055_167_16e-3, 10.0),
            (0.7, 9.799_10e-4, 30.0),
            (0.8, 4.321_69e-4, 30.0),
            (0.9, 9.950_36e-5, 30.0),
            (-0.7, 4.169_03e-4, 3.0),
        ];
        for (seed, (g, truth, gain)) in (0..).zip(rows) {
            let phase = hg(g);
            let table = pair(&light, &phase, 1.0, 0.0);
            let plain = RayPair::new(&camera(), CAMERA_LENGTH, &light, LIGHT_LENGTH, 0.0);
            let by_table = moments(seed, 400_000, |u| weight(&light, &phase, table.sample(u)));
            let by_distance = moments(100 + seed, 400_000, |u| weight(&light, &phase, plain.sample(u)));
            let ratio = by_distance.variance() / by_table.variance();
            let relative = by_table.variance().sqrt() / truth;
            println!("g = {g}: sd/mean {relative:.3}, variance lower by {ratio:.2}");
            for m in [by_table, by_distance] {
                let z = (m.mean() - truth) / (m.variance() / m.count()).sqrt();
                assert!(two_sided_p(z) > sidak(0.01, 10), "g = {g}: {} expected {truth}, z = {z}", m.mean());
            }
            assert!(ratio > gain, "g = {g}: {ratio}");
        }
    }
}
