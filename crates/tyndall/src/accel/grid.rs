//! The grid for queries of one fixed radius: points sorted by cell, counting.
//!
//! [`Grid::rebuild`] sees positions only. It answers with an order of the points: a user arranges whatever it keeps of
//! them by that order, and [`Grid::near`] answers with ranges of it.
//!
//! Rows of cells run along x, and cells of a row are neighbours in memory, so that one range covers what a query needs
//! of a row. Where a box of cells around all points would be larger than the number of points, rows start at hashed
//! places of a table of that size instead and may overlap; ranges of one query that do are united.

use super::resize;
use crate::math::lanes::WIDTH;
use crate::math::random::hash64;
use crate::math::{Aabb, Vec3};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Points sorted by cell. Memory: at most 16.2 bytes a point, those of the order included, for the most points so far.
#[derive(Debug, Default)]
pub struct Grid {
    cells: Cells,
    /// Where each cell starts in `order`, and its length at last.
    starts: Vec<u32>,
    /// Point numbers, cell by cell, ascending within each.
    order: Vec<u32>,
    /// For the build: cell and number of every point, sorted by bucket. (Atomic because chunks of points write between
    /// each other; each element is written once.)
    keyed: Vec<AtomicU64>,
    /// For the build: where each chunk of points puts those of each bucket.
    places: Vec<[u32; BUCKETS]>,
}

/// The edge of a cell across its row, in radii: a query meets two rows each way. (Cells of one radius cover half as many
/// points, in twice as many ranges: that was not faster.)
const ACROSS: f32 = 2.0;
/// The edge of a cell along its row, in radii: the first one for which there are not more cells than points.
const ALONG: [f32; 3] = [0.25, 0.5, 1.0];
/// In a hash table each cell may hold points from elsewhere too, so that few large ones are better.
const HASHED: f32 = 1.0;

/// Cells are first sorted into so many buckets of consecutive ones ...
const BUCKETS: usize = 256;
/// ... by chunks of so many points.
const CHUNK: usize = 1 << 14;
/// Buckets of fewer points are sorted together by one thread.
const SERIAL: usize = 4096;

/// Radii are made at least this, so that squares do not underflow, ...
const LEAST_RADIUS: f32 = 1e-18;
/// ... and at most this, so that they do not overflow.
const LARGEST_RADIUS: f32 = 1e18;
/// Cells further from the origin than this belong to the outermost one.
const OUTERMOST: f32 = (1 << 29) as f32;
/// Rounding makes three rows each way of the two that a query meets; where its radius is lost in the last places of its
/// position there may be more, which are not counted any more.
const ROWS: i32 = 3;
/// Ranges of a query: a row of a hash table may be two.
const CAPACITY: usize = 2 * (ROWS * ROWS) as usize;

/// How space is divided.
#[derive(Clone, Copy, Debug, Default)]
struct Cells {
    /// Of the queries, a little enlarged for rounding.
    radius: f32,
    /// The edge along y and z.
    edge: f32,
    /// Cells a metre.
    scale: Vec3,
    /// The first cell with points, and the last one.
    low: [i32; 3],
    high: [i32; 3],
    layout: Layout,
}

/// Where rows start.
#[derive(Clone, Copy, Debug)]
enum Layout {
    /// One after the other: cells along x, rows along y.
    Dense { length: u32, rows: u32 },
    /// At hashed places of a table whose size is a power of two.
    Hashed { mask: u32 },
}

impl Default for Layout {
    fn default() -> Self {
        Self::Hashed { mask: 0 }
    }
}

/// The number of the cell at `t` cells from the origin: rounded down, 0 for NaN. It never falls as `t` rises.
#[inline(always)]
fn cell(t: f32) -> i32 {
    let t = t.clamp(-OUTERMOST, OUTERMOST);
    let whole = t as i32;
    whole - (t < whole as f32) as i32
}

impl Cells {
    fn new(bounds: Aabb, radius: f32, count: usize) -> Self {
        let radius = if radius > LEAST_RADIUS { radius.min(LARGEST_RADIUS) } else { LEAST_RADIUS };
        let edge = radius * ACROSS;
        let divided = |along: f32| {
            let scale = Vec3::new((radius * along).recip(), edge.recip(), edge.recip());
            let (low, high) = match bounds.is_empty() {
                true => ([0; 3], [0; 3]),
                false => ((bounds.min * scale).to_array().map(cell), (bounds.max * scale).to_array().map(cell)),
            };
            let radius = radius * (1.0 + 4.0 * f32::EPSILON);
            Self { radius, edge, scale, low, high, layout: Layout::default() }
        };
        for along in ALONG {
            let cells = divided(along);
            let [x, y, z] = [0, 1, 2].map(|i| (cells.high[i] as i64 - cells.low[i] as i64 + 1) as u128);
            if x * y * z <= count as u128 {
                return Self { layout: Layout::Dense { length: x as u32, rows: y as u32 }, ..cells };
            }
        }
        let mask = (1_u32 << count.max(1).ilog2()) - 1;
        Self { layout: Layout::Hashed { mask }, ..divided(HASHED) }
    }

    /// How many there are in the table.
    fn count(&self) -> usize {
        match self.layout {
            Layout::Dense { length, rows } => {
                length as usize * rows as usize * (self.high[2] as i64 - self.low[2] as i64 + 1) as usize
            }
            Layout::Hashed { mask } => mask as usize + 1,
        }
    }

    /// The place of the row's first cell.
    #[inline(always)]
    fn row(&self, y: i32, z: i32) -> u32 {
        match self.layout {
            Layout::Dense { length, rows } => ((z - self.low[2]) as u32 * rows + (y - self.low[1]) as u32) * length,
            Layout::Hashed { mask } => hash64((y as u32 as u64) << 32 | z as u32 as u64) as u32 & mask,
        }
    }

    /// The place of a point's cell. Points that are not finite are put somewhere.
    #[inline(always)]
    fn place(&self, position: Vec3) -> u32 {
        let t = position * self.scale;
        let inside = |axis: usize| cell(t[axis]).max(self.low[axis]).min(self.high[axis]);
        let place = self.row(inside(1), inside(2)).wrapping_add(inside(0).wrapping_sub(self.low[0]) as u32);
        match self.layout {
            Layout::Dense { .. } => place,
            Layout::Hashed { mask } => place & mask,
        }
    }

    /// Metres between a coordinate and a row across it, at most.
    #[inline(always)]
    fn distance(&self, t: f32, row: i32) -> f32 {
        // The query and the points in the row may each be half a unit in the last place from where they seem.
        let slack = (t.abs() + 1.0) * (4.0 * f32::EPSILON);
        ((row as f32 - t).max(t - row as f32 - 1.0) - slack).max(0.0) * self.edge
    }
}

impl Grid {
    /// Sorts the points for queries of that radius, in metres: `NaN` and what is below 1e-18 count as 1e-18, what is
    /// above 1e18 as that. Points with coordinates that are not finite are in the order too, somewhere. The result does
    /// not depend on the number of threads. Memory is taken only where there are more points than ever before.
    ///
    /// # Panics
    /// With 2^31 points or more.
    pub fn rebuild(&mut self, positions: &[Vec3], radius: f32) {
        assert!(positions.len() < 1 << 31, "too many points for one grid");
        let finite = |bounds: Aabb, p: &Vec3| if p.is_finite() { bounds.include(*p) } else { bounds };
        let bounds = positions
            .par_chunks(CHUNK)
            .map(|chunk| chunk.iter().fold(Aabb::EMPTY, finite))
            .reduce(|| Aabb::EMPTY, Aabb::union);
        let cells = Cells::new(bounds, radius, positions.len());
        let count = cells.count();
        // Cells by bucket: a power of two, so that the last buckets may be empty.
        let shift = count.div_ceil(BUCKETS).next_power_of_two().ilog2();
        self.cells = cells;
        resize(&mut self.places, positions.len().div_ceil(CHUNK), || [0; BUCKETS]);
        resize(&mut self.keyed, positions.len(), AtomicU64::default);
        resize(&mut self.order, positions.len(), || 0);
        resize(&mut self.starts, count + 1, || 0);

        let chunks = || positions.par_chunks(CHUNK);
        self.places.par_iter_mut().zip(chunks()).for_each(|(places, chunk)| {
            *places = [0; BUCKETS];
            for p in chunk {
                places[(cells.place(*p) >> shift) as usize] += 1;
            }
        });
        let mut place = 0;
        for bucket in 0..BUCKETS {
            for places in &mut self.places {
                place += std::mem::replace(&mut places[bucket], place);
            }
        }
        let keyed = &self.keyed;
        self.places.par_iter_mut().zip(chunks()).enumerate().for_each(|(i, (places, chunk))| {
            for (j, p) in chunk.iter().enumerate() {
                let key = cells.place(*p);
                let place = &mut places[(key >> shift) as usize];
                keyed[*place as usize].store((key as u64) << 32 | (i * CHUNK + j) as u64, Relaxed);
                *place += 1;
            }
        });
        let (last, starts) = self.starts.split_last_mut().expect("has one element more than there are cells");
        *last = positions.len() as u32;
        if let Some(ends) = self.places.last() {
            Part { shift, ends, keyed, starts, order: &mut self.order, cell: 0, point: 0 }.sort();
        }
    }

    /// The points (indices into the positions given to [`Grid::rebuild`]), cell by cell.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Memory held, bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of::<u32>() * (self.starts.capacity() + self.order.capacity())
            + size_of::<u64>() * self.keyed.capacity()
            + size_of::<[u32; BUCKETS]>() * self.places.capacity()
    }

    /// Ranges of [`Grid::order`] that cover every point whose distance from `x` is at most the radius, and some others;
    /// none is empty and no two overlap.
    ///
    /// Everything is covered by one range where coordinates are so large (2^21 radii) that they hardly resolve the
    /// radius.
    #[inline(always)]
    pub fn near(&self, x: Vec3) -> Ranges {
        let mut ranges = Ranges { len: 0, ranges: [0; CAPACITY] };
        let cells = &self.cells;
        let first = |axis: usize| cell((x[axis] - cells.radius) * cells.scale[axis]).max(cells.low[axis]);
        let last = |axis: usize| cell((x[axis] + cells.radius) * cells.scale[axis]).min(cells.high[axis]);
        let ([y0, z0], [y1, z1]) = ([first(1), first(2)], [last(1), last(2)]);
        if self.order.is_empty() || y0 > y1 || z0 > z1 {
            return ranges;
        }
        if (y1 - y0).max(z1 - z0) >= ROWS {
            ranges.push(0, self.order.len() as u32);
            return ranges;
        }
        let t = (x * cells.scale).max(Vec3::splat(-OUTERMOST)).min(Vec3::splat(OUTERMOST));
        let squared = cells.radius * cells.radius * (1.0 + 8.0 * f32::EPSILON);
        for z in z0..=z1 {
            let dz = cells.distance(t.z, z);
            for y in y0..=y1 {
                let dy = cells.distance(t.y, y);
                let chord = squared - dz * dz - dy * dy;
                if chord < 0.0 {
                    continue;
                }
                let half = chord.sqrt();
                let x0 = cell((x.x - half) * cells.scale.x).max(cells.low[0]);
                let x1 = cell((x.x + half) * cells.scale.x).min(cells.high[0]);
                if x0 <= x1 {
                    self.row(cells.row(y, z), (x0 - cells.low[0]) as u32, (x1 - cells.low[0]) as u32, &mut ranges);
                }
            }
        }
        if let Layout::Hashed { .. } = cells.layout {
            ranges.unite();
        }
        ranges
    }

    /// As [`Grid::near`], calling back.
    #[inline(always)]
    pub fn visit(&self, x: Vec3, visit: impl FnMut(Range<usize>)) {
        self.near(x).iter().for_each(visit);
    }

    /// Adds the cells `from..=to` of a row.
    #[inline(always)]
    fn row(&self, row: u32, from: u32, to: u32, ranges: &mut Ranges) {
        let start = |cell: u32| self.starts[cell as usize];
        match self.cells.layout {
            Layout::Dense { .. } => ranges.push(start(row + from), start(row + to + 1)),
            Layout::Hashed { mask } if to - from >= mask => ranges.push(0, start(mask + 1)),
            Layout::Hashed { mask } => {
                let from = row.wrapping_add(from) & mask;
                let to = row.wrapping_add(to) & mask;
                if from <= to {
                    ranges.push(start(from), start(to + 1));
                } else {
                    ranges.push(start(from), start(mask + 1));
                    ranges.push(0, start(to + 1));
                }
            }
        }
    }
}

/// Consecutive buckets while they are sorted.
struct Part<'a> {
    /// Cells of a bucket, as a power of two.
    shift: u32,
    /// Where each bucket ends in `order`, counted from the first of all.
    ends: &'a [u32],
    keyed: &'a [AtomicU64],
    starts: &'a mut [u32],
    order: &'a mut [u32],
    /// The number of the first cell in `starts`, ...
    cell: usize,
    /// ... and of the first point in `order`.
    point: usize,
}

impl Part<'_> {
    fn sort(self) {
        let middle = self.ends.len() / 2;
        if middle == 0 || self.order.len() < SERIAL {
            return self.count();
        }
        let cells = (middle << self.shift).min(self.starts.len());
        let points = self.ends[middle - 1] as usize - self.point;
        let (ends, more_ends) = self.ends.split_at(middle);
        let (keyed, more_keyed) = self.keyed.split_at(points);
        let (starts, more_starts) = self.starts.split_at_mut(cells);
        let (order, more_order) = self.order.split_at_mut(points);
        let right = Part {
            ends: more_ends,
            keyed: more_keyed,
            starts: more_starts,
            order: more_order,
            cell: self.cell + cells,
            point: self.point + points,
            ..self
        };
        let left = Part { ends, keyed, starts, order, ..self };
        rayon::join(|| left.sort(), || right.sort());
    }

    /// The counting sort.
    fn count(self) {
        let read = |keyed: &AtomicU64| {
            let keyed = keyed.load(Relaxed);
            ((keyed >> 32) as usize - self.cell, keyed as u32)
        };
        self.starts.fill(0);
        for keyed in self.keyed {
            self.starts[read(keyed).0] += 1;
        }
        let mut end = self.point as u32;
        for start in self.starts.iter_mut() {
            end += *start;
            *start = end;
        }
        // From the back: what were ends become starts, and equals stay in order.
        for keyed in self.keyed.iter().rev() {
            let (cell, point) = read(keyed);
            self.starts[cell] -= 1;
            self.order[self.starts[cell] as usize - self.point] = point;
        }
    }
}

/// Ranges of sorted points.
#[derive(Clone, Debug)]
pub struct Ranges {
    len: usize,
    /// Start in the upper half, end in the lower one.
    ranges: [u64; CAPACITY],
}

impl Ranges {
    /// The ranges.
    #[inline(always)]
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Range<usize>> + '_ {
        self.ranges[..self.len].iter().map(|range| (range >> 32) as usize..*range as u32 as usize)
    }

    #[inline(always)]
    fn push(&mut self, start: u32, end: u32) {
        self.ranges[self.len] = (start as u64) << 32 | end as u64;
        self.len += (start < end) as usize;
    }

    /// Sorts them and makes one of those that overlap or touch.
    #[inline(always)]
    fn unite(&mut self) {
        for i in 1..self.len {
            let range = self.ranges[i];
            let mut at = i;
            while at > 0 && self.ranges[at - 1] > range {
                self.ranges[at] = self.ranges[at - 1];
                at -= 1;
            }
            self.ranges[at] = range;
        }
        let mut kept = 0;
        for i in 1..self.len {
            let (last, next) = (self.ranges[kept], self.ranges[i]);
            if (next >> 32) as u32 <= last as u32 {
                let end = (last as u32).max(next as u32);
                self.ranges[kept] = (last >> 32) << 32 | end as u64;
            } else {
                kept += 1;
                self.ranges[kept] = next;
            }
        }
        self.len = self.len.min(kept + 1);
    }
}

/// The rows of eight that a range of sorted points touches.
#[inline(always)]
pub fn rows(range: Range<usize>) -> Range<usize> {
    range.start / WIDTH..range.end.div_ceil(WIDTH)
}

/// Which lanes of a row that it touches belong to a range of sorted points, lane `i` as bit `i`.
#[inline(always)]
pub fn lanes(range: Range<usize>, row: usize) -> u32 {
    let before = range.start.saturating_sub(row * WIDTH);
    let within = (range.end - row * WIDTH).min(WIDTH);
    (0xff << before) & (0xff >> (WIDTH - within))
}

#[cfg(test)]
#[path = "grid_tests.rs"]
mod tests;
