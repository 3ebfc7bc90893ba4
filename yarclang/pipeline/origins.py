"""The program that a controller text was made from: found again by its name, and known again by what it does.

The text's header has the program's file name and a hash of what the program does. A file of that name, beside the text or in the working
folder, is that program if it does the same; comments and layout may have changed meanwhile.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from yarclang.hir import Gap, Origin, Program
from yarclang.identity import fingerprint
from yarclang.pipeline.inputs import Options, open_program
from yarclang.pipeline.line_map import Listed, map_lines
from yarclang.pipeline.stages import check_program
from yarclang.robot.model import Robot

_START = re.compile(r"^; start (\S+) \(", re.MULTILINE)
_AXIS = re.compile(r"[A-Z](-?\d+(?:\.\d+)?)")


@dataclass(frozen=True, slots=True, eq=False)
class Origins:
    """Where the commands of a text come from: `program`, or, where it is None, `missing`: why it isn't known."""

    program: Program | None
    missing: str = ""

    def of(self, index: str, name: str, source_line: int) -> Origin | None:
        """The origin of a command by its place, its name and the line that the text gives it; None where it isn't known.

        The line decides only between commands that are called the same.
        """
        if self.program is None:
            return None
        found = [
            step.origin
            for step in self.program.steps
            if not isinstance(step, Gap)
            and (step.origin.label or "-", step.origin.name) == (index or "-", name)
        ]
        return next((one for one in found if one.span.line == source_line), found[0] if found else None)

    def of_listed(self, listed: Listed) -> Origin | None:
        """The origin of a command of the text's own map."""
        return self.of(listed.index, listed.name, listed.source_line)


def origins_of_text(text: str, folder: Path, robot: Robot, source: str | None = None) -> Origins:
    """Look for the program of a controller text.

    Args:
        text: that yarcc has written.
        folder: where it is.
        robot: whom it is for.
        source: the program's file, if somebody says which it is.
    """
    mapped = map_lines(text)
    name = mapped.program
    if source is None and (not name or "/" in name or name == "<stdin>"):
        return Origins(None, "the text doesn't say which file its program is")
    tried = [folder / name, Path(name)] if source is None else [Path(source)]
    places = [place for place in tried if place.is_file()]
    if not places:
        return Origins(None, f"{tried[0]}, the program, isn't there")
    for place in places:
        for start in (None, _start(text, robot)):
            program = _program(str(place), robot, start)
            if program is not None and fingerprint(program) == mapped.fingerprint:
                return Origins(program)
    return Origins(
        None, f"{places[0]} does something else than this text: the source has changed, or is another one"
    )


def _program(path: str, robot: Robot, start: tuple[float, ...] | None) -> Program | None:
    """A program as it is checked for a robot; None where it can't be read."""
    opened = open_program(path, Options(robot=str(robot.folder / "robot.toml"), start=start))
    if opened.value is None:
        return None
    return check_program(opened.value.module, opened.value.request).value


def _start(text: str, robot: Robot) -> tuple[float, ...] | None:
    """Where the text says that the robot stands at first [deg or mm]."""
    found = _START.search(text)
    values = tuple(float(one) for one in _AXIS.findall(found[1])) if found else ()
    return values if len(values) == robot.size else None


def origin_text(origin: Origin) -> str:
    """`file.yarc:12`."""
    return f"{origin.source.name}:{origin.span.line}"
