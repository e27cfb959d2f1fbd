// SPDX-License-Identifier: Apache-2.0
//! A closure as the progress callback of a commit.
use crate::callback::{error_of, message_of};
use crate::error::Error;
use kiwami_sys as sys;
use std::ffi::c_void;
use std::ops::ControlFlow;
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::ptr::null_mut;

struct Report<F> {
    function: F,
    panic: Option<String>,
}

/// The library calls it from any of its threads, never by two at a time.
unsafe extern "C" fn report<F>(user: *mut c_void, fraction: f64) -> i32
where
    F: FnMut(f64) -> ControlFlow<()> + Send,
{
    // SAFETY: user is the Report of with_progress, which outlives the call that reports.
    let report = &mut *user.cast::<Report<F>>();
    if report.panic.is_some() {
        return 1;
    }
    match catch_unwind(AssertUnwindSafe(|| (report.function)(fraction))) {
        Ok(ControlFlow::Continue(())) => 0,
        Ok(ControlFlow::Break(())) => 1,
        Err(payload) => {
            report.panic = Some(message_of(payload));
            1
        }
    }
}

/// Runs `build` with the function told how far it is; its result is that of `build`, unless the
/// function panicked.
///
/// # Safety
/// The scene must live, and nothing else may reach it.
pub(crate) unsafe fn with_progress<F>(
    scene: *mut sys::kiwami_scene,
    function: F,
    build: impl FnOnce() -> Result<(), Error>,
) -> Result<(), Error>
where
    F: FnMut(f64) -> ControlFlow<()> + Send,
{
    let mut state = Report { function, panic: None };
    // Setting it fails for a NULL scene alone.
    let user: *mut Report<F> = &mut state;
    sys::kiwami_scene_set_progress(scene, Some(report::<F>), user.cast());
    let result = build();
    sys::kiwami_scene_set_progress(scene, None, null_mut());
    match state.panic {
        Some(message) => Err(error_of("progress function", &message)),
        None => result,
    }
}
