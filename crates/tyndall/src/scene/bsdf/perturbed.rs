//! Bump and normal maps: models seen in a turned frame.

use super::{BsdfSample, Bsdfs, SurfaceContext, Transport};
use crate::Spectrum;
use crate::math::{Frame, PerSolidAngle, Vec2, Vec3};
use crate::scene::desc::BsdfId;
use crate::scene::shape::SurfacePoint;
use crate::scene::texture::Texture;

/// Where the normals come from.
#[derive(Clone, Debug)]
pub enum Relief {
    /// Heights, in the unit of the derivatives of the position once scaled.
    Heights {
        /// The heights.
        texture: Texture,
        /// Factor.
        scale: f32,
    },
    /// Normals in the shading frame; value `(c + 1) / 2` stands for the coordinate `c`.
    Normals(Texture),
}

impl Relief {
    /// Whether the relief depends on the point.
    pub(super) fn varies(&self) -> bool {
        match self {
            Self::Heights { texture, .. } | Self::Normals(texture) => texture.varies(),
        }
    }

    /// The turned normal in the shading frame, not normalised.
    #[inline]
    fn normal(&self, ctx: &SurfaceContext) -> Vec3 {
        match self {
            Self::Normals(texture) => Vec3::from_array(texture.eval(&ctx.texture).to_rgb()) * 2.0 - Vec3::ONE,
            Self::Heights { texture, scale } => {
                // Blinn 1978, without the derivatives of the normal.
                let slope = texture.gradient(&ctx.texture) * *scale;
                let u = ctx.shading().to_local(ctx.surface.dp_du);
                let v = ctx.shading().to_local(ctx.surface.dp_dv);
                let normal = Vec3::new(u.x, u.y, slope.x).cross(Vec3::new(v.x, v.y, slope.y));
                let outside = ctx.shading().to_local(ctx.surface.normal);
                if normal.dot(outside) < 0.0 { -normal } else { normal }
            }
        }
    }
}

/// A model under a bump or normal map.
#[derive(Clone, Debug)]
pub struct Perturbed {
    pub(super) relief: Relief,
    pub(super) flip_invalid_normals: bool,
    pub(super) use_shadowing_function: bool,
    pub(super) nested: BsdfId,
}

/// Probability with which light's walk takes the normal that is turned round for viewers whom the map's own faces away from.
const TURNED_ROUND: f32 = 0.125;

impl Perturbed {
    /// The map's normal as seen along `wo`, and whether it has been turned round for that.
    #[inline]
    fn seen(&self, normal: Vec3, wo: Vec3) -> (Vec3, bool) {
        if self.flip_invalid_normals && wo.z * wo.dot(normal) <= 0.0 {
            return (turn_round(normal), true);
        }
        (normal, false)
    }

    /// Whether some viewers see the normal turned round.
    #[inline]
    fn turns(&self, normal: Vec3) -> bool {
        self.flip_invalid_normals && (normal.x != 0.0 || normal.y != 0.0)
    }

    /// Probability with which light's walk takes the normal as it is, or turned round.
    #[inline]
    fn probability(&self, normal: Vec3, turned: bool) -> f32 {
        match (self.turns(normal), turned) {
            (false, _) => 1.0,
            (true, true) => TURNED_ROUND,
            (true, false) => 1.0 - TURNED_ROUND,
        }
    }

    /// The surface with the turned frame for its shading frame.
    #[inline]
    fn turned(ctx: &SurfaceContext, frame: &Frame) -> SurfacePoint {
        let [s, t, n] = [frame.s, frame.t, frame.n].map(|axis| ctx.shading().to_world(axis));
        SurfacePoint { shading: Frame { s, t, n }, ..*ctx.surface }
    }

    /// Share of the light that small bumps would let pass (Estevez et al. 2019).
    #[inline]
    fn shadowing(&self, frame: &Frame, wi: Vec3) -> f32 {
        if !self.use_shadowing_function {
            return 1.0;
        }
        let tan2 = |v: Vec3| (v.x * v.x + v.y * v.y) / (v.z * v.z);
        let alpha2 = (0.125 * tan2(frame.n)).min(1.0);
        2.0 / (1.0 + (1.0 + alpha2 * tan2(wi)).sqrt())
    }

    /// What the value of the nested model is multiplied by when `light` goes on to the viewer: with radiance the cosine is that
    /// of the turned normal and light's direction, and so it must be with importance, whose density on the surface has the
    /// cosine of the normal that shades (Veach 1997, section 5.3). `None` when the light is on the turned normal's other side.
    #[inline]
    fn adjoint(
        &self,
        frame: &Frame,
        [light, viewer]: [Vec3; 2],
        [inner_light, inner_viewer]: [Vec3; 2],
    ) -> Option<f32> {
        let denominator = light.z * inner_viewer.z;
        if !(light.z * inner_light.z > 0.0) || denominator == 0.0 {
            return None;
        }
        Some((inner_light.z * viewer.z / denominator).abs() * self.shadowing(frame, light))
    }

    #[inline]
    pub(super) fn sample(
        &self,
        bsdfs: &Bsdfs,
        ctx: &SurfaceContext,
        wo: Vec3,
        transport: Transport,
        u1: f32,
        u2: Vec2,
    ) -> Option<BsdfSample> {
        let map = self.relief.normal(ctx);
        // Which normal counts is up to the viewer. Light's walk does not know it yet.
        let (normal, turned, probability, u1) = match transport {
            Transport::Radiance => {
                let (normal, turned) = self.seen(map, wo);
                (normal, turned, 1.0, u1)
            }
            Transport::Importance if !self.turns(map) => (map, false, 1.0, u1),
            Transport::Importance if u1 < TURNED_ROUND => (turn_round(map), true, TURNED_ROUND, u1 / TURNED_ROUND),
            Transport::Importance => {
                let rest = 1.0 - TURNED_ROUND;
                (map, false, rest, ((u1 - TURNED_ROUND) / rest).min(1.0 - f32::EPSILON))
            }
        };
        let frame = frame(normal);
        let surface = Self::turned(ctx, &frame);
        let inner = SurfaceContext { surface: &surface, ..*ctx };
        let inner_wo = frame.to_local(wo);
        let sample = bsdfs.sample(self.nested, &inner, inner_wo, transport, u1, u2)?;
        let (wi, viewer) = match sample.event.null {
            true => (-wo, wo),
            false => (frame.to_world(sample.wi), frame.to_world(sample.wi)),
        };
        let factor = match transport {
            Transport::Importance if self.seen(map, viewer).1 != turned => return None,
            _ if sample.event.null => 1.0,
            Transport::Radiance if !(wi.z * sample.wi.z > 0.0) => return None,
            Transport::Radiance => self.shadowing(&frame, wi),
            Transport::Importance => self.adjoint(&frame, [wo, wi], [inner_wo, sample.wi])?,
        };
        let pdf = PerSolidAngle(sample.pdf.0 * probability);
        Some(BsdfSample { wi, weight: sample.weight * (factor / probability), pdf, ..sample })
    }

    #[inline]
    pub(super) fn eval(
        &self,
        bsdfs: &Bsdfs,
        ctx: &SurfaceContext,
        wo: Vec3,
        wi: Vec3,
        transport: Transport,
    ) -> (Spectrum, PerSolidAngle) {
        let map = self.relief.normal(ctx);
        let (normal, turned) = self.seen(map, if transport == Transport::Radiance { wo } else { wi });
        let frame = frame(normal);
        let (inner_wo, inner_wi) = (frame.to_local(wo), frame.to_local(wi));
        let (factor, probability) = match transport {
            Transport::Radiance if !(wi.z * inner_wi.z > 0.0) => return super::NOTHING,
            Transport::Radiance => (self.shadowing(&frame, wi), 1.0),
            Transport::Importance => match self.adjoint(&frame, [wo, wi], [inner_wo, inner_wi]) {
                Some(factor) => (factor, self.probability(map, turned)),
                None => return super::NOTHING,
            },
        };
        let surface = Self::turned(ctx, &frame);
        let inner = SurfaceContext { surface: &surface, ..*ctx };
        let (value, pdf) = bsdfs.eval(self.nested, &inner, inner_wo, inner_wi, transport);
        (value * factor, PerSolidAngle(pdf.0 * probability))
    }

    #[inline]
    pub(super) fn null_transmission(&self, bsdfs: &Bsdfs, ctx: &SurfaceContext, wo: Vec3) -> Spectrum {
        let frame = frame(self.seen(self.relief.normal(ctx), wo).0);
        let surface = Self::turned(ctx, &frame);
        let inner = SurfaceContext { surface: &surface, ..*ctx };
        bsdfs.null_transmission(self.nested, &inner, frame.to_local(wo))
    }
}

/// Half a turn about the shading normal, which brings a normal to the viewer's side (Schuessler et al. 2017).
#[inline]
fn turn_round(normal: Vec3) -> Vec3 {
    Vec3::new(-normal.x, -normal.y, normal.z)
}

/// The frame of a normal in coordinates of the shading frame.
#[inline]
fn frame(normal: Vec3) -> Frame {
    Frame::from_normal_and_tangent(normal.try_normalize().unwrap_or(Vec3::Z), Vec3::X)
}
