# SPDX-License-Identifier: Apache-2.0
"""The answers that every binding must give, to the bit."""

import numpy as np
import pytest
import vectors

import kiwami


def words_of(hits):
    return hits.records.view(np.uint32).reshape(-1, 9)


def check_scene(scene, expected, rays):
    assert (words_of(scene.closest(rays)) == expected["closest_hit"]).all()
    assert (scene.any(rays) == (expected["any_hit"] == 1)).all()
    for max_hits, offsets, hits in expected["multi_hit"]:
        found, found_offsets = scene.multi_hit(rays, max_hits=max_hits)
        assert (found_offsets == offsets).all()
        assert (words_of(found) == hits).all()
        if max_hits == 0:
            assert (scene.count(rays) == np.diff(offsets)).all()



@pytest.mark.feature("closest hit", "any hit", "multi hit", "counts")
@pytest.mark.parametrize("isa", ["auto", "scalar"])
def test_answers_are_the_same_to_the_bit(isa):
    device = kiwami.Device(isa=isa, validate=True)
    compared = 0
    for expected in vectors.scenes():
        scene = kiwami.Scene(device=device)
        for mask, vertices, faces in expected["meshes"]:
            scene.add(vertices, faces, mask=mask)
        rays = expected["rays"].view(kiwami.ray_dtype).reshape(-1)
        check_scene(scene, expected, rays)
        if "file" in expected:
            check_scene(kiwami.Scene.load(expected["file"], device=device), expected, rays)
        compared += len(expected["rays"])
    assert compared > 100


@pytest.mark.feature("fields apart")
def test_fields_that_lie_apart_give_the_same(random):
    for expected in vectors.scenes():
        scene = kiwami.Scene()
        for mask, vertices, faces in expected["meshes"]:
            scene.add(vertices, faces, mask=mask)
        rays = expected["rays"].view(kiwami.ray_dtype).reshape(-1)
        plain = rays[rays["flags"] == 0]
        hits = scene.closest(
            plain["origin"],
            plain["direction"],
            tmin=plain["tmin"],
            tmax=plain["tmax"],
            mask=plain["mask"],
        )
        assert (words_of(hits) == expected["closest_hit"][rays["flags"] == 0]).all()


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
