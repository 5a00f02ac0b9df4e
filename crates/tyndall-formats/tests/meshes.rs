//! Mesh readers against files made here.

use tyndall::scene::desc::MeshDesc;
use tyndall_formats::mesh::{obj, ply};

/// A square of two triangles in the plane z = 0, and a triangle standing on it.
const POSITIONS: [[f32; 3]; 5] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.5, 2.0]];

fn close(a: [f32; 3], b: [f32; 3]) -> bool {
    a.iter().zip(b).all(|(x, y)| (x - y).abs() < 1e-6)
}

#[test]
fn obj_polygons_become_fans_of_unified_vertices() {
    let text = "# a comment\r\nmtllib x.mtl\no thing\nv 0 0 0\nv 1 0 0 0.5 0.5 0.5\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0.25\n\
                vn 0 0 2\ng part\nusemtl red\ns off\nf 1/1/1 2/2/1 -2/2/-1 \\\n -1/1/1 # quad\nf 1/2/1 2/2/1 3/2/1\n";
    let mesh = obj::parse(text.as_bytes(), "a.obj").unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [4, 1, 2]]);
    assert_eq!(mesh.positions, [POSITIONS[0], POSITIONS[1], POSITIONS[2], POSITIONS[3], POSITIONS[0]]);
    assert_eq!(mesh.uvs, [[0.0, 0.0], [1.0, 0.25], [1.0, 0.25], [0.0, 0.0], [1.0, 0.25]]);
    assert_eq!(mesh.normals, [[0.0, 0.0, 1.0]; 5]);
}

#[test]
fn obj_corners_may_leave_out_what_others_have() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 -1\nvn 0 0 0\nvt 0.5 0.5\nf 1//1 2/1 3//2\n";
    let mesh = obj::parse(text.as_bytes(), "a.obj").unwrap();
    assert_eq!(mesh.uvs, [[0.0, 0.0], [0.5, 0.5], [0.0, 0.0]]);
    assert_eq!(mesh.normals, [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]]);
}

/// Values found with Mitsuba 3 for the same three positions about the origin.
#[test]
fn missing_normals_are_weighted_by_angle() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 2 3\nf 1 3 4\n";
    let mesh = obj::parse(text.as_bytes(), "a.obj").unwrap();
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let expected = [[half, 0.0, half], [0.0, 0.0, 1.0], [0.9044, 0.0, 0.4267], [1.0, 0.0, 0.0]];
    for (normal, expected) in mesh.normals.iter().zip(expected) {
        assert!(normal.iter().zip(expected).all(|(a, b)| (a - b).abs() < 5e-5), "{normal:?} {expected:?}");
    }
}

/// Writes numbers in a PLY file's format.
struct Writer {
    format: &'static str,
    out: Vec<u8>,
}

impl Writer {
    fn number(&mut self, kind: &str, x: f64) {
        if self.format == "ascii" {
            self.out.extend_from_slice(format!("{x}\n").as_bytes());
            return;
        }
        let mut bytes = match kind {
            "char" | "int8" => (x as i8).to_le_bytes().to_vec(),
            "uchar" | "uint8" => (x as u8).to_le_bytes().to_vec(),
            "short" | "int16" => (x as i16).to_le_bytes().to_vec(),
            "ushort" | "uint16" => (x as u16).to_le_bytes().to_vec(),
            "int" | "int32" => (x as i32).to_le_bytes().to_vec(),
            "uint" | "uint32" => (x as u32).to_le_bytes().to_vec(),
            "float" | "float32" => (x as f32).to_le_bytes().to_vec(),
            _ => x.to_le_bytes().to_vec(),
        };
        if self.format == "binary_big_endian" {
            bytes.reverse();
        }
        self.out.extend_from_slice(&bytes);
    }
}

/// The test mesh: positions of one type, the faces' lists of two others; unknown elements and properties between.
fn ply_file(format: &'static str, float: &str, length: &str, index: &str) -> Vec<u8> {
    let header = format!(
        "ply\ncomment made here\nformat {format} 1.0\nobj_info none\nelement camera 2\nproperty {float} zoom\n\
         property list {length} {float} lens\nelement vertex 5\nproperty {float} x\nproperty {float} y\nproperty {float} z\n\
         property uchar skipped\nproperty {float} nx\nproperty {float} ny\nproperty {float} nz\nproperty {float} s\n\
         property {float} t\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n\
         property {float} heat_x\nproperty list {length} {index} neighbours\nelement face 2\n\
         property list {length} {index} vertex_indices\nproperty {float} r\nproperty {float} g\nproperty {float} b\nend_header\n"
    );
    let mut writer = Writer { format, out: header.into_bytes() };
    for camera in 0..2 {
        writer.number(float, 1.5);
        writer.number(length, f64::from(camera));
        for _ in 0..camera {
            writer.number(float, 2.5);
        }
    }
    for (i, p) in POSITIONS.iter().enumerate() {
        let i = i as f64;
        p.iter().for_each(|&x| writer.number(float, f64::from(x)));
        writer.number("uchar", 7.0);
        [0.0, 3.0, 4.0].iter().for_each(|&x| writer.number(float, x));
        [0.25 * i, 1.0].iter().for_each(|&x| writer.number(float, x));
        [i, 128.0, 255.0, 9.0].iter().for_each(|&x| writer.number("uchar", x));
        writer.number(float, -i);
        writer.number(length, 1.0);
        writer.number(index, 0.0);
    }
    for (face, colour) in [(&[0, 1, 2, 3][..], [0.5, 0.25, 1.0]), (&[1, 0, 4], [0.0, 1.0, 2.0])] {
        writer.number(length, face.len() as f64);
        face.iter().for_each(|&i| writer.number(index, f64::from(i)));
        colour.iter().for_each(|&x| writer.number(float, x));
    }
    writer.out
}

fn attribute<'a>(mesh: &'a MeshDesc, name: &str) -> (usize, &'a [f32]) {
    let attribute = mesh.attributes.iter().find(|a| a.name == name).unwrap_or_else(|| panic!("{name} is missing"));
    (attribute.channels, &attribute.values)
}

#[test]
fn ply_of_every_format_and_type_is_the_same_mesh() {
    let mut tried = 0;
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        for float in ["float", "double", "float32", "float64"] {
            for length in ["char", "uchar", "short", "uint16", "int", "uint32"] {
                for index in ["int8", "uchar", "int16", "ushort", "int32", "uint"] {
                    let mesh = ply::parse(&ply_file(format, float, length, index), "a.ply").unwrap();
                    assert_eq!(mesh.positions, POSITIONS);
                    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [1, 0, 4]]);
                    assert!(mesh.normals.iter().all(|&n| close(n, [0.0, 0.6, 0.8])));
                    assert_eq!(mesh.uvs[3], [0.75, 1.0]);
                    assert_eq!(attribute(&mesh, "vertex_color").0, 3);
                    assert_eq!(attribute(&mesh, "vertex_color").1[3..6], [1.0, 128.0, 255.0]);
                    assert_eq!(attribute(&mesh, "vertex_heat"), (1, &[0.0, -1.0, -2.0, -3.0, -4.0][..]));
                    let colours = [0.5, 0.25, 1.0, 0.5, 0.25, 1.0, 0.0, 1.0, 2.0];
                    assert_eq!(attribute(&mesh, "face_color"), (3, &colours[..]));
                    assert_eq!(mesh.attributes.len(), 3);
                    tried += 1;
                }
            }
        }
    }
    assert_eq!(tried, 3 * 4 * 6 * 6);
}

/// Names found with Mitsuba 3.
#[test]
fn ply_attributes_are_named_as_in_mitsuba() {
    let names = |properties: &str| -> Vec<(String, usize)> {
        let lines: String = properties.split(' ').map(|p| format!("property float {p}\n")).collect();
        let row = "0 ".repeat(3 + properties.split(' ').count());
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n{lines}\
             element face 1\nproperty list uchar int vertex_index\nend_header\n{row}\n{row}\n{row}\n3 0 1 2"
        );
        let mesh = ply::parse(text.as_bytes(), "a.ply").unwrap();
        mesh.attributes.into_iter().map(|a| (a.name, a.channels)).collect()
    };
    let one = |name: &str, channels| vec![(name.to_owned(), channels)];
    assert_eq!(names("r g b"), one("vertex_color", 3));
    assert_eq!(names("red green blue alpha"), one("vertex_color", 3));
    assert_eq!(names("foo_r foo_g foo_b"), one("vertex_foo_color", 3));
    assert_eq!(names("foo_x foo_y foo_z"), one("vertex_foo", 3));
    assert_eq!(names("foo_0 foo_1 foo_2"), one("vertex_foo", 3));
    assert_eq!(names("foo_1 foo_2 foo_3"), one("vertex_foo", 3));
    assert_eq!(names("my_foo_x"), one("vertex_my_foo", 1));
    assert_eq!(names("vertex_foo_x"), one("vertex_vertex_foo", 1));
    assert_eq!(names("foo_x foo_y"), []);
    assert_eq!(names("quality confidence vertex_foo"), []);
    assert_eq!(names("foo_x bar_x").len(), 2);
}

#[test]
fn ply_text_tells_the_place() {
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                element face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n1 oops 0\n0 1 0\n3 0 1 2\n";
    let error = ply::parse(text.as_bytes(), "a.ply").unwrap_err().to_string();
    assert_eq!(error, "a.ply:11:3: found 'oops', expected a number");
}
