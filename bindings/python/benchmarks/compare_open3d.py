# SPDX-License-Identifier: Apache-2.0
"""Times cast_rays of kiwami.RaycastingScene and of Open3D's RaycastingScene on the same rays, in turn.

  compare_open3d.py [--rays N] [--rounds N] [--threads N] SCENE...

SCENE is a file TRI1 (gzipped: counts, float32 positions, uint32 triangles). Prints one line a scene
and ray set: the median of the rounds' ratios (above 1: Kiwami is faster), and how many rays both
answer with the same triangle. Debian's Open3D hits nothing unless tests/open3d_ray_mask.c is
preloaded.
"""

import argparse
import gzip
import pathlib
import sys
import time

import numpy as np
import open3d

import kiwami


def read_scene(path):
    data = gzip.decompress(pathlib.Path(path).read_bytes())
    if data[:4] != b"TRI1":
        sys.exit(f"{path} is no file TRI1")
    vertex_count, triangle_count = np.frombuffer(data, "<u4", 2, 4)
    vertices = np.frombuffer(data, "<f4", 3 * vertex_count, 12).reshape(-1, 3)
    faces = np.frombuffer(data, "<u4", 3 * triangle_count, 12 + 12 * vertex_count)
    return vertices, faces.reshape(-1, 3)


def primary_rays(bounds, count):
    """A pinhole camera outside of the scene that looks at its middle, row by row."""
    lower, upper = bounds
    middle, size = (lower + upper) / 2, np.linalg.norm(upper - lower)
    eye = middle + size * np.array([0.45, 0.35, 0.6])
    forward = (middle - eye) / np.linalg.norm(middle - eye)
    right = np.cross(forward, [0.3, 1, 0.2])
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    side = int(np.sqrt(count))
    y, x = np.mgrid[-0.5:0.5:side * 1j, -0.5:0.5:side * 1j].reshape(2, -1, 1)
    return np.hstack([np.broadcast_to(eye, (side * side, 3)), forward + x * right + y * up])


def random_rays(bounds, count, random):
    """From anywhere in the scene's box, in all directions."""
    return np.hstack([random.uniform(*bounds, (count, 3)), random.standard_normal((count, 3))])


def time_of(call):
    began = time.perf_counter()
    answer = call()
    return time.perf_counter() - began, answer


def compare(name, rays, ours, theirs, arguments):
    rays = np.ascontiguousarray(rays, np.float32)
    tensor = open3d.core.Tensor(rays)
    ratios = []
    for _ in range(arguments.rounds + 1):
        their_time, expected = time_of(lambda: theirs.cast_rays(tensor, nthreads=arguments.threads))
        our_time, found = time_of(lambda: ours.cast_rays(rays))
        ratios.append(their_time / our_time)
    same = (found["primitive_ids"] == expected["primitive_ids"].numpy()).mean()
    print(f"{name:40} {len(rays):9} rays   {np.median(ratios[1:]):5.2f}   same {100 * same:6.2f} %")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rays", type=int, default=1 << 20)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("scenes", nargs="+", metavar="SCENE")
    arguments = parser.parse_args()
    random = np.random.default_rng(1)
    for path in arguments.scenes:
        vertices, faces = read_scene(path)
        ours = kiwami.RaycastingScene(nthreads=arguments.threads)
        ours.add_triangles(vertices, faces)
        theirs = open3d.t.geometry.RaycastingScene()
        theirs.add_triangles(open3d.core.Tensor(vertices.copy()), open3d.core.Tensor(faces.copy()))
        bounds = ours.scene.bounds
        name = pathlib.Path(path).name
        compare(f"{name} primary", primary_rays(bounds, arguments.rays), ours, theirs, arguments)
        compare(f"{name} random", random_rays(bounds, arguments.rays, random), ours, theirs,
                arguments)


if __name__ == "__main__":
    main()
