// SPDX-License-Identifier: Apache-2.0
//! Batches of rays on their way through the library.
use crate::callback::run;
use crate::device::Device;
use crate::error::Error;
use crate::ray::{Hit, Ray};
use crate::scene::MultiHits;
use kiwami_sys as sys;

/// A committed scene and what its trace calls are told beyond the rays.
pub(crate) struct Trace<'a> {
    pub(crate) device: &'a Device,
    pub(crate) scene: *mut sys::kiwami_scene,
    /// May be null.
    pub(crate) query: *const sys::kiwami_query,
}

impl Trace<'_> {
    pub(crate) fn closest_hit(&self, rays: &[Ray]) -> Result<Vec<Hit>, Error> {
        let mut hits = vec![Hit::MISS; rays.len()];
        self.closest_hit_into(rays, &mut hits)?;
        Ok(hits)
    }

    pub(crate) fn closest_hit_into(&self, rays: &[Ray], hits: &mut [Hit]) -> Result<(), Error> {
        assert_eq!(rays.len(), hits.len(), "as many hits as rays");
        // SAFETY: Ray and Hit are laid out as the C structs; the counts are those of the slices.
        run(|| {
            self.device.check(unsafe {
                sys::kiwami_closest_hit(
                    self.scene,
                    rays.as_ptr().cast(),
                    0,
                    hits.as_mut_ptr().cast(),
                    0,
                    rays.len(),
                    self.query,
                )
            })
        })
    }

    pub(crate) fn any_hit(&self, rays: &[Ray]) -> Result<Vec<bool>, Error> {
        let mut occluded = vec![false; rays.len()];
        // SAFETY: the library writes 0 or 1, which are the values of bool.
        run(|| {
            self.device.check(unsafe {
                sys::kiwami_any_hit(
                    self.scene,
                    rays.as_ptr().cast(),
                    0,
                    occluded.as_mut_ptr().cast(),
                    0,
                    rays.len(),
                    self.query,
                )
            })
        })?;
        Ok(occluded)
    }

    pub(crate) fn multi_hit(&self, rays: &[Ray], max_hits: u32) -> Result<MultiHits, Error> {
        let mut found =
            MultiHits { offsets: vec![0; rays.len() + 1], hits: vec![Hit::MISS; rays.len()] };
        loop {
            let mut is_complete = true;
            // SAFETY: as above; hits has room for as many as it says.
            run(|| {
                let result = unsafe {
                    sys::kiwami_multi_hit(
                        self.scene,
                        rays.as_ptr().cast(),
                        0,
                        rays.len(),
                        max_hits,
                        found.hits.as_mut_ptr().cast(),
                        found.hits.len() as u64,
                        found.offsets.as_mut_ptr(),
                        self.query,
                    )
                };
                is_complete = result != sys::KIWAMI_ERROR_CAPACITY;
                if is_complete { self.device.check(result) } else { Ok(()) }
            })?;
            found.hits.resize(found.offsets[rays.len()] as usize, Hit::MISS);
            if is_complete {
                return Ok(found);
            }
        }
    }

    pub(crate) fn count_hits(&self, rays: &[Ray]) -> Result<Vec<u32>, Error> {
        let mut counts = vec![0; rays.len()];
        // SAFETY: as above.
        run(|| {
            self.device.check(unsafe {
                sys::kiwami_count_hits(
                    self.scene,
                    rays.as_ptr().cast(),
                    0,
                    counts.as_mut_ptr(),
                    0,
                    rays.len(),
                    self.query,
                )
            })
        })?;
        Ok(counts)
    }
}
