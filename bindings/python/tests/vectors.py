# SPDX-License-Identifier: Apache-2.0
"""Reads the conformance vectors; see bindings/conformance/README.md."""

import pathlib

import numpy as np

PATH = pathlib.Path(__file__).resolve().parents[2] / "conformance" / "vectors.txt"


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


def scenes():
    """Every scene as a dict: name, meshes (mask, vertices, faces), rays, and the answers."""
    words = Words(PATH.read_text())
    assert (words.word(), words.word()) == ("kiwami-conformance", "1")
    while words.word() == "scene":
        yield _scene(words)


def _scene(words):
    scene = {"name": words.word(), "meshes": [], "multi_hit": []}
    while True:
        word = words.word()
        if word == "mesh":
            mask, vertex_count, triangle_count = (words.number() for _ in range(3))
            vertices = words.words(vertex_count, 3).view(np.float32)
            scene["meshes"].append((mask, vertices, words.words(triangle_count, 3)))
        elif word == "rays":
            count = words.number()
            scene["rays"] = words.words(count, 12)
        elif word == "closest_hit":
            scene["closest_hit"] = words.words(count, 9)
        elif word == "any_hit":
            scene["any_hit"] = words.words(count)
        elif word == "multi_hit":
            max_hits, total = words.number(), words.number()
            scene["multi_hit"].append((max_hits, words.numbers(count + 1), words.words(total, 9)))
        elif word == "file":
            scene["file"] = PATH.parent / words.word()
        else:
            assert word == "end"
            return scene


def errors():
    """name -> (result, sentence)."""
    found = {}
    for line in PATH.read_text().splitlines():
        if line.startswith("error "):
            _, name, result, sentence = line.split(" ", 3)
            found[name] = (int(result), sentence)
    return found
