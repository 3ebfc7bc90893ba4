"""Find a stop between two motions in one direction."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from yarclang.findings import Finding
from yarclang.hir import Array, Motion, SetOutput, Step
from yarclang.lint.rule import Remark, Rule, Surroundings, remark_at
from yarclang.memory import recall
from yarclang.motion.cartesian import CartesianPath
from yarclang.motion.plan import MotionPlan, PlannedMotion
from yarclang.units import DEG

STRAIGHT = 5.0 * DEG
"""Largest angle between two paths that count as going straight on [rad]."""


def _look(plan: MotionPlan, around: Surroundings) -> Iterator[Remark]:
    steps = plan.program.steps
    ways: dict[int, tuple[Array, Array] | None] = {}
    for first, second in zip(plan.motions, plan.motions[1:], strict=False):
        step, following = steps[first.step], steps[second.step]
        assert isinstance(step, Motion)
        assert isinstance(following, Motion)
        between: tuple[Step, ...] = steps[first.step + 1 : second.step]
        if step.blend is not None or not all(isinstance(one, SetOutput) for one in between):
            continue
        # The cache returns the same object for the same path, so paths can be part of a key.
        key = ("angle", first.path, second.path)
        (angle,) = recall(around.memory, key, partial(_angle, first, second, ways))
        if angle is not None and angle < STRAIGHT:
            other = f" {following.origin.label}" if following.origin.label else " the next motion"
            message = (
                f"the robot stops here, and{other} goes on in the same direction, within "
                f"{max(angle / DEG, 0.01):.2g} deg"
            )
            yield remark_at(
                step.origin,
                message,
                "add BLEND and a distance at the end of the line to pass here without a stop; if the stop "
                "is intended, change nothing",
            )


def _angle(
    first: PlannedMotion, second: PlannedMotion, ways: dict[int, tuple[Array, Array] | None]
) -> tuple[float | None]:
    """Return the angle [rad] between two Cartesian paths of one moving frame where the first ends and the
    second begins; (None,) for other paths.

    Args:
        first: the motion before the stop.
        second: the motion after the stop.
        ways: cache of path directions by step, see `_ends`; the directions of both motions are added.
    """
    one, other = first.path, second.path
    if not isinstance(one, CartesianPath) or not isinstance(other, CartesianPath):
        return (None,)
    for motion, path in ((first, one), (second, other)):
        if motion.step not in ways:
            ways[motion.step] = _ends(path)
    come, go = ways[first.step], ways[second.step]
    if come is None or go is None or not np.array_equal(one.flange_from_moving, other.flange_from_moving):
        return (None,)
    comes, goes = come[1], go[0]
    cosine = float(comes @ goes) / float(np.linalg.norm(comes) * np.linalg.norm(goes))
    return (float(np.arccos(np.clip(cosine, -1.0, 1.0))),)


def _ends(path: CartesianPath) -> tuple[Array, Array] | None:
    """Return the directions (3,) of a path at its start and at its end; None if it only rotates."""
    if path.extent[1]:
        return None
    begin, end = path.frame.tangents(np.array([0.0, 1.0]))[:, :3]
    return begin, end


_HEAD = "DEFAULT {TCP} [50%] (mm,deg,s) {B}\nP0010 MOVEJ_RPY 0 1174.4 1376 0 0 0\n"
RULE = Rule(
    Finding(
        "Y0612",
        "stop-on-the-way",
        "note",
        "the robot stops between two motions in the same direction",
        "Without BLEND each motion ends at rest. On a straight path this costs time, and leaves a mark if "
        "the tool is working, for example with glue.",
        _HEAD + "P0020 MOVEL 0 1174.4 1276 0 0 0 [V 100]\nP0030 MOVEL 0 1174.4 1176 0 0 0 [V 100]",
        _HEAD + "P0020 MOVEL 0 1174.4 1276 0 0 0 [V 100] BLEND 10\nP0030 MOVEL 0 1174.4 1176 0 0 0 [V 100]",
    ),
    MotionPlan,
    _look,
    valid=(
        _HEAD + "P0020 MOVEL 0 1174.4 1276 0 0 0\nP0030 MOVEL 100 1174.4 1276 0 0 0",
        _HEAD + "P0020 MOVEL 0 1174.4 1276 0 0 0\nP0030 WAIT [1]\nP0040 MOVEL 0 1174.4 1176 0 0 0",
        _HEAD + "P0020 MOVEL 0 1174.4 1276 0 0 0\nP0030 MOVEJ HOME",
    ),
    invalid=(
        _HEAD + "P0020 MOVEL 0 1174.4 1276 0 0 0\nP0030 MOVEL 0 1174.4 1176 0 0 0",
        "OUTPUT GLUE M1 OFF\n"
        + _HEAD
        + "P0020 MOVEL 0 1174.4 1276 0 0 0\nP0030 SET GLUE ON\nP0040 DMOVE 0 0 -100 0 0 0",
    ),
)
