// SPDX-License-Identifier: Apache-2.0
//! Sets of lights against the answers that every binding must give.
mod common;

use common::{note, CORNERS};
use kiwami::{
    Device, DeviceOptions, ErrorKind, Isa, Light, LightChoice, LightReceiver, LightTree,
    INVALID_ID,
};
use std::mem::{size_of, transmute_copy};

struct Words<'a>(std::str::SplitAsciiWhitespace<'a>);

impl<'a> Words<'a> {
    fn int(&mut self) -> u32 {
        self.0.next().expect("the vectors end too soon").parse().expect("a number")
    }
    fn floats(&mut self, count: u32) -> Vec<f32> {
        (0..count).map(|_| f32::from_bits(self.int())).collect()
    }
    /// Records of words; every pattern of bits must be a value of T.
    fn records<T: Copy, const N: usize>(&mut self, count: u32) -> Vec<T> {
        assert_eq!(size_of::<T>(), 4 * N);
        (0..count)
            .map(|_| {
                let words: [u32; N] = std::array::from_fn(|_| self.int());
                // SAFETY: T has this size, and numbers alone in it.
                unsafe { transmute_copy(&words) }
            })
            .collect()
    }
}

/// Plays a set of lights; returns how many choices were compared.
fn play(words: &mut Words, device: &Device) -> usize {
    let mut lights = LightTree::with_width(device, words.int()).unwrap();
    let (mut receivers, mut choices) = (Vec::<LightReceiver>::new(), Vec::new());
    let mut compared = 0;
    loop {
        match words.0.next().unwrap() {
            "light" => {
                let count = words.int();
                lights.add_lights(&words.records::<Light, 24>(count)).unwrap();
            }
            "light_mesh" => {
                let is_two_sided = words.int() != 0;
                let radiance = f32::from_bits(words.int());
                let (vertex_count, triangle_count) = (words.int(), words.int());
                let vertices = words.records::<[f32; 3], 3>(vertex_count);
                let triangles = words.records::<[u32; 3], 3>(triangle_count);
                lights.add_mesh(&vertices, &triangles, radiance, is_two_sided).unwrap();
            }
            "powers" => {
                let (first, count) = (words.int(), words.int());
                lights.set_powers(first, &words.floats(count)).unwrap();
            }
            "commit" => lights.commit().unwrap(),
            "refit" => lights.refit().unwrap(),
            "receivers" => {
                let count = words.int();
                receivers = words.records::<LightReceiver, 14>(count);
            }
            "choices" => {
                choices = lights.sample(&receivers).unwrap();
                for choice in &choices {
                    // SAFETY: the choice has as many bytes, and no padding.
                    let bits: [u32; 6] = unsafe { transmute_copy(choice) };
                    assert_eq!(bits, std::array::from_fn(|_| words.int()));
                }
                compared += choices.len();
            }
            "pdf" => {
                for probability in lights.pdf(&receivers, &choices).unwrap() {
                    assert_eq!(probability.to_bits(), words.int());
                }
            }
            "end" => return compared,
            word => panic!("the vectors have {word:?}"),
        }
    }
}

#[test]
fn choices_are_the_same_to_the_bit() {
    for isa in [Isa::Auto, Isa::Scalar] {
        let options = DeviceOptions { isa, validate: true, ..Default::default() };
        let device = Device::with_options(options).unwrap();
        let text = include_str!("../../../conformance/lights.txt");
        let mut words = Words(text.split_ascii_whitespace());
        assert_eq!((words.0.next(), words.int()), (Some("kiwami-conformance"), 1));
        let mut compared = 0;
        while words.0.next() == Some("lights") {
            compared += play(&mut words, &device);
        }
        assert!(compared > 100);
    }
    note("many lights");
}

#[test]
fn bad_lights_are_errors() {
    let mut lights = LightTree::new(&Device::new().unwrap()).unwrap();
    let receiver = LightReceiver::new([0.0; 3], [0.0, 0.0, 1.0], 0.5);
    let error = lights.sample(&[receiver]).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::InvalidState);
    let bad = Light { kind: 99, ..Light::point([0.0; 3], 1.0) };
    let errors = [
        lights.add_lights(&[bad]).err(),
        lights.add_mesh(&CORNERS, &[[0, 1, 3]], 1.0, false).err(),
        lights.set_powers(0, &[1.0]).err(),
        lights.pdf(&[receiver], &[]).err(),
    ];
    for error in errors {
        assert_eq!(error.unwrap().kind(), ErrorKind::InvalidArgument);
    }
    assert_eq!(lights.add_lights(&[Light::point([0.0, 0.0, 1.0], 2.0)]).unwrap(), 0);
    lights.commit().unwrap();
    let choices = lights.sample(&[receiver]).unwrap();
    assert_eq!((choices[0].light_id, choices[0].instance_id), (0, INVALID_ID));
    assert_eq!(lights.pdf(&[receiver], &[LightChoice::NONE]).unwrap(), [0.0]);
}
