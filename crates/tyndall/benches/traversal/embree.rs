//! Embree 4 as the oracle, opened at run time: the few calls that single rays need.

use libloading::Library;
use std::ffi::{c_char, c_void};
use tyndall::math::Ray;
use tyndall::scene::desc::MeshDesc;

type Handle = *mut c_void;

const ROBUST: u32 = 1 << 2;
const TRIANGLES: u32 = 0;
const INDEX: u32 = 0;
const VERTEX: u32 = 1;
const FLOAT3: u32 = 0x9003;
const UINT3: u32 = 0x5003;
const INVALID: u32 = u32::MAX;

/// Embree's ray and hit. Room to spare at the end: later versions have longer hits.
#[repr(C, align(16))]
#[derive(Clone, Copy)]
struct RayHit {
    origin: [f32; 3],
    t_near: f32,
    direction: [f32; 3],
    time: f32,
    t_far: f32,
    mask: u32,
    id: u32,
    flags: u32,
    normal: [f32; 3],
    uv: [f32; 2],
    triangle: u32,
    geometry: u32,
    instance: [u32; 9],
}

type Query = unsafe extern "C" fn(Handle, *mut RayHit, Handle);

/// A committed robust scene.
pub struct Embree {
    scene: Handle,
    intersect: Query,
    occluded: Query,
    _library: Library,
}

impl Embree {
    /// Opens the library that `TYNDALL_EMBREE` names and builds a scene of the meshes.
    pub fn open(meshes: &[MeshDesc]) -> Option<Self> {
        let path = std::env::var_os("TYNDALL_EMBREE")?;
        // SAFETY: the signatures are those of Embree 4's C interface; buffers are as long as declared.
        unsafe {
            let library = Library::new(path).ok()?;
            macro_rules! call {
                ($name:literal, ($($argument:expr => $kind:ty),*) $(-> $result:ty)?) => {
                    library.get::<unsafe extern "C" fn($($kind),*) $(-> $result)?>($name).ok()?($($argument),*)
                };
            }
            let device = call!(b"rtcNewDevice", (std::ptr::null() => *const c_char) -> Handle);
            let scene = call!(b"rtcNewScene", (device => Handle) -> Handle);
            call!(b"rtcSetSceneFlags", (scene => Handle, ROBUST => u32));
            for mesh in meshes {
                let geometry = call!(b"rtcNewGeometry", (device => Handle, TRIANGLES => u32) -> Handle);
                let fill = |kind: u32, format: u32, data: *const u8, count: usize| {
                    let buffer = call!(b"rtcSetNewGeometryBuffer", (geometry => Handle, kind => u32, 0 => u32,
                        format => u32, 12 => usize, count => usize) -> *mut u8);
                    std::ptr::copy_nonoverlapping(data, buffer, 12 * count);
                    Some(())
                };
                fill(VERTEX, FLOAT3, mesh.positions.as_ptr().cast(), mesh.positions.len())?;
                fill(INDEX, UINT3, mesh.triangles.as_ptr().cast(), mesh.triangles.len())?;
                call!(b"rtcCommitGeometry", (geometry => Handle));
                call!(b"rtcAttachGeometry", (scene => Handle, geometry => Handle) -> u32);
            }
            call!(b"rtcCommitScene", (scene => Handle));
            let intersect = *library.get::<Query>(b"rtcIntersect1").ok()?;
            let occluded = *library.get::<Query>(b"rtcOccluded1").ok()?;
            Some(Self { scene, intersect, occluded, _library: library })
        }
    }

    fn query(&self, query: Query, ray: &Ray, t_max: f32) -> RayHit {
        let mut hit = RayHit {
            origin: ray.origin.to_array(),
            t_near: 0.0,
            direction: ray.direction.to_array(),
            time: 0.0,
            t_far: t_max,
            mask: u32::MAX,
            id: 0,
            flags: 0,
            normal: [0.0; 3],
            uv: [0.0; 2],
            triangle: INVALID,
            geometry: INVALID,
            instance: [INVALID; 9],
        };
        // SAFETY: the scene is committed, the record is aligned, no arguments are needed.
        unsafe { query(self.scene, &mut hit, std::ptr::null_mut()) };
        hit
    }

    /// Distance to the nearest triangle.
    pub fn intersect(&self, ray: &Ray, t_max: f32) -> Option<f32> {
        let hit = self.query(self.intersect, ray, t_max);
        (hit.geometry != INVALID).then_some(hit.t_far)
    }

    /// Whether anything is in the way.
    pub fn occluded(&self, ray: &Ray, t_max: f32) -> bool {
        self.query(self.occluded, ray, t_max).t_far < 0.0
    }
}
