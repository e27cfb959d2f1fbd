// SPDX-License-Identifier: Apache-2.0
use kiwami::{Device, SceneBuilder};
use std::io::Write;

/// Notes that a feature was found right, for the table of the documents.
pub fn note(feature: &str) {
    if let Ok(path) = std::env::var("KIWAMI_FEATURES") {
        let mut file = std::fs::OpenOptions::new().create(true).append(true).open(path).unwrap();
        writeln!(file, "{feature}").unwrap();
    }
}

pub const CORNERS: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

#[allow(dead_code)] // not every test that includes this file needs it
pub fn one_triangle(device: &Device) -> SceneBuilder {
    let mut builder = SceneBuilder::new(device).unwrap();
    builder.add_mesh(&CORNERS, &[[0, 1, 2]]).unwrap();
    builder
}
