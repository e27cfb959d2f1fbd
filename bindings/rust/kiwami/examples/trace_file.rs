// SPDX-License-Identifier: Apache-2.0
//! See bindings/benchmark/trace_file.c.
use kiwami::{Device, Hit, Ray, Scene};
use std::path::Path;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let bytes = std::fs::read(&arguments[2])?;
    let mut rays = vec![Ray::new([0.0; 3], [0.0; 3]); bytes.len() / std::mem::size_of::<Ray>()];
    // SAFETY: every pattern of bits is a ray.
    unsafe {
        let target = rays.as_mut_ptr().cast::<u8>();
        std::ptr::copy_nonoverlapping(bytes.as_ptr(), target, std::mem::size_of_val(&rays[..]));
    }
    let device = Device::new()?;
    let flags = kiwami_sys::KIWAMI_LOAD_MAP | kiwami_sys::KIWAMI_LOAD_TRUSTED;
    // SAFETY: the library wrote the file, and nobody changes it.
    let scene = unsafe { Scene::load_with(&device, Path::new(&arguments[1]), flags)? };
    let mut hits = vec![Hit::MISS; rays.len()];
    for _ in 0..arguments[3].parse::<u32>()? {
        let began = Instant::now();
        scene.closest_hit_into(&rays, &mut hits)?;
        println!("{}", began.elapsed().as_secs_f64());
    }
    Ok(())
}
