"""Tests of groups of bits, which are several inputs or outputs read and set as one number, on
the simulator.
"""

import pytest

from tests.runtime.test_decisions import numbered
from tests.runtime.test_legs import job, joints, value, world
from yarclang.runtime.notices import Hold, Resume, Stop
from yarclang.runtime.pmac.performance import perform

BITS = ("M70", "M71", "M72")
DECLARED = ("REGISTER N 0..7", "INPUT JOB M70..M72")
CASES = ("CASE JOB", "OF 1", "  SET LAMP 10", "OF 2..5", "  SET LAMP 20", "OF 0 6 7", "  SET LAMP 30", "END")


@pytest.fixture
def robot(industrial6):
    return industrial6


def set_bits(made, number):
    for place, bit in enumerate(BITS):
        made.machine.command(f"{bit}={number >> place & 1}", 7)


def standing(robot, number):
    made = world(robot)
    for bit in BITS:
        assert made.machine.command(f"{bit}->*", 7).error is None
    set_bits(made, number)
    return made


def performed(made, robot, *lines):
    return made.perform(perform(made.operation, job(robot, *DECLARED, *numbered(lines))))


def asked_of(made, each):
    """Let `each` be called after each reading of the group, with the number of readings so far."""
    before, looks = made.machine.command, []

    def command(line, port):
        answer = before(line, port)
        if line == "".join(BITS):
            looks.append(line)
            each(len(looks))
        return answer

    made.machine.command = command
    return looks


@pytest.mark.parametrize(("number", "lamp"), [(0, 30), (1, 10), (2, 20), (4, 20), (5, 20), (6, 30), (7, 30)])
def test_the_first_variable_is_the_lowest_bit_and_all_values_need_no_else(robot, number, lamp):
    made = standing(robot, number)
    looks = asked_of(made, lambda _: None)
    assert performed(made, robot, *CASES, "SET N = JOB").registers == (("N", number),)
    assert value(made, "M2") == lamp
    assert len(looks) == 4  # two readings for the whole CASE, two for the SET


def test_a_torn_number_is_never_taken(robot):
    """A number that is read while the PLC changes it isn't used. Here the PLC changes 1 to 6, and the first
    reading gives 7.
    """
    made = standing(robot, 7)
    asked_of(made, lambda looks: set_bits(made, 6) if looks == 1 else None)
    ended = performed(made, robot, "SET N = JOB")
    assert ended.registers == (("N", 6),)


def test_a_group_that_never_holds_still_ends_the_run(robot):
    made = standing(robot, 0)
    asked_of(made, lambda looks: set_bits(made, looks % 8))
    ended = performed(made, robot, "SET GLUE ON", "SET N = JOB", "SET LAMP ON")
    assert (ended.well, ended.code) == (False, "Y1651")
    assert value(made, "M1") == 0.0
    assert value(made, "M2") == 0.0


def test_a_bit_that_reads_a_word_ends_the_run(robot):
    made = standing(robot, 1)
    made.machine.command("M71=5", 7)
    ended = performed(made, robot, *CASES)
    assert (ended.well, ended.code) == (False, "Y1650")
    assert "M71 of the group M70..M72 reads 5" in ended.what
    assert value(made, "M2") == 0.0


def test_inputs_that_change_within_a_case_change_nothing(robot):
    """CASE uses the number that it has read, even if the input changes afterwards."""
    made = standing(robot, 2)
    looks = asked_of(made, lambda count: set_bits(made, 1) if count == 2 else None)
    ended = performed(made, robot, *CASES, "CASE JOB", "OF 1", "  SET N = 5", "ELSE", "  SET N = 3", "END")
    assert ended.well
    assert value(made, "M2") == 20
    assert ended.registers == (("N", 5),)  # the second CASE has read the input again
    assert len(looks) == 4


@pytest.mark.parametrize("number", range(8))
def test_a_group_of_outputs_is_set_bit_by_bit(robot, number):
    made = standing(robot, 0)
    for bit in ("M80", "M81", "M82"):
        assert made.machine.command(f"{bit}->*", 7).error is None
        made.machine.command(f"{bit}=1", 7)
    lines = ("OUTPUT GO M80..M82", f"P10 SET GO {number}", "P20 WAIT [0.1] (s)")
    ended = made.perform(perform(made.operation, job(robot, *lines)))
    assert ended.well
    assert [value(made, f"M8{place}") for place in range(3)] == [number >> place & 1 for place in range(3)]


def test_a_group_has_its_safe_number_after_a_fault(robot):
    made = standing(robot, 0)
    for bit in ("M80", "M81", "M82"):
        made.machine.command(f"{bit}->*", 7)
    lines = (*DECLARED, "OUTPUT GO M80..M82 5", "P10 SET GO 2", "P20 SET N = JOB - 1")
    ended = made.perform(perform(made.operation, job(robot, *lines)))
    assert ended.code == "Y1630"
    assert [value(made, f"M8{place}") for place in range(3)] == [1, 0, 1]


WAY = ("  P91 MOVEJ 10 0 0 0 0 0 [3] (deg,s)", "  P92 MOVEJ HOME [3] (s)")
MOVING = (
    "CASE JOB",
    "OF 1",
    "  SET LAMP 10",
    "OF 2..5",
    *WAY,
    "  SET LAMP 20",
    "ELSE",
    "  SET LAMP 30",
    "END",
)


def test_a_hold_within_a_case_goes_on_in_the_way_that_was_read(robot):
    """The number changes while the robot is held in a branch of the CASE. The run continues in
    this branch.
    """
    made = standing(robot, 2)
    made.order(Hold(), 2.0)
    made.do(lambda: set_bits(made, 1), 4.0)
    made.order(Resume(), 6.0)
    since = made.now
    ended = performed(made, robot, *MOVING)
    assert ended.well
    assert ended.ways == (False, True)
    assert value(made, "M2") == 20
    assert made.now - since > 9.0  # the run was held


@pytest.mark.parametrize("order", [Hold(), Stop()])
def test_who_holds_or_stops_between_two_looks_sees_no_motion_of_a_way(robot, order):
    made = standing(robot, 2)
    asked_of(made, lambda count: made.operation.orders.append(order) if count == 1 else None)
    ended = performed(made, robot, *MOVING, "SET LAMP 40")
    assert not ended.well
    assert value(made, "M2") == 0.0
    assert abs(joints(made, robot)).max() < 1e-3


@pytest.mark.parametrize("number", [0, 1, 5, 7])
@pytest.mark.parametrize("form", ["SET OUT N", "SET OUT = N"])
def test_a_group_of_outputs_gets_what_a_register_holds(robot, number, form):
    made = standing(robot, number)
    lines = ("OUTPUT OUT M80..M82", "SET N = JOB", form)
    for bit in ("M80", "M81", "M82"):
        assert made.machine.command(f"{bit}->*", 7).error is None
    assert performed(made, robot, *lines).well
    assert [value(made, bit) for bit in ("M80", "M81", "M82")] == [number >> place & 1 for place in range(3)]


def test_an_output_gets_a_computed_number(robot):
    made = standing(robot, 3)
    assert performed(made, robot, "SET N = JOB", "SET LAMP = JOB * 100 + N - 1").well
    assert value(made, "M2") == 302.0


def test_what_a_group_cannot_hold_ends_the_run(robot):
    made = standing(robot, 7)
    for bit in ("M80", "M81"):
        assert made.machine.command(f"{bit}->*", 7).error is None
        made.machine.command(f"{bit}=0", 7)
    ended = performed(made, robot, "OUTPUT OUT M80..M81", "SET N = JOB", "SET OUT = N", "SET LAMP 9")
    assert ended.code == "Y1630"
    assert "would make OUT 7, and its 2 bits hold only integers from 0 to 3" in ended.what
    assert value(made, "M80") == value(made, "M81") == 0
