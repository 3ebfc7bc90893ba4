"""Propose joint positions for HOME: near zero, away from limits and singularities."""

from __future__ import annotations

import numpy as np

from yarclang.robot.dynamics import holding_torques
from yarclang.robot.kinematics.search import span, within
from yarclang.robot.kinematics.singularity import smallest_singular_values
from yarclang.robot.model import Array, Chain, Limits, Robot
from yarclang.robot.new.sketch import Given, Said, Sketch
from yarclang.units import DEG, MM

TRIES = 1024
"""Number of joint positions that are tried as HOME."""

ROUND = 5.0
"""HOME has multiples of this [deg, mm] if the limits allow them."""

MOST = 128
"""The largest number of joint positions that are proposed as HOME."""

INNER = 0.8
"""HOME stays within this middle fraction of each joint's range."""

BENT = 0.6
"""Smallest singular value that a joint position needs to be HOME, relative to the upper quartile of all tried
positions. Positions with smaller values are too near to a singularity.
"""


def homes(chain: Chain, sketch: Sketch, given: Given) -> tuple[Said, ...]:
    """Return joint positions that could be HOME, in deg and mm, the best first. If the user gives HOME, it is
    the only one.

    Candidates are the position with all joints at zero and positions from a fixed list, in round numbers. All
    of them are well within limits, and those near a singularity are left out. They are sorted by their
    distance from zero, so that all joints at zero come first if possible. The caller checks them for
    collisions.
    """
    if given.home is not None:
        return (Said(given.home, "given"),)
    units = np.array([DEG if joint.unit == "deg" else MM for joint in sketch.joints])
    low, high = span(chain, _limits(sketch, units))
    middle, half = 0.5 * (low + high), 0.5 * INNER * (high - low)
    target = np.clip(np.zeros(chain.size), middle - half, middle + half)
    tries = np.vstack([target, middle + INNER * (within(chain, _limits(sketch, units), TRIES) - middle)])
    coarse = np.round(tries / units / ROUND) * ROUND * units
    # Use round numbers if the range is wide enough for them.
    tries = np.where(np.abs(coarse - middle) <= half, coarse, tries)
    values = smallest_singular_values(chain, tries, np.eye(4))
    good = values >= BENT * np.quantile(values, 0.75)
    distance = np.square((tries - target) / np.maximum(half, 1e-9)).sum(axis=1)
    order = np.argsort(np.where(good, distance, np.inf), kind="stable")[: min(MOST, int(good.sum()))]
    return tuple(
        Said(
            tuple(round(float(value), 6) + 0.0 for value in tries[at] / units),
            "guess",
            "away from limits and singularities" if tries[at].any() else "all joints at 0",
        )
        for at in order
    )


STANDS = 0.9
"""Largest fraction of each joint's effort limit that gravity may need at HOME, if any candidate allows it."""


def standing(robot: Robot, positions: Array) -> Array:
    """Return the fraction (K, n) of each joint's effort limit that gravity needs at joint positions (K, n)
    [rad or m]. The fraction is 0 if torques aren't checked, or if masses or efforts aren't known.
    """
    dynamics = robot.dynamics
    if dynamics is None or not dynamics.wanted or (dynamics.mass <= 0.0).any():
        return np.zeros_like(positions)
    share: Array = np.abs(holding_torques(robot.chain, dynamics, positions)) / dynamics.effort
    return share


def _limits(sketch: Sketch, units: Array) -> Limits:
    """Return joint limits for a sketch (the values of a new robot.toml). Only the position limits are those
    of the sketch; all other limits are placeholders.
    """
    ends = [joint.position.value if joint.position else (-np.inf, np.inf) for joint in sketch.joints]
    lower, upper = (np.array([end[side] for end in ends]) * units for side in (0, 1))
    ones = np.ones(len(ends))
    return Limits(lower, upper, ones, ones, ones, ones)
