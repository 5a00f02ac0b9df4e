//! What a walk carries for the weights of multiple importance sampling: a few numbers for each vertex, updated from
//! vertex to vertex.
//!
//! Number the vertices of a full path from the light (0) to the lens (k). Let `pF(i)` be the density with which light's
//! walk finds vertex i and `pB(i)` that of the camera's walk, each per area or per volume. A connection between i and
//! i + 1 has the density `prod_{j<=i} pF(j) prod_{j>i} pB(j)`, a merge at m that of both walks finding m, times the
//! extent of its blur and the number of its light paths. For light's walk that has come to vertex i let `S(i)` be the sum
//! of the densities of all techniques that leave more of the path to the camera than the connection of i and i + 1, in
//! units of the density of that connection. Then (Krivanek et al. 2014, supplement; Georgiev 2012 for surfaces)
//!
//! `S(i) = pB(i) (eta(i) + (c(i-1) + S(i-1)) / pF(i))`
//!
//! with `eta(i)` the sum over the merges at i of number times extent, and `c(i-1)` one where i - 1 and i can be connected.
//! `pB(i)` and the reverse density inside `S(i-1)` wait for the next vertices. What remains, `c(i-1) / pF(i)` and the rest
//! without its reverse density, are the two numbers of an [`Arrival`]. The camera's walk carries the same from its end.

use super::density::{Cell, LightDensity};
use super::{Edge, FromLight, Mode};
use crate::math::Vec3;
use crate::scene::bsdf::Transport;
use crate::scene::emitter::EndDensity;
use crate::scene::medium::Medium;
use crate::scene::sensor::RayDensity;

/// How many samples the techniques take of each path, in units of one camera path joined with one light path; zero for
/// techniques not used.
#[derive(Clone, Debug)]
pub struct Effort {
    /// Connections and hits: 1 or 0.
    pub connect: f32,
    /// What joining two vertices counts that both walks have come to, in units of sampling an emitter.
    pub join: f32,
    /// Connections to the lens: light paths of a pass.
    pub lens: f32,
    /// Merging of points on surfaces: light paths times the area of the blur, m^2.
    pub surface: f32,
    /// Merging of points in media in three dimensions: light paths times the volume of the blur, m^3.
    pub point_point: f32,
    /// Merging of points with camera beams in two dimensions: light paths times the area of the blur, m^2.
    pub beam_point: f32,
    /// Merging of beams in one dimension: light paths times the width of the blur, m.
    pub beam_beam: f32,
    /// How densely light paths scatter, which says how many merges there are.
    pub light: LightDensity,
    /// At most so many times as many of the camera's walks come to their first vertex as go on from there.
    pub most_first: f32,
    /// Walks that go on where the camera's walk meets a rough mirror first.
    pub copies: f32,
    /// Whether the camera's walk passes all media to the first surface, besides another one that collides in them.
    pub split: bool,
}

impl Default for Effort {
    fn default() -> Self {
        Self::NONE
    }
}

impl Effort {
    /// Nothing is done.
    pub const NONE: Self = Self {
        connect: 0.0,
        join: 1.0,
        lens: 0.0,
        surface: 0.0,
        point_point: 0.0,
        beam_point: 0.0,
        beam_beam: 0.0,
        light: LightDensity::UNKNOWN,
        most_first: 1.0,
        copies: 1.0,
        split: false,
    };

    /// Light paths merged where the camera's walk has scattered before, for each merged at its first vertex.
    pub const BEYOND: f32 = 1.0 / 16.0;

    /// The share of the camera's walks that are joined with a walk of light, beside merges.
    pub const JOINED: f32 = 1.0 / 4.0;

    /// What joining two vertices that both walks have come to counts beside merges: all joints of a walk of light with one of
    /// the camera's share the noise of both, and merges find the same paths.
    pub const JOIN: f32 = Self::JOINED / 16.0;

    /// Walks that go on, beside merges, where the camera's walk meets a rough mirror first: what is seen in one is better
    /// looked for than told from light that arrives nearby.
    pub const COPIES: f32 = 2.0;

    /// What all merges of a place count at most, in walks, where the camera's walk comes from a rough mirror: it shows much the
    /// same wherever in its lobe they look.
    pub const MIRRORED: f32 = 4.0;

    /// Merges on a surface for which one sample of direct light at the camera's first vertex counts: it varies less from
    /// sample to sample than the number of photons that lie there by chance.
    pub const DIRECT: f32 = 8.0;

    /// What is merged at `x` in `medium`.
    #[inline]
    pub fn in_medium(&self, medium: &Medium, x: Vec3) -> Merges {
        let Cell { density, ball, disk, .. } = self.light.in_medium(x);
        let point_point = self.point_point * ball * ball * ball;
        let beam_point = self.beam_point * disk * disk;
        let length = self.light.beam_length(medium.sigma_t(x).mean());
        // Beams meet under all angles, whose mean sine is pi / 4.
        let beams = beam_point + std::f32::consts::FRAC_PI_4 * self.beam_beam * length;
        let (first, share) = self.shares(density * (point_point + beams * length));
        Merges { first, share, mirrored: share, point_point, beam_point, beam_beam: self.beam_beam, ..Merges::NONE }
    }

    /// What is merged at `x` on a surface wide enough in its scattering.
    #[inline]
    pub fn on_surface(&self, x: Vec3) -> Merges {
        let Cell { density, disk, .. } = self.light.on_surface(x);
        let surface = self.surface * disk * disk;
        let expected = density * surface;
        let (first, share) = self.shares(expected);
        let mirrored = (Self::MIRRORED / (1.0 + expected)).min(1.0);
        Merges { first, share, mirrored, surface, ..Merges::NONE }
    }

    /// The same on a rough mirror.
    #[inline]
    pub fn on_mirror(&self, merges: Merges) -> Merges {
        Merges { first: 1.0 / self.copies, mirror: true, ..merges }
    }

    /// The first two of [`Merges`] where so many merges are expected for each camera's walk that is merged with all.
    #[inline(always)]
    fn shares(&self, expected: f32) -> (f32, f32) {
        ((1.0 + expected).min(self.most_first), Self::BEYOND / (1.0 + Self::BEYOND * expected))
    }
}

/// What is merged at a place, in the units of [`Effort`].
#[derive(Clone, Copy, Debug)]
pub struct Merges {
    /// How many times as many of the camera's walks come here first as go on from here; less than one where more go on.
    pub first: f32,
    /// The share of the merges that there is and that counts: see [`crate::walk::density`].
    pub share: f32,
    /// The same where the camera's walk comes from a rough mirror.
    pub mirrored: f32,
    /// Whether the place is a rough mirror.
    pub mirror: bool,
    /// What a connection with the vertex counts, in units of those of a camera's walk that has gone on.
    pub connect: f32,
    /// How many times as much the camera's walks find direct light, by sampling emitters or running into them.
    pub direct: f32,
    /// As in [`Effort`], with the radii of the place ...
    pub surface: f32,
    /// ... in all techniques.
    pub point_point: f32,
    /// Camera beams and points.
    pub beam_point: f32,
    /// Beams.
    pub beam_beam: f32,
}

impl Merges {
    /// Nothing.
    pub const NONE: Self = Self {
        first: 1.0,
        share: 1.0,
        mirrored: 1.0,
        mirror: false,
        connect: 1.0,
        direct: 1.0,
        surface: 0.0,
        point_point: 0.0,
        beam_point: 0.0,
        beam_beam: 0.0,
    };

    /// Where the camera's walk has not scattered before: all counts, and more than beyond, where few walks come.
    #[inline(always)]
    pub fn first(self) -> Self {
        let direct = if self.surface > 0.0 { Effort::DIRECT } else { 1.0 };
        Self { share: self.first, connect: self.first, direct, ..self }
    }

    /// What running into an emitter from here counts: all walks that go on look for one, and if more come here, these do.
    #[inline(always)]
    pub fn hits(&self) -> f32 {
        self.connect.max(1.0)
    }

    /// Where `leg` of the camera's walk ends.
    #[inline(always)]
    pub fn at_end_of(self, leg: &Leg) -> Self {
        match (leg.first, leg.reflected) {
            (true, _) => self.first(),
            (false, true) => Self { share: self.mirrored, ..self },
            (false, false) => self,
        }
    }
}

/// A vertex where a walk may scatter, as far as weights ask.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    /// Position, metres.
    pub position: Vec3,
    /// Direction of travel on arrival.
    pub arriving: Vec3,
    /// Unit geometric normal of a surface; zero in media.
    pub normal: Vec3,
    /// What is merged here.
    pub merges: Merges,
}

impl Corner {
    /// Whether the vertex is inside a medium.
    #[inline(always)]
    pub fn in_medium(&self) -> bool {
        self.normal == Vec3::ZERO
    }

    /// Cosine by which areas across a direction become areas of the surface; one in media.
    #[inline(always)]
    pub fn cos(&self, direction: Vec3) -> f32 {
        if self.in_medium() { 1.0 } else { self.normal.dot(direction).abs() }
    }
}

/// A walk that has come to a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Arrival {
    /// Whether the last vertex is on the emitter: what is before is direct light of this one.
    pub emitted: bool,
    /// Technique that connects the last vertex with this one, over the density of this one.
    pub connected: f32,
    /// All techniques before, over the density of this one; to be multiplied by the reverse density of direction.
    pub before: f32,
    /// The same if this vertex is a rough mirror.
    pub mirrored: f32,
    /// In media: probability that a beam of this walk covers the place, over the density of a collision there, m.
    pub covered: f32,
}

/// A vertex and what the walk that has come there carries.
#[derive(Clone, Copy, Debug)]
pub struct End {
    /// The vertex.
    pub corner: Corner,
    /// What the walk carries.
    pub arrival: Arrival,
    /// As in [`Leg::first`].
    pub first: bool,
    /// Whether it is merged with all of light's walks: not only with those for places where the camera's has scattered before.
    pub merges_all: bool,
}

/// A walk on its way to the next vertex.
#[derive(Clone, Copy, Debug)]
pub struct Leg {
    /// Where it starts: the vertex, the point of the lens, the point on an emitter.
    pub start: Vec3,
    /// Whether the camera's walk has met nothing yet but smooth mirrors and glass: all merges at its end count.
    pub first: bool,
    /// Whether the camera's walk comes from a rough mirror, and has met nothing since but smooth mirrors and glass.
    pub reflected: bool,
    /// Whether the leg is one of the camera's that pass all media for certain, as in [`Effort::split`].
    pub certain: bool,
    /// Density of the direction, 1/sr; per area across the direction where all rays are parallel; one after a smooth
    /// mirror or glass.
    pub density: f32,
    /// Whether the density falls with the squared distance.
    pub spreads: bool,
    /// Weight of the technique that connects the start with the next vertex, in units of its density by walks.
    pub connect: f32,
    /// As in [`Effort::join`]: factor of that, if the next vertex is not on an emitter.
    pub join: f32,
    /// What running into an emitter at the end counts.
    pub hits: f32,
    /// As in [`Merges::direct`], of the start.
    pub direct: f32,
    /// Whether the start is on the emitter.
    pub emitted: bool,
    /// Cosine at the start.
    pub cos: f32,
    /// Whether the start is a vertex inside a medium.
    pub in_medium: bool,
    /// Techniques before, by the density with which the walk from the other end would collide at the start ...
    pub collided: f32,
    /// ... the same if the next vertex is a rough mirror ...
    pub mirrored: f32,
    /// ... and by the probability that its beam would cover the start.
    pub covering: f32,
}

impl Leg {
    /// Light's first leg, from a place of that density; [`Leg::lit`] adds the connection, which depends on its end.
    #[inline]
    pub fn from_emitter(effort: &Effort, density: &EndDensity, start: Vec3) -> Self {
        let collided = if density.hittable { effort.connect / density.place } else { 0.0 };
        Self {
            start,
            first: false,
            reflected: false,
            certain: false,
            density: density.onward,
            spreads: !density.parallel,
            connect: 0.0,
            join: 1.0,
            hits: 1.0,
            direct: 1.0,
            emitted: true,
            cos: density.cos,
            in_medium: false,
            collided,
            mirrored: collided,
            covering: 0.0,
        }
    }

    /// Light's first leg, where the density with which the emitter is sampled from its end is `sampled`.
    #[inline]
    pub fn lit(self, effort: &Effort, density: &EndDensity, sampled: f32) -> Self {
        Self { connect: effort.connect * sampled / density.place, ..self }
    }

    /// The camera's first leg.
    #[inline]
    pub fn from_lens(effort: &Effort, lens: &RayDensity) -> Self {
        Self {
            start: lens.lens,
            first: true,
            reflected: false,
            certain: effort.split,
            density: lens.density,
            spreads: !lens.parallel,
            connect: effort.lens,
            join: 1.0,
            hits: 1.0,
            direct: 1.0,
            emitted: false,
            cos: 1.0,
            in_medium: false,
            collided: 0.0,
            mirrored: 0.0,
            covering: 0.0,
        }
    }

    /// The leg of the camera's walk that follows `last` at a corner, where it scatters by chance or not.
    #[inline]
    pub fn following(self, last: &Self, corner: &Corner, by_chance: bool) -> Self {
        Self {
            first: last.first && !by_chance,
            certain: last.certain && !by_chance,
            reflected: if by_chance { corner.merges.mirror } else { last.reflected },
            ..self
        }
    }

    /// Factor of the spread of directions up to `position`, 1/m^2; 1 where rays are parallel.
    #[inline(always)]
    pub fn spread(&self, position: Vec3) -> f32 {
        if self.spreads { 1.0 / self.start.distance_squared(position) } else { 1.0 }
    }

    /// All techniques before the start's connection with the vertex at the other end of `edge`, over the density of
    /// both; to be multiplied by the density with which the other walk chooses the direction of the edge, and by its
    /// spread. The second is for a rough mirror at the other end.
    #[inline]
    pub fn before<M: Mode>(&self, edge: &Edge) -> [f32; 2] {
        // Camera beams run to the end of a stretch that a flight has come to, light beams to the collision.
        let beam = match M::TRANSPORT {
            Transport::Importance => edge.survival / edge.stretches[0],
            Transport::Radiance => edge.survival,
        };
        let departure = edge.departure(self.in_medium);
        [self.collided, self.mirrored].map(|collided| self.cos * (departure * collided + beam * self.covering))
    }

    /// As [`Leg::before`] of light's walk, where the other end is the lens.
    #[inline]
    pub fn before_lens(&self, effort: &Effort, edge: &Edge) -> f32 {
        if !effort.split {
            return self.before::<FromLight>(edge)[0];
        }
        let departure = if self.in_medium { edge.departure(true) } else { 1.0 };
        self.cos * (departure * self.collided + self.covering)
    }

    /// The walk comes to a vertex through `edge`, where `cos` is as in [`Corner::cos`] and `spread` as in
    /// [`Leg::spread`].
    #[inline]
    pub fn arrive<M: Mode>(&self, edge: &Edge, spread: f32, cos: f32, in_medium: bool) -> Arrival {
        // The spread is that of the reverse density as well, and may be infinite where a leg has no length.
        let passed = self.certain && !in_medium;
        let density = self.density * cos * if passed { 1.0 } else { edge.arrival(in_medium) };
        let inverse = if density > 0.0 { 1.0 / density } else { 0.0 };
        let covered = match M::TRANSPORT {
            Transport::Importance => 1.0 / edge.rates[1],
            Transport::Radiance if self.certain => 1.0 / (edge.survival * edge.rates[1]),
            Transport::Radiance => 1.0 / (edge.stretches[1] * edge.rates[1]),
        };
        let connected = self.connect * self.join * inverse / spread;
        let [before, mirrored] = self.before::<M>(edge).map(|before| before * inverse);
        Arrival { emitted: self.emitted, connected, before, mirrored, covered }
    }
}

impl Arrival {
    /// The technique that connects the last vertex with this one and all before, where `merges` says what they count and
    /// `reverse` is the reverse density of direction.
    #[inline(always)]
    pub fn behind(&self, merges: &Merges, reverse: f32) -> f32 {
        let Merges { connect, direct, mirror, .. } = *merges;
        let before = if mirror { self.mirrored } else { self.before };
        if self.emitted {
            direct * (connect * self.connected + merges.hits() * before * reverse)
        } else {
            connect * self.connected + before * reverse
        }
    }

    /// The walk goes on from `corner` along `direction`. `density` is that of the direction, `None` for a smooth mirror or
    /// glass; `reverse` that of the walk from the other end going on to the vertex before.
    #[inline]
    pub fn depart<M: Mode>(
        &self,
        effort: &Effort,
        corner: &Corner,
        direction: Vec3,
        density: Option<f32>,
        reverse: f32,
    ) -> Leg {
        let (start, in_medium) = (corner.position, corner.in_medium());
        let leg = Leg {
            start,
            first: false,
            reflected: false,
            certain: false,
            density: density.unwrap_or(1.0),
            spreads: true,
            connect: 0.0,
            join: 1.0,
            hits: 1.0,
            direct: 1.0,
            emitted: false,
            cos: corner.cos(direction),
            in_medium,
            collided: self.before,
            mirrored: self.mirrored,
            covering: 0.0,
        };
        // Forth and back a smooth mirror or glass takes a direction with the same probability.
        if density.is_none() {
            return leg;
        }
        let Merges { share, connect, direct, surface, point_point, beam_point, beam_beam, .. } = corner.merges;
        let behind = self.behind(&corner.merges, reverse);
        let (mut collided, mut covering) = (behind, 0.0);
        if in_medium {
            let sin = corner.arriving.cross(direction).length();
            collided += share * point_point;
            match M::TRANSPORT {
                Transport::Importance => covering = share * (beam_point + beam_beam * sin * self.covered),
                Transport::Radiance => {
                    collided += share * beam_point * self.covered;
                    covering = share * beam_beam * sin * self.covered;
                }
            }
        } else {
            collided += share * surface;
        }
        // The camera's walk knows where it comes from, light's does not know where it goes.
        let mirrored = match M::TRANSPORT {
            Transport::Importance if !in_medium => behind + corner.merges.mirrored * surface,
            _ => collided,
        };
        let (connect, hits) = (connect * effort.connect, corner.merges.hits());
        Leg { connect, join: effort.join, hits, direct, collided, mirrored, covering, ..leg }
    }
}
