"""Frames that users can drag in the picture, and the program lines that would declare the dragged frames."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from yarclang.hir import FrameLink, Gap, Program
from yarclang.report.pose_text import pose_values
from yarclang.robot.model import Array, Robot
from yarclang.source import SourceFile
from yarclang.transforms import quaternion_rotation

NEW = "NEW"
"""Name of a new frame. If the program or the cell has a frame with this name, a number is appended."""

_DIGITS = (4, 5)
"""Numbers of decimals of lengths [mm] and angles [deg]."""


@dataclass(frozen=True, slots=True, eq=False)
class Draggable:
    """A frame that users can drag: one that a file declares, or a new one.

    Attributes:
        name: name without braces.
        parent: name of the frame in which the declaration gives the pose.
        joint: number of joints that move the frame, counted from the base.
        base_from_parent: (4, 4) pose of the parent with all joints at zero.
        parent_from_frame: (4, 4) pose as declared.
        source: file that declares the frame; empty for a new frame.
        line: line of the declaration in this file; 0 for a new frame.
    """

    name: str
    parent: str
    joint: int
    base_from_parent: Array
    parent_from_frame: Array
    source: str = ""
    line: int = 0

    @property
    def base_from_frame(self) -> Array:
        """Return the frame's declared pose (4, 4) in {B}, with all joints at zero."""
        placed: Array = self.base_from_parent @ self.parent_from_frame
        return placed

    @property
    def in_cell(self) -> bool:
        """Return True if a cell.toml declares the frame. The declaration is then a table."""
        return self.source.endswith(".toml")

    def moved_to(self, position: Array, wxyz: Array) -> Array:
        """Return the pose parent_from_frame (4, 4) of the frame after it was dragged. The arguments are its
        new pose in {B} with all joints at zero.

        Args:
            position: (3,) [m].
            wxyz: rotation as a quaternion w x y z.
        """
        base_from_frame = np.eye(4)
        base_from_frame[:3, :3] = quaternion_rotation(np.roll(wxyz, -1))
        base_from_frame[:3, 3] = position
        moved: Array = np.linalg.inv(self.base_from_parent) @ base_from_frame
        return moved

    def declaration(self, parent_from_frame: Array) -> str:
        """Return the text that declares the frame at a new pose in its parent: a program line, or a table of
        a cell.toml.
        """
        values = pose_values(parent_from_frame)
        numbers = [_number(value, _DIGITS[place >= 3]) for place, value in enumerate(values.tolist())]
        if not self.in_cell:
            return f"FRAME {{{self.name}}} {' '.join(numbers)} (mm,deg) {{{self.parent}}}"
        place, turn = ", ".join(numbers[:3]), ", ".join(numbers[3:])
        return (
            f"[frames.{self.name}]\n"
            f'parent = "{self.parent}"\n'
            'units = "mm,deg"\n'
            f"xyz = [{place}]\n"
            f"rpy = [{turn}]"
        )


def draggables_of(robot: Robot, program: Program, base_from_new: Array) -> tuple[Draggable, ...]:
    """Return the frames that users can drag: those that a program's commands use and a file declares, and a
    new frame in {B}.

    A frame is left out if its line is executed several times with different poses, as in a loop. No single
    line could declare its new pose.

    Args:
        robot: the robot.
        program: the program.
        base_from_new: (4, 4) pose of the new frame.
    """
    found: dict[tuple[str, str, int], Draggable | None] = {}
    for link, parent, source, line in _declared(program):
        key = (link.name, source.name, line)
        one = _draggable(robot, link, parent, source, line)
        before = found.get(key, one)
        same = before is not None and np.allclose(before.base_from_frame, one.base_from_frame, atol=1e-9)
        found[key] = one if same else None
    kept = tuple(one for one in found.values() if one is not None)
    taken = {one.name for one in kept} | set(program.cell.frames if program.cell is not None else ())
    taken |= {name for name, _, _ in found} | set(robot.flange_from_frame)
    taken |= set(re.findall(r"\w+", program.source.text)) & {
        f"{NEW}{number}" for number in ("", *range(2, 100))
    }
    name = next(name for number in ("", *range(2, 1000)) if (name := f"{NEW}{number}") not in taken)
    return (*kept, Draggable(name, "B", 0, np.eye(4), base_from_new))


def _declared(program: Program) -> Iterable[tuple[FrameLink, FrameLink, SourceFile, int]]:
    """Yield the frames that a program's commands use and a file declares, each with its parent, file and
    line.
    """
    done: set[int] = set()
    for step in program.steps:
        if isinstance(step, Gap):
            continue
        for link in (step.origin.moving, step.origin.base, step.origin.tool):
            here = link
            while here is not None and here.parent is not None and id(here) not in done:
                done.add(id(here))
                if here.source is not None and here.span is not None:
                    yield here, here.parent, here.source, here.span.line
                here = here.parent


def _draggable(robot: Robot, link: FrameLink, parent: FrameLink, source: SourceFile, line: int) -> Draggable:
    pose, here = np.eye(4), parent
    while here.parent is not None:
        pose, here = here.parent_from_frame @ pose, here.parent
    on_flange = here.name == "FLANGE"
    return Draggable(
        link.name,
        parent.name,
        robot.size if on_flange else 0,
        robot.chain.base_from_flange @ pose if on_flange else pose,
        link.parent_from_frame,
        source.name,
        line,
    )


def _number(value: float, digits: int) -> str:
    text = f"{round(value, digits) + 0.0:.{digits}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text
