# SPDX-License-Identifier: Apache-2.0
"""The classes in the shape of other libraries."""

import types

import numpy as np
import pytest

import kiwami


@pytest.fixture
def mesh(sphere):
    return types.SimpleNamespace(vertices=sphere[0], faces=sphere[1])


def test_rays_of_trimesh(mesh):
    ray = kiwami.RayMeshIntersector(mesh)
    origins = np.array([[0.1, 0.2, -3], [0, 5, 0], [0.1, 0.2, 0.3]])
    directions = np.array([[0, 0, 1.0], [0, 0, 1.0], [0, 0, 1.0]])
    assert list(ray.intersects_any(origins, directions)) == [True, False, True]
    first = ray.intersects_first(origins, directions)
    assert first[1] == -1 and first[0] >= 0 and first.dtype == np.int64
    index_tri, index_ray, locations = ray.intersects_id(
        origins, directions, return_locations=True
    )
    assert list(index_ray) == [0, 0, 2] and index_tri[0] == first[0]
    assert np.allclose(np.linalg.norm(locations, axis=1), 1, atol=0.01)
    assert locations[0, 2] < locations[1, 2]
    index_tri, index_ray = ray.intersects_id(origins, directions, multiple_hits=False)
    assert list(index_ray) == [0, 2] and list(index_tri) == [first[0], first[2]]
    index_tri, index_ray = ray.intersects_id(origins, directions, max_hits=1)
    assert list(index_ray) == [0, 2]
    again, index_ray, _ = ray.intersects_location(origins, directions)
    assert np.array_equal(again, locations) and list(index_ray) == [0, 0, 2]


def test_contains_points(mesh, random):
    points = random.uniform(-1.5, 1.5, (5000, 3))
    radius = np.linalg.norm(points, axis=1)
    inside = kiwami.RayMeshIntersector(mesh).contains_points(points)
    assert inside[radius < 0.98].all() and not inside[radius > 1].any()


def check_against_open3d(ours, theirs, rays):
    import open3d as o3d

    tensor = o3d.core.Tensor(rays)
    expected = {name: value.numpy() for name, value in theirs.cast_rays(tensor).items()}
    found = ours.cast_rays(rays)
    assert set(found) >= set(expected)
    # At an edge the two may choose different neighbours, and Open3D may slip between them.
    same = found["primitive_ids"] == expected["primitive_ids"]
    assert same.mean() > 0.995
    assert np.allclose(found["t_hit"][same], expected["t_hit"][same], rtol=1e-4)
    assert np.allclose(found["primitive_uvs"][same], expected["primitive_uvs"][same], atol=1e-3)
    assert np.allclose(
        found["primitive_normals"][same], expected["primitive_normals"][same], atol=1e-3
    )
    assert (found["geometry_ids"][same] == expected["geometry_ids"][same]).all()
    assert (ours.test_occlusions(rays) == theirs.test_occlusions(tensor).numpy()).mean() > 0.995
    counts = ours.count_intersections(rays)
    assert (counts == theirs.count_intersections(tensor).numpy()).mean() > 0.99


def test_rays_of_open3d(sphere, random):
    o3d = pytest.importorskip("open3d")
    vertices, faces = sphere
    ours, theirs = kiwami.RaycastingScene(), o3d.t.geometry.RaycastingScene()
    for shift in (0, 3):
        moved = (vertices + shift).astype(np.float32)
        numbers = [
            ours.add_triangles(moved, faces),
            theirs.add_triangles(o3d.core.Tensor(moved), o3d.core.Tensor(faces.astype(np.uint32))),
        ]
        assert numbers[0] == numbers[1]
    rays = random.uniform(-3, 3, (4, 2500, 6)).astype(np.float32)
    check_against_open3d(ours, theirs, rays)


def test_lists_of_intersections(sphere, random):
    scene = kiwami.RaycastingScene(nthreads=2)
    scene.add_triangles(*sphere)
    rays = random.uniform(-2, 2, (3, 100, 6)).astype(np.float32)
    found = scene.list_intersections(rays)
    counts = scene.count_intersections(rays)
    assert counts.shape == (3, 100) and counts.dtype == np.int32
    assert np.array_equal(np.diff(found["ray_splits"]), counts.reshape(-1))
    assert np.array_equal(found["ray_ids"], np.repeat(np.arange(300), counts.reshape(-1)))
    starts = found["ray_splits"][:-1][counts.reshape(-1) > 0]
    nearest = scene.cast_rays(rays)
    is_hit = (nearest["primitive_ids"] != scene.INVALID_ID).reshape(-1)
    assert np.array_equal(found["t_hit"][starts], nearest["t_hit"].reshape(-1)[is_hit])
    assert found["primitive_uvs"].shape == (len(found["t_hit"]), 2)
    with pytest.raises(ValueError, match="6"):
        scene.cast_rays(rays[..., :5])


def test_normals_of_cast_rays_have_length_1_at_any_scale():
    ours = kiwami.RaycastingScene()
    corners = np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    for scale, z in ((1, 0), (1e-15, 3), (1e15, 5)):
        ours.add_triangles(corners * np.float32(scale) + np.float32([0, 0, z]), [[0, 1, 2]])
    rays = np.float32([[0.25, 0.25, -1, 0, 0, 1], [1e-16, 1e-16, 2, 0, 0, 1]] * 5000 + [[0] * 6])
    rays[2] = [1e14, 1e14, 4, 0, 0, 2]
    found = ours.cast_rays(rays.reshape(73, 137, 6))
    assert found["primitive_normals"].shape == (73, 137, 3)
    normals = found["primitive_normals"].reshape(-1, 3)
    assert (normals[:-1] == [0, 0, 1]).all() and (normals[-1] == 0).all()
    assert list(found["geometry_ids"].reshape(-1)[[0, 1, 2, -1]]) == [0, 1, 2, kiwami.INVALID_ID]
    assert all(array.flags.c_contiguous for array in found.values())
    assert ours.cast_rays(np.zeros((0, 6)))["primitive_normals"].shape == (0, 3)
