//! `.serialized` meshes made here.

use flate2::{Compression, write::ZlibEncoder};
use std::io::Write;
use tyndall_formats::mesh::serialized;

const POSITIONS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]];
const TRIANGLES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

/// One mesh, `columns` of numbers in the order of the format.
fn mesh(version: u16, flags: u32, counts: [u64; 2], columns: &[&[f32]], triangles: &[[u32; 3]]) -> Vec<u8> {
    let mut raw = flags.to_le_bytes().to_vec();
    if version == 4 {
        raw.extend_from_slice(b"a name\0");
    }
    raw.extend(counts.iter().flat_map(|n| n.to_le_bytes()));
    for &x in columns.iter().flat_map(|column| column.iter()) {
        if flags & 0x2000 != 0 {
            raw.extend_from_slice(&f64::from(x).to_le_bytes());
        } else {
            raw.extend_from_slice(&x.to_le_bytes());
        }
    }
    raw.extend(triangles.iter().flatten().flat_map(|i| i.to_le_bytes()));
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(&raw).unwrap();
    [&0x041c_u16.to_le_bytes()[..], &version.to_le_bytes(), &encoder.finish().unwrap()].concat()
}

/// Meshes and the table of their offsets.
fn file(version: u16, meshes: &[Vec<u8>]) -> Vec<u8> {
    let (mut bytes, mut table) = (Vec::new(), Vec::new());
    for mesh in meshes {
        match version {
            4 => table.extend_from_slice(&(bytes.len() as u64).to_le_bytes()),
            _ => table.extend_from_slice(&(bytes.len() as u32).to_le_bytes()),
        }
        bytes.extend_from_slice(mesh);
    }
    bytes.extend_from_slice(&table);
    bytes.extend_from_slice(&(meshes.len() as u32).to_le_bytes());
    bytes
}

/// The same files read by Mitsuba 3 gave the same vertices, normals, texture coordinates and triangles.
#[test]
fn every_version_precision_and_column() {
    let positions = POSITIONS.as_flattened();
    let (normals, uvs, colours) = ([0.0, 0.0, 2.0].repeat(4), [0.25, 0.75].repeat(4), [0.5, 0.25, 1.5].repeat(4));
    for version in [3, 4] {
        for precision in [0x1000, 0x2000] {
            let file = file(
                version,
                &[
                    mesh(version, precision, [4, 2], &[positions], &TRIANGLES),
                    mesh(version, precision | 0x0b, [4, 2], &[positions, &normals, &uvs, &colours], &TRIANGLES),
                    mesh(version, precision | 0x02, [4, 2], &[positions, &uvs], &TRIANGLES),
                ],
            );
            let bare = serialized::parse(&file, "a.serialized", 0).unwrap();
            assert_eq!((bare.positions.as_slice(), bare.triangles.as_slice()), (&POSITIONS[..], &TRIANGLES[..]));
            assert!((bare.normals[2][0] - 0.9044).abs() < 5e-5, "smooth normals");
            assert!(bare.uvs.is_empty() && bare.attributes.is_empty());
            let full = serialized::parse(&file, "a.serialized", 1).unwrap();
            assert_eq!(full.normals, [[0.0, 0.0, 1.0]; 4]);
            assert_eq!(full.uvs, [[0.25, 0.75]; 4]);
            assert_eq!((full.attributes[0].name.as_str(), full.attributes[0].channels), ("vertex_color", 3));
            assert_eq!(full.attributes[0].values, colours);
            let textured = serialized::parse(&file, "a.serialized", 2).unwrap();
            assert_eq!((textured.positions.as_slice(), textured.uvs.len()), (&POSITIONS[..], 4));
            let error = serialized::parse(&file, "a.serialized", 3).unwrap_err().to_string();
            let at = file.len() - 4;
            assert_eq!(error, format!("a.serialized: byte {at}: found 3 meshes, expected more than the shape_index 3"));
        }
    }
}

#[test]
fn broken_meshes_say_what_is_wrong() {
    let positions = POSITIONS.as_flattened();
    let message = |bytes: &[u8], index| serialized::parse(bytes, "a", index).unwrap_err().to_string();
    let whole = mesh(4, 0x1000, [4, 2], &[positions], &TRIANGLES);

    assert_eq!(message(b"", 0), "a: byte 0: found 0 bytes before the end, expected 2 for the start of a mesh");
    assert_eq!(message(b"PLYx", 0), "a: byte 0: found 0x4c50, expected 0x041c, the start of a mesh");
    assert_eq!(message(&[0x1c, 0x04, 2, 0], 0), "a: byte 2: found version 2, expected 3 or 4");
    assert_eq!(message(&whole[..4], 0), "a: byte 4: found the end of the deflated mesh, expected the flags");
    let cut = message(&whole[..whole.len() - 12], 0);
    assert!(cut.contains("found the end of the deflated mesh, expected positions"), "{cut}");
    let mut garbled = whole.clone();
    garbled[4..8].fill(0xff);
    assert!(message(&garbled, 0).contains(": cannot be inflated: "), "{}", message(&garbled, 0));

    let claim = mesh(4, 0x1000, [1 << 40, 1], &[positions], &TRIANGLES);
    assert!(message(&claim, 0).contains("found 1099511627776 vertices and 1 triangles, expected what"));
    let overflow = mesh(4, 0x1000, [u64::MAX, u64::MAX], &[], &[]);
    assert!(message(&overflow, 0).contains("found 18446744073709551615 vertices"));
    let empty = mesh(4, 0x1000, [4, 0], &[positions], &[]);
    assert!(message(&empty, 0).ends_with("and at least one triangle"));
    let index = mesh(4, 0x1000, [4, 2], &[positions], &[[0, 1, 2], [0, 2, 4]]);
    assert!(message(&index, 0).ends_with("found vertex index 4, expected one of the 4 vertices"));
    let nan = mesh(4, 0x1000, [4, 2], &[&[f32::NAN; 12]], &TRIANGLES);
    assert!(message(&nan, 0).ends_with("found NaN among the positions, expected a finite number"));

    let mut table = file(4, &[whole.clone(), whole.clone()]);
    let at = table.len() - 12;
    table[at..at + 8].copy_from_slice(&u64::MAX.to_le_bytes());
    let end = at - 8;
    assert_eq!(
        message(&table, 1),
        format!("a: byte {at}: found the offset 18446744073709551615, expected one before {end}")
    );
    let mut count = file(4, &[whole.clone(), whole]);
    let at = count.len() - 4;
    count[at..].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_eq!(
        message(&count, 1),
        format!("a: byte {at}: found a table of 4294967295 meshes, expected one no longer than the file")
    );
}
