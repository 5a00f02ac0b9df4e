//! Mitsuba's `.serialized`, versions 3 and 4: deflated meshes one after the other, and a table of their offsets at the end.

use crate::file::{Bytes, FileError, read_bytes};
use flate2::bufread::ZlibDecoder;
use std::io::{BufReader, Read};
use std::path::Path;
use tyndall::scene::desc::{MeshAttribute, MeshDesc};

const MAGIC: u16 = 0x041c;
const HAS_NORMALS: u32 = 0x0001;
const HAS_UVS: u32 = 0x0002;
const HAS_COLOURS: u32 = 0x0008;
const DOUBLE: u32 = 0x2000;
/// Deflate makes no more bytes of one than this.
const DEFLATE_RATIO: u128 = 1032;

/// Reads one mesh of a file, counting from 0. As in Mitsuba 3, the file's own wish for flat shading is not heeded.
pub fn read(path: &Path, shape_index: usize) -> Result<MeshDesc, FileError> {
    parse(&read_bytes(path)?, &path.to_string_lossy(), shape_index)
}

/// Reads a binary; `name` stands for the path in messages.
pub fn parse(bytes: &[u8], name: &str, shape_index: usize) -> Result<MeshDesc, FileError> {
    let mut file = Bytes::new(bytes, name);
    let version = parse_version(&mut file)?;
    // The first mesh is found without the table, which other programs leave out.
    let mut end = bytes.len();
    if shape_index > 0 {
        (file.at, end) = find(&file, version, shape_index)?;
        parse_version(&mut file)?;
    }
    let stream = Stream {
        reader: BufReader::new(ZlibDecoder::new(&bytes[file.at..end])),
        start: file.at,
        length: end - file.at,
        name,
    };
    stream.mesh(version)
}

/// Magic number and version.
fn parse_version(file: &mut Bytes) -> Result<u16, FileError> {
    let at = file.at;
    let magic = u16::from_le_bytes(file.array("the start of a mesh")?);
    if magic != MAGIC {
        return Err(FileError::byte(
            file.name,
            at,
            format!("found {magic:#06x}, expected {MAGIC:#06x}, the start of a mesh"),
        ));
    }
    let version = u16::from_le_bytes(file.array("the version")?);
    if version != 3 && version != 4 {
        return Err(FileError::byte(file.name, at + 2, format!("found version {version}, expected 3 or 4")));
    }
    Ok(version)
}

/// Where a mesh begins and where the table of offsets does.
fn find(file: &Bytes, version: u16, shape_index: usize) -> Result<(usize, usize), FileError> {
    let length = file.bytes.len();
    let last = length.saturating_sub(4);
    let mut tail = Bytes { at: last, ..file.clone() };
    let count = u32::from_le_bytes(tail.array("the number of meshes")?) as usize;
    if shape_index >= count {
        let message = format!("found {count} meshes, expected more than the shape_index {shape_index}");
        return Err(FileError::byte(file.name, last, message));
    }
    let width = if version == 4 { 8 } else { 4 };
    let Some(table) = count.checked_mul(width).and_then(|size| last.checked_sub(size)) else {
        let message = format!("found a table of {count} meshes, expected one no longer than the file");
        return Err(FileError::byte(file.name, last, message));
    };
    tail.at = table + width * shape_index;
    let at = tail.at;
    let offset = match version {
        4 => u64::from_le_bytes(tail.array("an offset")?),
        _ => u64::from(u32::from_le_bytes(tail.array("an offset")?)),
    };
    match usize::try_from(offset) {
        Ok(start) if start.checked_add(4).is_some_and(|end| end <= table) => Ok((start, table)),
        _ => Err(FileError::byte(file.name, at, format!("found the offset {offset}, expected one before {table}"))),
    }
}

/// The inflated bytes of one mesh.
struct Stream<'a> {
    reader: BufReader<ZlibDecoder<&'a [u8]>>,
    /// Where the deflated bytes begin in the file and how many there are.
    start: usize,
    length: usize,
    name: &'a str,
}

impl Stream<'_> {
    fn mesh(mut self, version: u16) -> Result<MeshDesc, FileError> {
        let flags = u32::from_le_bytes(self.array("the flags")?);
        if version == 4 {
            while self.array::<1>("the name")? != [0] {}
        }
        let vertices = u64::from_le_bytes(self.array("the number of vertices")?);
        let triangles = u64::from_le_bytes(self.array("the number of triangles")?);
        self.check_backed(flags, vertices, triangles)?;
        let double = flags & DOUBLE != 0;
        let (vertices, triangles) = (vertices as usize, triangles as usize);

        let mut mesh = MeshDesc { positions: self.vectors(vertices, double, "positions")?, ..MeshDesc::default() };
        if flags & HAS_NORMALS != 0 {
            mesh.normals = self.vectors(vertices, double, "normals")?;
        }
        if flags & HAS_UVS != 0 {
            mesh.uvs = self.vectors(vertices, double, "texture coordinates")?;
        }
        if flags & HAS_COLOURS != 0 {
            let colours: Vec<[f32; 3]> = self.vectors(vertices, double, "colours")?;
            let values = colours.into_flattened();
            mesh.attributes.push(MeshAttribute { name: "vertex_color".into(), channels: 3, values });
        }
        for _ in 0..triangles {
            let mut triangle = [0; 3];
            for index in &mut triangle {
                *index = u32::from_le_bytes(self.array("triangles")?);
                if *index as usize >= vertices {
                    return Err(
                        self.error(format!("found vertex index {index}, expected one of the {vertices} vertices"))
                    );
                }
            }
            mesh.triangles.push(triangle);
        }
        super::complete_normals(&mut mesh);
        Ok(mesh)
    }

    /// Refuses counts that this many deflated bytes cannot hold.
    fn check_backed(&self, flags: u32, vertices: u64, triangles: u64) -> Result<(), FileError> {
        let has = |flag: u32| u128::from(flags & flag != 0);
        let numbers = 3 + 3 * has(HAS_NORMALS) + 2 * has(HAS_UVS) + 3 * has(HAS_COLOURS);
        let size = if flags & DOUBLE != 0 { 8 } else { 4 };
        let needed = u128::from(vertices) * numbers * size + u128::from(triangles) * 12;
        if triangles == 0 || vertices >= 1 << 32 || needed > DEFLATE_RATIO * self.length as u128 {
            return Err(self.error(format!(
                "found {vertices} vertices and {triangles} triangles, expected what {} deflated bytes can hold, and at least \
                 one triangle",
                self.length
            )));
        }
        Ok(())
    }

    fn vectors<const N: usize>(&mut self, count: usize, double: bool, what: &str) -> Result<Vec<[f32; N]>, FileError> {
        // Grown as the numbers arrive.
        let mut vectors = Vec::new();
        for _ in 0..count {
            let mut vector = [0.0; N];
            for x in &mut vector {
                *x = if double {
                    f64::from_le_bytes(self.array(what)?) as f32
                } else {
                    f32::from_le_bytes(self.array(what)?)
                };
                if !x.is_finite() {
                    return Err(self.error(format!("found {x} among the {what}, expected a finite number")));
                }
            }
            vectors.push(vector);
        }
        Ok(vectors)
    }

    #[inline]
    fn array<const N: usize>(&mut self, what: &str) -> Result<[u8; N], FileError> {
        let mut array = [0; N];
        match self.reader.read_exact(&mut array) {
            Ok(()) => Ok(array),
            Err(e) if e.kind() == std::io::ErrorKind::UnexpectedEof => {
                Err(self.error(format!("found the end of the deflated mesh, expected {what}")))
            }
            Err(e) => Err(self.error(format!("cannot be inflated: {e}"))),
        }
    }

    /// An error at about the deflated byte read last.
    #[cold]
    fn error(&self, message: String) -> FileError {
        FileError::byte(self.name, self.start + self.reader.get_ref().total_in() as usize, message)
    }
}
