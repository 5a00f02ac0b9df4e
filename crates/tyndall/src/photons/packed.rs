//! What a photon carries, in few bytes.

use crate::Spectrum;
use crate::scene::desc::MediumId;

/// Three non-negative numbers in 63 bits: those of `f32` without sign and the last ten bits of the fraction, so that each is
/// off by at most 6e-5 of itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flux([u32; 2]);

const CHANNEL_BITS: u32 = 21;
const DROPPED_BITS: u32 = 10;

impl Flux {
    /// Rounded to nearest. Negative numbers become zero.
    #[inline]
    pub fn new(flux: Spectrum) -> Self {
        let pack = |c: f32| u64::from((c.max(0.0).to_bits() + (1 << (DROPPED_BITS - 1))) >> DROPPED_BITS);
        let bits = pack(flux[0]) | pack(flux[1]) << CHANNEL_BITS | pack(flux[2]) << (2 * CHANNEL_BITS);
        Self([bits as u32, (bits >> 32) as u32])
    }

    /// The three numbers.
    #[inline(always)]
    pub fn unpack(self) -> Spectrum {
        let bits = u64::from(self.0[0]) | u64::from(self.0[1]) << 32;
        let channel = |i: u32| f32::from_bits(((bits >> (i * CHANNEL_BITS)) as u32) << DROPPED_BITS & 0x7fff_fc00);
        Spectrum::new(channel(0), channel(1), channel(2))
    }
}

/// How light has come from its emitter, index-matched boundaries not counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Origin {
    /// Straight.
    Direct = 0,
    /// Over smooth mirrors and glass only.
    Specular = 1,
    /// Scattered into a lobe at least once.
    Scattered = 2,
}

/// What decides whether a datum counts for a query: its medium, its number of scatterings, its origin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tag(u32);

const MEDIUM_BITS: u32 = 14;
const NO_MEDIUM: u32 = (1 << MEDIUM_BITS) - 1;
const SCATTERINGS_BITS: u32 = 16;

impl Tag {
    /// How many media can be told apart.
    pub const MAX_MEDIA: usize = NO_MEDIUM as usize;

    /// For a datum in `medium` (`None`: on a surface) whose light has been scattered `scatterings` times.
    #[inline]
    pub fn new(medium: Option<MediumId>, scatterings: u32, origin: Origin) -> Self {
        let medium = medium.map_or(NO_MEDIUM, |m| m.0 as u32);
        let scatterings = scatterings.min((1 << SCATTERINGS_BITS) - 1);
        Self(medium | scatterings << MEDIUM_BITS | (origin as u32) << (MEDIUM_BITS + SCATTERINGS_BITS))
    }

    /// Whether the datum lies in `medium`.
    #[inline(always)]
    pub fn is_in(self, medium: MediumId) -> bool {
        self.0 & NO_MEDIUM == medium.0 as u32
    }

    /// The medium in which it lies; `None` on surfaces.
    #[inline]
    pub fn medium(self) -> Option<MediumId> {
        let medium = self.0 & NO_MEDIUM;
        (medium != NO_MEDIUM).then_some(MediumId(medium as usize))
    }

    /// Scatterings since the emitter.
    #[inline(always)]
    pub fn scatterings(self) -> u32 {
        self.0 >> MEDIUM_BITS & ((1 << SCATTERINGS_BITS) - 1)
    }

    /// The origin as a bit: 1 direct, 2 specular, 4 scattered.
    #[inline(always)]
    pub fn origin_bit(self) -> u32 {
        1 << (self.0 >> (MEDIUM_BITS + SCATTERINGS_BITS))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flux_keeps_four_digits() {
        for rgb in [[0.0, 1.0, 2.0], [1e-20, 3.3e5, 0.1], [7.77, 1e30, 1e-35]] {
            let back = Flux::new(Spectrum::from_rgb(rgb)).unpack().to_rgb();
            for (a, b) in rgb.into_iter().zip(back) {
                assert!((a - b).abs() <= 6.2e-5 * a, "{a} became {b}");
            }
        }
        assert_eq!(Flux::new(Spectrum::grey(-1.0)).unpack(), Spectrum::ZERO);
    }

    #[test]
    fn tags_keep_what_they_are_given() {
        for origin in [Origin::Direct, Origin::Specular, Origin::Scattered] {
            let tag = Tag::new(Some(MediumId(77)), 1234, origin);
            assert!(tag.is_in(MediumId(77)) && !tag.is_in(MediumId(76)));
            assert_eq!(tag.medium(), Some(MediumId(77)));
            assert_eq!((tag.scatterings(), tag.origin_bit()), (1234, 1 << origin as u32));
        }
        assert!(!Tag::new(None, 0, Origin::Direct).is_in(MediumId(0)));
        assert_eq!(Tag::new(None, 0, Origin::Direct).medium(), None);
        assert_eq!(Tag::new(None, u32::MAX, Origin::Scattered).scatterings(), 65535);
    }
}
