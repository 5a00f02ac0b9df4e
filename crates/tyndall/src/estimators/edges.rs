//! Connecting by eight edges at once: for each lane what [`transfer`](super::connect::transfer) answers for one.
//!
//! Distances, phase functions of Henyey and Greenstein, Lambertian surfaces and the transmittance of homogeneous media are
//! computed in lanes; what is rarer is asked for lane by lane.

use super::transport::{SHORT_OF, turned};
use crate::Spectrum;
use crate::math::functions::{exp, sin_cos_of_turn};
use crate::math::lanes::{Kernel, Lanes, Level, Mask, Row, WIDTH};
use crate::math::triples::{along, dot, load, minus, store};
use crate::math::{Ray, Rng, Vec3};
use crate::scene::Scene;
use crate::scene::bsdf::Transport;
use crate::scene::desc::MediumId;
use crate::scene::medium::Extinction;
use crate::scene::phase::Phase;
use crate::scene::shape::{Shadow, SurfacePoint};
use crate::walk::flight::Uniform;
use crate::walk::{FromCamera, FromLight, Mode, Scattering, Vertex, passage_from};

/// How the light that a vertex scatters depends on the direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Manner {
    /// By a phase function of Henyey and Greenstein, or not at all.
    Phase,
    /// By the cosine alone, on the side of arrival.
    Lambert,
    /// In any other way.
    Other,
}

/// A vertex of a walk as edges need it.
#[derive(Clone, Copy, Debug)]
pub struct Junction {
    /// Metres.
    pub position: Vec3,
    /// Throughput on arrival; of Lambertian surfaces that times the BSDF, for light times its cosines on arrival too.
    pub throughput: Spectrum,
    /// How light leaves.
    pub manner: Manner,
    /// Unit direction of travel on arrival; of Lambertian surfaces the shading normal on the side of arrival.
    axis: Vec3,
    /// Geometric normal of a surface.
    normal: Vec3,
    /// How far rays start off the surface, metres; 0 in media.
    epsilon: f32,
    /// Mean cosine of the phase function.
    g: f32,
    /// Media on the side of the normal and on the other one.
    media: [Option<MediumId>; 2],
}

impl Junction {
    /// A vertex in `medium`, where a walk arrives along `direction`.
    #[inline(always)]
    pub fn in_medium(scene: &Scene, medium: MediumId, position: Vec3, direction: Vec3, throughput: Spectrum) -> Self {
        let (manner, g) = match scene.medium(medium).phase().henyey_greenstein() {
            Some(g) => (Manner::Phase, g),
            None => (Manner::Other, 0.0),
        };
        let (normal, media) = (Vec3::ZERO, [Some(medium); 2]);
        Self { position, throughput, manner, axis: direction, normal, epsilon: 0.0, g, media }
    }

    /// A vertex of a walk.
    #[inline]
    pub fn new<M: Mode>(scene: &Scene, vertex: &Vertex) -> Self {
        match &vertex.scattering {
            Scattering::Medium { medium } => {
                Self::in_medium(scene, *medium, vertex.position, vertex.direction, vertex.throughput)
            }
            Scattering::Surface { point, medium } => Self::on_surface::<M>(scene, vertex, point, *medium),
        }
    }

    fn on_surface<M: Mode>(scene: &Scene, vertex: &Vertex, point: &SurfacePoint, medium: Option<MediumId>) -> Self {
        let media = [point.normal, -point.normal].map(|side| scene.medium_towards(point, side, medium));
        let junction = Self {
            position: point.position,
            throughput: vertex.throughput,
            manner: Manner::Other,
            axis: vertex.direction,
            normal: point.normal,
            epsilon: point.epsilon,
            g: 0.0,
            media,
        };
        let arrival = point.shading.to_local(-vertex.direction);
        // Light turns by the BSDF with its arguments exchanged, and by the geometric cosines.
        let cosines = match M::TRANSPORT {
            Transport::Radiance => 1.0,
            Transport::Importance => (arrival.z / vertex.direction.dot(point.normal)).abs(),
        };
        match scene.bsdfs.ceiling(scene.bsdf_of(point.shape), &scene.surface_context(point), arrival) {
            Some(ceiling) if ceiling.exact => Self {
                throughput: junction.throughput * ceiling.value * if cosines.is_finite() { cosines } else { 0.0 },
                manner: Manner::Lambert,
                axis: point.shading.n * 1.0_f32.copysign(arrival.z),
                ..junction
            },
            _ => junction,
        }
    }
}

/// Where [`Manner::Other`] is asked.
#[derive(Clone, Copy, Debug)]
pub enum Source<'a> {
    /// A vertex.
    Vertex(&'a Vertex),
    /// The phase function of a medium.
    Phase(&'a Phase),
}

/// One end of eight edges, all of one [`Manner`].
#[derive(Clone, Copy, Debug)]
pub struct Junctions<'a> {
    /// Metres: x, y, z.
    pub position: [Row; 3],
    /// Throughputs, a row for each channel, as in [`Junction`].
    pub throughput: [Row; 3],
    manner: Manner,
    axis: [Row; 3],
    normal: [Row; 3],
    epsilon: Row,
    g: Row,
    media: [[Option<MediumId>; 2]; WIDTH],
    sources: [Option<Source<'a>>; WIDTH],
}

const ZERO: Row = Row([0.0; WIDTH]);

#[inline(always)]
fn put(rows: &mut [Row; 3], lane: usize, [x, y, z]: [f32; 3]) {
    let [a, b, c] = rows;
    (a.0[lane & 7], b.0[lane & 7], c.0[lane & 7]) = (x, y, z);
}

#[inline(always)]
fn take([x, y, z]: &[Row; 3], lane: usize) -> Vec3 {
    Vec3::new(x.0[lane & 7], y.0[lane & 7], z.0[lane & 7])
}

impl<'a> Junctions<'a> {
    /// Ends from which nothing comes.
    pub fn none() -> Self {
        Self {
            position: [ZERO; 3],
            throughput: [ZERO; 3],
            manner: Manner::Phase,
            axis: [ZERO; 3],
            normal: [ZERO; 3],
            epsilon: ZERO,
            g: ZERO,
            media: [[None; 2]; WIDTH],
            sources: [None; WIDTH],
        }
    }

    /// The same end for all edges.
    #[inline]
    pub fn all(end: &Junction, source: Source<'a>) -> Self {
        let rows = |v: [f32; 3]| v.map(|x| Row([x; WIDTH]));
        Self {
            position: rows(end.position.to_array()),
            throughput: rows(end.throughput.to_rgb()),
            manner: end.manner,
            axis: rows(end.axis.to_array()),
            normal: rows(end.normal.to_array()),
            epsilon: Row([end.epsilon; WIDTH]),
            g: Row([end.g; WIDTH]),
            media: [end.media; WIDTH],
            sources: [Some(source); WIDTH],
        }
    }

    /// Puts an end into a lane; all lanes must be of its manner.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, end: &Junction, source: Source<'a>) {
        put(&mut self.position, lane, end.position.to_array());
        put(&mut self.throughput, lane, end.throughput.to_rgb());
        put(&mut self.axis, lane, end.axis.to_array());
        put(&mut self.normal, lane, end.normal.to_array());
        self.epsilon.0[lane & 7] = end.epsilon;
        self.g.0[lane & 7] = end.g;
        self.media[lane & 7] = end.media;
        self.sources[lane & 7] = Some(source);
        self.manner = end.manner;
    }

    /// Moves the end in a lane.
    #[inline(always)]
    pub fn put(&mut self, lane: usize, position: Vec3, throughput: Spectrum) {
        put(&mut self.position, lane, position.to_array());
        put(&mut self.throughput, lane, throughput.to_rgb());
    }

    /// Positions and throughputs after `t` metres along the directions of arrival through a medium of extinction `sigma_t` (1/m),
    /// if the distances were chosen with densities `pdf` (1/m); no throughput where that is zero.
    #[inline]
    pub fn after(&self, t: &Row, sigma_t: Spectrum, pdf: &Row) -> [[Row; 3]; 2] {
        Level::dispatch(After { from: self, t, sigma_t, pdf })
    }

    /// How light leaves.
    #[inline(always)]
    pub fn manner(&self) -> Manner {
        self.manner
    }

    /// What a walk does that turns into the unit vectors, 1/sr, `cosine` being the normals whose cosine counts; 1 for
    /// [`Manner::Other`].
    #[inline(always)]
    fn turn<L: Lanes>(&self, direction: [L; 3], cosine: &[Row; 3]) -> L {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        match self.manner {
            Manner::Phase => {
                let g = L::load(&self.g);
                let (size, gap) = (g.abs(), one.sub(g.abs()));
                let sign = zero.sub(one).select(g.lt(zero), one);
                let [x, y, z] = load::<L>(&self.axis);
                let chord = minus(direction, [sign.mul(x), sign.mul(y), sign.mul(z)]);
                let base = gap.mul(gap).add(size.mul(dot(chord, chord)));
                let factor = gap.mul(one.add(size)).mul(L::splat(0.25 * std::f32::consts::FRAC_1_PI));
                factor.div(base.mul(base.sqrt()))
            }
            Manner::Lambert => {
                let lit = zero.lt(dot(direction, load(&self.axis)));
                dot(direction, load(cosine)).abs().select(lit, zero)
            }
            Manner::Other => one,
        }
    }

    /// The ends, moved off their surfaces to the side of the vectors; and which are on the side of the normal.
    #[inline(always)]
    fn departure<L: Lanes>(&self, direction: [L; 3]) -> ([L; 3], u32) {
        let (normal, epsilon) = (load::<L>(&self.normal), L::load(&self.epsilon));
        let below = dot(direction, normal).lt(L::splat(0.0));
        let offset = L::splat(0.0).sub(epsilon).select(below, epsilon);
        (along(load(&self.position), offset, normal), !below.bits())
    }

    /// What [`Manner::Other`] does with a walk that turns into the unit vector.
    #[inline]
    fn turned<M: Mode>(&self, scene: &Scene, lane: usize, direction: Vec3) -> Spectrum {
        match self.sources[lane & 7] {
            Some(Source::Vertex(vertex)) => turned::<M>(scene, vertex, direction),
            Some(Source::Phase(phase)) => {
                Spectrum::grey(phase.eval(take(&self.position, lane), take(&self.axis, lane), direction))
            }
            None => Spectrum::ZERO,
        }
    }
}

/// The arguments of [`Junctions::after`].
struct After<'a> {
    from: &'a Junctions<'a>,
    t: &'a Row,
    sigma_t: Spectrum,
    pdf: &'a Row,
}

impl Kernel for After<'_> {
    type Output = [[Row; 3]; 2];

    #[inline(always)]
    fn run<L: Lanes>(self) -> [[Row; 3]; 2] {
        let (zero, t, pdf) = (L::splat(0.0), L::load(self.t), L::load(self.pdf));
        let weight = L::splat(1.0).div(pdf).select(zero.lt(pdf), zero);
        let position = along(load(&self.from.position), t, load(&self.from.axis));
        let mut throughput = [ZERO; 3];
        for (c, row) in throughput.iter_mut().enumerate() {
            let left = exp(t.mul(L::splat(-self.sigma_t[c])));
            *row = L::load(&self.from.throughput[c]).mul(left).mul(weight).store();
        }
        [store(position), throughput]
    }
}

/// Edges from `light` to `camera`.
#[derive(Clone, Copy, Debug)]
pub struct Edges<'a> {
    /// Vertices of light's walks.
    pub light: &'a Junctions<'a>,
    /// Vertices of the camera's.
    pub camera: &'a Junctions<'a>,
    /// Light comes from all of a ball of this radius, metres, seen along a direction within the ball's cone; the half space when
    /// the camera's vertex lies in it (Novak et al. 2012b; Hasan et al. 2009). 0: from its centre.
    pub radius: f32,
    /// Random numbers that choose the direction.
    pub u: &'a [Row; 2],
    /// Bound on 1/d^2, 1/m^2; 0: none.
    pub clamp: f32,
    /// How many edges there are, from the first lane on.
    pub count: usize,
    /// Factors of their light.
    pub weight: &'a Row,
}

/// Edges before it is known what is in the way.
struct Reaches {
    /// Turns, as far as lanes know them, and spread, 1/(m^2 sr^2).
    value: Row,
    /// The directions as if along which light turns.
    turning: [Row; 3],
    /// The shadow rays.
    origin: [Row; 3],
    direction: [Row; 3],
    length: Row,
    /// Lanes in which light leaves on the side of the normal.
    above: u32,
    /// Lanes in which light may arrive.
    possible: u32,
}

struct Reaching<'a>(&'a Edges<'a>);

impl Kernel for Reaching<'_> {
    type Output = Reaches;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Reaches {
        let Edges { light, camera, radius, u, clamp, count, .. } = *self.0;
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let between = minus(load::<L>(&camera.position), load(&light.position));
        let square = dot(between, between);
        let inverse = one.div(square.sqrt());
        let direction = between.map(|x| x.mul(inverse));
        let mut spread = one.div(square);
        let mut turning = direction;
        if radius > 0.0 {
            (turning, spread) = from_ball(direction, spread, radius, [L::load(&u[0]), L::load(&u[1])]);
        }
        if clamp > 0.0 {
            spread = spread.min(L::splat(clamp));
        }
        let [x, y, z] = turning;
        let back = [zero.sub(x), zero.sub(y), zero.sub(z)];
        let value = light.turn(turning, &light.normal).mul(camera.turn(back, &camera.axis)).mul(spread);
        let [x, y, z] = direction;
        let (from, above) = light.departure(direction);
        let (to, _) = camera.departure([zero.sub(x), zero.sub(y), zero.sub(z)]);
        let way = minus(to, from);
        let length = dot(way, way).sqrt();
        let inverse = one.div(length);
        let possible = zero.lt(value).and(zero.lt(square)).and(zero.lt(length)).bits();
        Reaches {
            value: value.store(),
            turning: store(turning),
            origin: store(from),
            direction: store([way[0].mul(inverse), way[1].mul(inverse), way[2].mul(inverse)]),
            length: length.mul(L::splat(SHORT_OF)).store(),
            above,
            possible: possible & ((1 << count) - 1),
        }
    }
}

/// The directions as if along which light turns that comes from balls, and one over the areas that stand for the squared
/// distances.
#[inline(always)]
fn from_ball<L: Lanes>(direction: [L; 3], spread: L, radius: f32, u: [L; 2]) -> ([L; 3], L) {
    let (zero, one, square) = (L::splat(0.0), L::splat(1.0), L::splat(radius * radius));
    let sin2 = square.mul(spread).min(one);
    // One minus the cosine, without cancellation.
    let cap = sin2.div(one.add(one.sub(sin2).sqrt()));
    let part = u[0].mul(cap);
    let cos = one.sub(part);
    let sin = part.mul(one.add(cos)).sqrt();
    let (y, x) = sin_cos_of_turn(u[1]);
    let (x, y) = (sin.mul(x), sin.mul(y));
    // The frame around the direction (Duff et al. 2017).
    let [nx, ny, nz] = direction;
    let sign = zero.sub(one).select(nz.lt(zero), one);
    let a = zero.sub(one).div(sign.add(nz));
    let b = nx.mul(ny).mul(a);
    let s = [one.add(sign.mul(nx).mul(nx).mul(a)), sign.mul(b), zero.sub(sign.mul(nx))];
    let t = [b, sign.add(ny.mul(ny).mul(a)), zero.sub(ny)];
    let mut turning = direction;
    for (i, axis) in turning.iter_mut().enumerate() {
        *axis = s[i].mul(x).add(t[i].mul(y)).add(axis.mul(cos));
    }
    (turning, L::splat(2.0).mul(cap).div(square))
}

/// What light arrives with.
struct Arrivals<'a> {
    edges: &'a Edges<'a>,
    value: &'a Row,
    length: &'a Row,
    /// Factors of the channels that were found lane by lane; 0 where nothing arrives.
    factor: &'a [Row; 3],
    /// Extinction, 1/m.
    sigma_t: &'a [Row; 3],
}

impl Kernel for Arrivals<'_> {
    type Output = [Row; 3];

    #[inline(always)]
    fn run<L: Lanes>(self) -> [Row; 3] {
        let Edges { light, camera, weight, .. } = self.edges;
        let value = L::load(self.value).mul(L::load(weight));
        let back = L::splat(0.0).sub(L::load(self.length));
        let mut sums = [ZERO; 3];
        for (c, sum) in sums.iter_mut().enumerate() {
            let throughput = L::load(&light.throughput[c]).mul(L::load(&camera.throughput[c]));
            let factor = L::load(&self.factor[c]);
            let arriving = exp(L::load(&self.sigma_t[c]).mul(back)).mul(factor).mul(throughput).mul(value);
            // What is blocked may be infinitely near.
            *sum = arriving.select(L::splat(0.0).lt(factor), L::splat(0.0)).store();
        }
        sums
    }
}

impl Edges<'_> {
    /// Radiance that all edges bring, weighed.
    pub fn radiance(&self, scene: &Scene, rng: &mut Rng) -> Spectrum {
        let reaches = Level::dispatch(Reaching(self));
        let mut factor = [ZERO; 3];
        let mut open = reaches.possible;
        if self.light.manner == Manner::Other || self.camera.manner == Manner::Other {
            let mut lanes = open;
            while lanes != 0 {
                let lane = lanes.trailing_zeros() as usize;
                lanes &= lanes - 1;
                let turns = self.other_turns(scene, lane, take(&reaches.turning, lane));
                put(&mut factor, lane, turns.to_rgb());
                if turns.is_black() {
                    open &= !(1 << lane);
                }
            }
        } else {
            factor = [Row([1.0; WIDTH]); 3];
        }
        if open == 0 {
            return Spectrum::ZERO;
        }
        let rays = std::array::from_fn(|lane| Ray {
            origin: take(&reaches.origin, lane),
            direction: take(&reaches.direction, lane),
        });
        let mut hits = [None; WIDTH];
        let [clear, transparent] = scene.geometry.shadows(&rays, &reaches.length.0, open, &mut hits);
        let mut sigma_t = [ZERO; 3];
        let mut last = None;
        let mut lanes = clear | transparent;
        let blocked = !lanes;
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize & 7;
            lanes &= lanes - 1;
            let medium = self.light.media[lane][usize::from(reaches.above >> lane & 1 == 0)];
            let shadow = match hits[lane] {
                Some(hit) => Shadow::Transparent(hit),
                None => {
                    let Some(id) = medium else { continue };
                    let inside = scene.medium(id);
                    if let Extinction::Homogeneous(model) = inside.kind() {
                        // Most edges are in the medium of the one before.
                        let rate = match last {
                            Some((same, rate)) if same == id => rate,
                            _ => Uniform::along(model, inside.phase(), &rays[lane]).sigma_t,
                        };
                        last = (!inside.phase().is_anisotropic_medium()).then_some((id, rate));
                        put(&mut sigma_t, lane, rate.to_rgb());
                        continue;
                    }
                    Shadow::Clear
                }
            };
            let passage = passage_from(scene, shadow, rays[lane], reaches.length.0[lane], medium, rng);
            let transmittance = passage.map_or(Spectrum::ZERO, |passage| passage.transmittance);
            let turns = Spectrum::from_rgb(take(&factor, lane).to_array());
            put(&mut factor, lane, (turns * transmittance).to_rgb());
        }
        for row in &mut factor {
            for (lane, factor) in row.0.iter_mut().enumerate() {
                *factor = if blocked >> lane & 1 == 1 { 0.0 } else { *factor };
            }
        }
        let arrivals = Arrivals {
            edges: self,
            value: &reaches.value,
            length: &reaches.length,
            factor: &factor,
            sigma_t: &sigma_t,
        };
        Spectrum::from_rgb(Level::dispatch(arrivals).map(|row| row.0.iter().sum()))
    }

    #[inline]
    fn other_turns(&self, scene: &Scene, lane: usize, turning: Vec3) -> Spectrum {
        let mut turns = Spectrum::ONE;
        if self.camera.manner == Manner::Other {
            turns = self.camera.turned::<FromCamera>(scene, lane, -turning);
        }
        if self.light.manner == Manner::Other && !turns.is_black() {
            turns *= self.light.turned::<FromLight>(scene, lane, turning);
        }
        turns
    }
}
