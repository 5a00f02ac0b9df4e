//! Broken files and the exact words about them.

use tyndall_formats::{FileError, grid, image, mesh};

/// A PLY text of one triangle.
const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                   element face 1\nproperty list char int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

fn obj(text: &str) -> Option<FileError> {
    mesh::obj::parse(text.as_bytes(), "a").err()
}

/// The text above with one piece replaced.
fn ply(piece: &str, replacement: &str) -> Option<FileError> {
    assert_eq!(PLY.matches(piece).count(), 1, "{piece}");
    mesh::ply::parse(PLY.replace(piece, replacement).as_bytes(), "a").err()
}

/// The same header in binary, with these bytes after it.
fn ply_binary(bytes: &[u8]) -> Option<FileError> {
    let header = &PLY[..PLY.find("0 0 0\n").unwrap()];
    let header = header.replace("ascii", "binary_little_endian");
    assert_eq!(header.len(), 166);
    mesh::ply::parse(&[header.as_bytes(), bytes].concat(), "a").err()
}

fn vol(change: impl Fn(&mut Vec<u8>)) -> Option<FileError> {
    let mut bytes = b"VOL\x03".to_vec();
    bytes.extend([1i32, 2, 1, 1, 1].iter().flat_map(|n| n.to_le_bytes()));
    bytes.extend([0.0f32, 0.0, 0.0, 1.0, 1.0, 1.0, 0.5, 0.25].iter().flat_map(|x| x.to_le_bytes()));
    assert!(grid::vol::parse(&bytes, "a").is_ok());
    change(&mut bytes);
    grid::vol::parse(&bytes, "a").err()
}

fn picture(bytes: &[u8]) -> Option<FileError> {
    image::parse(bytes, "a", false).err()
}

#[test]
fn broken_files_say_what_and_where() {
    let corners = |index: u8, nan: bool| {
        let mut bytes = vec![0; 36];
        if nan {
            bytes[16..20].copy_from_slice(&f32::NEG_INFINITY.to_le_bytes());
        }
        bytes.extend([3, 0, 0, 0, 0, 1, 0, 0, 0, index, 0, 0, index / 128 * 255]);
        bytes
    };
    let cases = [
        (obj(""), "a:1:1: found the end of the file, expected at least one face (f)"),
        (obj("v 0 0\n"), "a:1:1: found 2 numbers after 'v', expected at least 3"),
        (obj("v 0 0 nan\n"), "a:1:7: found 'nan', expected a finite number"),
        (obj("\nv 0 1e39 0\n"), "a:2:5: found '1e39', expected a finite number"),
        (obj("v 0 0 0 1 1 1 1 1\n"), "a:1:17: found a number too many, expected at most 7"),
        (obj("vertex 0 0 0\n"), "a:1:1: found 'vertex', expected a statement of polygons (v, vt, vn, f)"),
        (obj("curv2 1 2\n"), "a:1:1: found 'curv2', expected a statement of polygons (v, vt, vn, f)"),
        (obj("v 0 0 0\n  f 1 1\n"), "a:2:3: found a face of 2 corners, expected at least 3"),
        (obj("v 0 0 0\nf 1 0 1\n"), "a:2:5: found index 0, expected one of the 1 positions above"),
        (obj("v 0 0 0\nf 1 1 -2\n"), "a:2:7: found index -2, expected one of the 1 positions above"),
        (obj("v 0 0 0\nf 1/1 1 1\n"), "a:2:3: found index 1, expected one of the 0 texture coordinates above"),
        (obj("v 0 0 0\nf 1//7 1 1\n"), "a:2:3: found index 7, expected one of the 0 normals above"),
        (obj("v 0 0 0\nf 1/x/1 1 1\n"), "a:2:3: found '1/x/1', expected whole numbers between slashes"),
        (obj("v 0 0 0\nf 1////1 1 1\n"), "a:2:3: found '1////1', expected p, p/t, p//n or p/t/n"),
        (obj("v 0 0 0\nf /1 1 1\n"), "a:2:3: found '/1', expected p, p/t, p//n or p/t/n"),
        (obj("\u{7f}\0\n"), "a:1:1: found '\\u{7f}\\0', expected a statement of polygons (v, vt, vn, f)"),
        (ply("ply\n", "PLY\n"), "a:1:1: found 'PLY', expected the word ply"),
        (ply("ascii", "binary"), "a:2:8: found 'binary', expected ascii, binary_little_endian or binary_big_endian"),
        (ply("1.0", "2.0"), "a:2:14: found '2.0', expected version 1.0"),
        (ply("format ascii 1.0\n", ""), "a:8:1: found 'end_header', expected a line format before it"),
        (ply("vertex 3", "vertex -3"), "a:3:16: found '-3', expected a number of elements"),
        (ply("vertex 3", "vertex"), "a:3:15: found the end of the line, expected a number of elements"),
        (ply("element vertex 3\n", ""), "a:3:1: found 'property', expected an element before its properties"),
        (
            ply("float y", "quad y"),
            "a:5:10: found 'quad', expected a type (char, uchar, short, ushort, int, uint, float, double)",
        ),
        (ply("float y", "float x"), "a:5:1: found the property x twice"),
        (ply("float y", "float w"), "a:3:1: found a vertex without the properties x, y and z"),
        (ply("list char", "list float"), "a:8:15: found 'float', expected a type of whole numbers for a list's length"),
        (
            ply("int vertex_index", "float vertex_index"),
            "a:7:1: found a face without a list of whole numbers vertex_indices (or vertex_index)",
        ),
        (ply("end_header", "end"), "a:9:1: found 'end', expected format, comment, element, property or end_header"),
        (
            ply("vertex 3", "vertex 1000000000000"),
            "a:10:1: found 27 bytes, expected at least 6 for each of the 1000000000000 elements vertex",
        ),
        (
            ply("face 1", "face 18446744073709551615"),
            "a:12:6: found 10 bytes, expected at least 2 for each of the 18446744073709551615 elements face",
        ),
        (ply("0 1 0\n", "0 inf 0\n"), "a:12:3: found inf, expected a finite number"),
        (ply("3 0 1 2", "3 0 1.5 2"), "a:13:5: found '1.5', expected a whole number"),
        (ply("3 0 1 2", "3 0 1 3"), "a: found vertex index 3, expected one of the 3 vertices"),
        (ply("3 0 1 2", "3 0 -1 2"), "a:13:5: found vertex index -1, expected one from 0 on"),
        (ply("3 0 1 2", "-3 0 1 2"), "a:13:1: found a list of -3 items, expected none or more"),
        (ply("3 0 1 2", "2 0 1"), "a:13:1: found a face of 2 corners, expected at least 3"),
        (ply("3 0 1 2\n", "9 0 1 2"), "a:13:8: found the end of the file, expected a number"),
        (ply("element face 1", "element face 0"), "a: found no faces, expected at least one"),
        (ply_binary(&[0; 35]), "a: byte 166: found 35 bytes, expected at least 12 for each of the 3 elements vertex"),
        (ply_binary(&corners(2, false)[..47]), "a: byte 211: found 2 bytes before the end, expected 4 for a number"),
        (ply_binary(&corners(2, true)), "a: byte 182: found -inf, expected a finite number"),
        (ply_binary(&corners(7, false)), "a: found vertex index 7, expected one of the 3 vertices"),
        (ply_binary(&corners(128, false)), "a: byte 211: found vertex index -16777088, expected one from 0 on"),
        (vol(|b| b.truncate(2)), "a: byte 0: found 2 bytes before the end, expected 3 for the letters VOL"),
        (vol(|b| b[0] = b'\n'), "a: byte 0: found \"\\nOL\", expected the letters VOL"),
        (vol(|b| b[3] = 2), "a: byte 3: found version 2, expected 3"),
        (vol(|b| b[4] = 2), "a: byte 4: found samples of type 2 (16-bit floats), expected 1 (32-bit floats)"),
        (vol(|b| b[4] = 9), "a: byte 4: found samples of type 9, expected 1 (32-bit floats)"),
        (vol(|b| b[12] = 0), "a: byte 12: found 0 samples along y, expected at least 1"),
        (vol(|b| b[11] = 0xff), "a: byte 8: found -16777214 samples along x, expected at least 1"),
        (vol(|b| b[20] = 2), "a: byte 20: found 2 channels, expected 1, 3 or 6"),
        (vol(|b| b[26..28].fill(0xff)), "a: byte 24: found NaN in the bounding box, expected a finite number"),
        (vol(|b| b[54..56].fill(0xff)), "a: byte 52: found NaN, expected a finite number"),
        (vol(|b| b.truncate(40)), "a: byte 40: found 0 bytes before the end, expected 4 for the bounding box"),
        (
            vol(|b| b.truncate(55)),
            "a: byte 48: found 7 bytes of samples, expected 8 for 2 x 1 x 1 samples of 1 channels",
        ),
        (picture(b""), "a: byte 0: found \"\", expected the start of a PNG, JPEG, EXR, HDR or PFM picture"),
        (picture(b"BM123"), "a: byte 0: found \"BM12\", expected the start of a PNG, JPEG, EXR, HDR or PFM picture"),
        (picture(b"PF\n2 x\n"), "a:2:3: found 'x', expected a height"),
        (picture(b"PF\n2 2\n0\n"), "a:3:1: found '0', expected a scale other than 0"),
        (picture(b"Pf\n1 1\n-1\n123"), "a: byte 10: found 3 bytes of samples, expected 4 for 1 x 1 pixels"),
        (
            picture(b"PF\n4294967295 4294967295\n-1\n"),
            "a: byte 28: found 0 bytes of samples, expected 221360928781435404300 for 4294967295 x 4294967295 pixels",
        ),
        (
            picture(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 999999 +X 999999\n"),
            "a: found a picture of 999999 x 999999 pixels, expected what 55 bytes can hold",
        ),
    ];
    let mut wrong = 0;
    for (number, (error, expected)) in cases.iter().enumerate() {
        let found = error.as_ref().map_or("no error".to_owned(), FileError::to_string);
        if found != *expected {
            eprintln!("case {number}\n  found    {found}\n  expected {expected}");
            wrong += 1;
        }
    }
    assert_eq!(wrong, 0);
}

#[test]
fn files_that_cannot_be_opened() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("no.ply");
    let message = |e: FileError| e.to_string();
    assert_eq!(
        mesh::ply::read(&missing).map_err(message).unwrap_err(),
        format!("{}: cannot be read: No such file or directory (os error 2)", missing.display())
    );
    assert_eq!(
        grid::vol::read(folder.path()).map_err(message).unwrap_err(),
        format!("{}: is not a regular file", folder.path().display())
    );
    assert_eq!(
        image::read(std::path::Path::new("/dev/zero"), false).map_err(message).unwrap_err(),
        "/dev/zero: is not a regular file"
    );
}
