// SPDX-License-Identifier: Apache-2.0
//! Functions that the library calls back, and what panics in them.
mod common;

use common::{note, one_triangle, CORNERS};
use kiwami::{
    Answer, Bounds, Candidate, Device, ErrorKind, Intersection, Ray, Scene, SceneBuilder,
    UserGeometry, UserHit,
};
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex};

/// A call that fails has the first message of its process since it began: tests that look at messages
/// of user geometries run one at a time.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

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

fn ray_at(x: f32, y: f32) -> Ray {
    Ray::new([x, y, -1.0], [0.0, 0.0, 1.0])
}

/// Eight triangles, one behind the other.
fn layers() -> Scene {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..8u32 {
        let z = i as f32;
        vertices.extend([[-1.0, -1.0, z], [3.0, -1.0, z], [-1.0, 3.0, z]]);
        triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    let mut builder = SceneBuilder::new(&Device::new().unwrap()).unwrap();
    builder.add_mesh(&vertices, &triangles).unwrap();
    builder.commit().unwrap()
}

fn odd(candidate: &Candidate) -> Answer {
    assert!(candidate.ray() < 3000 && candidate.instance_path().is_empty());
    match candidate.hit().primitive_id % 2 {
        1 => Answer::Accept,
        _ => Answer::Reject,
    }
}

#[test]
fn filters_accept_reject_and_stop() {
    let scene = layers();
    let rays = vec![ray_at(0.0, 0.0); 3000];
    let filtered = scene.filtered(odd);
    assert!(filtered.closest_hit(&rays).unwrap().iter().all(|hit| hit.primitive_id == 1));
    assert!(filtered.any_hit(&rays).unwrap().into_iter().all(|is_hit| is_hit));
    assert!(filtered.count_hits(&rays).unwrap().into_iter().all(|count| count == 4));
    let found = filtered.multi_hit(&rays, 0).unwrap();
    let ids: Vec<_> = found.of(2999).iter().map(|hit| hit.primitive_id).collect();
    assert_eq!(ids, [1, 3, 5, 7]);
    let none = scene.filtered(|_| Answer::Reject);
    assert_eq!(none.any_hit(&rays[..1]).unwrap(), [false]);
    let first = scene.filtered(|_| Answer::AcceptAndStop);
    assert!(first.count_hits(&rays).unwrap().into_iter().all(|count| count == 1));
    note("filter callback");
}

#[test]
fn a_filter_that_panics_ends_the_call() {
    let scene = layers();
    let rays = vec![ray_at(0.0, 0.0); 3000];
    let filtered = scene.filtered(|candidate| panic!("at {}", candidate.hit().geometry_id));
    let errors = [
        filtered.closest_hit(&rays).err().unwrap(),
        filtered.any_hit(&rays).err().unwrap(),
        filtered.count_hits(&rays).err().unwrap(),
        filtered.multi_hit(&rays, 2).err().unwrap(),
    ];
    for error in errors {
        assert_eq!(error.kind(), ErrorKind::Callback);
        assert_eq!(error.to_string(), "the filter panicked: at 0");
    }
    assert_eq!(scene.any_hit(&rays[..1]).unwrap(), [true]);
}

/// Squares of side 2 across z = 0, 1, ...
#[derive(Clone)]
struct Squares {
    alive: Arc<()>,
    panics_in_bounds: bool,
    panics_at: f32,
    adds: usize,
}

impl Squares {
    fn new() -> Self {
        Self { alive: Arc::new(()), panics_in_bounds: false, panics_at: -5.0, adds: 1 }
    }
}

impl UserGeometry for Squares {
    fn bounds(&self, first: u32, bounds: &mut [Bounds]) {
        assert!(!self.panics_in_bounds, "no bounds");
        for (i, bounds) in bounds.iter_mut().enumerate() {
            let z = (first + i as u32) as f32;
            *bounds = Bounds { lower: [-1.0, -1.0, z], upper: [1.0, 1.0, z] };
        }
    }

    fn intersect(&self, intersection: &mut Intersection<'_>) {
        let ray = *intersection.ray();
        assert!(ray.origin[0] != self.panics_at, "no hit at {}", ray.origin[0]);
        for primitive_id in intersection.primitive_ids().to_vec() {
            let t = (primitive_id as f32 - ray.origin[2]) / ray.direction[2];
            let [u, v] = [0, 1].map(|axis| ray.origin[axis] + t * ray.direction[axis]);
            if u.abs() <= 1.0 && v.abs() <= 1.0 {
                for _ in 0..self.adds {
                    let normal = [0.0, 0.0, -1.0];
                    intersection.add(UserHit { t, u, v, normal, primitive_id });
                }
            }
        }
    }
}

fn scene_of(squares: Squares) -> Result<Scene, kiwami::Error> {
    let mut builder = SceneBuilder::new(&Device::new()?)?;
    builder.add_user_geometry(40, squares, !0)?;
    builder.commit()
}

#[test]
fn user_geometries_are_bounded_and_intersected() {
    let squares = Squares::new();
    let alive = Arc::clone(&squares.alive);
    let mut builder = one_triangle(&Device::new().unwrap());
    assert_eq!(builder.add_user_geometry(40, squares, 2).unwrap(), 1);
    let scene = builder.commit().unwrap();
    let rays = vec![ray_at(0.75, -0.5); 3000];
    let hit = scene.closest_hit(&rays).unwrap()[2999];
    assert_eq!((hit.t, hit.u, hit.v, hit.normal), (1.0, 0.75, -0.5, [0.0, 0.0, -1.0]));
    assert_eq!((hit.primitive_id, hit.geometry_id), (0, 1));
    assert_eq!(scene.count_hits(&rays[..1]).unwrap(), [40]);
    assert_eq!(scene.any_hit(&[ray_at(1.5, 0.0)]).unwrap(), [false]);
    assert_eq!(scene.any_hit(&[Ray { mask: 1, ..rays[0] }]).unwrap(), [false]);
    assert_eq!(scene.filtered(|_| Answer::Reject).any_hit(&rays[..1]).unwrap(), [false]);
    assert_eq!(Arc::strong_count(&alive), 2);
    let mut builder = scene.edit();
    builder.remove(1).unwrap();
    let scene = builder.commit().unwrap();
    assert_eq!(Arc::strong_count(&alive), 1);
    assert_eq!(scene.any_hit(&rays[..1]).unwrap(), [false]);
    note("user geometry callback");
}

#[test]
fn a_user_geometry_that_panics_ends_the_call() {
    let _alone = ONE_AT_A_TIME.lock();
    let error = scene_of(Squares { panics_in_bounds: true, ..Squares::new() }).err().unwrap();
    assert_eq!(error.to_string(), "the user geometry panicked: no bounds");
    let scene = scene_of(Squares { panics_at: 0.5, ..Squares::new() }).unwrap();
    let mut rays = vec![ray_at(0.25, 0.0); 3000];
    assert!(scene.any_hit(&rays).is_ok());
    rays[2000] = ray_at(0.5, 0.0);
    let errors = [
        scene.closest_hit(&rays).err().unwrap(),
        scene.any_hit(&rays).err().unwrap(),
        scene.count_hits(&rays).err().unwrap(),
        scene.multi_hit(&rays, 1).err().unwrap(),
    ];
    for error in errors {
        assert_eq!(error.kind(), ErrorKind::Callback);
        assert_eq!(error.to_string(), "the user geometry panicked: no hit at 0.5");
    }
    assert!(scene.any_hit(&rays[..1]).is_ok());
    let scene = scene_of(Squares { adds: 100, ..Squares::new() }).unwrap();
    let error = scene.any_hit(&rays[..1]).err().unwrap();
    assert!(error.to_string().contains("more than four hits"), "{error}");
    let mut builder = SceneBuilder::new(scene.device()).unwrap();
    let squares = Squares::new();
    let alive = Arc::clone(&squares.alive);
    assert!(builder.add_user_geometry(1 << 40, squares, !0).is_err());
    assert_eq!(Arc::strong_count(&alive), 1);
}

#[test]
fn each_of_many_calls_has_its_own_error() {
    let _alone = ONE_AT_A_TIME.lock();
    let scene = scene_of(Squares { panics_at: 0.5, ..Squares::new() }).unwrap();
    std::thread::scope(|scope| {
        for x in [0.5, 0.25, 0.5, 0.25] {
            let scene = &scene;
            scope.spawn(move || {
                for _ in 0..20 {
                    assert_eq!(scene.closest_hit(&[ray_at(x, 0.0)]).is_err(), x == 0.5);
                }
            });
        }
    });
}

#[test]
fn geometries_of_wrong_sizes_are_errors() {
    let mut builder = one_triangle(&Device::new().unwrap());
    let errors = [
        builder.add_discs(&[[0.0; 4]; 2], &[[0.0; 3]], !0),
        builder.add_moving_mesh(&kiwami::MovingMesh::new(&CORNERS, 2, &[])),
        builder.add_moving_mesh(&kiwami::MovingMesh::new(&CORNERS, 0, &[])),
        builder.add_instances(&[], &[], !0),
        builder.update_vertices(0, &CORNERS[..2]).map(|_| 0),
        builder.update_vertices(1, &CORNERS).map(|_| 0),
    ];
    for error in errors {
        assert_eq!(error.unwrap_err().kind(), ErrorKind::InvalidArgument);
    }
    assert!(builder.commit().is_ok());
}
