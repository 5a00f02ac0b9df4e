//! Radii that follow from the data.

use super::{Beam, Photon};
use crate::accel::{KdTree, Neighbours};
use crate::math::Vec3;
use rayon::prelude::*;

/// How many points are asked for their neighbours.
const ASKED: usize = 256;

/// The median distance, metres, from a point to its `k`-th nearest other point; `None` with too few points.
pub fn usual_distance(points: &[Vec3], k: usize) -> Option<f32> {
    if points.len() <= k {
        return None;
    }
    let step = points.len().div_ceil(ASKED);
    let mut distances = Vec::with_capacity(points.len());
    let mut usual: Vec<f32> = points
        .iter()
        .step_by(step)
        .map(|x| {
            distances.clear();
            distances.extend(points.iter().map(|y| x.distance_squared(*y)));
            // The point itself is the nearest.
            distances.select_nth_unstable_by(k, f32::total_cmp).1.sqrt()
        })
        .collect();
    usual.sort_unstable_by(f32::total_cmp);
    Some(usual[usual.len() / 2])
}

/// The radius at which a ray through the region where the beams are meets about `wanted` of them, if there were `factor`
/// times as many, metres; `None` without beams. Lines of total length L in a volume V cross a ray of length l within r
/// about `pi / 2 r l L / V` times.
pub fn beam_radius(beams: &[Beam], factor: f32, wanted: f32) -> Option<f32> {
    let total: f32 = beams.iter().map(|b| b.length).sum();
    let middle = |b: &Beam| b.origin + 0.5 * b.length * b.direction;
    let centre = beams.iter().map(|b| b.length * middle(b)).sum::<Vec3>() / total;
    // A segment's own second moment counts too.
    let spread = |b: &Beam| b.length * (middle(b).distance_squared(centre) + b.length * b.length / 12.0);
    let variance = beams.iter().map(spread).sum::<f32>() / total;
    // The ball of uniform density with this variance.
    let ball = (variance * (5.0 / 3.0)).sqrt();
    let volume = 4.0 / 3.0 * std::f32::consts::PI * ball.powi(3);
    let radius = wanted * volume / (std::f32::consts::FRAC_PI_2 * volume.cbrt() * total * factor);
    let radius = radius.min(LARGEST_SHARE * ball);
    (radius > 0.0 && radius.is_finite()).then_some(radius)
}

/// Largest automatic radius of beams, in units of the radius of the region where they are.
const LARGEST_SHARE: f32 = 0.01;

/// Gives every photon the radius within which about `k` others lie, times `factor`, at most `most` metres: from its m-th
/// neighbour, m = ceil(sqrt(k)), as if their density were the same all around (Jarosz, Zwicker and Jensen 2008, section 5).
/// A photon does not count itself.
pub fn adapt(photons: &mut [Photon], tree: &mut KdTree, positions: &mut Vec<Vec3>, k: u32, factor: f32, most: f32) {
    positions.clear();
    positions.par_extend(photons.par_iter().map(|p| p.position));
    tree.rebuild(positions);
    let pilot = f64::from(k).sqrt().ceil();
    let scale = factor * (f64::from(k) / pilot).cbrt() as f32;
    photons.par_iter_mut().for_each_init(Neighbours::default, |scratch, photon| {
        let distance = tree.kth_distance(photon.position, pilot as usize + 1, most, scratch);
        photon.radius = (distance * scale).min(most);
    });
}
