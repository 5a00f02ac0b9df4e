use super::super::point_sets::{all, clustered, not_finite, queries, squared, uniform, with_threads};
use super::*;

fn built(positions: &[Vec3]) -> KdTree {
    let mut tree = KdTree::default();
    tree.rebuild(positions);
    tree
}

/// Squared distances, as bits, and indices of the nearest, by looking at all.
fn brute_force(positions: &[Vec3], x: Vec3, k: usize, max_radius: f32) -> Vec<(u32, u32)> {
    let reach = (max_radius * max_radius).min(f32::MAX);
    let mut all: Vec<_> = positions.iter().enumerate().map(|(i, p)| (squared(*p, x), i as u32)).collect();
    all.retain(|(squared, _)| *squared <= reach);
    let mut all: Vec<_> = all.into_iter().map(|(squared, i)| (squared.to_bits(), i)).collect();
    all.sort_unstable();
    all.truncate(k);
    all
}

fn answer(found: &mut Neighbours) -> Vec<(u32, u32)> {
    let farthest = found.farthest();
    found.sort();
    assert_eq!(farthest, found.iter().last().map(|(squared, _)| squared));
    assert_eq!(found.farthest(), farthest);
    found.iter().map(|(squared, i)| (squared.to_bits(), i)).collect()
}

#[test]
fn the_nearest_are_those_of_brute_force_at_every_level() {
    let mut found = Neighbours::default();
    for (name, positions, radius) in all() {
        let tree = built(&positions);
        for (i, x) in queries(&positions, radius).into_iter().enumerate() {
            let k = [1, 2, 8, 32, 100, positions.len() + 3][i % 6];
            for max_radius in [f32::INFINITY, radius, 3.0 * radius, 0.0] {
                let truth = brute_force(&positions, x, k, max_radius);
                tree.nearest(x, k, max_radius, &mut found);
                assert_eq!(answer(&mut found), truth, "{name}: {k} around {x} within {max_radius}");
                for level in Level::available() {
                    if !positions.is_empty() {
                        found.start(k, (max_radius * max_radius).min(f32::MAX));
                        level.run(Nearest { tree: &tree, x, found: &mut found });
                        assert_eq!(answer(&mut found), truth, "{name}, {level:?}");
                    }
                }
                let distance = tree.kth_distance(x, k, max_radius, &mut found);
                let expected = truth.get(k - 1).map_or(max_radius, |(bits, _)| f32::from_bits(*bits).sqrt());
                assert_eq!(distance, expected, "{name}");
            }
        }
    }
}

/// Every number of points up to a few levels of nodes.
#[test]
fn trees_of_all_sizes_find_everything() {
    let positions = uniform(3000, 1);
    let mut found = Neighbours::default();
    let mut tree = KdTree::default();
    for count in (0..300).chain((300..3000).step_by(97)) {
        tree.rebuild(&positions[..count]);
        for x in [positions[7], Vec3::splat(0.5), Vec3::NEG_ONE] {
            for k in [5, count] {
                tree.nearest(x, k, f32::INFINITY, &mut found);
                assert_eq!(answer(&mut found), brute_force(&positions[..count], x, k, f32::INFINITY), "{count}");
            }
        }
        for leaf in 0..1 << tree.halvings {
            assert!(count <= 16 || (1..=2).contains(&tree.leaf(leaf).len()), "{count}");
        }
    }
}

#[test]
fn few_leaves_are_looked_at() {
    // Boxes hold their points tightly and hardly overlap.
    let tree = built(&uniform(10_000, 1));
    let leaves = 1 << tree.halvings;
    let volume = |leaf: usize| {
        let bounds = tree.packets[tree.leaf(leaf)].iter().fold(Aabb::EMPTY, |b, p| b.union(p.bounds()));
        bounds.extent().element_product()
    };
    let volume: f32 = (0..leaves).map(volume).sum();
    assert!(volume < 0.8, "{volume}");
    let root = tree.nodes[0].bounds();
    let all = Aabb::from_points(uniform(10_000, 1));
    assert_eq!(root, all);
}

#[test]
fn what_is_not_finite_is_not_found() {
    let mut positions = not_finite();
    positions.extend(uniform(200, 1));
    positions.extend(not_finite());
    positions.extend([Vec3::splat(f32::MAX), Vec3::splat(1e-40), Vec3::splat(1e18)]);
    let tree = built(&positions);
    let mut found = Neighbours::default();
    for x in queries(&uniform(200, 1), 0.1) {
        for k in [3, 1000] {
            tree.nearest(x, k, f32::INFINITY, &mut found);
            assert_eq!(answer(&mut found), brute_force(&positions, x, k, f32::INFINITY));
        }
    }
    for x in not_finite() {
        tree.nearest(x, 3, f32::INFINITY, &mut found);
        assert!(found.is_empty());
    }
    built(&not_finite()).nearest(Vec3::ZERO, 3, f32::INFINITY, &mut found);
    assert!(found.is_empty());
    for (k, max_radius) in [(0, 1.0), (3, f32::NAN), (3, -1.0), (3, f32::NEG_INFINITY)] {
        tree.nearest(Vec3::ZERO, k, max_radius, &mut found);
        assert!(found.is_empty() && found.farthest().is_none());
    }
}

#[test]
fn the_tree_does_not_depend_on_the_number_of_threads() {
    for positions in [uniform(100_000, 1), clustered(100_000, 2), vec![Vec3::ONE; 50_000]] {
        let with = |threads| with_threads(threads, || format!("{:?}", built(&positions)));
        let one = with(1);
        assert!(one == with(2) && one == with(3));
    }
}

#[test]
fn memory_is_bounded_and_used_again() {
    for count in [1, 100, 1025, 65_536, 65_537, 100_000, 131_073] {
        let positions = uniform(count, 1);
        let mut tree = built(&positions[..count * 9 / 10]);
        tree.rebuild(&positions);
        assert!(tree.memory_bytes() <= 20 * count + 400, "{count}: {}", tree.memory_bytes());
        let (packets, nodes, fresh) = (tree.packets.as_ptr(), tree.nodes.as_ptr(), format!("{tree:?}"));
        tree.rebuild(&clustered(count / 2, 3));
        tree.rebuild(&positions);
        assert_eq!((packets, nodes), (tree.packets.as_ptr(), tree.nodes.as_ptr()));
        assert!(fresh == format!("{tree:?}"), "what was there before shows");
    }
}
