# SPDX-License-Identifier: Apache-2.0
"""Filters."""

import gc
import threading
import weakref

import numpy as np
import pytest

import kiwami

UP = [0, 0, 1]


@pytest.fixture
def layers():
    """Eight triangles, one behind the other."""
    corners = np.array([[-1, -1, 0], [3, -1, 0], [-1, 3, 0]], np.float32)
    return kiwami.Scene(np.concatenate([corners + [0, 0, z] for z in range(8)]))


def as_records(origins, directions):
    return (kiwami.make_rays(origins, directions),)


def as_fields(origins, directions):
    return origins, directions


@pytest.mark.feature("filter callback")
@pytest.mark.parametrize("form", [as_records, as_fields])
def test_filters_accept_reject_and_stop(layers, form):
    rays = form(np.tile(np.float32([0, 0, -1]), (9, 1)), np.float32([UP] * 9))
    seen = []

    def odd(candidate):
        seen.append((candidate.ray, candidate.hit.geometry_id, candidate.depth))
        return candidate.hit.primitive_id % 2 == 1

    assert (layers.closest(*rays, filter=odd).primitive_id == 1).all()
    assert {ray for ray, _, _ in seen} == set(range(9))
    assert {each[1:] for each in seen} == {(0, 0)}
    assert layers.any(*rays, filter=odd).all()
    assert not layers.any(*rays, filter=lambda candidate: False).any()
    assert (layers.count(*rays, filter=odd) == 4).all()
    hits, offsets = layers.multi_hit(*rays, filter=odd)
    assert list(hits.primitive_id) == [1, 3, 5, 7] * 9 and offsets[-1] == 36
    stop = lambda candidate: kiwami.FILTER_ACCEPT_AND_STOP
    assert (layers.count(*rays, filter=stop) == 1).all()


@pytest.mark.parametrize("call", ["closest", "any", "count", "multi_hit"])
def test_what_a_filter_raises_is_the_cause_of_the_error(layers, call):
    def fail(candidate):
        raise KeyError("of the filter")

    with pytest.raises(kiwami.CallbackError, match="of the filter") as raised:
        getattr(layers, call)([[0, 0, -1]], [UP], filter=fail)
    assert isinstance(raised.value.__cause__, KeyError)
    assert raised.value.result == -6
    for bad in (lambda candidate: None, lambda candidate: 7):
        with pytest.raises(kiwami.CallbackError):
            getattr(layers, call)([[0, 0, -1]], [UP], filter=bad)
    assert layers.any([0, 0, -1], UP)


def test_nothing_of_a_filter_is_left_after_its_call(layers):
    class Filter:
        kept = []

        def __call__(self, candidate):
            self.kept.append(candidate)
            if len(self.kept) > 5:
                raise ValueError
            return True

    function = Filter()
    alive = weakref.ref(function)
    rays = kiwami.make_rays(np.zeros((2, 3)), [UP, UP])
    layers.closest(rays, filter=function)
    for _ in range(6):
        try:
            layers.closest(rays, filter=function)
        except kiwami.CallbackError:
            pass
    del function
    gc.collect()
    assert alive() is None
    assert Filter.kept[0].hit.t == 0  # candidates are copies


def test_filters_are_called_from_many_threads(layers):
    rays = kiwami.make_rays(np.tile([0, 0, -1.0], (3000, 1)), np.array(UP))
    found = [None] * 3

    def trace(i):
        found[i] = layers.closest(rays, filter=lambda each: each.hit.primitive_id >= i)

    threads = [threading.Thread(target=trace, args=(i,)) for i in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all((hits.primitive_id == i).all() for i, hits in enumerate(found))
