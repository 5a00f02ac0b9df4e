//! Writes a binary PLY of a million triangles, reads it, and tells time and peak memory (Linux).

use std::io::Write;
use std::time::Instant;

/// Vertices along a side.
const SIDE: u32 = 708;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("large.ply");
    let mut file = std::io::BufWriter::new(std::fs::File::create(&path)?);
    let (vertices, faces) = (SIDE * SIDE, 2 * (SIDE - 1) * (SIDE - 1));
    write!(
        file,
        "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
         property float z\nelement face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    )?;
    for i in 0..vertices {
        let (x, y) = ((i % SIDE) as f32 / SIDE as f32, (i / SIDE) as f32 / SIDE as f32);
        [x, y, (20.0 * x).sin() * (20.0 * y).cos()].iter().try_for_each(|c| file.write_all(&c.to_le_bytes()))?;
    }
    for i in 0..(SIDE - 1) * (SIDE - 1) {
        let a = i / (SIDE - 1) * SIDE + i % (SIDE - 1);
        for triangle in [[a, a + 1, a + SIDE], [a + 1, a + SIDE + 1, a + SIDE]] {
            file.write_all(&[3])?;
            triangle.iter().try_for_each(|v| file.write_all(&v.to_le_bytes()))?;
        }
    }
    file.into_inner()?.sync_all()?;

    let before = peak_kib()?;
    let start = Instant::now();
    let mesh = tyndall_formats::mesh::ply::read(&path)?;
    let (time, after) = (start.elapsed(), peak_kib()?);
    println!(
        "{} triangles, {} KiB on disk: {time:.2?}, peak {after} KiB, {before} KiB before",
        mesh.triangles.len(),
        std::fs::metadata(&path)?.len() / 1024
    );
    Ok(())
}

/// The largest resident size of this process so far.
fn peak_kib() -> Result<u64, Box<dyn std::error::Error>> {
    let status = std::fs::read_to_string("/proc/self/status")?;
    let line = status.lines().find(|l| l.starts_with("VmHWM")).ok_or("no VmHWM")?;
    Ok(line.split_whitespace().nth(1).ok_or("no number")?.parse()?)
}
