"""Tests of OFFSET {PART} X DX ...: the lines are planned and proved with the frame shifted by registers, or
refused before anything moves.
"""

from dataclasses import replace

import numpy as np
import pytest
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import codes, compiled
from runtime.virtual import moved_along, path_of, well_behaved, world_of

from yarclang.certify.certifying import certify
from yarclang.coordinator.backwards import known_behind_searches, passed
from yarclang.hir import When
from yarclang.identity import fingerprint
from yarclang.pipeline.boxes import box_findings, places_of
from yarclang.pipeline.jobs import job_of_compiled
from yarclang.pipeline.parts import beginning, part
from yarclang.pipeline.shifting import carried, shifted, shifted_program
from yarclang.pipeline.stages import Request
from yarclang.robot.actuation import to_counts
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.runtime.notices import Abort, Fill, Hold, Planned, Resume, Stop
from yarclang.runtime.pmac.performance import perform
from yarclang.runtime.state import State

HEAD = """OUTPUT LAMP M1
INPUT GRIPPED M12
REGISTER DX -3000..3000 0
REGISTER DY -3000..3000 0
REGISTER DZ -1000..1000 0
REGISTER TURN -2000..2000 0
DEFAULT {TCP} (mm,deg,s) {B}
FRAME {BIN} 100 1100 800 0 0 30
FRAME {PART} 0 20 0 0 0 15 {BIN}
P0010 MOVEL 0 1174.4 1100 0 0 0 [2]
"""
BLOCK = """OFFSET {PART} X DX Y DY Z DZ RZ TURN
  P0020 MOVEL 0 0 100 0 0 0 [60%] {PART}
  P0030 DMOVE 0 0 -100 0 0 0 [60%] {PART}
  P0040 SET LAMP ON
  P0050 WAIT GRIPPED ON [5]
  P0060 MOVEJ_RPY 0 0 100 0 0 0 [60%] {PART}
  P0070 MOVEL 0 1174.4 1100 0 0 0 [60%]
"""
ELSE = 'ELSE\n  P0080 SAY "refused"\n'
TAIL = "END\nP0090 MOVEJ 0 0 0 0 30 0 [2]\n"
PROGRAM = HEAD + BLOCK + ELSE + TAIL
BARE = HEAD + BLOCK + TAIL
NAMES = ("DX", "DY", "DZ", "TURN")


def held(job, values):
    """Return a job whose registers begin with other values."""
    first = dict(zip(NAMES, values, strict=True))
    return replace(
        job, registers=tuple(replace(one, first=first.get(one.name, one.first)) for one in job.registers)
    )


def made(values, text=PROGRAM, *, known=True, touch=1, **options):
    """Return a world before the run, the job, whose registers have given values, and the compiled program."""
    value, found = compiled(text)
    assert value is not None, found
    job = held(job_of_compiled(value, "test"), values)
    world = world_of(job, **options)
    for line in ("M12->*", f"M12={touch}", "M1->*", "M1=0"):
        world.say(line)
    anew = []

    def replan(wanted):
        begins = [abs(one.begins - wanted.begins) for one in job.commands]
        answer = shifted(
            value.plan, int(np.argmin(begins)), wanted.joints, wanted.values, Request(value.plan.robot)
        )
        anew.append((wanted, answer, world.now))
        return answer

    if known:
        world.replan = replan
    world.anew = anew
    return world, job, value


def run(world, job):
    ended = world.perform(perform(world.operation, job))
    assert not world.moving
    return ended


def at_its_end(world, job):
    return np.abs(world.stands(job.robot) - to_counts(job.robot, job.end)).max() <= 1.0


def turned(angle):
    pose = np.eye(4)
    pose[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    return pose


def placed(x, y, z, angle):
    pose = turned(np.deg2rad(angle))
    pose[:3, 3] = np.array([x, y, z]) / 1000.0
    return pose


def base_from_part(values):
    x, y, z, turn = np.array(values) / 100.0
    return placed(100, 1100, 800, 30) @ placed(0, 20, 0, 15) @ placed(x, y, z, turn)


BOX = st.tuples(*(st.integers(-high, high) for high in (3000, 3000, 1000, 2000)))


@exercises(shifted=0.5)
@settings(max_examples=12)
@given(BOX, st.floats(0.0, 0.003), st.integers(0, 2**32))
def test_anywhere_in_the_box(tally, values, delay, seed):
    """The frame reaches the shifted position along the proved path. All other motions are as without
    a shift.
    """
    world, job, value = made(values, record=True, delay=delay, seed=seed)
    ended = run(world, job)
    ((wanted, answer, since),) = world.anew
    assert wanted.values == values
    tally.count("shifted", not isinstance(answer, str))
    assert ended.well, ended
    assert at_its_end(world, job)
    if isinstance(answer, str):
        assert "refused" in world.words
        assert world.say("M1") == ("0",)
        return
    down, up = answer.jobs
    assert [one.index for one in down.commands] == ["P0020", "P0030"]
    assert [one.index for one in up.commands] == ["P0060", "P0070"]
    poses = tool_poses(job.robot.chain, np.stack([down.end]), job.robot.flange_from_frame["TCP"])
    assert poses[0] == pytest.approx(base_from_part(values), abs=1e-6)
    assert world.say("M1") == ("1",)
    number = next(
        n for n, one in enumerate(value.plan.motions) if value.program.steps[one.step].origin.index == "P0020"
    )
    meant = shifted_program(value.plan, number, wanted.joints, values, Request(job.robot))
    until = min(world.now, since + down.duration + 0.1)
    off = path_of(meant.plan).distance(
        world.machine.positions(np.arange(since, until, 0.02), job.robot.controller.motors)
    )
    assert off < 1.0  # [counts]; a shift would be thousands
    assert [one.kind for one in world.told if isinstance(one, Planned)] == ["offset"]
    assert '"certified": true' in down.certificate or down.certificate


def test_without_a_shift_it_is_what_was_proved():
    world, job, value = made((0, 0, 0, 0), record=True)
    assert run(world, job).well
    assert moved_along(world, job, value.plan, 0.0, step=0.05) < 1.0


@pytest.mark.parametrize("text", [PROGRAM, BARE])
@pytest.mark.parametrize(
    "values",
    [(3001, 0, 0, 0), (0, -3001, 0, 0), (0, 0, 10**9, 0), (0, 0, 0, -2001), (9999, 9999, 9999, 9999)],
)
def test_a_value_out_of_its_range_moves_nothing(values, text):
    world, job, _ = made(values, text, record=True)
    if text is BARE:
        world.order(Stop(), 30.0)
    ended = run(world, job)
    assert not world.anew
    assert "its range is" in world.words
    assert world.say("M1") == ("0",)
    if text is BARE:
        assert not ended.well
        assert world.operation.state is State.STOP
        assert (
            "nothing has moved; try again with Enter or `yarc resume`, with the values that the "
            "registers have then" in world.words
        )
    else:
        assert ended.well
        assert "refused" in world.words


OUTSIDE = BARE.replace("-3000..3000 0\n", "-3000..3000 0 OUTSIDE\n", 1).replace(
    "-1000..1000", "-300000..300000"
)


def test_without_an_else_it_holds_with_the_reason_until_it_can_be_done():
    """Without ELSE, an impossible shift holds the run with a reason. Resumed with the same values, it holds
    again. Resumed with new values from outside, it moves.
    """
    world, job, _ = made(
        (9999, 0, 0, 0), OUTSIDE.replace("OUTPUT LAMP M1", "OUTPUT LAMP M1 OFF"), record=True
    )
    world.order(Resume(), 10.0)
    world.order(Fill((("DX", 500),), "camera"), 20.0)
    world.order(Resume(), 21.0)
    ended = run(world, job)
    assert ended.well, ended
    assert world.words.count("DX is 9999, but its range is -3000..3000") >= 2
    assert [one[0].values for one in world.anew] == [(500, 0, 0, 0)]
    assert world.anew[0][2] >= 21.0
    assert at_its_end(world, job)


def test_what_cannot_be_planned_holds_as_well():
    world, job, _ = made((0, 0, 299999, 0), OUTSIDE)
    world.order(Resume(), 10.0)
    world.order(Abort(), 20.0)
    ended = run(world, job)
    assert not ended.well
    assert world.operation.state is State.STOP
    assert [one[0].values for one in world.anew] == [(0, 0, 299999, 0)] * 2
    assert "the motions aren't possible: P0020" in world.words


def test_a_place_out_of_reach_is_refused_with_its_command():
    text = PROGRAM.replace("-1000..1000", "-300000..300000")
    world, job, _ = made((0, 0, 299999, 0), text)
    assert run(world, job).well
    ((_, answer, _),) = world.anew
    assert isinstance(answer, str)
    assert answer.startswith("P0020: ")
    assert "the motions aren't possible: P0020" in world.words
    assert "refused" in world.words


def test_nobody_knows_the_program():
    world, job, _ = made((100, 0, 0, 0), known=False)
    assert run(world, job).well
    assert "refused" in world.words
    assert world.say("M1") == ("0",)
    world, job, _ = made((100, 0, 0, 0), BARE, known=False)
    assert run(world, job).code == "Y1635"


def lying(answer, jobs):
    return replace(answer, jobs=tuple(jobs))


@pytest.mark.parametrize(
    "lie",
    [
        lambda jobs: jobs[:1],
        lambda jobs: (*jobs, jobs[1]),
        lambda jobs: (jobs[1], jobs[0]),
        lambda jobs: (replace(jobs[0], sets=()), jobs[1]),
        lambda jobs: (replace(jobs[0], commands=jobs[1].commands), jobs[1]),
        lambda jobs: (),
    ],
)
def test_what_was_planned_does_what_the_text_does(lie):
    world, job, _ = made((100, 0, 0, 0))
    honest = world.replan
    world.replan = lambda wanted: lying(answer := honest(wanted), lie(answer.jobs))
    assert run(world, job).well
    assert "the shift would change which commands are executed" in world.words
    assert world.say("M1") == ("0",)


@pytest.mark.parametrize("order", [Stop(), Abort()])
@pytest.mark.parametrize("after", [0.5, 2.0, 2.03, 3.0, 4.5, 6.0])
def test_a_stop_at_any_time(order, after):
    world, job, _ = made((2000, 1000, 0, 700))
    world.order(order, after)
    ended = run(world, job)
    assert not ended.well
    assert world.operation.state is State.STOP


@pytest.mark.parametrize("after", [1.0, 2.02, 2.5, 4.0, 5.0])
def test_a_hold_and_a_resume(after):
    world, job, _ = made((2000, 1000, 0, 700), record=True)
    world.order(Hold(), after)
    world.order(Resume(), after + 3.0)
    assert run(world, job).well
    assert at_its_end(world, job)


@pytest.mark.parametrize("fault", ["drop@2.05", "drop@2.6", "freeze@2.5", "reset@3.0"])
def test_what_fails_in_between(fault):
    """If the connection or the controller is lost, the run ends, and nothing continues by itself."""
    world, job, _ = made((2000, 1000, 0, 700))
    world.spoil_by(fault)
    assert not run(world, job).well


def test_a_part_that_was_not_gripped():
    """A WAIT in the block that isn't fulfilled ends the run where the robot stands, like any other WAIT."""
    world, job, _ = made((500, 500, 0, 0), touch=0)
    ended = run(world, job)
    assert (ended.well, ended.code) == (False, "Y1604")


def test_well_behaved():
    world, job, _ = made((500, -500, 100, 300))
    assert run(world, job).well
    well_behaved(world)


def test_a_loop_takes_new_values_in_each_pass():
    text = HEAD + "LOOP\n" + BLOCK + ELSE + "END\nP0095 SET DX = DX + 400\nUNTIL DX > 900\n"
    world, job, _ = made((-300, 0, 0, 0), text)
    ended = run(world, job)
    assert ended.well, ended
    assert [one[0].values[0] for one in world.anew] == [-300, 100, 500, 900]
    assert at_its_end(world, job)


@pytest.mark.parametrize("does", ["stalls", "lies", "repeats"])
def test_values_from_outside(does):
    """Registers get only values that were asked for and are in range. A camera that sends nothing leads to
    the ELSE of the WAIT.
    """
    head = HEAD.replace("-3000..3000 0\n", "-3000..3000 0 OUTSIDE\n", 1)
    text = head + 'P0012 WAIT DX > -3000 [2] ELSE\n P0013 ABORT "stuck"\nEND\n' + BLOCK + ELSE + TAIL
    world, job, _ = made((0, 0, 0, 0), text.replace("-3000..3000 0 OUTSIDE", "-3000..3000 -3000 OUTSIDE"))
    job = replace(
        job, registers=tuple(replace(r, first=-3000) if r.name == "DX" else r for r in job.registers)
    )

    def fill(value):
        world.operation.orders.append(Fill((("DX", value),), "camera"))

    if does != "stalls":
        world.do(lambda: fill(1234 if does == "repeats" else 10**6), 3.0)
    if does == "repeats":
        world.do(lambda: fill(-2000), 3.001)
    ended = run(world, job)
    if does == "stalls":
        assert (ended.well, ended.code) == (False, "Y1635")
        assert not world.anew
    elif does == "lies":  # the values bypass the check of the door, so the OFFSET's own check refuses them
        assert ended.well
        assert not world.anew
        assert "refused" in world.words
    else:
        assert ended.well
        assert len(world.anew) == 1
        assert world.anew[0][0].values[0] in (1234, -2000)


KEPT = PROGRAM.replace(
    "OFFSET {PART} X DX Y DY Z DZ RZ TURN\n",
    "OFFSET {PART} X DX Y DY Z DZ RZ TURN\nKEEP {TCP} ABOVE 795 (mm) {B}\n",
).replace("  P0060", "END\n  P0060")


@pytest.mark.parametrize(("lower", "is_refused"), [(0, False), (400, False), (600, True), (1000, True)])
def test_a_rule_of_keep_holds_where_the_frame_is(lower, is_refused):
    """The part lies 5 mm above a plane that KEEP doesn't let the tool cross. A shift down by more
    is refused.
    """
    world, job, _ = made((0, 0, -lower, 0), KEPT)
    assert run(world, job).well
    ((_, answer, _),) = world.anew
    assert isinstance(answer, str) == is_refused
    assert ("the motions aren't possible: P0030" in world.words) == is_refused


@pytest.mark.parametrize("of", ["PART", "BIN"])
def test_what_is_kept_to_is_not_shifted(of):
    _, found = compiled(KEPT.replace("(mm) {B}", f"(mm) {{{of}}}").replace("ABOVE 795", "ABOVE -5"))
    assert ("Y0477" in codes(found)) == (of == "PART")


LINE = "; offset 1 OFFSET_1 DX DY DZ TURN PART\n"


@pytest.mark.parametrize(
    "change",
    [
        (LINE, ""),
        (LINE, LINE * 2),
        (LINE, LINE.replace(" 1 ", " 2 ")),
        (LINE, LINE.replace(" 1 ", " 0 ")),
        (LINE, LINE.replace("OFFSET_1", "DX")),
        (LINE, LINE.replace("OFFSET_1", "OFFSET_2")),
        (LINE, LINE.replace("DX DY", "DY DX")),
        (LINE, LINE.replace("DX DY", "DX DX")),
        (LINE, LINE.replace("DX DY", "DX -")),
        (LINE, LINE.replace("DX DY DZ TURN", "- - - -")),
        (LINE, LINE.replace("DX DY", "DX OFFSET_1")),
        (LINE, LINE.replace("DX DY", "DX NONE")),
        (LINE, LINE.replace("TURN PART", "TURN BIN")),
        (LINE, LINE.replace("TURN PART", "TURN")),
        (LINE, LINE.replace("TURN PART", "TURN  PART")),
        (LINE, LINE.replace("; offset", "; offsets")),
        ("$OFFSET_1=1 ", "$OFFSET_1=0 "),
        ("$OFFSET_1=1 ", "$DX=0 "),
        ("; register OFFSET_1 0 1 0", "; register OFFSET_1 0 1 1"),
        ("; register OFFSET_1 0 1 0", "; register OFFSET_1 0 1 0 outside"),
        ("; register DX -3000 3000 0", "; register DX -9000 9000 0"),
        ("; register DX -3000 3000 0", "; register DX 1 3000 1"),
        (
            "; register DX -3000 3000 0\n; register DY -3000 3000 0\n",
            "; register DY -3000 3000 0\n; register DX -3000 3000 0\n",
        ),
    ],
)
def test_the_certificate_refuses_a_text_that_shifts_otherwise(change, industrial6):
    program, _ = compiled(PROGRAM)
    assert change[0] in program.text
    changed = program.text.replace(*change, 1)
    judged = certify(changed, program.program, industrial6, industrial6.tolerance)
    assert any(one.is_error for one in judged.diagnostics), change


def test_the_judge_computes_a_shifted_pose_by_itself(industrial6):
    """A goal that isn't where the reported shift carries it is refused: the judge computes shifted poses
    itself.
    """
    value, _ = compiled(PROGRAM)
    number = next(
        n for n, one in enumerate(value.plan.motions) if value.program.steps[one.step].origin.index == "P0020"
    )
    here = value.plan.motions[number].curve.points[0]
    instance = shifted_program(value.plan, number, here, (500, 0, 0, 300), Request(industrial6))
    assert not any(
        one.is_error
        for one in certify(instance.text, instance.program, industrial6, industrial6.tolerance).diagnostics
    )
    honest = instance.program.steps[0]
    for links in ("moved", "other"):
        goal = honest.goal
        if links == "moved":
            pose = goal.base_from_moving.copy()
            pose[0, 3] += 1e-4
            goal = replace(goal, base_from_moving=pose)
        else:
            link = goal.told.base
            goal = replace(goal, told=replace(goal.told, base=link.parent))
        lied = replace(instance.program, steps=(replace(honest, goal=goal), *instance.program.steps[1:]))
        judged = certify(instance.text, lied, industrial6, industrial6.tolerance)
        assert any(one.is_error for one in judged.diagnostics), links


@settings(max_examples=30, deadline=None)
@given(BOX)
def test_goals_are_carried_rigidly(values):
    """Goals in a shifted frame keep their places in the frame. All other goals stay."""
    value, _ = compiled(PROGRAM)
    steps = value.program.steps
    begin = next(n for n, one in enumerate(steps) if isinstance(one, When))
    offset = steps[begin].offset
    body = steps[begin + 1 : begin + 7]
    now = carried(body, offset, values)
    part = base_from_part(values)
    assert now[0].goal.base_from_moving[:3, 3] == pytest.approx((part @ [0, 0, 0.1, 1])[:3], abs=1e-12)
    assert now[1].goal.axes == pytest.approx(part[:3, :3], abs=1e-12)
    assert now[5].goal.base_from_moving is body[5].goal.base_from_moving
    assert not any(one.goal.shifted for one in (now[0], now[1]) if any(values))


def found(text):
    return codes(compiled(text)[1])


@pytest.mark.parametrize(
    ("change", "code"),
    [
        (("OFFSET {PART}", "OFFSET {TCP}"), "Y0476"),
        (("OFFSET {PART}", "OFFSET {B}"), "Y0476"),
        (("OFFSET {PART}", "OFFSET {NONE}"), "Y0301"),
        (("OFFSET {PART}", "OFFSET"), "Y0302"),
        (("X DX Y DY Z DZ RZ TURN", ""), "Y0401"),
        (("X DX Y DY Z DZ RZ TURN", "X"), "Y0401"),
        (("X DX Y DY Z DZ RZ TURN", "X 5"), "Y0401"),
        (("X DX Y DY Z DZ RZ TURN", "X DX X DY"), "Y0476"),
        (("X DX Y DY Z DZ RZ TURN", "X DX Y DX"), "Y0476"),
        (("X DX Y DY Z DZ RZ TURN", "RX TURN"), "Y0476"),
        (("X DX Y DY Z DZ RZ TURN", "X GRIPPED"), "Y0209"),
        (("X DX Y DY Z DZ RZ TURN", "X NOTHING"), "Y0210"),
        (("REGISTER DX -3000..3000 0", "REGISTER DX 1..3000"), "Y0476"),
        (("  P0070 MOVEL 0 1174.4 1100 0 0 0 [60%]\n", ""), "Y0477"),
        (
            (
                "0 0 100 0 0 0 [60%] {PART}\n  P0070 MOVEL 0 1174.4 1100 0 0 0 [60%]",
                "0 0 100 0 0 0 [60%] {PART}\n  P0070 DMOVE 0 0 10 0 0 0 [60%]",
            ),
            "Y0477",
        ),
        (("  P0040 SET LAMP ON\n", "  WHEN GRIPPED ON\n    P0040 SET LAMP ON\n  END\n"), "Y0477"),
        (("  P0040 SET LAMP ON\n", '  P0040 ABORT "x"\n'), "Y0477"),
        (("  P0040 SET LAMP ON\n", "  OFFSET {BIN} X DX\n  END\n"), "Y0477"),
        (("[60%] {PART}\n  P0040", "[60%] {PART} UNTIL GRIPPED\n  P0040"), "Y0412"),
    ],
)
def test_what_is_wrong_is_told(change, code):
    assert change[0] in PROGRAM
    assert code in found(PROGRAM.replace(*change))


def test_nothing_is_shifted():
    assert "Y0477" in found(PROGRAM.replace("[60%] {PART}", "[60%] {BIN}"))
    assert found(PROGRAM) == [] or not any(one.is_error for one in compiled(PROGRAM)[1])


def test_the_frame_and_the_registers_are_part_of_the_program():
    other = PROGRAM.replace("P0010", "FRAME {OTHER} 0 20 0 0 0 15 {BIN}\nP0010", 1)
    marks = [
        fingerprint(compiled(text)[0].program)
        for text in (
            other,
            other.replace("X DX Y DY", "X DY Y DX"),
            other.replace("OFFSET {PART}", "OFFSET {BIN}"),
            # a goal at the same place, but in another frame, isn't shifted
            other.replace(
                "P0020 MOVEL 0 0 100 0 0 0 [60%] {PART}", "P0020 MOVEL 0 0 100 0 0 0 [60%] {OTHER}"
            ),
        )
    ]
    assert len(set(marks)) == len(marks)


def test_the_box_is_tried():
    value, _ = compiled(PROGRAM.replace("Z DZ ", ""))
    request = Request(value.plan.robot)
    assert list(box_findings(value.plan, request)) == []
    (offset,) = [one.offset for one in value.program.steps if isinstance(one, When)]
    places = places_of(offset, value.program)
    assert len(places) == 27
    assert {(-3000, -3000, 0, -2000), (3000, 3000, 0, 2000), (0, 0, 0, 0), (0, -3000, 0, 2000)} <= set(places)
    wide = PROGRAM.replace("Z DZ ", "").replace("REGISTER DX -3000..3000", "REGISTER DX -3000..90000")
    value, _ = compiled(wide)
    (told,) = box_findings(value.plan, request)
    assert told.code == "Y0508"
    assert " of 27 places in the box" in told.message
    assert "X 900.00 mm" in told.message
    assert "P0020: " in told.message


def test_not_more_is_tried_than_is_said(monkeypatch):
    monkeypatch.setattr("yarclang.pipeline.boxes.MOST_TRIED", 3)
    value, _ = compiled(PROGRAM)
    told = list(box_findings(value.plan, Request(value.plan.robot)))
    assert codes(told) == ["Y0509"]
    assert told[0].message.startswith("78 of 81 ")


@pytest.mark.parametrize("place", ["P0030", "P0060", "P0070"])
def test_no_run_begins_in_an_offset(place):
    value, _ = compiled(PROGRAM)
    number, step = beginning(value.plan, place)
    refused = part(value.plan, Request(value.plan.robot), number, None, with_lead=False, step=step)
    assert codes(refused.diagnostics) == ["Y1164"]


def test_no_way_back_leads_through_a_shifted_frame():
    value, _ = compiled(BARE)
    motions = passed(value.plan)
    assert [one.step.origin.index for one in motions] == [
        "P0010",
        "P0020",
        "P0030",
        "P0060",
        "P0070",
        "P0090",
    ]
    assert [one.step.origin.index for one in known_behind_searches(motions)] == ["P0090"]
    for end in range(2, 6):
        assert known_behind_searches(motions[:end]) == []
    assert known_behind_searches(motions[:1]) == list(motions[:1])
