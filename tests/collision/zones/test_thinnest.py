"""Tests of the thinnest zones that a cell may contain: the proof notices each motion across them. Thinner
ones, which a cell refuses, may be crossed unnoticed.
"""

import numpy as np
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st

from yarclang.cell.model import Cell, JointWindow, ShapeRegion, Zone
from yarclang.cell.zones import NARROWEST, THINNEST
from yarclang.collision.zones.watched import tool_frame
from yarclang.collision.zones.windows import SLACK as WINDOW_SLACK
from yarclang.collision.zones.workspace import SLACK
from yarclang.motion.avoid.room import room_of
from yarclang.motion.avoid.smooth import straight_course
from yarclang.robot.description import load_robot
from yarclang.robot.kinematics import flange_poses
from yarclang.shapes import Box
from yarclang.source import SourceFile
from yarclang.transforms import rpy_rotation

ROBOT = load_robot("INDUSTRIAL6").value
START, GOAL = (np.radians([side, 20, -20, 0, -30, 0]) for side in (-30, 30))


def doubts(region, rule="forbidden"):
    zone = Zone("Z", rule, region, watch=("tcp",))
    cell = Cell(SourceFile("cell.toml", ""), {}, {}, {}, {}, (), (zone,), {})
    return len(room_of(ROBOT, cell, tool_frame(ROBOT)).doubts(straight_course(START, GOAL)))


def test_what_a_cell_may_have_is_several_times_what_a_proof_cant_tell():
    assert THINNEST >= 4.0 * SLACK
    assert NARROWEST >= 4.0 * WINDOW_SLACK


@exercises(crossed=0.9)
@settings(max_examples=30, deadline=None)
@given(st.floats(0.1, 0.9), st.lists(st.floats(-0.6, 0.6), min_size=3, max_size=3))
def test_a_sheet_of_the_least_thickness_is_never_crossed_unseen(tally, share, turn):
    q = START + share * (GOAL - START)
    tool = flange_poses(ROBOT.chain, q[None])[0] @ tool_frame(ROBOT).flange_from_moving
    placed = np.eye(4)
    placed[:3, :3] = tool[:3, :3] @ rpy_rotation(np.array(turn))  # its normal is roughly along the motion
    placed[:3, 3] = tool[:3, 3]
    sheet = ShapeRegion(placed, Box(np.array([THINNEST, 3.0, 3.0])))
    found = doubts(sheet)
    tally.count("crossed", found > 0)
    assert found


@settings(max_examples=20, deadline=None)
@given(st.floats(-0.5, 0.5))
def test_a_window_of_the_least_width_is_never_crossed_unseen(at):
    lower, upper = np.full(6, -np.inf), np.full(6, np.inf)
    lower[0], upper[0] = at - NARROWEST / 2.0, at + NARROWEST / 2.0
    assert doubts(JointWindow(lower, upper))
