use super::super::point_sets::{all, clustered, not_finite, queries, squared, uniform, with_threads};
use super::*;

fn built(positions: &[Vec3], radius: f32) -> Grid {
    let mut grid = Grid::default();
    grid.rebuild(positions, radius);
    let mut order = grid.order().to_vec();
    order.sort_unstable();
    assert!(order.into_iter().eq(0..positions.len() as u32), "each point once");
    grid
}

/// Checks that everything within the radius is covered, once; returns how many points are.
fn covered(grid: &Grid, positions: &[Vec3], x: Vec3, radius: f32) -> usize {
    let mut times = vec![0; positions.len()];
    let mut sum = 0;
    grid.visit(x, |range| {
        assert!(!range.is_empty());
        sum += range.len();
        grid.order()[range].iter().for_each(|point| times[*point as usize] += 1);
    });
    for (p, times) in positions.iter().zip(times) {
        assert!(times <= 1, "{p} is covered {times} times around {x}");
        assert!(times == 1 || !(squared(*p, x) <= radius * radius), "{p} is missing around {x}");
    }
    sum
}

#[test]
fn everything_within_the_radius_is_covered_once() {
    for (name, positions, suited) in all() {
        for radius in [suited, 0.1 * suited, 10.0 * suited, 1e3 * suited, 1e-6 * suited] {
            println!("{name}, radius {radius}");
            let grid = built(&positions, radius);
            for x in queries(&positions, radius) {
                covered(&grid, &positions, x, radius);
            }
        }
    }
}

#[test]
fn few_others_are_covered() {
    let far = |offset: f32| uniform(10_000, 2).into_iter().map(move |p| p + offset);
    let sets = [
        ("uniform", uniform(20_000, 1), 0.0726, true),
        ("hashed", far(0.0).chain(far(1e5)).collect(), 0.0914, false),
        ("plane", uniform(20_000, 3).into_iter().map(|p| Vec3::new(p.x, p.y, p.x)).collect(), 0.02, false),
        ("clustered", clustered(20_000, 4), 0.005, false),
    ];
    for (name, positions, radius, dense) in sets {
        let grid = built(&positions, radius);
        assert_eq!(matches!(grid.cells.layout, Layout::Dense { .. }), dense, "{name}");
        let (mut sum, mut within) = (0, 0);
        for x in positions.iter().step_by(20) {
            sum += covered(&grid, &positions, *x, radius);
            within += positions.iter().filter(|p| squared(**p, *x) <= radius * radius).count();
        }
        let ratio = sum as f64 / within as f64;
        println!("{name}: {within} within, {ratio:.2} times as many covered");
        assert!(ratio < 10.0, "{name}: {ratio}");
    }
}

#[test]
fn any_radius_and_any_coordinate_will_do() {
    let mut positions = uniform(500, 1);
    positions.extend(not_finite());
    positions.extend([Vec3::splat(f32::MAX), Vec3::splat(f32::MIN), Vec3::splat(1e-40)]);
    for radius in [0.1, 0.0, -1.0, f32::NAN, f32::INFINITY, 1e-30, 1e-18, 1e17, f32::MAX] {
        let grid = built(&positions, radius);
        for x in queries(&positions[..500], 0.1) {
            covered(&grid, &positions, x, if radius > 0.0 { radius.min(1e18) } else { 0.0 });
        }
        for x in not_finite() {
            covered(&grid, &positions, x, 0.1);
        }
    }
    let grid = built(&not_finite(), 1.0);
    covered(&grid, &not_finite(), Vec3::ZERO, 1.0);
    assert_eq!(Grid::default().near(Vec3::ZERO).iter().len(), 0);
}

#[test]
fn the_grid_does_not_depend_on_the_number_of_threads() {
    for (positions, radius) in [(uniform(100_000, 1), 0.05), (clustered(100_000, 2), 0.002)] {
        let with = |threads| with_threads(threads, || format!("{:?}", built(&positions, radius)));
        let one = with(1);
        assert!(one == with(2) && one == with(3));
    }
}

#[test]
fn memory_is_bounded_and_used_again() {
    for (positions, radius) in
        [(uniform(50_000, 1), 0.05), (clustered(65_536, 2), 0.001), (clustered(65_535, 2), 0.001)]
    {
        let mut grid = built(&positions[1..], radius);
        grid.rebuild(&positions, radius);
        let bytes = grid.memory_bytes() - size_of_val(grid.order());
        assert!(bytes as f64 <= 12.2 * positions.len() as f64, "{bytes}");
        let places = |grid: &Grid| {
            let (starts, order) = (grid.starts.as_ptr() as usize, grid.order.as_ptr() as usize);
            (starts, order, grid.keyed.as_ptr() as usize, grid.places.as_ptr() as usize)
        };
        let (before, fresh) = (places(&grid), format!("{grid:?}"));
        grid.rebuild(&uniform(30_000, 9), 0.3);
        grid.rebuild(&positions, radius);
        assert_eq!(before, places(&grid));
        assert!(fresh == format!("{grid:?}"), "what was there before shows");
    }
}

#[test]
fn lanes_of_rows_make_up_the_range() {
    for start in 0..40 {
        for end in start + 1..42 {
            let range = start..end;
            let lanes = rows(range.clone()).flat_map(|row| {
                let lanes = lanes(range.clone(), row);
                (0..WIDTH).filter(move |lane| lanes >> lane & 1 == 1).map(move |lane| row * WIDTH + lane)
            });
            assert!(lanes.eq(range.clone()), "{range:?}");
        }
    }
}
