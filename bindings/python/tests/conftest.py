# SPDX-License-Identifier: Apache-2.0
import os

import numpy as np
import pytest

import kiwami


def pytest_configure(config):
    config.addinivalue_line("markers", "feature(*names): what the test shows to be right")


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item, call):
    """Notes the features of tests that passed, for the table of the documents."""
    report = (yield).get_result()
    path = os.environ.get("KIWAMI_FEATURES")
    if path and report.when == "call" and report.passed:
        with open(path, "a") as file:
            for mark in item.iter_markers("feature"):
                file.writelines(f"{name}\n" for name in mark.args)


@pytest.fixture
def sphere():
    """A closed mesh of 1,280 triangles around the origin: vertices, faces."""
    golden = (1 + 5**0.5) / 2
    vertices = [(-1, golden, 0), (1, golden, 0), (-1, -golden, 0), (1, -golden, 0)]
    vertices += [(z, x, y) for x, y, z in vertices] + [(y, z, x) for x, y, z in vertices]
    faces = []
    for a in range(12):
        for b in range(12):
            for c in range(12):
                if a < b and a < c and b != c:
                    corners = np.array([vertices[a], vertices[b], vertices[c]])
                    edges = corners - np.roll(corners, 1, axis=0)
                    is_short = np.allclose((edges**2).sum(axis=1), 4)
                    if is_short and np.linalg.det(corners) > 0:
                        faces.append((a, b, c))
    vertices = [tuple(np.array(v) / np.linalg.norm(v)) for v in vertices]
    for _ in range(3):
        faces = _subdivide(vertices, faces)
    assert len(faces) == 1280
    return np.array(vertices), np.array(faces)


def _subdivide(vertices, faces):
    middles = {}

    def middle(a, b):
        key = min(a, b), max(a, b)
        if key not in middles:
            point = np.array(vertices[a]) + np.array(vertices[b])
            vertices.append(tuple(point / np.linalg.norm(point)))
            middles[key] = len(vertices) - 1
        return middles[key]

    smaller = []
    for a, b, c in faces:
        ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
        smaller += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return smaller


@pytest.fixture
def random():
    """Random numbers; the seed is in the name of the failure's report."""
    return np.random.default_rng(2019)


@pytest.fixture
def ball(sphere):
    return kiwami.Scene(*sphere)
