# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
import vectors

import kiwami

# Two squares that shine downwards at height 5, the second 100 times as bright and far away.
SQUARE = np.array([[0, 0, 5], [0, 1, 5], [1, 1, 5], [1, 0, 5]], float)
FACES = [[0, 1, 2], [0, 2, 3]]


@pytest.fixture
def lights():
    tree = kiwami.LightTree()
    assert tree.add_mesh(SQUARE, FACES) == 0
    assert tree.add_mesh(SQUARE + [100, 0, 0], FACES, radiance=[100, 100]) == 2
    return tree


class LightPlayer:
    """Does what the file of vectors says, and compares the choices."""

    def __init__(self, device):
        self.device = device
        self.compared = 0

    def on_lights(self, width):
        self.lights = kiwami.LightTree(self.device, width=width)

    def on_light(self, words):
        self.lights.add_lights(words.view(kiwami.light_dtype).reshape(-1))

    def on_light_mesh(self, value):
        is_two_sided, radiance, vertices, faces = value
        self.lights.add_mesh(vertices, faces, radiance=radiance, two_sided=is_two_sided)

    def on_powers(self, value):
        self.lights.set_powers(*value)

    def on_commit(self, _):
        self.lights.commit()

    def on_refit(self, _):
        self.lights.refit()

    def on_receivers(self, words):
        self.receivers = words.view(kiwami.light_receiver_dtype).reshape(-1)

    def on_choices(self, expected):
        self.choices = self.lights.sample(self.receivers)
        assert (self.choices.view(np.uint32).reshape(-1, 6) == expected).all()
        self.compared += len(expected)

    def on_pdf(self, expected):
        found = self.lights.pdf(
            self.receivers, None, self.choices["light_id"], self.choices["instance_id"]
        )
        assert (found.view(np.uint32) == expected).all()

    def on_end(self, _):
        self.lights.close()


@pytest.mark.parametrize("isa", ["auto", "scalar"])
@pytest.mark.feature("many lights")
def test_choices_are_the_same_to_the_bit(isa):
    player = LightPlayer(kiwami.Device(isa=isa, validate=True))
    for word, value in vectors.statements("lights"):
        getattr(player, f"on_{word}")(value)
    assert player.compared > 100


def test_probabilities_are_those_of_the_samples(lights, random):
    points = random.uniform([-5, -5, 0], [105, 5, 4], (2000, 3))
    normals = np.array([0, 0, 1.0])
    choices = lights.sample(points, normals, random.random(2000))
    assert set(choices["light_id"]) == {0, 1, 2, 3}
    assert (choices["probability"] > 0).all()
    again = lights.pdf(points, normals, choices["light_id"], choices["instance_id"])
    assert (again == choices["probability"]).all()
    total = sum(lights.pdf(points, normals, light).astype(float) for light in range(4))
    assert np.allclose(total, 1, atol=1e-4)


def test_near_lights_are_chosen_near_them(lights):
    assert lights.pdf([[0.5, 0.5, 4]], [[0, 0, 1]], 0) > 0.3
    assert lights.pdf([[100.5, 0.5, 4]], [[0, 0, 1]], 0) < 1e-3


def test_single_lights_powers_and_masks():
    tree = kiwami.LightTree()
    lights = np.zeros(2, kiwami.light_dtype)
    lights["type"] = kiwami.LIGHT_POINT
    lights["points"][:, :3] = [[0, 0, 1], [0, 0, 1]]
    lights["power"], lights["user_id"], lights["link_mask"] = [1, 3], [7, 8], [1, 3]
    assert tree.add_lights(lights) == 0
    point, normal = [[0, 0, 0]], [[0, 0, 1]]
    assert tree.pdf(point, normal, 1) == pytest.approx(0.75)
    assert tree.pdf(point, normal, 1, link_mask=2) == 1
    assert tree.sample(point, normal, [0.99], link_mask=2)["user_id"] == 8
    tree.set_powers(0, [3, 1])
    tree.refit()
    assert tree.pdf(point, normal, 1) == pytest.approx(0.25)
    assert tree.info["light_count"] == 2


def test_bad_lights_are_named(lights):
    with pytest.raises(ValueError, match="radiance"):
        lights.add_mesh(SQUARE, FACES, radiance=[1, 2, 3])
    with pytest.raises(kiwami.InvalidArgumentError):
        lights.add_mesh(SQUARE, FACES, radiance=-1)
    with pytest.raises(ValueError, match="builder"):
        kiwami.LightTree(builder="best")
    bad = np.zeros(1, kiwami.light_dtype)
    bad["type"] = 99
    with pytest.raises(kiwami.InvalidArgumentError, match="99"):
        lights.add_lights(bad)
