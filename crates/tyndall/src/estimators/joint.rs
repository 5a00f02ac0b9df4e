//! Joint importance sampling of two scattering events (Georgiev et al. 2013).
//!
//! Light goes from a point d to c, to b and along the camera's ray. Not vertex by vertex but together, b on the ray and c in
//! space have a density proportional to the geometry terms and phase functions between them:
//!
//! - b: `p(t) ~ H / |bd|`, for the integral of `1 / (|bc|^2 |cd|^2)` over all c is `pi^3 / |bd|`. With phase functions it has
//!   a factor `H` that depends on the angle between the camera's ray and the direction to d only; 1 for isotropic
//!   scattering;
//! - the direction from b to c: `p(w) = p(phi) / (2 pi sin phi)` with `p(phi) ~ F(pi) - F(phi)`, phi the angle between w and
//!   the direction from b to d, and `F(theta)` the integral of the phase function at c over the angle from 0;
//!   `(pi - phi) / (pi^3 sin phi)` for isotropic scattering. The phase function at b is taken in as the other part of a
//!   one-sample mixture, unless it is isotropic;
//! - c on that line: equiangular about d, times the phase function at c.
//!
//! Lines end where the next surface is, and so do the densities of b and c. Transmittance is not part of them.

use super::equiangular::Equiangular;
use crate::math::{Frame, PerLength, PerSolidAngle, PerVolume, Ray, Vec2, Vec3};
use crate::scene::Scene;
use crate::scene::phase::Phase;
use std::f32::consts::{PI, TAU};

/// Cells of the tables over the angle.
const CELLS: usize = 1024;
/// Their extent, radians.
const WIDTH: f32 = PI / CELLS as f32;

/// Share of the directions that are chosen by the phase function at b, where it is not isotropic. Of 1/4 and 1/2 the better
/// for g = 0.7 and 0.8.
const TURNED: f32 = 0.25;

/// Isotropic scattering mixed into the tables, so that nothing is excluded.
const FLOOR: f64 = 0.01;

/// The tables for one phase function.
#[derive(Clone, Debug)]
pub struct Joint {
    /// None for isotropic scattering, whose integrals are in closed form.
    table: Option<Table>,
}

impl Joint {
    /// Tabulates `phase`. Of a function that differs from place to place or is not one of the cosine alone, the values at the
    /// origin along one axis serve: they change the density, not what can be found.
    pub fn new(phase: &Phase) -> Self {
        let value = |cos: f64| {
            let sin = (1.0 - cos * cos).max(0.0).sqrt();
            f64::from(phase.eval(Vec3::ZERO, Vec3::Z, Vec3::new(sin as f32, 0.0, cos as f32)))
        };
        Self { table: (!matches!(phase, Phase::Isotropic)).then(|| Table::new(value)) }
    }

    /// For all media of a scene.
    pub fn of_media(scene: &Scene) -> Vec<Self> {
        scene.media().iter().map(|medium| Self::new(medium.phase())).collect()
    }

    /// The densities of b on the first `length` metres of `ray`, finite, for light of `target`.
    #[inline]
    pub fn approach(&self, ray: &Ray, length: f32, target: Vec3) -> Approach<'_> {
        // In double precision: a short segment far away has a small range between large variables.
        let direction = ray.direction.as_dvec3();
        let to_target = target.as_dvec3() - ray.origin.as_dvec3();
        let delta = to_target.dot(direction);
        let height = (to_target - delta * direction).length().max(1e-6 * to_target.length()).max(1e-12);
        let (start, end) = ((-delta / height).asinh(), ((f64::from(length) - delta) / height).asinh());
        let table = self.table.as_ref();
        let integral = |variable: f64| table.map_or(variable, |table| table.approach.integral(variable));
        let (start, end) = (integral(start), integral(end));
        Approach { table, length, delta, height, start, range: (end - start).max(1e-12) }
    }

    /// A direction from the point b, to which the camera's walk has come along `arriving`, for light of `target`; `u` in
    /// [0, 1) chooses the part of the mixture, `u2` the direction. Its density is [`Onward::direction`].
    #[inline]
    pub fn sample_direction(&self, phase: &Phase, b: Vec3, arriving: Vec3, target: Vec3, u: f32, u2: Vec2) -> Vec3 {
        // The angle from the direction away from d, which the isotropic case knows without cancellation.
        let rest = match &self.table {
            None => PI * (1.0 - u2.x).sqrt(),
            Some(_) if u < TURNED => return phase.sample(b, arriving, u / TURNED, u2).0,
            Some(table) => PI - table.sample_start(u2.x),
        };
        let (sin, cos) = rest.sin_cos();
        let (y, x) = (TAU * u2.y).sin_cos();
        let to_target = target - b;
        let length = to_target.length();
        let axis = if length > 0.0 { to_target / length } else { Vec3::Z };
        Frame::from_normal(axis).to_world(Vec3::new(sin * x, sin * y, -cos))
    }

    /// What follows b: the first `length` metres of the ray `onward` that leaves it, for light of `target`.
    #[inline]
    pub fn onward(&self, onward: &Ray, length: f32, target: Vec3) -> Onward<'_> {
        let equiangular = Equiangular::new(onward, length, target);
        let table = self.table.as_ref();
        let (start, rest) = equiangular.angles_at_origin();
        let mass = table.map_or(1.0, |table| table.mass(start, equiangular.span()));
        Onward { table, equiangular, start, rest, mass }
    }
}

/// The densities of b, on a ray.
#[derive(Clone, Copy, Debug)]
pub struct Approach<'a> {
    table: Option<&'a Table>,
    length: f32,
    /// Distance along the ray of the foot of the perpendicular, metres.
    delta: f64,
    /// Distance of the point from the ray's line, metres, never zero.
    height: f64,
    /// Integral of the density over the variable `asinh((t - delta) / height)` up to the start of the ray, and over the ray.
    start: f64,
    range: f64,
}

impl Approach<'_> {
    /// The distance for `u` in [0, 1).
    #[inline]
    pub fn sample(&self, u: f32) -> f32 {
        let integral = self.start + f64::from(u) * self.range;
        let variable = self.table.map_or(integral, |table| table.approach.at(integral));
        ((self.delta + self.height * variable.sinh()) as f32).clamp(0.0, self.length)
    }

    /// Density of the distance `t`.
    #[inline]
    pub fn density(&self, t: f32) -> PerLength {
        let along = f64::from(t) - self.delta;
        let value = self.table.map_or(1.0, |table| table.approach.value((along / self.height).asinh()));
        PerLength((value / (self.range * (self.height * self.height + along * along).sqrt())) as f32)
    }
}

/// The densities of the direction from b to c, and of c along it.
#[derive(Clone, Copy, Debug)]
pub struct Onward<'a> {
    table: Option<&'a Table>,
    equiangular: Equiangular,
    /// The angle between the direction and that from b to d, and what it lacks to pi.
    start: f32,
    rest: f32,
    /// Integral of the phase function over the angles at which light may turn at c.
    mass: f32,
}

impl Onward<'_> {
    /// Density of the direction, where the phase function at b has the value `phase`.
    #[inline]
    pub fn direction(&self, phase: PerSolidAngle) -> PerSolidAngle {
        let sin = self.equiangular.sin_at_origin();
        PerSolidAngle(match self.table {
            None => self.rest / (PI * PI * PI * sin),
            Some(table) => (1.0 - TURNED) * table.start_density(self.start) / (TAU * sin) + TURNED * phase.0,
        })
    }

    /// The distance from b to c for `u` in [0, 1).
    #[inline]
    pub fn sample(&self, u: f32) -> f32 {
        match self.table {
            None => self.equiangular.sample(u),
            Some(table) => {
                let angle = table.turn(self.start, u * self.mass);
                self.equiangular.at(angle.min(self.equiangular.span()))
            }
        }
    }

    /// Density of the distance `t` from b to c.
    #[inline]
    pub fn density(&self, t: f32) -> PerLength {
        let even = self.equiangular.density(t);
        match self.table {
            None => even,
            Some(table) => {
                let angle = self.start + self.equiangular.angle(t);
                even * (self.equiangular.span() * table.value(Table::cell(angle)) / self.mass)
            }
        }
    }

    /// Density of c at the distance `t` in space, where the phase function at b has the value `phase`.
    #[inline]
    pub fn in_space(&self, phase: PerSolidAngle, t: f32) -> PerVolume {
        self.direction(phase).to_volume(t, self.density(t))
    }
}

/// A phase function over the angle by which light turns, the same all over a cell.
#[derive(Clone, Debug)]
struct Table {
    /// By node: integral of the phase function over all larger angles, 1/sr.
    beyond: Vec<f32>,
    /// By node: probability that the line from b makes a smaller angle with the direction to d.
    below: Vec<f32>,
    approach: Along,
}

impl Table {
    /// `value` is the phase function at a cosine, 1/sr.
    fn new(value: impl Fn(f64) -> f64 + Copy) -> Self {
        let width = std::f64::consts::PI / CELLS as f64;
        let mut beyond = vec![0.0; CELLS + 1];
        for i in (0..CELLS).rev() {
            let even = 0.25 * std::f64::consts::FRAC_1_PI;
            let value = value(((i as f64 + 0.5) * width).cos());
            beyond[i] = beyond[i + 1] + width * ((1.0 - FLOOR) * value + FLOOR * even);
        }
        let mut below = vec![0.0; CELLS + 1];
        for i in 0..CELLS {
            below[i + 1] = below[i] + beyond[i] + beyond[i + 1];
        }
        let single = |values: &[f64], unit: f64| values.iter().map(|v| (v / unit) as f32).collect();
        let approach = Along::new(value, &beyond);
        Self { beyond: single(&beyond, 1.0), below: single(&below, below[CELLS]), approach }
    }

    #[inline]
    fn cell(angle: f32) -> usize {
        ((angle / WIDTH) as usize).min(CELLS - 1)
    }

    /// The phase function in a cell, 1/sr.
    #[inline]
    fn value(&self, cell: usize) -> f32 {
        (self.beyond[cell] - self.beyond[cell + 1]) / WIDTH
    }

    /// Integral of the phase function from the angle `start` over `span`.
    #[inline]
    fn mass(&self, start: f32, span: f32) -> f32 {
        let end = (start + span).min(PI);
        let (first, last) = (Self::cell(start), Self::cell(end));
        if first == last {
            return span * self.value(first);
        }
        self.to_next(first, start)
            + (self.beyond[first + 1] - self.beyond[last])
            + self.value(last) * (end - last as f32 * WIDTH).max(0.0)
    }

    /// Integral from `start` to the end of its cell.
    #[inline]
    fn to_next(&self, cell: usize, start: f32) -> f32 {
        self.value(cell) * ((cell + 1) as f32 * WIDTH - start).max(0.0)
    }

    /// The span whose integral from the angle `start` is `mass`.
    #[inline]
    fn turn(&self, start: f32, mass: f32) -> f32 {
        let first = Self::cell(start);
        let beyond_first = mass - self.to_next(first, start);
        if beyond_first <= 0.0 || first + 1 == CELLS {
            return mass / self.value(first);
        }
        let rest = self.beyond[first + 1] - beyond_first;
        let cell = (first + self.beyond[first + 1..].partition_point(|beyond| *beyond >= rest)).min(CELLS - 1);
        cell as f32 * WIDTH - start + (self.beyond[cell] - rest).max(0.0) / self.value(cell)
    }

    /// An angle between the line from b and the direction to d for `u` in [0, 1).
    #[inline]
    fn sample_start(&self, u: f32) -> f32 {
        let cell = self.below.partition_point(|below| *below <= u).clamp(1, CELLS) - 1;
        let share = (u - self.below[cell]) / (self.below[cell + 1] - self.below[cell]);
        (cell as f32 + share) * WIDTH
    }

    /// Density of that angle, per radian.
    #[inline]
    fn start_density(&self, angle: f32) -> f32 {
        let cell = Self::cell(angle);
        (self.below[cell + 1] - self.below[cell]) / WIDTH
    }
}

/// Bound of the variable of [`Along`]; beyond, the ray's direction to the light hardly changes.
const FAR: f64 = 6.0;
/// Cells.
const ALONG: usize = 128;
/// Their extent.
const STEP: f64 = 2.0 * FAR / ALONG as f64;
/// Added to the values, whose mean is one: what they miss of narrow peaks stays within reach.
const LEAST: f64 = 0.05;

/// How much light is scattered twice towards the ray's origin from a place on it, over that of isotropic scattering: a function
/// of the angle between the ray and the direction to d alone. Tabulated over the variable `A = asinh((t - delta) / height)`,
/// in which the cosine of that angle is `-tanh A`; the same all over a cell.
#[derive(Clone, Debug)]
struct Along {
    /// By cell.
    values: Vec<f64>,
    /// By node: integral from the first one.
    integrals: Vec<f64>,
}

impl Along {
    /// `value` is the phase function at a cosine, `beyond` its integrals as in [`Table`].
    fn new(value: impl Fn(f64) -> f64, beyond: &[f64]) -> Self {
        const POLAR: usize = 64;
        const AZIMUTH: usize = 32;
        let scattered = |i: usize| {
            let cos_light = -(-FAR + (i as f64 + 0.5) * STEP).tanh();
            let sin_light = (1.0 - cos_light * cos_light).sqrt();
            let mut sum = 0.0;
            for j in 0..POLAR {
                let polar = (j as f64 + 0.5) / POLAR as f64;
                let (sin, cos) = (std::f64::consts::PI * polar).sin_cos();
                for k in 0..AZIMUTH {
                    let azimuth = std::f64::consts::PI * (k as f64 + 0.5) / AZIMUTH as f64;
                    let turn = cos_light * cos + sin_light * sin * azimuth.cos();
                    sum += value(turn.clamp(-1.0, 1.0)) * beyond[(polar * CELLS as f64) as usize];
                }
            }
            sum
        };
        let mut values: Vec<f64> = (0..ALONG).map(scattered).collect();
        let mean = values.iter().sum::<f64>() / ALONG as f64;
        values.iter_mut().for_each(|v| *v = *v / mean + LEAST);
        let mut integrals = vec![0.0];
        integrals.extend(values.iter().scan(0.0, |sum, v| {
            *sum += STEP * v;
            Some(*sum)
        }));
        Self { values, integrals }
    }

    #[inline]
    fn cell(variable: f64) -> usize {
        (((variable + FAR) / STEP) as usize).min(ALONG - 1)
    }

    #[inline]
    fn value(&self, variable: f64) -> f64 {
        self.values[Self::cell(variable)]
    }

    /// Integral up to the variable; the outer cells go on without end.
    #[inline]
    fn integral(&self, variable: f64) -> f64 {
        let cell = Self::cell(variable);
        self.integrals[cell] + self.values[cell] * (variable + FAR - cell as f64 * STEP)
    }

    /// The variable up to which the integral is that.
    #[inline]
    fn at(&self, integral: f64) -> f64 {
        let cell = self.integrals.partition_point(|i| *i <= integral).clamp(1, ALONG) - 1;
        cell as f64 * STEP - FAR + (integral - self.integrals[cell]) / self.values[cell]
    }
}

#[cfg(test)]
mod tests;
