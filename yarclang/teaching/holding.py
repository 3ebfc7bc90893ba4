"""The meaning of a line of a program: the values from DEFAULT that are in force in the line (units, frames,
times), the frames that its names stand for, and the poses of these frames.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from yarclang.pipeline.inputs import Options, open_source
from yarclang.pipeline.stages import Request, context_of
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.robot.model import Array, Robot
from yarclang.runtime.actions import Trouble
from yarclang.semantics.control.unroll import declared_names
from yarclang.semantics.names.scope import Frame, Scope
from yarclang.semantics.values.units import joint_kinds
from yarclang.source import SourceFile
from yarclang.syntax.ast import Statement, Word
from yarclang.teaching.edits import Program
from yarclang.transforms import roll_pitch_yaw
from yarclang.units import DEG, MM, UNITS, Kind, number_text

_FINEST: Mapping[Kind, float] = {"length": 0.01 * MM, "angle": 0.001 * DEG}
"""Resolution of the last digit of a taught number [m or rad], by kind."""

_DIGITS_OF_QUATERNION = 7


@dataclass(frozen=True, slots=True)
class Holding:
    """Values from DEFAULT that are in force in a line, so that the line may omit them.

    Attributes:
        moving: moving frame, without braces; empty if the line must name one.
        base: base frame, without braces; empty if the line must name one.
        time: motion time as written within the brackets; empty if the line must give one.
        units: names of the units that DEFAULT gives, by kind.
    """

    moving: str
    base: str
    time: str
    units: Mapping[Kind, str]

    def unit(self, kind: Kind) -> str:
        """Return the unit in which values of a kind are written."""
        return self.units.get(kind, {"length": "mm", "angle": "deg", "time": "s"}[kind])


def holding(program: Program, line: int, *, declares: bool = False) -> Holding:
    """Return the values from DEFAULT that are in force in a line.

    Args:
        program: the program.
        line: number of the line. For a command, DEFAULT may also be below the line.
        declares: True for the line of a declaration.
    """
    default = program.sketch.default
    if default is None:
        return Holding("", "", "", {})
    if declares and default.line >= line:
        return Holding(default.moving.name if default.moving else "", "", "", {})
    return Holding(
        default.moving.name if default.moving else "",
        default.base.name if default.base else "",
        program.content(default.line + default.time.place.row)[
            default.time.place.start : default.time.place.end - 2
        ].strip()
        if default.time
        else "",
        units_of(default),
    )


def units_of(statement: Statement) -> dict[Kind, str]:
    """Return the units that a statement names, by kind."""
    items = statement.units.items if statement.units else ()
    named = [UNITS.get(one.text.lower()) for one in items if isinstance(one, Word)]
    return {unit.kind: unit.name for unit in named if unit is not None}


@dataclass(frozen=True, slots=True)
class Around:
    """A program with its robot, and with the frames, signals and positions that its names stand for.

    Attributes:
        program: the program.
        robot: robot of the program.
        request: the settings for compiling the program.
        scope: meanings of the names outside of blocks.
    """

    program: Program
    robot: Robot
    request: Request
    scope: Scope

    def frame(self, name: str, line: int, *, moves: bool) -> Frame:
        """Return the frame that a name stands for in a line.

        Args:
            name: name without braces.
            line: number of the line; for the end of the program, the number of lines plus one.
            moves: True if the frame must move with the robot; False if it must be stationary.

        Raises:
            Trouble: the frame's pose isn't known.
        """
        symbol = self.program.sketch.names.meant(name, True, line)
        if symbol is not None and symbol.kind == "parameter":
            what = f"{{{name}}} is a parameter of {symbol.inside}: its pose depends on the CALL"
            raise Trouble(what, "teach outside of the SUB, or in another frame", "frame")
        if symbol is not None and not self._is_outside(symbol.statement):
            what = (
                f"{{{name}}} is declared in a block, in line {symbol.span.line}: it may be another one in "
                "each round"
            )
            raise Trouble(what, "teach in a frame that is declared outside of blocks", "frame")
        found = self.scope.frame(name)
        declared = self.program.sketch.names.declared(name, True)
        if symbol is None and declared is not None and declared.span.line >= line:
            what = f"{{{name}}} is declared only below, in line {declared.span.line}"
            raise Trouble(what, "move the declaration above this line", "frame")
        if found is None:
            what = f"the frame {{{name}}} can't be resolved: no frame of this name can be read"
            raise Trouble(what, "check its declaration, the CELL line and the modules", "frame")
        if found.on_flange != moves:
            what = (
                f"{{{name}}} {'stands still: it is' if moves else 'moves with the robot: it is'} no "
                f"{'moving' if moves else 'base'} frame"
            )
            raise Trouble(what, "name another frame in the line or DEFAULT", "frame")
        return found

    def _is_outside(self, statement: Statement) -> bool:
        return any(one is statement for one in self.program.sketch.nodes)

    def pose(self, joints: Array, moving: str, base: str, line: int) -> Array:
        """Return the pose of a moving frame in a base frame, base_from_moving (4, 4) [m], at joint positions.

        Args:
            joints: (n,) joint positions [rad or m].
            moving: the moving frame.
            base: the base frame.
            line: number of the line that names both frames.

        Raises:
            Trouble: one of the frames isn't known in the line.
        """
        tool, axes = self.frame(moving, line, moves=True), self.frame(base, line, moves=False)
        stands: Array = flange_poses(self.robot.chain, joints[None])[0] @ tool.transform
        return np.asarray(np.linalg.inv(axes.transform) @ stands)

    @property
    def tool(self) -> str:
        """Return the name of the moving frame of a motion that names none: TCP if the robot has this
        frame, otherwise FLANGE.
        """
        return "TCP" if "TCP" in self.robot.flange_from_frame else "FLANGE"


def around(program: Program, folder: Path, robot: Robot) -> Around:
    """Find what the names of a program stand for. Motions aren't planned, and errors in motions are ignored.

    Args:
        program: the program.
        folder: the program's folder.
        robot: the connected robot.

    Raises:
        Trouble: the program is for another robot, or can't be opened.
    """
    source, module = program.source, program.sketch.module
    if not module.statements and not module.unreadable_lines:
        # A text without statements can't be opened: open one that declares no names instead.
        source = SourceFile(source.name, "DEFAULT {FLANGE}\n")
    opened = open_source(source, folder, Options())
    if opened.value is None:
        opened = open_source(source, folder, Options(robot=str(robot.file)))
    if opened.value is None:
        first = opened.diagnostics[0]
        where = f" in line {first.span.line}" if first.span else ""
        raise Trouble(f"the program can't be opened: {first.message}{where}", first.help, first.code)
    request = opened.value.request
    if request.robot.fingerprint != robot.fingerprint:
        what = f"the program is for {request.robot.name}, and this robot is {robot.name}"
        raise Trouble(what, "teach at the robot that the ROBOT line or yarc.toml names", "robot")
    return Around(program, request.robot, request, declared_names(opened.value.module, context_of(request)))


def joint_numbers(robot: Robot, joints: Array, units: Mapping[Kind, str]) -> list[str]:
    """Return joint positions as texts for a program, within the robot's limits.

    Args:
        robot: the robot.
        joints: (n,) joint positions [rad or m].
        units: units of the texts, by kind.
    """
    numbers = []
    for at, (kind, value) in enumerate(zip(joint_kinds(robot), joints.tolist(), strict=True)):
        unit = units[kind]
        factor, digits = UNITS[unit].factor, _digits(kind, unit) + (kind == "length")
        lower, upper = float(robot.limits.lower[at]) / factor, float(robot.limits.upper[at]) / factor
        step = 10.0**-digits
        shown = round(value / factor, digits)
        if shown > upper + 1e-9 and value / factor <= upper + step:
            shown = math.floor(upper / step + 1e-6) * step
        elif shown < lower - 1e-9 and value / factor >= lower - step:
            shown = math.ceil(lower / step - 1e-6) * step
        numbers.append(number_text(shown, digits))
    return numbers


def pose_numbers(pose: Array, units: Mapping[Kind, str], *, quaternion: bool = False) -> list[str]:
    """Return a pose as texts for a program: x y z roll pitch yaw, or x y z qx qy qz qw.

    Args:
        pose: (4, 4) the pose [m].
        units: units of the texts, by kind.
        quaternion: True to write the orientation as a quaternion.
    """
    place = position_numbers(pose[:3, 3], units)
    if quaternion:
        return [*place, *(number_text(one, _DIGITS_OF_QUATERNION) for one in quaternion_of(pose[:3, :3]))]
    unit = units["angle"]
    angles = roll_pitch_yaw(pose[:3, :3]) / UNITS[unit].factor
    return [*place, *(number_text(one, _digits("angle", unit)) for one in angles.tolist())]


def position_numbers(position: Array, units: Mapping[Kind, str]) -> list[str]:
    """Return a position (3,) [m] as texts for a program."""
    unit = units["length"]
    return [number_text(one, _digits("length", unit)) for one in (position / UNITS[unit].factor).tolist()]


def quaternion_of(rotation: Array) -> list[float]:
    """Return the unit quaternion x y z w of a rotation (3, 3), with w >= 0."""
    from scipy.spatial.transform import Rotation

    found: list[float] = Rotation.from_matrix(rotation).as_quat(canonical=True).tolist()
    return found


def _digits(kind: Kind, unit: str) -> int:
    """Return the number of decimal places with which taught numbers in a unit are written."""
    return max(0, math.ceil(-math.log10(_FINEST[kind] / UNITS[unit].factor) - 1e-9))
