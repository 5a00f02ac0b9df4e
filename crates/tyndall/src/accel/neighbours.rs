//! What a search for nearest points finds.

/// Up to `k` points, nearest ones: a heap whose top is the farthest. It is re-used from search to search.
///
/// Points are ordered by squared distance, then by index, so that a set has one answer.
#[derive(Clone, Debug, Default)]
pub struct Neighbours {
    /// Squared distance (its bits sort as it does) in the upper half, index in the lower one. A heap when full.
    keys: Vec<u64>,
    limit: usize,
    /// What is farther is not wanted, as a squared distance.
    reach: f32,
}

fn read(key: u64) -> (f32, u32) {
    (f32::from_bits((key >> 32) as u32), key as u32)
}

impl Neighbours {
    /// How many were found.
    pub fn len(&self) -> usize {
        self.keys.len()
    }

    /// Whether nothing was found.
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty()
    }

    /// Squared distance, in m^2, and index of each, in no particular order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (f32, u32)> + '_ {
        self.keys.iter().map(|key| read(*key))
    }

    /// Sorts them, the nearest first.
    pub fn sort(&mut self) {
        self.keys.sort_unstable();
    }

    /// The largest squared distance, in m^2.
    pub fn farthest(&self) -> Option<f32> {
        self.keys.iter().max().map(|key| read(*key).0)
    }

    /// Forgets everything, for the `limit` nearest within `reach`, a squared distance.
    pub(super) fn start(&mut self, limit: usize, reach: f32) {
        self.keys.clear();
        (self.limit, self.reach) = (limit, reach);
    }

    /// The squared distance beyond which nothing is wanted.
    #[inline(always)]
    pub(super) fn reach(&self) -> f32 {
        self.reach
    }

    /// Takes a point if it is near enough and, where there are enough already, drops the farthest one.
    #[inline(always)]
    pub(super) fn offer(&mut self, squared: f32, index: u32) {
        let key = (squared.to_bits() as u64) << 32 | index as u64;
        if self.keys.len() < self.limit {
            self.keys.push(key);
            if self.keys.len() < self.limit {
                return;
            }
            for at in (0..self.limit / 2).rev() {
                self.sink(at, self.keys[at]);
            }
        } else if key < self.keys[0] {
            self.sink(0, key);
        } else {
            return;
        }
        self.reach = read(self.keys[0]).0;
    }

    /// Puts `key` at `at` or below, where it is not smaller than what is below it.
    #[inline(always)]
    fn sink(&mut self, mut at: usize, key: u64) {
        let keys = &mut self.keys[..];
        loop {
            let mut child = 2 * at + 1;
            if child >= keys.len() {
                break;
            }
            if child + 1 < keys.len() {
                child += (keys[child + 1] > keys[child]) as usize;
            }
            if keys[child] <= key {
                break;
            }
            keys[at] = keys[child];
            at = child;
        }
        keys[at] = key;
    }
}
