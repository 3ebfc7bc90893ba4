"""Joint torques along a controller text's segments: bounded between samples, compared with limits."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from yarclang.certify.bodies.handled import Handled
from yarclang.certify.bodies.torque_bounds import torque_bends
from yarclang.certify.certificate import IDLE, Load
from yarclang.certify.moments import pose_text
from yarclang.certify.motion.bounds import Cubics, segment_max
from yarclang.certify.motion.limits import RELATIVE
from yarclang.certify.read.layout import Layout, Place, chunks
from yarclang.diagnostics import Diagnostic, Edit, Fix, grouped
from yarclang.frozen import frozen
from yarclang.handling.surroundings import load_cases
from yarclang.hir import TimedMove
from yarclang.robot.dynamics import holding_torques, torques
from yarclang.robot.model import Array, Dynamics, Robot
from yarclang.units import UNITS
from yarclang.written import stretch_fix

REMAINDER = 0.003
"""Largest amount that the bound between sampled points should add to a torque, as a fraction of the effort
limit. The grid is refined until this holds, but into at most `PARTS` parts per segment.
"""
PARTS = 64
"""Largest number of parts into which a segment is cut."""
ROOM = 0.03
"""Fraction by which a proposed duration is increased.

A longer motion has another number of segments and other ramps, so its torques don't scale exactly.
"""


@frozen(eq=False)
class _Samples:
    """Torques at S instants of G motions that carry the same load.

    Attributes:
        row: (S,) segment of each instant.
        time: (S,) time after the start of the segment [s].
        q: (S, n) joint positions [rad or m].
        torque: (S, n) torques [N m or N].
        bound: (S, n) amount by which |torque| may be larger up to the next instant [N m or N].
        share: (S, n) largest |torque| up to the next instant, as a fraction of the effort limit.
        first: (G,) first instant of each motion.
    """

    row: NDArray[np.int64]
    time: Array
    q: Array
    torque: Array
    bound: Array
    share: Array
    first: NDArray[np.int64]


def find_torques(layout: Layout, robot: Robot, handled: Handled) -> tuple[dict[int, Load], list[Diagnostic]]:
    """Return the joint nearest to its effort limit for every step, and findings about exceeded limits.

    Args:
        layout: the segments of the controller text.
        robot: the robot's masses and effort limits; without them, nothing is judged.
        handled: the cell's state during each command, with the parts that grippers carry.
    """
    dynamics = robot.dynamics
    if dynamics is None or not dynamics.is_checked:
        return {}, []
    loads: dict[int, Load] = {place.step: IDLE for place in layout.places}
    worst: dict[int, Diagnostic] = {}
    for case, places in _by_load(layout, robot, handled):
        for chunk in chunks(places):
            _judge_load(layout, chunk, replace(robot, dynamics=case), (loads, worst))
    return loads, list(grouped([worst[step] for step in sorted(worst)]))


def _by_load(layout: Layout, robot: Robot, handled: Handled) -> list[tuple[Dynamics, list[Place]]]:
    """Return the distinct loads, each with all moving commands that carry it."""
    loads: dict[int, tuple[Dynamics, list[Place]]] = {}
    for place in layout.places:
        if place.size:
            # Load cases are cached, so equal cases are the same object.
            for case in load_cases(robot, handled.at(place.step)):
                loads.setdefault(id(case), (case, []))[1].append(place)
    return list(loads.values())


def _judge_load(
    layout: Layout, places: list[Place], robot: Robot, found: tuple[dict[int, Load], dict[int, Diagnostic]]
) -> None:
    """Judge the torques of commands for one load case, to which all of them belong. A command may belong to
    several load cases; the result with the largest torques is kept.
    """
    dynamics, (loads, findings) = robot.dynamics, found
    assert dynamics is not None  # torques are only judged with dynamics
    cubics = layout.cubics_of(np.concatenate([np.arange(place.first, place.last) for place in places]))
    starts = np.cumsum([0, *(place.size for place in places[:-1])])
    samples = _sampled(cubics, starts, robot, dynamics)
    peaks = segment_max(samples.share, samples.first)
    ends = [*samples.first[1:].tolist(), len(samples.row)]
    for number, place in enumerate(places):
        worst = int(np.argmax(peaks[number]))
        share = float(peaks[number, worst])
        if share <= loads[place.step].share:
            continue
        loads[place.step] = Load(robot.joint_names[worst], share)
        if share > 1.0 + RELATIVE:
            chosen = slice(int(samples.first[number]), ends[number])
            findings[place.step] = _finding(layout, place, samples, chosen, robot, dynamics)


def _sampled(cubics: Cubics, starts: NDArray[np.int64], robot: Robot, dynamics: Dynamics) -> _Samples:
    """Compute torques on a grid of instants.

    The grid is finer in segments whose bound could exceed the largest torque of their motion.
    """
    lower, upper = cubics.position_range()
    travel = np.maximum(np.abs(lower), np.abs(upper))
    peaks = cubics.velocity_peaks(), cubics.acceleration_peaks(), cubics.jerk_peaks()
    bends = torque_bends(robot.chain, dynamics, travel, peaks)
    # Between two instants that are d seconds apart, a torque exceeds its chord by at most d^2 / 8 times its
    # second derivative.
    whole = bends * (cubics.h[:, None] ** 2 / 8.0)
    coarse = _looked_at(cubics, starts, whole, np.ones(len(cubics.h), dtype=np.int64), robot)
    # A finer grid is useful only in segments whose bound exceeds the largest sampled torque of the motion.
    seen = segment_max((np.abs(coarse.torque) / dynamics.effort).max(axis=1), coarse.first)
    motion = np.repeat(np.arange(len(starts)), np.diff(np.append(coarse.first, len(coarse.row))))
    beyond = coarse.share.max(axis=1) > seen[motion] + REMAINDER
    if not beyond.any():
        return coarse
    # The bound falls with the square of the number of parts.
    wanted = np.ceil(np.sqrt((whole / (REMAINDER * dynamics.effort)).max(axis=1)))
    close = np.zeros(len(cubics.h), dtype=np.bool_)
    close[coarse.row[beyond]] = True
    parts = np.where(close, np.clip(wanted, 1, PARTS), 1).astype(np.int64)
    return _looked_at(cubics, starts, whole, parts, robot)


def _looked_at(
    cubics: Cubics, starts: NDArray[np.int64], whole: Array, parts: NDArray[np.int64], robot: Robot
) -> _Samples:
    """Compute torques at the ends of equal parts of segments.

    Args:
        cubics: N segments.
        starts: first segment of each motion.
        whole: (N, n) amount by which |torque| may exceed its values at both ends of an undivided segment.
        parts: (N,) number of parts into which each segment is divided.
        robot: the robot.
    """
    dynamics = robot.dynamics
    assert dynamics is not None  # torques are only judged with dynamics
    count = len(cubics.h)
    ends = np.append(starts[1:], count) - 1
    # Take one instant at the start of each part; the end of a part is the start of the next.
    number = parts.copy()
    number[ends] += 1  # include the end of each motion
    row = np.repeat(np.arange(count), number)
    offsets = np.concatenate([[0], np.cumsum(number)])
    time = (np.arange(len(row)) - offsets[row]) * (cubics.h / parts)[row]
    segments = cubics.take(row)
    q, v = segments.at(time)
    a = segments.a + time[:, None] * segments.j
    torque = torques(robot.chain, dynamics, q, v, a)
    # The bound on an interval of duration d is d^2 / 8 |torque''|. It is `whole` for an uncut segment, and
    # smaller by parts^2 for each of its equal parts.
    bound = (whole / (parts**2)[:, None])[row]
    bound[offsets[ends + 1] - 1] = 0.0
    size = np.abs(torque)
    # Between two instants the torque is at most the larger of both, plus the bound.
    there = size + bound
    there[:-1] = np.maximum(there[:-1], np.where(bound[:-1] > 0.0, size[1:] + bound[:-1], 0.0))
    return _Samples(row, time, q, torque, bound, there / dynamics.effort, offsets[starts])


def _finding(
    layout: Layout, place: Place, samples: _Samples, chosen: slice, robot: Robot, dynamics: Dynamics
) -> Diagnostic:
    """Return the finding Y1801, or Y1802 if an effort limit is exceeded even by holding the arm still
    somewhere on the motion's path.
    """
    origin = place.motion.origin
    torque, bound, q = samples.torque[chosen], samples.bound[chosen], samples.q[chosen]
    holding = holding_torques(robot.chain, dynamics, q)
    h = float(layout.time[place.first])
    time = (samples.row[chosen] - samples.row[chosen][0]) * h + samples.time[chosen]
    held = np.abs(holding) / dynamics.effort
    if held.max() > 1.0:
        at, joint = divmod(int(np.argmax(held)), robot.size)
        message = (
            f"{_needs(robot, dynamics, joint, abs(float(holding[at, joint])))} only to hold the arm against "
            f"gravity, {_when(time[at], place.size * h)}, {pose_text(robot, origin, q[at])}"
        )
        return Diagnostic("Y1802", message, origin.source, origin.span, _TOO_HEAVY, place=origin.place)
    at, joint = divmod(int(np.argmax(samples.share[chosen])), robot.size)
    most = float(samples.share[chosen][at, joint] * dynamics.effort[joint])
    still = abs(float(holding[at, joint]))
    message = (
        f"{_needs(robot, dynamics, joint, most)}, {_when(time[at], place.size * h)}, "
        f"{pose_text(robot, origin, q[at])}; {_number(still)} {_unit(robot, joint)} of it hold the arm "
        "against gravity"
    )
    help_, fix = _slower(place, place.size * h, _stretched(torque, holding, bound, dynamics))
    return Diagnostic("Y1801", message, origin.source, origin.span, help_, fix, place=origin.place)


def _needs(robot: Robot, dynamics: Dynamics, joint: int, size: float) -> str:
    effort = float(dynamics.effort[joint])
    return (
        f"{robot.joint_names[joint]} needs {_number(size)} {_unit(robot, joint)}, {size / effort:.1%} of its "
        f"effort of {effort:g} {_unit(robot, joint)}"
    )


def _when(time: float, duration: float) -> str:
    return f"{time:.3f} s after its start ({100.0 * time / duration:.0f} %)"


def _number(value: float) -> str:
    return f"{value:.4g}"


def _unit(robot: Robot, joint: int) -> str:
    return "N" if robot.joint_kinds[joint] == "prismatic" else "N m"


def _stretched(torque: Array, holding: Array, bound: Array, dynamics: Dynamics) -> float:
    """Return the factor by which a motion must last longer to respect all effort limits.

    The factor is infinite if even a very slow motion exceeds a limit. If the same path takes s times as long,
    all torques except those of gravity are divided by s^2.
    """
    # Solve |moving| / s^2 + gravity + bound <= effort for s, at the worst instant.
    moving = torque - holding
    against = np.where(moving >= 0.0, holding, -holding)  # positive if gravity adds to the other torques
    with np.errstate(divide="ignore", invalid="ignore"):
        # `bound` isn't divided by s^2: it also covers changes of the gravity torque along the path, which
        # shrink less in a slower motion.
        least = np.where(moving != 0.0, (dynamics.effort - bound - against) / np.abs(moving), np.inf)
    share = float(least.min())
    return math.sqrt(max(1.0, 1.0 / share)) * (1.0 + ROOM) if share > 0.0 else math.inf


def _slower(place: Place, duration: float, longer: float) -> tuple[str, Fix | None]:
    """Return a remedy in words, and a fix if there is one, for a motion that must take longer.

    Args:
        place: the motion.
        duration: the motion's duration [s].
        longer: factor by which the duration must grow.
    """
    if not math.isfinite(longer):
        return f"no duration works: {_TOO_HEAVY}", None
    if place.before is not None or place.behind is not None:
        return f"give the whole chain of motions about {longer:.2f} times as long, or carry less", None
    origin = place.motion.origin
    if isinstance(motion := place.motion, TimedMove):
        stretch = math.ceil(longer * motion.stretch * 1e3) / 1e3
        return f"a STRETCH that works is about {stretch:.10g}; or carry less", stretch_fix(motion, stretch)
    value = math.ceil(longer * duration / UNITS[origin.time_unit].factor * 1e3) / 1e3
    text = f"[{value:.10g}]"
    fix = Fix(f"write {text}", (Edit(origin.time_span, text),)) if origin.time_span is not None else None
    return f"a time that works is about {text} ({origin.time_unit}); or carry less", fix


_TOO_HEAVY = (
    "carry less, or keep the load nearer to the joint's axis; if a mass or an effort is wrong, correct it "
    "in the URDF (an effort also in robot.toml)"
)
