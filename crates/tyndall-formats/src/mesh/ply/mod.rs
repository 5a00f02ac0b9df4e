//! PLY: text and both binary byte orders.
//!
//! Attributes are named as Mitsuba 3 names them: `r, g, b` (or `red, green, blue`) make `vertex_color`, `heat_x` makes
//! `vertex_heat`, `heat_r, heat_g, heat_b` make `vertex_heat_color`; the same with `face_`. Values are as in the file: whole
//! numbers are not divided by 255. Properties of other names, and groups of neither 1 nor 3 channels, are left out.

mod body;
mod header;

use crate::file::{FileError, read_bytes};
use body::Body;
use header::{Element, Header, Kind};
use std::path::Path;
use tyndall::scene::desc::{MeshAttribute, MeshDesc};

/// Reads a file.
pub fn read(path: &Path) -> Result<MeshDesc, FileError> {
    parse(&read_bytes(path)?, &path.to_string_lossy())
}

/// Reads a text or binary; `name` stands for the path in messages.
pub fn parse(bytes: &[u8], name: &str) -> Result<MeshDesc, FileError> {
    let header = Header::parse(bytes, name)?;
    let mut body = Body::new(&header, bytes, name);
    let mut mesh = MeshDesc::default();
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => read_vertices(&mut body, element, &mut mesh)?,
            "face" => read_faces(&mut body, element, &mut mesh)?,
            _ => body.skip(element)?,
        }
    }
    // Only now is the number of vertices known for certain: an element "face" may come first.
    let count = mesh.positions.len();
    if let Some(index) = mesh.triangles.as_flattened().iter().find(|&&i| i as usize >= count) {
        return Err(FileError::whole(
            name,
            format!("found vertex index {index}, expected one of the {count} vertices"),
        ));
    }
    if mesh.triangles.is_empty() {
        return Err(FileError::whole(name, "found no faces, expected at least one"));
    }
    super::complete_normals(&mut mesh);
    Ok(mesh)
}

/// Where a scalar property of a vertex or face goes.
#[derive(Clone, Copy, PartialEq)]
enum Target {
    Position(usize),
    Normal(usize),
    Uv(usize),
    /// Attribute and channel.
    Attribute(usize, usize),
    Nowhere,
}

fn read_vertices(body: &mut Body, element: &Element, mesh: &mut MeshDesc) -> Result<(), FileError> {
    let count = body.backed_count(element)?;
    if u32::try_from(count).is_err() {
        return Err(body.error(format!("found {count} vertices, expected fewer than 2^32")));
    }
    let has = |names: &[&str]| names.iter().all(|n| element.scalar(n).is_some());
    if !has(&["x", "y", "z"]) {
        return Err(element.error(body.name, "found a vertex without the properties x, y and z"));
    }
    let mut targets = vec![Target::Nowhere; element.properties.len()];
    let mut claim = |names: &[&str], target: fn(usize) -> Target| {
        let all = has(names);
        for (i, name) in names.iter().enumerate().filter(|_| all) {
            targets[element.scalar(name).expect("all are there")] = target(i);
        }
        all
    };
    claim(&["x", "y", "z"], Target::Position);
    let has_normals = claim(&["nx", "ny", "nz"], Target::Normal);
    let has_uvs = [["u", "v"], ["s", "t"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]]
        .iter()
        .any(|names| claim(names, Target::Uv));
    let mut attributes = attributes(element, "vertex_", &mut targets);

    mesh.positions.reserve_exact(count);
    mesh.normals.reserve_exact(if has_normals { count } else { 0 });
    mesh.uvs.reserve_exact(if has_uvs { count } else { 0 });
    for _ in 0..count {
        let (mut position, mut normal, mut uv) = ([0.0; 3], [0.0; 3], [0.0; 2]);
        for (property, &target) in element.properties.iter().zip(&targets) {
            let Kind::Scalar(scalar) = property.kind else {
                body.skip_property(property)?;
                continue;
            };
            match target {
                Target::Position(i) => position[i] = body.finite(scalar)?,
                Target::Normal(i) => normal[i] = body.finite(scalar)?,
                Target::Uv(i) => uv[i] = body.finite(scalar)?,
                Target::Attribute(a, _) => attributes[a].values.push(body.finite(scalar)?),
                Target::Nowhere => drop(body.value(scalar)?),
            }
        }
        mesh.positions.push(position);
        if has_normals {
            mesh.normals.push(normal);
        }
        if has_uvs {
            mesh.uvs.push(uv);
        }
    }
    mesh.attributes.append(&mut attributes);
    Ok(())
}

fn read_faces(body: &mut Body, element: &Element, mesh: &mut MeshDesc) -> Result<(), FileError> {
    let count = body.backed_count(element)?;
    let corners = element.properties.iter().position(|p| p.name == "vertex_indices" || p.name == "vertex_index");
    let Some(corners) =
        corners.filter(|&i| matches!(element.properties[i].kind, Kind::List(_, item) if item.is_whole()))
    else {
        return Err(
            element.error(body.name, "found a face without a list of whole numbers vertex_indices (or vertex_index)")
        );
    };
    let mut targets = vec![Target::Nowhere; element.properties.len()];
    let mut attributes = attributes(element, "face_", &mut targets);
    mesh.triangles.reserve(count);
    for _ in 0..count {
        let before = mesh.triangles.len();
        for (index, (property, &target)) in element.properties.iter().zip(&targets).enumerate() {
            match (property.kind, target) {
                (Kind::List(length, item), _) if index == corners => read_fan(body, length, item, &mut mesh.triangles)?,
                (Kind::List(..), _) => body.skip_property(property)?,
                (Kind::Scalar(scalar), Target::Attribute(a, _)) => attributes[a].values.push(body.finite(scalar)?),
                (Kind::Scalar(scalar), _) => drop(body.value(scalar)?),
            }
        }
        // A polygon's attributes are those of each of its triangles.
        for attribute in attributes.iter_mut() {
            for _ in 1..mesh.triangles.len() - before {
                let last = attribute.values.len() - attribute.channels;
                attribute.values.extend_from_within(last..);
            }
        }
    }
    mesh.attributes.append(&mut attributes);
    Ok(())
}

/// Reads one polygon as a fan of triangles about its first corner.
fn read_fan(
    body: &mut Body,
    length: header::Scalar,
    item: header::Scalar,
    triangles: &mut Vec<[u32; 3]>,
) -> Result<(), FileError> {
    let count = body.length(length)?;
    if count < 3 {
        return Err(body.error_before(format!("found a face of {count} corners, expected at least 3")));
    }
    let first = body.index(item)?;
    let mut last = body.index(item)?;
    for _ in 2..count {
        let next = body.index(item)?;
        triangles.push([first, last, next]);
        last = next;
    }
    Ok(())
}

/// The attributes of an element. They must be 1 or 3 properties of one stem that stand together, channels in order.
fn attributes(element: &Element, prefix: &str, targets: &mut [Target]) -> Vec<MeshAttribute> {
    let mut attributes: Vec<MeshAttribute> = Vec::new();
    let stems: Vec<Option<(String, usize)>> = element
        .properties
        .iter()
        .zip(&*targets)
        .map(|(property, &target)| match property.kind {
            Kind::Scalar(_) if target == Target::Nowhere => stem(&property.name),
            _ => None,
        })
        .collect();
    let mut start = 0;
    while start < stems.len() {
        let Some((name, _)) = &stems[start] else {
            start += 1;
            continue;
        };
        let same = |s: &&Option<(String, usize)>| s.as_ref().is_some_and(|(n, _)| n == name);
        let length = stems[start..].iter().take_while(same).count();
        let name = format!("{prefix}{name}");
        // A fourth channel (alpha) is dropped.
        let channels = if length == 4 { 3 } else { length };
        if (channels == 1 || channels == 3) && attributes.iter().all(|a| a.name != name) {
            for channel in 0..channels {
                targets[start + channel] = Target::Attribute(attributes.len(), channel);
            }
            attributes.push(MeshAttribute { name, channels, values: Vec::new() });
        }
        start += length;
    }
    attributes
}

/// The attribute that a property belongs to, without `vertex_` or `face_`, and its channel.
fn stem(property: &str) -> Option<(String, usize)> {
    if let Some(channel) = ["red", "green", "blue", "alpha"].iter().position(|&c| c == property) {
        return Some(("color".into(), channel));
    }
    if let Some(channel) = ["r", "g", "b", "a"].iter().position(|&c| c == property) {
        return Some(("color".into(), channel));
    }
    let (name, suffix) = property.rsplit_once('_')?;
    let among = |names: [&str; 4]| names.iter().position(|&n| n == suffix);
    if let Some(channel) = among(["r", "g", "b", "a"]) {
        return Some((format!("{name}_color"), channel));
    }
    let channel =
        among(["x", "y", "z", "w"]).or_else(|| among(["0", "1", "2", "3"])).or_else(|| among(["1", "2", "3", "4"]))?;
    Some((name.into(), channel))
}
