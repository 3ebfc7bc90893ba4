"""All joint positions that reach a pose: which was taken, and why not another."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np

from yarclang.frozen import frozen
from yarclang.robot.kinematics.inverse import branches
from yarclang.robot.kinematics.nearest import SAME, full_turns
from yarclang.robot.kinematics.within import EDGE, beyond, nearest_turn
from yarclang.robot.model import Array, Robot

MOST_TRIED = 24
"""From so many solutions what follows is tried."""

Verdict = Literal["chosen", "farther", "continuity", "fails later", "works", "out of limits"]
Follow = Callable[[Array], str]
"""What goes wrong behind a joint position (n,): a sentence, or nothing."""


@frozen(eq=False)
class Solution:
    """A joint position `q` (n,) [rad or m] that reaches the pose.

    `distance` is the sum of squared joint differences from `reference` (rad and m), `verdict` what became of it, `reason` in words.
    `excess` (n,) [rad or m] is how far each joint is out of its limits, 0 within.
    """

    q: Array
    distance: float
    excess: Array
    verdict: Verdict
    reason: str


def solutions_of(
    robot: Robot,
    base_from_flange: Array,
    reference: Array,
    chosen: Array | None,
    follow: Follow,
    *,
    along_path: bool,
) -> tuple[Solution, ...]:
    """Every inverse-kinematics solution, each with all its full turns within limits, nearest first; then those out of limits.

    Args:
        robot: whose.
        base_from_flange: (4, 4), the pose.
        reference: (n,) from where the distance counts [rad or m].
        chosen: (n,) what the plan takes; None where it takes none.
        follow: what goes wrong behind a solution.
        along_path: whether the motion keeps its configuration, so that nothing is chosen.
    """
    chain, limits = robot.chain, robot.limits
    found, reached = branches(chain, base_from_flange[None], hold=reference)
    within: list[Array] = [] if chosen is None else [chosen]
    outside: list[tuple[Array, Array]] = []
    for q in nearest_turn(chain, limits, found[0][reached[0]], reference):
        excess = beyond(limits, q)
        if np.abs(excess).max() > EDGE:
            if not any(_same(q, other) for other, _ in outside):
                outside.append((q, excess))
            continue
        for turned in full_turns(chain, limits, q):
            if not any(_same(turned, other) for other in within):
                within.append(turned)
    within.sort(key=lambda q: _distance(q, reference))
    nearest_first = [
        Solution(
            q,
            _distance(q, reference),
            np.zeros_like(q),
            *_verdict(q, number, within, chosen, follow, along_path),
        )
        for number, q in enumerate(within)
    ]
    outside.sort(key=lambda pair: _distance(pair[0], reference))
    beyond_limits = [
        Solution(q, _distance(q, reference), excess, "out of limits", excess_text(robot, excess))
        for q, excess in outside
    ]
    return (*nearest_first, *beyond_limits)


def _verdict(
    q: Array, number: int, within: list[Array], chosen: Array | None, follow: Follow, along_path: bool
) -> tuple[Verdict, str]:
    if chosen is not None and q is chosen:
        trouble = follow(q)
        if along_path:
            return "chosen", trouble or "the path leads here in the configuration of its start"
        return "chosen", trouble or (
            "nearest" if number == 0 else "the nearest from which what follows can be done"
        )
    if along_path:
        return "continuity", "another configuration: the path doesn't change it on its way"
    place = next((n for n, one in enumerate(within) if one is chosen), -1)
    needs_trial = place < 0 or number < place or bool(follow(within[place]))
    trouble = follow(q) if needs_trial and number < MOST_TRIED else ""
    if trouble:
        return "fails later", trouble
    if number < place:
        return "works", "nearer, and what follows can be done from here: NEAR says something else"
    if place >= 0:
        worked = "; what follows can be done from here" if needs_trial and number < MOST_TRIED else ""
        return "farther", f"farther than the one that is taken{worked}"
    return "works", "within limits"


def excess_text(robot: Robot, excess: Array) -> str:
    """`J3 12.5 deg above, J5 3 deg below its limit`."""
    parts = [
        f"{name} by {abs(value) / unit:.4g} {unit_name} {'above' if value > 0 else 'below'}"
        for name, value, unit, unit_name in zip(
            robot.joint_names, excess, robot.axis_units, robot.axis_unit_names, strict=True
        )
        if abs(value) > EDGE
    ]
    return "out of limits: " + ", ".join(parts)


def _distance(q: Array, reference: Array) -> float:
    return float(np.square(q - reference).sum())


def _same(one: Array, other: Array) -> bool:
    return bool(np.abs(one - other).max() < SAME)
