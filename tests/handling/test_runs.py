"""Tests of motions of grippers to parts and away from them through WHENs, while the feeder presents new
parts.
"""

import numpy as np
import pytest
from programs import codes

from tests.handling.carrying import made
from yarclang.cell.model import Item, Parts
from yarclang.handling.parts import arrive, close, either, open_
from yarclang.handling.walk import handling_of

UP = "P0010 MOVEJ_RPY 0 0 120 0 0 0 {FEEDER}\n"
DOWN = "P0020 MOVEL 0 0 0 0 0 0 [1] {FEEDER}\n"
TAKE = "P0030 SET GRIP ON\n"
LIFT = "P0040 MOVEL 0 0 120 0 0 0 [1] {FEEDER}\n"
PUT = """P0050 MOVEJ_RPY 0 0 120 0 0 0 {PUT}
P0060 MOVEL 0 0 0 0 0 0 [1.2] {PUT}
P0070 SET GRIP OFF
P0080 MOVEL 0 0 120 0 0 0 [1.2] {PUT}
P0090 MOVEJ READY
"""
WAITS = 'WHEN GOOD OFF\nP0031 HOLD "look"\nP0032 WAIT GOOD ON [1]\nEND\n'
AGAIN = """WHEN GOOD OFF
P0031 SET GRIP OFF
P0032 MOVEL 0 0 120 0 0 0 [1] {FEEDER}
P0033 HOLD "lay it right"
P0034 MOVEL 0 0 0 0 0 0 [1] {FEEDER}
P0035 SET GRIP ON
END
"""
REGRIPS = "WHEN GOOD OFF\nP0031 SET GRIP OFF\nP0032 WAIT [0.5]\nP0033 SET GRIP ON\nEND\n"


@pytest.mark.parametrize(
    "between",
    [
        "P0035 WAIT [0.3]\n" + WAITS,
        WAITS.replace("END", 'ELSE\nP0036 HOLD "good"\nEND'),
        WAITS + WAITS.replace("P003", "P013"),
        AGAIN,
        REGRIPS,
        "P0036 SET GRIP ON\n",
    ],
)
@pytest.mark.parametrize("count", [1, 2])
def test_a_part_is_still_taken_behind_a_when_at_rest(tmp_path, between, count):
    found = made(tmp_path, UP + DOWN + TAKE + between + LIFT + PUT, count=count)
    assert found.value is not None, found.diagnostics
    assert not {"Y0942", "Y0901"} & {*codes(found.diagnostics)}
    last = found.value.plan.motions[-1].step
    handling = handling_of(
        found.value.plan.robot, found.value.plan.program.cell, found.value.plan.program.steps
    )
    assert last not in handling.runs.away


def test_a_when_between_the_way_in_and_the_set(tmp_path):
    found = made(tmp_path, UP + DOWN + WAITS + TAKE + LIFT + PUT)
    assert found.value is not None, found.diagnostics


def test_a_straight_way_out_goes_on_behind_a_when(tmp_path):
    low = "P0036 MOVEL 0 0 20 0 0 0 [1] {FEEDER}\n"
    found = made(tmp_path, UP + DOWN + TAKE + low + WAITS + LIFT + PUT, count=2)
    assert found.value is not None, found.diagnostics


def test_a_gripper_that_closes_on_one_way_only_has_no_allowance_behind_it(tmp_path):
    ways = "WHEN GOOD ON\n" + TAKE + "END\n"
    found = made(tmp_path, UP + DOWN + ways + LIFT + "P0090 MOVEJ READY\n")
    assert found.value is None
    assert "Y0901" in codes(found.diagnostics)


def test_a_robot_that_comes_back_within_a_when_meets_the_next_part(tmp_path):
    """In one branch, the robot leaves and comes back, and collides with the feeder's next part. In the other
    branch it stays, so that the next part can't come.
    """
    back = UP.replace("P0010", "P0033") + DOWN.replace("P0020", "P0034")
    ways = "WHEN GOOD OFF\n" + LIFT.replace("P0040", "P0031") + "P0032 MOVEJ READY\n" + back + "END\n"
    assert made(tmp_path, UP + DOWN + TAKE + ways + LIFT + PUT, count=1).value is None
    found = made(tmp_path, UP + DOWN + TAKE + ways + LIFT + PUT, count=2)
    assert found.value is None
    assert "BOX 2" in " ".join(one.message for one in found.diagnostics)


def test_the_ways_of_a_retry_lead_out_from_both_sets(tmp_path):
    found = made(tmp_path, UP + DOWN + TAKE + AGAIN + LIFT + PUT, count=2)
    plan = found.value.plan
    handling = handling_of(plan.robot, plan.program.cell, plan.program.steps)
    lift = next(
        at for at, one in enumerate(plan.program.steps) if getattr(one.origin, "label", "") == "P0040"
    )
    first, second = handling.runs.away[lift]
    assert first.between == second.between == ()
    assert handling.runs.leaves[lift] == {first.to, second.to}


def test_the_next_part_stays_away_from_one_that_was_put_back(tmp_path):
    plan = made(tmp_path, UP + DOWN + TAKE + LIFT + PUT, count=3).value.plan
    cell = plan.program.cell
    (grip,), (kind,) = cell.grips.values(), cell.parts
    place = kind.body.mount.transform
    flange = place @ np.linalg.inv(grip.flange_from_grip)
    start = Parts((Item(kind, 1, place.tobytes()),))
    taken, _ = close(start, "M1", grip, flange, 3)
    back = open_(taken, "M1", flange)
    assert arrive(back, ()) == back
    again, _ = close(back, "M1", grip, flange, 7)
    assert [one.taken for one in again.expected] == [7]
    assert arrive(again, {7}) == again
    assert [one.name for one in arrive(again, ()).items] == ["BOX 1", "BOX 2"]
    both = either(taken, again)
    assert [one.is_sure for one in both.items] == [True]
    assert [one.name for one in arrive(both, ()).items] == ["BOX 1", "BOX 2"]
    away = flange.copy()
    away[2, 3] += 0.3
    assert len(arrive(open_(taken, "M1", away), ()).items) == 2
