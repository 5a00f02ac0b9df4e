//! Triangle meshes and the binary PLY files that hold them.

use std::collections::HashMap;

/// A point or a direction.
pub(super) type Vector = [f64; 3];

/// Triangles over shared vertices. Without normals readers make smooth ones.
#[derive(Default)]
pub(super) struct Mesh {
    pub(super) positions: Vec<Vector>,
    pub(super) normals: Vec<Vector>,
    pub(super) triangles: Vec<[usize; 3]>,
}

impl Mesh {
    /// Binary little-endian PLY.
    pub(super) fn ply(&self) -> Vec<u8> {
        let with_normals = !self.normals.is_empty();
        let normals = if with_normals { "property float nx\nproperty float ny\nproperty float nz\n" } else { "" };
        let short = self.positions.len() <= usize::from(u16::MAX) + 1;
        let mut bytes = format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
             {normals}element face {}\nproperty list uchar {} vertex_indices\nend_header\n",
            self.positions.len(),
            self.triangles.len(),
            if short { "ushort" } else { "int" },
        )
        .into_bytes();
        let mut put = |v: &Vector| v.iter().for_each(|&x| bytes.extend((x as f32).to_le_bytes()));
        for (i, position) in self.positions.iter().enumerate() {
            put(position);
            if with_normals {
                put(&self.normals[i]);
            }
        }
        for triangle in &self.triangles {
            bytes.push(3);
            for &v in triangle {
                match short {
                    true => bytes.extend((v as u16).to_le_bytes()),
                    false => bytes.extend((v as i32).to_le_bytes()),
                }
            }
        }
        bytes
    }

    /// A rectangle of `columns` by `rows` vertices, row after row. Its triangles face along (column step) x (row step).
    /// `closed` joins the last column, or row, to the first.
    pub(super) fn grid(columns: usize, rows: usize, closed: [bool; 2], at: impl Fn(usize, usize) -> Vector) -> Self {
        let mut mesh = Self::default();
        for row in 0..rows {
            mesh.positions.extend((0..columns).map(|column| at(column, row)));
        }
        let steps = |n: usize, closed: bool| if closed { n } else { n - 1 };
        for row in 0..steps(rows, closed[1]) {
            for column in 0..steps(columns, closed[0]) {
                let vertex = |i: usize, j: usize| (row + j) % rows * columns + (column + i) % columns;
                mesh.triangles.push([vertex(0, 0), vertex(1, 0), vertex(1, 1)]);
                mesh.triangles.push([vertex(0, 0), vertex(1, 1), vertex(0, 1)]);
            }
        }
        mesh
    }

    /// An icosahedron whose triangles are cut in four `levels` times, its vertices at `radius(direction)`; faces outwards.
    pub(super) fn star(levels: u32, radius: impl Fn(Vector) -> f64) -> Self {
        let golden = 0.5 * (1.0 + 5.0f64.sqrt());
        let mut mesh = Self::default();
        for axis in 0..3 {
            for (one, long) in [(-1.0, -golden), (1.0, -golden), (-1.0, golden), (1.0, golden)] {
                let mut p = [0.0; 3];
                (p[(axis + 1) % 3], p[(axis + 2) % 3]) = (one, long);
                mesh.positions.push(unit(p));
            }
        }
        // the faces are the triples of vertices at the distance of an edge
        let p = &mesh.positions;
        let near = |a: usize, b: usize| dot(p[a], p[b]) > 0.4;
        for a in 0..12 {
            for b in (a + 1..12).filter(|&b| near(a, b)) {
                for c in (b + 1..12).filter(|&c| near(a, c) && near(b, c)) {
                    let outwards = dot(cross(sub(p[b], p[a]), sub(p[c], p[a])), p[a]) > 0.0;
                    mesh.triangles.push(if outwards { [a, b, c] } else { [a, c, b] });
                }
            }
        }
        for _ in 0..levels {
            let mut middles = HashMap::new();
            let mut finer = Vec::with_capacity(4 * mesh.triangles.len());
            for &[a, b, c] in &mesh.triangles {
                let positions = &mut mesh.positions;
                let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(i, j)| {
                    *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                        positions.push(unit(add(positions[i], positions[j])));
                        positions.len() - 1
                    })
                });
                finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
            }
            mesh.triangles = finer;
        }
        for p in &mut mesh.positions {
            *p = scale(radius(*p), *p);
        }
        mesh
    }

    /// Both, side by side.
    pub(super) fn with(mut self, other: &Self) -> Self {
        let first = self.positions.len();
        self.positions.extend(&other.positions);
        self.normals.extend(&other.normals);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
        self
    }
}

pub(super) fn add(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(super) fn sub(a: Vector, b: Vector) -> Vector {
    add(a, scale(-1.0, b))
}

pub(super) fn scale(s: f64, a: Vector) -> Vector {
    a.map(|x| s * x)
}

pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(super) fn unit(a: Vector) -> Vector {
    scale(1.0 / dot(a, a).sqrt(), a)
}
