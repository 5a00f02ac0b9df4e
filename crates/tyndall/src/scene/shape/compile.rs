//! From descriptions in object space to shapes in world space.

use super::error::{GeometryError, Problem};
use super::mesh::{Attribute, Mesh};
use super::quadric::{Cylinder, Disk, Sphere};
use super::{Form, Instance};
use crate::Spectrum;
use crate::math::{Affine, Transform, Vec2, Vec3};
use crate::scene::desc::{GeometryDesc, MeshAttribute, MeshDesc, ShapeDesc};
use glam::{DAffine3, DMat4, DVec3};

/// Compiles one shape. `groups` is the number of shape groups that may be instanced; `None` inside a group.
pub(super) fn compile(desc: &ShapeDesc, groups: Option<usize>) -> Result<Form, GeometryError> {
    form(desc, groups).map_err(|problem| GeometryError { shape: desc.name.clone(), problem })
}

fn form(desc: &ShapeDesc, groups: Option<usize>) -> Result<Form, Problem> {
    let place = Place {
        transform: &desc.to_world,
        affine: desc.to_world.compile().ok_or(Problem::BadTransform)?,
        flip: desc.flip_normals,
    };
    let instanced = groups.is_none() || matches!(desc.geometry, GeometryDesc::Instance(_));
    if instanced && desc.emission.is_some() {
        return Err(Problem::InstancedEmitter);
    }
    Ok(match &desc.geometry {
        GeometryDesc::Mesh(mesh) => Form::Mesh(place.mesh(mesh, !mesh.normals.is_empty())?),
        GeometryDesc::Rectangle => Form::Mesh(place.mesh(&rectangle(), true)?),
        GeometryDesc::Cube => Form::Mesh(place.mesh(&cube(), true)?),
        GeometryDesc::Sphere { center, radius } => Form::Sphere(place.sphere(*center, *radius)?),
        GeometryDesc::Disk => Form::Disk(place.disk()?),
        GeometryDesc::Cylinder { p0, p1, radius } => Form::Cylinder(place.cylinder(*p0, *p1, *radius)?),
        GeometryDesc::Instance(group) => match groups {
            None => return Err(Problem::NestedInstance),
            Some(count) if group.0 >= count => return Err(Problem::UnknownGroup(group.0)),
            Some(_) => Form::Instance(place.instance(group.0)?),
        },
    })
}

/// Where a shape goes.
struct Place<'a> {
    transform: &'a Transform,
    affine: Affine,
    flip: bool,
}

impl Place<'_> {
    fn point(&self, p: [f64; 3]) -> DVec3 {
        DVec3::from_array(self.transform.point(p))
    }

    fn vector(&self, v: [f64; 3]) -> DVec3 {
        DVec3::from_array(self.transform.vector(v))
    }

    fn side(&self, flip: bool) -> f64 {
        if self.flip != flip { -1.0 } else { 1.0 }
    }

    /// `oriented`: the object has normals of its own, which a mirroring transform does not turn round. Otherwise the
    /// winding of the transformed triangles decides, as in Mitsuba.
    fn mesh(&self, mesh: &MeshDesc, oriented: bool) -> Result<Mesh, Problem> {
        let vertices = mesh.positions.len();
        let per_vertex = |what: &str, found: usize| match found == 0 || found == vertices {
            true => Ok(()),
            false => Err(Problem::WrongLength { what: what.into(), found, expected: vertices }),
        };
        per_vertex("normals", mesh.normals.len())?;
        per_vertex("texture coordinates", mesh.uvs.len())?;
        let finite = |what, index, ok: bool| if ok { Ok(()) } else { Err(Problem::NotFinite { what, index }) };
        let mut positions = Vec::with_capacity(vertices);
        for (i, p) in mesh.positions.iter().enumerate() {
            let p = self.point(p.map(f64::from)).as_vec3();
            finite("vertex", i, p.is_finite())?;
            positions.push(p);
        }
        let mut normals = Vec::with_capacity(mesh.normals.len());
        for (i, n) in mesh.normals.iter().enumerate() {
            let n = Vec3::from_array(*n);
            finite("normal", i, n.is_finite())?;
            let n = self.affine.normal(n).as_dvec3().normalize_or_zero().as_vec3();
            normals.push(if self.flip { -n } else { n });
        }
        for (i, uv) in mesh.uvs.iter().enumerate() {
            finite("texture coordinate", i, uv.iter().all(|x| x.is_finite()))?;
        }
        let reverse = self.flip != (oriented && self.affine.flips_handedness());
        let mut triangles = Vec::with_capacity(mesh.triangles.len());
        for (triangle, &[a, b, c]) in mesh.triangles.iter().enumerate() {
            if let Some(&vertex) = [a, b, c].iter().find(|v| **v as usize >= vertices) {
                return Err(Problem::IndexOutOfRange { triangle, vertex, vertices });
            }
            triangles.push(if reverse { [a, c, b] } else { [a, b, c] });
        }
        let attributes = mesh.attributes.iter().map(|a| attribute(a, mesh)).collect::<Result<_, _>>()?;
        let uvs = mesh.uvs.iter().map(|uv| Vec2::from_array(*uv)).collect();
        let mut mesh = Mesh { positions, normals, uvs, triangles, attributes, facets: Vec::new() };
        mesh.note_facets();
        Ok(mesh)
    }

    /// A mirrored sphere is turned inside out, as in Mitsuba.
    fn sphere(&self, center: [f64; 3], radius: f64) -> Result<Sphere, Problem> {
        let scale = self.affine.uniform_scale().ok_or(Problem::NonUniformScale { form: "sphere" })?;
        let axis = |v| self.vector(v).normalize();
        Ok(Sphere {
            center: self.finite_center(center)?,
            radius: positive(radius, scale)?,
            axes: [axis([1.0, 0.0, 0.0]), axis([0.0, 1.0, 0.0]), axis([0.0, 0.0, 1.0])],
            side: self.side(self.affine.flips_handedness()),
        })
    }

    fn finite_center(&self, center: [f64; 3]) -> Result<DVec3, Problem> {
        let center = self.point(center);
        match center.as_vec3().is_finite() {
            true => Ok(center),
            false => Err(Problem::NotFinite { what: "center", index: 0 }),
        }
    }

    fn disk(&self) -> Result<Disk, Problem> {
        let [x, y] = [self.vector([1.0, 0.0, 0.0]), self.vector([0.0, 1.0, 0.0])];
        let z = self.vector([0.0, 0.0, 1.0]);
        let cross = x.cross(y);
        let normal = cross.normalize();
        let square = cross.length_squared();
        // On the side of the object's +z, mirrored or not.
        let side = self.side(cross.dot(z) < 0.0);
        Ok(Disk {
            center: self.finite_center([0.0; 3])?,
            axes: [x, y],
            dual: [y.cross(cross) / square, cross.cross(x) / square],
            normal: side * normal,
        })
    }

    fn cylinder(&self, p0: [f64; 3], p1: [f64; 3], radius: f64) -> Result<Cylinder, Problem> {
        let scale = self.affine.uniform_scale().ok_or(Problem::NonUniformScale { form: "cylinder" })?;
        let local = DVec3::from_array(p1) - DVec3::from_array(p0);
        let length = local.length();
        if !(length > 0.0 && length.is_finite() && DVec3::from_array(p0).is_finite()) {
            return Err(Problem::BadAxis);
        }
        let z = local / length;
        let [x, y] = tangents(z);
        let axis = |v: DVec3| self.vector(v.to_array()).normalize();
        Ok(Cylinder {
            base: self.finite_center(p0)?,
            axes: [axis(x), axis(y), axis(z)],
            radius: positive(radius, scale)?,
            length: length * scale as f64,
            side: self.side(false),
        })
    }

    fn instance(&self, group: usize) -> Result<Instance, Problem> {
        let to_world = DAffine3::from_mat4(DMat4::from_cols_array_2d(&self.transform.rows()).transpose());
        Ok(Instance { group: group as u32, to_world, to_local: to_world.inverse(), flip: self.flip })
    }
}

fn positive(radius: f64, scale: f32) -> Result<f64, Problem> {
    let world = radius * scale as f64;
    if radius > 0.0 && (world as f32) > 0.0 && (world as f32).is_finite() {
        Ok(world)
    } else {
        Err(Problem::BadRadius(radius))
    }
}

/// The x and y axes around the unit vector `z` (Duff et al. 2017).
fn tangents(z: DVec3) -> [DVec3; 2] {
    let sign = 1.0_f64.copysign(z.z);
    let a = -1.0 / (sign + z.z);
    let b = z.x * z.y * a;
    [DVec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x), DVec3::new(b, sign + z.y * z.y * a, -z.y)]
}

fn attribute(a: &MeshAttribute, mesh: &MeshDesc) -> Result<Attribute, Problem> {
    let per_face = a.name.starts_with("face_");
    let count = if per_face { mesh.triangles.len() } else { mesh.positions.len() };
    let expected = count * a.channels;
    if a.values.len() != expected || !matches!(a.channels, 1 | 3) {
        let what = format!("attribute `{}` of {} channels", a.name, a.channels);
        return Err(Problem::WrongLength { what, found: a.values.len(), expected });
    }
    let spectrum = |v: &[f32]| if let [r, g, b] = *v { Spectrum::new(r, g, b) } else { Spectrum::grey(v[0]) };
    let values = a.values.chunks_exact(a.channels).map(spectrum).collect();
    Ok(Attribute { name: a.name.as_str().into(), per_face, values })
}

/// A square around `normal` spanned by the directions of u and v; counter-clockwise seen from the normal's tip.
fn face(mesh: &mut MeshDesc, normal: Vec3, u: Vec3, v: Vec3) {
    let first = mesh.positions.len() as u32;
    for uv in [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y] {
        mesh.positions.push((normal + (2.0 * uv.x - 1.0) * u + (2.0 * uv.y - 1.0) * v).to_array());
        mesh.uvs.push(uv.to_array());
    }
    // The cube's faces are drawn mirrored.
    let order = if u.cross(v).dot(normal) < 0.0 { [[0, 3, 2], [0, 2, 1]] } else { [[0, 1, 2], [0, 2, 3]] };
    mesh.triangles.extend(order.map(|t| t.map(|i: u32| first + i)));
}

/// The rectangle as a mesh.
fn rectangle() -> MeshDesc {
    let mut mesh = MeshDesc::default();
    face(&mut mesh, Vec3::Z, Vec3::X, Vec3::Y);
    mesh.positions.iter_mut().for_each(|p| p[2] = 0.0);
    mesh
}

/// The cube as a mesh, with the texture coordinates of Mitsuba's.
fn cube() -> MeshDesc {
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    let mut mesh = MeshDesc::default();
    for (normal, u, v) in [(x, y, -z), (-x, y, z), (y, -x, -z), (-y, z, x), (z, y, x), (-z, -y, x)] {
        face(&mut mesh, normal, u, v);
    }
    mesh
}
