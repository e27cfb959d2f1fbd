# SPDX-License-Identifier: Apache-2.0
import copy
import pickle

import numpy as np
import pytest

import kiwami


@pytest.fixture
def rays(random):
    return kiwami.make_rays(random.uniform(-2, 2, (500, 3)), random.uniform(-1, 1, (500, 3)))


def same(first, second, rays):
    return (first.closest(rays).records == second.closest(rays).records).all()


@pytest.mark.parametrize("options", [{}, {"map": True}, {"map": True, "trusted": True}])
def test_a_file_gives_the_same_hits(ball, rays, tmp_path, options):
    path = tmp_path / "ball.kiwami"
    ball.save(path)
    loaded = kiwami.Scene.load(path, **options)
    assert same(ball, loaded, rays)
    assert loaded.info["triangle_count"] == 1280
    loaded.add([[5, 5, 5], [6, 5, 5], [5, 6, 5]])
    assert loaded.closest([5.1, 5.1, 0], [0, 0, 1]).geometry_id == 1


@pytest.mark.feature("files")
def test_scenes_are_pickled_and_copied(ball, rays):
    for again in (pickle.loads(pickle.dumps(ball)), copy.deepcopy(ball)):
        assert same(ball, again, rays)


def test_damaged_bytes_are_an_error(ball, tmp_path):
    data = bytearray(ball.to_bytes())
    data[len(data) // 2] ^= 1
    with pytest.raises(kiwami.InvalidFileError):
        kiwami.Scene.from_bytes(bytes(data))
    with pytest.raises(kiwami.InvalidFileError):
        kiwami.Scene.from_bytes(bytes(data[:100]))
    with pytest.raises(OSError):
        kiwami.Scene.load(tmp_path / "missing.kiwami")
    with pytest.raises(OSError):
        ball.save(tmp_path / "missing" / "ball.kiwami")


def test_empty_scenes_are_pickled():
    empty = pickle.loads(pickle.dumps(kiwami.Scene()))
    assert not empty.any(np.zeros(3), np.ones(3))
