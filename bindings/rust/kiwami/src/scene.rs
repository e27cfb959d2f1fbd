// SPDX-License-Identifier: Apache-2.0
use crate::builder::SceneBuilder;
use crate::descriptor::{defaults, invalid};
use crate::device::Device;
use crate::error::Error;
use crate::filter::{Answer, Candidate, Filtered};
use crate::geometry::Attached;
use crate::ray::{Hit, Ray};
use crate::trace::Trace;
use kiwami_sys as sys;
use std::collections::HashMap;
use std::ffi::CString;
use std::mem::{size_of, MaybeUninit};
use std::path::Path;
use std::ptr::{null, null_mut};

/// One reference to a scene of the C interface, and what is attached to it by number.
pub(crate) struct Object {
    pub(crate) device: Device,
    pub(crate) scene: *mut sys::kiwami_scene,
    pub(crate) attached: HashMap<u32, Attached>,
}

impl Object {
    /// Takes over the reference to the scene.
    pub(crate) fn new(device: &Device, scene: *mut sys::kiwami_scene) -> Self {
        Self { device: device.clone(), scene, attached: HashMap::new() }
    }
}

// SAFETY: scene.h: changes come from one thread at a time (they take &mut), traces of a committed
// scene from any.
unsafe impl Send for Object {}
unsafe impl Sync for Object {}

impl Drop for Object {
    fn drop(&mut self) {
        // SAFETY: this reference is self's own.
        unsafe { sys::kiwami_scene_release(self.scene) };
    }
}

/// The hits of many rays.
#[derive(Clone, Debug, Default)]
pub struct MultiHits {
    /// The hits of ray i are hits[offsets[i]] to hits[offsets[i + 1] - 1].
    pub offsets: Vec<u64>,
    pub hits: Vec<Hit>,
}

impl MultiHits {
    /// The hits of one ray, by rising distance.
    pub fn of(&self, ray: usize) -> &[Hit] {
        &self.hits[self.offsets[ray] as usize..self.offsets[ray + 1] as usize]
    }
}

/// A committed scene: it never changes, and any number of threads may trace it at once.
pub struct Scene {
    pub(crate) object: Object,
}

impl Scene {
    pub fn device(&self) -> &Device {
        &self.object.device
    }

    /// Changes are possible again; nothing can be traced until the next commit.
    pub fn edit(self) -> SceneBuilder {
        SceneBuilder { object: self.object }
    }

    /// Saves the scene; a file of that name stays whole until all is written.
    pub fn save(&self, path: &Path) -> Result<(), Error> {
        let path = c_path(path)?;
        let mut desc = defaults(sys::kiwami_save_desc_init);
        desc.path = path.as_ptr();
        // SAFETY: the scene lives, and path outlives the call.
        let result = unsafe { sys::kiwami_scene_save(self.object.scene, &desc, null_mut()) };
        self.object.device.check(result)
    }

    /// Loads a scene that `save` wrote, by copy, checking every byte.
    pub fn load(device: &Device, path: &Path) -> Result<Self, Error> {
        // SAFETY: nothing of the file is used after the call.
        unsafe { Self::load_with(device, path, 0) }
    }

    /// Loads with `kiwami_sys::KIWAMI_LOAD_*`.
    ///
    /// # Safety
    /// With MAP the file may not be changed or cut while the scene lives. With TRUSTED its bytes
    /// must be those that `save` wrote.
    pub unsafe fn load_with(device: &Device, path: &Path, flags: u32) -> Result<Self, Error> {
        let path = c_path(path)?;
        let mut desc = defaults(sys::kiwami_load_desc_init);
        let mut scene = null_mut();
        desc.path = path.as_ptr();
        desc.flags = flags;
        device.check(sys::kiwami_scene_load(device.object, &desc, &mut scene))?;
        Ok(Self { object: Object::new(device, scene) })
    }

    /// What the acceleration structure is made of.
    pub fn info(&self) -> Result<sys::kiwami_scene_info, Error> {
        // SAFETY: plain numbers, for which zeros are values.
        let mut info: sys::kiwami_scene_info = unsafe { MaybeUninit::zeroed().assume_init() };
        info.struct_size = size_of::<sys::kiwami_scene_info>() as u32;
        let result = unsafe { sys::kiwami_scene_get_info(self.object.scene, &mut info) };
        self.object.device.check(result)?;
        Ok(info)
    }

    pub(crate) fn trace(&self, query: *const sys::kiwami_query) -> Trace<'_> {
        Trace { device: &self.object.device, scene: self.object.scene, query }
    }

    /// The closest hit of each ray.
    pub fn closest_hit(&self, rays: &[Ray]) -> Result<Vec<Hit>, Error> {
        self.trace(null()).closest_hit(rays)
    }

    /// The same, into hits, of which there must be as many as rays.
    pub fn closest_hit_into(&self, rays: &[Ray], hits: &mut [Hit]) -> Result<(), Error> {
        self.trace(null()).closest_hit_into(rays, hits)
    }

    /// Whether each ray has a hit.
    pub fn any_hit(&self, rays: &[Ray]) -> Result<Vec<bool>, Error> {
        self.trace(null()).any_hit(rays)
    }

    /// The nearest max_hits hits of each ray, by rising distance; 0 stands for all.
    pub fn multi_hit(&self, rays: &[Ray], max_hits: u32) -> Result<MultiHits, Error> {
        self.trace(null()).multi_hit(rays, max_hits)
    }

    /// How many hits each ray has.
    pub fn count_hits(&self, rays: &[Ray]) -> Result<Vec<u32>, Error> {
        self.trace(null()).count_hits(rays)
    }

    /// The same calls, with a filter that decides which hits count. Several threads ask it at once.
    ///
    /// ```
    /// # fn shown(scene: &kiwami::Scene, rays: &[kiwami::Ray]) -> Result<(), kiwami::Error> {
    /// use kiwami::Answer;
    /// let even = scene.filtered(|candidate| match candidate.hit().primitive_id % 2 {
    ///     0 => Answer::Accept,
    ///     _ => Answer::Reject,
    /// });
    /// let hits = even.closest_hit(rays)?;
    /// # Ok(()) }
    /// ```
    pub fn filtered<F>(&self, filter: F) -> Filtered<'_, F>
    where
        F: Fn(&Candidate) -> Answer + Sync,
    {
        Filtered::new(self, filter)
    }
}

/// A path for C, which ends at the first 0.
fn c_path(path: &Path) -> Result<CString, Error> {
    CString::new(path.to_string_lossy().as_bytes())
        .map_err(|_| invalid(format!("path is {path:?}, expected one without a 0 in it")))
}
