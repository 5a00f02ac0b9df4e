//! `jis`: volumetric path tracing with joint importance sampling of two scattering events.
//!
//! On a segment through a homogeneous medium an emitter's point d is chosen, and with it at once a point b on the segment
//! and a point c in the medium around, by [`crate::estimators::joint`]. Light of d that is scattered at c and b is found so
//! with the density `q p(d) p(b | d) p(w | b, d) p(c | b, w, d)`, and by the walk with `p_flight(b) p_phase(w)` times the
//! densities of its own techniques at c; the balance heuristic weighs all of them. `q` counts samples that are added to
//! those of the walk, which goes on as it would without.
//!
//! The line from b to c ends at the first surface, index-matched or not: c is in the medium of b. What the walk finds beyond
//! has the weight that it had.

use super::{EQUIANGULAR_LEGS, EQUIANGULAR_SHARE, Options, Tracer, Volpath, common};
use crate::estimators::equiangular::Equiangular;
use crate::estimators::pair::{Bend, Pair, Stretch};
use crate::integrators::components::Components;
use crate::integrators::{IntegratorInfo, ParameterInfo, ParameterKind};
use crate::math::{Ray, Sampler, Vec3};
use crate::scene::emitter::EmitterId;
use crate::walk::Segment;

/// The parameter of other integrators.
pub const JOINT: ParameterInfo = ParameterInfo {
    name: "joint",
    kind: ParameterKind::Boolean,
    default: "false",
    unit: "",
    description: "Whether two scattering events in homogeneous media are sampled jointly as well, as `jis` does.",
};

/// The registry's entry.
pub const INFO: IntegratorInfo = IntegratorInfo {
    name: "jis",
    aliases: &[],
    summary: "Volumetric path tracing with joint importance sampling of double scattering.",
    source: "Georgiev, Krivanek, Hachisuka, Nowrouzezahrai and Jarosz 2013",
    parameters: &[common::MAX_DEPTH, common::RR_DEPTH, common::HIDE_EMITTERS, Components::PARAMETER, EQUIANGULAR_LEGS],
    make: |parameters| Ok(Box::new(Volpath::new(Options { joint: true, ..Options::read(parameters, true)? }))),
};

impl Tracer<'_> {
    /// [`Bend::jointly`]. Apart from the code of those who do without.
    #[inline(never)]
    pub(super) fn jointly(
        &self,
        bend: &Bend,
        ray: &Ray,
        length: f32,
        t: f32,
        emitter: EmitterId,
        target: Vec3,
        normal: Vec3,
    ) -> f32 {
        bend.jointly(self.scene, &self.joints[bend.medium.0], ray, length, t, emitter, target, normal)
    }

    /// Adds light that is scattered twice: last on `segment`, and before around it.
    #[inline(never)]
    pub(super) fn connect_jointly(&mut self, segment: &Segment, stretch: &Stretch, sampler: &mut Sampler) {
        let mut history = self.history;
        history.scatter(true, false);
        if segment.scatterings + 3 > self.options.rules.max_depth
            || segment.leg + 1 >= self.options.equiangular_legs
            || !self.options.components.has(history.lit_straight(true))
        {
            return;
        }
        let (scene, joint) = (self.scene, &self.joints[segment.medium.0]);
        let Some(pair) = Pair::sample(scene, joint, segment, stretch, sampler) else { return };
        let (c, light, length) = (pair.c(), &pair.light, pair.beyond.length);
        let Some((arriving, survival)) = self.connect(c, light, Some(segment.medium), sampler) else { return };

        // Densities of the emitter per solid angle at c, times those of c where they differ.
        let share_c = EQUIANGULAR_SHARE * pair.beyond.lit;
        let by_emitter = (1.0 - share_c) * scene.lights.pdf_light_point(c, &pair.point).0;
        let by_phase = if light.delta { 0.0 } else { pair.phase[1].0 * survival };
        let from_c = scene.lights.segment_pdf(&pair.onward, length, c, light.emitter, light.position, light.normal);
        let near = Equiangular::new(&pair.onward, length, light.position).density(pair.along);
        let by_equiangular = share_c * from_c.0 * near.0 / pair.flown[1].0;
        let chosen = pair.density * light.pdf.0;
        let weight = chosen / (chosen + pair.walked() * (by_emitter + by_phase + by_equiangular));
        self.radiance += pair.throughput * arriving * (pair.phase[1].0 * weight);
    }
}
