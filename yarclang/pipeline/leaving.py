"""Plan how a robot withdraws after a watched input has held a motion: back along its path to where the robot
was last at rest, then through the motions of the SUB that the ON calls (the way out).
"""

from __future__ import annotations

import numpy as np

from yarclang.decisions import only_holding
from yarclang.diagnostics import has_errors
from yarclang.hir import Array, Origin, Program, TimedMove, Timetable, Timing, WayOut
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.jobs import job_of_compiled
from yarclang.pipeline.parts import compiled_part
from yarclang.pipeline.stages import Compiled, Request
from yarclang.pipeline.stands import stand_before, start_of, title_of, way_out_from
from yarclang.robot.actuation import to_counts
from yarclang.runtime.job import Job
from yarclang.source import SourceFile, Span
from yarclang.transforms import constant

BACK = "<back>"
"""Name of the program that leads back along a path."""

_WITHIN = 1e-4
"""Largest deviation of each joint from the path on the way back [rad or m]; equal to MOVEJ_TIMED's default.
"""

_SLOWER = 2.0
"""Smallest ratio of the duration of the way back to that of the way forward."""

_SHORTEST = 1.0
"""Shortest time of the way back [s]."""

_TRIES = 4
"""Largest number of durations that are tried for the way back. Each is twice the previous one."""

_ROW_EACH = 0.02
_MOST_ROWS = 2000


def leaving(
    plan: MotionPlan, name: str, number: int, time: float, position: Array, request: Request
) -> tuple[Job, ...] | str:
    """Plan the motions by which a robot withdraws after it was stopped on the path of a motion.

    Args:
        plan: the program.
        name: name of the way out (the SUB that an ON calls).
        number: number of the motion on whose path the robot was stopped.
        time: time in the plan that corresponds to the robot's position [s].
        position: (n,) position of the robot [rad or m].
        request: the settings with which the program was planned.

    Returns:
        The jobs to stream: the way back to where the robot was last at rest (unless it is there already), and
        the way out. If one of them can't be planned and proved, a text with the reason.
    """
    way = next((one for one in plan.program.ways_out if one.name == name), None)
    if way is None:
        return f"the program has no branch {name}"
    begin = stand_before(plan, number)
    end = start_of(plan, begin)
    jobs: list[Job] = []
    if (np.abs(to_counts(plan.robot, position) - to_counts(plan.robot, end)) > 1.0).any():
        back = _back(plan, begin, time, position, request)
        if isinstance(back, str):
            title = title_of(plan, begin)
            return f"the robot can't move back to the start of {title}: {back}"
        jobs.append(job_of_compiled(back, BACK))
        end = jobs[0].end
    out = _out(plan, way, end, request)
    if isinstance(out, str):
        return f"{name} can't be executed: {out}"
    return (*jobs, job_of_compiled(out, plan.program.source.name))


def _out(plan: MotionPlan, way: WayOut, position: Array, request: Request) -> Compiled | str:
    return _compiled(way_out_from(plan, way, position), request)


def _back(plan: MotionPlan, begin: int, time: float, position: Array, request: Request) -> Compiled | str:
    """Plan the way back along the path, from rest at the robot's position to rest at the start of motion
    `begin`. It takes at least `_SLOWER` times as long as the way forward.
    """
    whole, watches = plan.program, only_holding(plan.program.watches)
    since = float(plan.begins[begin])
    done = max(time - since, 0.0)
    lasts = max(_SHORTEST, _SLOWER * done)
    compiled: Compiled | str = ""
    for _ in range(_TRIES):
        table = _table(plan, since, done, lasts)
        within = constant(np.full(len(position), _WITHIN))
        text = f"P0001 MOVEJ_TIMED [{lasts:g}]"
        source = SourceFile(BACK, text)
        origin = Origin("P0001", "MOVEJ_TIMED", source, Span.on_line(1, 1, len(text) + 1))
        move = TimedMove(origin, table, within, 1.0, Timing(lasts))
        compiled = _compiled(
            Program(source, position, (move,), whole.outputs, whole.cell, watches=watches), request
        )
        if not isinstance(compiled, str):
            return compiled
        lasts *= 2.0
    return compiled


def _table(plan: MotionPlan, since: float, progress: float, lasts: float) -> Timetable:
    """Return the way back along a plan as a timetable that begins and ends at rest. It leads from the plan's
    position at time `since + progress` to that at time `since` [s], and takes `lasts` [s].
    """
    count = int(np.clip(np.ceil(lasts / _ROW_EACH), 4, _MOST_ROWS))
    share = np.arange(1, count + 1) / count
    # `step` goes from 0 to 1 by the polynomial of degree 5 that begins and ends with zero velocity and
    # acceleration. `slope` and `bend` are its first two time derivatives.
    step = share**3 * (10.0 + share * (6.0 * share - 15.0))
    slope = 30.0 * share**2 * (1.0 - share) ** 2 / lasts
    bend = 60.0 * share * (1.0 - share) * (1.0 - 2.0 * share) / lasts**2
    q, v, a = plan.sample(since + progress * (1.0 - step))
    speed, change = (-progress * slope)[:, None], (-progress * bend)[:, None]
    velocities, accelerations = v * speed, a * speed**2 + v * change
    velocities[-1] = accelerations[-1] = 0.0
    return Timetable(constant(lasts * share), constant(q), constant(velocities), constant(accelerations))


def _compiled(program: Program, request: Request) -> Compiled | str:
    made = compiled_part(program, request)
    if made.value is None or has_errors(made.diagnostics):
        return next((one.message for one in made.diagnostics if one.is_error), "it can't be planned")
    return made.value
