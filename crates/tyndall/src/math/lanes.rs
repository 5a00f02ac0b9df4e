//! Eight-wide lanes of `f32`, at a SIMD level chosen once at start-up.
//!
//! Code over lanes is written once, generic over [`Lanes`], as a [`Kernel`]; [`Level::dispatch`] instantiates it for
//! every level. Only operations that IEEE 754 rounds exactly are offered, and no fused ones, so that a kernel gives the
//! same bits at every level.

use std::sync::atomic::{AtomicU8, Ordering};

/// How many lanes there are.
pub const WIDTH: usize = 8;

/// Eight numbers, aligned for one load.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub struct Row(pub [f32; WIDTH]);

/// Eight lanes of `f32`.
pub trait Lanes: Copy {
    /// One truth value a lane.
    type Mask: Mask;

    /// The same number in every lane.
    fn splat(x: f32) -> Self;
    /// Eight numbers from memory.
    fn load(row: &Row) -> Self;
    /// Eight numbers to memory.
    fn store(self) -> Row;
    /// `self + b`.
    fn add(self, b: Self) -> Self;
    /// `self - b`.
    fn sub(self, b: Self) -> Self;
    /// `self * b`.
    fn mul(self, b: Self) -> Self;
    /// `self / b`.
    fn div(self, b: Self) -> Self;
    /// The square root.
    fn sqrt(self) -> Self;
    /// `self < b ? self : b`: `b` where one is NaN or both are zeros.
    fn min(self, b: Self) -> Self;
    /// `self > b ? self : b`: `b` where one is NaN or both are zeros.
    fn max(self, b: Self) -> Self;
    /// `self < b`; false for NaN.
    fn lt(self, b: Self) -> Self::Mask;
    /// `self <= b`; false for NaN.
    fn le(self, b: Self) -> Self::Mask;
    /// `mask ? self : b`.
    fn select(self, mask: Self::Mask, b: Self) -> Self;
    /// The largest whole number that is not above.
    fn floor(self) -> Self;
    /// Two to the power of whole numbers from -126 to 127.
    fn power_of_two(self) -> Self;
    /// The mantissa in [1, 2) and the exponent of positive normal numbers.
    fn mantissa_and_exponent(self) -> (Self, Self);

    /// The absolute value.
    #[inline(always)]
    fn abs(self) -> Self {
        self.max(Self::splat(0.0).sub(self))
    }
}

/// Eight truth values.
pub trait Mask: Copy {
    /// Both.
    fn and(self, b: Self) -> Self;
    /// Either.
    fn or(self, b: Self) -> Self;
    /// Lane `i` as bit `i`.
    fn bits(self) -> u32;
}

/// A computation over lanes. Mark `run`, and everything generic over lanes that it calls, `#[inline(always)]`: only
/// then is it compiled for the instructions of its level. Keep lanes out of closures, which cannot be marked so.
pub trait Kernel {
    /// What it computes.
    type Output;
    /// Computes it with the given lanes.
    fn run<L: Lanes>(self) -> Self::Output;
}

/// The instructions that kernels use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Level {
    /// Plain arrays, for any machine.
    Portable = 1,
    /// AVX2, on x86-64.
    Avx2 = 2,
}

static CURRENT: AtomicU8 = AtomicU8::new(0);

impl Level {
    /// The best level of this machine.
    pub fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
            return Self::Avx2;
        }
        Self::Portable
    }

    /// The level in use: the best one, unless [`Level::force`] chose another.
    #[inline(always)]
    pub fn current() -> Self {
        match CURRENT.load(Ordering::Relaxed) {
            1 => Self::Portable,
            2 => Self::Avx2,
            _ => Self::initialise(),
        }
    }

    #[cold]
    fn initialise() -> Self {
        let level = Self::detect();
        CURRENT.store(level as u8, Ordering::Relaxed);
        level
    }

    /// Uses `self` from now on, or the best level of this machine if that is lower. Results do not depend on it.
    pub fn force(self) {
        let level = if self == Self::Portable { self } else { Self::detect() };
        CURRENT.store(level as u8, Ordering::Relaxed);
    }

    /// Every level that this machine has.
    pub fn available() -> &'static [Self] {
        match Self::detect() {
            Self::Portable => &[Self::Portable],
            Self::Avx2 => &[Self::Portable, Self::Avx2],
        }
    }

    /// Runs the kernel at the level in use.
    #[inline(always)]
    pub fn dispatch<K: Kernel>(kernel: K) -> K::Output {
        match Self::current() {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: `CURRENT` becomes `Avx2` only where `detect` found AVX2 and FMA.
            Self::Avx2 => unsafe { avx2::run(kernel) },
            _ => run_portable(kernel),
        }
    }

    /// Runs the kernel at this level, or at the best one of this machine if that is lower.
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: the machine has just been asked.
            Self::Avx2 if Self::detect() == Self::Avx2 => unsafe { avx2::run(kernel) },
            _ => run_portable(kernel),
        }
    }
}

#[inline(never)]
fn run_portable<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<Portable>()
}

/// How `f32` is laid out: bits of the mantissa, what is added to the exponent, and the number one.
const MANTISSA_BITS: i32 = 23;
const MANTISSA: u32 = (1 << MANTISSA_BITS) - 1;
const BIAS: i32 = 127;
const ONE: u32 = (BIAS as u32) << MANTISSA_BITS;

/// Lanes as an array.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub struct Portable([f32; WIDTH]);

/// Truth values as an array.
#[derive(Clone, Copy, Debug)]
pub struct PortableMask([bool; WIDTH]);

impl Portable {
    #[inline(always)]
    fn zip(self, b: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], b.0[i])))
    }
}

impl Lanes for Portable {
    type Mask = PortableMask;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self([x; WIDTH])
    }
    #[inline(always)]
    fn load(row: &Row) -> Self {
        Self(row.0)
    }
    #[inline(always)]
    fn store(self) -> Row {
        Row(self.0)
    }
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        self.zip(b, |a, b| a + b)
    }
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        self.zip(b, |a, b| a - b)
    }
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        self.zip(b, |a, b| a * b)
    }
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        self.zip(b, |a, b| a / b)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.map(f32::sqrt))
    }
    #[inline(always)]
    fn min(self, b: Self) -> Self {
        self.zip(b, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        self.zip(b, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn lt(self, b: Self) -> PortableMask {
        PortableMask(std::array::from_fn(|i| self.0[i] < b.0[i]))
    }
    #[inline(always)]
    fn le(self, b: Self) -> PortableMask {
        PortableMask(std::array::from_fn(|i| self.0[i] <= b.0[i]))
    }
    #[inline(always)]
    fn select(self, mask: PortableMask, b: Self) -> Self {
        Self(std::array::from_fn(|i| if mask.0[i] { self.0[i] } else { b.0[i] }))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self(self.0.map(f32::floor))
    }
    #[inline(always)]
    fn power_of_two(self) -> Self {
        Self(self.0.map(|x| f32::from_bits(((x as i32 + BIAS) as u32) << MANTISSA_BITS)))
    }
    #[inline(always)]
    fn mantissa_and_exponent(self) -> (Self, Self) {
        let mantissa = self.0.map(|x| f32::from_bits(x.to_bits() & MANTISSA | ONE));
        let exponent = self.0.map(|x| ((x.to_bits() >> MANTISSA_BITS) as i32 - BIAS) as f32);
        (Self(mantissa), Self(exponent))
    }
}

impl Mask for PortableMask {
    #[inline(always)]
    fn and(self, b: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] & b.0[i]))
    }
    #[inline(always)]
    fn or(self, b: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] | b.0[i]))
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        (0..WIDTH).fold(0, |bits, i| bits | (self.0[i] as u32) << i)
    }
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use super::{BIAS, Kernel, Lanes, MANTISSA, MANTISSA_BITS, Mask, ONE, Row};
    use std::arch::x86_64::*;

    /// Runs the kernel with AVX2 lanes, which exist nowhere else: that is what makes their operations sound. It is a
    /// call, unless one kernel runs another.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn run<K: Kernel>(kernel: K) -> K::Output {
        kernel.run::<Avx2>()
    }

    #[derive(Clone, Copy)]
    pub(super) struct Avx2(__m256);

    #[derive(Clone, Copy)]
    pub(super) struct Avx2Mask(__m256);

    // SAFETY of all blocks below: only `run` instantiates kernels with `Avx2`, and it may be called only where the
    // machine has AVX2. `Row` is aligned to 32 bytes.
    impl Lanes for Avx2 {
        type Mask = Avx2Mask;

        #[inline(always)]
        fn splat(x: f32) -> Self {
            Self(unsafe { _mm256_set1_ps(x) })
        }
        #[inline(always)]
        fn load(row: &Row) -> Self {
            Self(unsafe { _mm256_load_ps(row.0.as_ptr()) })
        }
        #[inline(always)]
        fn store(self) -> Row {
            let mut row = Row([0.0; 8]);
            unsafe { _mm256_store_ps(row.0.as_mut_ptr(), self.0) };
            row
        }
        #[inline(always)]
        fn add(self, b: Self) -> Self {
            Self(unsafe { _mm256_add_ps(self.0, b.0) })
        }
        #[inline(always)]
        fn sub(self, b: Self) -> Self {
            Self(unsafe { _mm256_sub_ps(self.0, b.0) })
        }
        #[inline(always)]
        fn mul(self, b: Self) -> Self {
            Self(unsafe { _mm256_mul_ps(self.0, b.0) })
        }
        #[inline(always)]
        fn div(self, b: Self) -> Self {
            Self(unsafe { _mm256_div_ps(self.0, b.0) })
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            Self(unsafe { _mm256_sqrt_ps(self.0) })
        }
        #[inline(always)]
        fn min(self, b: Self) -> Self {
            Self(unsafe { _mm256_min_ps(self.0, b.0) })
        }
        #[inline(always)]
        fn max(self, b: Self) -> Self {
            Self(unsafe { _mm256_max_ps(self.0, b.0) })
        }
        #[inline(always)]
        fn abs(self) -> Self {
            Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
        }
        #[inline(always)]
        fn lt(self, b: Self) -> Avx2Mask {
            Avx2Mask(unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, b.0) })
        }
        #[inline(always)]
        fn le(self, b: Self) -> Avx2Mask {
            Avx2Mask(unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, b.0) })
        }
        #[inline(always)]
        fn select(self, mask: Avx2Mask, b: Self) -> Self {
            Self(unsafe { _mm256_blendv_ps(b.0, self.0, mask.0) })
        }
        #[inline(always)]
        fn floor(self) -> Self {
            Self(unsafe { _mm256_floor_ps(self.0) })
        }
        #[inline(always)]
        fn power_of_two(self) -> Self {
            unsafe {
                let exponent = _mm256_add_epi32(_mm256_cvttps_epi32(self.0), _mm256_set1_epi32(BIAS));
                Self(_mm256_castsi256_ps(_mm256_slli_epi32::<MANTISSA_BITS>(exponent)))
            }
        }
        #[inline(always)]
        fn mantissa_and_exponent(self) -> (Self, Self) {
            unsafe {
                let bits = _mm256_castps_si256(self.0);
                let mantissa = _mm256_and_si256(bits, _mm256_set1_epi32(MANTISSA as i32));
                let mantissa = _mm256_or_si256(mantissa, _mm256_set1_epi32(ONE as i32));
                let exponent = _mm256_sub_epi32(_mm256_srli_epi32::<MANTISSA_BITS>(bits), _mm256_set1_epi32(BIAS));
                (Self(_mm256_castsi256_ps(mantissa)), Self(_mm256_cvtepi32_ps(exponent)))
            }
        }
    }

    impl Mask for Avx2Mask {
        #[inline(always)]
        fn and(self, b: Self) -> Self {
            Self(unsafe { _mm256_and_ps(self.0, b.0) })
        }
        #[inline(always)]
        fn or(self, b: Self) -> Self {
            Self(unsafe { _mm256_or_ps(self.0, b.0) })
        }
        #[inline(always)]
        fn bits(self) -> u32 {
            unsafe { _mm256_movemask_ps(self.0) as u32 }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Everything {
        a: Row,
        b: Row,
    }

    impl Kernel for Everything {
        type Output = (Vec<u32>, Vec<u32>);

        #[inline(always)]
        fn run<L: Lanes>(self) -> Self::Output {
            let (a, b) = (L::load(&self.a), L::load(&self.b));
            let masks = [a.lt(b), a.le(b), a.lt(b).and(b.le(a)), a.lt(b).or(b.le(a))];
            let values = [
                a.add(b),
                a.sub(b),
                a.mul(b),
                a.div(b),
                a.sqrt(),
                a.min(b),
                a.max(b),
                a.abs(),
                a.select(masks[0], b),
                L::splat(self.a.0[0]),
                a.floor(),
            ];
            let bits = |x: f32| if x.is_nan() { f32::NAN.to_bits() } else { x.to_bits() };
            (values.iter().flat_map(|v| v.store().0.map(bits)).collect(), masks.map(|m| m.bits()).to_vec())
        }
    }

    #[test]
    fn every_level_gives_the_same_bits() {
        let special = [0.0, -0.0, 1.0, -1.5, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e-42, f32::MAX, 0.1, 3.7e7];
        for i in 0..special.len() {
            for j in 0..special.len() {
                let row = |k: usize| Row(std::array::from_fn(|l| special[(k + l) % special.len()]));
                let results: Vec<_> =
                    Level::available().iter().map(|level| level.run(Everything { a: row(i), b: row(j) })).collect();
                assert!(results.iter().all(|r| *r == results[0]), "{:?} {:?}", row(i), row(j));
            }
        }
    }

    /// Numbers whole and broken.
    struct Powers([Row; 2]);

    impl Kernel for Powers {
        type Output = [Row; 3];

        #[inline(always)]
        fn run<L: Lanes>(self) -> [Row; 3] {
            let [exponents, numbers] = self.0.each_ref().map(L::load);
            let (mantissas, exponents_of) = numbers.mantissa_and_exponent();
            [exponents.power_of_two().store(), mantissas.store(), exponents_of.store()]
        }
    }

    #[test]
    fn powers_of_two_are_put_together_and_taken_apart() {
        let exponents = [-126.0, -24.0, -1.0, 0.0, 1.0, 7.0, 100.0, 127.0];
        let mantissas = [1.0, 1.25, 1.999_999_9, 1.5, 1.0, 1.1, 1.7, 1.3];
        let numbers = std::array::from_fn(|i| f32::exp2(exponents[i]) * mantissas[i]);
        for level in Level::available() {
            let found = level.run(Powers([Row(exponents), Row(numbers)]));
            assert_eq!(found, [Row(exponents.map(f32::exp2)), Row(mantissas), Row(exponents)]);
        }
    }

    #[test]
    fn minimum_and_maximum_drop_a_nan_on_the_left() {
        let nan = Portable::splat(f32::NAN);
        let one = Portable::splat(1.0);
        assert_eq!(nan.min(one).store().0[0], 1.0);
        assert_eq!(nan.max(one).store().0[0], 1.0);
        assert!(one.min(nan).store().0[0].is_nan());
    }
}
