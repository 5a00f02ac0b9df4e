//! Wavefront OBJ: polygons only.
//!
//! Read line by line here rather than by a library: known ones report no line numbers and pass over what they do not
//! understand. Groups, objects and materials are ignored: all faces make one mesh.

use crate::file::{FileError, Word, Words, read_bytes};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::Path;
use tyndall::scene::desc::MeshDesc;

/// Statements without a meaning for a triangle mesh.
const IGNORED: [&str; 17] = [
    "g",
    "o",
    "s",
    "mg",
    "usemtl",
    "mtllib",
    "usemap",
    "maplib",
    "l",
    "p",
    "lod",
    "bevel",
    "c_interp",
    "d_interp",
    "shadow_obj",
    "trace_obj",
    "vp",
];

/// Reads a file.
pub fn read(path: &Path) -> Result<MeshDesc, FileError> {
    parse(&read_bytes(path)?, &path.to_string_lossy())
}

/// Reads a text; `name` stands for the path in messages.
pub fn parse(bytes: &[u8], name: &str) -> Result<MeshDesc, FileError> {
    let mut reader = Reader {
        words: Words::new(bytes, name),
        positions: Vec::new(),
        uvs: Vec::new(),
        normals: Vec::new(),
        corners: Vec::new(),
        vertex_of: HashMap::new(),
        triangles: Vec::new(),
    };
    loop {
        reader.statement()?;
        if !reader.words.next_line() {
            break;
        }
    }
    reader.finish()
}

/// Stands for "none" among the indices of a corner.
const NONE: u32 = u32::MAX;

struct Reader<'a> {
    words: Words<'a>,
    positions: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
    /// Position, uv and normal of each vertex of the mesh.
    corners: Vec<[u32; 3]>,
    vertex_of: HashMap<[u32; 3], u32>,
    triangles: Vec<[u32; 3]>,
}

impl Reader<'_> {
    fn statement(&mut self) -> Result<(), FileError> {
        let Some(keyword) = self.words.in_line() else { return Ok(()) };
        match keyword.bytes {
            b"v" => {
                // A weight or a colour may follow.
                let p = self.numbers::<3>(keyword, 3, 7)?;
                self.positions.push(p);
            }
            b"vt" => {
                let [u, v, _] = self.numbers::<3>(keyword, 1, 3)?;
                self.uvs.push([u, v]);
            }
            b"vn" => {
                let n = self.numbers::<3>(keyword, 3, 3)?;
                self.normals.push(n);
            }
            b"f" => self.face(keyword)?,
            [b'#', ..] => {}
            other if IGNORED.iter().any(|k| k.as_bytes() == other) => {}
            _ => {
                let found = keyword.shown();
                return Err(self
                    .words
                    .error_at(keyword, format!("found {found}, expected a statement of polygons (v, vt, vn, f)")));
            }
        }
        Ok(())
    }

    /// The rest of the line: at least `least` numbers, `most` at most, of which `N` are kept.
    fn numbers<const N: usize>(&mut self, keyword: Word, least: usize, most: usize) -> Result<[f32; N], FileError> {
        let mut kept = [0.0; N];
        let mut count = 0;
        while let Some(word) = self.words.in_line() {
            if word.bytes[0] == b'#' {
                break;
            }
            let x = self.words.finite(word)?;
            if count == most {
                return Err(self.words.error_at(word, format!("found a number too many, expected at most {most}")));
            }
            if let Some(slot) = kept.get_mut(count) {
                *slot = x;
            }
            count += 1;
        }
        if count < least {
            let message = format!("found {count} numbers after {}, expected at least {least}", keyword.shown());
            return Err(self.words.error_at(keyword, message));
        }
        Ok(kept)
    }

    fn face(&mut self, keyword: Word) -> Result<(), FileError> {
        let (mut first, mut last, mut count) = (0, 0, 0);
        while let Some(word) = self.words.in_line() {
            if word.bytes[0] == b'#' {
                break;
            }
            let vertex = self.corner(word)?;
            match count {
                0 => first = vertex,
                1 => {}
                _ => self.triangles.push([first, last, vertex]),
            }
            last = vertex;
            count += 1;
        }
        if count < 3 {
            return Err(self.words.error_at(keyword, format!("found a face of {count} corners, expected at least 3")));
        }
        Ok(())
    }

    /// `p`, `p/t`, `p//n` or `p/t/n`, as a vertex of the mesh.
    fn corner(&mut self, word: Word) -> Result<u32, FileError> {
        let mut key = [NONE; 3];
        let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
        let names = ["positions", "texture coordinates", "normals"];
        for (slot, part) in word.bytes.split(|&b| b == b'/').enumerate() {
            if slot == 3 || (slot == 0 && part.is_empty()) {
                return Err(self
                    .words
                    .error_at(word, format!("found {}, expected p, p/t, p//n or p/t/n", word.shown())));
            }
            if part.is_empty() {
                continue;
            }
            let index: i64 = Word { bytes: part, ..word }.parse().ok_or_else(|| {
                self.words.error_at(word, format!("found {}, expected whole numbers between slashes", word.shown()))
            })?;
            let count = counts[slot] as i64;
            key[slot] = match index {
                1.. if index <= count => (index - 1) as u32,
                ..=-1 if index >= -count => (count + index) as u32,
                _ => {
                    let message = format!("found index {index}, expected one of the {count} {} above", names[slot]);
                    return Err(self.words.error_at(word, message));
                }
            };
        }
        match self.vertex_of.entry(key) {
            Entry::Occupied(entry) => Ok(*entry.get()),
            Entry::Vacant(entry) => {
                let vertex = u32::try_from(self.corners.len())
                    .map_err(|_| self.words.error_at(word, "found too many vertices, expected fewer than 2^32"))?;
                entry.insert(vertex);
                self.corners.push(key);
                Ok(vertex)
            }
        }
    }

    fn finish(self) -> Result<MeshDesc, FileError> {
        if self.triangles.is_empty() {
            return Err(self.words.error("found the end of the file, expected at least one face (f)"));
        }
        let any = |slot: usize| self.corners.iter().any(|c| c[slot] != NONE);
        let mut mesh = MeshDesc {
            positions: self.corners.iter().map(|c| self.positions[c[0] as usize]).collect(),
            triangles: self.triangles,
            ..MeshDesc::default()
        };
        // Where only some corners have them: uv zero, and normals made from the triangles.
        if any(1) {
            mesh.uvs = self.corners.iter().map(|c| self.uvs.get(c[1] as usize).copied().unwrap_or_default()).collect();
        }
        if any(2) {
            mesh.normals =
                self.corners.iter().map(|c| self.normals.get(c[2] as usize).copied().unwrap_or_default()).collect();
        }
        super::complete_normals(&mut mesh);
        Ok(mesh)
    }
}
