// SPDX-License-Identifier: Apache-2.0
//! What panics in functions that the library calls back. A panic may not cross C: its message is
//! kept, and becomes an error of the call.
use crate::error::{Error, ErrorKind};
use kiwami_sys as sys;
use std::any::Any;
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard};

/// An error that says what panicked, and why.
pub(crate) fn error_of(what: &str, message: &str) -> Error {
    Error::new(sys::KIWAMI_ERROR_CALLBACK, format!("the {what} panicked: {message}"))
}

/// The message of a panic. Its payload ends here; what that panics with is ignored.
pub(crate) fn message_of(payload: Box<dyn Any + Send>) -> String {
    let text = payload
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| payload.downcast_ref::<String>().map(String::as_str));
    let message = text.unwrap_or("no message").to_string();
    let _ = catch_unwind(AssertUnwindSafe(|| drop(payload)));
    message
}

/// Messages of user geometries. The library does not say for which call they run, so a message is
/// kept for all calls that do: one that fails has the first since it began.
struct Panics {
    running: usize,
    clock: u64,
    last_begin: u64,
    kept: Vec<(u64, String)>,
}

static PANICS: Mutex<Panics> =
    Mutex::new(Panics { running: 0, clock: 0, last_begin: 0, kept: Vec::new() });

fn panics() -> MutexGuard<'static, Panics> {
    PANICS.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

/// Keeps the message of a user geometry's panic for the calls that run.
pub(crate) fn keep(message: String) {
    let mut panics = panics();
    if panics.kept.last().map_or(true, |(when, _)| *when < panics.last_begin) {
        panics.clock += 1;
        let now = panics.clock;
        panics.kept.push((now, message));
    }
}

/// A call that may run the functions of user geometries.
struct Running {
    begin: u64,
}

impl Running {
    fn new() -> Self {
        let mut panics = panics();
        panics.running += 1;
        panics.clock += 1;
        panics.last_begin = panics.clock;
        Self { begin: panics.clock }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let mut panics = panics();
        panics.running -= 1;
        if panics.running == 0 {
            panics.kept.clear();
        }
    }
}

/// How many user geometries live; without any no call need be counted.
pub(crate) static USER_GEOMETRIES: AtomicUsize = AtomicUsize::new(0);

/// Runs a call of the library; where it fails because a user geometry panicked, the error says so.
pub(crate) fn run(call: impl FnOnce() -> Result<(), Error>) -> Result<(), Error> {
    if USER_GEOMETRIES.load(Ordering::SeqCst) == 0 {
        return call();
    }
    let running = Running::new();
    call().map_err(|error| {
        if error.kind() != ErrorKind::Callback {
            return error; // it has another reason
        }
        let panics = panics();
        let kept = panics.kept.iter().find(|(when, _)| *when > running.begin);
        kept.map_or(error, |(_, message)| error_of("user geometry", message))
    })
}
