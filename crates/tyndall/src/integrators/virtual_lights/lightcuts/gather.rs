//! The points of a pixel where light is gathered.

use super::super::camera::Stretch;
use super::super::wanted;
use super::Options;
use crate::Spectrum;
use crate::estimators::cells::Cells;
use crate::math::{Sampler, Vec2};
use crate::scene::Scene;
use crate::walk::{FromCamera, Onward, Profile, Scattering, Segment, Sink, Start, Vertex, walk};

/// The sink that keeps vertices of the camera's walk, dimmed by media, over smooth mirrors and glass up to the first other
/// surface: points on the stretches through media, and that surface.
pub(super) struct Gatherer<'a> {
    pub(super) options: &'a Options,
    pub(super) scene: &'a Scene,
    pub(super) profile: &'a mut Profile,
    pub(super) points: &'a mut Vec<Vertex>,
}

impl Gatherer<'_> {
    /// Keeps the points seen at the film position (pixels of the whole film), in units of `share`.
    pub(super) fn gather(&mut self, film: Vec2, share: f32, sampler: &mut Sampler) {
        let lens = Vec2::new(sampler.rng().f32(), sampler.rng().f32());
        let camera = self.scene.sensor.sample_ray(film, lens);
        let start = Start { throughput: Spectrum::grey(share), unit: share, ..Start::seen(self.scene, &camera) };
        walk::<FromCamera, _>(self.scene, start, &self.options.camera_rules, sampler, self);
    }
}

impl Sink for Gatherer<'_> {
    fn segment(&mut self, segment: &Segment, sampler: &mut Sampler) {
        let scattering = Scattering::Medium { medium: segment.medium };
        if !self.options.counts(0, segment.scatterings) || !wanted(self.options.components, &scattering) {
            return;
        }
        let Some((ray, length)) = self.profile.trace_segment(self.scene, segment, sampler.rng()) else { return };
        let (profile, medium) = (&*self.profile, self.scene.medium(segment.medium));
        let cells = Cells::new(length, |t| (profile.at(t) * medium.sigma_s(ray.at(t))).mean());
        // Fewer where the ray passes almost unscattered.
        let scattered = 1.0 - profile.at(length).min_channel();
        let count = (self.options.points as f32 * scattered).ceil().max(1.0);
        let stretch = Stretch { segment, ray, length };
        for i in 0..count as u32 {
            let (t, density) = cells.sample((i as f32 + sampler.rng().f32()) / count);
            self.points.push(stretch.vertex(self.scene, profile, t, density.0 * count));
        }
    }

    fn vertex(&mut self, vertex: &Vertex, _sampler: &mut Sampler) {
        let Scattering::Surface { point, .. } = &vertex.scattering else { return };
        if self.scene.is_smooth(point.shape) && wanted(self.options.components, &vertex.scattering) {
            self.points.push(*vertex);
        }
    }

    fn scattered(&mut self, _vertex: &Vertex, onward: &Onward) -> bool {
        onward.pdf.is_none()
    }
}
