//! Clusters, bounds and cuts by themselves.

use super::bounds::Bounds;
use super::clusters::{Clusters, Member, SURFACE};
use super::cut::{Cut, Graph};
use crate::math::{Rng, Vec3, warp};
use crate::scene::desc::PhaseDesc;
use crate::scene::phase::Phase;

fn phases() -> Vec<Phase> {
    let hg = |g| PhaseDesc::HenyeyGreenstein { g };
    [
        PhaseDesc::Isotropic,
        hg(0.8),
        hg(-0.6),
        PhaseDesc::Rayleigh,
        PhaseDesc::Tabulated { values: vec![0.5, 1.0, 0.2, 3.0] },
    ]
    .iter()
    .map(|desc| Phase::compile(desc).unwrap())
    .collect()
}

/// Members around `centre` within `size`, their axes within `spread` of one, of one class or of all.
fn members(rng: &mut Rng, count: u32, centre: Vec3, size: f32, spread: f32, class: Option<u32>) -> Vec<Member> {
    let main = warp::square_to_sphere(rng.vec2());
    (0..count)
        .map(|index| {
            let inside = Vec3::new(rng.f32(), rng.f32(), rng.f32() * rng.f32()) - 0.5;
            Member {
                position: centre + size * inside,
                axis: (main + spread * warp::square_to_sphere(rng.vec2())).normalize(),
                weight: 0.01 + rng.f32() * rng.f32(),
                peak: 0.5 + rng.f32(),
                floor: if rng.f32() < 0.1 { 0.2 * rng.f32() } else { 0.0 },
                class: class.unwrap_or((rng.f32() * 6.0) as u32),
                index,
            }
        })
        .collect()
}

fn clusters(members: &[Member]) -> Clusters {
    let mut clusters = Clusters::default();
    clusters.rebuild(members.iter().copied());
    clusters
}

/// The members of a cluster, by descending to its leaves.
fn below(clusters: &Clusters, node: u32, found: &mut Vec<u32>) {
    if clusters.node(node).is_leaf() {
        found.push(clusters.choose(node, &mut Rng::keyed(0, 0, 0)).0);
        return;
    }
    for child in clusters.children(node) {
        below(clusters, child, found);
    }
}

#[test]
fn clusters_hold_their_members() {
    let mut rng = Rng::keyed(1, 0, 0);
    for (count, size, spread) in
        [(1, 1.0, 0.5), (2, 0.0, 0.0), (7, 3.0, 2.0), (300, 1.0, 0.1), (300, 0.0, 2.0), (9000, 5.0, 5.0)]
    {
        let members = members(&mut rng, count, Vec3::new(3.0, -1.0, 2.0), size, spread, None);
        let clusters = clusters(&members);
        let total: u32 = clusters.roots.iter().map(|root| clusters.node(*root).count).sum();
        assert_eq!((total, clusters.members.len()), (count, count as usize));
        let step = (clusters.nodes.len() / 500).max(1);
        for node in (0..clusters.nodes.len() as u32).step_by(step).chain(clusters.roots.clone()) {
            let mut found = Vec::new();
            below(&clusters, node, &mut found);
            let node = clusters.node(node);
            assert_eq!(found.len(), node.count as usize);
            let mut weight = 0.0;
            for member in found.iter().map(|i| &members[*i as usize]) {
                assert!(node.bounds.contains(member.position) && node.class == member.class);
                assert!(node.peak >= member.peak && node.floor >= member.floor);
                let (cos, angle) = (node.axis.dot(member.axis), node.sin.atan2(node.cos));
                assert!(cos.clamp(-1.0, 1.0).acos() <= angle + 1e-3, "{cos} {angle}");
                weight += f64::from(member.weight);
            }
            assert!((f64::from(node.weight) / weight - 1.0).abs() < 1e-4);
        }
        // In one order, whoever builds it.
        let again =
            rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap().install(|| self::clusters(&members));
        assert!(clusters.members.iter().map(|m| m.index).eq(again.members.iter().map(|m| m.index)));
    }
}

#[test]
fn members_are_chosen_by_their_weight() {
    let mut rng = Rng::keyed(2, 0, 0);
    let members = members(&mut rng, 20, Vec3::ZERO, 1.0, 1.0, Some(SURFACE));
    let clusters = clusters(&members);
    let root = clusters.roots[0];
    let n = 200_000;
    let mut counts = [0.0; 20];
    for _ in 0..n {
        let (index, probability) = clusters.choose(root, &mut rng);
        let expected = members[index as usize].weight / clusters.node(root).weight;
        assert!((probability / expected - 1.0).abs() < 1e-4);
        counts[index as usize] += 1.0;
    }
    for (count, member) in counts.into_iter().zip(&members) {
        let expected = f64::from(member.weight / clusters.node(root).weight * n as f32);
        assert!((count - expected).abs() < 5.0 * expected.sqrt(), "{count} {expected}");
    }
}

/// What one member sends by way of the other.
fn sent(bounds: &Bounds, light: &Member, point: &Member) -> f32 {
    let way = point.position - light.position;
    let distance = way.length();
    let shape = |member: &Member, along: Vec3| {
        let cos = member.axis.dot(along);
        member.weight
            * member.peak
            * match member.class {
                SURFACE => cos.max(member.floor),
                medium => bounds.phases[medium as usize - 1].ceiling([cos, cos]),
            }
    };
    let along = way / distance;
    shape(light, along)
        * shape(point, -along)
        * (1.0 / (distance * distance)).min(bounds.clamp)
        * (-bounds.extinction * distance).exp()
}

#[test]
fn bounds_are_above_what_clusters_send() {
    let phases = phases();
    let mut rng = Rng::keyed(3, 0, 0);
    let mut tightness = Vec::new();
    for round in 0..400 {
        let (clamp, extinction) = ([4.0, f32::INFINITY][round % 2], [0.0, 0.7][round / 2 % 2]);
        let bounds = Bounds { phases: phases.iter().collect(), clamp, extinction };
        let centre = 4.0 * rng.f32() * warp::square_to_sphere(rng.vec2());
        let spreads = [rng.f32() * 0.01, 3.0 * rng.f32() * rng.f32()];
        let sizes = [2.0 * rng.f32(), 2.0 * rng.f32()];
        let lights = clusters(&members(&mut rng, 60, Vec3::ZERO, sizes[0], spreads[round / 4 % 2], None));
        let points = clusters(&members(&mut rng, 20, centre, sizes[1], spreads[round / 8 % 2], None));
        for _ in 0..200 {
            let pick = |clusters: &Clusters, u: f32| (u * clusters.nodes.len() as f32) as u32;
            let (light, point) = (pick(&lights, rng.f32()), pick(&points, rng.f32()));
            let bound = bounds.of(lights.node(light), points.node(point));
            let mut sum = 0.0;
            let (mut from, mut to) = (Vec::new(), Vec::new());
            below(&lights, light, &mut from);
            below(&points, point, &mut to);
            let find = |clusters: &Clusters, i: u32| *clusters.members.iter().find(|m| m.index == i).unwrap();
            for light in from.iter().map(|i| find(&lights, *i)) {
                for point in to.iter().map(|i| find(&points, *i)) {
                    sum += sent(&bounds, &light, &point);
                }
            }
            assert!(sum <= bound * 1.001 + 1e-12, "round {round}: {sum} above {bound}");
            if sum > 0.0 {
                tightness.push(bound / sum);
            }
        }
    }
    tightness.sort_by(f32::total_cmp);
    let median = tightness[tightness.len() / 2];
    assert!(median < 4.0, "the bounds are loose: {median} times what is sent");
}

#[test]
fn a_cut_has_every_light_with_every_point_once() {
    let phases = phases();
    let bounds = Bounds { phases: phases.iter().collect(), clamp: 4.0, extinction: 0.0 };
    let mut rng = Rng::keyed(4, 0, 0);
    let lights = clusters(&members(&mut rng, 100, Vec3::ZERO, 2.0, 1.0, None));
    let points = clusters(&members(&mut rng, 15, Vec3::X, 2.0, 1.0, None));
    let graph = Graph { lights: &lights, points: &points, bounds: &bounds };
    let mut cut = Cut::default();
    let mut sizes = Vec::new();
    for (threshold, most) in [(f32::INFINITY, 1), (1.0, 10_000), (1e-2, 10_000), (1e-2, 300), (0.0, 10_000)] {
        cut.start(&graph);
        cut.refine(&graph, threshold, most);
        assert!(cut.len() <= most.max(36) && (cut.error() <= threshold || cut.len() == most));
        let mut met = vec![0; 1500];
        for pair in cut.pairs() {
            let (mut from, mut to) = (Vec::new(), Vec::new());
            below(&lights, pair.light, &mut from);
            below(&points, pair.point, &mut to);
            for light in from {
                to.iter().for_each(|point| met[(light * 15 + point) as usize] += 1);
            }
        }
        assert!(met.iter().all(|n| *n == 1), "at {threshold}");
        sizes.push(cut.len());
    }
    assert!(sizes[0] < sizes[1] && sizes[1] < sizes[2] && sizes[2] < sizes[4], "{sizes:?}");
}
