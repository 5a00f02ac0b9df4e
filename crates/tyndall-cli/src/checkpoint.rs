//! The file that a rendering continues from.
//!
//! It lies beside the picture as `PICTURE.checkpoint` and is replaced as a whole, so that it is complete at any moment.
//! It carries a fingerprint of everything that the picture depends on except the budget: a rendering can be continued
//! with more samples.

use crate::console::Console;
use crate::failure::Failure;
use std::fmt::Write;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use tyndall::render::Rendering;
use tyndall::scene::desc::SceneDesc;
use tyndall_formats::file::write_atomically;

/// Without `--checkpoint`.
const DEFAULT_INTERVAL: Duration = Duration::from_secs(60);

/// The checkpoints of one rendering.
pub(crate) struct Checkpoints {
    path: PathBuf,
    fingerprint: u64,
    interval: Duration,
    last: Instant,
}

impl Checkpoints {
    /// For the picture `output` of `desc`, which has to name the integrator and the seed in use.
    pub(crate) fn new(output: &Path, desc: &SceneDesc, interval: Option<Duration>) -> Self {
        let mut path = output.as_os_str().to_owned();
        path.push(".checkpoint");
        Self {
            path: path.into(),
            fingerprint: fingerprint(desc),
            interval: interval.unwrap_or(DEFAULT_INTERVAL),
            last: Instant::now(),
        }
    }

    /// Continues from the checkpoint if there is one.
    pub(crate) fn resume(&self, rendering: &mut Rendering, console: Console) -> Result<(), Failure> {
        let path = self.path.display();
        let bytes = match std::fs::read(&self.path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == ErrorKind::NotFound => {
                console.say(format_args!("there is no {path} to continue from: starting anew"));
                return Ok(());
            }
            Err(error) => return Err(Failure::other(format_args!("{path}: cannot be read: {error}"))),
        };
        rendering.resume(&bytes, self.fingerprint).map_err(|error| {
            Failure::other(format_args!("{path}: {error}; remove it or leave out --resume to start anew"))
        })?;
        console.say(format_args!("continuing from {path} at {} samples per pixel", rendering.passes()));
        Ok(())
    }

    /// Writes a checkpoint if it is time for one.
    pub(crate) fn tick(&mut self, rendering: &Rendering) -> Result<(), Failure> {
        if self.last.elapsed() < self.interval { Ok(()) } else { self.write(rendering) }
    }

    /// Writes a checkpoint.
    pub(crate) fn write(&mut self, rendering: &Rendering) -> Result<(), Failure> {
        write_atomically(&self.path, &rendering.checkpoint(self.fingerprint)).map_err(Failure::other)?;
        self.last = Instant::now();
        Ok(())
    }

    /// Removes the checkpoint of a finished picture.
    pub(crate) fn remove(&self) -> Result<(), Failure> {
        match std::fs::remove_file(&self.path) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                Err(Failure::other(format_args!("{}: cannot be removed: {error}", self.path.display())))
            }
            _ => Ok(()),
        }
    }
}

/// A hash of the scene with everything that was loaded for it, and of this program's version. It goes over the text of
/// every number, which is exact; about a second for ten million of them.
fn fingerprint(desc: &SceneDesc) -> u64 {
    // All fields by name: the compiler will ask about a new one.
    let SceneDesc { shapes, shape_groups, bsdfs, media, emitters, sensor, film, sampler, integrator } = desc;
    let mut hash = Fnv(0xcbf2_9ce4_8422_2325);
    let version = env!("CARGO_PKG_VERSION");
    // A hasher never fails to write.
    let _ = write!(hash, "{version}{shapes:?}{shape_groups:?}{bsdfs:?}{media:?}{emitters:?}");
    let _ = write!(hash, "{sensor:?}{film:?}{integrator:?}{}", sampler.seed);
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
        let first = fingerprint(&scene(1.0));
        assert_eq!(first, fingerprint(&scene(1.0)));
        assert_ne!(first, fingerprint(&scene(1.000_000_1)));
        let mut desc = scene(1.0);
        desc.sampler.sample_count += 1;
        assert_eq!(first, fingerprint(&desc));
        desc.sampler.seed += 1;
        assert_ne!(first, fingerprint(&desc));
        desc.sampler.seed -= 1;
        desc.integrator = IntegratorDesc { name: "path".into(), parameters: Vec::new() };
        assert_ne!(first, fingerprint(&desc));
    }
}
