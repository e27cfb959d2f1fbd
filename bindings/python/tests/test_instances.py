# SPDX-License-Identifier: Apache-2.0
"""Instances and moving meshes."""

import gc

import numpy as np
import pytest

import kiwami

UP = [0, 0, 1]


def moved(x, y, z):
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def test_instances_show_scenes_elsewhere(ball):
    scene = kiwami.Scene()
    number = scene.add_instances(ball, [moved(5 * i, 0, 0) for i in range(3)], masks=[1, 2, 3])
    hits = scene.closest(np.float32([[5 * i, 0.01, -9] for i in range(4)]), np.array(UP))
    assert list(hits.instance_id) == [0, 1, 2, kiwami.INVALID_ID]
    assert list(hits.geometry_id[:3]) == [0, 0, 0] and hits.t[0] == pytest.approx(8, abs=0.02)
    rays = np.float32([[0, 0, -9], [5, 0, -9]])
    assert list(scene.any(rays, np.array(UP), mask=2)) == [False, True]
    scene.remove(number)
    scene.add_instances([ball], moved(5, 0, 0)[:3])
    assert list(scene.any(rays, np.array(UP))) == [False, True]


def test_a_commit_shows_what_the_scenes_hold_by_then(sphere):
    inner, outer = kiwami.Scene(), kiwami.Scene()
    outer.add_instances(inner, moved(5, 0, 0))
    assert not outer.any([5, 0, -9], UP)
    inner.add(*sphere)
    outer.commit()
    assert outer.any([5, 0, -9], UP)


def test_what_shown_scenes_share_lives_as_long_as_they_are_shown(sphere):
    scene = kiwami.Scene()

    def show():
        inner = kiwami.Scene()
        inner.set_parameter(kiwami.PARAMETER_LAYOUT, 1)  # rays read the mesh's own buffers
        inner.add(sphere[0].astype(np.float32), sphere[1].astype(np.uint32), share=True)
        scene.add_instances(inner, moved(5, 0, 0))
        scene.commit()
        inner.close()

    show()
    gc.collect()
    rays = kiwami.make_rays(np.random.default_rng(7).uniform(4, 6, (500, 3)) * [1, 0, 0], UP)
    assert scene.any(rays).all()


def test_bad_instances_are_named(ball):
    scene = kiwami.Scene()
    for bad in ({"scene_indices": [1]}, {"scene_indices": [0, 0]}, {"masks": [-1]}):
        with pytest.raises(ValueError, match=next(iter(bad))):
            scene.add_instances(ball, np.eye(4), **bad)
    with pytest.raises(ValueError, match="transforms"):
        scene.add_instances(ball, np.eye(3))
    with pytest.raises(kiwami.InvalidArgumentError):
        scene.add_instances(ball, np.zeros((4, 4)))
    with pytest.raises(kiwami.InvalidArgumentError):
        scene.add_instances([], np.eye(4))
    with pytest.raises(kiwami.InvalidArgumentError):
        scene.add_instances(scene, np.eye(4))
    ball.close()
    with pytest.raises(ValueError, match="closed"):
        scene.add_instances(ball, np.eye(4))


def test_moving_meshes_are_met_where_they_are_at_the_time(sphere):
    vertices, faces = sphere
    scene = kiwami.Scene()
    scene.add_moving_mesh([vertices, vertices + [10, 0, 0]], faces, times=(0.5, 1))
    origins = np.float32([[0, 0, -9], [5, 0, -9], [10, 0, -9]])
    for time, expected in ((0.25, [0, 0, 0]), (0.5, [1, 0, 0]), (0.75, [0, 1, 0]), (1, [0, 0, 1])):
        assert list(scene.any(origins, np.array(UP), time=time)) == [bool(e) for e in expected]
    with pytest.raises(ValueError, match="steps"):
        scene.add_moving_mesh(vertices, faces)
    with pytest.raises(kiwami.InvalidArgumentError):
        scene.add_moving_mesh([vertices, vertices], faces, times=(1, 0.5))
    with pytest.raises(kiwami.InvalidArgumentError):
        scene.add_moving_mesh([vertices], faces)
