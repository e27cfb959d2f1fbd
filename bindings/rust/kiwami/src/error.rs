// SPDX-License-Identifier: Apache-2.0
use kiwami_sys as sys;
use std::ffi::CStr;
use std::fmt;
use std::os::raw::c_char;

/// What went wrong, by the library's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ErrorKind {
    InvalidArgument,
    InvalidState,
    OutOfMemory,
    UnsupportedIsa,
    TooLarge,
    Callback,
    Validation,
    Internal,
    Capacity,
    InvalidFile,
    Io,
    Cancelled,
    /// A number that this crate does not know.
    Other,
}

/// An error of the library, with its sentence.
#[derive(Clone, Debug)]
pub struct Error {
    result: i32,
    sentence: String,
}

impl Error {
    /// One that this crate finds itself.
    pub(crate) fn new(result: i32, sentence: String) -> Self {
        Self { result, sentence }
    }

    pub fn kind(&self) -> ErrorKind {
        match self.result {
            sys::KIWAMI_ERROR_INVALID_ARGUMENT => ErrorKind::InvalidArgument,
            sys::KIWAMI_ERROR_INVALID_STATE => ErrorKind::InvalidState,
            sys::KIWAMI_ERROR_OUT_OF_MEMORY => ErrorKind::OutOfMemory,
            sys::KIWAMI_ERROR_UNSUPPORTED_ISA => ErrorKind::UnsupportedIsa,
            sys::KIWAMI_ERROR_TOO_LARGE => ErrorKind::TooLarge,
            sys::KIWAMI_ERROR_CALLBACK => ErrorKind::Callback,
            sys::KIWAMI_ERROR_VALIDATION => ErrorKind::Validation,
            sys::KIWAMI_ERROR_INTERNAL => ErrorKind::Internal,
            sys::KIWAMI_ERROR_CAPACITY => ErrorKind::Capacity,
            sys::KIWAMI_ERROR_INVALID_FILE => ErrorKind::InvalidFile,
            sys::KIWAMI_ERROR_IO => ErrorKind::Io,
            sys::KIWAMI_ERROR_CANCELLED => ErrorKind::Cancelled,
            _ => ErrorKind::Other,
        }
    }

    /// The number of the C interface.
    pub fn result(&self) -> i32 {
        self.result
    }
}

impl fmt::Display for Error {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.sentence)
    }
}

impl std::error::Error for Error {}

/// Turns a result into an error with the sentence of this thread's last error.
pub(crate) fn check(result: i32, device: *const sys::kiwami_device) -> Result<(), Error> {
    if result == sys::KIWAMI_OK {
        return Ok(());
    }
    let mut text = [0 as c_char; 1024];
    // SAFETY: the library writes at most text.len() bytes and ends them with 0.
    let sentence = unsafe {
        sys::kiwami_last_error(device, text.as_mut_ptr(), text.len());
        CStr::from_ptr(text.as_ptr()).to_string_lossy().into_owned()
    };
    Err(Error { result, sentence })
}
