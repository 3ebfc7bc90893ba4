"""The parts (workpieces) and sensors of a cell while a simulated robot moves: poses of parts, values of
sensors.

This module has no clock and does no I/O: its callers pass the time, the changes of outputs, and the positions
of the robot.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache

import numpy as np

from yarclang.cell.model import Cell, Expected, Item, Parts, Present
from yarclang.collision.geometry import Geometry, UnreadableError, geometry_of
from yarclang.collision.scene import scene_of
from yarclang.frozen import frozen
from yarclang.handling.parts import close, first_parts, open_, remove
from yarclang.handling.present import on_cell
from yarclang.robot.kinematics.fk import skew
from yarclang.robot.model import Array, Robot
from yarclang.shapes import Shape

ARRIVES_AFTER = 0.5
"""Time from the moment at which a part has left its place to the arrival of the next part of its kind [s]."""


@frozen(eq=False)
class _Region:
    """Region of space in which a sensor sees bodies.

    Attributes:
        input: variable of the sensor's input.
        inverted: True if the input is on while nothing is in the region.
        geometry: shape of the region.
        transform: pose (4, 4) of the region in the flange or in {B} [m].
        on_flange: True if the sensor is on the flange.
    """

    input: str
    inverted: bool
    geometry: Geometry
    transform: Array
    on_flange: bool


@lru_cache(maxsize=256)
def _geometry(shape: Shape) -> Geometry | None:
    try:
        return geometry_of(shape, hull=True)
    except UnreadableError:  # the collision check reports the shape
        return None


class Sensing:
    """Tracks the parts of a cell, and computes what the cell's sensors see.

    Args:
        robot: the robot in the cell.
        cell: the cell, with parts, grippers and sensors.

    Attributes:
        parts: the parts and their poses.
    """

    def __init__(self, robot: Robot, cell: Cell) -> None:
        self.parts = first_parts(cell)
        self._robot = robot
        self._cell = cell
        self._scene = scene_of(robot, replace(cell, parts=())).value
        self._regions = [
            _Region(one.input, one.inverted, geometry, one.mount.transform, one.mount.on_flange)
            for one in cell.sensors
            if one.region is not None
            and one.mount is not None
            and (geometry := _geometry(one.region)) is not None
        ]
        self._screws = _powers(robot.chain.screws)
        self._before: tuple[bytes, Array] | None = None
        bodies = () if self._scene is None else self._scene.bodies
        self._joints = np.array([body.joint for body in bodies], dtype=np.int64)
        self._middles = np.ones((len(bodies), 4, 1))
        if self._scene is not None:
            self._middles[:, :3, 0] = self._scene.boxes.middle
        self._left: dict[tuple[str, int], float] = {}
        self._seen: dict[str, float] = {}
        self._at: bytes | None = None
        self._state: object = None

    @property
    def watched(self) -> frozenset[str]:
        """Variables of the outputs that grip or remove parts."""
        return frozenset(self._cell.grips) | frozenset(self._cell.removals)

    @property
    def is_needed(self) -> bool:
        """True if there is a sensor."""
        return bool(self._cell.sensors)

    def output_changed(self, variable: str, value: float, q: Array) -> None:
        """Report the value of an output, which may close or open a gripper, or remove parts from the cell.

        Args:
            variable: variable of the output.
            value: value of the output.
            q: (n,) joint positions [rad or m].
        """
        grip, removal = self._cell.grips.get(variable), self._cell.removals.get(variable)
        if grip is not None:
            flange = self.flange(q)
            if value != grip.value:
                self.parts = open_(self.parts, variable, flange)
            elif variable not in self.parts.closed:
                self.parts, _ = close(self.parts, variable, grip, flange, 0)
        if removal is not None and value == removal.value:
            self.parts = remove(self.parts, removal)

    def place(self, parts: Parts, cell: Cell) -> None:
        """Set the places of the cell's parts. `cell` is the cell, as read from its file, to which these
        parts belong.
        """
        self.parts = on_cell(Present(parts), cell, self._cell).parts
        self._left.clear()

    def look(self, q: Array, now: float) -> Mapping[str, float]:
        """Compute what the sensors see.

        Args:
            q: (n,) joint positions [rad or m].
            now: the time [s].

        Returns:
            Values of the sensors' inputs, by variable. If several sensors have the same input, it is on if
            one of the sensors turns it on.
        """
        if self.parts.expected:
            self._arrive(q, now)
        at = q.tobytes()
        if at == self._at and self.parts is self._state:
            return self._seen
        self._at, self._state = at, self.parts
        told: dict[str, float] = {}
        for one, seen in self._told(q):
            told[one] = max(told.get(one, 0.0), float(seen))
        self._seen = told
        return told

    def _told(self, q: Array) -> list[tuple[str, bool]]:
        told = [
            (one.input, bool(self.parts.held(one.gripper)) != one.inverted)
            for one in self._cell.sensors
            if one.gripper is not None
        ]
        if not self._regions or self._scene is None:
            return told
        scene, moved, joints = self._scene, self._moved(q), self._joints
        flange = self.flange(q)
        middles = (moved[joints] @ self._middles)[:, :3, 0]
        solids = [
            (geometry, flange @ pose if one.gripper is not None else pose)
            for one in self.parts.items
            for pose, shape in one.solids
            if (geometry := _geometry(shape))
        ]
        for region in self._regions:
            there = flange @ region.transform if region.on_flange else region.transform
            middle = there[:3, :3] @ region.geometry.middle + there[:3, 3]
            # Of the robot's and the cell's bodies, a sensor sees only those that can move relative to it.
            moves = (joints > 0) & ((joints < self._robot.size) | (not region.on_flange))
            apart = middles - middle
            near = np.sqrt((apart * apart).sum(axis=1)) <= scene.boxes.bound + region.geometry.bound
            sees = any(
                _overlap(region.geometry, there, geometry, pose)
                for geometry, pose in solids
                if math.dist(pose[:3, :3] @ geometry.middle + pose[:3, 3], middle)
                <= geometry.bound + region.geometry.bound
            ) or any(
                _overlap(
                    region.geometry,
                    there,
                    scene.bodies[body].geometry,
                    moved[joints[body]] @ scene.bodies[body].base_from_body,
                )
                for body in np.flatnonzero(moves & near).tolist()
            )
            told.append((region.input, sees != region.inverted))
        return told

    def flange(self, q: Array) -> Array:
        """Return the pose of the flange (4, 4) [m] at joint positions `q` (n,) [rad or m]."""
        pose: Array = self._moved(q)[-1] @ self._robot.chain.base_from_flange
        return pose

    def _moved(self, q: Array) -> Array:
        """Return displacements of the robot's bodies, as (n + 1, 4, 4) [m]. Displacement i is that of all
        bodies that the first i joints move.

        Each displacement maps a body's pose at zero joint positions to its pose at `q` (n,) [rad or m].
        """
        at = q.tobytes()
        if self._before is not None and self._before[0] == at:
            return self._before[1]
        one, two, three = self._screws
        way = q[:, None, None]
        # Product of exponentials: exp(screw q) in closed form, for screws whose axes have length 1 or 0.
        each = np.eye(4) + way * one + (1.0 - np.cos(way)) * two + (way - np.sin(way)) * three
        moved = np.empty((len(q) + 1, 4, 4))
        moved[0] = np.eye(4)
        for joint, step in enumerate(each):
            np.matmul(moved[joint], step, out=moved[joint + 1])
        self._before = at, moved
        return moved

    def _arrive(self, q: Array, now: float) -> None:
        """Add the next parts in places that have been free for long enough."""
        come: list[Expected] = []
        for one in self.parts.expected:
            name = (one.part.body.name, one.number)
            if not self._is_free(one, q):
                self._left.pop(name, None)
            elif now - self._left.setdefault(name, now) >= ARRIVES_AFTER - 1e-9:
                come.append(one)
        if come:
            new = [Item(one.part, one.number, one.part.body.mount.transform.tobytes()) for one in come]
            rest = tuple(one for one in self.parts.expected if one not in come)
            self.parts = replace(self.parts, items=(*self.parts.items, *new), expected=rest)

    def _is_free(self, expected: Expected, q: Array) -> bool:
        """Return True if the next part of a kind has room at its place: the previous part is gone, or is so
        far away that the bounding spheres of both parts don't overlap.
        """
        geometry = _geometry(expected.part.body.shape)
        before = next(
            (
                one
                for one in self.parts.items
                if one.part is expected.part and one.number == expected.number - 1
            ),
            None,
        )
        if before is None or geometry is None:
            return True
        pose = self.flange(q) @ before.transform if before.gripper is not None else before.transform
        return math.dist(pose[:3, 3], expected.part.body.mount.transform[:3, 3]) > 2.0 * geometry.bound


def _powers(screws: Array) -> tuple[Array, Array, Array]:
    """Return screws (n, 6) as matrices (n, 4, 4), with their second and third powers."""
    one = np.zeros((len(screws), 4, 4))
    one[:, :3, :3] = skew(screws[:, 3:])
    one[:, :3, 3] = screws[:, :3]
    two = one @ one
    return one, two, two @ one


def _overlap(one: Geometry, here: Array, other: Geometry, there: Array) -> bool:
    """Return True if two shapes overlap at poses (4, 4) [m]."""
    import coal

    first, second = (coal.Transform3s(pose[:3, :3], pose[:3, 3]) for pose in (here, there))
    # The distance can't be used: coal returns up to 1e-6 m for bodies that overlap.
    return bool(
        coal.collide(
            one.of_coal, first, other.of_coal, second, coal.CollisionRequest(), coal.CollisionResult()
        )
    )
