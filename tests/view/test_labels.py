"""Which labels are written."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from yarclang.view.labels import labelled, spots
from yarclang.view.stage import Mark


def mark(piece):
    return Mark("Y0901", "error", "", "", 0.0, np.zeros(3), piece)


@given(st.lists(st.tuples(*[st.floats(-1.0, 1.0)] * 3), max_size=30), st.floats(0.01, 1.0))
def test_each_place_is_at_one_spot_and_spots_are_apart(places, apart):
    points = np.array(places).reshape(-1, 3)
    found = spots(points, apart)
    assert sorted(number for spot in found for number in spot) == list(range(len(points)))
    firsts = points[[spot[0] for spot in found]]
    for row, first in enumerate(firsts):
        assert (np.linalg.norm(firsts[:row] - first, axis=1) >= apart).all()
    for spot in found:
        assert (np.linalg.norm(points[spot] - points[spot[0]], axis=1) < apart).all()


def test_findings_of_the_command_at_hand_and_its_neighbours_have_labels():
    marks = [mark(piece) for piece in (0, 1, 1, 2, 3, -1)]
    assert labelled(marks, 0) == {0, 1, 2, 5}
    assert labelled(marks, 2) == {1, 2, 3, 4, 5}
    assert labelled(marks, 9) == {5}
    assert labelled(marks, -1) == set(range(6))


def test_of_many_findings_the_command_at_hand_comes_first():
    marks = [mark(piece) for piece in (0, 1) for _ in range(40)]
    assert labelled(marks, 1) == set(range(40, 64))
    assert labelled([], 3) == frozenset()
