"""Programs in a cell with a feeder, a table and boxes, for the tests of this folder."""

from pathlib import Path

from programs import compiled

from yarclang.diagnostics import Result
from yarclang.pipeline.cells import cell_loader
from yarclang.robot.description import load_robot

CELL = """units = "mm,deg,s"
[frames.FEEDER]
parent = "B"
xyz = [300, 850, 650]
[frames.PUT]
parent = "B"
xyz = [{x}, {y}, {z}]
rpy = [0, 0, {turn}]
[frames.GRIPPER]
parent = "FLANGE"
xyz = [0, 150, 0]
rpy = [90, 0, 0]
[joints]
READY = [0, -10, -20, 0, -60, 0]
[inputs]
GOOD = "M11"
[outputs]
GRIP = {{ variable = "M1", grips = "GRIPPER", reach = 15 }}
TAKEN = {{ variable = "M2", removes = "PUT", reach = 15 }}
[[parts]]
name = "BOX"
shape = "box"
frame = "FEEDER"
size = [{size}, 60, 60]
margin = {margin}
count = {count}
mass = {mass}
[[obstacles]]
name = "TRACK"
shape = "box"
frame = "FEEDER"
xyz = [0, 0, -130]
size = [300, 200, 200]
[[obstacles]]
name = "TABLE"
shape = "box"
frame = "PUT"
xyz = [0, 0, -130]
size = [300, 300, 200]
[[obstacles]]
name = "FINGERS"
shape = "box"
frame = "GRIPPER"
xyz = [0, 0, 40]
size = [30, 80, 80]
"""
GIVEN = {"x": -250, "y": 900, "z": 700, "turn": 30, "size": 60, "margin": 0, "count": 1, "mass": 0.8}

HEAD = 'CELL "cell.toml"\nDEFAULT {GRIPPER} [50%] (mm,deg,s) {B}\nSTART READY\n'
PICK = """P0010 MOVEJ_RPY 0 0 120 0 0 0 {FEEDER}
P0020 MOVEL 0 0 0 0 0 0 [1] {FEEDER}
P0030 SET GRIP ON
P0040 MOVEL 0 0 120 0 0 0 [1] {FEEDER}
"""
PUT = """P0050 MOVEJ_RPY 0 0 120 0 0 0 {PUT}
P0060 MOVEL 0 0 0 0 0 0 [1.2] {PUT}
P0070 SET GRIP OFF
P0080 MOVEL 0 0 120 0 0 0 [1.2] {PUT}
P0090 MOVEJ READY
"""


def made(folder: Path, program: str, more: str = "", robot: str = "INDUSTRIAL6", **given):
    """Compile a program in the cell with changed numbers, and with `more` at the end of the cell's file."""
    (folder / "cell.toml").write_text(CELL.format(**{**GIVEN, **given}) + more)
    return Result(*compiled(HEAD + program, robot, load_cell=cell_loader(folder, load_robot(robot).value)))
