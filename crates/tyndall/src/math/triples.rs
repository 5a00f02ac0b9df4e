//! Vectors over lanes.

use super::Vec3;
use super::lanes::{Lanes, Row};

/// `a + t d`.
#[inline(always)]
pub(crate) fn along<L: Lanes>(a: [L; 3], t: L, d: [L; 3]) -> [L; 3] {
    [a[0].add(t.mul(d[0])), a[1].add(t.mul(d[1])), a[2].add(t.mul(d[2]))]
}

/// Three numbers, each in all lanes.
#[inline(always)]
pub(crate) fn splat<L: Lanes>(v: Vec3) -> [L; 3] {
    [L::splat(v.x), L::splat(v.y), L::splat(v.z)]
}

/// Eight vectors.
#[inline(always)]
pub(crate) fn load<L: Lanes>([x, y, z]: &[Row; 3]) -> [L; 3] {
    [L::load(x), L::load(y), L::load(z)]
}

/// Eight vectors, to memory.
#[inline(always)]
pub(crate) fn store<L: Lanes>([x, y, z]: [L; 3]) -> [Row; 3] {
    [x.store(), y.store(), z.store()]
}

/// `a - b`.
#[inline(always)]
pub(crate) fn minus<L: Lanes>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [a[0].sub(b[0]), a[1].sub(b[1]), a[2].sub(b[2])]
}

/// The scalar product.
#[inline(always)]
pub(crate) fn dot<L: Lanes>(a: [L; 3], b: [L; 3]) -> L {
    a[0].mul(b[0]).add(a[1].mul(b[1])).add(a[2].mul(b[2]))
}

/// The vector product.
#[inline(always)]
pub(crate) fn cross<L: Lanes>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [a[1].mul(b[2]).sub(a[2].mul(b[1])), a[2].mul(b[0]).sub(a[0].mul(b[2])), a[0].mul(b[1]).sub(a[1].mul(b[0]))]
}

/// How two lines lie: one through the origin, eight through other points.
#[derive(Clone, Copy)]
pub(crate) struct Lines<L> {
    /// Where they are closest, along the line through the origin and along the other; both times `sin2`.
    pub(crate) t: L,
    pub(crate) s: L,
    /// Squared sine of the angle between them.
    pub(crate) sin2: L,
    /// Their distance times the sine, of either sign.
    pub(crate) across: L,
}

impl<L: Lanes> Lines<L> {
    /// Of unit directions `e` and `b`, the other line through `v`.
    #[inline(always)]
    pub(crate) fn new(e: [L; 3], v: [L; 3], b: [L; 3]) -> Self {
        let normal = cross(e, b);
        let (cos, ve, vb) = (dot(e, b), dot(v, e), dot(v, b));
        Self { t: ve.sub(cos.mul(vb)), s: cos.mul(ve).sub(vb), sin2: dot(normal, normal), across: dot(v, normal) }
    }
}
