"""Tests of the labels in the picture."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from yarclang.view.labels import Label, labelled, raised, spots
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


EYE, MIDDLE = np.array([4.0, 3.0, 2.0]), np.zeros(3)


def boxes(labels, heights):
    """Return the rectangles of labels on a screen 800 pixels high.

    They are computed with a pinhole camera, from the camera's axes and similar triangles.
    """
    z = (EYE - MIDDLE) / np.linalg.norm(EYE - MIDDLE)
    x = np.cross([0.0, 0.0, 1.0], z) / np.linalg.norm(np.cross([0.0, 0.0, 1.0], z))
    y = np.cross(z, x)
    found = []
    for label, height in zip(labels, heights, strict=True):
        seen = np.array([x, y, z]) @ (label.place + np.array([0.0, 0.0, height]) - EYE)
        u, v = 400.0 / np.tan(np.radians(37.5)) * seen[:2] / -seen[2]
        wide, high = 8.0 * label.scale * len(label.text), 14.0 * label.scale
        left = u - wide / 2.0 if label.anchor == "bottom-center" else u
        low = v - high if label.anchor == "top-left" else v
        found.append((left, low, left + wide, low + high))
    return found


@given(
    st.lists(
        st.tuples(
            st.tuples(*[st.floats(-0.5, 0.5)] * 3),
            st.sampled_from(["{B}", "{FIXTURE}", "Y0901, Y0501"]),
            st.sampled_from(["bottom-center", "bottom-left", "top-left"]),
        ),
        max_size=12,
    )
)
def test_no_label_lies_on_another_in_the_first_view(drawn):
    labels = [Label(text, np.array(place), 0.8, anchor) for place, text, anchor in drawn]
    heights = raised(labels, EYE, MIDDLE)
    assert heights[:1] == pytest.approx([0.0] * len(heights[:1]), abs=1e-12)
    assert min(heights, default=0.0) >= 0.0
    seen = boxes(labels, heights)
    for number, one in enumerate(seen):
        for other in seen[:number]:
            gap = max(one[0] - other[2], other[0] - one[2], one[1] - other[3], other[1] - one[3])
            assert gap > -1e-6, (one, other)


def test_labels_that_are_apart_stay_where_they_are():
    labels = [Label("{A}", np.array([0.0, 0.0, height]), 0.7, "top-left") for height in (0.0, 1.0)]
    assert raised(labels, EYE, MIDDLE) == pytest.approx([0.0, 0.0])
    # a label behind the eye overlaps no other one
    labels.append(Label("{A}", 3.0 * EYE, 0.7, "top-left"))
    assert raised(labels, EYE, MIDDLE)[2] == 0.0
