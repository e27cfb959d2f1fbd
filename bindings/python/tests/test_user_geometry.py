# SPDX-License-Identifier: Apache-2.0
"""Primitives of the caller's own kind."""

import gc
import threading
import weakref

import numpy as np
import pytest

import kiwami

UP = [0, 0, 1]


class Squares:
    """Of side 2, across z = 0, 1, ..."""

    raises_at = None
    hits_a_primitive = 1

    def bounds(self, first, count):
        z = np.arange(first, first + count)
        boxes = np.tile(np.float32([-1, -1, 0, 1, 1, 0]), (count, 1))
        boxes[:, 2] = boxes[:, 5] = z
        return boxes

    def intersect(self, ray, primitive_ids):
        origin, direction = ray["origin"], ray["direction"]
        if origin[0] == self.raises_at:
            raise KeyError("of the primitives")
        t = (primitive_ids.astype(np.float32) - origin[2]) / direction[2]
        x, y = (origin[axis] + t * direction[axis] for axis in range(2))
        is_hit = (abs(x) <= 1) & (abs(y) <= 1)
        hits = np.zeros(is_hit.sum() * self.hits_a_primitive, kiwami.user_hit_dtype)
        each = np.repeat(np.flatnonzero(is_hit), self.hits_a_primitive)
        hits["t"], hits["u"], hits["v"] = t[each], x[each], y[each]
        hits["normal"], hits["primitive_id"] = [0, 0, -1], primitive_ids[each]
        return hits

    def scene(self, **options):
        scene = kiwami.Scene(**options)
        scene.add_user_geometry(40, self.bounds, self.intersect, mask=2)
        return scene


def rays_at(*places):
    return kiwami.make_rays(np.array([(x, y, -1) for x, y in places]), np.array(UP))


@pytest.mark.feature("user geometry callback")
def test_user_geometries_are_bounded_and_intersected():
    scene = Squares().scene()
    rays = rays_at((0.75, -0.5), (1.5, 0), (0, 0))
    hits = scene.closest(rays)
    assert list(hits.t) == [1, np.inf, 1]
    assert (hits.u[0], hits.v[0], tuple(hits.normal[0])) == (0.75, -0.5, (0, 0, -1))
    assert list(scene.count(rays)) == [40, 0, 40]
    assert list(scene.any(rays)) == [True, False, True]
    hits, offsets = scene.multi_hit(rays, max_hits=3)
    assert list(hits.primitive_id) == [0, 1, 2] * 2 and list(offsets) == [0, 3, 3, 6]
    rays["mask"] = 1
    assert not scene.any(rays).any()
    assert not scene.any([0, 0, -1], UP, filter=lambda candidate: False)


def test_hits_may_be_tuples_or_none():
    scene = kiwami.Scene()
    box = [-1, -1, 0, 1, 1, 0]
    hit = (1.0, 0.5, 0.25, (0, 0, -1), 0)
    scene.add_user_geometry(1, lambda first, count: [box], lambda ray, ids: [hit])
    scene.add_user_geometry(1, lambda first, count: [box], lambda ray, ids: None)
    hits = scene.closest([0, 0, -1], UP)
    assert (hits.t, hits.u, hits.v, hits.geometry_id) == (1, 0.5, 0.25, 0)
    assert scene.count([0, 0, -1], UP) == 1


@pytest.mark.parametrize("call", ["closest", "any", "count", "multi_hit"])
def test_what_intersect_raises_is_the_cause_of_the_error(call):
    squares = Squares()
    squares.raises_at = 0.5
    scene = squares.scene()
    assert scene.any(rays_at((0, 0))).all()
    for rays in (rays_at(*[(0, 0)] * 2000, (0.5, 0)), [[0.5, 0, -1, 0, 0, 1]]):
        with pytest.raises(kiwami.CallbackError, match="of the primitives") as raised:
            getattr(scene, call)(rays)
        assert isinstance(raised.value.__cause__, KeyError)
    squares.raises_at, squares.hits_a_primitive = None, 5
    with pytest.raises(kiwami.CallbackError, match="four a primitive"):
        getattr(scene, call)(rays_at((0, 0)))
    squares.hits_a_primitive = 4
    assert scene.any(rays_at((0, 0))).all()


def test_what_bounds_raises_is_the_cause_of_the_error():
    scene = kiwami.Scene()

    def fail(first, count):
        raise KeyError("of the bounds")

    number = scene.add_user_geometry(4, fail, lambda ray, ids: None)
    for build in (scene.commit, scene.refit, lambda: scene.commit(lambda fraction: False)):
        with pytest.raises(kiwami.CallbackError, match="of the bounds") as raised:
            build()
        assert isinstance(raised.value.__cause__, KeyError)
    scene.remove(number)
    scene.add_user_geometry(4, lambda first, count: np.zeros((count, 5)), None)
    with pytest.raises(kiwami.CallbackError, match="shape"):
        scene.commit()
    with pytest.raises(kiwami.TooLargeError):
        scene.add_user_geometry(2**40, fail, fail)


def test_the_functions_live_as_long_as_the_geometry():
    squares = Squares()
    alive = weakref.ref(squares)
    scene = squares.scene()
    shown = kiwami.Scene()
    shown.add_instances(scene, np.eye(4))
    shown.commit()
    del squares
    gc.collect()
    assert scene.any(rays_at((0, 0))).all()
    scene.close()
    gc.collect()
    assert shown.any(rays_at((0, 0))).all()
    shown.close()
    gc.collect()
    assert alive() is None


def test_each_of_many_calls_has_its_own_error():
    squares = Squares()
    squares.raises_at = 0.5
    scene = squares.scene()
    scene.commit()
    failed = [0] * 4

    def trace(i):
        for _ in range(20):
            try:
                scene.closest(rays_at((0.5 if i % 2 else 0.25, 0)))
            except kiwami.CallbackError as error:
                failed[i] += isinstance(error.__cause__, KeyError)

    threads = [threading.Thread(target=trace, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failed == [0, 20, 0, 20]
