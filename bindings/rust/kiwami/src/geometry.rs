// SPDX-License-Identifier: Apache-2.0
//! What scenes are made of, beside meshes at rest.
use crate::scene::Scene;
use kiwami_sys as sys;
use std::sync::Arc;

/// A mesh whose vertices move from step to step.
#[derive(Clone, Copy, Debug)]
pub struct MovingMesh<'a> {
    /// Those of all steps, one step after the other.
    pub vertices: &'a [[f32; 3]],
    pub step_count: u32,
    pub triangles: &'a [[u32; 3]],
    /// When the mesh is where its first step says.
    pub time_begin: f32,
    /// When the mesh is where its last step says.
    pub time_end: f32,
    /// Only a ray with (ray.mask & mask) != 0 meets it.
    pub mask: u32,
}

impl<'a> MovingMesh<'a> {
    /// From time 0 to 1, met by all rays.
    pub fn new(vertices: &'a [[f32; 3]], step_count: u32, triangles: &'a [[u32; 3]]) -> Self {
        Self { vertices, step_count, triangles, time_begin: 0.0, time_end: 1.0, mask: !0 }
    }
}

/// One of several scenes, shown at another place.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// The index of the scene that it shows.
    pub scene: u32,
    /// A ray enters only if (ray.mask & mask) != 0.
    pub mask: u32,
    /// Three rows of four: from the scene's space to the outer one.
    pub transform: [[f32; 4]; 3],
}

impl Instance {
    /// Of the first scene, entered by all rays.
    pub fn new(transform: [[f32; 4]; 3]) -> Self {
        Self { scene: 0, mask: !0, transform }
    }
}

/// A geometry that is attached to a scene, and what it refers to.
pub(crate) struct Attached {
    pub(crate) geometry: *mut sys::kiwami_geometry,
    /// Of a triangle mesh.
    pub(crate) vertex_count: Option<usize>,
    /// Commits read the scenes that instances show: while they are held here nobody can edit them.
    _shown: Vec<Arc<Scene>>,
}

impl Attached {
    /// Takes over the reference to the geometry.
    pub(crate) fn new(geometry: *mut sys::kiwami_geometry) -> Self {
        Self { geometry, vertex_count: None, _shown: Vec::new() }
    }

    pub(crate) fn of_mesh(geometry: *mut sys::kiwami_geometry, vertex_count: usize) -> Self {
        Self { geometry, vertex_count: Some(vertex_count), _shown: Vec::new() }
    }

    pub(crate) fn of_instances(
        geometry: *mut sys::kiwami_geometry,
        shown: Vec<Arc<Scene>>,
    ) -> Self {
        Self { geometry, vertex_count: None, _shown: shown }
    }
}

impl Drop for Attached {
    fn drop(&mut self) {
        // SAFETY: this reference is self's own.
        unsafe { sys::kiwami_geometry_release(self.geometry) };
    }
}
