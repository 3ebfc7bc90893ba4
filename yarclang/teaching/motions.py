"""Taught motions: lines created from the robot's present position."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from yarclang.robot.kinematics.fk import flange_poses
from yarclang.robot.model import Array
from yarclang.runtime.actions import Trouble
from yarclang.semantics.names.scope import BASE
from yarclang.semantics.values.units import joint_kinds
from yarclang.teaching.before import blocks_around, flange_before
from yarclang.teaching.declaring import put_declaration, units_part
from yarclang.teaching.edits import Draft, Edited, Program
from yarclang.teaching.holding import (
    Around,
    Holding,
    holding,
    joint_numbers,
    pose_numbers,
    position_numbers,
)
from yarclang.teaching.indices import indentation, index_for, shown_index
from yarclang.units import Kind

Motion = Literal["MOVEJ", "MOVEL", "MOVEC", "DMOVE"]
Target = Literal["joints", "pose"]

_TIME = "50%"
"""Motion time if neither DEFAULT nor the user gives one."""

_HEADERS = ("ROBOT", "CELL", "DEFAULT", "START")


@dataclass(frozen=True, slots=True)
class Taught:
    """A motion that a user wants to teach.

    Attributes:
        motion: kind of the motion.
        target: kind of values in which the motion's end is written: joint values or a pose. For a Cartesian
            motion it is always a pose.
        via: (n,) joint positions at the point that MOVEC passes through [rad or m].
        name: name of a new POSE or JOINTS declaration for the end; empty to write the values into the line.
        axes: axes of a DMOVE: "base" for those of the line's base frame, "tool" for those of the moving
            frame.
        time: text in the square brackets; empty for the time of DEFAULT, or [50%] if DEFAULT gives none.
    """

    motion: Motion
    target: Target = "pose"
    via: Array | None = None
    name: str = ""
    axes: Literal["base", "tool"] = "base"
    time: str = ""


def teach(around: Around, after: int, taught: Taught, joints: Array) -> Edited:
    """Insert a motion that ends at the robot's present position.

    Args:
        around: the program.
        after: number of the line after which the motion is inserted; 0 is the beginning.
        taught: the motion.
        joints: (n,) present joint positions [rad or m].

    Raises:
        Trouble: the motion can't be taught there; the message is the reason.
    """
    program = around.program
    if taught.target == "joints" and taught.motion != "MOVEJ":
        raise Trouble(
            f"{taught.motion} moves a frame to a pose", "teach it as a pose, or teach a MOVEJ", "target"
        )
    if taught.name and taught.motion == "DMOVE":
        raise Trouble(
            "a DMOVE moves by an increment, which can't be a named pose", "teach it without a name", "target"
        )
    draft = Draft(program)
    after = place_of_command(draft, after)
    holds = holding(program, after + 1)
    if taught.name:
        what = "joints" if taught.target == "joints" else "pose"
        put_declaration(draft, around, what, taught.name, joints, _outermost(program, after))
    maker = _Maker(around, holds, after)
    code = maker.line(taught, joints)
    number = index_for(draft, after)
    draft.add(after, f"{indentation(program, after)}{shown_index(number)} {code}")
    line = draft.new_line(after) + len(draft.added[after]) - 1
    return draft.finished(line, f"taught {shown_index(number)} {taught.motion} where the robot stands")


def place_of_command(draft: Draft, after: int) -> int:
    """Return the number of the line after which a new command is inserted if the user wants it after a given
    line.

    If the given line is within a statement of several lines, such as a list of waypoints, this is the
    statement's last line. Commands are inserted below ROBOT, CELL, DEFAULT and START.

    Args:
        draft: the changes; it receives a note if the command must be inserted elsewhere.
        after: number of the given line.

    Raises:
        Trouble: there is no such line.
    """
    program = draft.program
    if after:
        program.check_line(after)
    wanted, after = after, program.last_row(after) if after else 0
    headers = [
        one
        for one in program.sketch.module.statements
        if one.index is None and one.name.name in _HEADERS and one.line > wanted
    ]
    if headers:
        last = headers[-1]
        after = last.line + last.rows - 1
        draft.notes.append(f"it comes after {last.name.name}, which comes before all commands")
    return after


def _outermost(program: Program, after: int) -> int:
    """Return the number of the first line of the outermost block that is open after a line. If no block is
    open there, return the number of the next line.
    """
    return next((one.head.line for one in blocks_around(program.sketch.nodes, after)), after + 1)


class _Maker:
    """Writer of the lines of taught motions, which are as short as DEFAULT allows."""

    def __init__(self, around: Around, holds: Holding, after: int) -> None:
        self._around = around
        self._holds = holds
        self._after = after
        self._moving = holds.moving or around.tool
        self._base = holds.base or BASE

    def line(self, taught: Taught, joints: Array) -> str:
        """Return the program line of a taught motion, without an index such as P0030.

        Args:
            taught: the motion.
            joints: (n,) present joint positions [rad or m].
        """
        if taught.target == "joints":
            units: dict[Kind, str] = {}
            if taught.name:
                return self._joined(
                    "MOVEJ", taught.name.upper(), self._time(taught), *self._units(units, taught)
                )
            units = {kind: self._holds.unit(kind) for kind in joint_kinds(self._around.robot)}
            numbers = " ".join(joint_numbers(self._around.robot, joints, units))
            return self._joined("MOVEJ", numbers, self._time(taught), *self._units(units, taught))
        named = taught.name.strip("{} ").upper()
        units = {"length": self._holds.unit("length"), "angle": self._holds.unit("angle")}
        pose = self._around.pose(joints, self._moving, self._base, self._after + 1)
        values = named or " ".join(pose_numbers(pose, units))
        word: str = taught.motion
        base = "" if self._holds.base else self._base
        if taught.motion == "MOVEC":
            values = f"{self._via(taught, units, joints)}; {values}"
        elif named:
            units, base = {}, ""
        elif taught.motion == "MOVEJ":
            word = "MOVEJ_RPY"
        elif taught.motion == "DMOVE":
            values, base = self._increment(taught, units, joints)
        frame = "" if self._holds.moving else f"{{{self._moving}}}"
        end = f"{{{base}}}" if base else ""
        return self._joined(word, frame, values, self._time(taught), *self._units(units, taught), end)

    @staticmethod
    def _joined(*parts: str) -> str:
        return " ".join(filter(None, parts))

    def _units(self, units: dict[Kind, str], taught: Taught) -> tuple[str, ...]:
        """Return the units that the line has to name. A time in the line also needs a unit."""
        time = taught.time.upper()
        if time and time != "MIN" and not time.endswith("%"):
            units = {**units, "time": self._holds.unit("time")}
        return units_part(units, self._holds)

    def _time(self, taught: Taught) -> str:
        given = self._holds.time
        if taught.motion == "MOVEJ" and _is_speed(taught.time):
            help_ = "give a time, a share of the limits, or V<= and a speed that isn't exceeded"
            raise Trouble("MOVEJ moves joints, not a frame, and so has no speed", help_, "time")
        if taught.time:
            return f"[{taught.time}]"
        if not given or (taught.motion == "MOVEJ" and _is_speed(given)):
            return f"[{_TIME}]"
        return ""

    def _via(self, taught: Taught, units: dict[Kind, str], joints: Array) -> str:
        if taught.via is None:
            raise Trouble(
                "an arc also needs a via point",
                "move there, record it as the via point, then move to the end point",
                "via",
            )
        around, line = self._around, self._after + 1
        via = around.pose(taught.via, self._moving, self._base, line)
        end = around.pose(joints, self._moving, self._base, line)
        if float(np.linalg.norm(via[:3, 3] - end[:3, 3])) < 1e-6:
            raise Trouble("the via point is the end of the arc", "move on from the via point first", "via")
        return " ".join(position_numbers(via[:3, 3], units))

    def _increment(self, taught: Taught, units: dict[Kind, str], joints: Array) -> tuple[str, str]:
        """Return two texts: the increments of a DMOVE to the robot's present position, and the frame that the
        line has to name for its axes (empty if DEFAULT gives it).

        Args:
            taught: the motion.
            units: units of the increments, by kind.
            joints: (n,) present joint positions [rad or m].
        """
        around, line = self._around, self._after + 1
        tool = around.frame(self._moving, line, moves=True).transform
        stood = flange_before(around, self._after) @ tool
        stands = flange_poses(around.robot.chain, joints[None])[0] @ tool
        if taught.axes == "tool":
            axes, base = stood[:3, :3], self._moving
        else:
            axes = around.frame(self._base, line, moves=False).transform[:3, :3]
            base = "" if self._holds.base else self._base
        delta = np.eye(4)
        delta[:3, 3] = axes.T @ (stands[:3, 3] - stood[:3, 3])
        delta[:3, :3] = axes.T @ stands[:3, :3] @ stood[:3, :3].T @ axes
        return " ".join(pose_numbers(delta, units)), base


def _is_speed(time: str) -> bool:
    """Return True if a motion time is a speed to keep, and not a largest speed."""
    return time[:1].upper() == "V" and "<=" not in time
