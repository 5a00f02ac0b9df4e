//! Glasses with something to drink in them, in centimetres.

use super::revolved::Revolved;

/// Steps around the axis.
const AROUND: usize = 72;

/// A glass of milk.
const MILK: Drink = Drink { foot: 3.0, lean: 0.07, wall: 0.22, floor: 0.9, level: 9.0, height: 12.0 };
/// A taller glass of juice.
const JUICE: Drink = Drink { foot: 2.9, lean: 0.045, wall: 0.2, floor: 0.8, level: 11.2, height: 13.5 };

/// The side files of milk-glass.xml and fruit-juice.xml.
pub(super) fn files() -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    for (name, drink) in [("milk-glass", MILK), ("fruit-juice", JUICE)] {
        for (part, surface) in ["air", "side", "top"].iter().zip(drink.interfaces()) {
            files.push((format!("{name}-{part}.ply"), surface.mesh(AROUND).ply()));
        }
    }
    files
}

/// A filled glass, wider towards its rim.
struct Drink {
    /// Outer radius at the foot.
    foot: f64,
    /// How much the radius grows with height.
    lean: f64,
    /// Thickness of the wall, measured along the radius.
    wall: f64,
    /// Height of the drink's underside.
    floor: f64,
    /// Height at which the drink meets the glass.
    level: f64,
    /// Height of the rim.
    height: f64,
}

impl Drink {
    /// Glass to air, drink to glass, drink to air; they meet in one circle, with the same vertices.
    fn interfaces(&self) -> [Revolved; 3] {
        let outer = |y: f64| self.foot + self.lean * y;
        let inner = |y: f64| outer(y) - self.wall;
        let slant = |side: f64| {
            let n = 1.0f64.hypot(self.lean);
            [side / n, -side * self.lean / n]
        };
        // quarter circle of `steps` from angle a0 to a1 around a centre, the normal pointing away from it (or to it)
        let arc = |[r, y]: [f64; 2], radius: f64, a0: f64, a1: f64, steps: usize, side: f64| {
            (0..=steps).map(move |i| {
                let (sin, cos) = (a0 + (a1 - a0) * i as f64 / steps as f64).to_radians().sin_cos();
                ([r + radius * cos, y + radius * sin], [side * cos, side * sin])
            })
        };
        let lean = self.lean.atan().to_degrees();

        // from the middle of the underside, round the foot, up the outside, over the rim, down to the drink
        let mut air = vec![([0.0, 0.0], [0.0, -1.0]), ([1.5, 0.0], [0.0, -1.0])];
        air.extend(arc([outer(0.0) - 0.35, 0.35], 0.35, -90.0, -lean, 6, 1.0));
        air.extend((1..8).map(|i| 0.6 + (self.height - 0.6) * f64::from(i) / 8.0).map(|y| ([outer(y), y], slant(1.0))));
        air.extend(arc(
            [0.5 * (outer(self.height) + inner(self.height)), self.height],
            0.5 * self.wall,
            -lean,
            180.0 - lean,
            8,
            1.0,
        ));
        air.extend(
            (0..=4)
                .map(|i| self.height - 0.1 - (self.height - 0.1 - self.level) * f64::from(i) / 4.0)
                .map(|y| ([inner(y), y], slant(-1.0))),
        );

        // from the circle down the inside to the middle of the bottom
        let corner = 0.8;
        let mut side: Vec<_> = (0..8)
            .map(|i| self.level - (self.level - self.floor - corner) * f64::from(i) / 8.0)
            .map(|y| ([inner(y), y], slant(1.0)))
            .collect();
        side.extend(arc([inner(self.floor + corner) - corner, self.floor + corner], corner, -lean, -90.0, 8, 1.0));
        side.push(([0.0, self.floor], [0.0, -1.0]));

        // the surface, flat, with a meniscus that climbs the wall
        let rim = inner(self.level);
        let meniscus = |r: f64| 0.12 * (-(rim - r) / 0.13).exp();
        let top = [0.0, 0.4, 0.7, 0.85, 0.91, 0.94, 0.96, 0.975, 0.99, 1.0].map(|s| {
            let r: f64 = s * rim;
            let n = [-meniscus(r) / 0.13, 1.0];
            let length = n[0].hypot(n[1]);
            ([r, self.level - meniscus(rim) + meniscus(r)], n.map(|c| c / length))
        });
        [air, side, top.to_vec()].map(|profile| Revolved { profile })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The interfaces share the circle where they meet.
    #[test]
    fn drinks_meet_their_glass() {
        for drink in [MILK, JUICE] {
            let [air, side, top] = drink.interfaces().map(|surface| surface.profile);
            let meeting = air.last().unwrap().0;
            assert_eq!(meeting, side[0].0);
            let near = top.last().unwrap().0;
            assert!((meeting[0] - near[0]).abs() < 1e-12 && (meeting[1] - near[1]).abs() < 1e-12);
        }
    }
}
