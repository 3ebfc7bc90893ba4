"""Tests of registers, run-time conditions and CASE on the simulator: the chosen branches, and the ways in
which a run ends.
"""

import pytest
from programs import compiled

from tests.runtime.test_legs import HEAD, job, joints, value, world
from yarclang.decisions import filled
from yarclang.diagnostics import Diagnostic
from yarclang.lasting import Lasting, schedule_of
from yarclang.pipeline.parts import beginning, part
from yarclang.pipeline.stages import Request
from yarclang.runtime.notices import Abort, Remark, Resume, Stop
from yarclang.runtime.pmac.performance import perform
from yarclang.runtime.signals import WaitEnded, signal_text, state_text

COUNTED = ("REGISTER N 0..3", "INPUT JOB M70", "INPUT EMPTY M71")


def numbered(lines):
    """Return lines in which each SET without an index has got one."""
    return [
        f"P{k}0 {line.strip()}" if line.strip().startswith("SET") else line for k, line in enumerate(lines, 1)
    ]


def performed(robot, *lines, inputs=(), at=()):
    made = world(robot)
    for name in ("M70", "M71"):
        assert made.machine.command(f"{name}->*", 7).error is None
        assert made.machine.command(f"{name}=0", 7).error is None
    for name, number in inputs:
        made.machine.command(f"{name}={number}", 7)
    made.at += [(made.now + when, lambda line=line: made.machine.command(line, 7)) for when, line in at]
    return made, made.perform(perform(made.operation, job(robot, *COUNTED, *numbered(lines))))


@pytest.fixture
def robot(industrial6):
    return industrial6


CASES = (
    "CASE JOB",
    "OF 1",
    "  SET LAMP 10",
    "OF 2..5 8",
    "  SET LAMP 20",
    "ELSE",
    "  SET LAMP 30",
    "END",
)


@pytest.mark.parametrize(("number", "lamp"), [(0, 30), (1, 10), (2, 20), (5, 20), (6, 30), (8, 20), (9, 30)])
def test_a_case_takes_the_way_of_its_value(robot, number, lamp):
    made, ended = performed(robot, *CASES, inputs=[("M70", number)])
    assert ended.well
    assert value(made, "M2") == lamp


def test_a_case_reads_its_input_once(robot):
    """CASE reads its input only once. The input changes after each reading, so a second reading would lead to
    another OF or to none.
    """
    made = world(robot)
    made.machine.command("M70->*", 7)
    made.machine.command("M70=2", 7)
    asked = []
    before = made.machine.command

    def command(line, port):
        answer = before(line, port)
        if line == "M70":
            asked.append(line)
            before("M70=1", port)
        return answer

    made.machine.command = command
    ended = made.perform(perform(made.operation, job(robot, *COUNTED, *numbered(CASES))))
    assert ended.well
    assert len(asked) == 1
    assert value(made, "M2") == 20


def test_registers_count_and_decide(robot):
    made, ended = performed(
        robot,
        "SET N = JOB % 4",
        "WHEN N < 3 AND NOT EMPTY = ON",
        "  SET N = N + 1",
        "ELSE",
        "  SET LAMP 5",
        "END",
        "CASE N",
        "OF 0",
        "  SET LAMP 7",
        "OF 1..3",
        "  SET LAMP 9",
        "END",
        inputs=[("M70", 6)],
    )
    assert ended.well
    assert dict(ended.registers) == {"N": 3}
    assert ended.ways == (True, False)
    assert value(made, "M2") == 9


@pytest.mark.parametrize(
    ("line", "number", "what"),
    [
        ("SET N = N - 1", 0, "N -1, and it is an integer from 0 to 3"),
        ("SET N = JOB", 9, "N 9,"),
        ("SET N = FLOOR(3 / JOB)", 0, "3 / 0 is a division by zero"),
        ("SET N = 3 % JOB", 0, "3 % 0 is a division by zero"),
        ("SET N = JOB", 1.5, "N 1.5,"),
        ("SET N = JOB * JOB", 100000, "is beyond 1,000,000,000"),
    ],
)
def test_what_no_register_can_hold_ends_the_run_at_rest(robot, line, number, what):
    made, ended = performed(robot, "SET GLUE ON", line, "SET LAMP ON", inputs=[("M70", number)])
    assert not ended.well
    assert ended.code == "Y1630"
    assert what in ended.what
    assert ended.at_barrier
    assert ended.concerns.index == "P0020"
    assert value(made, "M2") == 0.0  # the lines after the failed one weren't executed
    assert value(made, "M1") == 0.0  # its safe value
    assert dict(ended.registers) == {"N": 0}
    told = [one.text for one in made.told if isinstance(one, Remark)]
    assert "registers: N is 0; a run that continues with --from begins with their initial values" in told


def test_the_log_tells_what_was_decided(robot):
    made, ended = performed(robot, "SET N = 2", "WHEN N = 2 OR EMPTY = ON", "SET LAMP ON", "END")
    assert ended.well
    told = [one.text for one in made.told if isinstance(one, Remark)]
    assert "registers: N is 0" in told
    assert any("SET: N is 2" in one for one in told)
    assert any("N = 2 OR EMPTY = 1 holds, N is 2, M71 is OFF" in one for one in told)


ENDS = (
    "CASE JOB",
    "OF 1",
    "  P10 MOVEJ 5 0 0 0 0 0 [1] (deg,s)",
    "  P20 STOP",
    "OF 2",
    "  P30 MOVEJ 7 0 0 0 0 0 [1] (deg,s)",
    '  P40 ABORT "no part, {2}"',
    "OF 3",
    "  WHEN EMPTY = ON",
    "    P50 STOP",
    "  ELSE",
    '    P60 ABORT "full"',
    "  END",
    "OF 4",
    "  WHEN EMPTY = ON",
    "    P70 STOP",
    "  END",
    "ELSE",
    "END",
    "P80 MOVEJ 9 0 0 0 0 0 [1] (deg,s)",
    "P90 SET LAMP 90",
)


@pytest.mark.parametrize(
    ("inputs", "well", "place", "what"),
    [
        ({"M70": 0}, True, 9.0, ""),
        ({"M70": 1}, True, 5.0, ""),
        ({"M70": 2}, False, 7.0, "P0040 ABORT ends the program: no part, {2}"),
        ({"M70": 3, "M71": 1}, True, 0.0, ""),
        ({"M70": 3}, False, 0.0, "P0060 ABORT ends the program: full"),
        ({"M70": 4, "M71": 1}, True, 0.0, ""),
        ({"M70": 4}, True, 9.0, ""),
    ],
)
def test_a_way_may_end_the_program(robot, inputs, well, place, what):
    """If a branch ends the program, the robot stands there, and nothing after the branch is executed."""
    made = world(robot)
    for name in ("M70", "M71"):
        made.machine.command(f"{name}->*", 7)
        made.machine.command(f"{name}={inputs.get(name, 0)}", 7)
    ended = made.perform(perform(made.operation, job(robot, *COUNTED, "P05 SET GLUE ON", *ENDS)))
    assert (ended.well, ended.what) == (well, what)
    assert ended.code == ("" if well else "Y1635")
    assert joints(made, robot)[0] == pytest.approx(place, abs=1e-3)
    assert ended.joints[0] * 57.29577951308232 == pytest.approx(place, abs=1e-3)
    assert value(made, "M2") == (90.0 if place == 9.0 else 0.0)
    assert value(made, "M1") == 0.0  # its safe value, in whichever branch the program has ended
    assert ended.at_barrier == (not well)
    told = [one.text for one in made.told if isinstance(one, Remark)]
    assert well == ("STOP: the program ends here" in told[-1] or place == 9.0)


def test_nobody_goes_on_after_an_abort(robot):
    """An order to resume that is waiting when the program aborts itself doesn't continue the program."""
    made = world(robot)
    for name, number in (("M70", 2), ("M71", 0)):
        made.machine.command(f"{name}->*", 7)
        made.machine.command(f"{name}={number}", 7)
    made.at += [(made.now + 0.1 * one, lambda: made.operation.orders.append(Resume())) for one in range(80)]
    ended = made.perform(perform(made.operation, job(robot, *COUNTED, *ENDS)))
    assert not ended.well
    assert joints(made, robot)[0] == pytest.approx(7.0, abs=1e-3)
    assert value(made, "M2") == 0.0


def test_the_log_tells_which_way_of_a_case_was_taken(robot):
    made, ended = performed(robot, *CASES, inputs=[("M70", 2)])
    assert ended.well
    told = [one.text for one in made.told if isinstance(one, Remark)]
    first, second = (one for one in told if " OF: " in one)
    assert first.endswith("OF: JOB is 2: its lines are skipped")
    assert second.endswith("holds, M70 is 2: its lines are executed")


@pytest.mark.parametrize("when", [0.3, 1.2, 2.6])
def test_a_stop_in_any_leg_leaves_the_registers_as_they_were_there(robot, when):
    """Stop in the first motion, in the motion of the branch, and at the WAIT after it."""
    made = world(robot)
    for name in ("M70", "M71"):
        made.machine.command(f"{name}->*", 7)
        made.machine.command(f"{name}=0", 7)
    lines = (
        "P10 MOVEJ 5 0 0 0 0 0 [1] (deg,s)",
        "P20 SET N = 1",
        "WHEN N = 1 AND NOT EMPTY = ON",
        "P30 MOVEJ 9 0 0 0 0 0 [1] (deg,s)",
        "P40 SET N = 2",
        "ELSE",
        "P50 MOVEJ 9 0 0 0 0 0 [1] (deg,s)",
        "END",
        "P60 WAIT DOOR ON [60] (s)",
        "P70 SET N = 3",
    )
    run = job(robot, *COUNTED, *lines)
    made.at.append((made.now + when + 1.0, lambda: made.operation.orders.append(Stop())))
    ended = made.perform(perform(made.operation, run))
    assert not ended.well
    reached = dict(ended.registers)["N"]
    place = joints(made, robot)[0]
    # The register has counted the motions that the robot has completed.
    assert reached == (0 if place < 5 - 1e-3 else 1 if place < 9 - 1e-3 else 2)


def test_a_new_run_begins_anew(robot):
    """A new run begins with the initial values of the registers, not with the values of the previous run."""
    made, ended = performed(robot, "SET N = 3", "SET LAMP 1")
    assert ended.well
    assert dict(ended.registers) == {"N": 3}
    again = made.perform(perform(made.operation, job(robot, *COUNTED, "P10 SET N = N + 1")))
    assert again.well
    assert dict(again.registers) == {"N": 1}


@pytest.mark.parametrize(
    "lines",
    [("P10 SET N = 1",), ('P10 SAY "a"',), ("P10 WAIT JOB = 1 OR EMPTY = ON [5] (s)",),
        ("WHEN EMPTY ON", "P10 STOP", "END"), ('P10 ABORT "a"',), ("WHEN N = 1", "P10 SET LAMP ON", "END"),
            ("CASE JOB", "OF 1", "P10 SET LAMP ON", "OF 2", "P20 SET LAMP OFF", "ELSE", "END")],
)  # fmt: skip
def test_a_program_buffer_can_not_decide(robot, lines):
    text = HEAD + "\n".join((*COUNTED, *lines)) + "\n"
    made, found = compiled(text, robot.name, target="prog")
    assert made is None
    assert [one.code for one in found if one.is_error] == ["Y1106"]


def test_a_program_can_not_be_begun_inside_a_case(robot):
    """The finding refers to the first OF of the CASE, not to the next one."""
    program, _ = compiled(HEAD + "\n".join((*COUNTED, *ENDS)) + "\n", robot.name)
    begins = beginning(program.plan, "P0030")
    assert not isinstance(begins, Diagnostic)
    (found,) = part(program.plan, Request(robot), begins[0], step=begins[1]).diagnostics
    line = next(k for k, one in enumerate(program.program.source.text.splitlines(), 1) if one == "OF 1")
    assert (found.code, found.span.line) == ("Y1164", line)
    assert "inside a CASE" in found.message


@pytest.mark.parametrize(
    ("lines", "place"),
    [
        (("WHEN EMPTY ON", "P10 MOVEJ 5 0 0 0 0 0 [1] (deg,s)", "ELSE", "P20 MOVEJ 7 0 0 0 0 0 [1] (deg,s)",
            "P30 STOP", "END"), 5.0),
        (("WHEN EMPTY ON", "P20 MOVEJ 7 0 0 0 0 0 [1] (deg,s)", "P30 STOP", "END"), 0.0),
    ],
)  # fmt: skip
def test_a_job_ends_where_the_ways_that_go_on_do(robot, lines, place):
    assert job(robot, *COUNTED, *lines).end[0] * 57.29577951308232 == pytest.approx(place, abs=1e-5)


def test_ways_that_end_the_program_take_their_own_time():
    parts = [1.0, "when", 5.0, "finish", "else", 0.5, "when", "finish", "end", "end", 2.0]
    schedule = schedule_of(parts)
    assert (schedule.lasting.least, schedule.lasting.most) == (1.5, 6.0)
    assert schedule.clocks[-1] == 3.5  # a run that reaches the end has taken the second branch
    assert schedule_of([1.0, "when", 5.0, "finish", "else", 3.0, "finish", "end"]).lasting == Lasting(
        4.0, 6.0
    )


UNTIL = ("P10 SET N = 3", "P20 WAIT EMPTY = ON AND (JOB > 2 OR N = 1) [2] (s)", "P30 SET LAMP 30")


@pytest.mark.parametrize(
    ("at", "well", "after"),
    [
        ((), False, 2.0),
        (((0.5, "M71=1"),), False, 2.0),
        (((0.5, "M70=3"),), False, 2.0),
        (((0.5, "M70=3"), (1.0, "M71=1")), True, 1.0),
        # a condition that was fulfilled for a moment doesn't count
        (((0.5, "M70=3"), (0.8, "M70=0"), (1.0, "M71=1")), False, 2.0),
    ],
)
def test_a_wait_goes_on_when_its_condition_holds(robot, at, well, after):
    made, ended = performed(robot, *UNTIL, at=at)
    assert ended.well == well
    assert value(made, "M2") == (30.0 if well else 0.0)
    (end,) = (one for one in made.told if isinstance(one, WaitEnded))
    assert end.met == well
    assert end.waited == pytest.approx(after, abs=0.1)
    assert signal_text(end).startswith("P0020 WAIT: EMPTY = 1 AND (JOB > 2 OR N = 1) ")
    if not well:
        assert ended.code == "Y1604"
        assert ended.concerns.index == "P0020"
        state = {line.partition("=")[0]: float(line.partition("=")[2]) for _, line in at}
        said = (
            f"N is 3, M71 is {state_text(state.get('M71', 0.0))}, M70 is {state_text(state.get('M70', 0.0))}"
        )
        assert ended.what.endswith(said)


def test_a_wait_whose_condition_holds_already_takes_no_time(robot):
    made, ended = performed(robot, *UNTIL, inputs=[("M70", 3), ("M71", 1)])
    assert ended.well
    (end,) = (one for one in made.told if isinstance(one, WaitEnded))
    assert end.waited < 0.1


@pytest.mark.parametrize("order", [Stop(), Abort()])
def test_somebody_ends_a_wait_for_a_condition(robot, order):
    made = world(robot)
    for name in ("M70", "M71"):
        made.machine.command(f"{name}->*", 7)
        made.machine.command(f"{name}=0", 7)
    made.at.append((made.now + 0.7, lambda: made.operation.orders.append(order)))
    ended = made.perform(perform(made.operation, job(robot, *COUNTED, *UNTIL)))
    assert not ended.well
    assert made.now < 2.0
    assert ended.at_barrier
    assert value(made, "M2") == 0.0


def test_a_wait_that_cannot_be_computed_ends_the_run(robot):
    made, ended = performed(robot, "P10 WAIT FLOOR(4 / JOB) > 2 [2] (s)", "P20 SET LAMP 20")
    assert (ended.well, ended.code) == (False, "Y1630")
    assert "4 / 0 is a division by zero" in ended.what
    assert value(made, "M2") == 0.0


def test_one_input_and_one_value_is_the_wait_that_there_was(robot):
    """`WAIT JOB = 3` and `WAIT JOB 3` give the same controller text. A program buffer supports both."""
    texts = [
        compiled(HEAD + f"INPUT JOB M70\nP10 {line}\n", robot.name, target=target)[0].text
        for line in ("WAIT JOB = 3 [2] (s)", "WAIT JOB 3 [2] (s)")
        for target in ("rotary", "prog")
    ]
    kept = ["\n".join(one for one in text.splitlines() if "sha256" not in one) for text in texts]
    assert kept[0] == kept[2]
    assert kept[1] == kept[3]


def test_the_operator_is_told_and_the_program_goes_on(robot):
    made, ended = performed(
        robot, "SET N = 2", 'P20 SAY "box {n} of {N}"', "SET N = 3", 'P40 SAY "box { N }"', "SET LAMP 7"
    )
    assert ended.well
    told = [one.text for one in made.told if isinstance(one, Remark) and "SAY" in one.text]
    assert told == ["P0020 SAY: box 2 of 2", "P0040 SAY: box 3"]
    assert value(made, "M2") == 7.0
    assert made.now < 2.0


def test_a_text_with_braces_around_no_register_is_told_as_it_stands():
    """Braces that contain no register remain unchanged. A text that was verified without its program may
    contain them.
    """
    assert filled("a {B} {} {{N}} {N", {"N": 4}) == "a {B} {} {4} {N"
