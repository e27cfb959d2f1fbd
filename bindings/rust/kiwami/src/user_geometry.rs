// SPDX-License-Identifier: Apache-2.0
//! Primitives of the caller's own kind.
use crate::callback::{keep, message_of, USER_GEOMETRIES};
use crate::descriptor::defaults;
use crate::ray::Ray;
use kiwami_sys as sys;
use std::ffi::c_void;
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::slice;
use std::sync::atomic::Ordering;

/// A box around a primitive.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    pub lower: [f32; 3],
    pub upper: [f32; 3],
}

impl Bounds {
    /// Of a primitive that is never hit.
    pub const NONE: Self = Self { lower: [f32::INFINITY; 3], upper: [f32::NEG_INFINITY; 3] };
}

/// A point where a ray meets a primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UserHit {
    pub t: f32,
    /// Whatever the primitives' kind makes of them.
    pub u: f32,
    pub v: f32,
    /// Outward; need not have length 1.
    pub normal: [f32; 3],
    /// One of those that were asked for.
    pub primitive_id: u32,
}

/// One ray and the primitives that it may meet.
pub struct Intersection<'a> {
    asked: &'a mut sys::kiwami_user_intersection,
}

impl Intersection<'_> {
    /// In the geometry's space; its tmax may be nearer than the traced ray's.
    pub fn ray(&self) -> &Ray {
        // SAFETY: the ray lives until the callback returns; Ray is laid out as kiwami_ray.
        unsafe { &*self.asked.ray.cast() }
    }

    pub fn geometry_id(&self) -> u32 {
        self.asked.geometry_id
    }

    pub fn primitive_ids(&self) -> &[u32] {
        // SAFETY: the library says how many there are.
        unsafe {
            slice::from_raw_parts(self.asked.primitive_ids, self.asked.primitive_count as usize)
        }
    }

    /// Adds a hit of one of the primitives, of which each has at most four. Where ray.tmin <= t <=
    /// ray.tmax does not hold it is ignored.
    ///
    /// # Panics
    /// Where there are more than four a primitive.
    pub fn add(&mut self, hit: UserHit) {
        assert!(self.asked.hit_count < self.asked.hit_capacity, "more than four hits a primitive");
        let [normal_x, normal_y, normal_z] = hit.normal;
        // SAFETY: there is room for hit_capacity of them.
        unsafe {
            self.asked.hits.add(self.asked.hit_count as usize).write(sys::kiwami_user_hit {
                t: hit.t,
                u: hit.u,
                v: hit.v,
                normal_x,
                normal_y,
                normal_z,
                primitive_id: hit.primitive_id,
                reserved: 0,
            });
        }
        self.asked.hit_count += 1;
    }
}

/// Primitives that know their boxes and their hits. Several threads ask them at once. Where they
/// panic, the commit or the trace call ends with `ErrorKind::Callback` and the message.
pub trait UserGeometry: Send + Sync {
    /// Writes a box for each of the primitives from first on.
    fn bounds(&self, first: u32, bounds: &mut [Bounds]);

    /// Adds the hits of a ray. Those of a primitive must depend on the ray and the primitive alone,
    /// and lie in its box.
    fn intersect(&self, intersection: &mut Intersection<'_>);
}

fn guard(body: impl FnOnce()) -> i32 {
    match catch_unwind(AssertUnwindSafe(body)) {
        Ok(()) => 0,
        Err(payload) => {
            keep(message_of(payload));
            -1
        }
    }
}

unsafe extern "C" fn bounds<T: UserGeometry>(
    user: *mut c_void,
    first: u32,
    count: u32,
    bounds: *mut f32,
) -> i32 {
    // SAFETY: user is the T of descriptor(), which lives until destroy(). The boxes are written
    // before a slice of them is made.
    let bounds = bounds.cast::<Bounds>();
    for i in 0..count as usize {
        bounds.add(i).write(Bounds::NONE);
    }
    let bounds = slice::from_raw_parts_mut(bounds, count as usize);
    guard(|| (*user.cast::<T>()).bounds(first, bounds))
}

unsafe extern "C" fn intersect<T: UserGeometry>(
    user: *mut c_void,
    asked: *mut sys::kiwami_user_intersection,
) -> i32 {
    // SAFETY: as above; the library hands asked to this call alone.
    guard(|| (*user.cast::<T>()).intersect(&mut Intersection { asked: &mut *asked }))
}

unsafe extern "C" fn destroy<T: UserGeometry>(user: *mut c_void) {
    // SAFETY: the library calls it once, when nothing uses the geometry any more. A panic has no
    // call to end.
    let _ = catch_unwind(AssertUnwindSafe(|| drop(Box::from_raw(user.cast::<T>()))));
    USER_GEOMETRIES.fetch_sub(1, Ordering::SeqCst);
}

/// A descriptor that owns the primitives from the moment on when a geometry is made of it.
pub(crate) fn descriptor<T: UserGeometry>(
    primitives: *mut T,
    count: u64,
    mask: u32,
) -> sys::kiwami_user_geometry_desc {
    let mut desc = defaults(sys::kiwami_user_geometry_desc_init);
    desc.count = count;
    desc.bounds = Some(bounds::<T>);
    desc.intersect = Some(intersect::<T>);
    desc.destroy = Some(destroy::<T>);
    desc.user = primitives.cast();
    desc.mask = mask;
    desc
}
