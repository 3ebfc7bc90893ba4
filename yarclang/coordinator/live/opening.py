"""What stands in front of a live motion's lines: the rotary, its guard, the segment time; and who makes its lines."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from yarclang.backend_pmac.decimals import decimals_for
from yarclang.backend_pmac.emit import emit
from yarclang.backend_pmac.guard import watermarks
from yarclang.cell.model import Cell
from yarclang.collision.scene import scene_of
from yarclang.collision.zones.watched import Moving
from yarclang.coordinator.live.generator import Generator, rates_of
from yarclang.coordinator.live.proof import Judge, surroundings_of
from yarclang.coordinator.live.steering import Steering
from yarclang.diagnostics import Diagnostic, Result
from yarclang.handling.present import around_start
from yarclang.pmac.program import Assignment, PmacProgram, SegmentTime
from yarclang.pmac.variables import ARMED
from yarclang.robot.actuation import to_counts
from yarclang.robot.model import Array, Robot
from yarclang.runtime.job import Job
from yarclang.runtime.live import MADE_ON_THE_WAY, Live
from yarclang.units import MS

SEGMENT = 10.0 * MS
"""TM of live motions [s]."""

_LEAD = 12
"""Lines ahead beyond I16: what the host may be late by."""


@dataclass(frozen=True, slots=True)
class Settings:
    """How a live motion is made: `speed` of the tool at most [m/s] (None: the robot's `jog_speed`), `share` of the joints' velocity limits, the segment time [s]."""

    speed: float | None = None
    share: float = 1.0
    segment: float = SEGMENT


def live_motion(
    robot: Robot, here: Array, moving: Moving, cell: Cell | None, settings: Settings, name: str
) -> Result[tuple[Live, Generator]]:
    """A live motion from where the robot stands: no RAPID leads to a printed start, since that takes the motors' acceleration time, whatever the way.

    Args:
        robot: that moves.
        here: (n,) where it is commanded to stand [rad or m], as the controller tells it.
        moving: the tool.
        cell: what is around it, with its parts where they are.
        settings: how it is made.
        name: what it is called.

    Returns:
        A finding instead, where its surroundings can't be read, or don't let it move at all.
    """
    around = surroundings_of(robot, around_start(cell), moving)
    if around.value is None:
        return Result(None, around.diagnostics)
    speed = robot.jog_speed if settings.speed is None else settings.speed
    segment = max(settings.segment, robot.controller.smallest_segment)
    decimals = decimals_for(robot, segment, robot.tolerance)
    tool = moving.flange_from_moving
    leaves = cell is not None and cell.present is not None and bool(cell.present.leaving)
    strict = scene_of(robot, around_start(cell, touching=False)).value if leaves else None
    judge = Judge(robot, here, segment, speed, tool, *around.value, strict=strict)
    start = np.round(here / robot.axis_units, decimals) + 0.0
    stands = "".join(
        f"{axis}{value:.{decimals}f}" for axis, value in zip(robot.controller.axes, start, strict=True)
    )
    # the way to rest behind nothing: to the nearest place that can be printed
    if objection := judge.objection((stands,) * 3, ()):
        message = f"where the robot stands, no live motion can begin: {objection}"
        return Result(None, (Diagnostic("Y1616", message, help="move it away by a command"),))
    rates = rates_of(robot, settings.share)
    steering = Steering(robot, tool, rates, speed)
    generator = Generator(robot, here, decimals, segment, steering, judge, rates)
    marks = watermarks(robot, segment)
    program = PmacProgram(
        target="rotary",
        coordinate_system=robot.controller.coordinate_system,
        motors=robot.controller.motors,
        axes=robot.controller.axes,
        joint_names=robot.joint_names,
        decimals=decimals,
        start=start,
        start_counts=to_counts(robot, start * robot.axis_units),
        start_slack=np.zeros(robot.size),
        rotary_words=marks.words,
        full_lines=marks.low + 5,
        low_lines=marks.low,
        body=(SegmentTime(segment / MS), Assignment(ARMED, 1.0)),
        commands=(),
        rapid=False,
    )
    emitted = emit(program)
    text = [*emitted.opening, *emitted.body.split("\n")[:-2]]  # without CLOSE
    at = text.index("OPEN ROT")
    shown = emitted.text((MADE_ON_THE_WAY, f"robot {robot.name} {robot.fingerprint}"))
    job = Job(
        name=name,
        robot=robot,
        setup=tuple(text[:at]),
        lines=(),
        times=np.empty(0),
        commands=(),
        start=here,
        end=here,
        slack=judge.slack,
        segment=segment,
        duration=0.0,
        words=marks.words,
        low=marks.low,
        full=marks.low + 5,
        guarded=True,
        text=shown,
        source="",
        certificate="",
    )
    opening = tuple(text[at + 2 :])
    return Result((Live(job, opening, marks.low + _LEAD, generator), generator), around.diagnostics)
