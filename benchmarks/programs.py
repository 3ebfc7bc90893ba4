"""The measured programs. They are generated, and the same in every run."""

from __future__ import annotations

from collections.abc import Iterable
from random import Random

OPENING = "P0001 MOVEJ_RPY_LSPB {TCP} 0 1174.4 1176 0 0 0 [3] (mm,deg,s) {B}"
"""Motion to the pose at which Listing 4 of the paper begins."""

CENTRE = (0.0, 1174.4, 1176.0, 0.0, 0.0, 0.0)
REACH = (70.0, 70.0, 70.0, 4.0, 4.0, 4.0)
"""Largest distance of poses from the centre [mm, deg]. Larger distances would exceed the jerk limit in a
motion of one second.
"""

BENT = (0.0, -6.2, -46.5, 0.0, 52.7, 0.0)
"""Joint positions near the centre [deg]."""


def lines(count: int, seed: int = 1) -> str:
    """Return a move to the centre, then `count` straight lines of 1 s each, all different."""
    random = Random(seed)
    poses = (
        [middle + random.uniform(-reach, reach) for middle, reach in zip(CENTRE, REACH, strict=True)]
        for _ in range(count)
    )
    return _program(f"P{i:05d} MOVEL_RPY_LSPB {_values(pose)} [1]" for i, pose in enumerate(poses, 2))


def joint_moves(count: int, seed: int = 1) -> str:
    """Return a move to the centre, then `count` straight lines in joint space of 1 s each, all different."""
    random = Random(seed)
    goals = ([middle + random.uniform(-6.0, 6.0) for middle in BENT] for _ in range(count))
    return _program(f"P{i:05d} MOVEJ_LSPB {_values(goal)} [1]" for i, goal in enumerate(goals, 2))


def _values(values: list[float]) -> str:
    return " ".join(f"{value:.3f}" for value in values)


def _program(rows: Iterable[str]) -> str:
    return "\n".join(("ROBOT INDUSTRIAL6", "DEFAULT {TCP} (mm,deg,s) {B}", OPENING, *rows, "P99999 STOP", ""))
