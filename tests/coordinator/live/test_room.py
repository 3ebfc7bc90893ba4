"""Tests of free rooms around joint positions: all positions in a free room are free by an
independent check.
"""

import numpy as np
from floors import exercises
from hypothesis import Phase, assume, given, settings
from hypothesis import strategies as st

from yarclang.backend_pmac.live import LIVE
from yarclang.certify.motion.bounds import Cubics
from yarclang.collision.course import Course
from yarclang.collision.free import free_space
from yarclang.collision.proof import clearances
from yarclang.collision.scene import scene_of
from yarclang.coordinator.live.generator import Generator, rates_of
from yarclang.coordinator.live.proof import Judge
from yarclang.coordinator.live.room import Room, is_free
from yarclang.coordinator.live.steering import JointVelocity, Steering
from yarclang.robot.description import load_robot

ROBOT = load_robot("INDUSTRIAL6").value
SCENE = scene_of(ROBOT, None).value
SPACE = free_space(SCENE)
UNIT = st.floats(-1.0, 1.0)
SIX = st.lists(UNIT, min_size=6, max_size=6).map(np.array)


def posture(shares):
    """Return joint positions that are given as shares of the joints' ranges."""
    limits = ROBOT.limits
    return (limits.upper + limits.lower) / 2.0 + shares * (limits.upper - limits.lower) / 2.0


@exercises(free=0.1, taken=0.1)
@settings(max_examples=100, deadline=None, derandomize=True)
@given(SIX, SIX, st.sampled_from([0.02, 0.1, 0.4, 1.0]), st.lists(SIX, min_size=10, max_size=20))
def test_what_has_room_is_free(tally, shares, reach, size, within):
    room = Room(posture(shares), np.abs(reach) * size)
    corners = [np.sign(one) for one in within]
    free = is_free(SCENE, room)
    tally.count("free", free)
    tally.count("taken", not free)
    if free:
        assert all(SPACE.has(room.middle + one * room.reach) for one in (*within, *corners))


def test_there_is_none_where_bodies_are_near():
    bent = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    assert is_free(SCENE, Room(bent, np.full(6, 0.01)))
    assert not is_free(SCENE, Room(bent, np.full(6, 3.0)))
    room = Room(bent, np.full(6, 0.01))
    assert room.has(bent - 0.01, bent + 0.01)
    assert not room.has(bent - 0.01, bent + 0.02)


@exercises(moved=0.2)
@settings(max_examples=12, deadline=None, phases=(Phase.explicit, Phase.reuse, Phase.generate))
@given(SIX, st.lists(SIX, min_size=1, max_size=4))
def test_a_live_motion_that_was_admitted_is_free_for_who_looks_at_all_of_it(tally, shares, wanted):
    """An admitted live motion is free by an independent check of the whole motion. In these motions links
    come near to each other, so the proof by a room sometimes works and sometimes fails.
    """
    start, h, tool = posture(shares), 0.02, ROBOT.flange_from_frame["TCP"]
    assume(SPACE.has(start))
    judge, rates = Judge(ROBOT, start, h, 0.5, tool, SCENE, points=LIVE.points), rates_of(ROBOT)
    stands = "".join(
        f"{axis}{value:.7f}" for axis, value in zip("XYZABC", start / ROBOT.axis_units, strict=True)
    )
    assume(not judge.objection((stands,) * 3, ()))
    made = Generator(
        ROBOT,
        start,
        lambda points: LIVE.lines(ROBOT, points, 7),
        h,
        Steering(ROBOT, tool, rates, 0.5),
        judge,
        rates,
    )
    points = [np.tile(start, (3, 1))]
    for number, one in enumerate(wanted):
        made.want(JointVelocity(one), float(number))
        points.append(judge._points(ROBOT, made.more(float(number), 36)))
    made.finish()
    while not made.ended:
        points.append(judge._points(ROBOT, made.more(float(len(wanted)), 3)))
    control = np.concatenate(points)
    tally.count("moved", np.abs(control - start).max() > 0.01)
    count = len(control) - 3
    curve = Cubics.of_spline(control, np.arange(count), np.full(count, h))
    course = Course.of(curve.x, curve.v, curve.a, curve.j, curve.h, curve.velocity_peaks())
    assert not clearances(SCENE, course, np.array([[0, count]])).meetings
