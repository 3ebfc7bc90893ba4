"""Tests of the judge of live motions. It refuses each text that breaks a limit, by the printed numbers and
without the generator.
"""

import numpy as np
import pytest

from yarclang.backend_pmac.live import LIVE
from yarclang.certify.motion.bounds import Cubics
from yarclang.collision.zones.watched import tool_frame
from yarclang.coordinator.live.generator import Generator, rates_of
from yarclang.coordinator.live.proof import Judge, surroundings_of
from yarclang.coordinator.live.steering import JointVelocity, Steering, Twist
from yarclang.robot.description import load_robot

H = 0.01
START = np.array([0.0, 10.0, 10.0, 0.0, 40.0, 0.0])


def judge_at(start=START, speed=0.25):
    robot = load_robot("INDUSTRIAL6").value
    scene, watches = surroundings_of(robot, None, tool_frame(robot)).value
    return robot, Judge(
        robot,
        start * robot.axis_units,
        H,
        speed,
        robot.flange_from_frame["TCP"],
        scene,
        watches,
        points=LIVE.points,
    )


def text(robot, points):
    return tuple(
        "".join(f"{axis}{value:.7f}" for axis, value in zip(robot.controller.axes, row, strict=True))
        for row in points
    )


def along(joint, way, count):
    """Return points of a quintic from rest to rest."""
    u = np.linspace(0.0, 1.0, count)
    points = np.tile(START, (count, 1))
    points[:, joint - 1] += way * (10 * u**3 - 15 * u**4 + 6 * u**5)
    return np.concatenate([points, points[-1:], points[-1:]])


def test_what_keeps_all_limits_has_no_objection():
    robot, judge = judge_at()
    assert judge.objection(text(robot, along(1, 3.0, 100)), ()) == ""


@pytest.mark.parametrize(
    ("points", "why"),
    [
        (along(1, 30.0, 30), "J1 would have"),
        (along(1, 12.0, 100), "the tool might reach"),
        (along(5, 90.0, 400), "J5 would go past its limit"),
        (along(1, 3.0, 100)[:-3], "doesn't end at rest"),
        (along(3, 30.0, 45), "would have"),
    ],
)
def test_what_breaks_a_limit_is_refused(points, why):
    robot, judge = judge_at()
    assert why in judge.objection(text(robot, points), ())


def test_one_wrong_number_is_seen():
    robot, judge = judge_at()
    points = along(1, 3.0, 100)
    points[50, 3] += 0.01
    assert "J4" in judge.objection(text(robot, points), ())


@pytest.mark.parametrize("line", ["X1", "X1Y2Z3A4B5C6F7", "X1Y2Z3A4B5C", "DWELL100", ""])
def test_what_is_no_move_is_refused(line):
    _, judge = judge_at()
    assert "isn't a move of all axes" in judge.objection((line,), ())


def test_it_remembers_what_was_admitted():
    robot, judge = judge_at()
    points = text(robot, along(1, 3.0, 100))
    assert judge.objection(points[:40], points[40:]) == ""
    judge.admit(points[:40])
    assert judge.objection(points[40:], ()) == ""
    assert judge.objection(points[41:], ()) != ""  # a line is missing


@pytest.mark.parametrize("seed", range(4))
def test_whatever_is_wanted_the_whole_text_keeps_the_limits(seed):
    """Whatever targets are sent, the whole text respects the limits. This is checked at once for all lines,
    by the closed forms of the certificate.
    """
    robot, judge = judge_at()
    rates, random = rates_of(robot), np.random.default_rng(seed)
    tool = robot.flange_from_frame["TCP"]
    made = Generator(
        robot,
        START * robot.axis_units,
        lambda points: LIVE.lines(robot, points, 7),
        H,
        Steering(robot, tool, rates, robot.jog_speed),
        judge,
        rates,
    )
    lines, now, target = [], 0.0, None
    while now < 2.5:
        if target is None or random.random() < 0.05:
            target = (
                JointVelocity(random.normal(size=6) * 0.5)
                if random.random() < 0.5
                else Twist(random.normal(size=3) * 0.2, random.normal(size=3) * 0.5, "tool")
            )
        made.want(target, now)
        lines += made.more(now, 2)
        now += 2 * H
    made.finish()
    while not made.ended:
        lines += made.more(now, 2)
    q = np.array([[float(value) for value in _numbers(line)] for line in lines]) * robot.axis_units
    start = START * robot.axis_units
    control = np.concatenate([np.tile(start, (3, 1)), q, q[-1:], q[-1:]])
    cubics = Cubics.of_spline(control, np.arange(len(control) - 3), np.full(len(control) - 3, H))
    limits = robot.limits
    lower, upper = cubics.position_range()
    assert (lower >= limits.lower - 1e-9).all()
    assert (upper <= limits.upper + 1e-9).all()
    assert (cubics.velocity_peaks() <= limits.velocity * (1.0 + 1e-9)).all()
    assert (cubics.acceleration_peaks() <= limits.acceleration * (1.0 + 1e-9)).all()
    assert (np.abs(cubics.j) <= limits.jerk * (1.0 + 1e-9)).all()


def _numbers(line):
    import re

    return re.findall(r"-?\d+\.\d+", line)
