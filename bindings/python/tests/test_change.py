# SPDX-License-Identifier: Apache-2.0
"""Scenes that change, and shapes."""

import numpy as np
import pytest

import kiwami

UP = [0, 0, 1]


def test_moved_vertices_are_hit_after_a_refit(sphere, random):
    vertices, faces = sphere
    scene = kiwami.Scene(vertices, faces)
    rays = kiwami.make_rays(random.uniform(-2, 2, (500, 3)), random.uniform(-1, 1, (500, 3)))
    for step in range(1, 4):
        moved = vertices * (1 + 0.1 * step) + [0.2 * step, 0, 0]
        scene.move(0, moved)
        scene.refit()
        assert (scene.closest(rays).records == kiwami.Scene(moved, faces).closest(rays).records).all()
    assert scene.info["refit_count"] == 3
    with pytest.raises(ValueError, match="rows"):
        scene.move(0, vertices[:5])
    with pytest.raises(kiwami.InvalidArgumentError, match="7"):
        scene.move(7, vertices)


def test_shared_vertices_are_kept_while_they_are_used(sphere):
    vertices, faces = sphere[0].astype(np.float32), sphere[1].astype(np.uint32)
    scene = kiwami.Scene()
    number = scene.add(vertices, faces, share=True)
    scene.commit()
    scene.move(number, vertices + np.float32(5))
    scene.refit()
    assert scene.any([5, 5, 0], UP) and not scene.any([0, 0, -5], UP)


def test_geometries_are_left_out_and_taken_in(sphere):
    scene = kiwami.Scene(*sphere)
    scene.enable(0, False)
    assert not scene.any([0, 0, -5], UP)
    scene.enable(0)
    assert scene.any([0, 0, -5], UP)


@pytest.mark.feature("progress callback")
def test_progress_is_told_and_can_cancel(sphere):
    scene = kiwami.Scene(*sphere)
    scene.add(sphere[0] + 5, sphere[1])
    told = []
    with pytest.raises(kiwami.CancelledError):
        scene.commit(progress=lambda fraction: told.append(fraction) or True)
    assert len(told) >= 1
    with pytest.raises(ZeroDivisionError):
        scene.commit(progress=lambda fraction: 1 / 0)
    told.clear()
    scene.commit(progress=told.append)
    assert told == sorted(told) and told[-1] == 1
    assert scene.any([5, 5, 0], UP)


@pytest.mark.feature("spheres, discs, curves")
def test_spheres_discs_and_curves():
    scene = kiwami.Scene()
    spheres = scene.add_spheres([[0, 0, 0, 1], [5, 0, 0, 0.5]])
    discs = scene.add_discs([[0, 9, 0, 1]], [[0, 0, 1]])
    curves = scene.add_curves([[-9, 0, 0, 0.5], [-8, 0, 0, 0.5], [-7, 0, 0, 0.5]], [0, 1])
    origins = np.array([[0, 0, -5], [5, 0, -5], [0, 9, -5], [-7.5, 0, -5], [50, 0, 0]])
    hits = scene.closest(origins, np.array(UP))
    assert np.allclose(hits.t[:4], [4, 4.5, 5, 4.5]) and not hits.is_hit[4]
    assert list(hits.geometry_id[:4]) == [spheres, spheres, discs, curves]
    assert list(hits.primitive_id[:4]) == [0, 1, 0, 1]
    assert list(scene.count(origins, np.array(UP))) == [2, 2, 1, 2, 0]
    for bad in (
        lambda: scene.add_discs([[0, 0, 0, 1]], [[0, 0, 1], [0, 0, 1]]),
        lambda: scene.add_curves([[0, 0, 0, 1]], [0]),
        lambda: scene.add_spheres([[0, 0, 0]]),
    ):
        with pytest.raises(ValueError):
            bad()
