// SPDX-License-Identifier: Apache-2.0
//! Many lights: which of them a point should ask.
use crate::descriptor::{defaults, invalid};
use crate::device::Device;
use crate::error::Error;
use crate::ray::INVALID_ID;
use kiwami_sys as sys;
use std::mem::size_of;
use std::ptr::{null, null_mut};

/// A light; laid out as the C interface reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// `kiwami_sys::KIWAMI_LIGHT_*`: point, spot, triangle, ...
    pub kind: u32,
    /// `kiwami_sys::KIWAMI_LIGHT_TWO_SIDED`
    pub flags: u32,
    pub points: [[f32; 3]; 4],
    pub direction: [f32; 3],
    pub radius: f32,
    pub cos_inner: f32,
    pub cos_outer: f32,
    /// What it emits in all: only ratios count.
    pub power: f32,
    /// The caller's own; copied to the choices.
    pub user_id: u32,
    /// Lights a receiver only if (link_mask & receiver.link_mask) != 0.
    pub link_mask: u64,
}

impl Light {
    /// A point that shines in all directions, on every receiver.
    pub fn point(at: [f32; 3], power: f32) -> Self {
        Self {
            kind: sys::KIWAMI_LIGHT_POINT,
            flags: 0,
            points: [at, [0.0; 3], [0.0; 3], [0.0; 3]],
            direction: [0.0; 3],
            radius: 0.0,
            cos_inner: 0.0,
            cos_outer: 0.0,
            power,
            user_id: 0,
            link_mask: !0,
        }
    }
}

/// Who asks for a light: a point with a normal, a point without, or a segment.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightReceiver {
    pub position: [f32; 3],
    /// 0, 0, 0: none.
    pub normal: [f32; 3],
    /// From the position to the other end; 0, 0, 0: a point.
    pub segment: [f32; 3],
    /// `kiwami_sys::KIWAMI_RECEIVER_*`
    pub flags: u32,
    pub link_mask: u64,
    /// At least 0, below 1.
    pub random: f64,
}

impl LightReceiver {
    /// A point that every light may reach.
    pub fn new(position: [f32; 3], normal: [f32; 3], random: f64) -> Self {
        Self { position, normal, segment: [0.0; 3], flags: 0, link_mask: !0, random }
    }
}

/// A light that was chosen.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightChoice {
    /// INVALID_ID: none.
    pub light_id: u32,
    /// The instance through which it is seen; INVALID_ID: none.
    pub instance_id: u32,
    pub user_id: u32,
    /// With which this choice was made.
    pub probability: f32,
    /// A new random number, for a point on the light.
    pub random: f64,
}

impl LightChoice {
    pub const NONE: Self = Self {
        light_id: INVALID_ID,
        instance_id: INVALID_ID,
        user_id: 0,
        probability: 0.0,
        random: 0.0,
    };
}

const _: () = assert!(size_of::<Light>() == size_of::<sys::kiwami_light>());
const _: () = assert!(size_of::<LightReceiver>() == size_of::<sys::kiwami_light_receiver>());
const _: () = assert!(size_of::<LightChoice>() == size_of::<sys::kiwami_light_choice>());

/// Lights, among which points choose in proportion to what may reach them. Changes take effect with
/// [`LightTree::commit`].
pub struct LightTree {
    device: Device,
    tree: *mut sys::kiwami_light_tree,
}

// SAFETY: light.h: changes come from one thread at a time (they take &mut), samples of a committed
// tree from any.
unsafe impl Send for LightTree {}
unsafe impl Sync for LightTree {}

impl Drop for LightTree {
    fn drop(&mut self) {
        // SAFETY: this reference is self's own.
        unsafe { sys::kiwami_light_tree_release(self.tree) };
    }
}

impl LightTree {
    pub fn new(device: &Device) -> Result<Self, Error> {
        Self::with_width(device, 0)
    }

    /// With nodes of 2, 4, 8 or 16 children; 0: the device's default.
    pub fn with_width(device: &Device, width: u32) -> Result<Self, Error> {
        let mut desc = defaults(sys::kiwami_light_tree_desc_init);
        desc.width = width;
        let mut tree = null_mut();
        // SAFETY: the device lives.
        let result =
            unsafe { sys::kiwami_light_tree_create(device.object, &desc, &mut tree) };
        device.check(result)?;
        Ok(Self { device: device.clone(), tree })
    }

    /// Adds lights; returns the number of the first.
    pub fn add_lights(&mut self, lights: &[Light]) -> Result<u32, Error> {
        let mut first = 0;
        // SAFETY: Light is laid out as kiwami_light; the library copies the slice.
        self.device.check(unsafe {
            sys::kiwami_light_tree_add_lights(
                self.tree,
                lights.as_ptr().cast(),
                0,
                lights.len(),
                &mut first,
            )
        })?;
        Ok(first)
    }

    /// Makes a light of each triangle; returns the number of the first.
    pub fn add_mesh(
        &mut self,
        vertices: &[[f32; 3]],
        triangles: &[[u32; 3]],
        radiance: f32,
        is_two_sided: bool,
    ) -> Result<u32, Error> {
        let mut desc = defaults(sys::kiwami_light_mesh_desc_init);
        desc.flags = if is_two_sided { sys::KIWAMI_LIGHT_TWO_SIDED } else { 0 };
        desc.vertices = vertices.as_ptr().cast();
        desc.vertex_count = vertices.len() as u64;
        desc.indices = triangles.as_ptr().cast();
        desc.triangle_count = triangles.len() as u64;
        desc.radiance = radiance;
        let mut first = 0;
        // SAFETY: the library reads the slices during the call alone.
        self.device
            .check(unsafe { sys::kiwami_light_tree_add_mesh(self.tree, &desc, &mut first) })?;
        Ok(first)
    }

    /// Gives the lights from first on other powers.
    pub fn set_powers(&mut self, first: u32, powers: &[f32]) -> Result<(), Error> {
        // SAFETY: the library copies the slice.
        self.device.check(unsafe {
            sys::kiwami_light_tree_set_powers(self.tree, first, powers.as_ptr(), 0, powers.len())
        })
    }

    /// Builds the tree over all lights.
    pub fn commit(&mut self) -> Result<(), Error> {
        // SAFETY: the tree lives, and nothing else can reach it.
        self.device.check(unsafe { sys::kiwami_light_tree_commit(self.tree) })
    }

    /// As `commit`, but keeps the shape of the tree.
    pub fn refit(&mut self) -> Result<(), Error> {
        // SAFETY: as above.
        self.device.check(unsafe { sys::kiwami_light_tree_refit(self.tree) })
    }

    /// Lets each receiver choose a light.
    pub fn sample(&self, receivers: &[LightReceiver]) -> Result<Vec<LightChoice>, Error> {
        let mut choices = vec![LightChoice::NONE; receivers.len()];
        // SAFETY: the structs are laid out as those of C; there are as many choices as receivers.
        self.device.check(unsafe {
            sys::kiwami_light_sample(
                self.tree,
                receivers.as_ptr().cast(),
                0,
                choices.as_mut_ptr().cast(),
                0,
                receivers.len(),
                null(),
            )
        })?;
        Ok(choices)
    }

    /// The probability with which each receiver chooses the light of the choice beside it.
    pub fn pdf(
        &self,
        receivers: &[LightReceiver],
        lights: &[LightChoice],
    ) -> Result<Vec<f32>, Error> {
        if lights.len() != receivers.len() {
            let (found, expected) = (lights.len(), receivers.len());
            return Err(invalid(format!("there are {found} lights, expected {expected}")));
        }
        let mut probabilities = vec![0.0; receivers.len()];
        // SAFETY: as above; a choice begins with the name of its light.
        self.device.check(unsafe {
            sys::kiwami_light_pdf(
                self.tree,
                receivers.as_ptr().cast(),
                0,
                lights.as_ptr().cast(),
                size_of::<LightChoice>(),
                probabilities.as_mut_ptr(),
                0,
                receivers.len(),
                null(),
            )
        })?;
        Ok(probabilities)
    }
}
