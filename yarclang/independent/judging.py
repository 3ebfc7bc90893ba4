"""Check of the controller texts to which programs compile.

The joint positions that were chosen for poses come from the compiler's plan; this check tests that they reach
these poses.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from yarclang.independent.arm import Arm, Array
from yarclang.independent.found_ways import unfolded
from yarclang.independent.paths import Said, goals_from, off, path
from yarclang.independent.reading import Executed, overlaps, read
from yarclang.independent.reading import shares as shares_of
from yarclang.independent.rules import broken


@dataclass(frozen=True)
class Judgement:
    """Result of the check of one text.

    Attributes:
        faults: deviations of the executed motion from the program, as sentences.
        worst: by name, the largest used fraction of a tolerance (`path` and `table`) or of a limit
            (`position`, `velocity`, `acceleration`, `jerk` and `motor`).
        duration: time of all motions [s].
    """

    faults: tuple[str, ...]
    worst: dict[str, float]
    duration: float


def judge(
    arm: Arm,
    said: dict[int, Said],
    text: str,
    chosen: Mapping[int, Array],
    told: Mapping[int, Collection[str]],
) -> Judgement:
    """Check an emitted text for deviations from its program.

    Args:
        arm: the arm, read independently.
        said: requirements of the program on each motion, by step.
        text: the emitted text.
        chosen: for each step, the joint positions (k, n) [rad, m] that were chosen for its goals.
        told: codes of the compiler's warnings and notes, by step.
    """
    found: list[str] = []
    worst: dict[str, float] = {}
    lasts = 0.0
    stands, executed = read(text)
    flowing = overlaps(text)
    if any(one.avoids for one in said.values()):
        said, lasting = unfolded(arm, said, text, chosen)
        for legs, seconds in lasting:
            takes = sum(executed[step].duration for step in legs)
            if abs(takes - seconds) > 2.1e-4 * len(legs):
                found.append(f"step {legs[0]}: its legs take {takes:.6f} s")
    steps = sorted(said)
    corner = stands
    flows_in: int | None = None
    ball_before: Callable[[Array], Array] | None = None
    before: tuple[Said, Array] | None = None
    for place, step in enumerate(steps):
        one, done = said[step], executed[step]
        following = said[steps[place + 1]] if place + 1 < len(steps) else None
        goals = goals_from(arm, one, corner)
        ends = chosen[step] / arm.si
        # Number of segments in which the motion overlaps with the next one. None: the robot rests at the
        # corner between them. 0: both paths are followed up to the corner.
        flows_on = flowing.get(step)
        label = f"step {step} {one.kind}"
        lasts += done.duration
        found += [f"{label}: {fault}" for fault in _not_solutions(arm, goals, ends)]
        beside = [one]
        if flows_in is not None:
            beside.append(said[steps[place - 1]])
        if flows_on is not None:
            beside.append(said[steps[place + 1]])
        found += [f"{label}: {fault}" for fault in _beyond(arm, done, beside, worst)]
        q = done.sample()
        found += [f"{label}: {fault}" for fault in broken(arm, one.rules, q)]
        for flows, end, where in ((flows_in, corner, 0.0), (flows_on, ends[-1], done.duration)):
            if flows is None:
                if np.abs(done.spline(where, nu=1) * arm.si).max() > 2e-6:
                    found.append(f"{label}: no rest at {where:.3f} s")
                if np.abs(done.spline(where) - end).max() > 3e-5:
                    found.append(f"{label}: not at its place at {where:.3f} s")
        if one.kind == "timed":
            found += [f"{label}: {fault}" for fault in _off_table(arm, one, done, corner, worst)]
            corner, flows_in, ball_before, before = ends[-1], None, None, None
            continue
        way = one, path(arm, one, corner, goals, ends)
        shares = off(arm, one, q, way[1])
        ball = _ball(arm, one, following, ends[-1]) if flows_on and one.blend and following else None
        in_ball = np.zeros(len(q), bool)
        for inside in (ball_before, ball):
            if inside is not None:
                in_ball |= inside(q) <= 1.0
        shares[in_ball] = 0.0
        near = np.zeros(len(q), bool)
        if (rows := _beside(flows_in, said[steps[place - 1]])) is not None:
            near[:rows] = True
            assert before is not None
            shares[:rows] = np.minimum(shares[:rows], off(arm, before[0], q[:rows], before[1]))
        if (rows := _beside(flows_on, one)) is not None:
            assert following is not None
            next_goals, next_ends = goals_from(arm, following, ends[-1]), chosen[steps[place + 1]] / arm.si
            next_path = path(arm, following, ends[-1], next_goals, next_ends)
            near[-rows:] = True
            shares[-rows:] = np.minimum(shares[-rows:], off(arm, following, q[-rows:], next_path))
        _count(worst, "path", shares.max())
        if shares.max() > 1.0 + 1e-3:
            found.append(f"{label}: off the path by {shares.max():.4f} of the tolerance")
        if (
            one.seconds is not None
            and "Y0609" not in told.get(step, ())
            and abs(done.duration - one.seconds) > 2.1e-4
        ):
            found.append(f"{label}: takes {done.duration:.6f} s")
        if one.speed is not None:
            reaches = "Y0610" not in told.get(step, ()) and flows_in is None and flows_on is None
            found += [f"{label}: {fault}" for fault in _off_speed(arm, one, done, in_ball | near, reaches)]
        if one.ceiling is not None:
            fastest = _fastest(arm, done, in_ball | near)
            if fastest > one.ceiling * 1.002:
                found.append(f"{label}: goes at {fastest:.4f} mm/s and never above {one.ceiling:g}")
        corner, flows_in, ball_before, before = ends[-1], flows_on, ball, way
    return Judgement(tuple(found), worst, lasts)


def _count(worst: dict[str, float], what: str, value: float) -> None:
    """Store a value under a name in `worst`, unless a larger value is already stored under it."""
    worst[what] = max(worst.get(what, 0.0), float(value))


def _off_table(arm: Arm, one: Said, done: Executed, corner: Array, worst: dict[str, float]) -> Iterator[str]:
    """Yield deviations from a timetable that begins at joint positions `corner`."""
    assert one.table is not None
    lasts = one.table.times[-1] * one.stretch
    if not -1e-9 <= done.duration - lasts <= 1e-3:
        yield f"takes {done.duration:.6f} s, not {lasts:.6f} s"
    at = np.linspace(0.0, 1.0, 8 * len(done.control))
    asked = replace(one.table, start=corner).asked(one.stretch)
    far = (np.abs(done.spline(at * done.duration) - asked(at * lasts)) * arm.si).max()
    _count(worst, "table", far * 1e4)
    if far > 1e-4 * (1.0 + 1e-6):
        yield f"off its table by {far * 1e4:.4f} of the tolerance"


def _beside(segments: int | None, one: Said) -> int | None:
    """Return the number of samples next to a corner between two motions that may be on the path of either
    motion. They cover the overlap of the motions and one segment beside it.

    None if the robot rests at the corner, or if BLEND lets it leave the corner aside.

    Args:
        segments: number of overlapping segments of the motions; None if the robot rests at the corner.
        one: the requirements on the first motion.
    """
    return None if segments is None or (segments and one.blend) else 8 * (segments // 2 + 1) + 1


def _not_solutions(arm: Arm, goals: list[Any], ends: Array) -> Iterator[str]:
    """Yield a fault for each chosen joint position that doesn't reach its goal or is beyond a joint limit."""
    if len(goals) != len(ends):
        ends = ends[-1:]
        goals = goals[-1:]
    for goal, q in zip(goals, ends, strict=True):
        if isinstance(goal, tuple):
            (point,), turns = arm.poses(q[None])
            if np.linalg.norm(point - goal[0]) > 1e-5 or (turns[0].inv() * goal[1]).magnitude() > 1e-7:
                yield "a joint position that doesn't reach its pose"
        elif np.abs(goal - q).max() > 1e-7:
            yield "another joint position than is said"
        if ((q > arm.upper + 1e-6) | (q < arm.lower - 1e-6)).any():
            yield "a joint position out of limits"


_PRINTED = {"velocity": 2e-4, "motor": 2e-4, "acceleration": 1e-3, "jerk": 1e-2}
"""Amounts by which a motion may exceed its allowed fraction of a limit, since the printed decimals are
rounded. The limit itself must never be exceeded.
"""


def _beyond(arm: Arm, done: Executed, beside: list[Said], worst: dict[str, float]) -> Iterator[str]:
    """Yield a fault for each kind of limit that is exceeded at any sample of a motion.

    A program may allow a motion only a fraction of the limits. Where motions overlap, the largest fraction
    that any motion in `beside` may use is allowed.
    """
    share = max(other.share for other in beside)
    ramp = max(other.share * other.acc for other in beside)
    allowed = {"position": 1.0, "velocity": share, "motor": share, "acceleration": ramp, "jerk": ramp}
    if any(other.profile == "TOPP" or other.kind == "timed" for other in beside):
        del allowed["jerk"]
    used = shares_of(arm, done)
    for kind, meant in allowed.items():
        most = min(meant + _PRINTED.get(kind, 0.0), 1.0)
        _count(worst, kind, used[kind] / most)
        if used[kind] > most * (1.0 + 1e-6) + 1e-9:
            yield f"{kind} at {used[kind]:.6f} of the limit, {most:g} is allowed"


def _ball(arm: Arm, one: Said, following: Said, corner: Array) -> Callable[[Array], Array]:
    """Return a function that computes the distances of joint positions from a corner between two motions, as
    fractions of the distance that BLEND allows.
    """
    blend = one.blend or 0.0
    if one.in_joints and following.in_joints:
        return lambda q: np.asarray(np.abs(q - corner).max(axis=1) / blend)
    (point,), _ = arm.poses(corner[None])
    return lambda q: np.linalg.norm(arm.poses(q)[0] - point, axis=1) / (blend + (one.tol or 0.0))


def _off_speed(
    arm: Arm, one: Said, done: Executed, in_ball: NDArray[np.bool_], reaches: bool
) -> Iterator[str]:
    """Yield a fault if a motion exceeds its programmed speed of {TCP}, or (with `reaches`) stays below
    this speed.
    """
    assert one.speed is not None
    fastest = _fastest(arm, done, in_ball)
    if fastest > one.speed * 1.002:
        yield f"goes at {fastest:.4f} mm/s"
    if reaches and fastest < one.speed * 0.998:
        yield f"reaches only {fastest:.4f} mm/s"


def _fastest(arm: Arm, done: Executed, in_ball: NDArray[np.bool_]) -> float:
    """Return the largest speed of {TCP} outside of blends [mm/s]."""
    points, _ = arm.poses(done.sample())
    times = np.linspace(0.0, done.duration, len(points))
    speeds = np.linalg.norm(np.diff(points, axis=0), axis=1) / np.diff(times)
    return float(speeds[~(in_ball[1:] | in_ball[:-1])].max(initial=0.0))
