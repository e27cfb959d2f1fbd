// SPDX-License-Identifier: Apache-2.0
//! Descriptors of the C interface, made of slices.
use crate::error::Error;
use crate::geometry::{Instance, MovingMesh};
use kiwami_sys as sys;
use std::mem::{size_of, MaybeUninit};

/// A descriptor with the library's defaults.
pub(crate) fn defaults<T>(init: unsafe extern "C" fn(*mut T, usize) -> i32) -> T {
    let mut desc = MaybeUninit::<T>::uninit();
    // SAFETY: the init function fills as many bytes as it is told; with those of its own struct it
    // cannot fail.
    unsafe {
        init(desc.as_mut_ptr(), size_of::<T>());
        desc.assume_init()
    }
}

/// An error of the caller's that the library could not see.
pub(crate) fn invalid(sentence: String) -> Error {
    Error::new(sys::KIWAMI_ERROR_INVALID_ARGUMENT, sentence)
}

pub(crate) fn mesh(
    vertices: &[[f32; 3]],
    triangles: &[[u32; 3]],
    mask: u32,
) -> sys::kiwami_triangle_mesh_desc {
    let mut desc = defaults(sys::kiwami_triangle_mesh_desc_init);
    desc.vertices = vertices.as_ptr().cast();
    desc.vertex_count = vertices.len() as u64;
    desc.indices = triangles.as_ptr().cast();
    desc.triangle_count = triangles.len() as u64;
    desc.mask = mask;
    desc
}

pub(crate) fn moving_mesh(given: &MovingMesh) -> Result<sys::kiwami_moving_mesh_desc, Error> {
    let mut desc = defaults(sys::kiwami_moving_mesh_desc_init);
    let steps = given.step_count as usize;
    let vertex_count = given.vertices.len().checked_div(steps).unwrap_or(0);
    if vertex_count * steps != given.vertices.len() {
        let found = given.vertices.len();
        return Err(invalid(format!("{found} vertices, expected a multiple of {steps} steps")));
    }
    desc.vertices = given.vertices.as_ptr().cast();
    desc.vertex_count = vertex_count as u64;
    desc.indices = given.triangles.as_ptr().cast();
    desc.triangle_count = given.triangles.len() as u64;
    desc.step_count = given.step_count;
    desc.time_begin = given.time_begin;
    desc.time_end = given.time_end;
    desc.mask = given.mask;
    Ok(desc)
}

pub(crate) fn spheres(points: &[[f32; 4]], mask: u32) -> sys::kiwami_spheres_desc {
    let mut desc = defaults(sys::kiwami_spheres_desc_init);
    desc.points = points.as_ptr().cast();
    desc.sphere_count = points.len() as u64;
    desc.mask = mask;
    desc
}

pub(crate) fn discs(
    points: &[[f32; 4]],
    normals: &[[f32; 3]],
    mask: u32,
) -> Result<sys::kiwami_discs_desc, Error> {
    if points.len() != normals.len() {
        return Err(invalid(format!("{} normals, expected {}", normals.len(), points.len())));
    }
    let mut desc = defaults(sys::kiwami_discs_desc_init);
    desc.points = points.as_ptr().cast();
    desc.normals = normals.as_ptr().cast();
    desc.disc_count = points.len() as u64;
    desc.mask = mask;
    Ok(desc)
}

pub(crate) fn curves(
    points: &[[f32; 4]],
    segments: &[u32],
    mask: u32,
) -> sys::kiwami_curves_desc {
    let mut desc = defaults(sys::kiwami_curves_desc_init);
    desc.points = points.as_ptr().cast();
    desc.point_count = points.len() as u64;
    desc.indices = segments.as_ptr().cast();
    desc.segment_count = segments.len() as u64;
    desc.mask = mask;
    desc
}

/// scenes must outlive the descriptor.
pub(crate) fn instances(
    scenes: &mut [*mut sys::kiwami_scene],
    instances: &[Instance],
    mask: u32,
) -> sys::kiwami_instances_desc {
    let mut desc = defaults(sys::kiwami_instances_desc_init);
    desc.scenes = scenes.as_mut_ptr();
    desc.scene_count = scenes.len() as u64;
    desc.count = instances.len() as u64;
    if let Some(first) = instances.first() {
        let stride = size_of::<Instance>() as u64;
        let whole = instances.as_ptr();
        // Addresses of the fields of the first, with the extent of the slice.
        let field = |address: *const u32| {
            let offset = address as usize - whole as usize;
            whole.cast::<u8>().wrapping_add(offset).cast()
        };
        desc.scene_indices = field(&first.scene);
        desc.scene_index_stride = stride;
        desc.masks = field(&first.mask);
        desc.mask_stride = stride;
        desc.transforms = field(first.transform.as_ptr().cast());
        desc.transform_stride = stride;
    }
    desc.mask = mask;
    desc
}
