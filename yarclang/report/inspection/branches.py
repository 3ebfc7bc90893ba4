"""Find all joint positions that reach a pose, and the reason why the planner chose one of them and not the
others.
"""

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
"""Largest number of solutions that are tested by planning the following motions from them."""

Verdict = Literal["chosen", "farther", "continuity", "fails later", "works", "out of limits"]
Follow = Callable[[Array], str]
"""Function that takes a joint position (n,) at which a motion ends, and returns a sentence about what fails
after this motion; empty if nothing fails.
"""


@frozen(eq=False)
class Solution:
    """An inverse kinematics solution: a joint position that reaches a pose.

    Attributes:
        q: (n,) [rad or m].
        distance: sum of squared joint differences from the reference position (rad and m).
        excess: (n,) distance of each joint beyond its limits [rad or m]; 0 within.
        verdict: chosen, or the kind of reason why the solution wasn't chosen.
        reason: the reason in words.
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
    """Return all inverse kinematics solutions for a pose, including those that differ by full turns.

    Solutions within the limits come first, sorted by distance; solutions beyond the limits follow.

    Args:
        robot: the robot.
        base_from_flange: (4, 4), the pose.
        reference: (n,) position from which the distance is measured [rad or m].
        chosen: (n,) the plan's solution; None if it has none.
        follow: function that takes a solution, and returns what fails in the motions after it; empty if
            nothing fails.
        along_path: True if the motion keeps its inverse kinematics branch, so that there is no choice.
    """
    chain, limits = robot.chain, robot.limits
    found, reached = branches(chain, base_from_flange[None], hold=reference)
    within: list[Array] = [] if chosen is None else [chosen]
    outside: list[tuple[Array, Array]] = []
    for q in nearest_turn(chain, limits, found[0][reached[0]], reference):
        excess = beyond(limits, q)
        if np.abs(excess).max() > EDGE:
            if not any(_is_same(q, other) for other, _ in outside):
                outside.append((q, excess))
            continue
        for turned in full_turns(chain, limits, q):
            if not any(_is_same(turned, other) for other in within):
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
            return "chosen", trouble or "the path ends here in the configuration of its start"
        return "chosen", trouble or (
            "nearest" if number == 0 else "the nearest from which the following motions are possible"
        )
    if along_path:
        return "continuity", "another configuration: the path can't change the configuration"
    place = next((n for n, one in enumerate(within) if one is chosen), -1)
    needs_trial = place < 0 or number < place or bool(follow(within[place]))
    trouble = follow(q) if needs_trial and number < MOST_TRIED else ""
    if trouble:
        return "fails later", trouble
    if number < place:
        return "works", "nearer, and the following motions are possible, but NEAR selects another one"
    if place >= 0:
        worked = (
            "; the following motions are possible from here" if needs_trial and number < MOST_TRIED else ""
        )
        return "farther", f"farther than the chosen one{worked}"
    return "works", "within limits"


def excess_text(robot: Robot, excess: Array) -> str:
    """Return the joints that are beyond their limits, in words: `J3 12.5 deg above, J5 3 deg below its
    limit`.
    """
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


def _is_same(q: Array, other: Array) -> bool:
    return bool(np.abs(q - other).max() < SAME)
