//! Four dimensions of the Sobol' sequence with hash-based Owen scrambling (Burley 2020, "Practical Hash-based Owen
//! Scrambling"; the permutation is that of Laine and Karras 2011 with the constants of Vegdahl 2021).

use super::random::{hash64, unit_f32};

/// Dimensions of one batch.
pub const BATCH: usize = 4;

/// Bit-reversed direction numbers by byte of the reversed index: `TABLE[k][b]` is the contribution of byte `k` having the
/// value `b` to all dimensions. Dimension 0 is the reversed index, so its reversed digits are the index itself.
static TABLE: [[Digits; 256]; 4] = tables();

/// Reversed digits of all dimensions, aligned for one load.
#[derive(Clone, Copy)]
#[repr(align(16))]
struct Digits([u32; BATCH]);

/// Direction numbers of one dimension from the degree, the inner coefficients of the primitive polynomial and the
/// initial odd numbers (Joe and Kuo 2008).
const fn directions(degree: usize, coefficients: u32, initial: [u32; 3]) -> [u32; 32] {
    let mut v = [0u32; 32];
    let mut i = 0;
    while i < 32 {
        if i < degree {
            v[i] = initial[i] << (31 - i);
        } else {
            v[i] = v[i - degree] ^ (v[i - degree] >> degree);
            let mut k = 1;
            while k < degree {
                if coefficients >> (degree - 1 - k) & 1 == 1 {
                    v[i] ^= v[i - k];
                }
                k += 1;
            }
        }
        i += 1;
    }
    v
}

const fn tables() -> [[Digits; 256]; 4] {
    let dimensions = [directions(1, 0, [1, 0, 0]), directions(2, 1, [1, 3, 0]), directions(3, 1, [1, 3, 1])];
    let mut table = [[Digits([0; BATCH]); 256]; 4];
    let mut byte = 0;
    while byte < 4 {
        let mut value = 0;
        while value < 256 {
            let entry = &mut table[byte][value].0;
            let mut bit = 0;
            while bit < 8 {
                let place = 31 - (byte * 8 + bit);
                let mut d = 0;
                while d < BATCH && value >> bit & 1 == 1 {
                    entry[d] ^= if d == 0 { 1 << place } else { dimensions[d - 1][place].reverse_bits() };
                    d += 1;
                }
                bit += 1;
            }
            value += 1;
        }
        byte += 1;
    }
    table
}

/// A random permutation in which each bit depends on the lower bits only: Owen scrambling of reversed digits.
#[inline(always)]
fn permute(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// The point of the sequence that belongs to `key` whose index has the bits `reversed`, in reverse: four coordinates in
/// [0, 1).
///
/// Different keys give independently scrambled and shuffled sequences.
#[inline(always)]
pub fn point(reversed: u32, key: u64) -> [f32; BATCH] {
    let (digits, seeds) = unscrambled(reversed, key);
    std::array::from_fn(|d| scrambled(digits[d], seeds[d]))
}

/// Reversed digits of the coordinates before scrambling, and a seed for each.
#[inline(always)]
pub(super) fn unscrambled(reversed: u32, key: u64) -> ([u32; BATCH], [u32; BATCH]) {
    // One seed for the shuffle and one for each dimension, from different bits of one hash.
    let seeds = hash64(key);
    let turned = [13, 26, 39, 52].map(|bits| seeds.rotate_left(bits) as u32);
    (digits(permute(reversed, seeds as u32)), turned)
}

/// A coordinate from its reversed digits.
#[inline(always)]
pub(super) fn scrambled(digits: u32, seed: u32) -> f32 {
    unit_f32(permute(digits, seed).reverse_bits())
}

/// Reversed digits of the coordinates of a point, before scrambling.
#[inline(always)]
fn digits(reversed: u32) -> [u32; BATCH] {
    let [a, b, c, d] = reversed.to_le_bytes().map(usize::from);
    let [Digits(a), Digits(b), Digits(c), Digits(d)] = [TABLE[0][a], TABLE[1][b], TABLE[2][c], TABLE[3][d]];
    let mut sum = [0; BATCH];
    for i in 0..BATCH {
        sum[i] = a[i] ^ b[i] ^ c[i] ^ d[i];
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_points_are_those_of_joe_and_kuo() {
        let raw = |index: u32, d: usize| digits(index.reverse_bits())[d].reverse_bits() as f64 / 2f64.powi(32);
        // Points 1 to 7 of dimension 2, in natural (not Gray code) order.
        let expected = [0.5, 0.75, 0.25, 0.625, 0.125, 0.375, 0.875];
        assert_eq!(std::array::from_fn(|i| raw(i as u32 + 1, 1)), expected);
        // Every dimension is a permutation of k/2^m on each prefix of 2^m points.
        for d in 0..BATCH {
            for m in 0..10 {
                let mut seen: Vec<u32> = (0..1u32 << m).map(|i| (raw(i, d) * f64::from(1u32 << m)) as u32).collect();
                seen.sort_unstable();
                assert!(seen.iter().enumerate().all(|(i, &s)| i as u32 == s), "dimension {d}, 2^{m} points");
            }
        }
    }

    /// Each pair of dimensions (0,1) puts one point in every elementary interval, for every key and prefix.
    #[test]
    fn scrambled_prefixes_stay_stratified() {
        for key in 0..50 {
            let points: Vec<_> = (0..256_u32).map(|i| point(i.reverse_bits(), key)).collect();
            for shift in 0..=8 {
                let (nx, ny) = (1usize << shift, 1usize << (8 - shift));
                let mut cells = vec![0; 256];
                for p in &points {
                    cells[(p[0] * nx as f32) as usize + nx * (p[1] * ny as f32) as usize] += 1;
                }
                assert!(cells.iter().all(|&c| c == 1), "key {key}, {nx} x {ny} intervals");
            }
        }
    }

    #[test]
    fn keys_are_uncorrelated() {
        let n = 4096u64;
        let mean =
            (0..n).map(|key| f64::from(point(3, key)[0]) * f64::from(point(3, key + n)[0])).sum::<f64>() / n as f64;
        // The product of independent uniform numbers has mean 1/4 and standard deviation 0.22.
        assert!((mean - 0.25).abs() < 3.0 * 0.22 / (n as f64).sqrt(), "{mean}");
    }
}
