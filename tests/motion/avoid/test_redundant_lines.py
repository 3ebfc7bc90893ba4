"""Tests of MOVEL_AVOID for an arm with seven joints, which comes to one pose with many joint positions."""

import numpy as np
import pytest

from tests.motion.avoid.cells import box, cell_of
from tests.robot.made_arms import DATA, REAL, made
from yarclang.collision.zones.watched import tool_frame
from yarclang.motion.avoid import lines
from yarclang.motion.avoid.room import room_of
from yarclang.motion.cartesian import along
from yarclang.motion.paths.line import line_between
from yarclang.robot.kinematics import flange_poses, nearest_solutions


@pytest.fixture(scope="module")
def panda(tmp_path_factory):
    file, arguments, _ = REAL["panda"]
    return made(DATA / file, tmp_path_factory.mktemp("arm") / "panda", *arguments)


def test_two_trees_join_though_the_joints_differ(panda, monkeypatch):
    flange, tool = flange_poses(panda.chain, panda.home[None])[0], tool_frame(panda)
    begin = flange @ tool.flange_from_moving
    end = begin.copy()
    end[1, 3] += 0.3
    middle = (begin[:3, 3] + end[:3, 3]) / 2.0
    room = room_of(panda, cell_of(box("WALL", middle - [0.0, 0.0, 0.05], [0.2, 0.01, 0.2], 0.005)), tool)
    line = line_between(begin, end)
    straight = along(panda.chain, panda.limits, room.flange_from_moving, line, panda.home, reason="any")
    stands = end @ np.linalg.inv(tool.flange_from_moving)
    goals = nearest_solutions(panda.chain, panda.limits, stands, panda.home).q
    monkeypatch.setattr(lines._Search, "_in_three", lambda self: iter(()))
    efforts = (lines.Effort(0.005, 0.03, 250),)
    found = lines.find_course(room, line, straight, panda.home, list(goals), efforts)
    assert isinstance(found, lines.Course)
    assert len(found.paths) > 1
