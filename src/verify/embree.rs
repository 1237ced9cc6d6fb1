//! Embree's own hits, by its C interface, version 4: loaded while the program runs, and only if it is asked
//! for.
//!
//! The one file of this room that is `unsafe`. Everything that Embree is told is copied into memory that it
//! has given out itself, and nothing that it has given out leaves this file.

#![allow(unsafe_code)]

use std::{
    ffi::{c_char, c_int, c_uint, c_void},
    mem::ManuallyDrop,
    path::Path,
    ptr::{null, null_mut},
    slice,
};

use glam::Vec3;
use libloading::{Library, Symbol};

use crate::geometry::{Hit, PrimitiveId, Ray32};

type Handle = *mut c_void;

const GEOMETRY_TRIANGLE: c_int = 0;
const BUFFER_INDEX: c_int = 0;
const BUFFER_VERTEX: c_int = 1;
const FORMAT_UINT3: c_int = 0x5003;
const FORMAT_FLOAT3: c_int = 0x9003;
const SCENE_ROBUST: c_int = 1 << 2;
const PROPERTY_VERSION: c_int = 0;
const INVALID: c_uint = c_uint::MAX;

/// Why there is no Embree.
#[derive(Debug, thiserror::Error)]
pub enum EmbreeError {
    /// The file is no library, or lacks what it should have.
    #[error("{0}")]
    Library(#[from] libloading::Error),
    /// It is one of another version.
    #[error("it is version {}.{}, and version 4 is needed", .0 / 10_000, .0 / 100 % 100)]
    Version(isize),
    /// It can't work here.
    #[error("it can't make a {0}")]
    Refused(&'static str),
}

/// `RTCRayHit`.
#[repr(C, align(16))]
struct RayHit {
    org: [f32; 3],
    t_near: f32,
    dir: [f32; 3],
    time: f32,
    t_far: f32,
    mask: c_uint,
    id: c_uint,
    flags: c_uint,
    normal: [f32; 3],
    u: f32,
    v: f32,
    primitive: c_uint,
    geometry: c_uint,
    instance: [c_uint; 2],
}

/// Triangles in Embree's tree, in its robust mode.
pub struct Embree {
    device: Handle,
    scene: Handle,
    version: isize,
    intersect: unsafe extern "C" fn(Handle, *mut RayHit, *mut c_void),
    release_scene: unsafe extern "C" fn(Handle),
    release_device: unsafe extern "C" fn(Handle),
}

impl Embree {
    /// Loads the library of this name and builds a tree over triangles.
    ///
    /// # Errors
    /// [`EmbreeError`].
    pub fn new(library: &Path, triangles: &[[Vec3; 3]]) -> Result<Self, EmbreeError> {
        // SAFETY: whoever names a library trusts what it does when it is loaded; the types of its functions are
        // those of Embree 4's header, and before any of them whose type has changed is called, the version is
        // asked for.
        unsafe {
            // Never unloaded: threads that it has started would run on without their code.
            let library = ManuallyDrop::new(Library::new(library)?);
            let embree = Self::empty(&library)?;
            embree.fill(&library, triangles)?;
            Ok(embree)
        }
    }

    /// # Safety
    /// If there are functions of Embree's names in it, it is Embree.
    unsafe fn empty(library: &Library) -> Result<Self, EmbreeError> {
        // SAFETY: as above. Each handle is looked at before it is used.
        unsafe {
            let new_device: Symbol<unsafe extern "C" fn(*const c_char) -> Handle> =
                library.get(b"rtcNewDevice\0")?;
            let property: Symbol<unsafe extern "C" fn(Handle, c_int) -> isize> =
                library.get(b"rtcGetDeviceProperty\0")?;
            let new_scene: Symbol<unsafe extern "C" fn(Handle) -> Handle> = library.get(b"rtcNewScene\0")?;
            let release_device: Symbol<unsafe extern "C" fn(Handle)> = library.get(b"rtcReleaseDevice\0")?;
            let release_scene: Symbol<unsafe extern "C" fn(Handle)> = library.get(b"rtcReleaseScene\0")?;
            let intersect: Symbol<unsafe extern "C" fn(Handle, *mut RayHit, *mut c_void)> =
                library.get(b"rtcIntersect1\0")?;
            let device = new_device(null());
            if device.is_null() {
                return Err(EmbreeError::Refused("device"));
            }
            let version = property(device, PROPERTY_VERSION);
            if version / 10_000 != 4 {
                release_device(device);
                return Err(EmbreeError::Version(version));
            }
            let scene = new_scene(device);
            if scene.is_null() {
                release_device(device);
                return Err(EmbreeError::Refused("scene"));
            }
            let (intersect, release_scene, release_device) = (*intersect, *release_scene, *release_device);
            Ok(Self { device, scene, version, intersect, release_scene, release_device })
        }
    }

    /// # Safety
    /// As for [`empty`](Self::empty); and it is filled once.
    unsafe fn fill(&self, library: &Library, triangles: &[[Vec3; 3]]) -> Result<(), EmbreeError> {
        // SAFETY: as above. A buffer has room for as many elements of 12 bytes as were asked for.
        unsafe {
            let flags: Symbol<unsafe extern "C" fn(Handle, c_int)> = library.get(b"rtcSetSceneFlags\0")?;
            let new_geometry: Symbol<unsafe extern "C" fn(Handle, c_int) -> Handle> =
                library.get(b"rtcNewGeometry\0")?;
            let buffer: Symbol<
                unsafe extern "C" fn(Handle, c_int, c_uint, c_int, usize, usize) -> *mut c_void,
            > = library.get(b"rtcSetNewGeometryBuffer\0")?;
            let attach: Symbol<unsafe extern "C" fn(Handle, Handle) -> c_uint> =
                library.get(b"rtcAttachGeometry\0")?;
            let commit_geometry: Symbol<unsafe extern "C" fn(Handle)> =
                library.get(b"rtcCommitGeometry\0")?;
            let release_geometry: Symbol<unsafe extern "C" fn(Handle)> =
                library.get(b"rtcReleaseGeometry\0")?;
            let commit_scene: Symbol<unsafe extern "C" fn(Handle)> = library.get(b"rtcCommitScene\0")?;

            flags(self.scene, SCENE_ROBUST);
            let geometry = new_geometry(self.device, GEOMETRY_TRIANGLE);
            if geometry.is_null() {
                return Err(EmbreeError::Refused("geometry"));
            }
            let count = triangles.len();
            let vertices =
                buffer(geometry, BUFFER_VERTEX, 0, FORMAT_FLOAT3, 12, 3 * count).cast::<[f32; 3]>();
            let indices = buffer(geometry, BUFFER_INDEX, 0, FORMAT_UINT3, 12, count).cast::<[u32; 3]>();
            if count > 0 && (vertices.is_null() || indices.is_null()) {
                release_geometry(geometry);
                return Err(EmbreeError::Refused("buffer of that size"));
            }
            if count > 0 {
                let (vertices, indices) = (
                    slice::from_raw_parts_mut(vertices, 3 * count),
                    slice::from_raw_parts_mut(indices, count),
                );
                let corners = triangles.iter().flatten().map(Vec3::to_array);
                vertices.iter_mut().zip(corners).for_each(|(vertex, corner)| *vertex = corner);
                indices.iter_mut().zip(0..).for_each(|(index, i)| *index = [3 * i, 3 * i + 1, 3 * i + 2]);
                commit_geometry(geometry);
                attach(self.scene, geometry);
            }
            release_geometry(geometry);
            commit_scene(self.scene);
        }
        Ok(())
    }

    /// As people say it: `4.4`.
    pub fn version(&self) -> String {
        format!("{}.{}", self.version / 10_000, self.version / 100 % 100)
    }

    /// The nearest hit of each ray; primitives are places in the list of triangles.
    pub fn closest_hits(&self, rays: &[Ray32]) -> Vec<Hit> {
        rays.iter().map(|ray| if ray.is_valid() { self.closest_hit(ray) } else { Hit::MISS }).collect()
    }

    fn closest_hit(&self, ray: &Ray32) -> Hit {
        let mut found = RayHit {
            org: ray.org,
            t_near: ray.t_near,
            dir: ray.dir,
            time: 0.0,
            t_far: ray.t_far,
            mask: c_uint::MAX,
            id: 0,
            flags: 0,
            normal: [0.0; 3],
            u: 0.0,
            v: 0.0,
            primitive: INVALID,
            geometry: INVALID,
            instance: [INVALID; 2],
        };
        // SAFETY: the scene has been committed, the ray is laid out and aligned as the header says, and
        // without arguments the usual ones are meant.
        unsafe { (self.intersect)(self.scene, &raw mut found, null_mut()) };
        match found.geometry {
            INVALID => Hit::MISS,
            _ => Hit { t: found.t_far, u: found.u, v: found.v, primitive: PrimitiveId(found.primitive) },
        }
    }
}

impl Drop for Embree {
    fn drop(&mut self) {
        // SAFETY: both are there until now, and the library for ever.
        unsafe {
            (self.release_scene)(self.scene);
            (self.release_device)(self.device);
        }
    }
}
