"""Tests of loops on the simulator: passes, exits, orders of users during a loop, and the steps that are known
from the last pass.
"""

import time

import numpy as np
import pytest

from tests.runtime.test_decisions import numbered
from tests.runtime.test_legs import HOME, OUT, job, joints, value, world
from yarclang.coordinator.carried_out import taken
from yarclang.runtime.notices import Abort, Changed, Hold, Question, Remark, Resume, Stop
from yarclang.runtime.pmac.performance import perform
from yarclang.runtime.state import State

HEAD = ("REGISTER N 0..9", "REGISTER K -9..9 0")


@pytest.fixture
def robot(industrial6):
    return industrial6


def performed(robot, *lines, inputs=(), at=(), orders=()):
    made = world(robot)
    for name, number in inputs:
        made.machine.command(f"{name}={number}", 7)
    made.at += [(made.now + when, lambda line=line: made.machine.command(line, 7)) for when, line in at]
    made.at += [(made.now + when, lambda one=one: made.operation.orders.append(one)) for when, one in orders]
    return made, made.perform(perform(made.operation, job(robot, *HEAD, *numbered(lines))))


def remarks(made):
    return [one.text for one in made.told if isinstance(one, Remark)]


@pytest.mark.parametrize("count", [0, 1, 3])
def test_a_repeat_makes_as_many_passes_as_the_register_says_in_front_of_it(robot, count):
    made, ended = performed(
        robot,
        f"SET N = {count}",
        "REPEAT N",
        "  SET K = K + 1",
        "  SET N = 0",
        "END",
        "SET LAMP 5",
    )
    assert ended.well
    assert dict(ended.registers)["K"] == count
    assert value(made, "M2") == 5


def test_a_register_below_zero_makes_no_pass(robot):
    _, ended = performed(robot, "SET K = -4", "REPEAT K", "  SET N = N + 1", "END")
    assert ended.well
    assert dict(ended.registers)["N"] == 0


def test_a_loop_streams_its_body_in_each_pass(robot):
    made = world(robot)
    lines = ("LOOP", f"P10 {OUT}", f"P20 {HOME}", "P30 SET N = N + 1", "UNTIL N >= 3")
    since = made.now
    ended = made.perform(perform(made.operation, job(robot, *HEAD, *lines)))
    assert ended.well
    assert made.now - since > 6.0
    passes = [one for one in made.told if isinstance(one, Remark) and one.begins_pass]
    assert [one.text.partition(": ")[2] for one in passes] == ["LOOP: pass 1 is done", "LOOP: pass 2 is done"]
    assert joints(made, robot)[0] == pytest.approx(0.0, abs=1e-3)


def test_a_loop_is_left_where_the_robot_is(robot):
    made = world(robot)
    lines = (
        "LOOP", f"P10 {OUT}", "P15 SET N = N + 1", "WHEN N = 2", "P20 EXIT", "END", f"P30 {HOME}", "END",
            "P40 SET LAMP 7",
    )  # fmt: skip
    ended = made.perform(perform(made.operation, job(robot, *HEAD, *lines)))
    assert ended.well
    assert joints(made, robot)[0] == pytest.approx(20.0, abs=1e-3)
    assert value(made, "M2") == 7
    assert "P0020 EXIT: the loop is left" in remarks(made)


def test_an_exit_of_an_inner_loop_goes_on_in_the_outer_one(robot):
    _, ended = performed(
        robot,
        "WHILE N < 3",
        "  SET N = N + 1",
        "  LOOP",
        "    SET K = K + 1",
        "    WHEN K > 1",
        "P900 EXIT",
        "    END",
        "  END",
        "END",
    )
    assert ended.well
    assert dict(ended.registers) == {"N": 3, "K": 4}


def test_a_return_skips_the_rest_of_the_sub(robot):
    _, ended = performed(
        robot,
        "SUB S",
        "WHEN N > 0",
        "P900 RETURN",
        "END",
        "SET K = K + 1",
        "END",
        "P901 CALL S",
        "SET N = 1",
        "P902 CALL S",
    )
    assert ended.well
    assert dict(ended.registers) == {"N": 1, "K": 1}


@pytest.mark.parametrize("kind", ["LOOP", "WHILE K < 9", "LOOP 9", "REPEAT M"])
def test_a_return_in_loops_skips_all_that_is_left_of_the_sub(robot, kind):
    _, ended = performed(
        robot,
        "REGISTER M 0..9 9",
        "SUB S",
        "LOOP",
        kind,
        "SET K = K + 1",
        "WHEN K >= 3",
        "P900 RETURN",
        "END",
        "END",
        "SET N = 8",
        "END",
        "SET N = 9",
        "END",
        "P901 CALL S",
        "SET N = N + 1",
        "P902 CALL S",
        "SET N = N + 1",
    )
    assert ended.well
    held = dict(ended.registers)
    assert (held["N"], held["K"]) == (2, 4)  # the second call returns in its first pass


def test_a_sub_that_was_returned_from_is_gone_through_the_next_time(robot):
    _, ended = performed(
        robot,
        "SUB S",
        "LOOP 3",
        "WHEN N = 0",
        "P900 RETURN",
        "END",
        "SET K = K + 1",
        "END",
        "SET K = K + 5",
        "END",
        "LOOP 2",
        "P901 CALL S",
        "SET N = 1",
        "END",
    )
    assert ended.well
    assert dict(ended.registers)["K"] == 8


WAITS = ("WHILE DOOR OFF", "END", "SET LAMP 3")


def test_a_loop_that_moves_nothing_looks_again_and_again_and_takes_its_time(robot):
    made, ended = performed(robot, *WAITS, at=[(2.0, "M11=1")])
    assert ended.well
    assert value(made, "M2") == 3
    # Messages that are equal in each pass are reported only once.
    assert len([one for one in remarks(made) if "WHILE" in one]) == 2


@pytest.mark.parametrize("order", [Stop(), Abort()])
@pytest.mark.parametrize("lines", [WAITS, ("LOOP", "  SET N = 1 - N", "END")])
def test_a_loop_that_moves_nothing_is_stopped(robot, order, lines):
    begun = time.monotonic()
    _, ended = performed(robot, *lines, orders=[(1.0, order)])
    assert not ended.well
    assert ended.at_barrier
    assert time.monotonic() - begun < 30.0


def test_a_hold_in_a_loop_holds_where_it_begins_anew(robot):
    made = world(robot)
    lines = ("WHILE DOOR OFF", "END", f"P10 {OUT}")
    made.at.append((made.now + 1.0, lambda: made.operation.orders.append(Hold())))
    made.at.append((made.now + 2.0, lambda: made.machine.command("M11=1", 7)))
    made.at.append((made.now + 9.0, lambda: made.operation.orders.append(Resume())))
    since = made.now
    ended = made.perform(perform(made.operation, job(robot, *lines)))
    assert ended.well
    assert made.now - since > 9.0


def test_of_a_stopped_run_the_last_pass_is_known(robot):
    """In a stopped run, only the steps of the last pass are known. Each pass finds everything as the first
    pass did, so the earlier passes need not be known.
    """
    made = world(robot)
    lines = (
        "WHEN DOOR OFF",
        "  P10 SET N = 1",
        "END",
        "LOOP",
        f"  P20 {OUT}",
        "  WHEN N = 1",
        "    P30 SET N = 2",
        "  ELSE",
        "    P40 SET K = K + 1",
        "  END",
        f"  P50 {HOME}",
        "UNTIL DOOR ON",
        "P60 SET LAMP ON",
    )
    run = job(robot, *HEAD, *lines)
    made.at.append((made.now + 8.0, lambda: made.operation.orders.append(Stop())))
    ended = made.perform(perform(made.operation, run))
    assert not ended.well
    assert ended.ways[0] is True
    # The branches of completed passes aren't stored any more.
    assert ended.ways[1:] in ((), (False,))
    assert dict(ended.registers)["K"] >= 1


def test_the_steps_that_were_taken(robot):
    from programs import checked

    lines = (
        "LOOP",
        "P10 SET N = 1",
        "WHEN DOOR ON",
        "P20 EXIT",
        "END",
        "P30 SET N = 2",
        "END",
        "P40 SET N = 3",
    )
    program, _ = checked("INPUT DOOR M11\nREGISTER N 0..9\n" + "\n".join(lines) + "\n")
    names = [type(one).__name__ for one in program.steps]
    assert names == ["Loop", "Assign", "When", "Exit", "EndWhen", "Assign", "NextPass", "EndLoop",
        "Assign"]  # fmt: skip
    assert taken(program.steps, 0, 9, (True,)) == [0, 1, 2, 3, 8]
    assert taken(program.steps, 0, 9, (False,)) == [0, 1, 2, 5, 6]
    assert taken(program.steps, 0, 9, ()) == [0, 1]


def test_a_stop_in_a_later_pass_rests_on_its_path(robot):
    lines = ("LOOP", f"P900 {OUT}", "SET N = N + 1", f"P901 {HOME}", "UNTIL DOOR ON")
    made, ended = performed(robot, *lines, orders=[(7.2, Stop())])
    assert not ended.well
    assert dict(ended.registers)["N"] >= 2
    assert ended.command.startswith("P090")
    assert State.STOP in [one.state for one in made.told if isinstance(one, Changed)]
    assert np.degrees(ended.joints)[0] == pytest.approx(joints(made, robot)[0], abs=1e-2)
    # The robot is on its path, which leads along the first joint.
    assert -1e-3 <= joints(made, robot)[0] <= 20.0 + 1e-3
    assert np.abs(joints(made, robot)[1:]).max() < 1e-3


def test_a_wait_that_is_given_up_goes_the_way_of_its_else(robot):
    lines = ("WAIT DOOR ON [2] (s) ELSE", "  SET N = 1", "END", "SET LAMP 3")
    lines = tuple(f"P{k}0 {line.strip()}" if "ELSE" in line else line for k, line in enumerate(lines, 101))
    made, ended = performed(robot, *lines)
    assert ended.well
    assert dict(ended.registers)["N"] == 1
    assert ended.ways == (False,)
    assert value(made, "M2") == 3
    assert any("M11 is OFF: the lines after its ELSE are executed" in one for one in remarks(made))
    made, ended = performed(robot, *lines, at=[(1.0, "M11=1")])
    assert ended.well
    assert dict(ended.registers)["N"] == 0
    assert ended.ways == (True,)


@pytest.mark.parametrize("order", [Stop(), Abort()])
def test_a_wait_with_an_else_is_stopped(robot, order):
    made, ended = performed(robot, "P900 WAIT DOOR ON [20] (s) ELSE", "END", orders=[(1.0, order)])
    assert not ended.well
    assert made.now < 15.0
    assert ended.at_barrier


def test_a_loop_with_a_number_makes_so_many_passes(robot):
    made, ended = performed(robot, "LOOP 4", "  SET N = N + 1", "END", "LOOP 0", "  SET N = 9", "END")
    assert ended.well
    assert dict(ended.registers)["N"] == 4
    assert any("LOOP: 4 passes to go" in one for one in remarks(made))


ASKS = ('P900 HOLD "how many?" N', "SET K = N", "SET LAMP 3")


def test_a_hold_that_asks_goes_on_with_an_answer(robot):
    orders = [(1.0, Resume()), (2.0, Resume(12)), (3.0, Resume(-1)), (4.0, Resume(7)), (5.0, Resume(2))]
    made, ended = performed(robot, *ASKS, orders=orders)
    assert ended.well
    assert dict(ended.registers) == {"N": 7, "K": 7}
    assert value(made, "M2") == 3
    told = [one.text for one in made.told if isinstance(one, Remark) and one.warning]
    assert told == [
        "P0900 HOLD: no answer, but a number from 0 to 9 is needed",
        "P0900 HOLD: the answer 12, but a number from 0 to 9 is needed",
        "P0900 HOLD: the answer -1, but a number from 0 to 9 is needed",
    ]
    asked = [one.asks for one in made.told if isinstance(one, Changed) and one.asks]
    assert asked == [Question("how many?", "N", 0, 9)]
    assert [one.asks for one in made.told if isinstance(one, Changed)][-1] is None


@pytest.mark.parametrize("order", [Stop(), Abort()])
def test_a_hold_that_asks_is_stopped(robot, order):
    _, ended = performed(robot, *ASKS, orders=[(1.0, order), (2.0, Resume(3))])
    assert not ended.well
    assert dict(ended.registers)["N"] == 0


def test_an_answer_is_kept(robot):
    made = world(robot)
    made.at.append((made.now + 1.0, lambda: made.operation.orders.append(Resume(3))))
    run = job(robot, "REGISTER N 0..9 KEPT", 'P10 HOLD "how many?" N', "P20 SET LAMP 1")
    assert made.perform(perform(made.operation, run)).well
    assert made.kept == {"N": 3}


def test_flags_are_on_and_off(robot):
    lines = (
        "SET N ON",
        "WHEN N ON",
        "  SET K = 5",
        "END",
        "SET N OFF",
        "WHILE N ON",
        "  SET K = 9",
        "END",
        "SET K 7",
    )
    _, ended = performed(robot, *lines)
    assert ended.well
    assert ended.ways == (True, False)
    assert dict(ended.registers) == {"N": 0, "K": 7}
