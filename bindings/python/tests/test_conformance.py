# SPDX-License-Identifier: Apache-2.0
"""The answers that every binding must give, to the bit."""

import numpy as np
import pytest
import vectors

import kiwami


def words_of(hits):
    return hits.records.view(np.uint32).reshape(-1, 9)


class Player:
    """Does what a file of vectors says, and compares the answers."""

    def __init__(self, device):
        self.device = device
        self.scenes = {}
        self.rays = None
        self.compared = 0

    def play(self, name):
        for word, value in vectors.statements(name):
            getattr(self, f"on_{word}")(value)
        assert self.compared > 100

    def on_scene(self, name):
        self.now = self.scenes[name] = kiwami.Scene(device=self.device)

    def on_mesh(self, value):
        mask, vertices, faces = value
        self.now.add(vertices, faces, mask=mask)

    def on_moving_mesh(self, value):
        mask, times, vertices, faces = value
        self.now.add_moving_mesh(vertices, faces, times=times, mask=mask)

    def on_spheres(self, value):
        self.now.add_spheres(value[1], mask=value[0])

    def on_discs(self, value):
        self.now.add_discs(*value[1:], mask=value[0])

    def on_curves(self, value):
        self.now.add_curves(*value[1:], mask=value[0])

    def on_instances(self, value):
        mask, names, indices, masks, transforms = value
        scenes = [self.scenes[name] for name in names]
        self.now.add_instances(
            scenes, transforms, scene_indices=indices, masks=masks, mask=mask
        )

    def on_vertices(self, value):
        self.now.move(*value)

    def on_enable(self, value):
        self.now.enable(*value)

    def on_remove(self, value):
        self.now.remove(value)

    def on_commit(self, _):
        self.now.commit()

    def on_refit(self, _):
        self.now.refit()

    def on_rays(self, rays):
        self.rays = rays.view(kiwami.ray_dtype).reshape(-1)
        self.compared += len(rays)

    def on_closest_hit(self, expected):
        assert (words_of(self.now.closest(self.rays)) == expected).all()

    def on_any_hit(self, expected):
        assert (self.now.any(self.rays) == (expected == 1)).all()

    def on_multi_hit(self, value):
        max_hits, offsets, hits = value
        found, found_offsets = self.now.multi_hit(self.rays, max_hits=max_hits)
        assert (found_offsets == offsets).all()
        assert (words_of(found) == hits).all()
        if max_hits == 0:
            assert (self.now.count(self.rays) == np.diff(offsets)).all()

    def on_file(self, path):
        expected = words_of(self.now.closest(self.rays))
        loaded = kiwami.Scene.load(path, device=self.device)
        assert (words_of(loaded.closest(self.rays)) == expected).all()

    def on_end(self, _):
        pass


def features(*names):
    return pytest.mark.feature(*names)


@pytest.mark.parametrize("isa", ["auto", "scalar"])
@pytest.mark.parametrize(
    "name",
    [
        pytest.param("vectors", marks=features("closest hit", "any hit", "multi hit", "counts")),
        pytest.param("shapes", marks=features("spheres, discs, curves")),
        pytest.param("moving_meshes", marks=features("moving meshes")),
        pytest.param("instances", marks=features("instances")),
        pytest.param("changes", marks=features("changes, refit")),
    ],
)
def test_answers_are_the_same_to_the_bit(name, isa):
    Player(kiwami.Device(isa=isa, validate=True)).play(name)


@pytest.mark.feature("fields apart")
def test_fields_that_lie_apart_give_the_same():
    scene = rays = None
    for word, value in vectors.statements("vectors"):
        if word == "scene":
            scene = kiwami.Scene()
        elif word == "mesh":
            scene.add(*value[1:], mask=value[0])
        elif word == "rays":
            rays = value.view(kiwami.ray_dtype).reshape(-1)
        elif word == "closest_hit":
            plain = rays[rays["flags"] == 0]
            hits = scene.closest(
                plain["origin"],
                plain["direction"],
                tmin=plain["tmin"],
                tmax=plain["tmax"],
                mask=plain["mask"],
            )
            assert (words_of(hits) == value[rays["flags"] == 0]).all()


@pytest.mark.feature("errors")
def test_errors_are_the_same():
    scene = kiwami.Scene()
    calls = {
        "unknown_geometry": lambda: scene.remove(5),
        "parameter_out_of_bounds": lambda: scene.set_parameter(
            kiwami.PARAMETER_BIN_COUNT, 1000.0
        ),
    }
    for name, call in calls.items():
        with pytest.raises(kiwami.InvalidArgumentError) as raised:
            call()
        assert (raised.value.result, str(raised.value)) == vectors.errors()[name]
