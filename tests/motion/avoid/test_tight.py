"""Tests of motions out of narrow places: first the tool is drawn out along its axes, then a motion is
searched for. What is found is free according to other geometry.
"""

import numpy as np
import pytest

from tests.motion.avoid.cells import LEFT, RIGHT, ROBOT, room
from tests.motion.avoid.test_way import executed, worst
from yarclang.cell.model import Cell, JointWindow, Mount, Obstacle, Zone
from yarclang.collision.zones.watched import tool_frame
from yarclang.hir import Origin
from yarclang.motion.avoid import way as ways
from yarclang.motion.avoid.backing import FARTHEST, STEP, retreats
from yarclang.motion.avoid.messages import no_way
from yarclang.motion.avoid.room import room_of
from yarclang.motion.avoid.way import NoWay, Way, find_way
from yarclang.robot.kinematics import flange_poses
from yarclang.shapes import Box
from yarclang.source import SourceFile, Span

WIDTH, FOOT, LENGTH, DEEP, WALL = 0.05, 0.03, 0.2, 0.16, 0.02


def placed(name, size, xyz, base=None):
    """Return a body at a position in the flange's frame: fixed to the flange or, if the flange's pose is
    given, to the cell.
    """
    where = np.eye(4)
    where[:3, 3] = xyz
    mount = Mount(where, True) if base is None else Mount(base @ where, False)
    return Obstacle(name, Box(np.array(size)), mount, 0.0)


STICK = placed("STICK", [WIDTH, LENGTH, WIDTH], [0, FOOT + LENGTH / 2, 0])
"""The tool, along y of the flange, which points outwards."""


def box_about(q, wider, name="BOX"):
    """Return the walls of a box with the tool inside at `q`. Its opening is slightly wider than the tool."""
    base = flange_poses(ROBOT.chain, q[None])[0]
    mouth, bottom = FOOT + LENGTH - DEEP, FOOT + LENGTH + 0.01
    middle, deep, inner = (mouth + bottom) / 2, bottom - mouth, WIDTH + wider
    beside = (inner + WALL) / 2
    for number, sign in enumerate((-1, 1)):
        yield placed(f"{name}{number}", [WALL, deep, inner + 2 * WALL], [sign * beside, middle, 0], base)
        yield placed(f"{name}{number + 2}", [inner, deep, WALL], [0, middle, sign * beside], base)
    outer = inner + 2 * WALL
    yield placed(f"{name}4", [outer, WALL, outer], [0, bottom + WALL / 2, 0], base)


@pytest.mark.parametrize("wider", [0.02, 0.005])
def test_out_of_a_box_into_another(wider, monkeypatch):
    around = (STICK, *box_about(LEFT, wider, "ONE"), *box_about(RIGHT, wider, "OTHER"))
    way = find_way(room(*around), LEFT, RIGHT)
    assert isinstance(way, Way)
    assert worst(executed(LEFT, way), *around) > 0.0
    assert np.array_equal(way.waypoints, find_way(room(*around), LEFT, RIGHT).waypoints)
    # Random sampling alone finds nothing. Otherwise the problem would be too easy for this test.
    plain = tuple(one for one in ways.EFFORTS if not one.lines)
    monkeypatch.setattr(ways, "EFFORTS", plain)
    assert isinstance(find_way(room(*around), LEFT, RIGHT), NoWay)


def test_a_retreat_is_a_straight_line_of_the_tool_that_is_free():
    around = room(STICK, *box_about(LEFT, 0.01))
    found = retreats(around, LEFT, around.is_free, turns=False)
    assert found
    for one in found:
        assert np.array_equal(one.corners[0], LEFT)
        assert all(around.is_free(q) for q in one.corners)
        poses = flange_poses(ROBOT.chain, one.corners)
        assert np.abs(poses[:, :3, :3] - poses[0, :3, :3]).max() < 1e-4
        gone = (poses[:, :3, 3] - poses[0, :3, 3]) @ poses[0, :3, :3]
        assert np.abs(gone[:, [0, 2]]).max() < 1e-4  # the only way out is along the tool's own axis
        assert gone[:, 1].max() <= 1e-6
        assert gone[:, 1].min() >= -FARTHEST - STEP


def test_nothing_leads_out_of_a_closed_box():
    lid = placed("LID", [0.3, WALL, 0.3], [0, 0, 0], flange_poses(ROBOT.chain, LEFT[None])[0])
    around = room(STICK, *box_about(LEFT, 0.01), lid)
    assert [len(one.corners) for one in retreats(around, LEFT, lambda q: False, turns=True)] == [1]


def shut(lower, upper):
    """Return a room with a zone that forbids the joint positions between two bounds."""
    zone = Zone("GATE", "forbidden", JointWindow(np.array(lower), np.array(upper)))
    cell = Cell(SourceFile("cell.toml", ""), {}, {}, {}, {}, (), (zone,), {})
    return room_of(ROBOT, cell, tool_frame(ROBOT))


def window(**ends):
    lower, upper = np.full(6, -np.inf), np.full(6, np.inf)
    for name, (low, high) in ends.items():
        joint = int(name[1:]) - 1
        lower[joint], upper[joint] = np.radians(low), np.radians(high)
    return lower, upper


def test_a_window_of_one_joint_between_start_and_goal_is_seen_without_a_search(monkeypatch):
    monkeypatch.setattr(ways, "_found", lambda *_: pytest.fail("nothing has to be searched for"))
    why = find_way(shut(*window(J1=(-10, 10))), LEFT, RIGHT)
    assert isinstance(why, NoWay)
    assert (why.parting.name, why.parting.joint) == ("GATE", 0)
    said = no_way(ROBOT, why, Origin("P0010", "MOVEJ_AVOID", SourceFile("a.yarc", ""), Span.on_line(1, 1, 2)))
    assert said[:2] == (
        "Y0923",
        (
            "no path exists to the joint positions of the target: zone GATE forbids J1 from -10 to 10 deg, "
            "and start and target are on opposite sides of this range"
        ),
    )


@pytest.mark.parametrize("ends", [{"J1": (-10, 10), "J2": (-90, 40)}, {"J1": (-10, 10), "J3": (-60, 0)}])
def test_a_window_of_two_joints_is_gone_round(ends):
    assert isinstance(find_way(shut(*window(**ends)), LEFT, RIGHT), Way)


def test_a_window_beyond_both_ends_parts_nothing():
    assert find_way(shut(*window(J1=(70, 80))), LEFT, RIGHT).is_straight
