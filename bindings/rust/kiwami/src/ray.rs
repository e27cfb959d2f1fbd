// SPDX-License-Identifier: Apache-2.0
use kiwami_sys as sys;

/// The number that names nothing.
pub const INVALID_ID: u32 = sys::KIWAMI_INVALID_ID;

/// The points origin + t * direction with tmin <= t <= tmax; laid out as the C interface reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    pub origin: [f32; 3],
    pub tmin: f32,
    pub direction: [f32; 3],
    pub tmax: f32,
    /// 0 to 1, for geometries that move.
    pub time: f32,
    /// A mesh is met only if (ray.mask & mesh.mask) != 0.
    pub mask: u32,
    /// `kiwami_sys::KIWAMI_RAY_*`.
    pub flags: u32,
    /// The caller's own; not read.
    pub id: u32,
}

impl Ray {
    /// A ray without end, from tmin = 0 on, that meets meshes of all masks.
    pub fn new(origin: [f32; 3], direction: [f32; 3]) -> Self {
        Self {
            origin,
            tmin: 0.0,
            direction,
            tmax: f32::INFINITY,
            time: 0.0,
            mask: !0,
            flags: 0,
            id: 0,
        }
    }
}

/// The answer to a ray; laid out as the C interface writes it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance in units of the direction's length; infinite for a miss.
    pub t: f32,
    /// The point is (1 - u - v) a + u b + v c.
    pub u: f32,
    pub v: f32,
    /// (b - a) x (c - a), not normalised.
    pub normal: [f32; 3],
    /// INVALID_ID for a miss.
    pub primitive_id: u32,
    pub geometry_id: u32,
    pub instance_id: u32,
}

const _: () = assert!(std::mem::size_of::<Ray>() == std::mem::size_of::<sys::kiwami_ray>());
const _: () = assert!(std::mem::size_of::<Hit>() == std::mem::size_of::<sys::kiwami_hit>());

impl Hit {
    pub const MISS: Self = Self {
        t: f32::INFINITY,
        u: 0.0,
        v: 0.0,
        normal: [0.0; 3],
        primitive_id: INVALID_ID,
        geometry_id: INVALID_ID,
        instance_id: INVALID_ID,
    };

    pub fn is_hit(&self) -> bool {
        self.primitive_id != INVALID_ID
    }
}
