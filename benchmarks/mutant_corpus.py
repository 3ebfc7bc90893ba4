"""The programs that every mutant compiles. Some are small and valid, each close to the limit that it tests.
The others are invalid, each for a single reason.
"""

from __future__ import annotations

import re
import shutil
from pathlib import Path

from yarclang.frozen import frozen

ROOT = Path(__file__).resolve().parents[1]
MASSES = (
    "<inertial><origin xyz='0.01 0.02 0.1'/><mass value='12'/>"
    "<inertia ixx='0.2' iyy='0.3' izz='0.25' ixy='0.01' ixz='0' iyz='0.02'/></inertial>"
)
TOOL = """
[tools.HAND]
frame = "FLANGE"
mass = 6
center_of_mass = [0, 60, 10]
inertia = [0.02, 0.03, 0.02, 0.001, 0, 0]

[[bodies]]
tool = "HAND"
shape = "capsule"
radius = 30
length = 120
xyz = [0, 85, 0]
rpy = [90, 0, 0]
"""


@frozen
class Case:
    """A program. Its robot is a name or a file of the folder, its cell a file there. `refused` gives the
    reason for which it must be refused; None if it must compile.
    """

    name: str
    text: str
    robot: str = "INDUSTRIAL6"
    cell: str = ""
    refused: str | None = None


ALL = """DEFAULT {TCP} (mm,deg,s) {B}
P0010 MOVEJ_RPY 0 1174.4 1276 0 0 0 [9]
P0020 MOVEL 200 1074.4 1326 10 -5 20 [4] BLEND 10
P0030 DMOVE 0 0 -50 0 0 15 [2]
P0040 DMOVE 0 60 0 0 0 0 [2] {TCP}
P0050 MOVEJ_SPLINE 10 -5 -20 10 20 30; 0 0 -30 0 20 0; HOME [12]
P0060 MOVEJ_LSPB 20 10 -20 0 10 0 [MIN]
"""
FLOWING = """DEFAULT {TCP} [V 120] (mm,deg,s) {B}
P0010 MOVEJ_RPY 0 1074.4 1276 0 0 0 [9]
P0020 DMOVE 80 0 0 0 0 0 BLEND 8
P0030 DMOVE 0 -80 20 0 0 20 BLEND 8
P0040 MOVEL_SPLINE 120 1000 1300 0 0 10; 160 980 1320 5 0 0; 200 1000 1300 0 0 0
P0050 DMOVE 0 0 60 5 5 0 [MIN]
"""
QUICK = """P0010 MOVEJ 40 10 -20 30 20 60 [MIN] (deg,s)
P0020 MOVEJ_POLY5 0 40 20 0 0 0 [MIN] (deg,s)
P0030 MOVEJ_SCURVE HOME [MIN] (deg,s)
"""
SIGNALS = """INPUT READY M11
INPUT SECOND M12
OUTPUT DONE M1 OFF
P0010 MOVEJ 20 10 -20 0 10 0 [4] (deg,s)
P0020 WAIT READY 1 [20] (s)
P0030 SET DONE 1
WHEN SECOND 1
P0050 MOVEJ HOME [4] (deg,s)
ELSE
P0060 MOVEJ_POLY5 HOME [5] (deg,s)
END
P0070 SET DONE 0
"""
SWING = "P0010 MOVEJ {turn} 0 0 0 0 0 [6] (deg,s)\nP0020 MOVEJ HOME [6] (deg,s)\n"
POST = """units = "mm,deg,s"
[[obstacles]]
name = "POST"
shape = "box"
frame = "B"
xyz = [-800, 680, 1764]
size = [200, 200, 200]
rpy = [0, 0, 10]
margin = 5

[[zones]]
name = "FLOOR"
rule = "allowed"
shape = "half-space"
frame = "B"
normal = [0, 0, 1]
xyz = [0, 0, 50]

[[zones]]
name = "NEAR"
rule = "slow"
shape = "box"
frame = "B"
xyz = [0, 1100, 1250]
size = [700, 400, 300]
speed = 500
"""
HEAD = 'units = "mm,deg,s"\n'
BODIES = {
    "shelf": HEAD
    + """[[obstacles]]
name = "SHELF"
shape = "capsule"
frame = "B"
xyz = [0, 1250, 1276]
radius = 40
length = 900
rpy = [0, 90, 0]
margin = 5
""",
    "ball": HEAD
    + """[[obstacles]]
name = "BALL"
shape = "sphere"
frame = "B"
xyz = [300, 1050, 1100]
radius = 120
margin = 2
""",
    "drum": HEAD
    + """[[obstacles]]
name = "DRUM"
shape = "cylinder"
frame = "B"
xyz = [-300, 1250, 1000]
radius = 150
length = 500
rpy = [5, 0, 0]
""",
    "room": HEAD
    + """[[zones]]
name = "ROOM"
rule = "forbidden"
watch = ["elbow"]
frame = "B"
shape = "cylinder"
radius = 150
length = 300
xyz = [0, 700, 1300]
rpy = [10, 0, 0]
""",
    "parts": HEAD
    + """[frames.CUP]
parent = "FLANGE"
xyz = [0, 150, 0]
rpy = [90, 0, 0]
[outputs.GRIP]
variable = "M1"
grips = "CUP"
[frames.PLACE]
parent = "B"
xyz = [300, 800, 730]
[[parts]]
name = "BOX"
shape = "box"
frame = "PLACE"
size = [80, 80, 60]
[[obstacles]]
name = "WALL"
shape = "box"
frame = "B"
xyz = [600, 800, 760]
size = [200, 400, 300]
""",
}


LINES = (
    "DEFAULT {{TCP}} (mm,deg,s) {{B}}\nP0010 MOVEJ_RPY {one} 0 0 0 [9]\nP0020 MOVEL {other} 0 0 0 {time}\n"
)
CARRIED = """DEFAULT {{CUP}} (mm,deg,s) {{B}}
P0010 MOVEJ_RPY 300 800 900 0 0 0 [9]
P0020 MOVEL_RPY 300 800 760.2 0 0 0 [6]
P0030 SET GRIP 1
P0040 MOVEL_RPY 300 800 860 0 0 0 [6]
P0050 MOVEL_RPY {x} 800 860 0 0 0 [6]
"""


def cases() -> tuple[Case, ...]:
    """Return the programs. Each invalid one is one step beyond a valid one."""
    listing = (ROOT / "examples" / "01_listing4.yarc").read_text()
    arm, cell = "arm/robot.toml", "{}.toml".format
    apart = LINES.format
    return (
        Case("listing4", listing),
        Case("all", ALL),
        Case("flowing", FLOWING),
        Case("signals", SIGNALS),
        Case("in a cell", ALL, cell="post.toml"),
        Case("quick", QUICK, arm),
        Case("post", SWING.format(turn=39.68), cell="post.toml"),
        Case("post!", SWING.format(turn=39.70), cell="post.toml", refused="a margin"),
        Case("into the post!", SWING.format(turn=60), cell="post.toml", refused="a collision"),
        Case("shelf", apart(one="-100 1121 1276", other="100 1121 1276", time="[3]"), arm, cell("shelf")),
        Case(
            "shelf!",
            apart(one="-100 1122 1276", other="100 1122 1276", time="[3]"),
            arm,
            cell("shelf"),
            "a margin",
        ),
        Case("elbow", "P0010 MOVEJ 0 -30.6 30.6 0 0 0 [9] (deg,s)\n", cell=cell("room")),
        Case("elbow!", "P0010 MOVEJ 0 -30.8 30.8 0 0 0 [9] (deg,s)\n", cell=cell("room"), refused="a zone"),
        Case("slow", apart(one="-300 1100 1250", other="300 1100 1250", time="[V 499]"), cell="post.toml"),
        Case(
            "slow!",
            apart(one="-300 1100 1250", other="300 1100 1250", time="[V 502]"),
            cell="post.toml",
            refused="a slow zone",
        ),
        Case("effort", "P0010 MOVEJ 0 60 -40 0 0 0 [2] (deg,s)\n", "enough/robot.toml"),
        Case("effort!", "P0010 MOVEJ 0 60 -40 0 0 0 [2] (deg,s)\n", "weak/robot.toml", refused="a torque"),
        Case("motor", "P0010 MOVEJ 0 30 30 0 0 0 [1.5] (deg,s)\n", arm),
        Case("motor!", "P0010 MOVEJ 0 30 30 0 0 0 [1] (deg,s)\n", arm, refused="a motor's speed"),
        Case("window", "P0010 MOVEJ 0 0 79.9 0 0 0 [9] (deg,s)\n"),
        Case("window!", "P0010 MOVEJ 0 0 80.1 0 0 0 [9] (deg,s)\n", refused="a joint's end"),
        Case("itself!", "P0010 MOVEJ 0 0 -165 0 0 0 [20] (deg,s)\n", refused="a collision with itself"),
        Case("ball", apart(one="200 1001 1100", other="400 1001 1100", time="[4]"), cell=cell("ball")),
        Case(
            "ball!",
            apart(one="200 1002.5 1100", other="400 1002.5 1100", time="[4]"),
            cell=cell("ball"),
            refused="a margin",
        ),
        Case("drum", apart(one="-200 1055 1000", other="-400 1055 1000", time="[4]"), cell=cell("drum")),
        Case(
            "drum!",
            apart(one="-200 1056 1000", other="-400 1056 1000", time="[4]"),
            cell=cell("drum"),
            refused="a collision",
        ),
        Case("carried", CARRIED.format(x=459.5), cell=cell("parts")),
        Case("carried!", CARRIED.format(x=460.5), cell=cell("parts"), refused="a part's collision"),
    )


def write(folder: Path) -> None:
    """Write the robots and cells of the programs."""
    (folder / "post.toml").write_text(POST)
    for name, text in BODIES.items():
        (folder / f"{name}.toml").write_text(text)
    arm = folder / "arm"
    shutil.copytree(ROOT / "stdlib" / "robots" / "industrial6", arm)
    urdf = arm / "industrial6.urdf"
    urdf.write_text(re.sub(r'(<link name="link_[1-6]">)', rf"\1{MASSES}", urdf.read_text()))
    toml = arm / "robot.toml"
    text = toml.read_text().replace("velocity = [1540, 1550, 3520,", "velocity = [1540, 1550, 1760,")
    toml.write_text(text + TOOL)
    for name, effort in (("enough", 385.0), ("weak", 383.0)):
        shutil.copytree(arm, folder / name)
        other = folder / name / "robot.toml"
        other.write_text(other.read_text().replace("[joints.J2]\n", f"[joints.J2]\neffort = {effort}\n"))
