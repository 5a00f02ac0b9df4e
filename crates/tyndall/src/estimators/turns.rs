//! Sampling of the points where light turns: by distance alone, or by what the turns make of it too, from tables of the
//! product of two phase functions (Novak et al. 2012a).
//!
//! In the angle of equiangular sampling the factor 1/d^2 is gone, and what is left of the integrand is smooth: both phase
//! functions and the transmittance. It is tabulated at a few angles, and the density is linear between them. The same
//! holds for the variable of the point on light's ray, whose table has the sums of the others. Whatever is in the tables,
//! samples have exactly the density that they are given with. Eight rays of light are sampled at once.

use super::equiangular::EquiangularLanes;
use super::ray_pair::{EightRays, RayPair};
use crate::math::Ray;
use crate::math::functions::sin_cos;
use crate::math::lanes::{Kernel, Lanes, Row, WIDTH};
use crate::math::polyline::{Polyline, integral};
use crate::math::triples::{dot, load, minus};
use crate::scene::phase::Phase;

/// Nodes over the angle at a point.
const ANGLES: usize = 12;
/// Nodes over a ray of light, and over the angle at each of them.
const PLACES: usize = 5;
const ANGLES_AT_PLACE: usize = 5;
/// What tables are lifted by, in units of their mean: between the nodes there may be more than at them.
const FLOOR: f32 = 0.05;

/// Phase functions, one a lane.
#[derive(Clone, Copy, Debug)]
pub enum Phases<'a> {
    /// The same in all.
    Same(&'a Phase),
    /// Any.
    Each([&'a Phase; WIDTH]),
}

impl Phases<'_> {
    /// `values` times numbers proportional to the functions at the cosines.
    #[inline(always)]
    fn scale<L: Lanes>(&self, cosines: L, values: L) -> L {
        let (cosines, mut values) = (cosines.store(), values.store());
        match self {
            Self::Same(phase) => phase.scale_table(&cosines.0, &mut values.0),
            Self::Each(phases) => {
                for (lane, phase) in phases.iter().enumerate() {
                    phase.scale_table(&cosines.0[lane..=lane], &mut values.0[lane..=lane]);
                }
            }
        }
        L::load(&values)
    }
}

/// About `exp(-depth)`, but with a long tail.
#[inline(always)]
fn dimmed<L: Lanes>(depth: L) -> L {
    let root = L::splat(1.0).div(L::splat(0.125).mul(depth).add(L::splat(1.0)));
    let square = root.mul(root);
    let fourth = square.mul(square);
    fourth.mul(fourth)
}

/// What is left of the integrand beside 1/d^2, for light between a point and a ray.
#[derive(Clone, Copy)]
struct Turns<'a, L> {
    /// Phase function along the ray.
    on_ray: &'a Phases<'a>,
    /// Phase function at the point, and the unit direction of travel with which a walk arrives there, to go on to the ray.
    at_point: Option<(&'a Phases<'a>, [L; 3])>,
    /// Rate at which the ray dims with the distance from its start, 1/m.
    along: L,
    /// Rate at which light dims between point and ray, 1/m.
    between: L,
}

impl<L: Lanes> Turns<'_, L> {
    /// The product at equidistant angles, in any unit; `rejection` leads from the points' feet on the rays to the points.
    #[inline(always)]
    fn table<const N: usize>(&self, direction: [L; 3], angles: &EquiangularLanes<L>, rejection: [L; 3]) -> [L; N] {
        let EquiangularLanes { delta, height, span } = *angles;
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let (sin_step, cos_step) = sin_cos(span.mul(L::splat(1.0 / (N - 1) as f32)));
        let start = height.mul(height).add(delta.mul(delta)).sqrt();
        let (aside, along) = match self.at_point {
            Some((_, arrival)) => {
                let apart = dot(rejection, rejection).sqrt().max(L::splat(1e-30));
                (zero.sub(dot(rejection, arrival)).div(apart), dot(direction, arrival))
            }
            None => (zero, zero),
        };
        // Cosine and sine of the angle between the perpendicular from the point and the way to the ray.
        let (mut cos, mut sin) = (height.div(start), zero.sub(delta).div(start));
        let mut values = [one; N];
        for value in &mut values {
            let distance = height.div(cos.max(L::splat(1e-4)));
            let t = delta.add(distance.mul(sin)).max(zero);
            *value = dimmed(self.along.mul(t).add(self.between.mul(distance)));
            // Whichever way light goes, one of the two directions of the turn on the ray points along it, the other off.
            *value = self.on_ray.scale(zero.sub(sin), *value);
            if let Some((phases, _)) = self.at_point {
                *value = phases.scale(cos.mul(aside).add(sin.mul(along)), *value);
            }
            (cos, sin) = (cos.mul(cos_step).sub(sin.mul(sin_step)), sin.mul(cos_step).add(cos.mul(sin_step)));
        }
        values
    }
}

/// Distances along rays by [`Turns`] and 1/d^2.
#[derive(Clone, Copy)]
struct TurnsOnRay<L> {
    angles: EquiangularLanes<L>,
    table: Polyline<L, ANGLES>,
}

impl<L: Lanes> TurnsOnRay<L> {
    /// For the points that `angles` were made for.
    #[inline(always)]
    fn new(turns: &Turns<L>, direction: [L; 3], (angles, rejection): (EquiangularLanes<L>, [L; 3])) -> Self {
        Self { angles, table: Polyline::new(&turns.table(direction, &angles, rejection), FLOOR) }
    }

    /// The distances for `u` in [0, 1), and their density.
    #[inline(always)]
    fn sample(&self, u: L) -> (L, L) {
        let (position, density) = self.table.sample(u);
        let t = self.angles.sample(position);
        (t, density.mul(self.angles.density(t)))
    }

    /// Density of the distances `t`.
    #[cfg(test)]
    #[inline(always)]
    fn density(&self, t: L) -> L {
        self.table.density(self.angles.position(t)).mul(self.angles.density(t))
    }
}

/// Pairs of distances, on rays of light and on the camera's, by [`Turns`] and 1/d^2.
#[derive(Clone, Copy)]
struct TurningPair<'a, L: Lanes> {
    pair: RayPair<L>,
    turns: Turns<'a, L>,
    light: Polyline<L, PLACES>,
}

impl<'a, L: Lanes> TurningPair<'a, L> {
    #[inline(always)]
    fn new(pair: RayPair<L>, turns: &'a PairTurns<'a>) -> Self {
        let along = L::splat(turns.sigma_t);
        let at_point = Some((&turns.at_light, pair.light));
        let rates = L::load(&turns.rates);
        let turns = Turns { on_ray: &turns.on_camera, at_point, along, between: along };
        let mut sums = [L::splat(0.0); PLACES];
        for (i, sum) in sums.iter_mut().enumerate() {
            let s = pair.on_light(L::splat(i as f32 / (PLACES - 1) as f32));
            let (angles, rejection) = pair.across(s);
            let row = turns.table::<ANGLES_AT_PLACE>(pair.camera, &angles, rejection);
            *sum = integral(&row).mul(angles.span).mul(dimmed(rates.mul(s)));
        }
        Self { pair, turns, light: Polyline::new(&sums, FLOOR) }
    }

    #[inline(always)]
    fn across(&self, s: L) -> TurnsOnRay<L> {
        TurnsOnRay::new(&self.turns, self.pair.camera, self.pair.across(s))
    }

    /// The pairs for `u` in [0, 1)^2, and their density.
    #[inline(always)]
    fn sample(&self, u: [L; 2]) -> [L; 3] {
        let (position, density) = self.light.sample(u[0]);
        let s = self.pair.on_light(position);
        let (t, across) = self.across(s).sample(u[1]);
        [s, t, density.mul(self.pair.density_on_light(s)).mul(across)]
    }

    /// Density of the pairs, 1/m^2.
    #[cfg(test)]
    #[inline(always)]
    fn density(&self, s: L, t: L) -> L {
        let on_light = self.light.density(self.pair.position_on_light(s)).mul(self.pair.density_on_light(s));
        on_light.mul(self.across(s).density(t))
    }
}

/// What chooses pairs of distances besides the distance between the points.
#[derive(Clone, Copy, Debug)]
pub struct PairTurns<'a> {
    /// Phase function along the camera's ray.
    pub on_camera: Phases<'a>,
    /// Phase functions along light's rays.
    pub at_light: Phases<'a>,
    /// Rates at which light's rays dim, 1/m.
    pub rates: Row,
    /// Extinction along the camera's ray and between, 1/m.
    pub sigma_t: f32,
}

/// Chooses a distance on each of eight rays of light and one on the camera's ray for each.
#[derive(Clone, Copy, Debug)]
pub struct Pairs<'a> {
    /// The camera's ray.
    pub camera: Ray,
    /// Its length, metres.
    pub length: f32,
    /// Light's.
    pub lights: &'a EightRays,
    /// Softens 1/d^2, metres.
    pub radius: f32,
    /// `None`: only distances count.
    pub turns: Option<&'a PairTurns<'a>>,
    /// Random numbers in [0, 1): for light's rays and for the camera's.
    pub u: &'a [Row; 2],
}

impl Kernel for Pairs<'_> {
    /// Distances on light's rays and on the camera's, metres, and their joint densities, 1/m^2.
    type Output = [Row; 3];

    #[inline(always)]
    fn run<L: Lanes>(self) -> [Row; 3] {
        let pair = RayPair::<L>::new(&self.camera, self.length, self.lights, self.radius);
        let [u, v] = [L::load(&self.u[0]), L::load(&self.u[1])];
        let [s, t, pdf] = match self.turns {
            Some(turns) => TurningPair::new(pair, turns).sample([u, v]),
            None => {
                let s = pair.on_light(u);
                let (across, _) = pair.across(s);
                let t = across.sample(v);
                [s, t, pair.density_on_light(s).mul(across.density(t))]
            }
        };
        [s.store(), t.min(L::splat(self.length)).store(), pdf.store()]
    }
}

/// Chooses a distance on each of eight rays, for light between there and a point for each.
#[derive(Clone, Copy, Debug)]
pub struct Distances<'a> {
    /// The points: x, y, z, metres.
    pub points: &'a [Row; 3],
    /// The rays.
    pub rays: &'a EightRays,
    /// Softens 1/d^2, metres.
    pub radius: f32,
    /// Phase functions along the rays and the rates at which they dim, 1/m; `None`: only distances count.
    pub turns: Option<(&'a Phases<'a>, &'a Row)>,
    /// Random numbers in [0, 1).
    pub u: &'a Row,
}

impl Kernel for Distances<'_> {
    /// Distances, metres, and their densities, 1/m.
    type Output = [Row; 2];

    #[inline(always)]
    fn run<L: Lanes>(self) -> [Row; 2] {
        let (direction, length) = (load::<L>(&self.rays.direction), L::load(&self.rays.length));
        let to_point = minus(load(self.points), load(&self.rays.origin));
        let across = EquiangularLanes::new(direction, length, to_point, self.radius);
        let u = L::load(self.u);
        let (s, pdf) = match self.turns {
            Some((on_ray, rates)) => {
                let turns = Turns { on_ray, at_point: None, along: L::load(rates), between: L::splat(0.0) };
                TurnsOnRay::new(&turns, direction, across).sample(u)
            }
            None => {
                let s = across.0.sample(u);
                (s, across.0.density(s))
            }
        };
        [s.min(length).store(), pdf.store()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::lanes::{Level, Portable};
    use crate::math::{Rng, Vec3};
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

    /// Rays of light past the camera's: at some distance, close by, parallel, nearly so, beyond its end on either side, far off.
    fn lights() -> [Ray; 7] {
        [
            ray([1.0, 0.3, -0.8], [0.3, 0.2, 0.9]),
            ray([1.0, 0.01, -0.5], [0.1, 0.0, 1.0]),
            ray([3.0, 0.5, 0.0], [-1.0, 0.0, 0.0]),
            ray([0.5, 0.2, 0.1], [1.0, 2e-3, 0.0]),
            ray([6.0, 2.0, 1.0], [0.0, 1.0, 0.2]),
            ray([-1.0, 3.0, 4.5], [0.1, -0.5, -1.0]),
            ray([20.0, 50.0, -30.0], [0.3, 0.2, 0.9]),
        ]
    }

    /// One of the lights in a lane of its own, the others around it.
    fn rows() -> EightRays {
        let mut rows = EightRays::default();
        lights().iter().enumerate().for_each(|(lane, light)| rows.set(lane, light, LIGHT_LENGTH));
        rows
    }

    fn hg(g: f32) -> Phase {
        Phase::compile(&PhaseDesc::HenyeyGreenstein { g }).unwrap()
    }

    /// How pairs are chosen: the phase function of a table with its extinction, or none, and the radius.
    type Choice<'a> = (Option<(&'a Phase, f32)>, f32);

    fn turns<'a>((table, _): Choice<'a>) -> Option<PairTurns<'a>> {
        table.map(|(phase, sigma_t)| PairTurns {
            on_camera: Phases::Same(phase),
            at_light: Phases::Each([phase; WIDTH]),
            rates: Row([sigma_t; WIDTH]),
            sigma_t,
        })
    }

    /// A pair of distances with the light of that number, and its density.
    fn pair(choice: Choice, light: usize, u: [f32; 2]) -> [f32; 3] {
        let (turns, lights, u) = (turns(choice), rows(), u.map(|u| Row([u; WIDTH])));
        let turns = turns.as_ref();
        let kernel = Pairs { camera: camera(), length: CAMERA_LENGTH, lights: &lights, radius: choice.1, turns, u: &u };
        Level::dispatch(kernel).map(|row| row.0[light])
    }

    #[test]
    fn pairs_follow_their_density() {
        let phases = [0.5, 0.8, -0.5].map(hg);
        let by_distance: [Choice; 2] = [(None, 0.0), (None, 0.2)];
        let by_turns = phases.iter().flat_map(|phase| [(Some((phase, 0.0)), 0.0), (Some((phase, 2.0)), 0.1)]);
        let choices: Vec<Choice> = by_distance.into_iter().chain(by_turns).collect();
        for (case, choice) in (0..).zip(&choices) {
            let turns = turns(*choice);
            let by_distance = RayPair::<Portable>::new(&camera(), CAMERA_LENGTH, &rows(), choice.1);
            let by_turns = turns.as_ref().map(|turns| TurningPair::new(by_distance, turns));
            for light in (0..lights().len()).step_by(1 + case as usize % 2) {
                let density = |[s, t]: [f32; 2]| {
                    let [s, t] = [s, t].map(Portable::splat);
                    let density = match &by_turns {
                        Some(pair) => pair.density(s, t),
                        None => by_distance.density_on_light(s).mul(by_distance.across(s).0.density(t)),
                    };
                    density.store().0[light]
                };
                let sample = |u: [f32; 2]| {
                    let [s, t, pdf] = pair(*choice, light, u);
                    // The table behind the density takes long: for one in eight, wherever they lie.
                    if ((u[0] * 4096.0) as u32).is_multiple_of(8) {
                        let expected = density([s, t]);
                        assert!((pdf - expected).abs() < 2e-3 * expected, "{choice:?}, {light}: {pdf} {expected}");
                    }
                    Some([s / LIGHT_LENGTH, t / CAMERA_LENGTH])
                };
                let per_square = |[s, t]: [f32; 2]| {
                    f64::from(density([s * LIGHT_LENGTH, t * CAMERA_LENGTH]) * LIGHT_LENGTH * CAMERA_LENGTH)
                };
                let outcome = chi2::square(sample, per_square, 100_000, case * 100 + light as u64);
                assert!((outcome.integral - 1.0).abs() < 1e-3, "{choice:?}, {light}: {outcome:?}");
                assert!(outcome.passes(0.01, choices.len() * lights().len()), "{choice:?}, {light}: {outcome:?}");
            }
        }
    }

    #[test]
    fn distances_follow_their_density() {
        let gs = [0.0, 0.8, -0.5];
        let targets = [Vec3::new(1.0, 0.3, -0.8), Vec3::new(2.0, 1e-3, 0.0), Vec3::new(-1.0, 0.2, 0.0)];
        let lane = 5;
        let mut rows = rows();
        rows.set(lane, &camera(), CAMERA_LENGTH);
        for (case, g) in (0..).zip(gs) {
            let phase = hg(g);
            let phases = Phases::Same(&phase);
            for (place, point) in (0..).zip(targets) {
                let (points, rates) = (point.to_array().map(|x| Row([x; WIDTH])), Row([1.0; WIDTH]));
                let draw = |u: f32| {
                    let (turns, u) = (Some((&phases, &rates)), Row([u; WIDTH]));
                    Level::dispatch(Distances { points: &points, rays: &rows, radius: 0.0, turns, u: &u })
                        .map(|row| row.0[lane])
                };
                let to_point = minus(load(&points), load(&rows.origin));
                let direction = load::<Portable>(&rows.direction);
                let across = EquiangularLanes::new(direction, Portable::load(&rows.length), to_point, 0.0);
                let (along, between) = (Portable::splat(1.0), Portable::splat(0.0));
                let turns = Turns { on_ray: &phases, at_point: None, along, between };
                let distances = TurnsOnRay::new(&turns, direction, across);
                let density = |s: f64| f64::from(distances.density(Portable::splat(s as f32)).store().0[lane]);
                let sample = |u| {
                    let [s, pdf] = draw(u).map(f64::from);
                    assert!((pdf / density(s) - 1.0).abs() < 2e-3, "{g} {point}: {pdf} at {s}");
                    Some(s)
                };
                let outcome =
                    chi2::interval(sample, density, 0.0, f64::from(CAMERA_LENGTH), 100_000, case * 10 + place);
                assert!((outcome.integral - 1.0).abs() < 1e-4, "{g} {point}: {outcome:?}");
                assert!(outcome.passes(0.01, gs.len() * targets.len()), "{g} {point}: {outcome:?}");
            }
        }
    }

    /// The integrand of both turns with its transmittances, over the density.
    fn weight(light: &Ray, phase: &Phase, [s, t, pdf]: [f32; 3]) -> f64 {
        let between = camera().at(t) - light.at(s);
        let (distance, direction) = (between.length(), between.normalize());
        let turned =
            phase.eval(light.at(s), light.direction, direction) * phase.eval(camera().at(t), direction, -Vec3::X);
        f64::from(turned * (-(s + t + distance)).exp() / (distance * distance * pdf))
    }

    /// Of `n` weights of pairs with the first light, which fills all lanes.
    fn moments(seed: u64, n: usize, phase: &Phase, table: Option<(&Phase, f32)>) -> Moments {
        let light = lights()[0];
        let mut rows = EightRays::default();
        (0..WIDTH).for_each(|lane| rows.set(lane, &light, LIGHT_LENGTH));
        let turns = turns((table, 0.0));
        let mut rng = Rng::keyed(seed, 0, 0);
        let mut moments = Moments::default();
        for _ in 0..n / WIDTH {
            let u = [0, 1].map(|_| Row(std::array::from_fn(|_| rng.f32())));
            let turns = turns.as_ref();
            let kernel = Pairs { camera: camera(), length: CAMERA_LENGTH, lights: &rows, radius: 0.0, turns, u: &u };
            let found = Level::dispatch(kernel);
            (0..WIDTH).for_each(|lane| moments.push(weight(&light, phase, [0, 1, 2].map(|i| found[i].0[lane]))));
        }
        moments
    }

    /// Quadrature of both turns, all extinctions and lengths one, 4 and 3, by a rule independent of the samplers.
    #[test]
    fn estimates_agree_with_quadrature_and_vary_less() {
        let rows = [
            (0.0, 3.055_167_16e-3, 10.0),
            (0.7, 9.799_10e-4, 30.0),
            (0.8, 4.321_69e-4, 30.0),
            (0.9, 9.950_36e-5, 30.0),
            (-0.7, 4.169_03e-4, 3.0),
        ];
        for (seed, (g, truth, gain)) in (0..).zip(rows) {
            let phase = hg(g);
            let by_table = moments(seed, 400_000, &phase, Some((&phase, 1.0)));
            let by_distance = moments(100 + seed, 400_000, &phase, None);
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

    #[test]
    fn every_level_gives_the_same_bits() {
        let phase = hg(0.7);
        let turns = turns((Some((&phase, 1.3)), 0.1));
        let lights = rows();
        let mut rng = Rng::keyed(1, 2, 3);
        for _ in 0..200 {
            let u = [0, 1].map(|_| Row(std::array::from_fn(|_| rng.f32())));
            for turns in [None, turns.as_ref()] {
                let kernel = Pairs { camera: camera(), length: 4.0, lights: &lights, radius: 0.1, turns, u: &u };
                let mut answers = Level::available().iter().map(|level| level.run(kernel));
                let first = answers.next().unwrap();
                assert!(answers.all(|other| other == first));
            }
        }
    }
}
