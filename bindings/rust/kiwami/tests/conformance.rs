// SPDX-License-Identifier: Apache-2.0
//! The answers that every binding must give, to the bit.
use std::io::Write;
use std::ops::ControlFlow;

use kiwami::{Device, DeviceOptions, ErrorKind, Hit, Isa, Ray, Scene, SceneBuilder};

const VECTORS: &str = include_str!("../../../conformance/vectors.txt");

/// Notes that a feature was found right, for the table of the documents.
fn note(feature: &str) {
    if let Ok(path) = std::env::var("KIWAMI_FEATURES") {
        let mut file = std::fs::OpenOptions::new().create(true).append(true).open(path).unwrap();
        writeln!(file, "{feature}").unwrap();
    }
}

struct Words<'a>(std::str::SplitAsciiWhitespace<'a>);

impl<'a> Words<'a> {
    fn word(&mut self) -> &'a str {
        self.0.next().expect("the vectors end too soon")
    }
    fn number(&mut self) -> u64 {
        self.word().parse().expect("a number")
    }
    fn int(&mut self) -> u32 {
        self.number() as u32
    }
    fn float(&mut self) -> f32 {
        f32::from_bits(self.int())
    }
    fn floats(&mut self) -> [f32; 3] {
        [self.float(), self.float(), self.float()]
    }
    fn ray(&mut self) -> Ray {
        Ray {
            origin: self.floats(),
            tmin: self.float(),
            direction: self.floats(),
            tmax: self.float(),
            time: self.float(),
            mask: self.int(),
            flags: self.int(),
            id: self.int(),
        }
    }
    fn hit(&mut self) -> [u32; 9] {
        std::array::from_fn(|_| self.int())
    }
}

fn bits_of(hit: &Hit) -> [u32; 9] {
    [
        hit.t.to_bits(),
        hit.u.to_bits(),
        hit.v.to_bits(),
        hit.normal[0].to_bits(),
        hit.normal[1].to_bits(),
        hit.normal[2].to_bits(),
        hit.primitive_id,
        hit.geometry_id,
        hit.instance_id,
    ]
}

fn check_multi_hit(words: &mut Words, scene: &Scene, rays: &[Ray]) {
    let max_hits = words.int();
    let total = words.number();
    let found = scene.multi_hit(rays, max_hits).unwrap();
    for offset in &found.offsets {
        assert_eq!(*offset, words.number());
    }
    assert_eq!(found.hits.len() as u64, total);
    for hit in &found.hits {
        assert_eq!(bits_of(hit), words.hit());
    }
    let counts = scene.count_hits(rays).unwrap();
    for (ray, count) in counts.iter().enumerate() {
        let expected = if max_hits == 0 { *count } else { (*count).min(max_hits) };
        assert_eq!(found.of(ray).len() as u32, expected);
    }
}

fn check_file(words: &mut Words, scene: &Scene, rays: &[Ray]) {
    let expected: Vec<_> = scene.closest_hit(rays).unwrap().iter().map(bits_of).collect();
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../conformance");
    let saved = std::env::temp_dir().join(format!("kiwami-{}.kiwami", std::process::id()));
    scene.save(&saved).unwrap();
    for path in [&saved, &folder.join(words.word())] {
        let loaded = Scene::load(scene.device(), path).unwrap();
        // SAFETY: nobody changes the file.
        let mapped = unsafe {
            Scene::load_with(scene.device(), path, kiwami_sys::KIWAMI_LOAD_MAP).unwrap()
        };
        for again in [loaded, mapped] {
            let hits = again.closest_hit(rays).unwrap();
            assert!(hits.iter().map(bits_of).eq(expected.iter().copied()));
        }
    }
    std::fs::remove_file(&saved).unwrap();
    assert!(Scene::load(scene.device(), &folder.join("vectors.txt")).is_err());
    note("files");
}

/// One scene; returns how many answers were compared.
fn check_scene(words: &mut Words, device: &Device) -> usize {
    let mut builder = SceneBuilder::new(device).unwrap();
    assert!(!words.word().is_empty());
    let mut word = words.word();
    while word == "mesh" {
        let (mask, vertex_count, triangle_count) = (words.int(), words.int(), words.int());
        let vertices: Vec<_> = (0..vertex_count).map(|_| words.floats()).collect();
        let triangles: Vec<[u32; 3]> =
            (0..triangle_count).map(|_| [words.int(), words.int(), words.int()]).collect();
        builder.add_masked_mesh(&vertices, &triangles, mask).unwrap();
        word = words.word();
    }
    assert_eq!(word, "rays");
    let count = words.int();
    let rays: Vec<_> = (0..count).map(|_| words.ray()).collect();
    let scene = builder.commit().unwrap();
    assert_eq!(words.word(), "closest_hit");
    for hit in scene.closest_hit(&rays).unwrap() {
        assert_eq!(bits_of(&hit), words.hit());
    }
    assert_eq!(words.word(), "any_hit");
    for occluded in scene.any_hit(&rays).unwrap() {
        assert_eq!(u32::from(occluded), words.int());
    }
    word = words.word();
    while word == "multi_hit" {
        check_multi_hit(words, &scene, &rays);
        word = words.word();
    }
    if word == "file" {
        check_file(words, &scene, &rays);
        word = words.word();
    }
    assert_eq!(word, "end");
    ["closest hit", "any hit", "multi hit", "counts"].map(note);
    rays.len()
}

#[test]
fn answers_are_the_same_to_the_bit() {
    for isa in [Isa::Auto, Isa::Scalar] {
        let device = Device::with_options(DeviceOptions { isa, ..Default::default() }).unwrap();
        let mut words = Words(VECTORS.split_ascii_whitespace());
        assert_eq!((words.word(), words.word()), ("kiwami-conformance", "1"));
        let mut compared = 0;
        while words.word() == "scene" {
            compared += check_scene(&mut words, &device);
        }
        assert!(compared > 100);
    }
}

fn expected_error(name: &str) -> (i32, &'static str) {
    let line = VECTORS.lines().find(|line| line.starts_with(&format!("error {name} "))).unwrap();
    let mut parts = line.splitn(4, ' ').skip(2);
    (parts.next().unwrap().parse().unwrap(), parts.next().unwrap())
}

#[test]
fn errors_are_the_same() {
    let device = Device::new().unwrap();
    let mut builder = SceneBuilder::new(&device).unwrap();
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let errors = [
        ("index_beyond_vertices", builder.add_mesh(&corners, &[[0, 1, 3]]).unwrap_err()),
        ("unknown_geometry", builder.remove(5).unwrap_err()),
        (
            "parameter_out_of_bounds",
            builder.set_parameter(kiwami_sys::KIWAMI_PARAMETER_BIN_COUNT, 1000.0).unwrap_err(),
        ),
    ];
    for (name, error) in errors {
        assert_eq!((error.result(), error.to_string().as_str()), expected_error(name));
        assert_eq!(error.kind(), ErrorKind::InvalidArgument);
    }
    note("errors");
}

#[test]
fn a_scene_is_traced_by_many_threads() {
    let device = Device::new().unwrap();
    let mut builder = SceneBuilder::new(&device).unwrap();
    builder
        .add_mesh(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]])
        .unwrap();
    let scene = builder.commit().unwrap();
    let rays: Vec<_> =
        (0..100).map(|i| Ray::new([i as f32 / 50.0, 0.1, -1.0], [0.0, 0.0, 1.0])).collect();
    let expected = scene.closest_hit(&rays).unwrap();
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| assert_eq!(scene.closest_hit(&rays).unwrap(), expected));
        }
    });
    assert!(scene.edit().commit().is_ok());
}

fn one_triangle(device: &Device) -> SceneBuilder {
    let mut builder = SceneBuilder::new(device).unwrap();
    builder
        .add_mesh(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]])
        .unwrap();
    builder
}

#[test]
fn progress_is_told_and_may_cancel_or_panic() {
    let device = Device::new().unwrap();
    let mut fractions = Vec::new();
    let scene = one_triangle(&device)
        .commit_with_progress(|fraction| {
            fractions.push(fraction);
            ControlFlow::Continue(())
        })
        .unwrap();
    assert_eq!((fractions.first(), fractions.last()), (Some(&0.0), Some(&1.0)));
    assert!(fractions.windows(2).all(|pair| pair[0] <= pair[1]));
    // The closure is gone: a later commit must not call it.
    assert!(scene.edit().commit().is_ok());

    let error = one_triangle(&device)
        .commit_with_progress(|_| ControlFlow::Break(()))
        .err()
        .unwrap();
    assert_eq!(error.kind(), ErrorKind::Cancelled);

    let mut calls = 0;
    let error = one_triangle(&device)
        .commit_with_progress(|_| {
            calls += 1;
            panic!("no more")
        })
        .err()
        .unwrap();
    assert_eq!(error.kind(), ErrorKind::Callback);
    assert_eq!(error.to_string(), "the progress function panicked: no more");
    assert_eq!(calls, 1);
    note("progress callback");
}

#[test]
fn a_path_with_a_zero_is_an_error() {
    let device = Device::new().unwrap();
    let error = Scene::load(&device, std::path::Path::new("a\0b")).err().unwrap();
    assert_eq!(error.kind(), ErrorKind::InvalidArgument);
    assert!(error.to_string().contains("a\\0b"), "{error}");
    let missing = Scene::load(&device, std::path::Path::new("/no/such/file")).err().unwrap();
    assert_eq!(missing.kind(), ErrorKind::Io);
}
