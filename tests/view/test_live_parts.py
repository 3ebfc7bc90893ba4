"""Tests of a cell's parts during a run: after each SET they are where the plan has them."""

import numpy as np
import pytest
from view.stages import EXAMPLES
from view.test_of_live import Q, cell_of, robot_of, status

import yarclang
from yarclang.coordinator.describing import joints_by_name
from yarclang.coordinator.messages import events, replies
from yarclang.handling.present import are_same
from yarclang.hir import SetOutput
from yarclang.report.carried import carried_in_plan
from yarclang.view.live_parts import LiveParts
from yarclang.view.of_live import Live


@pytest.mark.parametrize("name", ["05_pick_and_place", "06_palletising"])
def test_sets_move_the_parts_as_the_plan_does(name):
    source = (EXAMPLES / f"{name}.yarc").read_text()
    plan = yarclang.compile(source, name=f"{name}.yarc", folder=EXAMPLES).value.plan
    carried, robot, cell = carried_in_plan(plan), plan.robot, plan.program.cell
    live = Live(robot, status(robot, plan.program.start))
    live.parts = LiveParts(robot, cell)
    ends = {motion.step: motion.curve for motion in plan.motions}
    states, count = iter(carried.states[1:]), 0
    for number, step in enumerate(plan.program.steps):
        if (curve := ends.get(number)) is not None:
            for q in curve.sample(np.linspace(0.0, curve.duration, 20))[0]:
                told = joints_by_name(robot, q)
                live.hear(events.Position(time_s=0.0, joints=told, done_s=0.0))
        if isinstance(step, SetOutput):
            one = step.output
            live.hear(events.OutputSet(time_s=0.0, name="", variable=one.variable, value=step.value))
            count += bool(live.parts.parts.held())
    assert count
    last = [*states][-1].parts
    assert {one.name for one in live.parts.parts.items} >= {one.name for one in last.items}
    for one in last.items:
        same = next(each for each in live.parts.parts.items if each.name == one.name)
        assert (same.gripper, same.is_sure) == (one.gripper, one.is_sure)
        assert same.transform == pytest.approx(one.transform, abs=1e-4)


def told(*parts, moved=True, doubt=None):
    return replies.Parts(parts=parts, moved=moved, doubt=doubt, findings=())


def place(name, held=None, pose=None):
    matrix = np.eye(4) if pose is None else pose
    return replies.PartPlace(name=name, held=held, sure=True, pose=tuple(map(tuple, matrix.tolist())))


def test_what_a_coordinator_tells_counts_and_what_it_cannot_mean_is_left_out():
    cell = cell_of("06_palletising.toml")
    parts, first = LiveParts(robot_of(), cell), LiveParts(robot_of(), cell).parts
    kind = cell.parts[0].body.name
    wrong = (
        place("NOTHING"),
        place(f"{kind} ²"),
        replies.PartPlace(name=f"{kind} 2", held=None, sure=True, pose=((1.0,),)),
    )
    grip = next(name for name, one in cell.outputs.items() if one.grip is not None)
    parts.told(told(place(f"{kind} 3", held=grip), *wrong))
    assert parts.rows == [("holds", f"{kind} 3")]
    before = parts.parts
    parts.told(told(place(f"{kind} 3", held=grip), *wrong))
    assert parts.parts is before  # the parts aren't drawn again
    parts.told(told(moved=False, doubt="it was killed"), is_late=True)
    assert are_same(parts.parts, first)
    assert parts.rows == [("parts", "the places aren't certain: it was killed")]
    # neither an output that moves no part nor a position of the robot moves parts
    parts.output_set("M9999", 1.0, Q)
    parts.stands(Q)
    assert parts.parts is first
