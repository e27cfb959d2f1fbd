// SPDX-License-Identifier: Apache-2.0
//! A closure as the filter of trace calls.
use crate::callback::{error_of, message_of};
use crate::descriptor::defaults;
use crate::error::Error;
use crate::ray::{Hit, Ray};
use crate::scene::{MultiHits, Scene};
use crate::trace::Trace;
use kiwami_sys as sys;
use std::ffi::c_void;
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::sync::Mutex;

/// What a filter is asked about: a hit that tmin, tmax, masks and sides leave.
pub struct Candidate<'a>(&'a sys::kiwami_filter_candidate);

impl Candidate<'_> {
    /// The number of the ray in the call.
    pub fn ray(&self) -> usize {
        self.0.ray as usize
    }

    pub fn hit(&self) -> &Hit {
        // SAFETY: Hit is laid out as kiwami_hit.
        unsafe { &*(&self.0.hit as *const sys::kiwami_hit).cast() }
    }

    /// The numbers of the instances that lead to the hit, the outermost first.
    pub fn instance_path(&self) -> &[u32] {
        &self.0.instance_path[..self.0.depth as usize]
    }
}

/// What a filter says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// The hit is none.
    Reject,
    Accept,
    /// Nothing more is looked for along this ray.
    AcceptAndStop,
}

/// A scene whose hits must pass a filter; [`Scene::filtered`] makes it. Where the filter panics, the
/// call ends with `ErrorKind::Callback` and the message.
pub struct Filtered<'a, F> {
    scene: &'a Scene,
    filter: F,
}

struct Running<'a, F> {
    filter: &'a F,
    panic: Mutex<Option<String>>,
}

unsafe extern "C" fn decide<F>(
    user: *mut c_void,
    candidate: *const sys::kiwami_filter_candidate,
) -> i32
where
    F: Fn(&Candidate) -> Answer + Sync,
{
    // SAFETY: user is the Running of with_query, which outlives the call that filters; the candidate
    // lives until this function returns, and no reference to it leaves the filter.
    let running = &*user.cast::<Running<F>>();
    match catch_unwind(AssertUnwindSafe(|| (running.filter)(&Candidate(&*candidate)))) {
        Ok(Answer::Reject) => sys::KIWAMI_FILTER_REJECT as i32,
        Ok(Answer::Accept) => sys::KIWAMI_FILTER_ACCEPT as i32,
        Ok(Answer::AcceptAndStop) => sys::KIWAMI_FILTER_ACCEPT_AND_STOP as i32,
        Err(payload) => {
            let message = message_of(payload);
            if let Ok(mut panic) = running.panic.lock() {
                panic.get_or_insert(message);
            }
            -1
        }
    }
}

impl<'a, F> Filtered<'a, F>
where
    F: Fn(&Candidate) -> Answer + Sync,
{
    pub(crate) fn new(scene: &'a Scene, filter: F) -> Self {
        Self { scene, filter }
    }

    fn with_query<T>(&self, call: impl FnOnce(Trace) -> Result<T, Error>) -> Result<T, Error> {
        let running = Running { filter: &self.filter, panic: Mutex::new(None) };
        let mut query = defaults(sys::kiwami_query_init);
        query.filter = Some(decide::<F>);
        query.filter_user = (&running as *const Running<F> as *mut Running<F>).cast();
        let result = call(self.scene.trace(&query));
        match running.panic.into_inner() {
            Ok(Some(message)) => Err(error_of("filter", &message)),
            _ => result,
        }
    }

    /// See [`Scene::closest_hit`].
    pub fn closest_hit(&self, rays: &[Ray]) -> Result<Vec<Hit>, Error> {
        self.with_query(|trace| trace.closest_hit(rays))
    }

    /// See [`Scene::closest_hit_into`].
    pub fn closest_hit_into(&self, rays: &[Ray], hits: &mut [Hit]) -> Result<(), Error> {
        self.with_query(|trace| trace.closest_hit_into(rays, hits))
    }

    /// See [`Scene::any_hit`].
    pub fn any_hit(&self, rays: &[Ray]) -> Result<Vec<bool>, Error> {
        self.with_query(|trace| trace.any_hit(rays))
    }

    /// See [`Scene::multi_hit`].
    pub fn multi_hit(&self, rays: &[Ray], max_hits: u32) -> Result<MultiHits, Error> {
        self.with_query(|trace| trace.multi_hit(rays, max_hits))
    }

    /// See [`Scene::count_hits`].
    pub fn count_hits(&self, rays: &[Ray]) -> Result<Vec<u32>, Error> {
        self.with_query(|trace| trace.count_hits(rays))
    }
}
