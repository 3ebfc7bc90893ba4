"""Tests of ON CURTAIN OFF HOLD: at whatever instant the input changes, the motion is held on its path, and
continues only when a user resumes.
"""

import numpy as np
import pytest
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st
from runtime.virtual import SHORT, lines_of, moved_along, prepared, well_behaved, world_of

from yarclang.certify.certifying import certify
from yarclang.pipeline.jobs import job_of_compiled
from yarclang.pipeline.parts import approach
from yarclang.robot.actuation import to_counts
from yarclang.runtime.notices import Abort, Hold, Resume, Stop
from yarclang.runtime.pmac.messages import Ask, Write
from yarclang.runtime.pmac.performance import perform
from yarclang.runtime.pmac.supervision import Supervision
from yarclang.runtime.state import State

HEAD = "INPUT CURTAIN M11\nON CURTAIN OFF HOLD\n"
WATCHED = HEAD + SHORT


def made(text=WATCHED, *, curtain=1, record=False, **options):
    """Return a world before the run, a job that watches M11, and its plan."""
    job, plan = prepared(text)
    world = world_of(job, record=record, **options)
    world.say("M11->*")
    world.say(f"M11={curtain}")
    return world, job, plan


def run(world, job, **options):
    ended = world.perform(perform(world.operation, job), **options)
    well_behaved(world)
    assert not world.moving
    return ended


def holds(world):
    """Return the times at which holds of the motion were sent."""
    return [one.time for one in world.sent if isinstance(one.request, Ask) and one.request.line == "&1H"]


def at_its_end(world, job):
    return np.abs(world.stands(job.robot) - to_counts(job.robot, job.end)).max() <= 1.0


@exercises(held=0.6)
@settings(max_examples=20)
@given(st.integers(0, 1100), st.floats(0.3, 3.0), st.floats(0.0, 0.002), st.integers(0, 2**32))
def test_a_curtain_at_any_instant(tally, thousandths, opened, delay, seed):
    world, job, plan = made(record=True, delay=delay, seed=seed)
    after = thousandths / 1000 * job.duration  # sometimes before the motion begins, or after its end
    since, edge = world.now, []
    world.do(lambda: (world.say("M11=0"), edge.append(world.now)), after)
    world.order(Resume(), after + 0.5 * opened)  # too early: the motion stays held
    world.do(lambda: world.say("M11=1"), after + opened)
    world.order(Resume(), after + opened + 0.1)
    ended = run(world, job)
    assert ended.well, ended
    assert at_its_end(world, job)
    assert moved_along(world, job, plan, since, step=0.05) < 1.0
    tally.count("held", "held on the path" in world.words)
    if "held on the path" in world.words:
        # The input is read every 5 ms, after the requests that are in progress.
        assert min(holds(world)) - edge[0] <= 0.005 + 6.0 * delay + 0.007
        assert "the hold continues: CURTAIN (M11) is OFF" in world.words
        assert world.now - since > job.duration + 0.9 * opened
    assert (world.states.count(State.HOLD) > 0) == ("CURTAIN (M11) is OFF" in world.words)


def test_nothing_begins_while_it_is_open():
    world, job, _ = made(curtain=0)
    world.order(Resume(), 1.0)
    world.do(lambda: world.say("M11=1"), 2.0)
    world.order(Resume(), 3.0)
    since = world.now
    stands = world.stands(job.robot)
    world.do(lambda: np.testing.assert_allclose(world.stands(job.robot), stands, atol=1e-6), 2.9)
    assert run(world, job).well
    assert at_its_end(world, job)
    assert world.now - since > job.duration + 2.5
    assert "the motion isn't started" in world.words
    assert world.states[-4:] == [State.INIT, State.HOLD, State.MOVE, State.STOP]


@pytest.mark.parametrize("order", [Stop(), Abort()])
@pytest.mark.parametrize("curtain", [0, 1])
def test_a_stop_while_it_is_open(order, curtain):
    world, job, _ = made(curtain=curtain)
    world.do(lambda: world.say("M11=0"), 1.0)
    world.order(order, 3.0)
    ended = run(world, job)
    assert not ended.well
    assert world.operation.state is State.STOP
    assert not curtain or 0.5 < ended.done < 1.5


def test_a_person_s_hold_and_a_curtain():
    """A hold that a user has ordered can't be resumed while the curtain is interrupted."""
    world, job, _ = made()
    world.order(Hold(), 1.0)
    world.do(lambda: world.say("M11=0"), 1.5)
    world.order(Resume(), 2.0)
    world.do(lambda: world.say("M11=1"), 3.0)
    world.order(Resume(), 4.0)
    assert run(world, job).well
    assert at_its_end(world, job)
    assert "the hold continues: CURTAIN (M11) is OFF" in world.words


def test_one_that_opens_again_and_again():
    world, job, _ = made()
    for number in range(12):
        world.do(lambda: world.say("M11=0"), 0.4 + number)
        world.do(lambda: world.say("M11=1"), 0.6 + number)
        world.order(Resume(), 0.9 + number)
    assert run(world, job).well
    assert at_its_end(world, job)
    assert world.states.count(State.HOLD) >= 5


@pytest.mark.parametrize("curtain", [0, 1])
def test_nobody_is_there(curtain):
    world, job, _ = made(curtain=curtain)
    world.operation.unattended = True
    world.do(lambda: world.say("M11=0"), 1.0)
    ended = run(world, job)
    assert (ended.well, ended.code) == (False, "Y1637")
    assert "CURTAIN (M11) is OFF" in ended.what
    assert not world.moving


def test_each_leg_looks_before_it_begins():
    text = (
        "INPUT DOOR M12\n" + HEAD + "P10 MOVEJ 20 0 0 0 0 0 [1] (deg,s)\n"
        "P20 WAIT DOOR ON [9] (s)\nP30 MOVEJ 0 0 0 0 0 0 [1] (deg,s)\n"
    )
    world, job, _ = made(text)
    for line in ("M12->*", "M12=0"):
        world.say(line)
    world.do(lambda: world.say("M11=0"), 2.0)  # during the WAIT
    world.do(lambda: world.say("M12=1"), 3.0)
    world.do(lambda: world.say("M11=1"), 5.0)
    world.order(Resume(), 6.0)
    since = world.now
    assert run(world, job).well
    assert at_its_end(world, job)
    assert world.now - since > 6.5
    assert "the motion isn't started" in world.words


def test_several_inputs():
    text = "INPUT CURTAIN M11\nINPUT FAULT M12\nON CURTAIN OFF HOLD\nON FAULT ON HOLD\n" + SHORT
    world, job, _ = made(text)
    for line in ("M12->*", "M12=0"):
        world.say(line)
    world.do(lambda: world.say("M12=1"), 1.0)
    world.do(lambda: world.say("M11=0"), 1.0)
    world.do(lambda: (world.say("M11=1"), world.say("M12=0")), 2.0)
    world.order(Resume(), 2.5)
    assert run(world, job).well
    assert "CURTAIN (M11) is OFF, FAULT (M12) is ON: held on the path" in world.words


def test_outputs_are_safe_meanwhile():
    world, job, _ = made(GLUED)
    for line in ("M1->*", "M1=0"):
        world.say(line)
    seen = []
    world.do(lambda: world.say("M11=0"), 1.5)
    world.do(lambda: seen.append(world.say("M1")), 1.4)
    world.do(lambda: seen.append(world.say("M1")), 2.5)
    world.do(lambda: world.say("M11=1"), 3.0)
    world.order(Resume(), 3.5)
    world.do(lambda: seen.append(world.say("M1")), 4.5)
    assert world.perform(perform(world.operation, job)).well
    assert seen == [("1",), ("0",), ("1",)]


GLUED = "OUTPUT GLUE M1 OFF\n" + HEAD + "P5 SET GLUE ON\n" + SHORT


def asked_from(world, begin):
    """Return the lines that went out from the first `begin` on."""
    lines = [one.request.line for one in world.sent if isinstance(one.request, Ask)]
    return lines[lines.index(begin) :]


def test_outputs_are_safe_while_the_guard_holds():
    """The guard PLC itself sets no outputs; they are safe until the buffer is full again."""
    world, job, _ = made(GLUED)
    for line in ("M1->*", "M1=0"):
        world.say(line)
    world.do(lambda: world.say("&1H") or world.say("P8100=2"), 1.5)
    assert world.perform(perform(world.operation, job)).well
    assert "the guard PLC has held the motion" in world.words
    lines = asked_from(world, "&1H")
    before_it_goes_on = lines[: lines.index("R")]
    # once at the hold, once at rest, since the robot may have passed a SET, and then as in the program
    assert [line for line in before_it_goes_on if line.startswith("M1=")] == ["M1=0", "M1=0", "M1=1"]


def test_outputs_are_safe_while_nobody_knows_who_holds(monkeypatch):
    monkeypatch.setattr(Supervision, "changed", lambda *_args, **_options: "")
    world, job, _ = made(GLUED)
    seen = []
    for line in ("M1->*", "M1=0"):
        world.say(line)
    world.do(lambda: world.say("&1H"), 1.5)
    world.do(lambda: seen.append(world.say("M1")), 7.0)
    world.order(Resume(), 7.5)
    world.do(lambda: seen.append(world.say("M1")), 8.5)
    assert world.perform(perform(world.operation, job)).well
    assert "another client holds the motion" in world.words
    assert seen == [("0",), ("1",)]


def test_what_an_input_reads_is_a_number():
    """A reply that isn't a number ends the run, like any other invalid reply."""
    world, job, _ = made()
    plain = world.spoil

    def spoil(request, reply):
        asks = isinstance(request, Ask) and " PR " in request.line and world.operation.state is State.MOVE
        return reply.replace(b"\r", b"?\r", 5) if asks else plain(request, reply)

    world.spoil = spoil
    assert not run(world, job).well


def test_no_line_is_written_while_a_look_is_overdue():
    world, job, _ = made()
    run(world, job)
    moved = [one for one in world.sent if one.state is State.MOVE]
    looks = [one.time for one in moved if isinstance(one.request, Ask) and " M11 %" in one.request.line]
    assert np.diff(looks).max() < 0.012
    assert any(isinstance(one.request, Write) and lines_of(one.request) for one in world.sent)


@pytest.mark.parametrize(
    "change",
    [
        ("; watch M11=0 CURTAIN\n", ""),
        ("; watch M11=0 CURTAIN\n", "; watch M11=1 CURTAIN\n"),
        ("; watch M11=0 CURTAIN\n", "; watch M12=0 CURTAIN\n"),
        ("; watch M11=0 CURTAIN\n", "; watch M11=0 DOOR\n"),
        ("; watch M11=0 CURTAIN\n", "; watch M11=0 CURTAIN\n; watch M12=0 DOOR\n"),
        ("; watch M11=0 CURTAIN\n", "; watch M11=0 CURTAIN\n; watch M11=0 CURTAIN\n"),
        ("; watch M11=0 CURTAIN\n", ";watch M11=0 CURTAIN\n"),
        ("; watch M11=0 CURTAIN\n", "; watch M11=0.0 CURTAIN\n"),
        ("; watch M11=0 CURTAIN\n", "; watch M11=-0 CURTAIN\n"),
    ],
)
def test_the_certificate_refuses_a_text_that_watches_otherwise(change, industrial6):
    from programs import compiled

    program, _ = compiled(WATCHED)
    assert change[0] in program.text
    changed = program.text.replace(*change, 1)
    judged = certify(changed, program.program, industrial6, industrial6.tolerance)
    assert any(one.is_error for one in judged.diagnostics), change


def test_the_way_to_the_start_is_watched_too(industrial6):
    job, plan = prepared(WATCHED)
    far = plan.program.start + np.radians([5.0, 5.0, 5.0, 5.0, 5.0, 5.0])
    made = approach(industrial6, far, plan.program.start, None, plan.program.watches)
    assert "; watch M11=0 CURTAIN\n" in made.value.text
    assert job_of_compiled(made.value, "approach").watches == job.watches


@pytest.mark.parametrize("value", ["0.5", "2", "-1"])
def test_an_input_that_is_no_bit_holds(value):
    world, job, _ = made()
    world.do(lambda: world.say(f"M11={value}"), 1.0)
    world.order(Resume(), 2.0)
    world.do(lambda: world.say("M11=1"), 3.0)
    world.order(Resume(), 4.0)
    assert run(world, job).well
    assert f"CURTAIN (M11) is {value}: held on the path" in world.words
