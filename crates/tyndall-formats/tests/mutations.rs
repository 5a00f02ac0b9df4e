//! Thousands of broken files: every reader must answer with an error or a value, never panic, never take much memory.

mod seeds;

use tyndall::math::Rng;
use tyndall_formats::{grid, image, mesh, mitsuba};

/// Feeds the reader of a format; true when it liked the bytes.
fn parse(format: &str, bytes: &[u8]) -> bool {
    match format {
        "obj" => mesh::obj::parse(bytes, "a").is_ok(),
        "ply" => mesh::ply::parse(bytes, "a").is_ok(),
        "serialized" => (0..2).all(|index| mesh::serialized::parse(bytes, "a", index).is_ok()),
        "xml" => {
            let text = String::from_utf8_lossy(bytes);
            mitsuba::read_str(&text, "no such folder".as_ref(), &mitsuba::Options::default()).is_ok()
        }
        "vol" => grid::vol::parse(bytes, "a").is_ok(),
        _ => image::parse(bytes, "a", false).is_ok() && image::parse_picture(bytes, "a").is_ok(),
    }
}

#[test]
fn seeds_are_liked() {
    for (i, (format, bytes)) in seeds::all().iter().enumerate() {
        assert!(parse(format, bytes), "{format} {i}");
    }
}

#[test]
fn every_beginning_of_a_seed_is_survived() {
    for (format, bytes) in seeds::all() {
        for end in (0..bytes.len()).step_by(1 + bytes.len() / 100) {
            parse(format, &bytes[..end]);
        }
    }
}

#[test]
fn mutations_are_survived() {
    let (mut liked, mut refused) = (0, 0);
    for (number, (format, seed)) in seeds::all().iter().enumerate() {
        for round in 0..200 {
            let mut rng = Rng::keyed(1, number as u64, round);
            let mut bytes = seed.clone();
            for _ in 0..1 + rng.bits() % 4 {
                mutate(&mut bytes, &mut rng);
            }
            *if parse(format, &bytes) { &mut liked } else { &mut refused } += 1;
        }
    }
    // Both must happen often, or nothing was tried.
    assert!(liked > 300 && refused > 2000, "{liked} {refused}");
}

fn mutate(bytes: &mut Vec<u8>, rng: &mut Rng) {
    if bytes.is_empty() {
        return;
    }
    let at = rng.bits() as usize % bytes.len();
    let end = (at + 1 + rng.bits() as usize % 8).min(bytes.len());
    match rng.bits() % 6 {
        0 => bytes[at] ^= 1 << (rng.bits() % 8),
        1 => bytes[at] = rng.bits() as u8,
        2 => bytes[at..end].fill([0, 0x7f, 0x80, 0xff][rng.bits() as usize % 4]),
        3 => drop(bytes.drain(at..end)),
        4 => {
            let copy = bytes[at..end].to_vec();
            bytes.splice(at..at, copy);
        }
        _ => bytes[at] = b"0123456789-/.e \n"[rng.bits() as usize % 16],
    }
}
