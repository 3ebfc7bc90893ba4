"""Registers, run-time conditions and CASE: what is decided on the simulator, and what ends a run."""

import pytest

from tests.runtime.test_legs import job, value, world
from yarclang.runtime.notices import Remark
from yarclang.runtime.pmac.performance import perform

COUNTED = ("REGISTER N 0..3", "INPUT JOB M70", "INPUT EMPTY M71")


def numbered(lines):
    """Lines with an index before each SET that has none."""
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
    """The input changes at each question: with a second look at it, no OF or another one would be taken."""
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
    assert value(made, "M2") == 0.0  # nothing after it was done
    assert value(made, "M1") == 0.0  # the safe value
    assert dict(ended.registers) == {"N": 0}


def test_the_log_tells_what_was_decided(robot):
    made, ended = performed(robot, "SET N = 2", "WHEN N = 2 OR EMPTY = ON", "SET LAMP ON", "END")
    assert ended.well
    told = [one.text for one in made.told if isinstance(one, Remark)]
    assert "registers: N is 0" in told
    assert any("SET: N is 2" in one for one in told)
    assert any("N = 2 OR EMPTY = 1 holds, N is 2, M71 is OFF" in one for one in told)
