//! All emitters of a scene, and the choice among them.
//!
//! A choice has two steps: an emitter, by its importance for the receiver; then a point on it or a direction towards it.
//! Finite emitters are found through a [`LightTree`]; those at infinity share a fixed fraction, by fluence. Every density
//! here includes the probability of the first step.

use super::area::Area;
use super::emission::EmissionTable;
use super::error::{EmitterError, EmitterProblem, number};
use super::shapes;
use super::tree::LightTree;
use super::{Constant, Emitter, EmitterId, Reach};
use crate::Spectrum;
use crate::math::{PerArea, PerSolidAngle, Ray, Vec2, Vec3};
use crate::scene::desc::{AreaEmitterDesc, EmitterDesc};
use crate::scene::shape::{AreaPoint, Geometry, SurfacePoint};
use crate::scene::texture::TexturePoint;
use std::sync::Arc;

/// Probability of choosing an emitter at infinity, when there are others.
const INFINITE_SHARE: f32 = 0.5;
/// Longest segment, metres, that the importance along it tells from an infinite one.
const LONGEST: f32 = 1e12;

/// Light that may arrive at a point.
#[derive(Clone, Copy, Debug)]
pub struct EmitterSample {
    /// Unit direction from the point to the emitter.
    pub direction: Vec3,
    /// Distance to the emitter, metres; for emitters at infinity, far enough to leave the scene.
    pub distance: f32,
    /// The point at that distance.
    pub position: Vec3,
    /// Unit normal of an area emitter there; zero for others.
    pub normal: Vec3,
    /// Incident radiance, W/(m^2 sr). For delta emitters the incident irradiance at right angles (W/m^2), so that
    /// `f * radiance / pdf` is the contribution of either.
    pub radiance: Spectrum,
    /// Density of the direction, selection included; for delta emitters the probability of the selection.
    pub pdf: PerSolidAngle,
    /// Whether no other technique can find this light.
    pub delta: bool,
    /// The emitter chosen. Emitters at infinity that are not delta answer together, under the name of one of them.
    pub emitter: EmitterId,
}

/// A point on an emitter, chosen for a segment; the receiver on the segment comes later.
#[derive(Clone, Copy, Debug)]
pub struct LightPoint {
    /// Position, metres.
    pub position: Vec3,
    /// Unit normal of an area emitter; zero for delta emitters.
    pub normal: Vec3,
    /// Radiance that an area emitter sends from there, W/(m^2 sr).
    radiance: Spectrum,
    /// Density of the point on an area emitter, selection not included.
    density: PerArea,
    /// Probability of the selection.
    pub selection: f32,
    /// Whether the emitter is a single point.
    pub delta: bool,
    /// The emitter.
    pub emitter: EmitterId,
}

/// All emitters of a scene.
#[derive(Debug)]
pub struct Lights {
    emitters: Vec<Emitter>,
    tree: LightTree,
    /// Emitters at infinity that can be chosen, with the probability of the choice.
    infinite: Vec<(EmitterId, f32)>,
    /// By shape, the emitter it is.
    of_shape: Vec<Option<EmitterId>>,
    pub(super) geometry: Arc<Geometry>,
    /// Sphere around the scene, metres.
    pub(super) centre: Vec3,
    radius: f32,
    pub(super) emission: EmissionTable,
}

impl Lights {
    /// The emitters of a description. `areas` lists the shapes that emit: name, index, emission. Directions out of the scene
    /// end beyond the box around `geometry`.
    pub fn new<'a>(
        descs: &[EmitterDesc],
        areas: impl IntoIterator<Item = (&'a str, u32, &'a AreaEmitterDesc)>,
        geometry: Arc<Geometry>,
    ) -> Result<Self, EmitterError> {
        let mut emitters = Vec::new();
        let mut weights = Vec::new();
        let mut of_shape = Vec::new();
        let mut add = |name: &str, emitter: Result<Emitter, EmitterProblem>, sampling_weight: f32| {
            let weight = number("sampling_weight", sampling_weight, "at least 0", |w| w >= 0.0);
            let (emitter, weight) = emitter
                .and_then(|e| Ok((e, weight?)))
                .map_err(|problem| EmitterError { emitter: name.into(), problem })?;
            emitters.push(emitter);
            weights.push(weight);
            Ok(EmitterId(emitters.len() as u32 - 1))
        };
        for desc in descs {
            add(&desc.name, Emitter::new(desc), desc.sampling_weight)?;
        }
        for (name, shape, desc) in areas {
            let id = add(name, Area::new(desc, shape, &geometry).map(Emitter::Area), desc.sampling_weight)?;
            of_shape.resize(of_shape.len().max(shape as usize + 1), None);
            of_shape[shape as usize] = Some(id);
        }

        let mut finite = Vec::new();
        let mut infinite = Vec::new();
        for ((id, emitter), weight) in (0..).zip(&emitters).zip(&weights) {
            match emitter.reach() {
                Reach::Finite(mut bound) => {
                    bound.intensity *= weight;
                    finite.push((id, bound));
                }
                Reach::Infinite(fluence) => infinite.push((EmitterId(id), fluence * weight)),
            }
        }
        let tree = LightTree::new(&finite, emitters.len());
        infinite.retain(|(_, fluence)| *fluence > 0.0);
        let share = if tree.is_empty() { 1.0 } else { INFINITE_SHARE };
        let total: f32 = infinite.iter().map(|(_, fluence)| fluence).sum();
        infinite.iter_mut().for_each(|(_, fluence)| *fluence *= share / total);
        let bounds = geometry.bounds();
        let (centre, radius) =
            if bounds.is_empty() { (Vec3::ZERO, 1.0) } else { (bounds.centre(), 0.5 * bounds.extent().length()) };
        let emission = EmissionTable::new(&emitters, &weights, &geometry, centre, radius);
        Ok(Self { emitters, tree, infinite, of_shape, geometry, centre, radius, emission })
    }

    /// The emitters; their indices are the ids.
    pub fn emitters(&self) -> &[Emitter] {
        &self.emitters
    }

    /// Whether there are emitters at finite distances.
    #[inline(always)]
    pub fn any_finite(&self) -> bool {
        !self.tree.is_empty()
    }

    /// Whether the emitter is at a finite distance.
    #[inline(always)]
    pub fn is_finite(&self, emitter: EmitterId) -> bool {
        !matches!(
            self.emitters[emitter.0 as usize],
            Emitter::Directional(_) | Emitter::Constant(_) | Emitter::Envmap(_)
        )
    }

    /// Extent of the smallest emitter, metres; zero for points and directions, `None` for surroundings only.
    pub fn smallest_extent(&self) -> Option<f32> {
        let extent = |emitter: &Emitter| match emitter {
            Emitter::Area(area) => Some(self.geometry.area(area.shape).sqrt()),
            Emitter::Constant(_) | Emitter::Envmap(_) => None,
            _ => Some(0.0),
        };
        self.emitters.iter().filter_map(extent).reduce(f32::min)
    }

    /// The emitter that a shape is.
    #[inline]
    pub fn of_shape(&self, shape: u32) -> Option<EmitterId> {
        self.of_shape.get(shape as usize).copied().flatten()
    }

    /// Light that may arrive at `x`: an emitter chosen with `choice`, a point or direction with `u`. `None` when the choice
    /// cannot light `x`.
    #[inline]
    pub fn sample(&self, x: Vec3, choice: f32, u: Vec2) -> Option<EmitterSample> {
        let (emitter, selection) = self.select(x, choice)?;
        let mut sample = match &self.emitters[emitter.0 as usize] {
            Emitter::Area(area) => {
                let (point, pdf) = shapes::sample_from(&self.geometry, area.shape, x, u)?;
                let texture_point = TexturePoint::on_emitter(&point, self.geometry.mesh(area.shape));
                let radiance = |direction| area.radiance(&texture_point, point.normal, direction);
                finite_sample(x, point.position, point.normal, emitter, |direction| {
                    (direction.dot(point.normal) > 0.0).then(|| (radiance(direction), pdf))
                })?
            }
            Emitter::Directional(light) => {
                EmitterSample { radiance: light.irradiance, delta: true, ..self.escape(x, -light.direction, emitter) }
            }
            Emitter::Constant(_) => return Some(self.environment(x, Constant::sample(u), emitter)),
            Emitter::Envmap(map) => return Some(self.environment(x, map.sample(u), emitter)),
            point => point.at_point(x, emitter)?,
        };
        sample.pdf.0 *= selection;
        Some(sample)
    }

    /// Density with which [`Lights::sample`] at `from` returns the point `hit` of a shape. Zero for shapes that do not
    /// emit towards `from`.
    #[inline]
    pub fn pdf_hit(&self, from: Vec3, hit: &SurfacePoint) -> PerSolidAngle {
        self.pdf_point(from, hit.shape, hit.position, hit.normal)
    }

    /// Density with which [`Lights::sample`] at `x` returns the point `y` (as [`Lights::incident`] saw it from `x`); the
    /// probability of the selection for a delta emitter.
    #[inline]
    pub fn pdf_light_point(&self, x: Vec3, y: &LightPoint) -> PerSolidAngle {
        match &self.emitters[y.emitter.0 as usize] {
            Emitter::Area(area) => self.pdf_point(x, area.shape, y.position, y.normal),
            _ => PerSolidAngle(self.point_selection_pdf(x, y.emitter)),
        }
    }

    #[inline]
    pub(super) fn pdf_point(&self, from: Vec3, shape: u32, position: Vec3, normal: Vec3) -> PerSolidAngle {
        match self.of_shape(shape) {
            Some(emitter) if (from - position).dot(normal) > 0.0 => {
                shapes::pdf_from(&self.geometry, shape, from, position, normal)
                    * self.point_selection_pdf(from, emitter)
            }
            _ => PerSolidAngle(0.0),
        }
    }

    /// Density with which [`Lights::sample`] returns a direction that leaves the scene.
    #[inline]
    pub fn pdf_escape(&self, direction: Vec3) -> PerSolidAngle {
        let mut pdf = PerSolidAngle(0.0);
        for &(id, selection) in &self.infinite {
            pdf = pdf
                + match &self.emitters[id.0 as usize] {
                    Emitter::Constant(_) => Constant::PDF * selection,
                    Emitter::Envmap(map) => map.pdf(direction) * selection,
                    _ => PerSolidAngle(0.0),
                };
        }
        pdf
    }

    /// Radiance seen along a ray that travels in `direction` and hits `point`, W/(m^2 sr).
    #[inline]
    pub fn radiance_surface(&self, point: &SurfacePoint, direction: Vec3) -> Spectrum {
        let Some(id) = self.of_shape(point.shape) else { return Spectrum::ZERO };
        let Emitter::Area(area) = &self.emitters[id.0 as usize] else { return Spectrum::ZERO };
        area.radiance(&TexturePoint::new(point, self.geometry.mesh(point.shape)), point.normal, -direction)
    }

    /// Radiance seen along a ray that leaves the scene in `direction`, W/(m^2 sr).
    #[inline]
    pub fn radiance_escape(&self, direction: Vec3) -> Spectrum {
        let mut radiance = Spectrum::ZERO;
        for emitter in &self.emitters {
            match emitter {
                Emitter::Constant(constant) => radiance += constant.radiance,
                Emitter::Envmap(map) => radiance += map.radiance(direction),
                _ => {}
            }
        }
        radiance
    }

    /// A point on a finite emitter, chosen for the segment of `ray` up to `t_max`. `None` without such emitters.
    #[inline]
    pub fn sample_for_segment(&self, ray: &Ray, t_max: f32, choice: f32, u: Vec2) -> Option<LightPoint> {
        let t_max = t_max.min(LONGEST);
        let (id, selection) = self.tree.select(|i| i.along_segment(ray, t_max), choice)?;
        let id = EmitterId(id);
        let mut point = self.point_on(id, u)?;
        point.selection = selection;
        Some(point)
    }

    /// A point on a finite emitter, as if it alone had been chosen.
    #[inline]
    pub fn point_on(&self, emitter: EmitterId, u: Vec2) -> Option<LightPoint> {
        Some(match &self.emitters[emitter.0 as usize] {
            Emitter::Area(area) => {
                let (point, density) = self.geometry.sample_area(area.shape, u)?;
                let texture_point = TexturePoint::on_emitter(&point, self.geometry.mesh(area.shape));
                let radiance = area.radiance(&texture_point, point.normal, point.normal);
                let AreaPoint { position, normal, .. } = point;
                LightPoint { position, normal, radiance, density, selection: 1.0, delta: false, emitter }
            }
            point => LightPoint {
                position: point.position()?,
                normal: Vec3::ZERO,
                radiance: Spectrum::ZERO,
                density: PerArea(1.0),
                selection: 1.0,
                delta: true,
                emitter,
            },
        })
    }

    /// The light that `y` sends to `x`; its density is that of [`Lights::sample_for_segment`]. `None` when `y` cannot
    /// light `x`.
    #[inline]
    pub fn incident(&self, x: Vec3, y: &LightPoint) -> Option<EmitterSample> {
        let mut sample = match &self.emitters[y.emitter.0 as usize] {
            Emitter::Area(_) => finite_sample(x, y.position, y.normal, y.emitter, |direction| {
                let cos = direction.dot(y.normal);
                (cos > 0.0).then(|| (y.radiance, y.density.to_solid_angle((y.position - x).length(), cos)))
            })?,
            point => point.at_point(x, y.emitter)?,
        };
        sample.pdf.0 *= y.selection;
        Some(sample)
    }

    /// Density with which [`Lights::sample_for_segment`] and [`Lights::incident`] at `x` find the point `position` of
    /// `emitter`, where the normal is `normal`; the probability of the selection for a delta emitter, zero for an emitter at
    /// infinity.
    #[inline]
    pub fn segment_pdf(
        &self,
        ray: &Ray,
        t_max: f32,
        x: Vec3,
        emitter: EmitterId,
        position: Vec3,
        normal: Vec3,
    ) -> PerSolidAngle {
        let selection = self.segment_selection_pdf(ray, t_max, emitter);
        let Emitter::Area(area) = &self.emitters[emitter.0 as usize] else { return PerSolidAngle(selection) };
        let to_x = x - position;
        let distance = to_x.length();
        let cos = to_x.dot(normal) / distance;
        if !(cos > 0.0) {
            return PerSolidAngle(0.0);
        }
        self.geometry.area_pdf(area.shape).to_solid_angle(distance, cos) * selection
    }

    /// Probability that [`Lights::sample`] at `x` chooses `emitter`.
    #[inline]
    pub fn point_selection_pdf(&self, x: Vec3, emitter: EmitterId) -> f32 {
        if let Some((_, probability)) = self.infinite.iter().find(|(id, _)| *id == emitter) {
            return *probability;
        }
        self.tree.probability(|i| i.at_point(x), emitter.0) * self.finite_share()
    }

    /// Probability that [`Lights::sample_for_segment`] chooses `emitter`; zero for emitters at infinity.
    #[inline]
    pub fn segment_selection_pdf(&self, ray: &Ray, t_max: f32, emitter: EmitterId) -> f32 {
        let t_max = t_max.min(LONGEST);
        self.tree.probability(|i| i.along_segment(ray, t_max), emitter.0)
    }

    /// Probability that an emitter at a finite distance is chosen.
    #[inline]
    pub fn finite_share(&self) -> f32 {
        if self.infinite.is_empty() { 1.0 } else { 1.0 - INFINITE_SHARE }
    }

    /// An emitter for the point `x` and the probability of the choice.
    #[inline]
    pub(super) fn select(&self, x: Vec3, mut choice: f32) -> Option<(EmitterId, f32)> {
        for &(id, probability) in &self.infinite {
            if choice < probability {
                return Some((id, probability));
            }
            choice -= probability;
        }
        let share = self.finite_share();
        let choice = (choice / share).min(1.0 - f32::EPSILON);
        match self.tree.select(|i| i.at_point(x), choice) {
            Some((id, probability)) => Some((EmitterId(id), probability * share)),
            // Only rounding leads here when all emitters are at infinity.
            None => self.infinite.last().copied(),
        }
    }

    /// What all emitters at infinity but delta ones send to `x` against `direction`.
    #[inline]
    fn environment(&self, x: Vec3, direction: Vec3, emitter: EmitterId) -> EmitterSample {
        EmitterSample {
            radiance: self.radiance_escape(direction),
            pdf: self.pdf_escape(direction),
            ..self.escape(x, direction, emitter)
        }
    }

    /// A sample of density one and no radiance, out of the scene.
    #[inline]
    fn escape(&self, x: Vec3, direction: Vec3, emitter: EmitterId) -> EmitterSample {
        let distance = (x - self.centre).length() + self.radius;
        EmitterSample {
            direction,
            distance,
            position: x + direction * distance,
            normal: Vec3::ZERO,
            radiance: Spectrum::ZERO,
            pdf: PerSolidAngle(1.0),
            delta: false,
            emitter,
        }
    }
}

impl Emitter {
    /// What an emitter that is a point sends to `x`, with density one. `None` when that is nothing.
    #[inline]
    fn at_point(&self, x: Vec3, emitter: EmitterId) -> Option<EmitterSample> {
        let mut sample = finite_sample(x, self.position()?, Vec3::ZERO, emitter, |direction| {
            let intensity = match self {
                Self::Point(point) => point.intensity,
                Self::Spot(spot) => spot.intensity(direction),
                Self::Projector(projector) => projector.intensity(direction),
                _ => Spectrum::ZERO,
            };
            (!intensity.is_black()).then_some((intensity, PerSolidAngle(1.0)))
        })?;
        sample.radiance *= 1.0 / (sample.distance * sample.distance);
        sample.delta = true;
        Some(sample)
    }
}

/// The sample of the point `position`; `light` returns radiance and density of what leaves it in a direction.
#[inline]
fn finite_sample(
    x: Vec3,
    position: Vec3,
    normal: Vec3,
    emitter: EmitterId,
    light: impl FnOnce(Vec3) -> Option<(Spectrum, PerSolidAngle)>,
) -> Option<EmitterSample> {
    let to_light = position - x;
    let distance = to_light.length();
    if !(distance > 0.0) {
        return None;
    }
    let direction = to_light / distance;
    let (radiance, pdf) = light(-direction)?;
    (pdf.0 > 0.0).then_some(EmitterSample {
        direction,
        distance,
        position,
        normal,
        radiance,
        pdf,
        delta: false,
        emitter,
    })
}
