"""Tests of OFFSET in a cell with parts: parts in the shifted frame are shifted with it and gripped alike, and
no part is left at another place than the programmed one.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import codes, robot_of, source

from yarclang.cell.description import Names, read_cell
from yarclang.handling.parts import first_parts, shift
from yarclang.handling.present import are_same
from yarclang.hir import When
from yarclang.pipeline.boxes import box_findings
from yarclang.pipeline.parts import followed_plan, parts_before
from yarclang.pipeline.shifting import around, shifted_program
from yarclang.pipeline.stages import Request, compile_module
from yarclang.semantics.declared.meanings import is_word
from yarclang.syntax.parse import parse

ROBOT = robot_of("INDUSTRIAL6")
CELL = """units = "mm,deg"
[frames]
BIN = { parent = "B", xyz = [380, 800, 580] }
PART = { parent = "BIN", xyz = [0, 0, 60] }
TRAY = { parent = "B", xyz = [-300, 700, 640] }
CUP = { parent = "FLANGE", xyz = [0, 150, 0], rpy = [90, 0, 0] }
[joints]
READY = [0, -10, -20, 0, -60, 0]
[outputs.SUCK]
variable = "M1"
grips = "CUP"
[[parts]]
name = "BLOCK"
shape = "box"
frame = "PART"
xyz = [0, 0, -30]
size = [60, 60, 60]
mass = 1.2
count = COUNT
[[obstacles]]
name = "WALL"
shape = "box"
frame = "BIN"
xyz = [105, 0, 40]
size = [10, 220, 80]
[[obstacles]]
name = "TUBE"
shape = "cylinder"
frame = "CUP"
xyz = [0, 0, 40]
radius = 15
length = 80
"""
HEAD = """ROBOT INDUSTRIAL6
CELL "cell.toml"
REGISTER DX -2000..2000 0
REGISTER DY -2000..2000 0
REGISTER TURN -1500..1500 0
DEFAULT {CUP} [50%] (mm,deg,s) {B}
START READY
"""
PICK = """OFFSET {PART} X DX Y DY RZ TURN
  P0010 MOVEJ_RPY 0 0 120 0 0 0 {PART}
  P0020 MOVEL 0 0 0 0 0 0 [30%] {PART}
  P0030 SET SUCK ON
  P0040 MOVEL 0 0 120 0 0 0 [30%] {PART}
  P0050 MOVEJ READY
END
P0060 MOVEJ_RPY 0 0 120 0 0 0 {TRAY}
P0070 MOVEL 0 0 0 0 0 0 [30%] {TRAY}
P0080 SET SUCK OFF
P0090 MOVEL 0 0 120 0 0 0 [30%] {TRAY}
"""
# SHOVE puts the block down within the shifted frame
SHOVE = PICK.replace("P0040 MOVEL 0 0 120", "P0040 MOVEL 0 0 40").replace(
    "  P0050 MOVEJ READY",
    "  P0042 MOVEL 0 60 40 0 0 0 [30%] {PART}\n"
    "  P0043 MOVEL 0 60 0 0 0 0 [30%] {PART}\n"
    "  P0044 SET SUCK OFF\n"
    "  P0045 MOVEL 0 60 120 0 0 0 [30%] {PART}\n"
    "  P0050 MOVEJ READY",
)
SHOVE = SHOVE[: SHOVE.index("P0060")] + "P0060 MOVEJ 0 0 0 0 -30 0\n"


def made(text, count=2, cell=CELL):
    def load(name, _):
        return read_cell(source(cell.replace("COUNT", str(count)), name), None, Names(is_word, ROBOT))

    parsed = parse(source(HEAD + text))
    result = compile_module(parsed.value, Request(ROBOT, load_cell=load))
    assert result.value is not None, (parsed.diagnostics, result.diagnostics)
    return result.value


def instance(value, values):
    plan = value.plan
    return shifted_program(plan, 0, plan.motions[0].curve.points[0], values, Request(ROBOT))


@settings(max_examples=3, deadline=None)
@given(st.integers(-2000, 2000), st.integers(-2000, 2000), st.integers(-1500, 1500), st.integers(1, 3))
def test_the_grip_is_the_same_wherever_the_part_lies(x, y, turn, count):
    value = made(PICK, count)
    there = instance(value, (x, y, 0, turn))
    assert not isinstance(there, str), there
    (grasp,) = followed_plan(there.plan).grasps.values()
    (meant, *_) = followed_plan(value.plan).grasps.values()
    held, known = grasp.after.held()[0], meant.after.held()[0]
    assert held.transform == pytest.approx(known.transform, abs=1e-6)
    _, end = around(value.program.steps, value.plan.motions[0].step)
    assert are_same(followed_plan(there.plan).end, parts_before(value.plan, end))
    # before the grasp, the part lay at the shifted place
    moved = np.linalg.norm(grasp.before.items[0].transform[:3, 3] - meant.before.items[0].transform[:3, 3])
    assert moved == pytest.approx(np.hypot(x, y) * 1e-5, abs=1e-5)


def test_a_part_may_not_stay_where_the_shift_has_it():
    value = made(SHOVE, 1)
    assert not isinstance(instance(value, (0, 0, 0, 0)), str)
    told = instance(value, (500, 0, 0, 0))
    assert isinstance(told, str)
    assert "BLOCK is left 5.000 mm away from its place without the shift" in told


def test_a_part_that_is_not_taken_may_not_stay_either():
    value = made(
        PICK.replace("  P0030 SET SUCK ON\n", "  P0030 WAIT [0.1]\n").replace(
            "P0020 MOVEL 0 0 0", "P0020 MOVEL 0 0 10"
        ),
        1,
    )
    told = instance(value, (500, 0, 0, 0))
    assert isinstance(told, str)
    assert "BLOCK is left 5.000 mm away from its place without the shift" in told


def test_a_part_in_another_frame_stays():
    """A shift of PART doesn't move a block in BIN, so that the cup doesn't grip it as programmed: this is
    refused.
    """
    value = made(
        PICK, 1, CELL.replace('frame = "PART"\nxyz = [0, 0, -30]', 'frame = "BIN"\nxyz = [0, 0, 30]')
    )
    (offset,) = [one.offset for one in value.program.steps if isinstance(one, When)]
    assert offset.parts == ()
    told = instance(value, (2000, 2000, 0, 0))
    # within its reach the cup takes it elsewhere than the program says
    assert "BLOCK is held 28.284 mm away from its place in the gripper without the shift" in told


def test_a_frame_in_the_shifted_frame_carries_its_parts():
    cell = CELL.replace("TRAY =", 'INNER = { parent = "PART", xyz = [0, 0, -30] }\nTRAY =').replace(
        'frame = "PART"\nxyz = [0, 0, -30]', 'frame = "INNER"\nxyz = [0, 0, 0]'
    )
    value = made(PICK, 2, cell)
    (offset,) = [one.offset for one in value.program.steps if isinstance(one, When)]
    assert offset.parts == ("BLOCK",)
    assert not isinstance(instance(value, (1000, -1000, 0, 900)), str)


def test_the_program_s_own_frame_of_that_name_has_no_parts():
    value = made(PICK, 1)
    assert [one.offset.parts for one in value.program.steps if isinstance(one, When)] == [("BLOCK",)]


def test_a_wall_is_where_it_is():
    """A shift by which the block or the cup hits the wall is refused at run time; a range that contains it is
    a finding.
    """
    wide = HEAD.replace("DX -2000..2000", "DX -2000..8500")
    value = made(PICK)
    told = instance(value, (8500, 0, 0, 0))
    assert isinstance(told, str)
    assert "WALL" in told
    assert list(box_findings(value.plan, Request(ROBOT))) == []
    parsed = parse(source(wide + PICK))

    def load(name, _):
        return read_cell(source(CELL.replace("COUNT", "2"), name), None, Names(is_word, ROBOT))

    result = compile_module(parsed.value, Request(ROBOT, load_cell=load))
    found = list(box_findings(result.value.plan, Request(ROBOT)))
    assert codes(found) == ["Y0508"]
    assert "WALL" in found[0].message


@given(st.floats(-0.05, 0.05), st.floats(-0.05, 0.05))
def test_only_parts_at_their_first_place_are_shifted(x, y):
    value = made(PICK, 3)
    cell = value.program.cell
    parts = first_parts(cell)
    moved = np.eye(4)
    moved[:2, 3] = x, y
    once = shift(parts, ("BLOCK",), moved, 0)
    assert once.items[0].transform[:2, 3] == pytest.approx(parts.items[0].transform[:2, 3] + [x, y])
    assert [one.number for one in once.expected] == [2]
    assert shift(parts, (), moved, 0) == parts
    if x or y:
        assert shift(once, ("BLOCK",), moved, 0).items == once.items
