//! `cargo xtask scenes`: the side files of the scenes, computed.

mod bumpy_sphere;
mod drinks;
mod lighthouse;
mod mesh;
mod noise;
mod revolved;
mod smoke;
mod statue;
mod street;
mod underwater;

use std::io;
use std::path::Path;

/// Names and contents of the side files under `scenes/`.
fn files() -> Vec<(String, Vec<u8>)> {
    let mut files = vec![
        ("smoke-plume.vol".to_string(), smoke::plume_grid()),
        ("bumpy-sphere.ply".to_string(), bumpy_sphere::ball().ply()),
        ("underwater-surface.ply".to_string(), underwater::surface().ply()),
        ("statue-smoke-figure.ply".to_string(), statue::figure().ply()),
        ("statue-smoke-pedestal.ply".to_string(), statue::pedestal().ply()),
        ("lighthouse-white.ply".to_string(), lighthouse::white().ply()),
        ("lighthouse-red.ply".to_string(), lighthouse::red().ply()),
        ("lighthouse-rock.ply".to_string(), lighthouse::rock().ply()),
        ("lighthouse-sky.pfm".to_string(), lighthouse::sky()),
        ("foggy-street-body.ply".to_string(), street::body().ply()),
        ("foggy-street-cabin.ply".to_string(), street::cabin().ply()),
    ];
    files.extend(drinks::files());
    files
}

/// Writes every side file under `scenes/`.
pub(crate) fn write(root: &Path) -> io::Result<()> {
    for (name, bytes) in files() {
        std::fs::write(root.join("scenes").join(name), bytes)?;
    }
    peers(root)
}

/// Writes the grid of the peers' smoke, too large to be kept.
pub(crate) fn peers(root: &Path) -> io::Result<()> {
    std::fs::write(root.join("scenes/peers/density64.vol"), smoke::puff_grid())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The committed files are what the generator writes, but for last digits of sines and exponentials.
    #[test]
    fn files_are_up_to_date() {
        for (name, bytes) in files() {
            let kept = std::fs::read(crate::root().join("scenes").join(&name)).unwrap();
            let different = kept.iter().zip(&bytes).filter(|(a, b)| a != b).count();
            assert!(kept.len() == bytes.len() && different * 50 < kept.len(), "{name}: run cargo xtask scenes");
        }
    }

    /// Around every vertex the triangles close, and they face outwards.
    #[test]
    fn bodies_are_closed() {
        use mesh::{Mesh, cross, dot};
        let closed = |name: &str, mesh: Mesh| {
            let mut sides = std::collections::HashSet::new();
            let mut volume = 0.0;
            for &[a, b, c] in &mesh.triangles {
                let [p, q, r] = [a, b, c].map(|v| mesh.positions[v]);
                volume += dot(cross(p, q), r) / 6.0;
                assert!([(a, b), (b, c), (c, a)].into_iter().all(|side| sides.insert(side)), "{name}");
            }
            assert!(volume > 0.0 && sides.iter().all(|&(a, b)| sides.contains(&(b, a))), "{name}: {volume}");
        };
        closed("ball", bumpy_sphere::ball());
        closed("figure", statue::figure());
        closed("rock", lighthouse::rock());
        closed("body", street::body());
        closed("cabin", street::cabin());
    }
}
