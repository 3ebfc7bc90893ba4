"""Tests of unrolling REPEAT, IF and CALL: the commands, their order and their places."""

import re
import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from programs import checked, codes, planned

from yarclang.diagnostics import grouped
from yarclang.pipeline.checking import check_text
from yarclang.pipeline.inputs import Options
from yarclang.semantics.control import counting, repeats
from yarclang.source import SourceFile

DEFAULT = "DEFAULT {TCP} [5] (mm,deg,s) {B}\n"


def steps(program):
    checked_program, found = checked(DEFAULT + program)
    assert codes(found) == []
    return checked_program.steps


def first_joints(program):
    return [round(float(np.degrees(step.goal.q[0])), 9) for step in steps(program)]


@given(st.integers(0, 5), st.integers(0, 5))
def test_nested_loops_count_from_zero(rows, columns):
    program = (
        f"LET N = {rows}\n"
        "REPEAT I $N\n"
        f"REPEAT J {columns}\n"
        "P0010 MOVEJ $(10*I+J) 0 0 0 0 0\n"
        "END\n"
        "END\n"
        "P0020 STOP"
    )
    *moves, _ = steps(program)
    expected = [(i, j) for i in range(rows) for j in range(columns)]
    assert [step.origin.place for step in moves] == [f"P0010(I={i},J={j})" for i, j in expected]
    assert np.allclose([np.degrees(step.goal.q[0]) for step in moves], [10 * i + j for i, j in expected])


@pytest.mark.parametrize(
    ("program", "expected"),
    [
        ("REPEAT 3\nP0010 MOVEJ 1 0 0 0 0 0\nEND", [1, 1, 1]),
        ("REPEAT $(3*0.1*10)\nP0010 MOVEJ 1 0 0 0 0 0\nEND", [1, 1, 1]),
        (("REPEAT I 4\n"
            "IF I % 2 = 0\n"
            "P0010 MOVEJ $I 0 0 0 0 0\n"
            "ELSE\n"
            "P0020 MOVEJ $(-I) 0 0 0 0 0\n"
            "END\n"
            "END"), [0, -1, 2, -3]),
        ("IF 0\nP0010 MOVEJ 1 0 0 0 0 0\nEND\nP0020 MOVEJ 2 0 0 0 0 0", [2]),
        ("IF 2 (cm) > 19 (mm)\nP0010 MOVEJ 1 0 0 0 0 0\nEND", [1]),
        (("SUB S A (deg)\n"
            "P0010 MOVEJ $A 0 0 0 0 0\n"
            "END\n"
            "P0020 CALL S 2\n"
            "P0030 CALL S 0.1 (rad)"), [2, round(np.degrees(0.1), 9)]),
        (("SUB S A (m)\n"
            "P0010 MOVEJ $(A / 1 (m)) 0 0 0 0 0\n"
            "END\n"
            "P0020 CALL S 2000 (mm)\n"
            "P0030 CALL S 3"), [2, 3]),
        ("LET W = 5\nSUB S A\nP0010 MOVEJ $(A+W) 0 0 0 0 0\nEND\nP0020 CALL S $(W*2)", [15]),
        ("SUB S P\nP0010 MOVEJ P\nEND\nJOINTS LOW 7 0 0 0 0 0\nP0020 CALL S LOW", None),
    ],
)  # fmt: skip
def test_what_comes_of_it(program, expected):
    if expected is None:
        program, expected = program.replace(" P\n", " Q\n"), [7]
    assert first_joints(program) == pytest.approx(expected)


def test_places_from_outside_in():
    program = (
        "SUB INNER\nP0005 MOVEJ 1 0 0 0 0 0\nEND\nSUB OUTER\nREPEAT J 2\nP0010 CALL INNER\nEND\nEND\n"
        "REPEAT I 2\nP0020 CALL OUTER\nEND\nP0030 CALL INNER\nP0040 MOVEJ 1 0 0 0 0 0"
    )
    assert [step.origin.label for step in steps(program)] == [
        *(f"P0020(I={i})>P0010(J={j})>P0005" for i in (0, 1) for j in (0, 1)),
        "P0030>P0005",
        "P0040",
    ]


def test_frames_inputs_and_outputs_are_arguments():
    program = (
        "INPUT DOOR M11\nOUTPUT GLUE M1 OFF\nFRAME {TABLE} 100 0 0 0 0 0\n"
        "SUB S {AT} EYE GUN\nP0010 WAIT EYE ON [2]\nP0020 SET GUN ON\nP0030 MOVEL 1 0 0 0 0 0 {AT}\nEND\n"
        "P0040 CALL S {TABLE} DOOR GLUE"
    )
    wait, put, move = steps(program)
    assert (wait.input.variable, wait.timeout, put.output.variable) == ("M11", 2.0, "M1")
    assert move.goal.base_from_moving[0, 3] == pytest.approx(0.101)


@pytest.mark.parametrize(
    ("call", "part"),
    [
        ("CALL S", "takes 2 arguments ({AT} D (mm)), 0 given"),
        ("CALL S {B} 1 2", "3 given"),
        ("CALL S 1 2", "the parameter {AT} is a frame"),
        ("CALL S {B} {B}", "D isn't a frame"),
        ("CALL S {B} 1 (s)", "D: 1 s is a time"),
        ("CALL S {B} HOME", "not a joint position"),
        ("CALL S {B} NOTHING", "no name NOTHING is declared"),
        ("CALL S {B} 0,5", "can't be an argument"),
    ],
)
def test_wrong_arguments(call, part):
    program = f"{DEFAULT}SUB S {{AT}} D (mm)\nP0005 MOVEL 0 0 $D 0 0 0 {{AT}}\nEND\nP0010 {call}"
    (found,) = checked(program)[1]
    assert found.code == "Y0411"
    assert part in found.message
    assert found.span.line == 5


@pytest.mark.parametrize(
    ("program", "part", "line"),
    [
        ("SUB S\nP0010 CALL S\nEND\nP0020 CALL S", "S calls itself", 3),
        ("SUB S\nP0010 CALL T\nEND\nSUB T\nP0020 CALL S\nEND\nP0030 CALL T", "T calls itself through S", 3),
    ],
)
def test_recursion(program, part, line):
    (found,) = checked(DEFAULT + program)[1]
    assert (found.code, found.span.line) == ("Y0212", line)
    assert part in found.message


def test_a_fault_in_a_long_loop_is_one_finding():
    found = planned(f"{DEFAULT}REPEAT I 10000\nP0010 MOVEJ $(1/(I-I)) 0 0 0 0 0\nEND")[1]
    (one,) = grouped(found)
    assert one.code == "Y0410"
    assert "(at P0010(I=0), and 9,999 more times)" in one.message


def test_most_commands(monkeypatch):
    for module in (counting, repeats):
        monkeypatch.setattr(module, "MOST_COMMANDS", 100)
    loop = "REPEAT 10\nREPEAT {}\nP0010 MOVEJ HOME\nEND\nEND"
    empty = "REPEAT 50\nREPEAT 50\nEND\nEND\nP0010 STOP"
    assert codes(checked(DEFAULT + loop.format(9))[1]) == []
    program, found = checked(DEFAULT + loop.format(11))
    assert codes(found) == ["Y1004"]
    assert len(program.steps) < 3
    assert codes(checked(DEFAULT + empty)[1]) == ["Y1004"]
    assert codes(checked(f"{DEFAULT}REPEAT 101\nP0010 STOP\nEND")[1]) == ["Y1004"]


ROUNDS_LIMIT = "; the loops of a program make at most 200,000 rounds"


@pytest.mark.parametrize(
    ("program", "line", "message"),
    [
        ("REPEAT 200001\nEND", 2, "REPEAT 200,001: the loops of a program make at most 200,000 rounds"),
        (("REPEAT 8881\n"
            "REPEAT 99\n"
            "END\n"
            "END"), 2, "8,881 rounds, each around 99 others, are 888,100 rounds" + ROUNDS_LIMIT),
        ("REPEAT I 1000\nREPEAT J 1000\nIF I > J\nP0010 STOP\nEND\nEND\nEND", 2,
         "1,000 rounds, each around at least 1,000 others, are at least 1,001,000 rounds" + ROUNDS_LIMIT),
        (("REPEAT I 1000\n"
            "REPEAT $I\n"
            "END\n"
            "END"), 2, "up to round 632 of 1,000 this loop makes 200,028 rounds" + ROUNDS_LIMIT),
        (("REPEAT I 100000\n"
            "END\n"
            "REPEAT 99999\n"
            "END\n"
            "REPEAT 2\n"
            "END"), 6, "with this REPEAT the program makes 200,001 rounds" + ROUNDS_LIMIT),
        ("SUB S\nREPEAT 1000\nEND\nEND\nREPEAT 200\nP0010 CALL S\nEND", 6,
         "200 rounds, each around 1,000 others, are 200,200 rounds" + ROUNDS_LIMIT),
    ],
)  # fmt: skip
def test_rounds_are_counted_before_any_is_carried_out(program, line, message):
    begin = time.process_time()
    unrolled, found = checked(DEFAULT + program)
    assert time.process_time() - begin < 1.0
    (one,) = [finding for finding in found if finding.code == "Y1004"]
    assert (one.message, one.span.line) == (message, line)
    assert len(unrolled.steps) < 20_000


def test_as_many_rounds_as_are_allowed():
    assert codes(checked(f"{DEFAULT}REPEAT 199\nREPEAT 999\nEND\nEND\nP0010 STOP")[1]) == []


@pytest.mark.parametrize(
    "body",
    [
        "IF I > 2\nP0010 MOVEJ 1 0 0 0 0 0\nEND",
        "IF I > 2\nELSE\nREPEAT 3\nP0010 MOVEJ 1 0 0 0 0 0\nEND\nEND",
        "LET N = I % 3\nREPEAT $N\nP0010 CALL S $N\nEND",
        (
            "INPUT DOOR M11\n"
            "WHEN DOOR ON\n"
            "REPEAT $(I % 2)\n"
            "P0010 MOVEJ 1 0 0 0 0 0\n"
            "END\n"
            "ELSE\n"
            "P0020 MOVEJ 2 0 0 0 0 0\n"
            "END"
        ),
        'REPEAT J 4\nREPEAT $(I * J)\nP0010 MOVEJ 1 0 0 0 0 0\nEND\nIF J > 2\nP0020 HOLD "A"\nEND\nEND',
    ],
)
def test_a_least_count_is_no_more_than_the_count(body, monkeypatch):
    found = {}

    def noted(name):
        method = getattr(counting.Counter, name)

        def note(counter, block, *others):
            made = method(counter, block, *others)
            if block.head.line == 7:
                found[name] = made
            return made

        monkeypatch.setattr(counting.Counter, name, note)

    noted("_repeat")
    noted("_least_round")
    checked(f"{DEFAULT}SUB S A\nIF A > 1\nP0030 MOVEJ 3 0 0 0 0 0\nEND\nEND\nREPEAT I 7\n{body}\nEND")
    least, (commands, lines, rounds, _) = found["_least_round"], found["_repeat"]
    assert 0 < 7 * least.commands <= commands
    assert 0 < 7 * least.lines <= lines
    assert 0 < 7 * least.rounds <= rounds


@pytest.mark.parametrize(
    ("mistake", "least", "most"),
    [
        ("P0005 MOVEJ NOWHERE", 10_000, 10_100),  # a name that isn't declared
        ("P0005 MOVEJ (((", 1_000, 1_100),  # a line that can't be read
    ],
)
def test_programs_with_errors_are_carried_out_in_part(mistake, least, most):
    program = (
        f"{mistake}\nREPEAT I 300\nREPEAT J 300\nP0010 MOVEJ $(I/9) 0 0 0 0 0\nEND\nEND\nP0020 MOVEJ HOME"
    )
    begin = time.process_time()
    unrolled, found = checked(DEFAULT + program)
    assert time.process_time() - begin < 3.0
    assert unrolled.is_cut
    assert least / 2 < len(unrolled.steps) < most
    assert any(
        getattr(step.origin, "index", "") == "P0020"
        for step in unrolled.steps[-3:]
        if hasattr(step, "origin")
    )
    assert "Y1004" not in codes(found)


def test_what_is_found_in_a_part_of_a_loop_is_there_at_least_so_often():
    found = planned(f"{DEFAULT}REPEAT I 50000\nP0010 MOVEJ NOWHERE\nEND")[1]
    (one,) = grouped(found, at_least=True)
    assert "at least" in one.message
    whole = planned(f"{DEFAULT}REPEAT I 50\nP0010 MOVEJ NOWHERE\nEND")[1]
    (one,) = grouped(whole)
    assert "and 49 more times" in one.message


def test_sub_that_call_others_twice_are_counted_once():
    subs = "SUB S0\nP0010 MOVEJ HOME\nEND\n" + "".join(
        f"SUB S{number}\nP0010 CALL S{number - 1}\nP0020 CALL S{number - 1}\nEND\n" for number in range(1, 41)
    )
    begin = time.process_time()
    (one,) = [finding for finding in checked(f"{DEFAULT}{subs}P0030 CALL S40")[1] if finding.code == "Y1004"]
    assert time.process_time() - begin < 1.0
    assert "a program has at most 1,000,000 commands" in one.message


def test_the_pallet_with_far_too_many_rows_is_refused_at_its_loop_at_once():
    text = next((Path(__file__).resolve().parents[2] / "examples").glob("06*.yarc")).read_text()
    text = re.sub(r"LET ROWS *= *\d+", "LET ROWS = 99999", text)
    begin = time.process_time()
    source = SourceFile("pallet.yarc", text)
    diagnostics = check_text(source, Path(), Options()).diagnostics
    assert time.process_time() - begin < 2.0
    (one,) = [finding for finding in diagnostics if finding.code == "Y1004"]
    assert source.line(one.span.line).split("!")[0].split()[0] in ("REPEAT", "CALL")
    assert re.search(r"[0-9]+,[0-9]{3}", one.message)
