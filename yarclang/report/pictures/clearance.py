"""Sample distances between bodies over the time of a plan, for display. This proves nothing."""

from __future__ import annotations

import numpy as np

from yarclang.cell.model import Cell
from yarclang.collision.bodies import Rows
from yarclang.collision.scene import scene_of
from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.plan import MotionPlan
from yarclang.report.carried import carried_in_plan
from yarclang.report.clearance import SEEN, near
from yarclang.report.pictures.trace import STANDING

_SAMPLES = 400
"""Number of samples over the whole plan."""

_MOST_STATES = 60
"""Largest number of states of the cell's parts (where they are) for which distances are computed. If a
program has more states, only some of them are sampled.
"""


@frozen(eq=False)
class Clearance:
    """The smallest distance between any two bodies over time.

    Attributes:
        times: (N,) [s].
        apart: (N,) distances, at most `SEEN`; 0 for bodies that touch [m].
        pair: names of the two bodies with the smallest distance; empty if no distance is below `SEEN`.
    """

    times: Array
    apart: Array
    pair: tuple[str, ...]


def clearance_of(plan: MotionPlan) -> Clearance | None:
    """Sample the smallest distance between bodies over a plan, with the parts where the program has moved
    them. None if there are no two bodies that could collide.
    """
    times = np.linspace(0.0, plan.duration or STANDING, _SAMPLES)
    cells, owner = _cells(plan, times)
    apart = np.full(len(times), SEEN)
    pair: tuple[str, ...] = ()
    visible = False
    is_computed = np.zeros(len(times), dtype=bool)
    kept = np.unique(owner)
    for number in kept[:: -(-len(kept) // _MOST_STATES)].tolist():
        scene = scene_of(plan.robot, cells[number]).value
        rows = np.flatnonzero(owner == number)
        is_computed[rows] = True
        if scene is None or not len(scene.pairs.first):
            continue
        visible = True
        found = near(scene, plan.sample(times[rows])[0])
        row = int(np.argmin(found.apart))
        if found.apart[row] < apart.min():
            pair = scene.names(int(found.pair[row]))
        apart[rows] = np.maximum(found.apart, 0.0)
    return Clearance(times[is_computed], apart[is_computed], pair) if visible else None


def _cells(plan: MotionPlan, times: Array) -> tuple[tuple[Cell | None, ...], Rows]:
    """Return the cells during a plan, with their parts in different places, and the number of the cell that
    applies at each time (N,) [s].
    """
    carried = carried_in_plan(plan)
    if carried is None:
        return (plan.program.cell,), np.zeros(len(times), dtype=np.int64)
    places = plan.schedule.places
    begins = np.array([-np.inf, *(places[one.step] for one in carried.states[1:])])
    owner = np.maximum(np.searchsorted(begins, times, side="right") - 1, 0)
    used = set(owner.tolist())
    cells = tuple(
        carried.cell_of(one) if number in used else None for number, one in enumerate(carried.states)
    )
    return cells, owner
