"""Tests of programs that carry parts, executed by single steps or from a command in the middle: the parts are
where the whole program has them.
"""

import numpy as np
import pytest
from programs import codes

from tests.handling.carrying import PICK, PUT, made
from yarclang.diagnostics import has_errors
from yarclang.handling.surroundings import surroundings
from yarclang.pipeline.parts import approach, chains, part, parts_before
from yarclang.pipeline.returning import along_the_path, can_go_on
from yarclang.pipeline.stages import Request
from yarclang.robot.kinematics.fk import tool_poses


def cell_before(plan, number):
    """Return the cell with its parts before a motion."""
    return surroundings(plan.program.cell, parts_before(plan, plan.motions[number].step))


SLOW = PICK.replace("P0020", "P0015 MOVEL 0 0 20 0 0 0 [1] {FEEDER}\nP0020")


@pytest.mark.parametrize("program", [PICK + PUT, SLOW + PUT])
def test_each_step_is_certified(tmp_path, program):
    plan = made(tmp_path, program, margin=8).value.plan
    for first, last in chains(plan):
        found = part(plan, Request(plan.robot), first, last)
        assert found.value is not None, (first, codes(found.diagnostics), found.diagnostics)
        assert not has_errors(found.diagnostics)


def test_what_is_left_of_a_program_is_certified(tmp_path):
    plan = made(tmp_path, PICK + PUT).value.plan
    for first in range(len(plan.motions)):
        assert part(plan, Request(plan.robot), first).value is not None


def test_the_way_to_a_command_in_the_middle_carries_what_is_carried_there(tmp_path):
    plan = made(tmp_path, PICK + PUT).value.plan
    held = {one.name: one.mount.on_flange for one in cell_before(plan, 3).obstacles}
    assert held["BOX"]
    assert not {one.name: one.mount.on_flange for one in cell_before(plan, 0).obstacles}["BOX"]
    there = plan.motions[3].curve.points[0]
    way = approach(plan.robot, plan.robot.positions["HOME"], there, cell_before(plan, 3))
    assert way.value is not None
    carried = [one.name for one in way.value.program.cell.obstacles if one.mount.on_flange]
    assert carried == ["FINGERS", "BOX"]


def test_a_step_that_meets_something_with_its_part_is_refused(tmp_path):
    """A single step is judged with the part in the gripper, here in a cell with an added wall."""
    from dataclasses import replace

    plan = made(tmp_path, PICK + PUT).value.plan
    wall = (
        "\n"
        "[[obstacles]]\n"
        'name = "WALL"\n'
        'shape = "box"\n'
        'frame = "B"\n'
        "xyz = [25, 1000, 700]\n"
        "size = [10, 200, 180]\n"
    )
    from yarclang.pipeline.cells import cell_loader

    made(tmp_path, PICK + PUT, wall)
    cell = cell_loader(tmp_path, plan.robot)("cell.toml", None).value
    other = replace(plan, program=replace(plan.program, cell=cell))
    found = part(other, Request(plan.robot), 3, 4)
    assert found.value is None or has_errors(found.diagnostics)
    assert "BOX" in " ".join(one.message for one in found.diagnostics)


@pytest.mark.parametrize("share", [0.02, 0.3, 0.7, 0.98])
@pytest.mark.parametrize("number", [1, 2, 4, 5])
def test_a_run_that_was_stopped_beside_a_part_goes_on_along_its_path(tmp_path, number, share):
    """After a stop beside a part, the robot can go back along its path, or on to the end of the motion.

    The path is straight, and the feeder's next part isn't there yet.
    """
    plan = made(tmp_path, PICK + PUT, count=2).value.plan
    motion = plan.motions[number]
    here = motion.curve.sample(np.array([share * motion.curve.duration]))[0][0]
    for begin in (number, number + 1):
        found = along_the_path(plan, begin, here)
        assert found is not None
        (way,) = found.plan.motions
        there = plan.motions[begin].curve.points[0]
        assert np.abs(way.curve.sample(np.array([way.curve.duration]))[0][0] - there).max() < 1e-8
        parts = [one.name for one in found.plan.program.cell.obstacles if one.name.startswith("BOX")]
        assert parts == (["BOX 1", "BOX 2"] if number > 3 else ["BOX 1"])
        qs = way.curve.sample(np.linspace(0.0, way.curve.duration, 50))[0]
        tips = tool_poses(plan.robot.chain, qs, plan.robot.flange_from_frame["TCP"])[:, :2, 3]
        assert np.ptp(tips, axis=0).max() < 5e-4  # the gripper moves straight up or down


def test_the_way_on_starts_where_the_robot_stands_only_if_its_parts_are_there(tmp_path):
    plan = made(tmp_path, PICK + PUT, count=2).value.plan
    lift = plan.motions[2]
    here = lift.curve.sample(np.array([0.2 * lift.curve.duration]))[0][0]
    known = parts_before(plan, plan.motions[2].step)
    assert along_the_path(plan, 3, here, known) is not None
    assert along_the_path(plan, 3, here, parts_before(plan, plan.motions[1].step)) is None
    assert along_the_path(plan, 3, here + 0.01, known) is None
    assert along_the_path(plan, 5, here, known) is None
    # an ordinary approach would collide with the box's support, or with a part that comes only later
    assert approach(plan.robot, here, lift.curve.points[0], cell_before(plan, 2)).value is None


def test_a_place_to_go_on_with_is_one_that_can_be_come_to(tmp_path):
    plan = made(tmp_path, PICK + PUT, count=2).value.plan
    lift = plan.motions[2]
    here = lift.curve.sample(np.array([0.2 * lift.curve.duration]))[0][0]
    assert can_go_on(plan, 2, here)
    assert can_go_on(plan, 3, here)
    beside = here.copy()
    beside[0] += 0.02
    assert not can_go_on(plan, 2, beside)
