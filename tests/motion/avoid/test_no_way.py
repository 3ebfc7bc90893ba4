"""Tests of motions that don't exist, or aren't found. Zones that separate start and target are recognized at
once, and a search that fails reports how far it got.
"""

from dataclasses import replace

import numpy as np
import pytest
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.motion.avoid.cells import LEFT, POST, RIGHT, ROBOT, WALL, box, cell_of, room
from tests.motion.avoid.test_way import worst
from yarclang.cell.model import JointWindow, ShapeRegion, Zone
from yarclang.collision.zones.moved import Arm
from yarclang.collision.zones.watched import tool_frame
from yarclang.hir import Origin
from yarclang.motion.avoid import parting as partings
from yarclang.motion.avoid import way as ways
from yarclang.motion.avoid.messages import no_way
from yarclang.motion.avoid.parting import Barrier
from yarclang.motion.avoid.room import Obstruction, room_of
from yarclang.motion.avoid.search import Effort
from yarclang.motion.avoid.way import Furthest, NoWay, Way, find_way
from yarclang.robot.description import load_robot
from yarclang.robot.kinematics import flange_poses
from yarclang.shapes import Box
from yarclang.source import SourceFile, Span
from yarclang.transforms import constant

ORIGIN = Origin("P0010", "MOVEJ_AVOID", SourceFile("a.yarc", ""), Span.on_line(1, 1, 2))
FEW = (Effort(0.01, 0.05, 60, 1), Effort(0.001, 0.05, 60, 2))


def curtain(size, *obstacles, xyz=(0.0, 0.9, 1.0), posture=None, watch=("tcp",)):
    """Return a room with a zone that the tool must not enter."""
    placed = np.eye(4)
    placed[:3, 3] = xyz
    region = ShapeRegion(constant(placed), Box(np.array(size, float)))
    zone = Zone("CURTAIN", "forbidden", region, None, watch, 0.0, posture)
    return room_of(ROBOT, replace(cell_of(*obstacles), zones=(zone,)), tool_frame(ROBOT))


def test_a_zone_that_the_arm_cannot_reach_past_is_seen_without_a_search(monkeypatch):
    monkeypatch.setattr(ways, "_found", lambda *_: pytest.fail("nothing has to be searched for"))
    why = find_way(curtain([0.1, 20.0, 20.0]), LEFT, RIGHT)
    assert isinstance(why, NoWay)
    assert why.parting == Barrier("CURTAIN", "{TCP}")
    said = no_way(ROBOT, why, ORIGIN)
    assert said[:2] == (
        "Y0923",
        (
            "no path exists to the joint positions of the target: zone CURTAIN "
            "separates the positions of {TCP} at start and target, and the arm can't reach past the zone"
        ),
    )


WINDOW = JointWindow(constant(np.full(6, -0.1)), constant(np.full(6, 0.1)))


@pytest.mark.parametrize(
    "around",
    [
        {"size": [0.1, 20.0, 2.5]},  # there is room above it
        {"size": [0.1, 2.0, 20.0]},  # there is room behind the arm
        {"size": [0.1, 20.0, 20.0], "xyz": (3.0, 0.0, 0.0)},  # it isn't between start and target
        {"size": [3e-5, 20.0, 20.0]},  # so thin that it counts as no zone
        {"size": [0.1, 20.0, 20.0], "posture": WINDOW},  # the tool may enter it in a certain posture
    ],
)
def test_what_leaves_room_is_no_barrier(around):
    assert partings.parting(curtain(**around), LEFT, RIGHT) is None


def test_no_way_leads_past_a_barrier_and_one_past_what_leaves_room():
    assert isinstance(find_way(curtain([0.1, 20.0, 2.5]), LEFT, RIGHT), Way)


@exercises(near=0.02)
@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_nothing_leaves_the_ball_that_it_is_said_to_keep_to(tally, seed):
    random = np.random.default_rng(seed)
    robot = load_robot(("INDUSTRIAL6", "TRACKED_MANIPULATOR")[seed % 2]).value
    placed = np.eye(4)
    zone = Zone(
        "Z", "forbidden", ShapeRegion(constant(placed), Box(np.ones(3))), None, ("tcp", "elbow", "arm")
    )
    around = room_of(robot, replace(cell_of(), zones=(zone,)), tool_frame(robot))
    q = random.uniform(robot.limits.lower, robot.limits.upper, (200, robot.size))
    arm = Arm.at(around.scene, q)
    for watch in around.watches:
        middle, radius = partings._reach(robot.chain, robot.limits, watch.item)
        far = np.linalg.norm(arm.of(watch.item).point(watch.item.points[0]) - middle, axis=1)
        assert far.max() <= radius + 1e-9
        tally.count("near", far.max() > 0.7 * radius)


def test_a_search_that_failed_says_how_far_it_came(monkeypatch):
    monkeypatch.setattr(ways, "EFFORTS", FEW)
    why = find_way(room(*WALL), LEFT, RIGHT)
    assert isinstance(why, NoWay)
    assert why.tries == 120
    far = why.furthest
    assert worst(far.q[None], *WALL) > 0.0  # this position is free
    assert {"WALL", "BACK_WALL", "LID"} & set(far.blocked.names)
    sides = flange_poses(ROBOT.chain, np.stack([far.q, LEFT, RIGHT]))[:, 0, 3]
    assert np.sign(sides[0]) == np.sign(sides[1]) == -np.sign(sides[2])  # on the start's side of the wall
    poses = flange_poses(ROBOT.chain, np.stack([far.q, RIGHT])) @ tool_frame(ROBOT).flange_from_moving
    assert far.left == pytest.approx(np.linalg.norm(poses[0, :3, 3] - poses[1, :3, 3]))
    again = find_way(room(*WALL), LEFT, RIGHT).furthest
    assert np.array_equal(again.q, far.q)
    assert (again.blocked.names, again.blocked.distance) == (far.blocked.names, far.blocked.distance)
    message = no_way(ROBOT, why, ORIGIN)[1]
    assert "found in 120 tries (one may still exist): the search came as far as " in message
    assert f"{far.left * 1e3:.0f} mm from the target; beyond, " in message


def test_a_zone_that_stops_a_search_is_named(monkeypatch):
    monkeypatch.setattr(ways, "EFFORTS", FEW[:1])
    # The window of two joints leaves only a narrow gap, which a few attempts don't find.
    lower, upper = np.full(6, -np.inf), np.full(6, np.inf)
    lower[0], upper[0], upper[1] = -0.2, 0.2, ROBOT.limits.upper[1] - 0.02
    zone = Zone("GATE", "forbidden", JointWindow(constant(lower), constant(upper)))
    around = room_of(ROBOT, replace(cell_of(), zones=(zone,)), tool_frame(ROBOT))
    why = find_way(around, LEFT, RIGHT)
    assert isinstance(why, NoWay)
    assert why.furthest.blocked.names == ("the joints", "GATE")
    assert "beyond, the joints break the zone GATE" in no_way(ROBOT, why, ORIGIN)[1]


def test_a_way_with_corners_that_becomes_no_curve_is_said(monkeypatch):
    monkeypatch.setattr(ways, "smooth", lambda *_: None)
    why = find_way(room(POST), LEFT, RIGHT)
    assert why.has_corners
    message = no_way(ROBOT, why, ORIGIN)[1]
    assert "a path with corners is free, but no smooth path along it was proved to be free" in message
    assert "POST" in message


@pytest.mark.parametrize(
    ("blocked", "said"),
    [
        (Obstruction(("TOOL", "BOX"), -0.003), "TOOL is 3 mm deep in BOX"),
        (Obstruction(("TOOL", "BOX"), 0.0004), "TOOL is 0.4 mm from BOX"),
        (Obstruction(("{TCP}", "Z"), 0.02, is_zone=True), "{TCP} breaks the zone Z by 20 mm"),
        (Obstruction(("{TCP}", "Z"), -0.02, is_zone=True), "zone Z leaves {TCP} too little room"),
    ],
)
def test_what_is_in_the_way_from_there_on_is_in_words(blocked, said):
    why = NoWay(furthest=Furthest(np.radians([10.0, 20.0, 0.0, -30.04, 0.0, 0.0]), 0.31, blocked), tries=60)
    message = no_way(ROBOT, why, ORIGIN)[1]
    assert message == (
        "no free path was found in 60 tries (one may still exist): "
        f"the search came as far as 10 20 0 -30 0 0 (deg), 310 mm from the target; beyond, {said}"
    )


def test_among_many_bodies_a_search_ends_early_and_says_so(monkeypatch):
    monkeypatch.setattr(ways, "MOST_LOOKS", 400)
    why = find_way(room(*WALL), LEFT, RIGHT)
    assert why.is_cut
    assert 0 < why.tries < 500
    _, message, _, help_, _ = no_way(ROBOT, why, ORIGIN)
    assert f"in {why.tries} tries" in message
    assert help_.endswith("the search was cut short: --avoid-effort 4 searches four times as long")
    assert find_way(room(*WALL), LEFT, RIGHT, searches=4).tries > why.tries
    monkeypatch.setattr(ways, "EFFORTS", FEW)
    monkeypatch.setattr(ways, "MOST_LOOKS", 300_000)
    whole = find_way(room(*WALL), LEFT, RIGHT)
    assert not whole.is_cut
    assert "cut short" not in no_way(ROBOT, whole, ORIGIN)[3]


def test_more_bodies_cost_more_looks():
    few, many = (
        room(*WALL),
        room(*(box(f"B{at}", [3.0, 3.0, 0.1 * at], [0.05, 0.05, 0.05]) for at in range(100))),
    )
    assert ways._Looks(few, 1).cost < 1.1
    assert ways._Looks(many, 1).cost > 2.0
