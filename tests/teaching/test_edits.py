"""Tests of properties of all edits, for sound and broken texts: edits never overlap, all other text stays the
same to the byte, and no edit adds faults.
"""

import itertools
import random
import time
from pathlib import Path

import mutated_texts
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import robot_of

from yarclang.runtime.actions import Trouble
from yarclang.source import SourceFile, lines_with_ends
from yarclang.teaching.changing import change
from yarclang.teaching.edits import Program, applied
from yarclang.teaching.fields import Reader
from yarclang.teaching.holding import around
from yarclang.teaching.lines import delete, insert, move, renumbered
from yarclang.teaching.listing import listing
from yarclang.teaching.motions import Taught, teach
from yarclang.teaching.points import touch_up

ROBOT = robot_of("INDUSTRIAL6")
ENDS = ("\n", "\r\n", "\r")


def program(text):
    return Program(SourceFile("test.yarc", text))


def overlap(edits):
    pairs = itertools.pairwise(sorted(edits, key=lambda one: one.span))
    return any(
        (one.span.end_line, one.span.end_column) > (other.span.line, other.span.column)
        for one, other in pairs
    )


def untouched(text, edits):
    """Return the lines, with their line ends, that no edit touches."""
    lines = lines_with_ends(text)
    reached = set()
    for edit in edits:
        span = edit.span
        last = span.end_line - (span.end_column == 1 and span.end_line > span.line)
        if span.column == 1 and (span.line, span.column) == (span.end_line, span.end_column):
            continue  # a line is inserted before this one, which stays
        reached.update(range(span.line, last + 1))
    return [line for number, line in enumerate(lines, 1) if number not in reached]


def is_part(some, all_of_them):
    """Return True if the lines `some` occur among all lines, in the same order."""
    left = iter(all_of_them)
    return all(any(one == other for other in left) for one in some)


def holds(text, edited):
    """Check the properties of every edit, and return the edited text."""
    new = applied(text, edited.edits)
    assert not overlap(edited.edits)
    assert is_part(untouched(text, edited.edits), lines_with_ends(new))
    before, after = program(text), program(new)
    assert after.faults[0] <= before.faults[0]
    assert after.faults[1] <= before.faults[1]
    assert 1 <= edited.line <= max(after.size, 1)
    assert edited.what
    return new


def some_edit(text, draw):
    """Return a random edit, or None if it is refused."""
    found = program(text)
    line = draw.randint(1, max(found.size, 1))
    other = draw.randint(1, found.size + 1)
    named = None
    joints = ROBOT.home + np.array([draw.uniform(-0.3, 0.3) for _ in range(6)])
    kind = draw.choice(("delete", "move", "renumber", "insert", "change", "teach", "touch"))
    try:
        if kind in ("teach", "touch"):
            named = around(found, Path(__file__).parent, ROBOT)
        match kind:
            case "delete":
                return delete(found, line, min(line + draw.randint(0, 3), found.size))
            case "move":
                return move(found, line, other)
            case "renumber":
                return renumbered(found)
            case "insert":
                code = draw.choice(("WAIT [1] (s)", "STOP", 'HOLD "a ! b"', "! only words"))
                return insert(found, line - draw.randint(0, 1), code, has_index=code[0] != "!")
            case "change":
                statement = found.statement(line)
                placed = Reader(found.sketch).placed(statement)
                if not placed:
                    return None
                field = draw.choice(placed).field
                value = draw.choice(
                    ("1.5", "READY", "", "ON", "{B}", "a ! b", "min", "2] (s) !", "1\n2", "50%", '"')
                )
                return change(found, line, {field.name: value})
            case "teach":
                motion = draw.choice(("MOVEJ", "MOVEL", "DMOVE", "MOVEC"))
                name = draw.choice(("", "", f"T{draw.randint(0, 99)}")) if motion != "DMOVE" else ""
                taught = Taught(motion, name=name, via=ROBOT.home + 0.1)
                return teach(named, line - draw.randint(0, 1), taught, joints)
            case _:
                return touch_up(named, line, joints)
    except Trouble as trouble:
        told = trouble.what
    assert told
    assert "\n" not in told
    return None


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 1 << 30), broken=st.booleans())
def test_edits_keep_what_they_dont_mean(seed, broken):
    draw = random.Random(seed)
    whole = [text for _, text in mutated_texts.programs() if len(text) < 4000]
    text = mutated_texts.drawn(seed)[1][:4000] if broken else draw.choice(whole)
    text = text.replace("\r\n", "\n").replace("\n", draw.choice(ENDS))
    if draw.random() < 0.3:
        text = text.rstrip("\r\n")
    for _ in range(6):
        edited = some_edit(text, draw)
        if edited is not None:
            text = holds(text, edited)
    assert all(one.line >= 1 and one.rows >= 1 and one.depth >= 0 for one in listing(SourceFile("x", text)))


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 1 << 30))
def test_what_was_inserted_and_is_deleted_leaves_no_trace(seed):
    draw = random.Random(seed)
    text = mutated_texts.drawn(seed)[1][:3000].replace("\n", draw.choice(ENDS))
    before = program(text)
    try:
        edited = insert(before, draw.randint(0, before.size), "WAIT [1] (s)")
    except Trouble:
        return
    if "new one" in edited.what:  # the insertion gave other commands new indices, because none was free
        return
    new = applied(text, edited.edits)
    try:
        back = delete(program(new), edited.line, edited.line)
    except Trouble:
        return
    assert applied(new, back.edits) == text


def test_no_text_is_too_strange_to_be_listed():
    for seed in range(200):
        text = mutated_texts.drawn(seed)[1]
        found = listing(SourceFile("x", text))
        module = program(text).sketch.module
        lines = {one.line for one in found}
        assert {one.line for one in module.statements} | set(module.unreadable_lines) <= lines
        assert len(found) == len(lines)


def test_a_block_goes_with_its_end_and_says_what_is_missing_then():
    text = (
        "JOINTS READY 0 0 0 0 10 0 (deg)\n"
        "REPEAT 2 ! twice\n"
        "  P0010 MOVEJ READY [2] (s)\n"
        "  IF 1\n"
        "    P0020 STOP\n"
        "  END\n"
        "END\n"
        "P0030 STOP\n"
    )
    gone = delete(program(text), 2, 2)
    assert applied(text, gone.edits) == "JOINTS READY 0 0 0 0 10 0 (deg)\nP0030 STOP\n"
    assert gone.what == "deleted 6 lines from line 2 on"
    with pytest.raises(Trouble, match="the END in line 7 belongs to REPEAT in line 2"):
        delete(program(text), 7, 7)
    assert "READY is used in line 2" in delete(program(text), 1, 1).what
    rows = "P0010 MOVEJ_SPLINE 1 2 3 4 5 6; ! a\n\n ! b\n  1 2 3 4 5 7 [9] (deg,s)\nP0020 STOP"
    assert applied(rows, delete(program(rows), 3, 3).edits) == "P0020 STOP"
    assert applied(rows, delete(program(rows), 5, 5).edits) == rows[: -len("\nP0020 STOP")]


def test_a_command_is_moved_into_a_block_as_its_neighbours_are():
    text = 'P0010 STOP  ! one\r\nREPEAT 2\r\n    P0020 HOLD "a"\r\nEND\r\nP0030 HOLD "b"\r\n'
    inside = move(program(text), 1, 4)
    made = applied(text, inside.edits)
    assert made == 'REPEAT 2\r\n    P0020 HOLD "a"\r\n    P0025 STOP  ! one\r\nEND\r\nP0030 HOLD "b"\r\n'
    assert inside.line == 3
    whole = applied(text, move(program(text), 2, 6).edits)
    assert whole.splitlines()[1:] == ['P0030 HOLD "b"', "REPEAT 2", '    P0040 HOLD "a"', "END"]
    with pytest.raises(Trouble, match="into themselves"):
        move(program(text), 2, 4)


def test_tables_of_places_and_ceilings_have_fields():
    text = (
        "TABLE SPOTS POSE 1 2 3 0 0 0; 4 5 6 0 0 0 (mm,deg) {B}\n"
        "TABLE STANDS JOINTS 0 0 0 0 20 0; 10 0 0 0 20 0 (deg)\n"
        "P0010 MOVEL {TCP} $(SPOTS[1]) [V<=250] (mm,s) BLEND <=5\n"
        "P0020 MOVEJ $(STANDS[0]) [V 5]\n"
        "FUNC MID(A, B) = (A + B) / 2\n"
    )
    found = program(text)

    def line(number, **fields):
        return applied(text, change(found, number, fields).edits).splitlines()[number - 1]

    assert line(1, **{"1.0": "7"}) == "TABLE SPOTS POSE 1 2 3 0 0 0; 7 5 6 0 0 0 (mm,deg) {B}"
    assert line(1, base="TABLE") == "TABLE SPOTS POSE 1 2 3 0 0 0; 4 5 6 0 0 0 (mm,deg) {TABLE}"
    assert line(2, **{"0.4": "30"}) == "TABLE STANDS JOINTS 0 0 0 0 30 0; 10 0 0 0 20 0 (deg)"
    assert line(3, target="$(SPOTS[0])") == "P0010 MOVEL {TCP} $(SPOTS[0]) [V<=250] (mm,s) BLEND <=5"
    assert line(3, ceiling="100", blend="2") == "P0010 MOVEL {TCP} $(SPOTS[1]) [V<=100] (mm,s) BLEND <=2"
    assert line(3, speed="80") == "P0010 MOVEL {TCP} $(SPOTS[1]) [V 80] (mm,s) BLEND <=5"
    assert line(3, blend="") == "P0010 MOVEL {TCP} $(SPOTS[1]) [V<=250] (mm,s)"
    assert line(5, value="A*B") == "FUNC MID(A, B) = A*B"


def test_fields_are_changed_in_their_places():
    text = (
        "DEFAULT {TCP} [50%] (mm,deg) {B}\n"
        "P0010   MOVEL  1.00 2  3 0 0 0   BLEND 5   ! there\n"
        "P0020 WAIT DOOR ON\n"
        "P0030 MOVEJ A NEAR B\n"
    )
    found = program(text)

    def line(number, **fields):
        return applied(text, change(found, number, fields).edits).splitlines()[number - 1]

    assert line(2, x="7.5") == "P0010   MOVEL  7.5 2  3 0 0 0   BLEND 5   ! there"
    assert line(2, speed="100") == "P0010   MOVEL  1.00 2  3 0 0 0 [V 100] (s)   BLEND 5   ! there"
    assert line(2, blend="", comment="") == "P0010   MOVEL  1.00 2  3 0 0 0"
    assert (
        line(2, time="4", base="TABLE", acc="30")
        == "P0010   MOVEL  1.00 2  3 0 0 0 [4] (s) {TABLE}   BLEND 5 ACC 30%   ! there"
    )
    assert line(3, time="5") == "P0020 WAIT DOOR ON [5] (s)"
    assert line(4, target="READY", near="") == "P0030 MOVEJ READY"
    assert line(2, ceiling="100") == "P0010   MOVEL  1.00 2  3 0 0 0 [V<=100] (s)   BLEND 5   ! there"
    for wrong in (
        {"x": "1 2"},
        {"x": ""},
        {"blend": "5 ! x"},
        {"nothing": "1"},
        {"time": "1", "percent": "50"},
        {"comment": "a\nP1 STOP"},
    ):
        with pytest.raises(Trouble):
            change(found, 2, wrong)


def test_the_condition_of_a_wait_is_a_field():
    text = (
        "INPUT DOOR M11\n"
        "P0010  WAIT  DOOR = ON AND JOB > 2  [5] (s) ! x\n"
        "P0020 WAIT NOT DOOR = ON ! y\n"
        'P0030 ABORT "no part"\n'
        "P0040 WAIT N = 1 AND (NOT (DOOR = ON))\n"
    )
    found = program(text)

    def line(number, **fields):
        return applied(text, change(found, number, fields).edits).splitlines()[number - 1]

    assert line(2, condition="N = 3 OR JOB = 1") == "P0010  WAIT  N = 3 OR JOB = 1  [5] (s) ! x"
    assert line(2, time="7") == "P0010  WAIT  DOOR = ON AND JOB > 2  [7] (s) ! x"
    assert line(3, condition="DOOR = OFF") == "P0020 WAIT DOOR = OFF ! y"
    assert line(3, time="5") == "P0020 WAIT NOT DOOR = ON [5] (s) ! y"
    assert line(5, time="5") == "P0040 WAIT N = 1 AND (NOT (DOOR = ON)) [5] (s)"
    assert line(4, text="no tray") == 'P0030 ABORT "no tray"'


def test_a_long_program_is_listed_in_a_second():
    lines = "".join(
        f"P{n * 10:05d} MOVEL {n % 999}.25 1000 {n / 100:.2f} 0 0 {n % 90}\n" for n in range(10_000)
    )
    source = SourceFile("x", f"DEFAULT {{TCP}} [50%] (mm,deg,s) {{B}}\n{lines}")
    took = []
    for _ in range(2):
        begin = time.process_time()
        assert len(listing(source)) == 10_001
        took.append(time.process_time() - begin)
    assert min(took) < 1.0


def test_the_input_that_ends_a_motion_is_a_field():
    text = (
        "INPUT TOUCH M12\n"
        "INPUT STOP M13\n"
        "REGISTER DEPTH 0..9\n"
        "P0010 MOVEL 1 2 3 0 0 0 [V 50] (mm,deg,s) UNTIL TOUCH OFF INTO DEPTH ELSE\n"
        "END\n"
    )
    found = program(text)

    def line(**fields):
        return applied(text, change(found, 4, fields).edits).splitlines()[3]

    assert line(until="STOP").endswith("UNTIL STOP INTO DEPTH ELSE")
    with pytest.raises(Trouble, match="would break a block"):
        line(until="")
    assert line(into="").endswith("UNTIL TOUCH OFF ELSE")


def test_a_timetable_has_the_time_of_each_way_point_and_its_own_options():
    text = (
        "DEFAULT (deg,s)\n"
        "P0010 MOVEJ_TIMED 1 0 0 0 5 0 [1] VEL 0 0 0 0 4 0; 2 0 0 0 9 0 [2.5] VEL 0 0 0 0 0 0\n"
    )
    made = program(text)
    fields = {one.field.name: one.field.value for one in Reader(made.sketch).placed(made.statement(2))}
    assert {"1.time": "1", "time": "2.5", "stretch": "", "tol": ""}.items() <= fields.items()
    assert not {"percent", "blend", "acc"} & fields.keys()
    for wanted, said in (
        ({"1.time": "0.7"}, "5 0 [0.7] VEL 0 0 0 0 4 0; 2"),
        ({"time": "3"}, "9 0 [3] VEL 0 0 0 0 0 0"),
        ({"stretch": "1.5"}, "[2.5] VEL 0 0 0 0 0 0 STRETCH 1.5"),
        ({"units": "deg,s"}, "[2.5] VEL 0 0 0 0 0 0 (deg,s)"),
    ):
        assert said in applied(text, change(made, 2, wanted).edits)
    file = program('DEFAULT (deg,s)\nP0010 MOVEJ_TIMED "a.csv" STRETCH 2\n')
    fields = {one.field.name: one.field.value for one in Reader(file.sketch).placed(file.statement(2))}
    assert (fields["file"], fields["stretch"]) == ("a.csv", "2")


CASE = """REGISTER N 0..3
CASE N
OF 0 1
  P0010 WAIT [1] (s)
OF 2..3
  P0020 SET N = N - 1
END
"""


def test_a_case_is_listed_with_its_ways():
    found = listing(SourceFile("x", CASE))
    assert [(one.line, one.depth, one.kind) for one in found] == [
        (1, 0, "declaration"), (2, 0, "block"), (3, 0, "end"), (4, 1, "wait"), (5, 0, "end"), (6, 1, "set"),
            (7, 0, "end"),
    ]  # fmt: skip
    assert [
        [(field.name, field.value) for field in one.fields if field.value]
        for one in found
        if one.line in (1, 2, 3, 5)
    ] == [
        [("range", "0..3")],
        [("selector", "N")],
        [("1", "0"), ("2", "1")],
        [("1", "2..3")],
    ]
