"""Description of the bodies around the arm in a proof.

It contains their poses, the commands during which they are present, and the pairs that may touch.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import combinations
from typing import Any

import numpy as np

from yarclang import hir
from yarclang.cell.model import Cell, HalfSpace, JointWindow, Unplaced, Zone
from yarclang.certify.bodies.handled import follow
from yarclang.certify.bodies.zones import moving_of
from yarclang.certify.kinematics.arm import axes_of, steps_of
from yarclang.certify.read.layout import Layout
from yarclang.collision.geometry import Geometry, geometry_of
from yarclang.collision.scene import Body, Rows, Scene, scene_of
from yarclang.collision.zones.regions import faces_of
from yarclang.collision.zones.watched import Item, Moving, bodies_of, room_of
from yarclang.collision.zones.workspace import watches_of
from yarclang.frozen import frozen
from yarclang.robot.model import Array, Robot
from yarclang.verify.conditions import Slow
from yarclang.verify.room import Pair

_GRID = 1e-6
"""Grid to which the corners of meshes are rounded in a proof [m]. Meshes are grown by the same distance to
cover the rounding.
"""


@frozen(eq=False)
class Needed:
    """The pairs that must be proved apart: two bodies, or a body and the region of a zone.

    Attributes:
        items: the bodies, in the order of the proof.
        pairs: the pairs, as indices of `items`.
        needs: for each pair, the stretches of time during which it must stay apart: begin and end [parts of a
            segment], and margin [m].
        speeds: (K,) speed that a body must not exceed inside a slow zone [m/s]; 0 for other pairs.
    """

    items: list[Item]
    pairs: list[tuple[int, int]]
    needs: list[list[tuple[int, int, float]]]
    speeds: Array

    def stretches(self) -> tuple[Rows, Rows, Rows, Array]:
        """Return the stretches of time to prove: begins, ends, pairs to keep apart, margins [m]."""
        rows = [(*need, pair) for pair, needs in enumerate(self.needs) for need in needs]
        begin, end, margin, pair = zip(*rows, strict=True) if rows else ((), (), (), ())
        whole = [np.array(column, dtype=np.int64) for column in (begin, end, pair)]
        return whole[0], whole[1], whole[2], np.array(margin, dtype=np.float64)

    @classmethod
    def of(cls, items: list[Item], pairs: Sequence[Pair], unit: int) -> Needed:
        """Convert the pairs that the checker demands to floating-point data.

        Args:
            items: the bodies, in the order of the proof.
            pairs: the checker's pairs.
            unit: the checker's integer for 1 m, and for 1 m/s.
        """
        needs = [[(begin, end, least / unit) for begin, end, least in pair.needs] for pair in pairs]
        fast = [max([0, *(one.speed for one in pair.conditions if isinstance(one, Slow))]) for pair in pairs]
        return cls(items, [(pair.one, pair.other) for pair in pairs], needs, np.array(fast) / unit)


@frozen(eq=False)
class During:
    """Surroundings of the arm during a command: the cell's state, and the frame that the command moves."""

    cell: Cell | None
    moving: Moving


def commands_of(layout: Layout, program: hir.Program, robot: Robot) -> dict[int, During]:
    """Return the surroundings of the arm during each command with moves, by the command's step."""
    handled, _ = follow(layout, program, robot)
    places = [place for place in layout.places if place.size]
    return {place.step: During(handled.at(place.step), moving_of(place.motion, robot)) for place in places}


class Room:
    """Description of the bodies and zones in a proof, from the surroundings of the arm during each command.

    Attributes:
        told: the description: `bodies`, `zones`, and `exceptions`, the pairs that may be nearer than their
            margins.
        items: the bodies, followed by the regions that zones keep bodies out of, for the search of planes.
    """

    def __init__(self, commands: Mapping[int, During], robot: Robot) -> None:
        self.robot, self.commands, self.moving = robot, commands, list(commands)
        self.items: list[Item] = []
        self.bodies: list[dict[str, Any]] = []
        self._numbers: dict[Hashable, int] = {}
        self._there: dict[int, list[int]] = {}
        self._scenes = [self._scene(one.cell) for one in commands.values()]
        exceptions = self._exceptions()
        zones, regions = self._zones()
        for number, body in enumerate(self.bodies):
            if len(self._there[number]) < len(self.moving):
                body["during"] = _ranges(self._there[number], self.moving)
        self.items += regions
        self.told = {"bodies": self.bodies, "exceptions": exceptions, "zones": zones}

    def _scene(self, cell: Cell | None) -> Scene:
        made = scene_of(self.robot, cell).value
        if made is None:  # the judge rejects a text with such a mesh earlier
            raise ValueError("the bodies can't be read")
        return made

    def _number(self, key: Hashable, item: Item, step: int, told: Callable[[], dict[str, Any]]) -> int:
        """Return the number of a body in the proof, and store that the body is present during `step`. A new
        body is added to the proof.
        """
        if key not in self._numbers:
            self._numbers[key] = len(self.bodies)
            self._there[len(self.bodies)] = []
            self.items.append(item)
            self.bodies.append(told())
        number = self._numbers[key]
        if step not in self._there[number][-1:]:
            self._there[number].append(step)
        return number

    def _body(self, body: Body, step: int) -> int:
        placed = body.base_from_body.tobytes()
        key = body.name, body.joint, placed, id(body.geometry), body.margin
        return self._number(key, room_of(body), step, lambda: _told(body, self.robot))

    def _exceptions(self) -> list[list[Any]]:
        """Return the pairs that may touch or be nearer than their margins, each with a range of commands."""
        found: dict[tuple[int, int, float | None], list[int]] = {}
        for step, scene in zip(self.moving, self._scenes, strict=True):
            own = [self._body(body, step) for body in scene.bodies]
            pairs = scene.pairs
            ends = (np.array(own)[side].tolist() for side in (pairs.first, pairs.second)) if own else ((), ())
            least = {
                (min(pair), max(pair)): margin
                for *pair, margin in zip(*ends, pairs.margin.tolist(), strict=True)
            }
            for one, other in combinations(range(len(own)), 2):
                first, second = scene.bodies[one], scene.bodies[other]
                pair = min(own[one], own[other]), max(own[one], own[other])
                kept = least.get(pair)
                if first.joint != second.joint and kept != max(first.margin, second.margin):
                    found.setdefault((*pair, kept), []).append(step)
        return [
            [one, other, kept, *ends]
            for (one, other, kept), steps in found.items()
            for ends in _ranges(steps, self.moving)
        ]

    def _zones(self) -> tuple[list[dict[str, Any]], list[Item]]:
        """Return the descriptions of the zones, and the zones' regions as bodies for the search of planes."""
        told: dict[str, dict[str, Any]] = {}
        regions: dict[str, list[Item]] = {}
        for step, scene, during in zip(self.moving, self._scenes, self.commands.values(), strict=True):
            if during.cell is None:
                continue
            body_of = {id(item): body for body, item in bodies_of(scene)}
            for watch in watches_of(self.robot, during.cell, during.moving):
                zone, item = watch.zone, watch.item
                if zone.keep is not None:
                    continue  # the small checker reads such a rule (KEEP) from the map of the text
                if zone.name not in told:
                    told[zone.name], regions[zone.name] = told_zone(zone, self.robot.axis_units)
                if item is None:
                    continue
                if id(item) in body_of:
                    number = self._body(body_of[id(item)], step)
                else:
                    number = self._point(item, step)
                watched = told[zone.name]["watched"]
                if number not in watched:
                    watched.append(number)
        return list(told.values()), [item for items in regions.values() for item in items]

    def _point(self, item: Item, step: int) -> int:
        def told() -> dict[str, Any]:
            pose = np.eye(4)
            pose[:3, 3] = (np.linalg.inv(_link(item.joint, self.robot)) @ np.append(item.middle, 1.0))[:3]
            shape = {"core": [0, 0, 0], "disc": 0, "radius": 0, "pose": told_frame(pose)}
            return {"name": item.name, "joint": item.joint, "margin": 0, "point": True} | shape

        return self._number((item.name, item.joint, item.middle.tobytes()), _solid(item), step, told)


def told_arm(robot: Robot) -> dict[str, Any]:
    """Return the description of an arm: the kinds of its joints, and the frames between them."""
    kinds = ["turns" if one else "slides" for one in (axes_of(robot.chain).turn == 1.0).tolist()]
    return {"kinds": kinds, "arm": [told_frame(step) for step in steps_of(robot.chain)]}


def told_frame(pose: Array) -> list[float]:
    """Return the three upper rows of a frame (4, 4)."""
    return [float(one) for one in pose[:3].ravel()]


def in_units(numbers: Array) -> list[float | None]:
    """Return numbers in the units of robot.toml, rounded to 13 digits; None for infinity.

    The rounding restores the digits that robot.toml has, since conversion to SI units and back changes the
    last digits.
    """
    return [float(f"{one:.13g}") if np.isfinite(one) else None for one in numbers.tolist()]


def exactly(told: Any) -> Any:
    """Return a description as the checker reads it, with exact numbers."""
    return json.loads(json.dumps(told), parse_float=Fraction, parse_int=Fraction)


def _ranges(steps: Iterable[int], moving: Sequence[int]) -> list[list[int]]:
    """Return the first and last steps of the runs of consecutive steps with moves."""
    place = {step: number for number, step in enumerate(moving)}
    found: list[list[int]] = []
    for step in steps:
        if found and place[step] == place[found[-1][1]] + 1:
            found[-1][1] = step
        else:
            found.append([step, step])
    return found


def _solid(point: Item) -> Item:
    """Return a point with a tiny ball as its shape, because distances are computed between shapes."""
    import coal

    placed = np.eye(4)
    placed[:3, 3] = point.middle
    return replace(point, of_coal=coal.Sphere(1e-6), base_from_body=placed)


def _link(joint: int, robot: Robot) -> Array:
    """Return base_from_link (4, 4) of the link that the first `joint` joints move, all joints at zero."""
    link = np.eye(4)
    for step in steps_of(robot.chain)[:joint]:
        link = link @ step
    return link


def _told(body: Body, robot: Robot) -> dict[str, Any]:
    """Return the description of a body on the link that carries it [m]."""
    back = np.linalg.inv(_link(body.joint, robot))
    geometry, item = body.geometry, room_of(body)
    told: dict[str, Any] = {"name": body.name, "joint": body.joint, "margin": body.margin}
    if geometry.corners is None and not geometry.is_hollow:
        return told | told_shape(back @ body.base_from_body, geometry)
    pose = np.eye(4)
    pose[:3, 3] = back[:3, :3] @ item.middle + back[:3, 3]
    corners = item.points @ back[:3, :3].T + back[:3, 3] - pose[:3, 3]
    told |= {"core": [0, 0, 0], "disc": 0, "radius": _GRID, "pose": told_frame(pose)}
    # The corners are in the order of the mesh: the checker compares those of a part on the ground and on the
    # arm one by one.
    return told | {"corners": np.round(np.round(corners / _GRID) * _GRID, 9).tolist()}


def told_shape(pose: Array, geometry: Geometry) -> dict[str, Any]:
    """Return the description of a simple shape, such as a sphere or a box, at a pose (4, 4)."""
    placed = pose.copy()
    placed[:3, 3] += pose[:3, :3] @ geometry.middle
    shape = {"core": geometry.core.tolist(), "disc": geometry.disc, "radius": geometry.radius}
    return shape | {"pose": told_frame(placed)}


def told_zone(zone: Zone, units: Array) -> tuple[dict[str, Any], list[Item]]:
    """Return the description of a zone, and the regions to stay out of, in the checker's order.

    Args:
        zone: the zone.
        units: (n,) units of the joints [rad or m], for ranges of joints.
    """
    told: dict[str, Any] = {"name": zone.name, "rule": zone.rule, "margin": zone.margin, "region": None}
    told["watched"] = []
    if zone.speed is not None:
        told["speed"] = zone.speed
    if zone.posture is not None:
        told["posture"] = _window(zone.posture, units)
    region = zone.region
    if isinstance(region, JointWindow):
        return told | {"window": _window(region, units)}, [everywhere(zone.name)]
    if isinstance(region, Unplaced):
        return told, []
    if isinstance(region, HalfSpace):
        told["region"] = {"pose": told_frame(region.base_from_plane)}
        sign = -1.0 if zone.rule == "allowed" else 1.0
        borders = [(sign * region.normal, sign * region.offset)]
    else:
        geometry = geometry_of(region.shape)
        told["region"] = told_shape(region.base_from_shape, geometry)
        if zone.rule != "allowed":
            return told, [
                room_of(Body(zone.name, 0, region.base_from_shape, geometry, 0.0, False, False, False))
            ]
        faces = faces_of(region)
        if faces is None:
            return told, [everywhere(zone.name)]
        borders = list(zip(faces.normals, faces.offsets.tolist(), strict=True))
    return told, [border(zone.name, normal, offset) for normal, offset in borders]


def _window(window: JointWindow, units: Array) -> list[tuple[float | None, float | None]]:
    """Return the ranges of joints in the units of robot.toml; None for an end that isn't limited."""
    return list(zip(in_units(window.lower / units), in_units(window.upper / units), strict=True))


def everywhere(name: str) -> Item:
    """Return a half-space that contains all bodies. It is the region of a condition that must hold
    everywhere.
    """
    return border(name, np.array([0.0, 0.0, 1.0]), -1e6)


def border(name: str, normal: Array, offset: float) -> Item:
    """Return the half-space normal . p >= offset in the form of a body.

    Its `axis` is the normal, `bound` is infinite, and `points` has one point of the plane.
    """
    point = normal[None] * offset
    return Item(name, 0, point, normal, 0.0, 0.0, point, point[0], np.inf)
