// SPDX-License-Identifier: Apache-2.0
//! Kiwami for Rust: ray tracing on CPUs, exact, the same to the bit everywhere, in batches.
//!
//! ```
//! # fn main() -> Result<(), kiwami::Error> {
//! let device = kiwami::Device::new()?;
//! let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
//! let mut builder = kiwami::SceneBuilder::new(&device)?;
//! builder.add_mesh(&vertices, &[[0, 1, 2]])?;
//! let scene = builder.commit()?;
//! let ray = kiwami::Ray::new([0.25, 0.25, -1.0], [0.0, 0.0, 1.0]);
//! let hits = scene.closest_hit(&[ray])?;
//! assert_eq!(hits[0].t, 1.0);
//! # Ok(()) }
//! ```
//!
//! A [`SceneBuilder`] may change and cannot be traced; a [`Scene`] is committed, never changes, and
//! can be traced from any number of threads.

mod builder;
mod callback;
mod descriptor;
mod device;
mod error;
mod filter;
mod geometry;
mod lights;
mod progress;
mod ray;
mod scene;
mod trace;
mod user_geometry;

pub use builder::{Quality, SceneBuilder};
pub use device::{Device, DeviceOptions, Isa};
pub use error::{Error, ErrorKind};
pub use filter::{Answer, Candidate, Filtered};
pub use geometry::{Instance, MovingMesh};
pub use lights::{Light, LightChoice, LightReceiver, LightTree};
pub use ray::{Hit, Ray, INVALID_ID};
pub use scene::{MultiHits, Scene};
pub use user_geometry::{Bounds, Intersection, UserGeometry, UserHit};
