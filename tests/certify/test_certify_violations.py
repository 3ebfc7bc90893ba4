"""Tests of all kinds of violations: when a correct text is changed, the violation is found at its command,
with its figures.
"""

from dataclasses import replace

import numpy as np
import pytest

from tests.certify.certify_bench import (
    DEG,
    FLANGE_FROM_TCP,
    Job,
    emit,
    everything,
    industrial6,
    joint_points,
    origin,
    program,
    railed,
)
from yarclang import hir
from yarclang.certify import certify
from yarclang.certify.claims import Claims
from yarclang.findings import CATALOGUE
from yarclang.robot.kinematics.fk import poses_and_jacobians
from yarclang.robot.model import Tolerance

TOLERANCE = Tolerance()


def judge(text, case=None, **changes):
    case = case or everything()
    with_defaults = {"program": case.program, "witnesses": case.witnesses, **changes}
    return certify(text, with_defaults["program"], case.robot, TOLERANCE, Claims(with_defaults["witnesses"]))


def codes(result):
    assert all(finding.code in CATALOGUE and finding.is_error for finding in result.diagnostics)
    return [finding.code for finding in result.diagnostics]


def with_points(step, change):
    """Return the text after a change of one command's points."""
    case = everything()
    jobs = [*case.jobs]
    jobs[step] = replace(jobs[step], points=change(jobs[step].points.copy()))
    return replace(case, jobs=tuple(jobs)).text()


def moves(text):
    lines = text.split("\n")
    return lines, [i for i, line in enumerate(lines) if line.startswith("X")]


@pytest.mark.parametrize("step", range(8))
def test_a_point_that_is_moved(step):
    """The elbow is moved by 0.03 deg, which is half a millimetre at the tool."""

    def move(points):
        points[len(points) // 2, 2] += 0.03 * DEG
        return points

    result = judge(with_points(step, move))
    assert "Y1159" in codes(result)
    for finding in result.diagnostics:
        assert finding.span == everything().jobs[step].motion.origin.span
        assert finding.message.startswith(f"P{step + 1:04d} ")
    deviation = result.value.commands[step].deviation
    if everything().jobs[step].motion.origin.name == "MOVEL":
        assert 1e-4 < deviation.position < 1e-3
    else:
        assert 0.01 * DEG < deviation.angle < 0.06 * DEG
    # The other commands have the same deviations as before.
    good = judge(everything().text()).value
    assert [c.deviation for i, c in enumerate(result.value.commands) if i != step] == [
        c.deviation for i, c in enumerate(good.commands) if i != step
    ]


@pytest.mark.parametrize("target", ["rotary", "prog"])
def test_a_digit_that_is_changed(target):
    """A number is changed in the text itself, for both targets."""
    lines, places = moves(everything().text(target))
    at = places[40]
    head, tail = lines[at].split("Y")
    lines[at] = f"X{float(head[1:]) + 0.05:.9f}Y{tail}"
    assert codes(judge("\n".join(lines)))


def test_another_segment_time():
    text = everything().text()
    result = judge(text.replace("TM47.5\n", "TM47.25\n"))
    assert codes(result) == ["Y1156"]
    assert result.diagnostics[0].message.endswith(
        "takes 1.134 s (24 segments) instead of the programmed 1.14 s"
    )
    # The times are steps of 1/4096 ms. For each segment, half a step counts as rounding, and a whole step
    # doesn't.
    assert codes(judge(text.replace("TM47.5\n", "TM47.500244140625\n"))) == ["Y1156"]
    motion = everything().jobs[3].motion
    for off, found in ((24 / 8192e3, []), (24 / 8192e3 + 3e-9, ["Y1156"])):
        steps = [*everything().program.steps]
        steps[3] = replace(motion, timing=hir.Timing(1.14 + off))
        changed = hir.Program(everything().program.source, everything().start, tuple(steps))
        assert codes(judge(text, program=changed)) == found
    # The whole text is faster. If no duration is programmed, the limits are still exceeded.
    short = text.replace("TM50\n", "TM12.5\n")
    assert {"Y1157", "Y1156"} <= set(codes(judge(short)))


def test_segments_faster_than_the_controller():
    result = judge(everything().text().replace("TM47.5\n", "TM3.5\n"))
    assert "Y1152" in codes(result)
    result = judge(everything().text().replace("TM47.5\n", "TM47.0001\n"))
    assert codes(result) == ["Y1152"]
    assert result.value is None


@pytest.mark.parametrize("doubled", [False, True])
@pytest.mark.parametrize("step", range(8))
def test_a_line_dropped_or_doubled(step, doubled):
    lines, _ = moves(everything().text())
    at = judge("\n".join(lines)).value.commands[step].lines[0] + 9
    lines[at : at + 1] = [lines[at]] * 2 if doubled else []
    result = judge("\n".join(lines))
    assert codes(result) == ["Y1153"]
    assert result.value is None
    # a left-out or doubled point is also found if the map's line numbers are adjusted

    def change(points):
        return np.insert(points, 10, points[10], axis=0) if doubled else np.delete(points, 10, axis=0)

    assert "Y1156" in codes(judge(with_points(step, change)))


def test_commands_that_change_places():
    case = everything()
    jobs = [*case.jobs]
    jobs[0], jobs[1] = replace(jobs[0], points=jobs[1].points), replace(jobs[1], points=jobs[0].points)
    assert "Y1160" in codes(judge(replace(case, jobs=tuple(jobs)).text()))
    lines = case.text().split("\n")
    first = next(i for i, line in enumerate(lines) if line.startswith("; command 0"))
    lines[first], lines[first + 1] = lines[first + 1], lines[first]
    assert codes(judge("\n".join(lines))) == ["Y1153"]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("; command 2 P0003 MOVEL 3 ", "; command 2 P0004 MOVEL 3 "),
        ("; command 2 P0003 MOVEL 3 ", "; command 2 P0003 MOVEJ 3 "),
        ("; command 2 P0003 MOVEL 3 ", "; command 2 - MOVEL 3 "),
        ("; command 2 P0003 MOVEL 3 ", "; command 2 P0003 MOVEL 4 "),
        ("; command 2 P0003 MOVEL 3 ", "; command 1 P0003 MOVEL 3 "),
        ("; command 2 P0003 MOVEL 3 ", "; command 2 P0003 MOVEL 3 1"),
        ("; command 8 P0009 STOP 9 - -\n", ""),
        ("; command 8 P0009 STOP 9 - -\n", "; command 8 P0009 STOP 9 - -\n; command 9 P0010 STOP 10 - -\n"),
    ],
)
def test_a_map_that_says_otherwise(old, new):
    text = everything().text()
    assert old in text
    result = judge(text.replace(old, new))
    assert codes(result) == ["Y1153"]
    assert result.value is None


def test_a_map_of_other_lines():
    text = everything().text()
    place = judge(text).value.commands
    for step, shift in ((1, (0, 1)), (1, (1, 0)), (3, (0, -1)), (7, (0, 1)), (0, (-1, 0))):
        first, last = place[step].lines
        old, new = f" {first} {last}\n", f" {first + shift[0]} {last + shift[1]}\n"
        assert codes(judge(text.replace(old, new))) == ["Y1153"]
    first, last = place[7].lines
    assert codes(judge(text.replace(f" {first} {last}\n", " - -\n"))) == ["Y1153"]
    # The command would extend over the border between two sequences.
    joined = text.replace(f" {place[2].lines[1]}\n", f" {place[3].lines[1]}\n")
    assert codes(judge(joined)) == ["Y1153"]


def test_a_program_with_errors_is_never_certified():
    case = everything()
    steps = (hir.Gap(), *case.program.steps[1:])
    result = judge(case.text(), program=hir.Program(case.program.source, case.start, steps))
    assert codes(result) == ["Y1153"]
    assert result.value is None


@pytest.mark.parametrize("target", ["rotary", "prog"])
def test_another_start(target):
    case = everything()
    for off, found in ((1e-10, False), (2e-7 if target == "rotary" else 1e-3, True)):
        start = case.start + np.array([0, 0, off, 0, 0, 0]) * DEG
        result = judge(emit(case.robot, start, case.jobs, target))
        assert ("Y1154" in codes(result)) == found
    result = judge(
        case.text(target), program=hir.Program(case.program.source, case.start + 0.01, case.program.steps)
    )
    assert codes(result)[0] == "Y1154"
    assert result.diagnostics[0].span == case.jobs[0].motion.origin.span


def test_a_guard_that_is_too_wide():
    """0.05 of 240 deg/s^2 in 50 ms are 0.03 deg, or 766 counts of motor 1. Motor 2 moves joints 2 and 3."""
    text = everything().text("prog")
    for motor, counts, found in ((1, 765, []), (1, 767, ["Y1154"]), (3, 870, []), (3, 890, ["Y1154"])):
        wide = [
            line.replace(">3072", f">{counts * 3072}") if line.startswith(f"IF(ABS(M{motor}61") else line
            for line in text.split("\n")
        ]
        # A count of motor 2 also turns joint 3, in the opposite direction of motor 3.
        assert codes(judge("\n".join(wide))) == found


def test_commands_that_run_into_each_other():
    lines, _ = moves(everything().text())
    last = judge("\n".join(lines)).value.commands[0].lines[1]
    lines[last - 1] = lines[last - 4]
    result = judge("\n".join(lines))
    assert "Y1155" in codes(result)
    assert f"(line {last})" in next(f.message for f in result.diagnostics if f.code == "Y1155")


def certify_one(robot, goal, n, tm):
    motion = hir.JointMove(origin(0), hir.JointGoal(goal), "LSPB", hir.Timing(None))
    jobs = [Job(motion, joint_points(np.zeros(robot.size), goal, n), tm)]
    start = np.zeros(robot.size)
    return certify(emit(robot, start, jobs, decimals=12), program(start, jobs), robot, TOLERANCE)


def test_limits_that_are_broken_by_half_a_percent():
    robot, goal, n = industrial6(), np.array([0, 1.0, 0, 0, 0, 0]), 60
    for share in (0.995, 1.0 - 1e-9, 1.005):
        # The segment time determines which limit is reached first: velocity is proportional to 1/TM, jerk to
        # its cube.
        for quantity, tm in (("velocity", "50"), ("acceleration", "50"), ("jerk", "25")):
            values = getattr(robot.limits, quantity)
            slack = replace(
                robot,
                limits=replace(
                    robot.limits,
                    lower=np.full(6, -9.0),
                    upper=np.full(6, 9.0),
                    **{q: np.full(6, 1e9) for q in ("velocity", "acceleration", "jerk") if q != quantity},
                ),
                actuation=replace(robot.actuation, velocity=np.full(6, 1e12)),
            )
            used = getattr(certify_one(slack, goal, n, tm).value.commands[0], quantity).share
            result = certify_one(slack, goal * share / used, n, tm)
            assert codes(result) == (["Y1157"] if share > 1 else [])
            assert np.isclose(getattr(result.value.commands[0], quantity).share, share, rtol=1e-7)
            if share > 1:
                message = result.diagnostics[0].message
                assert "J2" in message
                assert "100.50%" in message
                assert quantity in message
                assert f"limit of {values[1] / DEG:.6g} deg/s" in message


def test_motor_limit_where_no_joint_limit_is_broken():
    """Motor 3 follows joints 2 and 3. At 90 % of both joints' limits, it exceeds its own limit."""
    robot = industrial6()
    goal = np.array([0, 1.0, 1.0, 0, 0, 0])
    used = certify_one(robot, goal, 60, "50").value.commands[0].motor_velocity
    assert used.name == "motor 3"
    for share in (0.999, 1.005):
        fast = replace(
            robot, actuation=replace(robot.actuation, velocity=robot.actuation.velocity * used.share / share)
        )
        result = certify_one(fast, goal, 60, "50")
        assert codes(result) == (["Y1158"] if share > 1 else [])
    assert "motor 3" in result.diagnostics[0].message


def test_position_limits():
    robot = industrial6()
    for over, found in ((-1e-3, []), (1e-10, []), (1e-6, ["Y1157"])):
        goal = np.array([0, robot.limits.upper[1] + over * DEG, 0, 0, 0, 0])
        result = certify_one(robot, goal, 100, "50")
        assert codes(result) == found
    assert "J2" in result.diagnostics[0].message
    assert "exceeds its limit by 1e-06 deg" in result.diagnostics[0].message
    assert result.value.commands[0].position.name == "J2"
    endless = replace(
        robot, limits=replace(robot.limits, lower=np.full(6, -np.inf), upper=np.full(6, np.inf))
    )
    result = certify_one(endless, goal, 100, "50")
    assert codes(result) == []
    assert result.value.commands[0].position.share == 0.0
    rail = railed()
    assert codes(certify_one(rail, np.array([2.001, 0, 0, 0, 0]), 160, "50")) == ["Y1157"]


@pytest.mark.parametrize("step", [2, 4, 5])
def test_an_end_that_is_off(step):
    """An end at rest that is off along the base's z by more than the tolerance is found. A smaller error is
    counted.
    """
    case = everything()
    end = case.jobs[step].points[-1]
    _, jacobian = poses_and_jacobians(case.robot.chain, end[None], FLANGE_FROM_TCP)
    for off, found in ((5e-5, True), (1e-5, False), (1e-6, False)):
        change = np.linalg.solve(jacobian[0], [0, 0, off, 0, 0, 0])
        result = judge(
            with_points(step, lambda points, c=change: points + np.linspace(0, 1, len(points))[:, None] * c)
        )
        own = [f for f in result.diagnostics if f.message.startswith(f"P{step + 1:04d}")]
        assert [f.code for f in own] == (["Y1160"] if found else [])
        deviation = result.value.commands[step].deviation
        assert np.isclose(deviation.end_position, off, rtol=1e-3)
        assert deviation.position >= deviation.end_position


def test_claims_about_waypoints():
    case = everything()
    good = case.witnesses[6]
    for witnesses in ({}, {6: good[:-1]}, {6: good * np.nan}, {6: good[:, :5]}):
        result = judge(case.text(), witnesses=witnesses)
        assert "Y1161" in codes(result)
        assert result.value.commands[6].deviation.angle == np.inf
    for row, off, found in ((0, 1e-6, True), (1, 1e-3, True), (1, 1e-7, False)):
        moved = good.copy()
        moved[row, 2] += off
        assert ("Y1161" in codes(judge(case.text(), witnesses={6: moved}))) == found
    # Another inverse solution of the same pose is allowed as a waypoint, but gives another spline.
    other = good.copy()
    other[1:3, 5] += 2 * np.pi
    assert "Y1161" not in codes(judge(case.text(), witnesses={6: other}))
    assert "Y1159" in codes(judge(case.text(), witnesses={6: other}))


@pytest.mark.parametrize("line", ["garbage", "R", "XnanY0Z0A0B0C0", "X0Y0Z0A0B0C0R"])
def test_unreadable_text_has_no_certificate(line):
    lines, places = moves(everything().text())
    lines[places[50]] = line
    result = judge("\n".join(lines))
    assert codes(result) == ["Y1151"]
    assert result.value is None
    assert f"line {places[50] + 1} " in result.diagnostics[0].message
