//! Everything that rays can hit, compiled.

use super::compile::compile;
use super::mesh::Mesh;
use super::quadric::Point;
use super::sample::{Patch, cumulative_areas};
use super::surface::SurfacePoint;
use super::tree::{Any, Nearest, Search, Seen, Through, Tree, Want, frobenius};
use super::{Form, GeometryError, Instance, Problem};
use crate::math::lanes::{Kernel, Lanes, Level, WIDTH};
use crate::math::{Aabb, Frame, PerArea, Ray, Vec2, Vec3};
use crate::scene::desc::ShapeDesc;
use glam::DVec3;
use rayon::prelude::*;

/// The compiled shapes of a scene.
///
/// Shapes are numbered: first those of the scene in their order, instances included, then the members of the first
/// shape group, of the second, and so on ([`Geometry::group_first_shape`]).
#[derive(Debug)]
pub struct Geometry {
    pub(super) shapes: Vec<Shape>,
    /// The world's, then one a group.
    pub(super) trees: Vec<Tree>,
    group_firsts: Vec<u32>,
}

/// A compiled shape.
#[derive(Debug)]
pub(super) struct Shape {
    pub(super) form: Form,
    /// Area, m^2; zero for instances.
    pub(super) area: f64,
    /// Density of points uniform over the area; zero without area.
    pub(super) area_pdf: PerArea,
    /// Running sums of the triangle areas of emitting meshes, for sampling.
    pub(super) cumulative: Vec<f64>,
    /// Their triangles.
    pub(super) patches: Vec<Patch>,
}

/// Where a ray hits a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray, metres.
    pub t: f32,
    /// Number of the shape: for an instance, that of the member of the group.
    pub shape: u32,
    /// Index of the triangle in its mesh; 0 for other shapes.
    pub triangle: u32,
    /// Barycentric coordinates of the second and third vertex of the triangle.
    pub barycentrics: Vec2,
    /// The instance through which the shape was reached.
    pub instance: Option<u32>,
}

/// What lies on the way of a shadow ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shadow {
    /// Nothing.
    Clear,
    /// An opaque surface, somewhere.
    Blocked,
    /// No opaque surface, but transparent ones; the nearest of them.
    Transparent(Hit),
}

impl Shape {
    /// In how many pieces the shape enters a tree.
    pub(super) fn surface_count(&self) -> usize {
        if let Form::Mesh(mesh) = &self.form { mesh.triangles.len() } else { 1 }
    }
}

impl Geometry {
    /// Compiles the shapes of a scene and its shape groups. `opaque` tells which shapes stop shadow rays for good; it is
    /// not asked about instances, only about the members of their groups.
    pub fn build(
        shapes: &[ShapeDesc],
        groups: &[Vec<ShapeDesc>],
        opaque: impl Fn(&ShapeDesc) -> bool,
    ) -> Result<Self, GeometryError> {
        let mut geometry = Self { shapes: Vec::new(), trees: Vec::new(), group_firsts: Vec::new() };
        let mut transparent = Vec::new();
        let mut add = |geometry: &mut Self, list: &[ShapeDesc], groups: Option<usize>| {
            let compiled: Vec<_> = list.par_iter().map(|desc| Shape::new(desc, groups)).collect();
            for (shape, desc) in compiled.into_iter().zip(list) {
                geometry.shapes.push(shape?);
                transparent.push(!opaque(desc));
            }
            Ok(())
        };
        add(&mut geometry, shapes, Some(groups.len()))?;
        for group in groups {
            geometry.group_firsts.push(geometry.shapes.len() as u32);
            add(&mut geometry, group, None)?;
        }
        let too_many = |list: &[ShapeDesc]| GeometryError {
            shape: list.last().map_or(String::new(), |d| d.name.clone()),
            problem: Problem::TooMany,
        };
        // The world's tree comes first in the list but needs those of the groups.
        let mut first = shapes.len();
        for group in groups {
            let range = first..first + group.len();
            first = range.end;
            let tree = Tree::build(&geometry, range, &transparent).ok_or_else(|| too_many(group))?;
            geometry.trees.push(tree);
        }
        let world = Tree::build(&geometry, 0..shapes.len(), &transparent).ok_or_else(|| too_many(shapes))?;
        geometry.trees.insert(0, world);
        Ok(geometry)
    }

    /// The number of the first member of a shape group.
    pub fn group_first_shape(&self, group: usize) -> u32 {
        self.group_firsts[group]
    }

    /// Bounds of an instance's group, while the trees of the groups are all there is.
    pub(super) fn group_bounds(&self, instance: &Instance) -> Aabb {
        self.trees[instance.group as usize].bounds()
    }

    /// The box around everything; empty without shapes.
    pub fn bounds(&self) -> Aabb {
        self.trees[0].bounds()
    }

    /// How many shapes there are, members of groups included.
    pub fn shape_count(&self) -> usize {
        self.shapes.len()
    }

    /// The form of a shape.
    pub fn form(&self, shape: u32) -> &Form {
        &self.shapes[shape as usize].form
    }

    /// The mesh behind a shape, if it is one.
    #[inline]
    pub fn mesh(&self, shape: u32) -> Option<&Mesh> {
        if let Form::Mesh(mesh) = self.form(shape) { Some(mesh) } else { None }
    }

    /// Triangles of all meshes, each group counted once.
    pub fn triangle_count(&self) -> usize {
        self.shapes.iter().map(|s| if let Form::Mesh(m) = &s.form { m.triangles.len() } else { 0 }).sum()
    }

    /// Memory held by meshes and hierarchies, bytes.
    pub fn memory_bytes(&self) -> usize {
        let shape = |s: &Shape| {
            let mesh = if let Form::Mesh(mesh) = &s.form { mesh.memory_bytes() } else { 0 };
            mesh + size_of::<Shape>() + size_of_val(&*s.cumulative) + size_of_val(&*s.patches)
        };
        self.shapes.iter().map(shape).sum::<usize>() + self.trees.iter().map(Tree::memory_bytes).sum::<usize>()
    }

    #[inline(always)]
    fn search<W: Want>(&self, ray: &Ray, t_max: f32, want: W) -> Seen {
        let (geometry, tree) = (self, &self.trees[0]);
        let mut search = Search { geometry, tree, ray, t_max, seen: Seen::default(), want, instance: None };
        Level::dispatch(&mut search);
        search.seen
    }

    /// The nearest surface at a distance in (0, t_max).
    pub fn intersect(&self, ray: &Ray, t_max: f32) -> Option<Hit> {
        self.search(ray, t_max, Nearest).nearest.map(|m| m.hit(self))
    }

    /// Whether there is any surface at a distance in (0, t_max).
    pub fn occluded(&self, ray: &Ray, t_max: f32) -> bool {
        self.search(ray, t_max, Any).blocked
    }

    /// What a shadow ray meets in (0, t_max): blocked as soon as any opaque surface is found, wherever it is; else the
    /// nearest transparent surface; else nothing.
    pub fn shadow(&self, ray: &Ray, t_max: f32) -> Shadow {
        match self.search(ray, t_max, Through) {
            Seen { blocked: true, .. } => Shadow::Blocked,
            Seen { nearest: Some(meeting), .. } => Shadow::Transparent(meeting.hit(self)),
            _ => Shadow::Clear,
        }
    }

    /// As [`Geometry::shadow`] for those of eight rays whose bit is set in `which`: the bits of the rays that meet nothing, and of
    /// those that meet nothing opaque, whose first transparent surfaces are put into `hits`.
    pub fn shadows(
        &self,
        rays: &[Ray; WIDTH],
        t_max: &[f32; WIDTH],
        which: u32,
        hits: &mut [Option<Hit>; WIDTH],
    ) -> [u32; 2] {
        Level::dispatch(Shadows { geometry: self, rays, t_max, which, hits })
    }

    /// The point where the ray hits.
    #[inline(always)]
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        match (self.form(hit.shape), hit.instance) {
            (Form::Mesh(mesh), None) => {
                let reach = rounding(ray.origin.as_dvec3() + hit.t as f64 * ray.direction.as_dvec3());
                let (point, frame) = mesh.meet(hit.triangle, hit.barycentrics, reach);
                place(hit, point, frame, reach)
            }
            _ => self.other_surface(ray, hit),
        }
    }

    /// The point where the ray hits anything but a mesh of the world.
    #[inline(never)]
    fn other_surface(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let instance = hit.instance.and_then(|i| match self.form(i) {
            Form::Instance(instance) => Some(instance),
            _ => None,
        });
        let ray = instance.map_or(*ray, |i| i.local_ray(ray));
        let on_ray = ray.origin.as_dvec3() + hit.t as f64 * ray.direction.as_dvec3();
        let mut point = match self.form(hit.shape) {
            Form::Mesh(mesh) => {
                // Rounding in the group's space, and in the world's as seen from there.
                let local = rounding(on_ray);
                let reach = instance
                    .map_or(local, |i| local + rounding(i.to_world.transform_point3(on_ray)) * frobenius_inverse(i));
                mesh.meet(hit.triangle, hit.barycentrics, reach).0
            }
            Form::Sphere(sphere) => sphere.point(on_ray - sphere.center).into(),
            Form::Disk(disk) => disk.point(disk.local(on_ray)).into(),
            Form::Cylinder(cylinder) => cylinder.nearest(on_ray).into(),
            Form::Instance(_) => {
                debug_assert!(false, "a hit names the surface, not the instance around it");
                Point::facing(on_ray, -ray.direction.as_dvec3()).into()
            }
        };
        let mut epsilon = rounding(point.position);
        if let Some(instance) = instance {
            point = instance.place(point);
            epsilon = epsilon * frobenius(instance) + rounding(point.position);
        }
        place(hit, point, None, epsilon)
    }
}

/// The shadow rays of [`Geometry::shadows`].
struct Shadows<'a> {
    geometry: &'a Geometry,
    rays: &'a [Ray; WIDTH],
    t_max: &'a [f32; WIDTH],
    which: u32,
    hits: &'a mut [Option<Hit>; WIDTH],
}

impl Kernel for Shadows<'_> {
    type Output = [u32; 2];

    #[inline(always)]
    fn run<L: Lanes>(self) -> [u32; 2] {
        let (geometry, tree) = (self.geometry, &self.geometry.trees[0]);
        let (mut clear, mut transparent) = (0, 0);
        let mut which = self.which;
        while which != 0 {
            let lane = which.trailing_zeros() as usize & 7;
            which &= which - 1;
            let (ray, t_max, seen) = (&self.rays[lane], self.t_max[lane], Seen::default());
            let mut search = Search { geometry, tree, ray, t_max, seen, want: Through, instance: None };
            (&mut search).run::<L>();
            match search.seen {
                Seen { blocked: true, .. } => {}
                Seen { nearest: Some(meeting), .. } => {
                    self.hits[lane] = Some(meeting.hit(geometry));
                    transparent |= 1 << lane;
                }
                _ => clear |= 1 << lane,
            }
        }
        [clear, transparent]
    }
}

impl Instance {
    /// Takes a point of the group to the world.
    fn place(&self, p: LocalPoint) -> LocalPoint {
        let vector = |v: Vec3| self.to_world.transform_vector3(v.as_dvec3()).as_vec3();
        LocalPoint {
            position: self.to_world.transform_point3(p.position),
            normal: self.normal(p.normal),
            shading_normal: self.normal(p.shading_normal.as_dvec3()).as_vec3(),
            dp_du: vector(p.dp_du),
            dp_dv: vector(p.dp_dv),
            ..p
        }
    }
}

/// Rounds a point of the world and gives it its shading frame, if it has none yet.
#[inline(always)]
fn place(hit: &Hit, p: LocalPoint, frame: Option<&Frame>, epsilon: f64) -> SurfacePoint {
    let normal = p.normal.as_vec3();
    let shading = match frame {
        Some(frame) => *frame,
        None => {
            let away = p.shading_normal.dot(normal) < 0.0;
            let shading_normal = if away { -p.shading_normal } else { p.shading_normal };
            Frame::from_normal_and_tangent(shading_normal, p.dp_du)
        }
    };
    SurfacePoint {
        position: p.position.as_vec3(),
        normal,
        shading,
        uv: p.uv,
        dp_du: p.dp_du,
        dp_dv: p.dp_dv,
        shape: hit.shape,
        triangle: hit.triangle,
        barycentrics: p.barycentrics,
        epsilon: epsilon as f32,
    }
}

/// A point of a shape in its own space.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocalPoint {
    pub(super) position: DVec3,
    pub(super) normal: DVec3,
    pub(super) shading_normal: Vec3,
    pub(super) uv: Vec2,
    pub(super) dp_du: Vec3,
    pub(super) dp_dv: Vec3,
    pub(super) barycentrics: Vec2,
}

impl From<Point> for LocalPoint {
    fn from(p: Point) -> Self {
        Self {
            position: p.position,
            normal: p.normal,
            shading_normal: p.normal.as_vec3(),
            uv: p.uv(),
            dp_du: p.dp_du.as_vec3(),
            dp_dv: p.dp_dv.as_vec3(),
            barycentrics: Vec2::ZERO,
        }
    }
}

/// How far new rays start off a surface at `p`: eight half-units in the last place of the largest coordinate.
///
/// Positions are computed in double precision, so what matters is rounding to `f32`: of the position (at most sqrt(3)
/// half-units) and of the start that [`SurfacePoint::leave`] moves off it (as many again). The tests along the new ray
/// are exact about the side of the surface on which it starts.
pub(super) fn rounding(p: DVec3) -> f64 {
    8.0 * 0.5 * f32::EPSILON as f64 * p.abs().max_element()
}

fn frobenius_inverse(instance: &Instance) -> f64 {
    let m = instance.to_local.matrix3;
    (m.x_axis.length_squared() + m.y_axis.length_squared() + m.z_axis.length_squared()).sqrt()
}

impl Shape {
    fn new(desc: &ShapeDesc, groups: Option<usize>) -> Result<Self, GeometryError> {
        let form = compile(desc, groups)?;
        let (mut cumulative, mut patches) = (Vec::new(), Vec::new());
        let area = match &form {
            Form::Mesh(mesh) if desc.emission.is_some() => {
                cumulative = cumulative_areas(mesh);
                patches = (0..mesh.triangles.len()).map(|i| Patch::new(mesh, i)).collect();
                cumulative.last().copied().unwrap_or(0.0)
            }
            Form::Mesh(mesh) => (0..mesh.triangles.len()).map(|i| mesh.triangle_area(i)).sum(),
            Form::Sphere(sphere) => sphere.area(),
            Form::Disk(disk) => disk.area(),
            Form::Cylinder(cylinder) => cylinder.area(),
            Form::Instance(_) => 0.0,
        };
        let area_pdf = PerArea(if area > 0.0 { (1.0 / area) as f32 } else { 0.0 });
        Ok(Self { form, area, area_pdf, cumulative, patches })
    }
}

impl Mesh {
    /// Memory held, bytes.
    pub fn memory_bytes(&self) -> usize {
        let attributes: usize = self.attributes.iter().map(|a| size_of_val(&*a.values)).sum();
        size_of_val(&*self.positions)
            + size_of_val(&*self.normals)
            + size_of_val(&*self.uvs)
            + size_of_val(&*self.triangles)
            + size_of_val(&*self.facets)
            + attributes
    }
}
