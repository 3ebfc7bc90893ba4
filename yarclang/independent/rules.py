"""Rules to which motions must keep (KEEP), checked without the compiler's code."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from yarclang.independent.arm import Arm, Array


@dataclass(frozen=True)
class Rule:
    """A rule of a KEEP, by `kind`.

    `upright`: the z axis of a frame that is turned by `turn` from {TCP} is within `limit` [deg] of the z axis
    of {B}.
    `above`: the origin of {TCP} is at least `limit` [mm] above the origin of {B}.
    """

    kind: str
    limit: float
    turn: Any = None


SLACK = {"upright": 1e-4, "above": 1e-4}
"""Amount by which rounding may break a rule at a sample [deg, mm]."""


def broken(arm: Arm, rules: tuple[Rule, ...], q: Array) -> Iterator[str]:
    """Yield a sentence for each rule that is broken at joint positions (N, n) [deg, mm]."""
    if not rules:
        return
    points, turns = arm.poses(q)
    for one in rules:
        if one.kind == "above":
            by = one.limit - float(points[:, 2].min())
        else:
            upwards = (turns * one.turn).as_matrix()[:, 2, 2]
            by = float(np.degrees(np.arccos(np.clip(upwards, -1.0, 1.0))).max()) - one.limit
        if by > SLACK[one.kind]:
            yield f"breaks {one.kind} {one.limit:g} by {by:.5f}"
