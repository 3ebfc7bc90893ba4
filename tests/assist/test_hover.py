"""Tests of the text for the place under the mouse."""

import re
from dataclasses import replace

import numpy as np
import pytest

from tests.assist.texts import HEAD, checked, looked_at, marked, robot
from yarclang.assist.hints import ShortestTimes, hints_in
from yarclang.assist.hover import hover_at
from yarclang.robot.kinematics.fk import tool_poses

PROGRAM = (
    HEAD
    + """\
FRAME {TABLE} 0 900 600 0 0 90 {B}
FRAME {HOLE} 120 0 50 0 0 0 {TABLE}     ! a bore
LET PITCH = 60 (mm)
TABLE HEIGHTS 10 20 30 (mm)
TABLE SPOTS 0 0; 1 1; 2 2
JOINTS READY 0 -10 -20 0 -60 0
POSE P1 100 100 400 0 0 0 {TABLE}
INPUT DOOR M11
OUTPUT GRIP M1 OFF
! Goes up.
SUB UP
  P0005 DMOVE 0 0 50 0 0 0 [1]
END
P0010 MOVEJ READY
P0020 MOVEL 100 100 400 0 0 0 [8] {TABLE}
P0030 CALL UP
REPEAT 3
  P0040 MOVEJ 10 0 0 0 0 0
  P0050 MOVEJ READY
END
"""
)


@pytest.fixture(scope="module")
def planned():
    return checked(PROGRAM, plans=True)


def hovered(view, piece: str, shift: int = 1) -> str:
    text = view.sketch.source.text
    place = text.index(piece) + shift
    _, line, column = marked(text[:place] + "|" + text[place:])
    found = hover_at(view, line, column)
    return found.text if found else ""


def numbers(text: str) -> list[float]:
    return [float(one) for one in re.findall(r"-?\d+\.\d+", text)]


def test_a_command_tells_where_it_leads(planned):
    text = hovered(planned, "P0020")
    lines = text.splitlines()
    assert lines[0].startswith("- ends with `{TCP}` in `{TABLE}` at ")
    assert np.allclose(numbers(lines[0]), [100, 100, 400, 0, 0, 0], atol=1e-3)
    # computed by hand: the table is turned by 90 deg about z
    assert np.allclose(numbers(lines[1]), [-100, 1000, 1000, 0, 0, 90], atol=1e-3)
    joints = np.deg2rad(numbers(lines[2]))
    pose = tool_poses(robot().chain, joints[None], robot().flange_from_frame["TCP"])[0]
    assert np.allclose(pose[:3, 3], [-0.1, 1.0, 1.0], atol=1e-4)
    assert re.search(r"takes 8\.000 s, at least \d\.\d+ s, from \d\.\d+ s on", text)
    assert "nearest limit: " in text
    assert "smallest singular value 0." in text
    assert "clearance at least " in text


def test_the_command_s_name_has_its_documentation(planned):
    text = hovered(planned, "MOVEL 100")
    assert text.index("takes 8.000 s") < text.index("**MOVEL**: ")
    assert "**MOVEL**" in hovered(looked_at("P0010 MOVEL"), "MOVEL")


def test_a_command_in_a_loop_tells_its_first_time(planned):
    assert "the first of 3 times: P0040(#0)" in hovered(planned, "P0040")


def test_frames_tell_their_chain(planned):
    text = hovered(planned, "HOLE")
    assert "FRAME {HOLE} 120 0 50 0 0 0 {TABLE}     ! a bore" in text
    first, second, whole = (line for line in text.splitlines() if line.startswith("- "))
    assert numbers(first) == [120, 0, 50, 0, 0, 0]
    assert "`{TABLE}` in `{B}`" in second
    assert numbers(whole) == [0, 1020, 650, 0, 0, 90]
    assert "world" in hovered(planned, "{B}")
    assert "in `{FLANGE}`" in hovered(planned, "{TCP}")


@pytest.mark.parametrize(
    ("piece", "told"),
    [
        ("PITCH", "is 60 mm"),
        ("READY", "J5 -60.000"),
        ("DOOR", "reads M11"),
        ("GRIP", "sets M1 of the controller; 0 at any stop"),
        ("CALL UP", "**CALL**: carries out a SUB"),
        ("UP\nREPEAT", "Goes up."),
        ("MIN", ""),
        ("deg,s", "a unit of angle"),
        ("DEFAULT", "parts that lines of this file may leave out"),
        ("! Goes", ""),
        ("INDUSTRIAL6", ""),
    ],
)
def test_names_and_words(planned, piece: str, told: str):
    if piece in PROGRAM:
        assert told in hovered(planned, piece, 5 if piece == "CALL UP" and told.startswith("Goes") else 1)
        assert bool(told) == bool(hovered(planned, piece, 1))


def test_errors_leave_what_is_known():
    view = checked(PROGRAM + "P0090 MOVEL 9999 0 0 0 0 0 {TABLE}\n", plans=True)
    text = hovered(view, "P0020")
    assert "- ends with `{TCP}` in `{TABLE}` at 100.000 100.000 400.000" in text
    assert "not planned: the program has errors" in text
    assert "J5 -60.000" in hovered(view, "P0010")


def test_without_a_check_names_are_told_from_the_text():
    view = looked_at(PROGRAM)
    assert "FRAME {HOLE}" in hovered(view, "HOLE")
    assert "LET PITCH = 60 (mm)" in hovered(view, "PITCH")
    assert "Goes up." in hovered(view, "UP\nREPEAT", 1)


def test_suppressed_codes_are_explained():
    assert "**Y0611 " in hovered(looked_at("P0010 STOP ! yarc: ignore[Y0611]"), "Y0611")
    assert hovered(looked_at("P0010 STOP ! yarc: ignore[Y0611]"), "ignore") == ""


def test_a_half_typed_line_leaves_the_others_what_they_were(planned):
    """Unchanged lines keep their motions from before the edit, even if they have moved; changed lines have
    none.
    """
    text = PROGRAM.replace("P0010 MOVEJ READY\n", "P0007 MOV\nP0010 MOVEJ READY\n").replace(
        "P0040 MOVEJ 10", "P0040 MOVEJ 11"
    )
    assert text.count("P0007 MOV") == 1
    view = replace(checked(text), older=planned)
    assert not view.is_planned
    before = hovered(planned, "P0050")
    assert hovered(view, "P0050") == before + "\n- as it was before the last edits"
    assert "takes" not in hovered(view, "P0040")
    lines = view.sketch.source.lines
    found = {lines[one.line - 1].split()[0]: one for one in hints_in(view, 1, len(lines), ShortestTimes())}
    assert "P0050" in found
    assert not {"P0040", "P0007"} & found.keys()
    assert found["P0050"].text == next(
        one.text
        for one in hints_in(planned, 1, 99, ShortestTimes())
        if "P0050" in planned.sketch.source.line(one.line)
    )


def test_a_motion_that_flows_has_no_shortest_time_of_its_own():
    lines = "".join(
        f"P{10 * n:04} MOVEL {300 - 3 * n} 1074 1100 0 0 0 [V 50] BLEND 0.3\n" for n in range(2, 12)
    )
    text = (
        "P0010 MOVEJ_RPY 300 1074 1100 0 0 0\n"
        + lines
        + "P0120 MOVEL 250 1074 1100 0 0 0 [V 50]\nP0130 MOVEJ 0 0 0 0 0 0\n"
    )
    view = checked(HEAD + text, plans=True)
    hints = {one.line: one for one in hints_in(view, 1, 99, ShortestTimes())}
    for place, line in (("P0010", 3), ("P0130", 15)):
        assert "at least" in hints[line].tooltip, place
        assert "at least" in hovered(view, place)
    for place, line in (("P0020", 4), ("P0060", 8), ("P0120", 14)):
        assert "at least" not in hints[line].tooltip, place
        assert "s, at least" not in hovered(view, place)
        assert "takes" in hovered(view, place)


def test_a_table_tells_its_indices(planned):
    text = hovered(planned, "TABLE HEIGHTS", 7)
    assert "a table" in text
    assert "3 numbers, with the indices 0 to 2" in text
    assert "3 rows of 2 numbers" in hovered(planned, "TABLE SPOTS", 7)


def test_a_pose_tells_where_it_is_in_its_frame_and_in_the_base(planned):
    text = hovered(planned, "POSE P1", 5)
    assert "a pose" in text
    assert "POSE P1 100 100 400" in text
    inside, base = (numbers(line) for line in text.splitlines() if line.startswith("- in `{"))
    assert np.allclose(inside, [100, 100, 400, 0, 0, 0], atol=1e-3)
    # computed by hand: the table is turned by 90 deg about z
    assert np.allclose(base[:3], [-100, 900 + 100, 600 + 400], atol=1e-3)
    assert base[5] == pytest.approx(90)
