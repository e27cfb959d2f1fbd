# SPDX-License-Identifier: Apache-2.0
import threading

import numpy as np
import pytest

import kiwami

TRIANGLE = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32)


def rays_at(random, count):
    """Rays from anywhere around towards the unit sphere."""
    origins = random.standard_normal((count, 3))
    origins *= 3 / np.linalg.norm(origins, axis=1)[:, None]
    targets = random.uniform(-1, 1, (count, 3))
    return origins, targets - origins


@pytest.mark.parametrize("kind", [np.int8, np.uint8, np.int16, np.int32, np.uint32, np.int64])
def test_faces_of_any_integers(kind):
    scene = kiwami.Scene(TRIANGLE, np.array([[0, 1, 2]], kind))
    assert scene.closest([0.25, 0.25, -1], [0, 0, 1]).t == 1


@pytest.mark.parametrize("kind", [np.float16, np.float32, np.float64, np.int64])
def test_vertices_of_any_numbers(kind):
    scene = kiwami.Scene(TRIANGLE.astype(kind))
    hits = scene.closest(np.array([[0.25, 0.25, -1]]), np.array([[0, 0, 1]], np.int32))
    assert hits.t[0] == 1 and hits.geometry_id[0] == 0


def test_strided_and_reversed_arrays_give_the_same(ball, random):
    origins, directions = (each.astype(np.float32) for each in rays_at(random, 1000))
    expected = ball.closest(origins, directions).records
    together = np.zeros((1000, 8), np.float32)
    together[:, 1:4], together[:, 5:8] = origins, directions
    packed = np.hstack([origins, directions])
    same = [
        ball.closest(together[:, 1:4], together[:, 5:8]),
        ball.closest(np.asfortranarray(origins), directions),
        ball.closest(packed),
        ball.closest(packed.reshape(10, 100, 6))[:].records.reshape(-1),
        ball.closest(origins[::-1], directions[::-1])[::-1],
        ball.closest(kiwami.make_rays(origins, directions)),
        ball.closest(origins.astype(np.float64), directions.astype(np.float64)),
    ]
    for hits in same:
        assert (getattr(hits, "records", hits) == expected).all()
    for origin, direction, hit in zip(origins[:20], directions[:20], expected):
        assert ball.closest(origin, direction).records == hit


def test_float_arrays_are_read_where_they_lie(ball, random, monkeypatch):
    from kiwami import rays as module

    origins, directions = (each.astype(np.float32) for each in rays_at(random, 64))
    seen = {}
    take = module.set_input
    monkeypatch.setattr(module, "set_input", lambda field, array: seen.update(
        {array.ctypes.data: array.strides}) or take(field, array))
    ball.closest(origins, directions)
    assert seen[origins.ctypes.data] == (12,) and seen[directions.ctypes.data + 8] == (12,)


def test_out_is_filled(ball, random):
    rays = kiwami.make_rays(*rays_at(random, 100))
    out = np.zeros(100, kiwami.hit_dtype)
    hits = ball.closest(rays, out=out)
    assert hits.records is out and (out == ball.closest(rays).records).all()
    assert ball.closest(rays, out=hits).records is out
    flags = np.zeros(100, bool)
    assert ball.any(rays, out=flags) is flags and (flags == hits.is_hit).all()
    for bad in (out[:50], np.zeros(100), out[::2]):
        with pytest.raises(ValueError, match="out"):
            ball.closest(rays, out=bad)
    with pytest.raises(ValueError, match="out"):
        ball.any(rays, out=np.zeros(100, np.uint8))


def test_bounds_masks_and_culling():
    scene = kiwami.Scene(TRIANGLE, mask=2)
    at, up = [0.25, 0.25, -1.0], [0, 0, 1.0]
    assert scene.any(at, up)
    assert not scene.any(at, up, tmin=1.5) and not scene.any(at, up, tmax=0.5)
    assert not scene.any(at, up, mask=1) and scene.any(at, up, mask=3)
    assert not scene.any(at, up, cull="back") and scene.any(at, up, cull="front")
    tmax = np.array([0.5, 1.5])
    assert list(scene.any(np.tile(at, (2, 1)), up, tmax=tmax)) == [False, True]


def test_hits_of_closed_meshes_are_even(ball, sphere, random):
    origins, _ = rays_at(random, 2000)
    targets = sphere[0][random.integers(len(sphere[0]), size=2000)]
    counts = ball.count(origins, targets - origins)
    assert (counts % 2 == 0).all() and counts.max() >= 2
    hits, offsets = ball.multi_hit(origins, targets - origins)
    assert (np.diff(offsets) == counts).all() and len(hits) == counts.sum()
    nearest = ball.closest(origins, targets - origins)
    first = offsets[:-1][counts > 0]
    assert (hits.records[first] == nearest.records[counts > 0]).all()
    two, offsets = ball.multi_hit(origins, targets - origins, max_hits=2)
    assert (np.diff(offsets) == np.minimum(counts, 2)).all()


def test_hits_are_where_double_precision_has_them(ball, sphere, random):
    origins, directions = rays_at(random, 500)
    origins, directions = origins.astype(np.float32), directions.astype(np.float32)
    hits = ball.closest(origins, directions)
    a, b, c = (sphere[0].astype(np.float32)[sphere[1][hits.primitive_id[hits.is_hit], k]]
               for k in range(3))
    u, v = hits.u[hits.is_hit, None], hits.v[hits.is_hit, None]
    points = (1 - u - v) * a + u * b + v * c
    assert np.allclose(points, hits.points(origins, directions)[hits.is_hit], atol=1e-5)
    assert np.isnan(hits.points(origins, directions)[~hits.is_hit]).all()
    assert 100 < hits.is_hit.sum() < 500


def test_changes_take_effect_with_the_next_query(sphere):
    scene = kiwami.Scene()
    assert not scene.any([0, 0, -5], [0, 0, 1])
    first = scene.add(*sphere)
    second = scene.add(TRIANGLE + 10)
    assert scene.info["triangle_count"] == 1281 and (first, second) == (0, 1)
    scene.remove(first)
    assert not scene.any([0, 0, -5], [0, 0, 1]) and scene.info["triangle_count"] == 1
    assert np.array_equal(scene.bounds, [[10, 10, 10], [11, 11, 10]])


def test_shared_buffers_outlive_their_names():
    vertices = TRIANGLE.copy()
    scene = kiwami.Scene()
    scene.add(vertices, share=True)
    del vertices
    scene.commit()
    assert scene.closest([0.25, 0.25, -1], [0, 0, 1]).t == 1


def test_empty_input():
    scene = kiwami.Scene(np.zeros((0, 3)), np.zeros((0, 3), int))
    assert len(scene.closest(np.zeros((0, 3)), np.zeros((0, 3)))) == 0
    assert scene.any(np.zeros((2, 0, 6))).shape == (2, 0)
    assert kiwami.Scene([], []).info["triangle_count"] == 0


@pytest.mark.parametrize(
    "call, kind, text",
    [
        (lambda s: s.add(TRIANGLE, [[0, 1, 3]]), ValueError, "holds 3"),
        (lambda s: s.add(TRIANGLE, [[0, -1, 2]]), ValueError, "holds -1"),
        (lambda s: s.add(TRIANGLE, [[0.0, 1, 2]]), TypeError, "integers"),
        (lambda s: s.add(TRIANGLE[:, :2]), ValueError, r"\(3, 2\)"),
        (lambda s: s.add(["a"]), TypeError, "numbers"),
        (lambda s: s.closest(TRIANGLE), ValueError, "6"),
        (lambda s: s.closest(TRIANGLE, TRIANGLE[:2]), ValueError, "broadcast"),
        (lambda s: s.closest(TRIANGLE, TRIANGLE, cull="both"), ValueError, "both"),
        (lambda s: s.closest(TRIANGLE, TRIANGLE, mask=1.5), TypeError, "integers"),
        (lambda s: s.remove(9), kiwami.InvalidArgumentError, "9"),
        (lambda s: kiwami.Device(isa="mmx"), ValueError, "mmx"),
        (lambda s: kiwami.Scene(quality="finest"), ValueError, "finest"),
        (lambda s: kiwami.Scene(faces=[[0, 1, 2]]), TypeError, "vertices"),
    ],
)
def test_bad_input_is_named(call, kind, text):
    with pytest.raises(kind, match=text):
        call(kiwami.Scene(TRIANGLE))


def test_closed_objects_are_errors():
    with kiwami.Device() as device:
        with kiwami.Scene(TRIANGLE, device=device) as scene:
            assert scene.any([0.25, 0.25, -1], [0, 0, 1])
        scene.close()
        assert repr(scene) == "<kiwami.Scene, closed>"
        with pytest.raises(ValueError, match="closed"):
            scene.any([0, 0, -1], [0, 0, 1])


def test_many_threads_trace_one_scene(ball, random):
    rays = kiwami.make_rays(*rays_at(random, 5000))
    expected = ball.closest(rays).records
    found = [None] * 4

    def trace(i):
        found[i] = ball.closest(rays).records

    threads = [threading.Thread(target=trace, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all((each == expected).all() for each in found)
