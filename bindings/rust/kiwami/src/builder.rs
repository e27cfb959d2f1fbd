// SPDX-License-Identifier: Apache-2.0
use crate::callback::{run, USER_GEOMETRIES};
use crate::descriptor;
use crate::device::Device;
use crate::error::Error;
use crate::geometry::{Attached, Instance, MovingMesh};
use crate::progress::with_progress;
use crate::scene::{Object, Scene};
use crate::user_geometry::{self, UserGeometry};
use kiwami_sys as sys;
use std::ops::ControlFlow;
use std::ptr::null_mut;
use std::sync::atomic::Ordering;
use std::sync::Arc;

/// Named points of the pipeline that builds the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Quality {
    Balanced = sys::KIWAMI_QUALITY_BALANCED,
    Fast = sys::KIWAMI_QUALITY_FAST,
    Best = sys::KIWAMI_QUALITY_BEST,
}

/// How one of the library's functions makes a geometry.
type Create<T> = unsafe extern "C" fn(
    *mut sys::kiwami_device,
    *const T,
    *mut *mut sys::kiwami_geometry,
) -> i32;

/// A scene that is being put together. [`SceneBuilder::commit`] makes it one that can be traced.
pub struct SceneBuilder {
    pub(crate) object: Object,
}

impl SceneBuilder {
    pub fn new(device: &Device) -> Result<Self, Error> {
        let mut scene = null_mut();
        // SAFETY: the device lives.
        device.check(unsafe { sys::kiwami_scene_create(device.object, &mut scene) })?;
        Ok(Self { object: Object::new(device, scene) })
    }

    /// # Safety
    /// The descriptor's arrays must live, and hold what it says.
    unsafe fn create<T>(
        &self,
        create: Create<T>,
        desc: &T,
    ) -> Result<*mut sys::kiwami_geometry, Error> {
        let device = &self.object.device;
        let mut geometry = null_mut();
        device.check(create(device.object, desc, &mut geometry))?;
        Ok(geometry)
    }

    fn attach(&mut self, attached: Attached) -> Result<u32, Error> {
        let mut geometry_id = 0;
        // SAFETY: scene and geometry live.
        self.object.device.check(unsafe {
            sys::kiwami_scene_attach(self.object.scene, attached.geometry, &mut geometry_id)
        })?;
        self.object.attached.insert(geometry_id, attached);
        Ok(geometry_id)
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
        let desc = descriptor::mesh(vertices, triangles, mask);
        // SAFETY: the descriptor is made of slices that outlive the call, which copies them.
        let geometry = unsafe { self.create(sys::kiwami_triangle_mesh_create, &desc)? };
        self.attach(Attached::of_mesh(geometry, vertices.len()))
    }

    /// Adds a mesh that moves, copied; returns its number as of `add_mesh`, as do the calls below.
    pub fn add_moving_mesh(&mut self, mesh: &MovingMesh) -> Result<u32, Error> {
        let desc = descriptor::moving_mesh(mesh)?;
        // SAFETY: as above.
        let geometry = unsafe { self.create(sys::kiwami_moving_mesh_create, &desc)? };
        self.attach(Attached::new(geometry))
    }

    /// Adds spheres: x, y, z and radius. Only a ray with (ray.mask & mask) != 0 meets them.
    pub fn add_spheres(&mut self, points: &[[f32; 4]], mask: u32) -> Result<u32, Error> {
        let desc = descriptor::spheres(points, mask);
        // SAFETY: as above.
        let geometry = unsafe { self.create(sys::kiwami_spheres_create, &desc)? };
        self.attach(Attached::new(geometry))
    }

    /// Adds flat discs, as many points as normals.
    pub fn add_discs(
        &mut self,
        points: &[[f32; 4]],
        normals: &[[f32; 3]],
        mask: u32,
    ) -> Result<u32, Error> {
        let desc = descriptor::discs(points, normals, mask)?;
        // SAFETY: as above.
        let geometry = unsafe { self.create(sys::kiwami_discs_create, &desc)? };
        self.attach(Attached::new(geometry))
    }

    /// Adds round curve segments: segment i joins the points segments[i] and segments[i] + 1.
    pub fn add_curves(
        &mut self,
        points: &[[f32; 4]],
        segments: &[u32],
        mask: u32,
    ) -> Result<u32, Error> {
        let desc = descriptor::curves(points, segments, mask);
        // SAFETY: as above.
        let geometry = unsafe { self.create(sys::kiwami_curves_create, &desc)? };
        self.attach(Attached::new(geometry))
    }

    /// Adds instances of these scenes, which are held: to edit one, remove the instances first.
    pub fn add_instances(
        &mut self,
        scenes: &[Arc<Scene>],
        instances: &[Instance],
        mask: u32,
    ) -> Result<u32, Error> {
        let mut shown: Vec<_> = scenes.iter().map(|scene| scene.object.scene).collect();
        let desc = descriptor::instances(&mut shown, instances, mask);
        // SAFETY: as above.
        let geometry = unsafe { self.create(sys::kiwami_instances_create, &desc)? };
        self.attach(Attached::of_instances(geometry, scenes.to_vec()))
    }

    /// Adds count primitives of the caller's own kind, which are dropped when no scene uses them any
    /// more.
    pub fn add_user_geometry<T: UserGeometry + 'static>(
        &mut self,
        count: u64,
        primitives: T,
        mask: u32,
    ) -> Result<u32, Error> {
        let primitives = Box::into_raw(Box::new(primitives));
        let desc = user_geometry::descriptor(primitives, count, mask);
        // SAFETY: the geometry owns the primitives where it is made; else they are still our own.
        let made = unsafe { self.create(sys::kiwami_user_geometry_create, &desc) };
        let geometry = made.map_err(|error| {
            drop(unsafe { Box::from_raw(primitives) });
            error
        })?;
        USER_GEOMETRIES.fetch_add(1, Ordering::SeqCst);
        self.attach(Attached::new(geometry))
    }

    /// Gives a mesh other vertices, as many as it has.
    pub fn update_vertices(
        &mut self,
        geometry_id: u32,
        vertices: &[[f32; 3]],
    ) -> Result<(), Error> {
        let attached = self.object.attached.get(&geometry_id);
        let known = attached.and_then(|each| each.vertex_count.map(|count| (each, count)));
        let (attached, expected) = known.ok_or_else(|| {
            descriptor::invalid(format!("geometry_id is {geometry_id}, expected that of a mesh"))
        })?;
        if vertices.len() != expected {
            let found = vertices.len();
            return Err(descriptor::invalid(format!("{found} vertices, expected {expected}")));
        }
        // SAFETY: the geometry lives, and copies the vertices.
        self.object.device.check(unsafe {
            sys::kiwami_triangle_mesh_update_vertices(
                attached.geometry,
                vertices.as_ptr().cast(),
                0,
                0,
            )
        })
    }

    /// Leaves a geometry out, or takes it in again, under its number.
    pub fn enable(&mut self, geometry_id: u32, is_enabled: bool) -> Result<(), Error> {
        // SAFETY: the scene lives.
        self.object.device.check(unsafe {
            sys::kiwami_scene_enable(self.object.scene, geometry_id, is_enabled.into())
        })
    }

    /// Removes a geometry; its number becomes free.
    pub fn remove(&mut self, geometry_id: u32) -> Result<(), Error> {
        // SAFETY: the scene lives.
        let result = unsafe { sys::kiwami_scene_detach(self.object.scene, geometry_id) };
        self.object.device.check(result)?;
        self.object.attached.remove(&geometry_id);
        Ok(())
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
        let Object { device, scene, .. } = &self.object;
        // SAFETY: the scene lives, and nothing else can reach it.
        run(|| device.check(unsafe { sys::kiwami_scene_commit(*scene) }))?;
        Ok(Scene { object: self.object })
    }

    /// As `commit`, but keeps the tree where only vertices moved: quicker to make, and, the further
    /// they moved, slower to trace.
    pub fn refit(self) -> Result<Scene, Error> {
        let Object { device, scene, .. } = &self.object;
        // SAFETY: as above.
        run(|| device.check(unsafe { sys::kiwami_scene_refit(*scene) }))?;
        Ok(Scene { object: self.object })
    }

    /// As `commit`, and tells `progress` how far it is: a fraction from 0 to 1, which never falls,
    /// from any thread, never from two at a time. Where it breaks, the commit ends with
    /// `ErrorKind::Cancelled`; where it panics, with `ErrorKind::Callback` and the message.
    pub fn commit_with_progress<F>(self, progress: F) -> Result<Scene, Error>
    where
        F: FnMut(f64) -> ControlFlow<()> + Send,
    {
        let Object { device, scene, .. } = &self.object;
        // SAFETY: as above.
        unsafe {
            with_progress(*scene, progress, || {
                run(|| device.check(sys::kiwami_scene_commit(*scene)))
            })?;
        }
        Ok(Scene { object: self.object })
    }
}
