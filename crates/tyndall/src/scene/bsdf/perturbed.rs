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

impl Perturbed {
    /// The turned frame in coordinates of the shading frame.
    #[inline]
    fn frame(&self, ctx: &SurfaceContext, wo: Vec3) -> Frame {
        let mut n = self.relief.normal(ctx);
        if self.flip_invalid_normals && wo.z * wo.dot(n) <= 0.0 {
            // Half a turn about the shading normal brings it to the viewer's side (Schuessler et al. 2017).
            n = Vec3::new(-n.x, -n.y, n.z);
        }
        Frame::from_normal_and_tangent(n.try_normalize().unwrap_or(Vec3::Z), Vec3::X)
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
        let frame = self.frame(ctx, wo);
        let surface = Self::turned(ctx, &frame);
        let inner = SurfaceContext { surface: &surface, ..*ctx };
        let sample = bsdfs.sample(self.nested, &inner, frame.to_local(wo), transport, u1, u2)?;
        if sample.event.null {
            return Some(BsdfSample { wi: -wo, ..sample });
        }
        let wi = frame.to_world(sample.wi);
        if !(wi.z * sample.wi.z > 0.0) {
            return None;
        }
        Some(BsdfSample { wi, weight: sample.weight * self.shadowing(&frame, wi), ..sample })
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
        let frame = self.frame(ctx, wo);
        let inner_wi = frame.to_local(wi);
        if !(wi.z * inner_wi.z > 0.0) {
            return super::NOTHING;
        }
        let surface = Self::turned(ctx, &frame);
        let inner = SurfaceContext { surface: &surface, ..*ctx };
        let (value, pdf) = bsdfs.eval(self.nested, &inner, frame.to_local(wo), inner_wi, transport);
        (value * self.shadowing(&frame, wi), pdf)
    }

    #[inline]
    pub(super) fn null_transmission(&self, bsdfs: &Bsdfs, ctx: &SurfaceContext, wo: Vec3) -> Spectrum {
        let frame = self.frame(ctx, wo);
        let surface = Self::turned(ctx, &frame);
        let inner = SurfaceContext { surface: &surface, ..*ctx };
        bsdfs.null_transmission(self.nested, &inner, frame.to_local(wo))
    }
}
