// SPDX-License-Identifier: Apache-2.0
use crate::device::Device;
use crate::error::Error;
use crate::progress::with_progress;
use crate::ray::{Hit, Ray};
use kiwami_sys as sys;
use std::ffi::CString;
use std::mem::{size_of, MaybeUninit};
use std::ops::ControlFlow;
use std::path::Path;
use std::ptr::{null, null_mut};

/// Named points of the pipeline that builds the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Quality {
    Balanced = sys::KIWAMI_QUALITY_BALANCED,
    Fast = sys::KIWAMI_QUALITY_FAST,
    Best = sys::KIWAMI_QUALITY_BEST,
}

/// One reference to a scene of the C interface.
struct Object {
    device: Device,
    scene: *mut sys::kiwami_scene,
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

/// A scene that is being put together. [`SceneBuilder::commit`] makes it one that can be traced.
pub struct SceneBuilder {
    object: Object,
}

impl SceneBuilder {
    pub fn new(device: &Device) -> Result<Self, Error> {
        let mut scene = null_mut();
        // SAFETY: the device lives.
        device.check(unsafe { sys::kiwami_scene_create(device.object, &mut scene) })?;
        Ok(Self { object: Object { device: device.clone(), scene } })
    }

    /// Adds a mesh, copied, and returns the number that hits report as geometry_id.
    pub fn add_mesh(
        &mut self,
        vertices: &[[f32; 3]],
        triangles: &[[u32; 3]],
    ) -> Result<u32, Error> {
        self.add_masked_mesh(vertices, triangles, !0)
    }

    /// The same; only a ray with (ray.mask & mask) != 0 meets it.
    pub fn add_masked_mesh(
        &mut self,
        vertices: &[[f32; 3]],
        triangles: &[[u32; 3]],
        mask: u32,
    ) -> Result<u32, Error> {
        let device = &self.object.device;
        let mut desc = MaybeUninit::<sys::kiwami_triangle_mesh_desc>::uninit();
        let mut geometry = null_mut();
        let mut geometry_id = 0;
        // SAFETY: the init function fills the descriptor; the slices outlive the call, which copies
        // them; the scene takes its own reference to the geometry.
        unsafe {
            device.check(sys::kiwami_triangle_mesh_desc_init(
                desc.as_mut_ptr(),
                size_of::<sys::kiwami_triangle_mesh_desc>(),
            ))?;
            let mut desc = desc.assume_init();
            desc.vertices = vertices.as_ptr().cast();
            desc.vertex_count = vertices.len() as u64;
            desc.indices = triangles.as_ptr().cast();
            desc.triangle_count = triangles.len() as u64;
            desc.mask = mask;
            device.check(sys::kiwami_triangle_mesh_create(device.object, &desc, &mut geometry))?;
            let result = sys::kiwami_scene_attach(self.object.scene, geometry, &mut geometry_id);
            let attached = device.check(result);
            sys::kiwami_geometry_release(geometry);
            attached?;
        }
        Ok(geometry_id)
    }

    /// Removes a mesh; its number becomes free.
    pub fn remove(&mut self, geometry_id: u32) -> Result<(), Error> {
        // SAFETY: the scene lives.
        let result = unsafe { sys::kiwami_scene_detach(self.object.scene, geometry_id) };
        self.object.device.check(result)
    }

    /// Sets one of `kiwami_sys::KIWAMI_PARAMETER_*`.
    pub fn set_parameter(&mut self, parameter: u32, value: f64) -> Result<(), Error> {
        // SAFETY: the scene lives.
        let result =
            unsafe { sys::kiwami_scene_set_parameter(self.object.scene, parameter, value) };
        self.object.device.check(result)
    }

    pub fn set_quality(&mut self, quality: Quality) -> Result<(), Error> {
        self.set_parameter(sys::KIWAMI_PARAMETER_QUALITY, f64::from(quality as u32))
    }

    /// Builds the acceleration structure. On error the builder is lost, and the error says why.
    pub fn commit(self) -> Result<Scene, Error> {
        // SAFETY: the scene lives, and nothing else can reach it.
        self.object.device.check(unsafe { sys::kiwami_scene_commit(self.object.scene) })?;
        Ok(Scene { object: self.object })
    }

    /// The same, and tells `progress` how far it is: a fraction from 0 to 1, which never falls, from
    /// any thread, never from two at a time. Where it breaks, the commit ends with
    /// `ErrorKind::Cancelled`; where it panics, with `ErrorKind::Callback` and the message.
    pub fn commit_with_progress<F>(self, progress: F) -> Result<Scene, Error>
    where
        F: FnMut(f64) -> ControlFlow<()> + Send,
    {
        let Object { device, scene } = &self.object;
        // SAFETY: the scene lives, and nothing else can reach it.
        unsafe {
            with_progress(*scene, progress, || device.check(sys::kiwami_scene_commit(*scene)))?;
        }
        Ok(Scene { object: self.object })
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
    object: Object,
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
        let mut desc = MaybeUninit::<sys::kiwami_save_desc>::uninit();
        // SAFETY: the init function fills the descriptor; path outlives the call.
        self.object.device.check(unsafe {
            sys::kiwami_save_desc_init(desc.as_mut_ptr(), size_of::<sys::kiwami_save_desc>());
            let mut desc = desc.assume_init();
            desc.path = path.as_ptr();
            sys::kiwami_scene_save(self.object.scene, &desc, null_mut())
        })
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
        let mut desc = MaybeUninit::<sys::kiwami_load_desc>::uninit();
        let mut scene = null_mut();
        device.check({
            sys::kiwami_load_desc_init(desc.as_mut_ptr(), size_of::<sys::kiwami_load_desc>());
            let mut desc = desc.assume_init();
            desc.path = path.as_ptr();
            desc.flags = flags;
            sys::kiwami_scene_load(device.object, &desc, &mut scene)
        })?;
        Ok(Self { object: Object { device: device.clone(), scene } })
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

    /// The closest hit of each ray.
    pub fn closest_hit(&self, rays: &[Ray]) -> Result<Vec<Hit>, Error> {
        let mut hits = vec![Hit::MISS; rays.len()];
        self.closest_hit_into(rays, &mut hits)?;
        Ok(hits)
    }

    /// The same, into hits, of which there must be as many as rays.
    pub fn closest_hit_into(&self, rays: &[Ray], hits: &mut [Hit]) -> Result<(), Error> {
        assert_eq!(rays.len(), hits.len(), "as many hits as rays");
        // SAFETY: Ray and Hit are laid out as the C structs; the counts are those of the slices.
        self.object.device.check(unsafe {
            sys::kiwami_closest_hit(
                self.object.scene,
                rays.as_ptr().cast(),
                0,
                hits.as_mut_ptr().cast(),
                0,
                rays.len(),
                null(),
            )
        })
    }

    /// Whether each ray has a hit.
    pub fn any_hit(&self, rays: &[Ray]) -> Result<Vec<bool>, Error> {
        let mut occluded = vec![false; rays.len()];
        // SAFETY: the library writes 0 or 1, which are the values of bool.
        self.object.device.check(unsafe {
            sys::kiwami_any_hit(
                self.object.scene,
                rays.as_ptr().cast(),
                0,
                occluded.as_mut_ptr().cast(),
                0,
                rays.len(),
                null(),
            )
        })?;
        Ok(occluded)
    }

    /// The nearest max_hits hits of each ray, by rising distance; 0 stands for all.
    pub fn multi_hit(&self, rays: &[Ray], max_hits: u32) -> Result<MultiHits, Error> {
        let mut found =
            MultiHits { offsets: vec![0; rays.len() + 1], hits: vec![Hit::MISS; rays.len()] };
        loop {
            // SAFETY: as above; hits has room for as many as it says.
            let result = unsafe {
                sys::kiwami_multi_hit(
                    self.object.scene,
                    rays.as_ptr().cast(),
                    0,
                    rays.len(),
                    max_hits,
                    found.hits.as_mut_ptr().cast(),
                    found.hits.len() as u64,
                    found.offsets.as_mut_ptr(),
                    null(),
                )
            };
            let is_complete = result != sys::KIWAMI_ERROR_CAPACITY;
            if is_complete {
                self.object.device.check(result)?;
            }
            found.hits.resize(found.offsets[rays.len()] as usize, Hit::MISS);
            if is_complete {
                return Ok(found);
            }
        }
    }

    /// How many hits each ray has.
    pub fn count_hits(&self, rays: &[Ray]) -> Result<Vec<u32>, Error> {
        let mut counts = vec![0; rays.len()];
        // SAFETY: as above.
        self.object.device.check(unsafe {
            sys::kiwami_count_hits(
                self.object.scene,
                rays.as_ptr().cast(),
                0,
                counts.as_mut_ptr(),
                0,
                rays.len(),
                null(),
            )
        })?;
        Ok(counts)
    }
}

/// A path for C, which ends at the first 0.
fn c_path(path: &Path) -> Result<CString, Error> {
    CString::new(path.to_string_lossy().as_bytes()).map_err(|_| {
        Error::new(
            sys::KIWAMI_ERROR_INVALID_ARGUMENT,
            format!("path is {path:?}, expected one without a 0 in it"),
        )
    })
}
