"""Positions that programs have taught while they ran (JPOS, LPOS). They are stored in the database of KEPT
registers.
"""

from __future__ import annotations

import sqlite3

import numpy as np

from yarclang.collision.zones.watched import tool_frame
from yarclang.coordinator.kept_registers import deleted, opened, registers_file, unreadable
from yarclang.frozen import frozen
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.model import Array, Robot
from yarclang.runtime.actions import Teach
from yarclang.transforms import roll_pitch_yaw
from yarclang.units import DEG, MM

_TABLE = (
    "CREATE TABLE IF NOT EXISTS taught (controller TEXT NOT NULL, program TEXT NOT NULL, name TEXT NOT NULL, "
    "line TEXT NOT NULL, PRIMARY KEY (controller, program, name))"
)


@frozen
class Place:
    """The last position that was taught under a name, as the program line that declares it."""

    controller: str
    program: str
    name: str
    line: str


def line_of(robot: Robot, teaches: str, name: str, joints: Array) -> str:
    """Return the line of a program that declares a taught position.

    Args:
        robot: the robot.
        teaches: what is taught: `joints`, or `pose` for the pose of {TCP} in {B} (of {FLANGE} if there is no
            {TCP}).
        name: name of the position.
        joints: joint positions of the robot (n,) [rad or m].
    """
    if teaches == "joints":
        values = joints / robot.axis_units
        units = ",".join(dict.fromkeys(robot.axis_unit_names))
        return f"JOINTS {name} {_numbers(values)} ({units})"
    moving = tool_frame(robot)
    pose = tool_poses(robot.chain, np.asarray(joints)[None], moving.flange_from_moving)[0]
    values = np.append(pose[:3, 3] / MM, roll_pitch_yaw(pose[:3, :3]) / DEG)
    return f"POSE {name} {_numbers(values)} (mm,deg) {{B}}"


def _numbers(values: Array) -> str:
    return " ".join(f"{value:.4f}".rstrip("0").rstrip(".") for value in np.round(values, 4) + 0.0)


def teach(robot: Robot, controller: str, program: str, wanted: Teach) -> str:
    """Store a taught position. When this returns, the position is on the disk.

    Args:
        robot: the robot.
        controller: name of the robot and address of the controller. A simulated controller stores taught
            positions of its own.
        program: name of the program, from `yarclang.coordinator.kept_registers.program_of`.
        wanted: the position.

    Returns:
        The line of a program that declares the position.

    Raises:
        OSError: the position can't be stored.
    """
    line, place = line_of(robot, wanted.teaches, wanted.name, wanted.joints), registers_file()
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        with opened(place) as base, base:
            base.execute(_TABLE)
            row = controller, program, wanted.name, line
            base.execute("INSERT OR REPLACE INTO taught VALUES (?, ?, ?, ?)", row)
    except (sqlite3.Error, OSError) as error:
        raise OSError(f"{place}: {error}") from None
    return line


def places(program: str = "") -> list[Place]:
    """Return the taught positions of a program (empty: of all programs), sorted by controller, program and
    name of the position.

    Raises:
        Trouble: the database can't be read.
    """
    place = registers_file()
    if not place.exists():
        return []
    try:
        with opened(place) as base:
            base.execute(_TABLE)
            rows = base.execute(
                "SELECT controller, program, name, line FROM taught WHERE (? = '' OR program = ?) "
                "ORDER BY controller, program, name",
                (program, program),
            ).fetchall()
        return [Place(*map(str, row)) for row in rows]
    except (sqlite3.Error, OSError) as error:
        raise unreadable(place, error) from None


def forget(program: str) -> int:
    """Delete the taught positions of a program, for all controllers. Return the number of deleted positions.

    Raises:
        Trouble: the database can't be read or written.
    """
    return deleted(_TABLE, "DELETE FROM taught WHERE program = ?", program)
