"""Controller text of live motions for a Turbo PMAC: the opening lines (rotary buffer, guard, segment time)
and the move lines.
"""

from __future__ import annotations

import numpy as np

from yarclang.backend import LiveWriting
from yarclang.backend_pmac.decimals import decimals_for
from yarclang.backend_pmac.emit import emit
from yarclang.backend_pmac.guard import watermarks
from yarclang.certify.pmac.moves import read_moves
from yarclang.pmac.controller import turbo_pmac
from yarclang.pmac.program import Assignment, PmacProgram, SegmentTime
from yarclang.pmac.variables import ARMED
from yarclang.robot.actuation import to_counts
from yarclang.robot.model import Array, Robot
from yarclang.runtime.job import Job
from yarclang.runtime.live import MADE_ON_THE_WAY, Live, Source
from yarclang.runtime.pmac.loading import Loading, capacity_of
from yarclang.units import MS

_LEAD = 12
"""Number of lines that must be ahead in addition to I16, as an allowance for delays of the host."""


def _decimals(robot: Robot, segment: float) -> int:
    return decimals_for(robot, segment, robot.tolerance)


def _lines(robot: Robot, points: Array, decimals: int) -> tuple[str, ...]:
    row = "".join(f"{axis}%.{decimals}f" for axis in robot.controller.axes)
    return tuple(row % tuple(one) for one in (points / robot.axis_units + 0.0).tolist())


def _motion(
    robot: Robot, here: Array, slack: Array, segment: float, decimals: int, name: str, source: Source
) -> Live:
    marks = watermarks(robot, segment)
    start = np.round(here / robot.axis_units, decimals) + 0.0
    program = PmacProgram(
        target="rotary",
        coordinate_system=turbo_pmac(robot).coordinate_system,
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
    job = Job(
        name=name,
        robot=robot,
        lines=(),
        times=np.empty(0),
        commands=(),
        start=here,
        end=here,
        slack=slack,
        segment=segment,
        duration=0.0,
        capacity=capacity_of(robot, marks.words),
        guarded=True,
        text=emitted.text((MADE_ON_THE_WAY, f"robot {robot.name} {robot.fingerprint}")),
        source="",
        certificate="",
        own=Loading(tuple(text[:at]), marks.words, marks.low, marks.low + 5),
    )
    return Live(job, tuple(text[at + 2 :]), marks.low + _LEAD, source)


LIVE = LiveWriting(_decimals, _lines, read_moves, _motion)
