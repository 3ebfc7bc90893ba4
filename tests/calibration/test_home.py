"""Tests of motor offsets from joints at their marks, for an arm whose motor 3 moves with two joints."""

from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from yarclang.calibration.home import find_offsets
from yarclang.robot.actuation import from_counts, to_counts
from yarclang.robot.description import load_robot
from yarclang.units import DEG

ROBOT = load_robot("industrial6").value
assert ROBOT is not None
NAMES = ROBOT.joint_names


def with_offset(a0):
    return replace(ROBOT, actuation=replace(ROBOT.actuation, offset=np.asarray(a0, dtype=float)))


@given(
    st.lists(st.floats(-1e6, 1e6), min_size=6, max_size=6),
    st.lists(st.floats(-1.5, 1.5), min_size=6, max_size=6),
    st.sets(st.sampled_from(NAMES), min_size=1),
)
def test_marked_joints_read_their_marks_and_the_others_what_they_read_before(a0, q, marked):
    believed = with_offset(a0)
    counts = to_counts(ROBOT, np.array(q))
    marks = {name: 0.1 * at for at, name in enumerate(NAMES) if name in marked}
    found = find_offsets(believed, [counts], marks)
    assert found.value is not None
    assert not found.diagnostics
    before, now = from_counts(believed, counts), from_counts(with_offset(found.value.offsets), counts)
    for at, name in enumerate(NAMES):
        assert abs(now[at] - (marks[name] if name in marks else before[at])) < 1e-9
    np.testing.assert_allclose(now - before, found.value.shift, atol=1e-9)


def test_visits_are_averaged_and_their_spread_is_told():
    counts = [to_counts(ROBOT, np.array([0, off, 0, 0, 0, 0]) * DEG) for off in (-0.1, 0.1, 0.0)]
    found = find_offsets(ROBOT, counts, {"J2": 0.0})
    assert found.value is not None
    np.testing.assert_allclose(found.value.spread[1], 0.1 * DEG, rtol=1e-9)
    assert np.all(found.value.spread[[0, 2, 3, 4, 5]] == 0.0)
    assert [one.code for one in found.diagnostics] == ["Y1904"]
    assert "J2 differ by 0.100 deg" in found.diagnostics[0].message


def test_what_is_missing():
    assert [one.code for one in find_offsets(ROBOT, [], {"J1": 0.0}).diagnostics] == ["Y1901"]
    assert [one.code for one in find_offsets(ROBOT, [np.zeros(6)], {}).diagnostics] == ["Y1901"]
    (finding,) = find_offsets(ROBOT, [np.zeros(6)], {"J7": 0.0}).diagnostics
    assert finding.code == "Y1905"
    assert "J1" in finding.help
