"""Preparation of a live motion: its settings, its judge, and its generator."""

from __future__ import annotations

from dataclasses import dataclass

from yarclang.backend import backend_of
from yarclang.cell.model import Cell
from yarclang.collision.scene import scene_of
from yarclang.collision.zones.watched import Moving
from yarclang.coordinator.live.generator import Generator, rates_of
from yarclang.coordinator.live.proof import Judge, surroundings_of
from yarclang.coordinator.live.steering import Steering
from yarclang.diagnostics import Diagnostic, Result
from yarclang.handling.present import around_start
from yarclang.robot.model import Array, Robot
from yarclang.runtime.live import Live
from yarclang.units import MS

SEGMENT = 10.0 * MS
"""Segment time of live motions [s]."""


@dataclass(frozen=True, slots=True)
class Settings:
    """Settings of a live motion: the largest `speed` of the tool [m/s] (None: the robot's `jog_speed`), the
    `share` of the joints' velocity limits that may be used, and the segment time [s].
    """

    speed: float | None = None
    share: float = 1.0
    segment: float = SEGMENT


def live_motion(
    robot: Robot, position: Array, moving: Moving, cell: Cell | None, settings: Settings, name: str
) -> Result[tuple[Live, Generator]]:
    """Prepare a live motion from the robot's present position.

    The motion doesn't begin with a RAPID to a printed start position, because a RAPID takes the motors'
    acceleration time even for a tiny distance.

    Args:
        robot: the robot.
        position: (n,) commanded position of the robot, as reported by the controller [rad or m].
        moving: frame of the tool.
        cell: the cell around the robot, with its parts at their present places.
        settings: settings of the motion.
        name: name of the motion, for messages.

    Returns:
        The motion and its generator; a finding instead if the cell can't be read, or doesn't allow any
        motion.
    """
    around = surroundings_of(robot, around_start(cell), moving)
    if around.value is None:
        return Result(None, around.diagnostics)
    writing = backend_of(robot).live()
    if writing is None:
        message = "this kind of controller doesn't support live motions"
        return Result(None, (Diagnostic("Y1616", message, help="move the robot by commands"),))
    speed = robot.jog_speed if settings.speed is None else settings.speed
    segment = max(settings.segment, robot.controller.smallest_segment)
    decimals = writing.decimals(robot, segment)
    tool = moving.flange_from_moving
    leaves = cell is not None and cell.present is not None and bool(cell.present.leaving)
    strict = scene_of(robot, around_start(cell, touching=False)).value if leaves else None
    judge = Judge(robot, position, segment, speed, tool, *around.value, strict=strict, points=writing.points)
    (stands,) = writing.lines(robot, position[None], decimals)
    # Check a text that moves the robot only to the nearest position that can be printed exactly, and ends
    # there at rest. If even this text can't be proved, no live motion can begin here.
    if objection := judge.objection((stands,) * 3, ()):
        message = f"no live motion can begin at the robot's position: {objection}"
        return Result(None, (Diagnostic("Y1616", message, help="move the robot away by a command"),))
    rates = rates_of(robot, settings.share)
    steering = Steering(robot, tool, rates, speed)
    generator = Generator(
        robot,
        position,
        lambda points: writing.lines(robot, points, decimals),
        segment,
        steering,
        judge,
        rates,
    )
    live = writing.motion(robot, position, judge.slack, segment, decimals, name, generator)
    return Result((live, generator), around.diagnostics)
