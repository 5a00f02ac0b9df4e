//! Hashes that tell whether something kept on disk belongs to what is asked for now.

use std::fmt::Write;
use tyndall::scene::desc::SceneDesc;

/// A hash of the scene with everything that was loaded for it, and of this program's version. It goes over the text of
/// every number, which is exact; about a second for ten million of them.
pub(crate) fn of_scene(desc: &SceneDesc) -> u64 {
    // All fields by name: the compiler will ask about a new one.
    let SceneDesc { shapes, shape_groups, bsdfs, media, emitters, sensor, film, sampler, integrator } = desc;
    let mut hash = Fnv(0xcbf2_9ce4_8422_2325);
    let version = env!("CARGO_PKG_VERSION");
    // A hasher never fails to write.
    let _ = write!(hash, "{version}{shapes:?}{shape_groups:?}{bsdfs:?}{media:?}{emitters:?}");
    let _ = write!(hash, "{sensor:?}{film:?}{integrator:?}{}", sampler.seed);
    hash.0
}

/// A hash of words.
pub(crate) fn of_words<'a>(words: impl IntoIterator<Item = &'a str>) -> u64 {
    let mut hash = Fnv(0xcbf2_9ce4_8422_2325);
    for word in words {
        // The length keeps `ab c` and `a bc` apart.
        let _ = write!(hash, "{}:{word}", word.len());
    }
    hash.0
}

/// The 64-bit hash FNV-1a (Fowler, Noll and Vo 1991).
struct Fnv(u64);

impl Write for Fnv {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        for byte in text.bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tyndall::scene::desc::{GeometryDesc, IntegratorDesc, MeshDesc, ShapeDesc};

    #[test]
    fn fnv_1a() {
        let mut hash = Fnv(0xcbf2_9ce4_8422_2325);
        let _ = hash.write_str("foobar");
        assert_eq!(hash.0, 0x8594_4171_f739_67e8);
    }

    #[test]
    fn the_fingerprint_sees_everything_but_the_budget() {
        let scene = |x: f32| {
            let mesh = MeshDesc { positions: vec![[x, 0.0, 0.0]; 3], triangles: vec![[0, 1, 2]], ..Default::default() };
            let shapes = vec![ShapeDesc::new("mesh", GeometryDesc::Mesh(mesh.into()))];
            SceneDesc { shapes, ..Default::default() }
        };
        let first = of_scene(&scene(1.0));
        assert_eq!(first, of_scene(&scene(1.0)));
        assert_ne!(first, of_scene(&scene(1.000_000_1)));
        let mut desc = scene(1.0);
        desc.sampler.sample_count += 1;
        assert_eq!(first, of_scene(&desc));
        desc.sampler.seed += 1;
        assert_ne!(first, of_scene(&desc));
        desc.sampler.seed -= 1;
        desc.integrator = IntegratorDesc { name: "path".into(), parameters: Vec::new() };
        assert_ne!(first, of_scene(&desc));
    }
}
