"""Find when the rules in a plan are in force (KEEP and `[[keep]]`), and compute the angles and distances that
they limit at given joint positions, for display.

These values are samples; only the certificate proves that a rule is kept.
"""

from __future__ import annotations

import numpy as np

from yarclang.cell.keeping import LEAST_SIGHT, Height, Keep, Sight, Tilt
from yarclang.frozen import frozen
from yarclang.hir import Motion
from yarclang.motion.plan import MotionPlan
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.robot.model import Array, Chain
from yarclang.units import DEG, MM


@frozen(eq=False)
class HeldRule:
    """A KEEP rule, with the times at which it is in force.

    Attributes:
        keep: the rule.
        begins: (k,) times at which it comes into force [s], increasing.
        ends: (k,) times at which it ceases to be in force [s].
    """

    keep: Keep
    begins: Array
    ends: Array


@frozen(eq=False)
class Quantity:
    """An angle or a distance that a KEEP rule limits, at N instants.

    Attributes:
        name: "angle" or "distance".
        unit: "deg" or "mm".
        values: (N,) in the unit.
        least: lower limit in the unit; None without one.
        most: upper limit in the unit; None without one.
    """

    name: str
    unit: str
    values: Array
    least: float | None
    most: float | None


def held_rules(plan: MotionPlan) -> tuple[HeldRule, ...]:
    """Return the rules that a plan's motions keep, with the times at which they are in force: first those of
    the cell, then those of the program in the order in which they begin.

    A rule is in force during each motion to which it applies. It is also in force during the rest between two
    successive motions to which it applies.
    """
    cell = plan.program.cell
    of_cell = () if cell is None else cell.rules
    found: dict[str, tuple[Keep, list[int]]] = {}
    for number, motion in enumerate(plan.motions):
        step = plan.program.steps[motion.step]
        for keep in (*of_cell, *(step.keeps if isinstance(step, Motion) else ())):
            found.setdefault(f"{keep.of_cell} {keep.told}", (keep, []))[1].append(number)
    held = []
    for keep, numbers in sorted(found.values(), key=lambda one: not one[0].of_cell):
        of = np.array(numbers)
        breaks = np.flatnonzero(np.diff(of) > 1)
        first = of[np.concatenate(([0], breaks + 1))]
        last = of[np.concatenate((breaks, [len(of) - 1]))]
        held.append(HeldRule(keep, plan.begins[first], plan.ends[last]))
    return tuple(held)


def measured(keep: Keep, chain: Chain, q: Array) -> tuple[Quantity, ...]:
    """Return the angle, the distance, or both, that a KEEP rule limits, at given joint positions.

    Args:
        keep: the rule.
        chain: the robot's joints.
        q: (N, n) joint positions [rad or m].
    """
    region, flange = keep.region, flange_poses(chain, q)
    turn, place = flange[:, :3, :3], flange[:, :3, 3]
    match region:
        case Tilt():
            angle = _between(turn @ np.array(region.own), np.array(region.up)) / DEG
            return (Quantity("angle", "deg", angle, None, region.limit / DEG),)
        case Height():
            above = (turn @ np.array(region.own) + place) @ np.array(region.up) - region.level
            return (Quantity("distance", "mm", above / MM, region.limit / MM, None),)
        case Sight():
            carried, spot = turn @ np.array(region.own) + place, np.array(region.spot)
            way = spot - carried if region.is_carried else carried - spot
            axis = turn @ np.array(region.axis) if region.is_carried else np.array(region.axis)
            seen = Quantity("angle", "deg", _between(way, axis) / DEG, None, region.limit / DEG)
            has_near, has_far = region.near > LEAST_SIGHT, bool(np.isfinite(region.far))
            if not has_near and not has_far:
                return (seen,)
            away = np.linalg.norm(way, axis=1) / MM
            far = region.far / MM if has_far else None
            return seen, Quantity("distance", "mm", away, region.near / MM, far)


def _between(vectors: Array, axis: Array) -> Array:
    """Return the angles (N,) [rad] between vectors (N, 3) and an axis, which is (3,) or (N, 3). The vectors
    may have any length.
    """
    # The arc tangent is exact for small angles too, where the cosine is flat.
    across = np.linalg.norm(np.cross(vectors, axis), axis=1)
    found: Array = np.arctan2(across, (vectors * axis).sum(axis=1))
    return found
