//! Random numbers keyed by (seed, stream, index), never by thread.

/// A 32-bit avalanche hash (constants found by Wellons 2018, "prospector").
#[inline(always)]
pub fn hash32(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x21f0_aaad);
    x ^= x >> 15;
    x = x.wrapping_mul(0xd35a_2d97);
    x ^ (x >> 15)
}

/// A 64-bit avalanche hash (Stafford 2011, variant 13).
#[inline(always)]
pub fn hash64(mut x: u64) -> u64 {
    x ^= x >> 30;
    x = x.wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x ^= x >> 27;
    x = x.wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// The top 24 bits as a number in [0, 1).
#[inline(always)]
pub fn unit_f32(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// `u` with 24 more random bits below its own, hashed from it and an independent number: for choices among so many that 24
/// bits do not tell them apart.
#[inline(always)]
pub fn more_bits(u: f32, other: f32) -> f64 {
    f64::from(u) + f64::from(unit_f32(hash32(u.to_bits() ^ hash32(other.to_bits())))) / 16_777_216.0
}

/// A small permuted congruential generator (O'Neill 2014, PCG-XSH-RR 64/32) whose start depends on a key alone.
#[derive(Clone, Debug)]
pub struct Rng {
    state: u64,
}

impl Rng {
    /// The generator of `(seed, stream, index)`: for example the picture's seed, the pass, the pixel.
    #[inline(always)]
    pub fn keyed(seed: u64, stream: u64, index: u64) -> Self {
        let key = hash64(seed ^ hash64(stream.wrapping_add(0x9e37_79b9_7f4a_7c15) ^ hash64(index.wrapping_add(1))));
        Self { state: key }
    }

    /// 32 random bits.
    #[inline(always)]
    pub fn bits(&mut self) -> u32 {
        let old = self.state;
        self.state = old.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let xorshifted = (((old >> 18) ^ old) >> 27) as u32;
        xorshifted.rotate_right((old >> 59) as u32)
    }

    /// Numbers in [0, 1), two from each state.
    #[inline(always)]
    pub fn fill<const N: usize>(&mut self) -> [f32; N] {
        let mut numbers = [0.0; N];
        for pair in numbers.chunks_mut(2) {
            let bits = hash64(self.state);
            self.bits();
            pair[0] = unit_f32(bits as u32);
            if let Some(second) = pair.get_mut(1) {
                *second = unit_f32((bits >> 32) as u32);
            }
        }
        numbers
    }

    /// A number in [0, 1).
    #[inline(always)]
    pub fn f32(&mut self) -> f32 {
        unit_f32(self.bits())
    }

    /// Two numbers in [0, 1).
    #[inline(always)]
    pub fn vec2(&mut self) -> glam::Vec2 {
        let x = self.f32();
        glam::Vec2::new(x, self.f32())
    }
}
