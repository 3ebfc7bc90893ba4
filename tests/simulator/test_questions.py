"""The quick readers for questions and plain moves agree with the interpreter for any line."""

import pytest
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st
from simulator.machines import bare, program, say

from yarclang.simulator.language.reader import Reader
from yarclang.simulator.language.words import cleaned, read_statement, simple_move
from yarclang.simulator.network.reply import Reply
from yarclang.simulator.online.interpreter import execute
from yarclang.simulator.online.line import LONGEST
from yarclang.simulator.online.questions import questions

POINTERS = (
    "M1->X:$B0,24", "M2->Y:$C0,24", "M3->Y:$C0,0", "M4->X:$B0,13", "M5->X:$2040,24", "M6->Y:$203F,16",
        "M7->Y:$203F,24",
    "M8->D:$88", "M9->D:$8B", "M10->X:$130,8,8,S", "M11->L:$10", "M12->*", "M161->D:$C7", "M162->Y:$2140,24",
)  # fmt: skip

# mostly numbers that exist, so that most questions aren't refused
MOTORS = st.one_of(*[st.integers(1, 32)] * 9, st.sampled_from([0, 33, 40, 100]))
SYSTEMS = st.one_of(*[st.integers(1, 16)] * 9, st.sampled_from([0, 17, 20, 100]))
INDICES = st.one_of(
    *[st.integers(0, 20), st.integers(0, 8191), st.sampled_from([20, 100, 161, 162, 5111, 8191])] * 3,
    st.sampled_from([8192, 9999, 99999]),
)
NUMBERED = st.tuples(
    st.one_of(
        st.tuples(st.just("#"), MOTORS),
        st.tuples(st.just("&"), SYSTEMS),
        st.tuples(st.sampled_from("IPQM"), INDICES),
    ),
    st.sampled_from(["", "", "", "", "0", "00"]),
).map(lambda part: f"{part[0][0]}{part[1]}{part[0][1]}")
ASKED = st.one_of(NUMBERED, NUMBERED, st.sampled_from(["P", "V", "F", "?", "??", "???"]))
OTHER = st.sampled_from(
    ["#", "&", "##2", "P(1)", "P1..3", "P1=5", "Q3=1", "M1->", "M1->*", "I9=1", "I9=2", "PR", "PC", "%",
        "FOO", "X1",
     "VER", "1", "$", '"', ";", "//", "; P1", "// ?", "é", "#1->", "I5111=1000", "TIME", "???????", "PP",
         "OPEN PLC 3"]
)  # fmt: skip
GLUE = st.sampled_from(["", "", " ", "  ", "\t"])


def glued(parts):
    """Draw a line from parts, with spaces between them, in upper, lower or mixed case."""
    return st.tuples(
        st.lists(parts, min_size=1, max_size=5), GLUE, st.sampled_from([str.upper, str.lower, str.title])
    ).map(lambda line: line[2](line[1].join(line[0])))


def moving(i9):
    """Return a machine in the middle of a program, a jog and a PLC 0, with M-variables for their state."""
    machine = bare("1000X+5", "100.5Y", record=False)
    say(
        machine,
        "I300=1 #3->10Z #3J/",
        "Q1=5 P7=-1.25",
        "&2Q1=6",
        "Q2=1/3",
        "&1",
        *POINTERS,
        "I5111=5000M12=-3",
    )
    say(machine, "OPEN PLC 0 CLEAR", "P1=M8/3072", "P2=M9/3072+P7", "CLOSE", "I5=1", "ENABLE PLC 0")
    program(machine, "SPLINE1 TM100", "M12==4", "X1Y-2", "X2Y-3", "X3Y1")
    say(machine, "#4", "I400=1", "#4J/", "#4J=3000", "&1B1R")
    machine.advance(0.234)
    say(machine, f"I9={i9}")
    return machine


@exercises(quick=0.1, slow=0.1)
@settings(max_examples=250)
@given(
    st.one_of(glued(ASKED), glued(st.one_of(ASKED, ASKED, ASKED, OTHER))),
    st.integers(0, 3),
    st.integers(1, 32),
    st.integers(1, 16),
)
def test_questions_are_answered_alike(tally, line, i9, motor, system):
    one, other = moving(i9), moving(i9)
    for machine in (one, other):
        say(machine, f"#{motor}&{system}")
    tally.count("quick", questions(line))
    tally.count("slow", not questions(line))
    assert one.command(line) == execute(other, other.ports[0], line)
    assert one.ports == other.ports
    assert one.command("P1P2M12I9#&") == other.command("P1P2M12I9#&")


@pytest.mark.parametrize(
    "line",
    [
        "P1",
        "#1P#2P",
        " #1 p # 2 v f",
        "&16??",
        "???",
        "I5111Q8191",
        "PVF?",
        "P1P",
        "p0001",
        "P8191;P1",
        "#32?&1??",
        "????",
    ],
)
def test_lines_that_only_ask_are_read_once(line):
    assert questions(line)


@pytest.mark.parametrize(
    "line", ["", "P8192", "#33P", "&0?", "P1=1", "VP1", "P00001", "#", "P1P9000", "P1" + " " * LONGEST]
)
def test_other_lines_are_left_to_the_interpreter(line):
    assert not questions(line)


@pytest.mark.parametrize(
    ("line", "items"),
    [
        ("P7P9000P7", ["-1.25"]),
        ("#2#40P", []),
        ("&2Q1&17", ["6"]),
        ("Q1FOO", ["5"]),
        ("P7#9V#33P7", ["-1.25", "0"]),
    ],
)
def test_what_was_answered_before_an_error_stays(line, items):
    one, other = moving(0), moving(0)
    reply = one.command(line)
    assert reply == execute(other, other.ports[0], line) == Reply(tuple(items), 3)
    assert one.ports == other.ports


DIGITS = st.text("0123456789", max_size=70)
CONSTANT = st.tuples(st.sampled_from(["", "+", "-"]), DIGITS, st.sampled_from(["", "."]), DIGITS).map("".join)


@exercises(quick=0.05, slow=0.1)
@settings(max_examples=400)
@given(
    st.lists(st.tuples(st.sampled_from("ABCUVWXYZXYFIM:^("), CONSTANT).map("".join), max_size=4).map("".join)
)
def test_plain_moves_are_read_alike(tally, line):
    text = cleaned(line)
    move = simple_move(text)
    tally.count("quick", move is not None)
    tally.count("slow", move is None)
    if move is not None:
        reader = Reader(text)
        assert read_statement(reader, False) == move
        assert reader.ended
