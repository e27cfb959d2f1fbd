// SPDX-License-Identifier: Apache-2.0
//! The answers that every binding must give, to the bit.
mod common;

use common::{note, one_triangle, CORNERS};
use kiwami::{
    Device, DeviceOptions, ErrorKind, Hit, Instance, Isa, MovingMesh, Ray, Scene, SceneBuilder,
};
use std::collections::HashMap;
use std::sync::Arc;

const VECTORS: &str = include_str!("../../../conformance/vectors.txt");
const FILES: [(&str, &[&str]); 5] = [
    (VECTORS, &["closest hit", "any hit", "multi hit", "counts"]),
    (include_str!("../../../conformance/shapes.txt"), &["spheres, discs, curves"]),
    (include_str!("../../../conformance/moving_meshes.txt"), &["moving meshes"]),
    (include_str!("../../../conformance/instances.txt"), &["instances"]),
    (include_str!("../../../conformance/changes.txt"), &["changes, refit"]),
];

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
    fn floats<const N: usize>(&mut self) -> [f32; N] {
        std::array::from_fn(|_| self.float())
    }
    fn rows<const N: usize>(&mut self, count: u32) -> Vec<[f32; N]> {
        (0..count).map(|_| self.floats()).collect()
    }
    fn triangles(&mut self, count: u32) -> Vec<[u32; 3]> {
        (0..count).map(|_| std::array::from_fn(|_| self.int())).collect()
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

/// Adds a geometry of this kind, or says that it is none.
fn add_geometry(
    kind: &str,
    words: &mut Words,
    builder: &mut SceneBuilder,
    scenes: &HashMap<String, Arc<Scene>>,
) -> bool {
    let mut header = |count: usize| -> Vec<u32> { (0..count).map(|_| words.int()).collect() };
    let added = match kind {
        "mesh" => {
            let head = header(3);
            let (vertices, triangles) = (words.rows(head[1]), words.triangles(head[2]));
            builder.add_masked_mesh(&vertices, &triangles, head[0])
        }
        "moving_mesh" => {
            let head = header(6);
            let (vertices, triangles) = (words.rows(head[1] * head[4]), words.triangles(head[5]));
            builder.add_moving_mesh(&MovingMesh {
                time_begin: f32::from_bits(head[2]),
                time_end: f32::from_bits(head[3]),
                mask: head[0],
                ..MovingMesh::new(&vertices, head[1], &triangles)
            })
        }
        "spheres" => {
            let head = header(2);
            builder.add_spheres(&words.rows(head[1]), head[0])
        }
        "discs" => {
            let head = header(2);
            let (points, normals) = (words.rows(head[1]), words.rows(head[1]));
            builder.add_discs(&points, &normals, head[0])
        }
        "curves" => {
            let head = header(3);
            let points = words.rows(head[1]);
            let segments: Vec<_> = (0..head[2]).map(|_| words.int()).collect();
            builder.add_curves(&points, &segments, head[0])
        }
        "instances" => {
            let head = header(3);
            let shown: Vec<_> = (0..head[1]).map(|_| scenes[words.word()].clone()).collect();
            let instances: Vec<_> = (0..head[2])
                .map(|_| Instance {
                    scene: words.int(),
                    mask: words.int(),
                    transform: std::array::from_fn(|_| words.floats()),
                })
                .collect();
            builder.add_instances(&shown, &instances, head[0])
        }
        _ => return false,
    };
    added.unwrap();
    true
}

/// Changes the scene by one statement, or says that it does not change it.
fn change(statement: &str, words: &mut Words, builder: &mut SceneBuilder) -> bool {
    match statement {
        "vertices" => {
            let (geometry_id, count) = (words.int(), words.int());
            builder.update_vertices(geometry_id, &words.rows(count)).unwrap();
        }
        "enable" => {
            let geometry_id = words.int();
            builder.enable(geometry_id, words.int() != 0).unwrap();
        }
        "remove" => builder.remove(words.int()).unwrap(),
        _ => return false,
    }
    true
}

/// Compares one kind of answer.
fn compare(statement: &str, words: &mut Words, scene: &Scene, rays: &[Ray]) {
    match statement {
        "closest_hit" => {
            for hit in scene.closest_hit(rays).unwrap() {
                assert_eq!(bits_of(&hit), words.hit());
            }
        }
        "any_hit" => {
            for occluded in scene.any_hit(rays).unwrap() {
                assert_eq!(u32::from(occluded), words.int());
            }
        }
        "multi_hit" => check_multi_hit(words, scene, rays),
        "file" => check_file(words, scene, rays),
        _ => panic!("the vectors have {statement:?}"),
    }
}

/// One scene; returns how many rays were compared.
fn check_scene(
    words: &mut Words,
    device: &Device,
    scenes: &mut HashMap<String, Arc<Scene>>,
) -> usize {
    let name = words.word();
    let mut builder = Some(SceneBuilder::new(device).unwrap());
    let mut scene: Option<Scene> = None;
    let (mut rays, mut compared) = (Vec::new(), 0);
    loop {
        let statement = words.word();
        if statement == "end" {
            scenes.insert(name.to_string(), Arc::new(scene.unwrap()));
            return compared;
        }
        if statement == "rays" {
            rays = (0..words.int()).map(|_| words.ray()).collect();
            compared += rays.len();
        } else if statement == "commit" {
            scene = Some(builder.take().unwrap().commit().unwrap());
        } else if statement == "refit" {
            scene = Some(builder.take().unwrap().refit().unwrap());
        } else if matches!(statement, "closest_hit" | "any_hit" | "multi_hit" | "file") {
            compare(statement, words, scene.as_ref().unwrap(), &rays);
        } else {
            let mut edited = builder.take().unwrap_or_else(|| scene.take().unwrap().edit());
            assert!(
                add_geometry(statement, words, &mut edited, scenes)
                    || change(statement, words, &mut edited),
                "the vectors have {statement:?}"
            );
            builder = Some(edited);
        }
    }
}

#[test]
fn answers_are_the_same_to_the_bit() {
    for (text, features) in FILES {
        for isa in [Isa::Auto, Isa::Scalar] {
            let options = DeviceOptions { isa, validate: true, ..Default::default() };
            let device = Device::with_options(options).unwrap();
            let mut words = Words(text.split_ascii_whitespace());
            assert_eq!((words.word(), words.word()), ("kiwami-conformance", "1"));
            let (mut compared, mut scenes) = (0, HashMap::new());
            while words.0.next() == Some("scene") {
                compared += check_scene(&mut words, &device, &mut scenes);
            }
            assert!(compared > 100);
        }
        features.iter().for_each(|feature| note(feature));
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
    let errors = [
        ("index_beyond_vertices", builder.add_mesh(&CORNERS, &[[0, 1, 3]]).unwrap_err()),
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
    let scene = one_triangle(&device).commit().unwrap();
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

#[test]
fn a_path_with_a_zero_is_an_error() {
    let device = Device::new().unwrap();
    let error = Scene::load(&device, std::path::Path::new("a\0b")).err().unwrap();
    assert_eq!(error.kind(), ErrorKind::InvalidArgument);
    assert!(error.to_string().contains("a\\0b"), "{error}");
    let missing = Scene::load(&device, std::path::Path::new("/no/such/file")).err().unwrap();
    assert_eq!(missing.kind(), ErrorKind::Io);
}
