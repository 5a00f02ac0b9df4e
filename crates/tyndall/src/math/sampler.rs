//! The numbers that a path consumes: stratified over the samples of a pixel at first, independent later.

use super::lanes::{Kernel, Lanes, Level};
use super::random::{Rng, hash64};
use super::{Vec2, sobol};
use sobol::BATCH;

/// The legs of a path whose numbers are stratified. Later legs matter less and take cheaper independent numbers.
const STRATIFIED_LEGS: u32 = 2;

/// Batches of four stratified numbers that each leg may consume.
const BATCHES_PER_LEG: u32 = 4;

/// Batches of which nearly every path consumes some: two before the first leg and the first two of each stratified leg.
/// They are computed side by side.
const FIRST: usize = 6;

/// Their places among all.
const PLACES: [u64; FIRST] = {
    let mut places = [0; FIRST];
    let mut i = 0;
    while i < FIRST {
        places[i] = (i / 2) as u64 * BATCHES_PER_LEG as u64 + (i % 2) as u64;
        i += 1;
    }
    places
};

/// How many numbers come at a time.
const FILL: usize = 2 * BATCH;

/// Where numbers that come later are.
const LATER: usize = FIRST * BATCH;

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
    /// Where stratified numbers go on, once those at hand have been consumed.
    batch: Option<u32>,
    /// The next one of the numbers at hand, and their end.
    next: usize,
    end: usize,
    numbers: [f32; LATER + FILL],
}

impl Sampler {
    /// The numbers of sample `index` of `stream` (a pixel, or all light paths). The same `(seed, stream)` stratifies
    /// over its indices.
    #[inline]
    pub fn new(seed: u64, stream: u64, index: u32) -> Self {
        let rng = Rng::keyed(seed, stream, u64::from(index));
        let key = hash64(seed.wrapping_add(0x9e37_79b9_7f4a_7c15) ^ hash64(stream));
        let reversed = index.reverse_bits();
        let mut numbers = [0.0; LATER + FILL];
        Level::dispatch(Batches { reversed, key, places: PLACES, numbers: &mut numbers });
        Self { rng, key, reversed, batch: None, next: 0, end: FILL, numbers }
    }

    /// A leg from which on numbers are independent.
    pub const INDEPENDENT_LEG: u32 = STRATIFIED_LEGS;

    /// Continues with the dimensions of leg number `leg` (0 = the leg that leaves the sensor or the emitter).
    #[inline]
    pub fn start_leg(&mut self, leg: u32) {
        let stratified = leg < STRATIFIED_LEGS;
        self.batch = stratified.then_some((1 + leg) * BATCHES_PER_LEG + 2);
        self.next = if stratified { (1 + leg as usize) * FILL } else { LATER + FILL };
        self.end = if stratified { self.next + FILL } else { LATER + FILL };
    }

    /// One number in [0, 1).
    #[inline(always)]
    pub fn f32(&mut self) -> f32 {
        if self.next == self.end {
            self.refill();
        }
        let number = self.numbers[self.next % (LATER + FILL)];
        self.next += 1;
        number
    }

    #[inline(never)]
    fn refill(&mut self) {
        match self.batch.take() {
            Some(batch) => {
                let (reversed, key) = (self.reversed, self.key.wrapping_add(u64::from(batch)));
                Level::dispatch(Batches { reversed, key, places: [0, 1], numbers: &mut self.numbers[LATER..] });
            }
            None => self.numbers[LATER..].copy_from_slice(&self.rng.fill::<FILL>()),
        }
        (self.next, self.end) = (LATER, LATER + FILL);
    }

    /// Two numbers in [0, 1), stratified together.
    #[inline(always)]
    pub fn vec2(&mut self) -> Vec2 {
        // Both of one batch.
        self.next += usize::from(self.next % BATCH == BATCH - 1);
        let x = self.f32();
        Vec2::new(x, self.f32())
    }

    /// Independent numbers, as many as needed.
    #[inline(always)]
    pub fn rng(&mut self) -> &mut Rng {
        &mut self.rng
    }
}

/// Batches of numbers: their integers are computed side by side where the machine can.
struct Batches<'a, const N: usize> {
    reversed: u32,
    key: u64,
    places: [u64; N],
    numbers: &'a mut [f32],
}

impl<const N: usize> Kernel for Batches<'_, N> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let (mut digits, mut seeds) = ([[0; BATCH]; N], [[0; BATCH]; N]);
        for i in 0..N {
            (digits[i], seeds[i]) = sobol::unscrambled(self.reversed, self.key.wrapping_add(self.places[i]));
        }
        for (i, number) in self.numbers[..N * BATCH].iter_mut().enumerate() {
            *number = sobol::scrambled(digits[i / BATCH][i % BATCH], seeds[i / BATCH][i % BATCH]);
        }
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
