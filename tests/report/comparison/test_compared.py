"""Two programs compared by path and time."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import compiled

from yarclang.motion.curve import Curve
from yarclang.pipeline.executed import Act, executed
from yarclang.report.comparison.compared import compare
from yarclang.report.comparison.paired import pairs_of
from yarclang.report.comparison.path_difference import path_difference
from yarclang.report.comparison.text import compared_json, compared_lines
from yarclang.robot.description import load_robot
from yarclang.robot.model import Tolerance
from yarclang.units import DEG, MM

ROBOT = load_robot("INDUSTRIAL6").value
HEAD = "DEFAULT {TCP} [2] (mm,deg,s) {B}\nINPUT DOOR M11\nOUTPUT GLUE M1\n"
BASE = [
    "P0010 MOVEJ 0 -10 -20 0 -60 0",
    "P0020 DMOVE 50 0 0 0 0 0 {B}",
    "P0030 SET GLUE ON",
    "P0040 WAIT [0.5]",
    "P0050 DMOVE 0 50 0 0 0 0 {B}",
    "P0060 WAIT DOOR ON [5]",
    "P0070 MOVEJ 0 0 0 0 0 0",
]


def program(*lines, target="rotary", start=None):
    value, found = compiled(HEAD + "\n".join(lines) + "\n", target=target, start=start)
    assert value is not None, found
    return executed(value.text, ROBOT, "test").value


def compared(first, second, tolerance=ROBOT.tolerance):
    return compare(program(*first), program(*second), tolerance)


def changed(lines, number, line):
    return [*lines[:number], line, *lines[number + 1 :]]


def differences(comparison):
    json.dumps(compared_json(comparison), allow_nan=False)
    return [one for one in comparison.commands if one.status != "same"]


def words(comparison):
    return "\n".join(line for _, line in compared_lines(comparison))


def test_a_text_is_read_as_it_was_planned():
    value, _ = compiled(HEAD + "\n".join(BASE))
    acts = executed(value.text, ROBOT, "test").value.acts
    motions = [one for one in acts if one.kind == "motion"]
    assert [one.place for one in acts] == [line[:5] for line in BASE]
    for act, motion in zip(motions, value.plan.motions, strict=True):
        assert act.duration == pytest.approx(motion.curve.duration)
        assert np.abs(act.curve.points - motion.curve.points).max() < 1e-6
    assert [one.duration for one in acts if one.kind == "dwell"] == [0.5]


@pytest.mark.parametrize("target", ["rotary", "prog"])
def test_a_program_equals_itself_in_either_target(target):
    comparison = compare(program(*BASE), program(*BASE, target=target), ROBOT.tolerance)
    assert comparison.equal
    assert comparison.count("same") == len(BASE)
    assert "7 same" in words(comparison)


def test_comments_layout_and_renumbering_are_no_difference():
    again = [f"  {line.lower().replace('p00', 'p01')}   ! remark" for line in BASE]
    comparison = compared(BASE, again)
    assert comparison.equal
    assert comparison.commands[0].second.place == "P0110"


@pytest.mark.parametrize("place", range(len(BASE)))
def test_an_inserted_command_is_told_as_inserted(place):
    new = "P0005 WAIT [0.25]"
    with_it = [*BASE[:place], new, *BASE[place:]]
    lines = [f"P{10 * number:04d}{line[5:]}" for number, line in enumerate(with_it, 1)]
    comparison = compared(BASE, lines)
    assert [one.status for one in differences(comparison)] == ["added"]
    back = compared(lines, BASE)
    assert [one.status for one in differences(back)] == ["removed"]
    assert "removed: stands for 250 ms" in words(back)


def test_an_inserted_motion_changes_the_way_of_the_next():
    comparison = compared(BASE, [*BASE[:6], "P0065 DMOVEJ 0 0 0 0 0 20", BASE[6]])
    assert [one.status for one in differences(comparison)] == ["added", "changed"]


def test_another_path_says_by_how_much_and_where():
    comparison = compared(BASE, changed(BASE, 1, "P0020 DMOVE 50 0 3 0 0 0 {B}"))
    first, second, _ = differences(comparison)
    assert first.second.place == "P0020"
    assert first.path.position == pytest.approx(3 * MM, abs=0.01 * MM)
    assert first.path.at == pytest.approx(1.0)
    assert second.second.place == "P0050"
    assert not first.other_branch
    assert first.longer == 0.0
    assert "path differs by at most 3 mm" in words(comparison)
    assert compared(BASE, changed(BASE, 1, "P0020 DMOVE 50 0 3 0 0 0 {B}"), Tolerance(4 * MM, 1 * DEG)).equal


def test_another_time_or_profile_is_no_other_path():
    comparison = compared(BASE, changed(BASE, 1, "P0020 DMOVE_POLY5 50 0 0 0 0 0 [3] {B}"))
    (one,) = differences(comparison)
    assert (one.differs, one.longer) == (False, pytest.approx(1.0))
    assert one.path.position < 0.001 * MM
    assert "2.000 s -> 3.000 s (+1.000 s)" in words(comparison)


def test_another_branch_is_told():
    near = "JOINTS TURNED 0 -10 -20 180 60 180 (deg)"
    pose = "P0010 MOVEJ_RPY 0 1174.4 1076 20 0 0 [5]"
    one = compared([near, pose], [near, f"{pose} NEAR TURNED"])
    (found,) = differences(one)
    assert found.other_branch
    assert "another configuration: J" in words(one)


@pytest.mark.parametrize(
    ("number", "line", "told"),
    [
        (2, "P0030 SET GLUE OFF", "M1 becomes 1 -> M1 becomes 0"),
        (3, "P0040 WAIT [0.6]", "stands for 500 ms -> stands for 600 ms"),
        (5, "P0060 WAIT DOOR ON [6]", "at most 5 s -> "),
        (5, "P0060 WAIT DOOR OFF [5]", "(M11=0)"),
    ],
)
def test_what_moves_nothing(number, line, told):
    comparison = compared(BASE, changed(BASE, number, line))
    assert [one.status for one in differences(comparison)] == ["changed"]
    assert told in words(comparison)


def test_another_start_is_a_difference():
    elsewhere = np.array([5.0, 0, 0, 0, 0, 0]) * DEG
    comparison = compare(program(*BASE), program(*BASE, start=elsewhere), ROBOT.tolerance)
    assert comparison.starts_elsewhere
    assert "starts elsewhere: J1 by +5 deg" in words(comparison)


def test_a_text_that_is_none_is_refused():
    value, _ = compiled(HEAD + BASE[0])
    broken = executed(value.text.replace("SPLINE1\n", "SPLINE2\n"), ROBOT, "test")
    assert [one.code for one in broken.diagnostics] == ["Y1151"]


# laws


def curve(points, segment=0.05):
    points = np.array(points, dtype=float)
    return Curve(np.concatenate((points[[0, 0]], points, points[[-1, -1]])), segment, np.empty(0))


JOINTS = st.lists(st.floats(-0.5, 0.5), min_size=6, max_size=6)


@settings(max_examples=25, deadline=None)
@given(st.lists(JOINTS, min_size=2, max_size=5), st.floats(0.02, 0.5))
def test_a_path_is_itself_at_any_pace(points, segment):
    one = curve(points)
    found = path_difference(ROBOT, "TCP", one, Curve(one.points + 1e-12, segment, one.law))
    assert found.position < 1e-6
    assert found.angle < 1e-6


@settings(max_examples=25, deadline=None)
@given(JOINTS, JOINTS, JOINTS)
def test_the_difference_is_that_of_the_ends_at_least(start, end, other):
    one, two = curve([start, end]), curve([start, other])
    found, back = path_difference(ROBOT, "TCP", one, two), path_difference(ROBOT, "TCP", two, one)
    assert found.position == pytest.approx(back.position)
    assert found.joint_off * DEG >= np.abs(np.array(end) - other).max() - 1e-9


@settings(max_examples=50, deadline=None)
@given(st.lists(st.sampled_from("abcde"), max_size=12), st.lists(st.sampled_from("abcde"), max_size=12))
def test_pairs_keep_all_commands_in_order(first, second):
    one = [Act("set", f"P{n}", "SET", n, what) for n, what in enumerate(first)]
    other = [Act("set", f"P{n}", "SET", n, what) for n, what in enumerate(second)]
    pairs = pairs_of(one, other)
    assert [pair[0] for pair in pairs if pair[0] is not None] == one
    assert [pair[1] for pair in pairs if pair[1] is not None] == other
    assert pairs_of(one, one) == [(act, act) for act in one]


def test_many_commands_are_paired_by_place():
    one = [Act("motion", f"P{n}", "MOVEJ", n, "", curve([[0.0] * 6, [0.001 * n] * 6])) for n in range(600)]
    other = [
        Act("motion", f"P{n}", "MOVEJ", n, "", curve([[0.0] * 6, [2.0 + 0.001 * n] * 6])) for n in range(600)
    ]
    assert all(a.place == b.place for a, b in pairs_of(one, other))
