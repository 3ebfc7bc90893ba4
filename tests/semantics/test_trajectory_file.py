"""Tests of files of timed trajectories: they are read without loss, and errors are found at their line and
column.
"""

import time
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import codes, robot_of

from yarclang.hir import Timetable
from yarclang.semantics.motions.trajectory_file import STANDS, TrajectoryFile, write_table
from yarclang.source import SourceFile
from yarclang.units import UNITS

DEG = {"angle": UNITS["deg"]}
HEADER = "time,J1,J2,J3,J4,J5,J6"
RATES = "".join(f",J{n}_velocity" for n in range(1, 7))


@pytest.fixture(scope="module")
def slider():
    """Return INDUSTRIAL6 with a prismatic first joint that moves upwards, up to 3 m."""
    robot = robot_of("INDUSTRIAL6")
    screws = robot.chain.screws.copy()
    screws[0] = 0, 0, 1, 0, 0, 0
    return replace(robot, chain=replace(robot.chain, screws=screws), written=None)


def read(text, units=DEG, robot="INDUSTRIAL6", own=frozenset()):
    result = TrajectoryFile(SourceFile("path.csv", text)).table(robot_of(robot), units, own)
    return result.value, result.diagnostics


def refused(text, units=DEG, own=frozenset()):
    """Return code, line, column and message of the only finding."""
    table, found = read(text, units, own=own)
    assert table is None
    (one,) = found
    assert one.is_error
    assert one.source.name == "path.csv"
    assert one.help
    return one.code, one.span.line, one.span.column, one.message


POSITION = st.floats(-1.0, 1.0)
RATE = st.floats(-1e6, 1e6)


@st.composite
def tables(draw):
    size = draw(st.integers(1, 6))
    begins = draw(st.booleans())
    steps = draw(st.lists(st.floats(1e-6, 1e3), min_size=size + begins, max_size=size + begins))
    times = np.cumsum([0.0 if begins else 0.25, *steps[1:]])
    orders = draw(st.integers(0, 2))
    rows = [
        np.array(draw(st.lists(st.tuples(*[kind] * 6), min_size=len(times), max_size=len(times))))
        for kind in (POSITION, RATE, RATE)[: orders + 1]
    ]
    for some in rows[1:2]:
        some[-1] = 0.0
        some[0] = 0.0 if begins else some[0]
    return Timetable(times, *rows)


def same(one, other):
    pairs = [
        (getattr(one, name), getattr(other, name))
        for name in ("times", "positions", "velocities", "accelerations")
    ]
    return all(a is b or (a is not None and b is not None and np.array_equal(a, b)) for a, b in pairs)


@settings(max_examples=100)
@given(table=tables(), ending=st.sampled_from(["\n", "\r\n", "\r"]), order=st.randoms())
def test_what_is_written_is_read(table, ending, order):
    text = write_table(robot_of("INDUSTRIAL6"), table)
    found, told = read(text, {})
    assert codes(told) == []
    assert same(found, table)
    # the result is the same for other orders of columns, line ends, blank lines, comments, and spaces between
    # cells
    lines = [line.split(",") for line in text.splitlines()]
    columns = list(range(len(lines[0])))
    order.shuffle(columns)
    shuffled = [" , ".join(line[column] for column in columns) for line in lines]
    shuffled.insert(1, "")
    shuffled.insert(2, "# a comment, with a comma")
    assert same(read(ending.join(shuffled), {})[0], table)


@settings(max_examples=100)
@given(table=tables(), unit=st.sampled_from(["deg", "rad"]), clock=st.sampled_from(["", " [ms]", "[min]"]))
def test_units_are_those_of_the_header_or_of_the_program(table, unit, clock):
    factor, second = UNITS[unit].factor, UNITS[clock.strip(" []") or "s"].factor
    named = "".join(f",J{n} [{unit}]" for n in range(1, 7))
    rows = np.hstack((table.times[:, None] / second, table.positions / factor))
    body = "".join(",".join(map(repr, row)) + "\n" for row in rows.tolist())
    for header, units in ((f"time{clock}{named}", {}), (f"time{clock},{HEADER[5:]}", {"angle": UNITS[unit]})):
        found, told = read(f"{header}\n{body}", units)
        assert codes(told) == []
        assert found.times == pytest.approx(table.times, rel=1e-15)
        assert found.positions.tolist() == ((table.positions / factor) * factor).tolist()


def test_lengths_and_angles(slider):
    header = "time,J1 [mm],J2 [deg],J3 [deg],J4 [deg],J5 [deg],J6 [deg]" + "".join(
        f",J{n}_velocity [{unit}/s]" for n, unit in enumerate(("mm", *["deg"] * 5), 1)
    )
    text = f"{header}\n1,250,90,0,0,0,0,100,9,0,0,0,0\n2,500,0,0,0,0,0,0,0,0,0,0,0\n"
    table, found = read(text, {}, slider)
    assert codes(found) == []
    assert table.positions[0, :2].tolist() == [0.25, np.pi / 2]
    assert table.velocities[0, :2].tolist() == [0.1, 9 * UNITS["deg"].factor]


@pytest.mark.parametrize(
    ("text", "code", "line", "column", "words"),
    [
        ("", "Y1384", 1, 1, "no data"),
        ("\n \n# nothing\n", "Y1384", 1, 1, "no data"),
        (HEADER, "Y1384", 1, 1, "a header and no row"),
        (f"{HEADER}\n0,1,2,3,4,5,6", "Y1384", 2, 1, "the only row is the start"),
        (HEADER.replace(",", ";"), "Y1380", 1, 5, "this file has semicolons between cells"),
        (HEADER.replace(",", "\t"), "Y1380", 1, 5, "this file has tabs between cells"),
        ("time,J1,J2,J3,J5,J6\n1,1,1,1,1,1", "Y1380", 1, 1, "column J4 is missing"),
        ("J1,J2,J3,J4,J5,J6", "Y1380", 1, 1, "column time is missing"),
        (f"{HEADER},J2", "Y1380", 1, 24, "J2 is a column twice: the other begins at column 9"),
        (f"{HEADER}, Time ", "Y1380", 1, 25, "Time is a column twice"),
        (f"{HEADER},J7", "Y1380", 1, 24, "'J7' is no column of a trajectory of INDUSTRIAL6"),
        (f"{HEADER},gripper", "Y1380", 1, 24, "'gripper' is no column"),
        (f"{HEADER},", "Y1380", 1, 24, "a column without a name"),
        (f"{HEADER}{RATES[:-12]}", "Y1380", 1, 1, "column J6_velocity is missing"),
        (f"{HEADER}{RATES.replace('velocity', 'acceleration')}", "Y1380", 1, 1, "columns J1_velocity, "),
        (HEADER.replace("J2", "J2 [deg]"), "Y1381", 1, 6, "J2 has a unit, deg, and J1 doesn't"),
        (HEADER.replace("J2", "J2 [deg]").replace("J3", "J3 (rad)"), "Y1381", 1, 18, "in deg and J3 in rad"),
        (HEADER.replace("J2", "J2 [mm]"), "Y1381", 1, 9, "'mm' is no unit for J2"),
        (HEADER.replace("J2", "J2 [turn]"), "Y1381", 1, 9, "'turn' is no unit"),
        (HEADER.replace("time", "time [deg]"), "Y1381", 1, 1, "'deg' is no unit for time"),
        (HEADER + RATES.replace("J1_velocity", "J1_velocity [deg]"), "Y1381", 1, 24, "'deg' is no unit"),
        (HEADER + RATES.replace("J1_velocity", "J1_velocity [deg/s2]"), "Y1381", 1, 24, "no unit"),
        (f"{HEADER}\n1,1,2,3,4,5", "Y1382", 2, 1, "this line has 6 cells, but the header has 7"),
        (f"{HEADER}\n1,1,2,3,4,5,6\n\n2", "Y1382", 4, 1, "this line has 1 cell, but the header has 7"),
        (f"{HEADER}\n1;1;2;3;4;5;6", "Y1382", 2, 1, "this line has 1 cell"),
        (f"{HEADER}\n1,1,2,3,4,5,six", "Y1382", 2, 13, "'six' is not a number"),
        (f"{HEADER}\n1,1,2, nan,4,5,6", "Y1382", 2, 8, "nan is too large for a joint position"),
        (f"{HEADER}\n1,1,2,-inf,4,5,6", "Y1382", 2, 7, "-inf is too large"),
        (f"{HEADER}\n1,1,,3,4,5,6", "Y1382", 2, 5, "this cell is empty"),
        (f"{HEADER}\n1,1,1e99,3,4,5,6", "Y1382", 2, 5, "1e99 is beyond the largest value"),
        (f"{HEADER}\n1,1,1e999,3,4,5,6", "Y1382", 2, 5, "1e999 is beyond the largest value"),
        (f"{HEADER}\n1,1,1_0,3,4,5,6", "Y1382", 2, 5, "'1_0' is not a number"),
        (f"{HEADER}\n1,1,0x1,3,4,5,6", "Y1382", 2, 5, "'0x1' is not a number"),
        (f"{HEADER}\n1,1,1 0,3,4,5,6", "Y1382", 2, 5, "'1 0' is not a number"),
        (f"{HEADER}\n1,1,٣,3,4,5,6", "Y1382", 2, 5, "is not a number"),
        (f"{HEADER}\n1,1,--3,3,4,5,6", "Y1382", 2, 5, "'--3' is not a number"),
        (f"{HEADER}\n-0.5,1,2,3,4,5,6", "Y1383", 2, 1, "the first time is -0.5 s"),
        ((f"{HEADER}\n"
            "1,1,2,3,4,5,6\n"
            "1,2,3,4,5,6,7"), "Y1383", 3, 1, "1 s isn't later than the one before, 1 s in line 2"),
        (f"{HEADER}\r\n1,1,2,3,4,5,6\r\n0.5,2,3,4,5,6,7\r\n", "Y1383", 3, 1, "0.5 s isn't later"),
        (f"{HEADER}\n3,1,1,1,1,1,1\n2,1,1,1,1,1,1\n1,1,1,1,1,1,1", "Y1383", 3, 1, "(and 1 more row)"),
        (f"{HEADER}\n1,0,0,0,0,0,0\n2,0,180,0,0,0,0", "Y0502", 3, 5, "J2 at 180 deg is outside its limits"),
        ((f"{HEADER}{RATES}\n"
            f"0{',0' * 6},0,0,9{',0' * 3}\n"
            f"1{',0' * 12}"), "Y1383", 2, 19, "J3 moves at 9 deg/s at time 0"),
        (f"{HEADER}{RATES}\n1{',0' * 11},9", "Y1383", 2, 25, "J6 moves at 9 deg/s in the last row"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said_where(text, code, line, column, words):
    found = refused(text)
    assert found[:3] == (code, line, column)
    assert words in found[3]


def test_a_unit_that_nobody_says():
    code, line, column, message = refused(f"{HEADER}\n1,1,2,3,4,5,6", {})
    assert (code, line, column, message) == ("Y1381", 1, 1, "J1 has no unit")


def test_a_unit_of_the_line_against_that_of_the_header():
    named = ",".join(["time", *(f"J{n} [rad]" for n in range(1, 7))])
    text = f"{named}\n1,1,0,0,0,0,0\n"
    assert refused(text, DEG, frozenset(["angle"]))[0] == "Y1381"
    # the unit of DEFAULT is only for files that state no unit
    assert read(text, DEG)[0].positions[0, 0] == 1.0


def test_noise_at_rest_is_none():
    table, _ = read(f"{HEADER}{RATES}\n1{',0' * 11},{STANDS}\n")
    assert table.velocities[-1].tolist() == [0.0] * 6


@pytest.mark.parametrize(
    "text",
    ["a" * 20_000_000, "," * 20_000_000, "\n" * 20_000_000, HEADER + "\n" + "1," * 10_000_000,
     HEADER + "\n" + "1,2,3,4,5,6,7\n" * 1_400_000, (HEADER + "\n") * 900_000],
    ids=["letters", "commas", "lines", "cells", "rows", "headers"],
)  # fmt: skip
def test_as_much_garbage_as_is_read_is_one_finding(text):
    begun = time.process_time()
    code, *_, message = refused(text)
    assert code.startswith("Y13")
    assert len(message) < 400
    assert time.process_time() - begun < 20.0


def test_a_file_is_read_once_for_a_robot_and_its_units():
    file = TrajectoryFile(SourceFile("path.csv", f"{HEADER}\n1,1,2,3,4,5,6\n"))
    robot = robot_of("INDUSTRIAL6")
    first = file.table(robot, DEG)
    assert file.table(robot, dict(DEG)) is first
    other = file.table(robot, {"angle": UNITS["rad"]})
    assert other.value is None or other.value is not first.value


@settings(max_examples=300)
@given(
    text=st.text(alphabet="time,J123456 \n\r[]degra/s._-+e0;#\t\"'nif", max_size=150), is_body=st.booleans()
)
def test_no_text_makes_it_fall(text, is_body):
    table, found = read(f"{HEADER}\n{text}" if is_body else text)
    assert (table is None) == any(one.is_error for one in found)
