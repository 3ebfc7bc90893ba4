"""Tests of LOOP, WHILE, UNTIL, EXIT, RETURN and a REPEAT that a register counts: their steps and findings."""

import pytest
from programs import checked, codes, planned

from yarclang.hir import Assign, EndLoop, EndWhen, Exit, Finish, Loop, NextPass, When

HEAD = "INPUT DOOR M11\nREGISTER N 0..9\nJOINTS A 10 0 0 0 0 0 (deg)\nDEFAULT [1] (deg,s)\n"


def kinds(*lines):
    program, found = checked(HEAD + "\n".join(lines) + "\n")
    assert not [one for one in found if one.is_error], found
    return [type(step) for step in program.steps if not hasattr(step, "profile")]


def first(*lines):
    _, found = checked(HEAD + "\n".join(lines) + "\n")
    return next(one for one in found if one.is_error)


def test_a_while_is_a_loop_whose_body_stands_in_a_when():
    assert kinds("WHILE DOOR OFF", "P10 MOVEJ HOME", "END") == [Loop, When, NextPass, EndWhen, EndLoop]


def test_an_until_leaves_the_loop_behind_its_pass():
    found = kinds("LOOP", "P10 MOVEJ HOME", "UNTIL N > 2 AND DOOR = ON")
    assert found == [Loop, When, Exit, EndWhen, NextPass, EndLoop]


def test_a_repeat_counts_a_register_of_its_own_down():
    program, _ = checked(HEAD + "REPEAT N\nP10 MOVEJ HOME\nEND\n")
    assert [one.name for one in program.registers] == ["N", "REPEAT_1"]
    own = program.registers[1]
    assert (own.low, own.high) == (0, 9)
    steps = [type(step) for step in program.steps if not hasattr(step, "profile")]
    assert steps == [Assign, Loop, When, Assign, NextPass, EndWhen, EndLoop]


def test_a_loop_with_a_number_counts_as_well():
    program, _ = checked(HEAD + "LET K = 143\nLOOP $(K * 2 + 2)\nP10 MOVEJ HOME\nEND\n")
    assert program.registers[-1].high == 288
    steps = [type(step) for step in program.steps if not hasattr(step, "profile")]
    assert steps == [Assign, Loop, When, Assign, NextPass, EndWhen, EndLoop]
    assert kinds("LOOP N", "P10 MOVEJ HOME", "END") == steps


def test_repeats_inside_each_other_have_registers_of_their_own():
    program, _ = checked(HEAD + "REPEAT N\nREPEAT N\nP10 MOVEJ HOME\nEND\nEND\n")
    assert [one.name for one in program.registers] == ["N", "REPEAT_1", "REPEAT_2"]


def test_the_register_of_a_repeat_hides_none():
    program, _ = checked(HEAD + "REGISTER REPEAT_1 0..3\nREPEAT N\nP10 MOVEJ HOME\nEND\n")
    assert [one.name for one in program.registers] == ["N", "REPEAT_1", "REPEAT_2"]


def test_a_pass_that_every_way_leaves_has_no_next_one():
    assert NextPass not in kinds("LOOP", "P10 MOVEJ HOME", "P20 EXIT", "END")
    both = ("LOOP", "WHEN DOOR ON", "P10 EXIT", "ELSE", "P20 STOP", "END", "END", "P30 MOVEJ A")
    found = kinds(*both)
    assert NextPass not in found
    assert Finish in found


def test_a_return_leads_behind_its_sub():
    lines = (
        "SUB S",
        "WHEN DOOR ON",
        "P10 RETURN",
        "END",
        "P20 SET N = 1",
        "END",
        "P30 CALL S",
        "P40 MOVEJ A",
    )
    assert kinds(*lines) == [Loop, When, Exit, EndWhen, Assign, EndLoop]


def test_a_return_in_loops_leaves_each_of_them_and_then_the_sub():
    lines = (
        "SUB S",
        "LOOP",
        "LOOP",
        "WHEN DOOR ON",
        "P10 RETURN",
        "END",
        "END",
        "P20 SET N = 1",
        "END",
        "END",
        "P30 CALL S",
        "P40 MOVEJ A",
    )
    behind = [EndLoop, When, Exit, EndWhen]
    inner = [Loop, When, Assign, Exit, EndWhen, NextPass, *behind]
    assert kinds(*lines) == [Assign, Loop, Loop, *inner, Assign, NextPass, *behind, EndLoop]


def test_a_return_in_a_loop_of_a_sub_leaves_no_loop_around_its_call():
    lines = (
        "SUB S",
        "LOOP",
        "P10 RETURN",
        "END",
        "END",
        "LOOP",
        "P30 CALL S",
        "P35 SET N = 1",
        "UNTIL DOOR ON",
        "P40 MOVEJ A",
    )
    program, found = checked(HEAD + "\n".join(lines) + "\n")
    assert [one.code for one in found if one.is_error] == []
    assert sum(isinstance(step, NextPass) for step in program.steps) == 1


def test_a_return_on_all_ways_needs_no_step():
    assert kinds("SUB S", "P10 RETURN", "END", "P30 CALL S", "P40 MOVEJ A") == []


def test_a_return_in_a_compile_time_if_needs_no_step_either():
    lines = ("LET K = 1", "SUB S", "IF 1 = 1", "P10 RETURN", "END", "P20 SET N = 1", "END", "P30 CALL S")
    program, found = checked(HEAD + "\n".join((*lines, "P40 MOVEJ $K 0 0 0 0 0")) + "\n")
    assert [type(step).__name__ for step in program.steps] == ["JointMove"]
    assert "Y1001" in codes(found)  # P20 can't be reached


@pytest.mark.parametrize(
    ("lines", "code", "what"),
    [
        (["P10 EXIT", "P20 MOVEJ A"], "Y0450", "EXIT is not in a LOOP or WHILE"),
        (["P10 RETURN", "P20 MOVEJ A"], "Y0450", "RETURN is not in a SUB"),
        (["SUB S", "P5 EXIT", "END", "LOOP", "P10 CALL S", "END"], "Y0450", "EXIT is not in a LOOP"),
        (["REPEAT 2", "P10 EXIT", "END"], "Y0450", "EXIT is not in a LOOP"),
        (["P10 MOVEJ A", "UNTIL DOOR ON"], "Y0114", "this UNTIL has no LOOP to end: no block is open"),
        (["WHEN DOOR ON", "P10 MOVEJ A", "UNTIL DOOR ON", "END"], "Y0114", "the WHEN of line 5 is open here"),
        (["LOOP", "P10 MOVEJ A"], "Y0113", "this LOOP has no END"),
        (["LOOP", "WHEN DOOR ON", "P10 MOVEJ A", "UNTIL DOOR ON"], "Y0113", "this WHEN has no END"),
        (["LOOP 5 6", "P10 MOVEJ A", "END"], "Y0401", "LOOP takes a number of passes, or nothing"),
        (["LOOP DOOR", "P10 MOVEJ A", "END"], "Y0401", "LOOP takes a number of passes, or nothing"),
        (["LOOP 2.5", "P10 MOVEJ A", "END"], "Y0414", "LOOP 2.5: the count must be an integer"),
        (["LOOP -1", "P10 MOVEJ A", "END"], "Y0414", "LOOP -1: the count must be an integer"),
        (["LOOP 300000", "P10 MOVEJ A", "END"], "Y1004", "LOOP 300,000"),
        (
            ["LOOP 5", "P10 MOVEJ A", "UNTIL DOOR ON"],
            "Y0401",
            "a LOOP with a number of passes must end with END, not UNTIL",
        ),
        (
            ["LOOP", "P10 MOVEJ A", "ELSE", "P20 MOVEJ HOME", "END"],
            "Y0115",
            "the LOOP of line 5 is open here",
        ),
        (["WHILE DOOR", "P10 MOVEJ A", "END"], "Y0401", "WHILE takes an input and its value"),
        (["LOOP", "P10 MOVEJ A", "UNTIL"], "Y0401", "UNTIL takes an input and its value"),
        (["WHILE 1 = 1", "P10 MOVEJ A", "END"], "Y0430", "this condition has no register or input"),
        (["REPEAT I N", "P10 MOVEJ A", "END"], "Y0401", "N is known only when the program runs"),
        (["P5 LOOP", "P10 MOVEJ A", "END"], "Y0117", "LOOP is no command and has no index"),
        (["LOOP", "P10 MOVEJ A", "P20 EXIT 5", "END"], "Y0401", "EXIT takes nothing after it"),
        (
            ["P10 WAIT DOOR ON ELSE", "P20 MOVEJ A", "END"],
            "Y0451",
            "the ELSE of this WAIT is never carried out",
        ),
        (["P10 WAIT [5] ELSE", "P20 MOVEJ A", "END"], "Y0451", "the ELSE of this WAIT is never carried out"),
        (["P10 WAIT DOOR ON [5] ELSE 4", "P20 MOVEJ A", "END"], "Y0412", "the line must end after the ELSE"),
        (["P10 WAIT DOOR ON [5] BLEND 2 ELSE", "P20 MOVEJ A", "END"], "Y0408", "WAIT doesn't take BLEND"),
        (["P10 MOVEJ A ELSE"], "Y0412", "ELSE is allowed only after the time of a WAIT"),
        (["WAIT DOOR ON [5] ELSE", "P20 MOVEJ A", "END"], "Y0105", "WAIT has no index"),
        (["P10 WAIT DOOR ON [5] ELSE", "P20 MOVEJ A"], "Y0113", "this WAIT has no END"),
        (
            ["P10 WAIT DOOR ON [5] ELSE", "ELSE", "P20 MOVEJ A", "END"],
            "Y0115",
            "the WAIT of line 5 already has an ELSE",
        ),
        (
            ["P10 WAIT N = 3 [5] ELSE", "P20 MOVEJ A", "END"],
            "Y0440",
            "this condition can't change during the WAIT",
        ),
    ],
)
def test_mistakes_are_told(lines, code, what):
    found = first(*lines)
    assert found.code == code
    assert what in found.message


@pytest.mark.parametrize(
    ("lines", "what"),
    [
        (["LOOP", "P10 MOVEJ A", "END", "P20 MOVEJ HOME"], "the LOOP of line 5 never ends"),
        (["LOOP", "P10 EXIT", "P20 MOVEJ A", "END"], "P0010 has already left the loop"),
        (["SUB S", "P5 RETURN", "P10 MOVEJ A", "END", "P20 CALL S"], "has already left the SUB"),
        (["LOOP", "P10 STOP", "END", "P20 MOVEJ A"], "P0010 ends the program"),
    ],
)
def test_lines_that_no_way_leads_to_are_told(lines, what):
    _, found = checked(HEAD + "\n".join(lines) + "\n")
    (one,) = (one for one in found if one.code == "Y1001")
    assert what in one.message


@pytest.mark.parametrize(
    ("lines", "what"),
    [
        (["LOOP", "P10 MOVEJ A", "UNTIL DOOR ON"],
            "a pass of this loop doesn't end where it began: the joint positions differ in J1 by 10 deg"),
        (["WHILE DOOR ON", "P10 MOVEJ A", "END"], "a pass of this loop doesn't end where it began"),
        (["REPEAT N", "P10 DMOVEJ 1 0 0 0 0 0", "END"], "a pass of this loop doesn't end where it began"),
        (
            ["LOOP", "WHEN DOOR ON", "P10 EXIT", "END", "P20 MOVEJ A", "WHEN N > 1", "P30 EXIT", "END",
                "P40 MOVEJ HOME", "END"],
            "the exits of this loop end at different joint positions, which differ in J1 by 10 deg",
        ),
        (
            ["SUB S", "WHEN DOOR ON", "P10 RETURN", "END", "P20 MOVEJ A", "END", "P30 CALL S"],
            "the exits of this CALL end at different joint positions",
        ),
    ],
)  # fmt: skip
def test_a_loop_closes(lines, what):
    _, found = planned(HEAD + "\n".join(lines) + "\n")
    (one,) = (one for one in found if one.code == "Y1002")
    assert what in one.message


def test_the_way_of_an_else_comes_back():
    _, found = planned(HEAD + "P10 WAIT DOOR ON [5] ELSE\nP20 MOVEJ A\nEND\n")
    (one,) = (one for one in found if one.code == "Y1002")
    assert "the branches of this WAIT end at different joint positions" in one.message
    assert "which differ in J1 by 10 deg" in one.message


def test_a_loop_may_be_left_elsewhere_than_where_it_begins():
    lines = ("LOOP", "P10 MOVEJ A", "WHEN DOOR ON", "P20 EXIT", "END", "P30 MOVEJ HOME", "END", "P40 MOVEJ A")
    _, found = planned(HEAD + "\n".join(lines) + "\n")
    assert not [one for one in found if one.is_error]
    assert "Y0603" in codes(found)  # after the loop, the robot is at A already
