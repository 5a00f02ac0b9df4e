//! A car.

use super::mesh::Mesh;

/// Shapes cut from paper: at each place along z the lower and upper edge, and the half width there, as flat faces.
fn slab(sections: &[[f64; 3]], widths: impl Fn(f64) -> f64) -> Mesh {
    // around a section: lower right, upper right, upper left, lower left
    let ring = |&[z, low, high]: &[f64; 3]| {
        [(1.0, low), (1.0, high), (-1.0, high), (-1.0, low)].map(|(side, y)| [side * widths(y), y, z])
    };
    let rings: Vec<_> = sections.iter().map(ring).collect();
    let mut mesh = Mesh::grid(4, rings.len(), [true, false], |i, j| rings[j][i]);
    let last = 4 * (rings.len() - 1);
    mesh.triangles.extend([[0, 2, 1], [0, 3, 2], [last, last + 1, last + 2], [last, last + 2, last + 3]]);
    mesh
}

/// The body, 4.3 metres long, its front at z = -2.1.
pub(super) fn body() -> Mesh {
    let sections = [
        [-2.1, 0.35, 0.62],
        [-2.0, 0.28, 0.74],
        [-1.0, 0.25, 0.92],
        [1.5, 0.25, 0.98],
        [2.05, 0.3, 0.94],
        [2.2, 0.4, 0.86],
    ];
    slab(&sections, |_| 0.86)
}

/// The cabin, narrower at the top.
pub(super) fn cabin() -> Mesh {
    slab(&[[-1.0, 0.9, 0.93], [-0.2, 0.9, 1.42], [1.0, 0.9, 1.42], [1.75, 0.9, 0.96]], |y| 0.86 - 0.42 * (y - 0.9))
}
