"""Programs that yarcc writes, on commissioned machines, and other contents of programs."""

import re
from itertools import pairwise

import numpy as np
import pytest
from simulator.machines import (
    EXAMPLES,
    bare,
    error,
    example,
    feed,
    lines_of,
    program,
    robot_machine,
    say,
)

from yarclang.pmac.variables import ARMED
from yarclang.robot.actuation import from_counts, to_counts
from yarclang.simulator.commissioning import stand


def at_start(name, target, off=0.0, **request):
    robot, machine = robot_machine(name)
    value = example(name, target, **request)
    stand(machine, robot, value.plan.program.start + off)
    return robot, machine, value


def joints(robot, machine):
    """Return the joint positions of PLC 0 in SI units."""
    names = robot.controller.feedback
    return np.array([float(say(machine, name)[0]) for name in names]) * robot.axis_units


def ends_as_planned(robot, machine, plan):
    end = plan.sample(np.array([plan.duration]))[0][0]
    assert np.abs(machine.positions() - to_counts(robot, end)).max() < 1.0
    assert np.abs(joints(robot, machine) - end).max() < 1e-6


def rounding(value):
    """Return the rounding of a joint by the text's decimals [rad or m], half of the last decimal."""
    decimals = max(map(len, re.findall(r"[A-CU-Z]-?\d+\.(\d+)", value.text.split("SPLINE1")[1])))
    return np.deg2rad(0.51 * 10.0**-decimals)


def deviation(robot, machine, plan, begin):
    """Return the largest distance of the trace from the plan [rad or m]."""
    times = np.linspace(0.0, plan.duration, 4001)
    got = from_counts(robot, machine.positions(begin + times))
    return np.abs(got - plan.sample(times)[0]).max()


@pytest.mark.parametrize("name", EXAMPLES)
def test_prog_runs_as_planned(name):
    robot, machine, value = at_start(name, "prog")
    say(machine, *lines_of(value.text), "B1R")
    begin = machine.now
    machine.advance(value.plan.duration - 1e-6)
    assert machine.systems[1].busy
    machine.advance(2e-6)
    assert not machine.systems[1].busy
    ends_as_planned(robot, machine, value.plan)
    assert deviation(robot, machine, value.plan, begin) < rounding(value)
    assert machine.unknown_words == {}


@pytest.mark.parametrize("name", EXAMPLES)
def test_rotary_runs_as_planned(name):
    robot, machine, value = at_start(name, "rotary")
    lines = lines_of(value.text)
    assert feed(machine, lines) == len(lines)
    machine.advance(60)
    ends_as_planned(robot, machine, value.plan)
    # the program begins after RAPID and DWELL0, where the commanded position leaves the start
    times = machine.record._times[robot.controller.motors[0]]
    tm = value.plan.motions[0].curve.segment
    begin = next(a for a, b in pairwise(times[1:]) if b - a == pytest.approx(tm, abs=1e-9))
    assert deviation(robot, machine, value.plan, begin) < rounding(value)
    assert say(machine, ARMED) == ("0",)


def test_listing4_takes_40_seconds():
    assert example("INDUSTRIAL6", "prog").plan.duration == pytest.approx(40.0, abs=1e-9)


def test_prog_off_its_start_does_not_move():
    robot, machine, value = at_start("INDUSTRIAL6", "prog", off=np.deg2rad(30))
    before = machine.positions()
    say(machine, *lines_of(value.text), "B1R")
    machine.advance(5)
    assert machine.messages() == tuple(f"YARC: MOTOR {n} IS NOT AT THE START" for n in range(1, 7))
    assert machine.positions() == pytest.approx(before)
    assert not machine.systems[1].busy
    say(machine, "R")
    machine.advance(5)
    assert len(machine.messages()) == 6
    for motor, counts in zip(range(1, 7), to_counts(robot, value.plan.program.start), strict=True):
        say(machine, f"#{motor}J={counts:.3f}")
    machine.advance(30)
    say(machine, "R")
    asked = begin = machine.now
    machine.advance(value.plan.duration + 0.01)
    assert machine.messages() == ()
    ends_as_planned(robot, machine, value.plan)
    # after the second pass of the loop, the calculation continues at the next real-time interrupt
    begin = next(time for time in machine.record._times[1] if time > begin)
    assert begin - asked < machine.interrupt + 1e-9
    assert deviation(robot, machine, value.plan, begin) < rounding(value)


def test_rotary_off_its_start_goes_there_slowly():
    robot, machine, value = at_start("INDUSTRIAL6", "rotary", off=np.deg2rad(30))
    lines = lines_of(value.text)
    feed(machine, lines)
    machine.advance(60)
    ends_as_planned(robot, machine, value.plan)
    times = np.linspace(0, 30, 3001)
    start = to_counts(robot, value.plan.program.start)
    for row, motor in enumerate(robot.controller.motors):
        away = np.abs(machine.record.positions(motor, times) - start[row]) > 1.0
        rapid = times[: int(np.argmin(away))] if not away.all() else times
        speed = np.abs(machine.record.velocities(motor, rapid)).max()
        limit = float(say(machine, f"I{motor}22")[0]) * 1e3
        assert 0.3 * limit < speed <= limit * (1 + 1e-9)


def test_guard_holds_on_the_path_when_the_host_is_silent():
    robot, machine, value = at_start("INDUSTRIAL6", "rotary")
    lines = lines_of(value.text)
    taken = feed(machine, lines, until=5.0)
    assert taken < len(lines)
    silent = machine.now
    machine.advance(20)
    assert say(machine, ARMED) == ("2",)
    held = machine.positions()
    assert machine.systems[1].drive.held_at is not None
    # the robot is on the path, between two samples of the plan
    q = from_counts(robot, held)
    plan = value.plan
    times = np.linspace(0, plan.duration, 200001)
    assert np.abs(plan.sample(times)[0] - q).max(axis=1).min() < 1e-5
    # the robot is at rest within the hold time and the reserve of the guard's PLC
    ends = max(t for t in machine.record._times[1])
    motors = machine.record.velocities(1, np.linspace(silent, ends, 1000))
    assert motors[-1] == 0
    changes = [t for t in machine.record._times[1] if t > silent]
    assert changes[-1] - changes[-2] <= robot.controller.hold_time + 1e-3
    # after a refill, the program continues
    say(machine, "CLOSE ALL", "OPEN ROT")
    at = taken
    while at < len(lines) and machine.command(lines[at]).error is None:
        at += 1
    say(machine, "R")
    machine.advance(0.5)
    feed(machine, lines[at:])
    machine.advance(60)
    ends_as_planned(robot, machine, value.plan)


def test_forty_seconds_at_tm_5_in_virtual_time():
    robot, machine, value = at_start("INDUSTRIAL6", "prog", tm=5.0)
    say(machine, *lines_of(value.text), "B1R")
    machine.advance(40.01)
    ends_as_planned(robot, machine, value.plan)


def run(*lines, before=(), seconds=5.0):
    machine = bare("1000X", "1000Y")
    program(machine, *lines)
    say(machine, *before, "B1R")
    machine.advance(seconds)
    return machine


@pytest.mark.parametrize(
    ("lines", "p1"),
    [
        (["IF(P2=0)", "P1=1", "ELSE", "P1=2", "ENDIF"], 1),
        (["IF(P2=1)", "P1=1", "ELSE", "P1=2", "ENDIF"], 2),
        (["IF(P2=1)P1=1", "ELSE P1=2"], 2),
        (["IF(P2=0)P1=1", "ELSE P1=2"], 1),
        (["IF(P2=0)", "IF(P2=1)P1=1", "ELSE", "P1=2", "ENDIF"], 0),
        (["IF(P2=0)", "IF(P2=1)P1=1", "ELSE P1=3", "ENDIF"], 3),
        (["IF(P2=0)P1=1 ENDIF", "P1=P1+1"], 2),
        (["IF(P2=0 AND P3=1)P1=1", "IF(P2=0 OR P3=1)P1=P1+5"], 5),
        (["IF((P2=0)AND(P3=0))P1=1"], 1),
        (["IF(P2=1)P1=1", "P3=4"], 0),
        (["WHILE(P1<10)", "P1=P1+1", "ENDWHILE"], 10),
        (["WHILE(P1<10)P1=P1+1"], 10),
        (["WHILE(P1<3)", "WHILE(P2<5)", "P2=P2+1", "ENDWHILE", "P1=P1+1", "ENDWHILE"], 3),
        (["GOTO 20", "P1=1", "N20", "P1=P1+2"], 2),
        (["GOSUB 20", "P1=P1+10", "STOP", "N20", "P1=P1+2", "RETURN"], 12),
        (["CALL 7", "P1=P1+10"], 11),
        (["CALL 7.005", "P1=P1+10"], 110),
        (["P2=3", "P(P2+1)=8", "P1=P4"], 8),
        (["M5=3 M6=M5*2 P1=M6"], 6),
        (["I5111=100", "WHILE(I5111>0)WAIT", "P1=1"], 1),
        (["RETURN", "P1=1"], 0),
        (["STOP", "P1=1"], 0),
    ],
)
def test_flow(lines, p1):
    machine = bare("1000X")
    program(machine, "P1=P1+1", "RETURN", "N500", "P1=P1+100", number=7)
    program(machine, *lines)
    say(machine, "B1R")
    machine.advance(5)
    assert say(machine, "P1") == (str(p1),)
    assert not machine.systems[1].busy


def test_stop_and_r_goes_on():
    machine = run("P1=1", "STOP", "P1=2", "STOP", "P1=3")
    for value in ("1", "2", "3", "1"):
        assert say(machine, "P1") == (value,)
        say(machine, "R")
        machine.advance(1)


def test_wait_for_an_input():
    machine = run("DWELL0", "WHILE(M11=0)WAIT", "P1=1", before=("M11->Y:$78400,0",))
    assert machine.systems[1].running
    assert say(machine, "P1") == ("0",)
    say(machine, "M11=1")
    machine.advance(0.01)
    assert say(machine, "P1") == ("1",)


def test_endless_loops_do_not_hang():
    machine = run("WHILE(1=1)", "P1=P1+1", "ENDWHILE", seconds=1.0)
    assert 300 < float(say(machine, "P1")[0]) < 3000
    assert error(machine, "A") is None
    machine = run("N1 GOTO 1", seconds=1.0)
    assert machine.systems[1].running
    machine = run("WHILE(1=1)", "RAPID X0", "ENDWHILE", seconds=1.0)
    assert machine.systems[1].running
    machine = run("N1", "GOSUB1", seconds=1.0)
    assert machine.systems[1].ahead.run_time_error


def test_send_and_cmd():
    machine = run('SEND"Hello, World"', 'CMD"#2J=500"', 'CMD"P5=3 FOO"', "X1")
    assert machine.messages() == ("Hello, World",)
    assert machine.messages() == ()
    assert say(machine, "P5") == ("3",)


def test_unknown_words_are_reported():
    machine = run("CC1 NORMAL K-1 TSEL1 ADIS(5) S100 CIRCLE1 X1Y1 I5 J2", 'DISPLAY"x"', "LINEAR X2")
    assert set(machine.unknown_words) == {"CC", "NORMAL", "TSEL", "ADIS", "S", "CIRCLE1", "DISPLAY"}
    assert machine.positions()[0] == pytest.approx(2000)


@pytest.mark.parametrize(
    "line",
    [
        "X(P(P1))",
        "P2=P(P1)",
        "IF(P(P1)=0)X1",
        "DWELL(P(P1))",
        "M1==P(P1)",
        "CALL(P(P1))",
        "PSET X(P(P1))",
        "P(P(P1))=1",
    ],
)
@pytest.mark.parametrize("before", [(), ("X1", "X2", "X3")], ids=["at once", "later"])
def test_a_variable_that_does_not_exist_ends_the_program(line, before):
    machine = bare("1000X")
    program(machine, "LINEAR TA10TS0 TM100", *before, "P1=9000", line, "X5")
    say(machine, "B1R")
    machine.advance(5)
    assert machine.systems[1].ahead.run_time_error
    assert not machine.systems[1].busy
    assert machine.positions()[0] == pytest.approx(1000 * len(before))


def test_codes_call_their_programs():
    machine = bare("1000X")
    program(machine, "N1000", "P1=5", "RETURN", number=1000)
    program(machine, "N3000", "P2=6", "RETURN", number=1001)
    program(machine, "G1 M3")
    say(machine, "B1R")
    machine.advance(1)
    assert say(machine, "P1P2") == ("5", "6")


def plc(machine, number, *lines):
    say(machine, f"OPEN PLC {number} CLEAR", *lines, "CLOSE", f"ENABLE PLC {number}")


def test_background_plc_scans():
    machine = bare()
    plc(machine, 3, "P1=P1+1")
    machine.advance(1)
    assert say(machine, "P1") == ("0",)
    say(machine, "I5=2")
    machine.advance(1)
    assert 100 < float(say(machine, "P1")[0]) < 500
    say(machine, "DISABLE PLC3", "P1=0")
    machine.advance(1)
    assert say(machine, "P1") == ("0",)


def test_plc_0_counts_interrupts():
    machine = bare()
    plc(machine, 0, "P1=P1+1")
    say(machine, "I5=1")
    machine.advance(1)
    assert float(say(machine, "P1")[0]) == pytest.approx(1 / machine.interrupt, abs=2)


def test_plc_loops_take_a_scan_a_turn():
    machine = bare()
    plc(machine, 1, "P2=0", "WHILE(P2<3)", "P2=P2+1", "ENDWHILE", "P1=P1+1", "DISABLE PLC 1")
    say(machine, "I5=3")
    machine.advance(1)
    assert say(machine, "P1P2") == ("1", "3")


def test_plc_takes_no_moves():
    machine = bare()
    say(machine, "OPEN PLC 1")
    assert error(machine, "X1") == 3
    say(machine, "IF(P1=0)", "AND(P2=0)", "P3=1", "ENDIF", "CLOSE", "I5=2", "ENABLE PLC 1")
    machine.advance(0.1)
    assert say(machine, "P3") == ("1",)


def test_plc_addresses_a_motor_and_a_coordinate_system():
    machine = bare()
    plc(machine, 1, "ADDRESS#2&3", 'CMD"J+"', "Q1=7", 'CMD"P1=Q1"', "DISABLE PLC 1")
    say(machine, "I5=2")
    machine.advance(0.1)
    assert [machine.motors[n].jogging for n in (1, 2)] == [False, True]
    assert say(machine, "P1&1Q1&3Q1") == ("7", "0", "7")


@pytest.mark.parametrize("address", ["&17", "&0", "#33", "#0"])
def test_plc_addresses_what_there_is(address):
    machine = bare()
    say(machine, "OPEN PLC 1 CLEAR")
    assert error(machine, f"ADDRESS{address}") == 3


def test_cmd_sends_control_characters():
    """A program stops motors by CMD^A; texts that aren't control characters have no effect."""
    machine = bare("X")
    for word in ('CMD"^"', 'CMD"^AB"', "CMD^A", 'CMD"^A"'):
        say(machine, "I122=10 I120=0 I121=0 #1J+")
        machine.advance(1)
        program(machine, word)
        plc(machine, 1, word, "DISABLE PLC 1")
        say(machine, "I5=2")
        machine.advance(1)
        assert machine.motors[1].jogging == (word in ('CMD"^"', 'CMD"^AB"'))
    machine = bare("1000X")
    program(machine, "LINEAR TA10TS0 TM1000", "X1", "X2", "CMD^A", "X3")
    say(machine, "B1R")
    machine.advance(5)
    assert machine.positions()[0] < 2000


@pytest.mark.parametrize("order", ["$$$", "$$$***", "CLOSE ALL"])
def test_cmd_resets(order):
    """After a reset by CMD, commands queued after it are lost, with all running programs."""
    machine = bare()
    plc(machine, 1, f'CMD"{order}"', 'CMD"P1=5"', "DISABLE PLC 1")
    say(machine, "I5=2")
    machine.advance(0.1)
    assert say(machine, "P1") == ("5" if order == "CLOSE ALL" else "0",)


def test_a_program_is_listed_as_it_was_written():
    machine = bare()
    program(machine, "linear  tm 50 ; a comment", "X(P1*2) Y-.5")
    assert say(machine, "LIST PROG 1") == ("LINEARTM50", "X(P1*2)Y-.5", "RETURN")
    assert say(machine, "LIST PROG 1,1") == ("X(P1*2)Y-.5", "RETURN")


def test_an_hour_keeps_memory():
    machine = bare("1000X", record=False)
    program(machine, "SPLINE1 TM100", "WHILE(1=1)", "X1", "X2", "X1", "X0", "ENDWHILE")
    say(machine, "B1R")
    machine.advance(3600)
    assert machine.systems[1].busy
    assert len(machine.systems[1].ahead.steps) < 5
