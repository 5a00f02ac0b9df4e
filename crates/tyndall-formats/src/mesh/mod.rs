//! Triangle meshes.
//!
//! All readers give what the file says, polygons cut into fans. Texture coordinates are those of the file, not flipped.
//! Normals missing in a file are made: a reader's mesh is smooth, and clearing its normals makes it flat.

pub mod obj;
pub mod ply;
pub mod serialized;

use tyndall::scene::desc::MeshDesc;

/// Vertex normals: those of the triangles around a vertex, weighted by their angles there (Thuermer and Wuethrich 1998).
///
/// A vertex without area around it gets +z.
pub fn smooth_normals(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<[f32; 3]> {
    let mut sums = vec![[0.0f32; 3]; positions.len()];
    for triangle in triangles {
        let p = triangle.map(|i| positions[i as usize].map(f64::from));
        let Some(normal) = unit(cross(sub(p[1], p[0]), sub(p[2], p[0]))) else { continue };
        for corner in 0..3 {
            let (a, b, c) = (p[corner], p[(corner + 1) % 3], p[(corner + 2) % 3]);
            let (Some(u), Some(v)) = (unit(sub(b, a)), unit(sub(c, a))) else { continue };
            let angle = dot(u, v).clamp(-1.0, 1.0).acos();
            let sum = &mut sums[triangle[corner] as usize];
            for axis in 0..3 {
                sum[axis] += (normal[axis] * angle) as f32;
            }
        }
    }
    sums.into_iter().map(|n| unit(n.map(f64::from)).map_or([0.0, 0.0, 1.0], |n| n.map(|x| x as f32))).collect()
}

/// Brings the normals to unit length. Missing ones, and those of length zero, are made from the triangles.
pub(crate) fn complete_normals(mesh: &mut MeshDesc) {
    let mut made = Vec::new();
    if mesh.normals.is_empty() {
        mesh.normals = smooth_normals(&mesh.positions, &mesh.triangles);
        return;
    }
    for i in 0..mesh.normals.len() {
        mesh.normals[i] = match unit(mesh.normals[i].map(f64::from)) {
            Some(n) => n.map(|x| x as f32),
            None => {
                if made.is_empty() {
                    made = smooth_normals(&mesh.positions, &mesh.triangles);
                }
                made[i]
            }
        };
    }
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Finite `f32` vectors neither overflow nor vanish when squared as `f64`; products of them may.
fn unit(a: [f64; 3]) -> Option<[f64; 3]> {
    let length = dot(a, a).sqrt();
    (length > 0.0 && length.is_finite()).then(|| a.map(|x| x / length))
}
