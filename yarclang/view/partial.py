"""Find collisions in a program of which some motions can't be planned.

Such a program can't be compiled, so there is no certificate that reports its collisions.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from yarclang.certify.bodies.clearance import find_clearances
from yarclang.certify.bodies.handled import follow
from yarclang.certify.bodies.zones import find_zones
from yarclang.certify.read.layout import Layout, Place
from yarclang.diagnostics import Diagnostic, in_order
from yarclang.hir import Motion
from yarclang.motion.plan import MotionPlan, PlannedMotion
from yarclang.robot.model import Array

_TOGETHER = 1e-9
"""Difference up to which the end of a motion and the beginning of the next one count as connected [rad or
m].
"""


def met(plan: MotionPlan) -> tuple[Diagnostic, ...]:
    """Return the collisions and zone violations of the planned motions. They are proved as for a complete
    program.
    """
    found: list[Diagnostic] = []
    if not plan.motions:
        return ()
    handled, _ = follow(_layout(plan, plan.motions), plan.program, plan.robot)
    for motions in _without_gaps(plan.motions):
        layout = _layout(plan, motions)
        found += find_clearances(layout, plan.program, plan.robot, handled)[1]
        found += find_zones(layout, plan.robot, handled, {})[1]
    return in_order(found)


def _without_gaps(motions: Sequence[PlannedMotion]) -> Iterator[list[PlannedMotion]]:
    """Divide planned motions into sequences without a gap, and yield each sequence. Between two sequences
    there is a motion that couldn't be planned.
    """
    stretch: list[PlannedMotion] = []
    for motion in motions:
        if stretch and np.abs(_ends(motion)[0] - _ends(stretch[-1])[1]).max() > _TOGETHER:
            yield stretch
            stretch = []
        stretch.append(motion)
    if stretch:
        yield stretch


def _ends(motion: PlannedMotion) -> tuple[Array, Array]:
    points = motion.curve.points
    weights = np.array([1.0, 4.0, 1.0]) / 6.0
    return weights @ points[:3], weights @ points[-3:]


def _layout(plan: MotionPlan, motions: Sequence[PlannedMotion]) -> Layout:
    """Arrange planned motions like the segments of a controller text, so that the same proofs can be used."""
    places: list[Place] = []
    at: list[NDArray[np.int64]] = []
    first = points = 0
    for motion in motions:
        step, curve = plan.program.steps[motion.step], motion.curve
        assert isinstance(step, Motion)
        places.append(Place(motion.step, step, first, first + curve.segments, None))
        at.append(points + np.arange(curve.segments))
        first += curve.segments
        points += len(curve.points)
    ends = [_ends(motion) for motion in motions]
    return Layout(
        control=np.concatenate([motion.curve.points for motion in motions]),
        at=np.concatenate(at),
        time=np.concatenate([np.full(motion.curve.segments, motion.curve.segment) for motion in motions]),
        places=tuple(places),
        begins=np.array([begin for begin, _ in ends]),
        ends=np.array([end for _, end in ends]),
    )
