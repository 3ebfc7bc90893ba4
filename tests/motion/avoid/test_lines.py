"""Tests of MOVEL_AVOID: the motion is straight if the line is free, otherwise it consists of straight legs
around the obstacles, all of them proved. Also tests of the findings if this is impossible, and of a planner
with wrong legs.
"""

from dataclasses import replace

import numpy as np
import pytest
from programs import codes, compiled, planned

from tests.motion.avoid.cells import box, loading
from yarclang.certify.certifying import certify
from yarclang.certify.legs import strayed
from yarclang.hir import Gap, LineMove, Reading
from yarclang.pipeline.stages import claims_of
from yarclang.robot.kinematics.fk import tool_poses

HEAD = 'CELL "cell.toml"\nDEFAULT {TCP} [MIN] (mm,deg,s) {B}\nP0010 MOVEJ_RPY -450 850 900 -90 0 0\n'
BOX = box("BOX", [0.0, 0.9, 0.5], [0.3, 0.3, 1.0], 0.01)
GO = "450 850 900 -90 0 0"


def made(line, *obstacles):
    return compiled(HEAD + line, load_cell=loading(*(obstacles or (BOX,))))


def errors(found):
    return codes([one for one in found if one.is_error])


@pytest.mark.parametrize(
    "line",
    [
        f"P0020 MOVEL_AVOID {GO}",
        f"P0020 MOVEL_RPY_AVOID_TOPP {GO}",
        "P0020 MOVEL_QUAT_AVOID 450 850 900 -0.7071067811865476 0 0 0.7071067811865476",
        f"P0020 MOVEL_AVOID_POLY5 {GO} [14]",
        f"P0020 MOVEL_AVOID {GO} [V 150]",
        f"P0020 MOVEL_AVOID {GO} [V<=200]",
        f"P0020 MOVEL_AVOID_SCURVE {GO} [50%] ACC 40% TOL 0.05",
        "P0020 MOVEL_AVOID 450 850 900 -60 20 30",
    ],
)
def test_every_form_goes_round_and_is_proved(line):
    value, found = made(line)
    assert not errors(found), found
    assert "Y0920" in codes(found)
    _, *legs = value.certificate.commands
    assert len(legs) == len(value.plan.motions) - 1 > 1
    for leg in legs:
        assert leg.kind == "line"
        assert leg.clearance.distance > 0.01
        assert leg.deviation.position < 1e-4 if "TOL" in line else 2e-5
    if "[14]" in line:
        assert sum(leg.duration for leg in legs) == pytest.approx(14.0, abs=1e-3)
    end = value.plan.motions[-1].waypoints[-1]
    pose = tool_poses(value.plan.robot.chain, end[None], value.plan.program.steps[-1].goal.flange_from_moving)
    assert np.abs(pose[0, :3, 3] - [0.45, 0.85, 0.9]).max() < 1e-6


def test_without_an_obstacle_it_is_the_very_line():
    value, found = made(f"P0020 MOVEL_AVOID {GO}", box("FAR", [0, 5, 0], [0.1, 0.1, 0.1]))
    assert codes(found) == []
    straight, _ = made(f"P0020 MOVEL {GO}", box("FAR", [0, 5, 0], [0.1, 0.1, 0.1]))
    assert len(value.plan.motions) == 2
    assert np.array_equal(value.plan.motions[1].curve.points, straight.plan.motions[1].curve.points)


def test_a_program_without_a_cell_goes_straight():
    text = HEAD.partition("\n")[2] + f"P0020 MOVEL_AVOID {GO}"
    value, found = compiled(text)
    straight, _ = compiled(text.replace("_AVOID", ""))
    assert codes(found) == []
    assert np.array_equal(value.plan.motions[1].curve.points, straight.plan.motions[1].curve.points)


def test_the_same_program_gives_the_same_text():
    one, other = (made(f"P0020 MOVEL_AVOID {GO}")[0].text for _ in range(2))
    assert one == other


def test_without_avoid_it_is_refused_and_the_fix_leads_round():
    value, found = made(f"P0020 MOVEL {GO}")
    assert value is None
    (hit,) = [one for one in found if one.code == "Y0901"]
    assert hit.fix.edits[0].text == "MOVEL_AVOID"
    (hit,) = [one for one in made(f"P0020 MOVEL_RPY_TOPP {GO}")[1] if one.code == "Y0901"]
    assert hit.fix.edits[0].text == "MOVEL_RPY_AVOID_TOPP"


def test_it_flows_into_its_neighbours():
    text = (
        "P0015 MOVEL -400 850 900 -90 0 0 BLEND 10\n"
        f"P0020 MOVEL_AVOID {GO} BLEND 10\nP0030 MOVEL 450 850 1000 -90 0 0"
    )
    value, found = made(text)
    assert not errors(found), found
    flows = [motion.flows for motion in value.plan.motions]
    assert flows[1]
    assert flows[-2]
    assert not flows[-1]


def test_an_offset_refuses_it_with_a_reason():
    head = HEAD.replace("P0010", "FRAME {F} 0 0 0 0 0 0\nREGISTER DX -2000..2000 0 OUTSIDE\nP0010", 1)
    text = head + f"OFFSET {{F}} X DX\nP0020 MOVEL_AVOID {GO} {{F}}\nP0030 MOVEL 450 850 950 -90 0 0\nEND"
    value, found = compiled(text, load_cell=loading(BOX))
    assert value is None
    (refused,) = [one for one in found if one.code == "Y0477"]
    assert "Y0920" in refused.message
    fine = text.replace("MOVEL_AVOID 450", "MOVEL -450")
    assert not errors(compiled(fine, load_cell=loading(BOX))[1])


@pytest.mark.parametrize(
    ("line", "obstacles", "code", "part"),
    [
        (f"P0020 MOVEL_AVOID {GO}", (box("AT_GOAL", [0.45, 0.85, 0.9], [0.3] * 3),), "Y0922", "AT_GOAL"),
        (f"P0020 MOVEL_AVOID {GO}", (box("AT_START", [-0.45, 0.85, 0.9], [0.3] * 3),), "Y0921", "AT_START"),
        ("P0020 MOVEL_AVOID 450 850 900 90 0 0", (BOX,), "Y0409", "180 deg"),
        ("P0020 MOVEL_AVOID 9450 850 900 -90 0 0", (BOX,), "Y0501", "reach"),
    ],
)
def test_what_cannot_be_done_is_said(line, obstacles, code, part):
    value, found = made(line, *obstacles)
    assert value is None
    assert code in errors(found), found
    assert any(part in one.message for one in found), found


WALLS = (
    box("WALL", [0, 1.0, 1.5], [0.02, 1.2, 3.0]),
    box("LID", [0, 0.9, 2.6], [4.0, 4.0, 0.04]),
)


def test_nothing_found_is_said_with_the_tries(monkeypatch):
    from yarclang.motion.avoid import lines
    from yarclang.motion.leading import frame_motions

    monkeypatch.setattr(frame_motions, "EFFORTS", (lines.Effort(0.01, 0.03, 40),))
    value, found = made(f"P0020 MOVEL_AVOID {GO}", *WALLS)
    assert value is None
    (one,) = [one for one in found if one.is_error]
    assert one.code == "Y0923"
    assert "tries (one may still exist): the search came as far as" in one.message
    assert "WALL" in one.message


def moved(step, by):
    pose = step.goal.base_from_moving.copy()
    pose[:3, 3] += by
    return replace(step, goal=replace(step.goal, base_from_moving=pose))


@pytest.fixture(scope="module")
def proved():
    value, found = made(f"P0020 MOVEL_AVOID {GO} [9]")
    assert not errors(found)
    return value


def judged(value, steps):
    plan = value.plan
    program = replace(plan.program, steps=tuple(steps))
    robot = plan.robot
    return errors(certify(value.text, program, robot, robot.tolerance, claims_of(plan)).diagnostics)


def test_a_text_is_held_to_the_legs(proved):
    """A text is refused if a via pose was moved, or if a leg was left out or is in another order."""
    first, one, two, *rest = steps = list(proved.plan.program.steps)
    assert judged(proved, steps) == []
    assert judged(proved, [first, moved(one, [0, 0, 2e-3]), two, *rest])
    assert judged(proved, [first, two, *rest])
    assert judged(proved, [first, one, *rest])
    assert judged(proved, [first, two, one, *rest])
    assert judged(proved, [first, one, two, *rest, rest[-1]])


def lies(steps):
    first, one, two, *rest = steps
    last = steps[-1]
    shared = replace(one.timing, duration=one.timing.duration + 0.5)
    yield "a goal moved", [first, one, two, *rest[:-1], moved(last, [0, 1e-3, 0])]
    yield "the last leg left out", [first, one, two, *rest][:-1]
    yield "a command left out", [one, two, *rest]
    yield "a command more", [*steps, last]
    yield "another command in between", [first, one, Gap(), two, *rest]
    yield "longer", [first, replace(one, timing=shared), two, *rest]
    yield "as fast as possible", [first, replace(one, timing=replace(one.timing, duration=None)), two, *rest]
    yield "less exact", [first, replace(one, tolerance=0.1), two, *rest]
    yield "another law", [first, replace(one, profile="POLY5"), two, *rest]
    yield "a corner that is rounded", [first, replace(one, blend=Reading(0.05, None)), two, *rest]
    yield "an end that is rounded", [*steps[:-1], replace(last, blend=Reading(0.05, None))]
    yield "bodies that may touch", [first, replace(one, allowed=(object(),)), two, *rest]
    yield "another frame", [
        first, replace(one, goal=replace(one.goal, flange_from_moving=np.eye(4))), two, *rest
    ]  # fmt: skip
    bent = one.goal.base_from_moving.copy()
    bent[0, 0] = 0.9
    yield "no pose", [first, replace(one, goal=replace(one.goal, base_from_moving=bent)), two, *rest]
    yield "a pose that the judge would compute", [
        first, replace(one, goal=replace(one.goal, told=last.goal.told)), two, *rest
    ]  # fmt: skip
    yield "the line itself", [first, replace(last, avoids=True)]


def test_a_lying_planner_is_found_out(proved):
    plan = proved.plan
    asked = plan.asked
    assert [type(step) for step in asked.steps].count(LineMove) == 1
    assert strayed(asked, plan.program) is None
    for name, steps in lies(list(plan.program.steps)):
        found = strayed(asked, replace(plan.program, steps=tuple(steps)))
        assert found is not None, name
        assert found.code == "Y0964"
    assert strayed(asked, replace(plan.program, start=plan.program.start + 0.1)) is not None
    assert strayed(asked, replace(plan.program, cell=None)) is not None


def test_the_pipeline_asks_the_judge(monkeypatch):
    from yarclang.motion import routes

    honest = routes.Router.in_legs

    def lying(self):
        steps, done = honest(self)
        return (*steps[:-1], moved(steps[-1], [0, 0, 1e-3])), done

    monkeypatch.setattr(routes.Router, "in_legs", lying)
    value, found = planned(HEAD + f"P0020 MOVEL_AVOID {GO}", load_cell=loading(BOX))
    assert value is None
    assert "Y0964" in errors(found)
