"""The path constraints of motions (KEEP and `[[keep]]`), as cones and planes for a picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from yarclang.cell.keeping import LEAST_SIGHT, Height, Keep, Sight, Tilt
from yarclang.cell.model import Cell
from yarclang.hir import FrameLink
from yarclang.report.kept import HeldRule, Quantity, measured
from yarclang.report.solids import Solid, cone
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.robot.model import Array, Robot

MOST_SHOWN = 12
"""Largest number of rules that are shown at an instant."""

_AXIS = 0.3
"""Length of the axis and the cone of UPRIGHT [m]."""
_FAR = 1.0
"""Least length of the cone of a rule without a largest distance [m]. If twice the rule's smallest distance is
longer, that is the cone's length.
"""
_HALF = 0.6
"""Half of the edge length of the drawn part of a plane [m]."""
_WITHIN = 0.01
"""Amount by which a value may exceed its limit and still count as within it [deg or mm]."""


@dataclass(frozen=True, slots=True, eq=False)
class RuleNow:
    """A path constraint (KEEP rule) at an instant.

    Attributes:
        base_from_surface: (4, 4) pose of the cone or plane in {B}.
        pointer: (2, 3) ends of the line that must stay in the cone or above the plane [m].
        quantities: the limited angle or distance, with its limits.
        is_kept: True if all quantities are within their limits.
    """

    base_from_surface: Array
    pointer: Array
    quantities: tuple[Quantity, ...]
    is_kept: bool

    @property
    def figures(self) -> str:
        """The angle and the distance as text, such as "8.96 deg, 640.2 mm"."""
        return ", ".join(f"{float(one.values[0]) + 0.0:.2f} {one.unit}" for one in self.quantities)


@dataclass(frozen=True, slots=True, eq=False)
class ShownRule:
    """A path constraint (KEEP rule) that can be drawn.

    Attributes:
        keep: the rule.
        origin: (3,) origin of the carried frame in {FLANGE} [m].
    """

    keep: Keep
    origin: Array

    def surface(self) -> Solid:
        """Return the cone around its z axis from its apex, or a part of the plane of its x and y axes."""
        region = self.keep.region
        match region:
            case Tilt():
                return cone(region.limit, 0.0, _AXIS)
            case Sight():
                near = region.near if region.near > LEAST_SIGHT else 0.0
                far = region.far if np.isfinite(region.far) else max(_FAR, 2.0 * near)
                return cone(region.limit, near, far)
            case Height():
                corners = _HALF * np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
                return Solid(corners, np.array([[0, 1, 2], [0, 2, 3]]))

    def at(self, robot: Robot, q: Array) -> RuleNow:
        """Return the state of the rule at joint positions (n,) [rad or m]."""
        region, flange = self.keep.region, flange_poses(robot.chain, q[None])[0]
        origin = flange[:3, :3] @ self.origin + flange[:3, 3]
        match region:
            case Tilt():
                place, axis = origin, np.array(region.up)
                pointer = np.array([origin, origin + _AXIS * (flange[:3, :3] @ np.array(region.own))])
            case Sight():
                spot = np.array(region.spot)
                place = origin if region.is_carried else spot
                turn = flange[:3, :3] if region.is_carried else np.eye(3)
                axis = turn @ np.array(region.axis)
                pointer = np.array([place, spot if region.is_carried else origin])
            case Height():
                axis = np.array(region.up)
                # Draw the plane below the frame.
                place = origin - (axis @ origin - region.level - region.limit) * axis
                pointer = np.array([place, origin])
        found = measured(self.keep, robot.chain, q[None])
        return RuleNow(_along(place, axis), pointer, found, all(map(_is_within, found)))


@dataclass(frozen=True, eq=False)
class Rules:
    """The path constraints (KEEP rules) of a program over time.

    Attributes:
        held: the rules, with the times at which they are in force.
        shown: the same rules, for drawing.
    """

    held: tuple[HeldRule, ...]
    shown: tuple[ShownRule, ...]

    def at(self, time: float) -> list[int]:
        """Return the numbers of the rules that are in force at a time [s]."""
        begins, ends, owners = self._times
        return [int(one) for one in np.unique(owners[(begins <= time) & (time <= ends)])]

    @cached_property
    def _times(self) -> tuple[Array, Array, NDArray[np.int64]]:
        begins = np.concatenate([np.zeros(0), *(one.begins for one in self.held)])
        ends = np.concatenate([np.zeros(0), *(one.ends for one in self.held)])
        counts = np.array([len(one.begins) for one in self.held], dtype=np.int64)
        return begins, ends, np.repeat(np.arange(len(counts)), counts)


NO_RULES = Rules((), ())


def rules_of(held: Sequence[HeldRule], robot: Robot, cell: Cell | None) -> Rules:
    """Return the path constraints (KEEP rules) of a program for a picture."""
    return Rules(tuple(held), tuple(ShownRule(one.keep, _origin(one.keep, robot, cell)) for one in held))


def _origin(keep: Keep, robot: Robot, cell: Cell | None) -> Array:
    """Return the origin of the carried frame in {FLANGE} (3,) [m]."""
    if not isinstance(keep.region, Tilt):
        return np.array(keep.region.own)
    if isinstance(keep.carried, FrameLink):
        return _placed(keep.carried)[:3, 3]
    if cell is not None and keep.frame in cell.frames:
        return cell.frames[keep.frame].mount.transform[:3, 3]
    return robot.flange_from_frame.get(keep.frame, np.eye(4))[:3, 3]


def _placed(link: FrameLink) -> Array:
    """Return the pose (4, 4) of a carried frame in {FLANGE}."""
    pose, parent = link.parent_from_frame, link.parent
    while parent is not None:
        pose, parent = parent.parent_from_frame @ pose, parent.parent
    return pose


def _is_within(one: Quantity) -> bool:
    value = float(one.values[0])
    return (one.least is None or value >= one.least - _WITHIN) and (
        one.most is None or value <= one.most + _WITHIN
    )


def _along(place: Array, axis: Array) -> Array:
    """Return a pose (4, 4) at a place with its z axis along a vector of length 1."""
    across = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    across /= np.linalg.norm(across)
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([across, np.cross(axis, across), axis])
    pose[:3, 3] = place
    return pose
