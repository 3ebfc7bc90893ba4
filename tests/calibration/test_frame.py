"""Tests of frames from touched points, compared with known frames."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from yarclang.calibration.frame import find_frame

ORIGIN = np.array([0.8, 0.2, 0.3])


@given(
    st.integers(0, 10**6),
    st.lists(
        st.tuples(st.floats(-0.3, 0.6), st.floats(0.05, 0.7)).filter(lambda p: p[1] > 0.1 * abs(p[0])),
        min_size=1,
        max_size=5,
    ),
    st.floats(0.02, 1.0),
)
def test_the_frame_is_found_wherever_it_is(seed, in_plane, on_x):
    rotation = Rotation.random(random_state=seed).as_matrix()
    points = [ORIGIN + rotation @ [x, y, 0.0] for x, y in in_plane]
    found = find_frame(ORIGIN, ORIGIN + rotation @ [on_x, 0.0, 0.0], points)
    assert found.value is not None
    np.testing.assert_allclose(found.value.base_from_frame[:3, :3], rotation, atol=1e-9)
    np.testing.assert_allclose(found.value.base_from_frame[:3, 3], ORIGIN)
    assert np.abs(found.value.heights).max() < 1e-9
    assert not found.diagnostics


def test_points_off_the_plane_are_told():
    points = ORIGIN + np.array([[0.1, 0.3, 0.0], [0.4, 0.3, 0.003], [0.3, 0.1, 0.0]])
    found = find_frame(ORIGIN, ORIGIN + np.array([0.4, 0.0, 0.0]), list(points))
    assert found.value is not None
    assert [one.code for one in found.diagnostics] == ["Y1904"]
    assert np.abs(found.value.heights[3]) == np.abs(found.value.heights).max()
    tilt = np.degrees(np.arccos(found.value.base_from_frame[2, 2]))
    assert 0.01 < tilt < 1.0


@pytest.mark.parametrize(
    ("on_x", "on_plane", "code", "word"),
    [
        ([0.3, 0, 0], [], "Y1901", "no point of the plane"),
        ([0.005, 0, 0], [[0, 0.3, 0]], "Y1903", "the point on x is 5.0 mm"),
        ([0.3, 0, 0], [[0, 0, 0]], "Y1903", "point 1 of the plane is 0.0 mm"),
        ([0.3, 0, 0], [[0.2, 0.001, 0]], "Y1903", "in a line"),
        ([0.3, 0, 0], [[-0.2, 0.0, 0]], "Y1903", "in a line"),
        ([0.3, 0, 0], [[0.0, 0.3, 0], [0.1, -0.2, 0]], "Y1903", "other side"),
    ],
)
def test_points_that_give_no_frame(on_x, on_plane, code, word):
    found = find_frame(ORIGIN, ORIGIN + on_x, [ORIGIN + point for point in on_plane])
    assert found.value is None
    assert [one.code for one in found.diagnostics] == [code]
    assert word in found.diagnostics[0].message
