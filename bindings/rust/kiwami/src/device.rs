// SPDX-License-Identifier: Apache-2.0
use crate::error::{check, Error};
use kiwami_sys as sys;
use std::mem::{size_of, MaybeUninit};
use std::ptr::{null, null_mut};

/// Instruction sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Isa {
    Auto = sys::KIWAMI_ISA_AUTO,
    Scalar = sys::KIWAMI_ISA_SCALAR,
    Sse = sys::KIWAMI_ISA_SSE,
    Avx2 = sys::KIWAMI_ISA_AVX2,
    Avx512 = sys::KIWAMI_ISA_AVX512,
}

/// How a device is to be made.
#[derive(Clone, Copy, Debug)]
pub struct DeviceOptions {
    pub isa: Isa,
    /// Threads that builds and batches use at once; 0: one per processor.
    pub thread_count: u32,
    /// Check the arguments of the trace calls in the library too.
    pub validate: bool,
}

impl Default for DeviceOptions {
    fn default() -> Self {
        Self { isa: Isa::Auto, thread_count: 0, validate: false }
    }
}

/// Kernels of one instruction set and the threads that run them. Clones name the same device.
pub struct Device {
    pub(crate) object: *mut sys::kiwami_device,
}

// SAFETY: device.h: all calls on a device may come from any thread.
unsafe impl Send for Device {}
unsafe impl Sync for Device {}

impl Device {
    /// The best kernels of this machine on all its processors.
    pub fn new() -> Result<Self, Error> {
        Self::with_options(DeviceOptions::default())
    }

    pub fn with_options(options: DeviceOptions) -> Result<Self, Error> {
        let mut desc = MaybeUninit::<sys::kiwami_device_desc>::uninit();
        let mut object = null_mut();
        // SAFETY: the init function fills the whole descriptor.
        unsafe {
            check(
                sys::kiwami_device_desc_init(desc.as_mut_ptr(), size_of::<sys::kiwami_device_desc>()),
                null(),
            )?;
            let mut desc = desc.assume_init();
            desc.isa = options.isa as u32;
            desc.thread_count = options.thread_count;
            desc.flags = if options.validate { sys::KIWAMI_DEVICE_VALIDATE } else { 0 };
            check(sys::kiwami_device_create(&desc, &mut object), null())?;
        }
        Ok(Self { object })
    }

    fn info(&self) -> sys::kiwami_device_info {
        let mut info: sys::kiwami_device_info = unsafe { MaybeUninit::zeroed().assume_init() };
        info.struct_size = size_of::<sys::kiwami_device_info>() as u32;
        // SAFETY: the device lives, and info says how large it is; then the call cannot fail.
        unsafe { sys::kiwami_device_get_info(self.object, &mut info) };
        info
    }

    /// The instruction set whose kernels this device runs.
    pub fn isa(&self) -> Isa {
        match self.info().isa {
            sys::KIWAMI_ISA_SSE => Isa::Sse,
            sys::KIWAMI_ISA_AVX2 => Isa::Avx2,
            sys::KIWAMI_ISA_AVX512 => Isa::Avx512,
            _ => Isa::Scalar,
        }
    }

    /// Threads that builds and batches use at once.
    pub fn thread_count(&self) -> u32 {
        self.info().thread_count
    }

    pub(crate) fn check(&self, result: i32) -> Result<(), Error> {
        check(result, self.object)
    }
}

impl Clone for Device {
    fn clone(&self) -> Self {
        // SAFETY: the device lives as long as self.
        unsafe { sys::kiwami_device_retain(self.object) };
        Self { object: self.object }
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: this reference is self's own.
        unsafe { sys::kiwami_device_release(self.object) };
    }
}
