"""Find the source program of a controller text by its file name, and check it by a hash of its actions.

The header of the controller text has the file name and the hash. A file with that name, beside the text or in
the working folder, is the source program if its actions have this hash. Its comments and layout may have
changed.
"""

from __future__ import annotations

import re
from pathlib import Path

from yarclang.certify.read.header import header_of
from yarclang.certify.read.text import Unreadable
from yarclang.consulted import is_file
from yarclang.emitted.header import Header
from yarclang.emitted.purposes import Listed
from yarclang.frozen import frozen
from yarclang.hir import Gap, Origin, Program
from yarclang.identity import fingerprint
from yarclang.pipeline.inputs import Options, open_program
from yarclang.pipeline.stages import check_program
from yarclang.robot.model import Robot

_VALUE = r"(-?\d+(?:\.\d+)?)"


@frozen(eq=False)
class Origins:
    """The source program of a controller text, in which the text's commands can be looked up. If it wasn't
    found, `program` is None and `missing` is the reason.
    """

    program: Program | None
    missing: str = ""

    def of(self, index: str, name: str, source_line: int) -> Origin | None:
        """Find the source of a command that a controller text lists, by the command's place, name and source
        line; None if there is none.

        The line is used only to choose among commands with the same place and name.
        """
        if self.program is None:
            return None
        matches = [
            step.origin
            for step in self.program.steps
            if not isinstance(step, Gap)
            and (step.origin.label or "-", step.origin.name) == (index or "-", name)
        ]
        return next((one for one in matches if one.span.line == source_line), matches[0] if matches else None)

    def of_listed(self, listed: Listed) -> Origin | None:
        """Return the origin of a command that the map in the header of the controller text lists."""
        return self.of(listed.index, listed.name, listed.source_line)


def origins_of_text(
    text: str, folder: Path, robot: Robot, source: str | None = None, cell: str | None = None
) -> Origins:
    """Look for the program from which a controller text was compiled.

    Args:
        text: a text of yarcc.
        folder: folder of the text.
        robot: robot that the text is for.
        source: the program's file, if it is given.
        cell: path of a cell.toml, if the program was compiled with one.
    """
    preamble = header_of(text)
    if isinstance(preamble, Unreadable):
        return Origins(
            None, f"the text was changed after yarcc wrote it: line {preamble.line} {preamble.reason}"
        )
    header, name = preamble.header, preamble.header.source
    if source is None and (not name or "/" in name or name == "<stdin>"):
        return Origins(None, "the text doesn't name its program's file")
    tried = [folder / name, Path(name)] if source is None else [Path(source)]
    places = [place for place in tried if is_file(place)]
    if not places:
        return Origins(None, f"{tried[0]}, the program, isn't there")
    for place in places:
        for start in (None, start_values(header, robot)):
            program = _program(str(place), robot, start, cell)
            if program is not None and fingerprint(program) == header.program_fingerprint:
                return Origins(program)
    return Origins(None, f"{places[0]} differs from this text: the source has changed, or is another program")


def _program(path: str, robot: Robot, start: tuple[float, ...] | None, cell: str | None) -> Program | None:
    """Return a program, checked for a robot; None if it can't be read."""
    opened = open_program(path, Options(robot=str(robot.file), start=start, cell=cell))
    if opened.value is None:
        return None
    return check_program(opened.value.module, opened.value.request).value


def start_values(header: Header, robot: Robot) -> tuple[float, ...] | None:
    """Return the joint position at which a controller text starts, from its header [deg or mm]; None if it
    isn't a position of this robot.
    """
    form = "".join(re.escape(axis) + _VALUE for axis in robot.controller.axes)
    found = re.fullmatch(form, header.start)
    return None if found is None else tuple(float(one) for one in found.groups())
