# SPDX-License-Identifier: Apache-2.0
"""See bindings/benchmark/trace_file.c."""

import sys
import time

import numpy as np

import kiwami

scene_path, rays_path, rounds = sys.argv[1:]
rays = np.fromfile(rays_path, kiwami.ray_dtype)
scene = kiwami.Scene.load(scene_path, map=True, trusted=True)
hits = np.empty(len(rays), kiwami.hit_dtype)
for _ in range(int(rounds)):
    began = time.perf_counter()
    scene.closest(rays, out=hits)
    print(time.perf_counter() - began)
