"""Programs with the robot, the rack and the cell of the example with a tool changer, for tests of tools."""

from functools import cache
from pathlib import Path

from conftest import EXAMPLES
from programs import compiled, planned

from yarclang.diagnostics import Result
from yarclang.pipeline.cells import cell_loader
from yarclang.robot.description import load_robot

CELL = (EXAMPLES / "29_tool_changer.toml").read_text()
HEAD = """CELL "cell.toml"
DEFAULT {FLANGE} [60%] (mm,deg,s) {B}
START READY
INPUT GOOD M21
FRAME {G} -150 0 0 0 0 0 {RACK}
FRAME {S} 150 0 0 0 0 0 {RACK}
"""
OVER = "MOVEJ_RPY 0 -200 0 0 0 0 {%s}"
IN = "MOVEL 0 0 0 0 0 0 [2] {%s}"
OUT = "MOVEL 0 -200 0 0 0 0 [2] {%s}"


@cache
def robot():
    return load_robot(str(EXAMPLES / "29_tool_changer.robot.toml")).value


def lines(*parts):
    """Return lines of a program from single lines and nested lists, with added indices."""
    found = []
    for one in parts:
        found += lines(*one) if isinstance(one, list | tuple) else [one]
    return found


def text_of(*parts):
    words = ("WHEN", "ELSE", "END", "LOOP", "UNTIL", "REPEAT", "SUB", "OUTPUT", "REGISTER")
    numbered = [
        line if line.startswith(words) else f"P{10 * at:04d} {line}"
        for at, line in enumerate(lines(*parts), 1)
    ]
    return HEAD + "\n".join(numbered) + "\n"


def take(name):
    """Return the lines that take a tool from its place."""
    place = name[0]
    return [OVER % place, IN % place, f"TOOL {name}", OUT % place]


def put(name):
    """Return the lines that put a tool back into its place."""
    place = name[0]
    return [OVER % place, IN % place, "TOOL NONE", OUT % place]


def written(folder, changes):
    text = CELL
    for old, new in changes.items():
        assert old in text, old
        text = text.replace(old, new)
    (Path(folder) / "cell.toml").write_text(text)


def made(folder, *parts, changes=None, arm=None, plan=False):
    """Compile a program of parts in the cell, with `changes` in the cell's text."""
    written(folder, changes or {})
    arm = arm or robot()
    text = parts[0] if len(parts) == 1 and isinstance(parts[0], str) and "\n" in parts[0] else text_of(*parts)
    return Result(*(planned if plan else compiled)(text, arm, load_cell=cell_loader(Path(folder), arm)))


def errors(result):
    return [one for one in result.diagnostics if one.is_error]
