//! The numbers that a path consumes: stratified over the samples of a pixel at first, independent later.

use super::lanes::{Kernel, Lanes, Level};
use super::random::{Rng, hash64};
use super::{Vec2, sobol};

/// The legs of a path whose numbers are stratified. Later legs matter less and take cheaper independent numbers.
const STRATIFIED_LEGS: u32 = 2;

/// Batches of four stratified numbers that each leg may consume.
const BATCHES_PER_LEG: u32 = 4;

/// The random numbers of one path, keyed by (seed, pass, pixel or light path) and never by thread.
///
/// Legs have their own dimensions, so that the same decision of all paths of a pixel is stratified whatever was
/// consumed before it. Free-flight tracking, whose need of numbers is unbounded, draws from [`Sampler::rng`].
#[derive(Clone, Debug)]
pub struct Sampler {
    rng: Rng,
    key: u64,
    /// The index of the sample, its bits reversed.
    reversed: u32,
    batch: u32,
    end: u32,
    used: usize,
    numbers: [f32; sobol::BATCH],
}

impl Sampler {
    /// The numbers of sample `index` of `stream` (a pixel, or all light paths). The same `(seed, stream)` stratifies
    /// over its indices.
    #[inline]
    pub fn new(seed: u64, stream: u64, index: u32) -> Self {
        let rng = Rng::keyed(seed, stream, u64::from(index));
        let key = hash64(seed.wrapping_add(0x9e37_79b9_7f4a_7c15) ^ hash64(stream));
        let reversed = index.reverse_bits();
        Self { rng, key, reversed, batch: 0, end: 1, used: sobol::BATCH, numbers: [0.0; sobol::BATCH] }
    }

    /// Continues with the dimensions of leg number `leg` (0 = the leg that leaves the sensor or the emitter).
    #[inline]
    pub fn start_leg(&mut self, leg: u32) {
        self.batch = if leg < STRATIFIED_LEGS { 1 + leg * BATCHES_PER_LEG } else { 0 };
        self.end = if leg < STRATIFIED_LEGS { self.batch + BATCHES_PER_LEG } else { 0 };
        self.used = sobol::BATCH;
    }

    /// One number in [0, 1).
    #[inline(always)]
    pub fn f32(&mut self) -> f32 {
        if self.used == sobol::BATCH {
            if self.batch >= self.end {
                return self.rng.f32();
            }
            self.refill();
        }
        self.used += 1;
        self.numbers[self.used - 1]
    }

    #[inline(never)]
    fn refill(&mut self) {
        let key = self.key.wrapping_add(u64::from(self.batch));
        self.numbers = Level::dispatch(Batch { reversed: self.reversed, key });
        self.batch += 1;
        self.used = 0;
    }

    /// Two numbers in [0, 1), stratified together.
    #[inline(always)]
    pub fn vec2(&mut self) -> Vec2 {
        if self.used == sobol::BATCH - 1 {
            self.used = sobol::BATCH;
        }
        let x = self.f32();
        Vec2::new(x, self.f32())
    }

    /// Independent numbers, as many as needed.
    #[inline(always)]
    pub fn rng(&mut self) -> &mut Rng {
        &mut self.rng
    }
}

/// A batch of numbers: its four integers are computed side by side where the machine can.
struct Batch {
    reversed: u32,
    key: u64,
}

impl Kernel for Batch {
    type Output = [f32; sobol::BATCH];

    #[inline(always)]
    fn run<L: Lanes>(self) -> Self::Output {
        sobol::point(self.reversed, self.key)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_keys_give_equal_numbers_and_other_keys_do_not() {
        let draw = |seed, stream, index| {
            let mut sampler = Sampler::new(seed, stream, index);
            (0..200)
                .map(|i| {
                    if i % 10 == 0 {
                        sampler.start_leg(i / 10);
                    }
                    sampler.f32()
                })
                .collect::<Vec<_>>()
        };
        assert_eq!(draw(1, 2, 3), draw(1, 2, 3));
        assert!(draw(1, 2, 3) != draw(2, 2, 3) && draw(1, 2, 3) != draw(1, 3, 3) && draw(1, 2, 3) != draw(1, 2, 4));
    }

    #[test]
    fn numbers_of_a_leg_do_not_depend_on_what_was_drawn_before() {
        let mut a = Sampler::new(7, 8, 9);
        let mut b = a.clone();
        b.f32();
        a.start_leg(1);
        b.start_leg(1);
        assert_eq!(a.vec2(), b.vec2());
    }

    #[test]
    fn uniform_and_stratified() {
        let n = 1024;
        for leg in [0, 1, STRATIFIED_LEGS, 9] {
            let mut sum = 0.0;
            for index in 0..n {
                let mut sampler = Sampler::new(0, 5, index);
                sampler.start_leg(leg);
                sum += f64::from(sampler.f32());
            }
            let error = (sum / f64::from(n) - 0.5).abs();
            let bound = if leg < STRATIFIED_LEGS { 1.0 / f64::from(n) } else { 3.0 * 0.29 / f64::from(n).sqrt() };
            assert!(error < bound, "leg {leg}: {error}");
        }
    }
}
