//! A hierarchy over the surfaces of several shapes: triangle packets, and a short list of other shapes a leaf.

use super::{Form, Geometry, Instance};
use crate::accel::{Bvh, TrianglePacket, TriangleRay, Visit};
use crate::math::lanes::{Kernel, Lanes, Level, WIDTH};
use crate::math::{Aabb, Ray, Vec2, Vec3};
use glam::DVec3;
use std::ops::Range;

/// The surfaces of the world or of one shape group.
#[derive(Debug)]
pub(super) struct Tree {
    bvh: Bvh,
    /// One a leaf. Its ids are surface numbers, with [`TRANSPARENT`] set where shadow rays may pass.
    packets: Vec<TrianglePacket>,
    /// Surface numbers of the others, leaf by leaf, flagged alike.
    others: Vec<u32>,
    /// Where each leaf's others start, and their number at last; empty if there are none at all.
    other_starts: Vec<u32>,
    /// First surface number of each shape, and the number of surfaces at last.
    firsts: Vec<u32>,
    /// The shape of each of the first few surfaces: all, in small scenes.
    table: Vec<u32>,
    /// Index of the first shape in the geometry's list.
    first_shape: u32,
}

/// Marks surfaces that shadow rays may pass.
const TRANSPARENT: u32 = 1 << 31;

/// How many surfaces have their shape noted.
const TABLE: usize = 1024;

/// What a ray meets, before its surface number is looked up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meeting {
    pub(super) t: f32,
    surface: u32,
    barycentrics: Vec2,
    /// The shape that placed the group in which the surface is.
    instance: Option<u32>,
}

impl Tree {
    /// Builds the tree over `shapes[range]`. `None` when there are too many surfaces. Triangles without area are left out.
    pub(super) fn build(geometry: &Geometry, range: Range<usize>, transparent: &[bool]) -> Option<Self> {
        let shapes = &geometry.shapes[range.clone()];
        let mut firsts = Vec::with_capacity(shapes.len() + 1);
        let mut count = 0;
        for shape in shapes {
            firsts.push(count as u32);
            count += shape.surface_count();
            if count >= TRANSPARENT as usize {
                return None;
            }
        }
        firsts.push(count as u32);
        let shape_of = |surface| firsts.partition_point(|first| *first <= surface) as u32 - 1;
        let table = (0..count.min(TABLE) as u32).map(&shape_of).collect();
        let mut bounds = Vec::with_capacity(count);
        for shape in shapes {
            match &shape.form {
                Form::Mesh(mesh) => bounds.extend((0..mesh.triangles.len()).map(|i| triangle_bounds(mesh.corners(i)))),
                Form::Sphere(sphere) => bounds.push(sphere.bounds()),
                Form::Disk(disk) => bounds.push(disk.bounds()),
                Form::Cylinder(cylinder) => bounds.push(cylinder.bounds()),
                Form::Instance(instance) => bounds.push(instance_bounds(instance, geometry.group_bounds(instance))),
            }
        }
        let mut bvh = Bvh::build_with_costs(&bounds, |surface| {
            let mesh = matches!(shapes[shape_of(surface as u32) as usize].form, Form::Mesh(_));
            if mesh { 1 } else { WIDTH as u32 }
        });
        drop(bounds);
        let mut tree = Self {
            packets: vec![TrianglePacket::EMPTY; bvh.leaf_count()],
            others: Vec::new(),
            other_starts: vec![0],
            firsts,
            table,
            first_shape: range.start as u32,
            bvh: Bvh::default(),
        };
        for leaf in 0..bvh.leaf_count() {
            let mut lane = 0;
            for &surface in &bvh.order()[bvh.leaf(leaf as u32)] {
                let (shape, triangle) = tree.locate(surface);
                let id = if transparent[shape as usize] { surface | TRANSPARENT } else { surface };
                match &geometry.shapes[shape as usize].form {
                    Form::Mesh(mesh) => {
                        tree.packets[leaf].set(lane, mesh.corners(triangle as usize), id);
                        lane += 1;
                    }
                    _ => tree.others.push(id),
                }
            }
            tree.other_starts.push(tree.others.len() as u32);
        }
        if tree.others.is_empty() {
            tree.other_starts = Vec::new();
        }
        bvh.forget_order();
        tree.bvh = bvh;
        Some(tree)
    }

    pub(super) fn bounds(&self) -> Aabb {
        self.bvh.bounds()
    }

    pub(super) fn memory_bytes(&self) -> usize {
        let numbers = self.others.len() + self.other_starts.len() + self.firsts.len() + self.table.len();
        self.bvh.memory_bytes() + size_of_val(&*self.packets) + numbers * size_of::<u32>()
    }

    /// The shape and the triangle of a surface number.
    #[inline(always)]
    fn locate(&self, surface: u32) -> (u32, u32) {
        let surface = surface & !TRANSPARENT;
        let shape = match self.table.get(surface as usize) {
            Some(shape) => *shape,
            None => self.search_shape(surface),
        };
        (self.first_shape + shape, surface - self.firsts[shape as usize])
    }

    #[inline(never)]
    fn search_shape(&self, surface: u32) -> u32 {
        self.firsts.partition_point(|first| *first <= surface) as u32 - 1
    }

    #[inline(always)]
    fn leaf_others(&self, leaf: u32) -> &[u32] {
        match self.other_starts.is_empty() {
            true => &[],
            false => {
                &self.others[self.other_starts[leaf as usize] as usize..self.other_starts[leaf as usize + 1] as usize]
            }
        }
    }
}

fn triangle_bounds([a, b, c]: [Vec3; 3]) -> Aabb {
    let [p, q, r] = [a, b, c].map(Vec3::as_dvec3);
    if (q - p).cross(r - p) == DVec3::ZERO { Aabb::EMPTY } else { Aabb::from_points([a, b, c]) }
}

fn instance_bounds(instance: &Instance, bounds: Aabb) -> Aabb {
    if bounds.is_empty() {
        return Aabb::EMPTY;
    }
    let corners = bounds.corners().map(|c| instance.to_world.transform_point3(c.as_dvec3()).as_vec3());
    let b = Aabb::from_points(corners);
    // Room for rounding, of these corners and of the rays on their way in.
    let local = bounds.min.abs().max(bounds.max.abs()).length() as f64 * frobenius(instance);
    let pad = Vec3::splat(8.0 * f32::EPSILON * (local as f32 + b.min.abs().max(b.max.abs()).max_element()));
    Aabb { min: b.min - pad, max: b.max + pad }
}

/// A bound of the factor by which the instance enlarges lengths.
pub(super) fn frobenius(instance: &Instance) -> f64 {
    let m = instance.to_world.matrix3;
    (m.x_axis.length_squared() + m.y_axis.length_squared() + m.z_axis.length_squared()).sqrt()
}

/// What a search wants of the surfaces on a ray.
pub(super) trait Want: Copy {
    /// Notes the meeting, which is nearer than `t_max`; returns the new `t_max`.
    fn found(meeting: Meeting, transparent: bool, t_max: f32, result: &mut Seen) -> f32;
    /// Whether nearer boxes come first.
    const NEAR_FIRST: bool;
}

/// What a search has found.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Seen {
    pub(super) nearest: Option<Meeting>,
    pub(super) blocked: bool,
}

/// The nearest surface.
#[derive(Clone, Copy)]
pub(super) struct Nearest;
/// Any surface.
#[derive(Clone, Copy)]
pub(super) struct Any;
/// Any opaque surface, else the nearest transparent one.
#[derive(Clone, Copy)]
pub(super) struct Through;

impl Want for Nearest {
    const NEAR_FIRST: bool = true;
    #[inline(always)]
    fn found(meeting: Meeting, _: bool, _: f32, seen: &mut Seen) -> f32 {
        seen.nearest = Some(meeting);
        meeting.t
    }
}

impl Want for Any {
    const NEAR_FIRST: bool = false;
    #[inline(always)]
    fn found(_: Meeting, _: bool, _: f32, seen: &mut Seen) -> f32 {
        seen.blocked = true;
        Bvh::STOP
    }
}

impl Want for Through {
    const NEAR_FIRST: bool = false;
    #[inline(always)]
    fn found(meeting: Meeting, transparent: bool, t_max: f32, seen: &mut Seen) -> f32 {
        if !transparent {
            seen.blocked = true;
            return Bvh::STOP;
        }
        if seen.nearest.is_none_or(|n| meeting.t < n.t) {
            seen.nearest = Some(meeting);
        }
        t_max
    }
}

/// The search of a ray through a tree.
pub(super) struct Search<'a, W> {
    pub(super) geometry: &'a Geometry,
    pub(super) tree: &'a Tree,
    pub(super) ray: &'a Ray,
    /// Nothing farther is wanted; shortened by what is found.
    pub(super) t_max: f32,
    pub(super) seen: Seen,
    pub(super) want: W,
    /// The shape that placed this tree.
    pub(super) instance: Option<u32>,
}

impl<W: Want> Kernel for &mut Search<'_, W> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let (tree, ray, t_max) = (self.tree, self.ray, self.t_max);
        let mut visitor = SearchVisit { triangle_ray: TriangleRay::new(ray), search: self };
        match W::NEAR_FIRST {
            true => tree.bvh.nearest::<L>(ray, t_max, &mut visitor),
            false => tree.bvh.along::<L>(ray, t_max, &mut visitor),
        }
    }
}

struct SearchVisit<'s, 'a, W> {
    search: &'s mut Search<'a, W>,
    triangle_ray: TriangleRay<'a>,
}

impl<W: Want> Visit for SearchVisit<'_, '_, W> {
    #[inline(always)]
    fn leaf<L: Lanes>(&mut self, leaf: u32, t_max: f32) -> f32 {
        let Search { tree, seen, instance, t_max: shortened, .. } = &mut *self.search;
        let packet = &tree.packets[leaf as usize];
        let mut t_max = t_max;
        if packet.ids[0] != u32::MAX {
            t_max = packet.meet::<L>(&self.triangle_ray, t_max, |hit, t_max| {
                let id = packet.ids[hit.lane & 7];
                let meeting = Meeting { t: hit.t, surface: id, barycentrics: hit.barycentrics, instance: *instance };
                *shortened = W::found(meeting, id & TRANSPARENT != 0, t_max, seen);
                *shortened
            });
        }
        for &other in tree.leaf_others(leaf) {
            t_max = self.search.other(other, t_max);
            self.search.t_max = t_max;
        }
        t_max
    }
}

impl<W: Want> Search<'_, W> {
    /// Meets a shape that is not a mesh.
    #[inline(never)]
    fn other(&mut self, id: u32, t_max: f32) -> f32 {
        let (shape, _) = self.tree.locate(id);
        let t = match &self.geometry.shapes[shape as usize].form {
            Form::Sphere(sphere) => sphere.meet(self.ray, t_max),
            Form::Disk(disk) => disk.meet(self.ray, t_max),
            Form::Cylinder(cylinder) => cylinder.meet(self.ray, t_max),
            Form::Instance(instance) => {
                let mut search = Search {
                    geometry: self.geometry,
                    tree: &self.geometry.trees[1 + instance.group as usize],
                    ray: &instance.local_ray(self.ray),
                    t_max,
                    seen: self.seen,
                    want: self.want,
                    instance: Some(shape),
                };
                Level::dispatch(&mut search);
                self.seen = search.seen;
                return search.t_max;
            }
            Form::Mesh(_) => None,
        };
        match t {
            None => t_max,
            Some(t) => {
                let meeting = Meeting { t, surface: id, barycentrics: Vec2::ZERO, instance: self.instance };
                W::found(meeting, id & TRANSPARENT != 0, t_max, &mut self.seen)
            }
        }
    }
}

impl Meeting {
    /// Looks the shape and the triangle up.
    #[inline(always)]
    pub(super) fn hit(&self, geometry: &Geometry) -> super::Hit {
        let tree = match self.instance.map(|i| &geometry.shapes[i as usize].form) {
            Some(Form::Instance(instance)) => &geometry.trees[1 + instance.group as usize],
            _ => &geometry.trees[0],
        };
        let (shape, triangle) = tree.locate(self.surface);
        super::Hit { t: self.t, shape, triangle, barycentrics: self.barycentrics, instance: self.instance }
    }
}
