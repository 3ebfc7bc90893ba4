"""The process that finds the programs with errors under a draft (unsaved changes of cell.toml or robot.toml).
It reads its question from standard input, and writes one line of JSON for each result.

It writes no files. The texts of the draft are read instead of the files that it changes.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from yarclang.cell.description import Names, read_cell
from yarclang.cell.model import Cell
from yarclang.collision.scene import scene_of
from yarclang.collision.zones.watched import tool_frame
from yarclang.collision.zones.workspace import broken_at
from yarclang.diagnostics import Diagnostic
from yarclang.pipeline.cells import file_of
from yarclang.pipeline.checking import Checked, check_file
from yarclang.pipeline.inputs import Options, robot_for
from yarclang.report.clearance import touching
from yarclang.robot.model import Array, Robot
from yarclang.semantics.declared.meanings import is_word
from yarclang.source import SourceFile
from yarclang.units import MM

_NOTHING = "Y0104"
"""Code of the finding for a file without a command. Such a file is a module, and is checked together with the
programs that call it.
"""


def main() -> None:
    """Carry out one check: read the question from standard input and write the results to standard output."""
    asked = json.load(sys.stdin)
    out = sys.stdout
    for told in answers(asked):
        out.write(json.dumps(told) + "\n")
        out.flush()


def answers(request: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield the problems that the draft causes at the robot's present position, and then the result for each
    program.

    Args:
        request: a mapping with `folder` and `files` of the project, `robot`, `cell` (path of the session's
            cell, or null), `drafts` (changed text by path of the file), and `joints` (present joint positions
            (n,) [rad or m], or null).
    """
    drafts = {Path(path): SourceFile(path, text) for path, text in request["drafts"].items()}
    before = Options(robot=request["robot"], cell=request["cell"])
    after = replace(before, texts=drafts)
    yield {"standing": list(_standing(request, after))}
    for number, file in enumerate(request["files"]):
        yield {"at": number}
        yield {"file": file, **_judged(str(Path(request["folder"]) / file), before, after)}
    yield {"done": True}


def _judged(path: str, before: Options, after: Options) -> dict[str, Any]:
    """Return the result for a program.

    `held` and `holds` are True if the program has no errors without and with the draft. The other keys
    describe its first error with the draft. The mapping is empty for a module, and for a program without
    errors that the draft doesn't affect.
    """
    now = check_file(path, after)
    if any(one.code == _NOTHING for one in now.diagnostics):
        return {}
    error = next((one for one in now.diagnostics if one.is_error), None)
    if error is None:
        return {"held": None, "holds": True} if _matters(now, after) else {}
    held = not any(one.is_error for one in check_file(path, before).diagnostics)
    return {"held": held, "holds": False, **_messages(error)}


def _matters(checked: Checked, options: Options) -> bool:
    """Return True if a program moves the robot and depends on a text of the draft."""
    if checked.plan is None or not checked.plan.motions:
        return False
    files = {file_of(one) for one in options.texts}
    cell = None if checked.program is None else checked.program.cell
    if cell is not None and file_of(Path(cell.source.name).absolute()) in files:
        return True
    robot = None if checked.opened is None else checked.opened.request.robot
    return robot is not None and file_of(robot.file.absolute()) in files


def _messages(error: Diagnostic) -> dict[str, Any]:
    return {
        "line": None if error.span is None else error.span.line,
        "code": error.code,
        "message": error.message[:400],
    }


def _standing(request: Mapping[str, Any], options: Options) -> Iterator[str]:
    """Yield the problems that the robot has at its present position with the draft, in words."""
    if request["joints"] is None:
        yield "the robot's position is unknown"
        return
    q = np.array(request["joints"], dtype=float)
    robot = robot_for(Path(request["folder"]), request["robot"], options.texts).value
    if robot is None or robot.size != len(q):
        return
    described = file_of(robot.file.absolute())
    drafted = next((text for path, text in options.texts.items() if file_of(path) == described), None)
    if drafted is not None:
        from yarclang.robot.description import read_robot

        robot = read_robot(drafted, robot.folder).value or robot
    yield from beyond_limits(robot, q)
    named = next((text for path, text in options.texts.items() if file_of(path) != described), None)
    cell = None if named is None else read_cell(named, Path(named.name).parent, Names(is_word, robot)).value
    if cell is not None:
        yield from in_the_way(robot, cell, q)


def beyond_limits(robot: Robot, q: Array) -> Iterator[str]:
    """Yield, in words, which joints are beyond their limits at joint positions (n,) [rad or m], and by how
    much.
    """
    excess = np.maximum(robot.limits.lower - q, q - robot.limits.upper) / robot.axis_units
    for name, by, unit in zip(robot.joint_names, excess, robot.axis_unit_names, strict=True):
        if by > 1e-6:
            yield f"{name} is {by:.4g} {unit} beyond its limits"


def in_the_way(robot: Robot, cell: Cell, q: Array) -> Iterator[str]:
    """Yield, in words, which zones and margins of a cell the robot violates at joint positions (n,) [rad
    or m].
    """
    told = set()
    for watch, slack in broken_at(robot, cell, tool_frame(robot), q):
        item = "the joints" if watch.item is None else watch.item.name
        if (watch.zone.name, item) not in told:
            told.add((watch.zone.name, item))
            by = "" if watch.item is None else f" by {-slack / MM:.1f} mm"
            yield f"{item} violates the zone {watch.zone.name}{by}"
    scene = scene_of(robot, cell).value
    if scene is not None and (names := sorted(touching(scene, q))):
        yield f"{', '.join(names[:6])} are closer to each other than their margins"


if __name__ == "__main__":
    main()
