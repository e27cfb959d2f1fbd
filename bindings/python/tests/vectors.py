# SPDX-License-Identifier: Apache-2.0
"""Reads the conformance vectors; see bindings/conformance/README.md."""

import pathlib

import numpy as np

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "conformance"


class Words:
    def __init__(self, text):
        self._words = iter(text.split())

    def word(self):
        return next(self._words)

    def number(self):
        return int(self.word())

    def numbers(self, *shape):
        count = int(np.prod(shape, dtype=int))
        return np.array([self.number() for _ in range(count)], np.uint64).reshape(shape)

    def words(self, *shape):
        return self.numbers(*shape).astype(np.uint32)


def statements(name):
    """Every statement of a file as a tuple of its word and what follows it."""
    words = Words((FOLDER / f"{name}.txt").read_text())
    assert (words.word(), words.word()) == ("kiwami-conformance", "1")
    rays = 0
    while True:
        try:
            word = words.word()
        except StopIteration:
            return
        if word == "error":
            return
        if word in ("rays", "receivers"):
            rays = words.number()
        yield word, _READERS[word](words, rays)


def _floats(words, *shape):
    return words.words(*shape).view(np.float32)


def _mesh(words, _):
    mask, vertex_count, triangle_count = (words.number() for _ in range(3))
    return mask, _floats(words, vertex_count, 3), words.words(triangle_count, 3)


def _moving_mesh(words, _):
    mask, steps, begin, end, vertex_count, triangle_count = (words.number() for _ in range(6))
    times = np.array([begin, end], np.uint32).view(np.float32)
    vertices = _floats(words, steps, vertex_count, 3)
    return mask, tuple(times.tolist()), vertices, words.words(triangle_count, 3)


def _discs(words, _):
    mask, count = words.number(), words.number()
    return mask, _floats(words, count, 4), _floats(words, count, 3)


def _curves(words, _):
    mask, point_count, segment_count = (words.number() for _ in range(3))
    return mask, _floats(words, point_count, 4), words.words(segment_count)


def _instances(words, _):
    mask, scene_count, count = (words.number() for _ in range(3))
    names = [words.word() for _ in range(scene_count)]
    rows = words.words(count, 14)
    transforms = np.ascontiguousarray(rows[:, 2:]).view(np.float32).reshape(-1, 3, 4)
    return mask, names, rows[:, 0], rows[:, 1], transforms


def _multi_hit(words, rays):
    max_hits, total = words.number(), words.number()
    return max_hits, words.numbers(rays + 1), words.words(total, 9)


def _light_mesh(words, _):
    is_two_sided, radiance = words.number() != 0, float(_floats(words, 1)[0])
    vertex_count, triangle_count = words.number(), words.number()
    return is_two_sided, radiance, _floats(words, vertex_count, 3), words.words(triangle_count, 3)


_READERS = {
    "scene": lambda words, _: words.word(),
    "mesh": _mesh,
    "moving_mesh": _moving_mesh,
    "spheres": lambda words, _: (words.number(), _floats(words, words.number(), 4)),
    "discs": _discs,
    "curves": _curves,
    "instances": _instances,
    "vertices": lambda words, _: (words.number(), _floats(words, words.number(), 3)),
    "enable": lambda words, _: (words.number(), words.number() != 0),
    "remove": lambda words, _: words.number(),
    "commit": lambda words, _: None,
    "refit": lambda words, _: None,
    "rays": lambda words, rays: words.words(rays, 12),
    "closest_hit": lambda words, rays: words.words(rays, 9),
    "any_hit": lambda words, rays: words.words(rays),
    "multi_hit": _multi_hit,
    "file": lambda words, _: FOLDER / words.word(),
    "lights": lambda words, _: words.number(),
    "light": lambda words, _: words.words(words.number(), 24),
    "light_mesh": _light_mesh,
    "powers": lambda words, _: (words.number(), _floats(words, words.number())),
    "receivers": lambda words, count: words.words(count, 14),
    "choices": lambda words, count: words.words(count, 6),
    "pdf": lambda words, count: words.words(count),
    "end": lambda words, _: None,
}


def errors():
    """name -> (result, sentence)."""
    found = {}
    for line in (FOLDER / "vectors.txt").read_text().splitlines():
        if line.startswith("error "):
            _, name, result, sentence = line.split(" ", 3)
            found[name] = (int(result), sentence)
    return found
