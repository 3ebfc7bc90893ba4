"""Read the zones of a cell: the keys of each shape and rule, and their values in SI."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from yarclang.cell.bodies import Surroundings, Units, belong, mounted, simple_shape
from yarclang.cell.keeping import Pointed
from yarclang.cell.measures import Measures
from yarclang.cell.model import PARTS, Array, HalfSpace, JointWindow, Mount, Region, ShapeRegion, Zone
from yarclang.cell.schema import ZoneTable
from yarclang.cell.windows import joint_window
from yarclang.robot.kinematics.elbow import elbow_of
from yarclang.robot.model import Robot
from yarclang.shapes import Box, Capsule, Cylinder, Sphere
from yarclang.subjects import Name
from yarclang.toml.bodies import SIZES
from yarclang.toml.draft import table_name
from yarclang.toml.file import did_you_mean
from yarclang.toml.places import Path
from yarclang.transforms import constant
from yarclang.units import MM

_TURNED = ("xyz", "rpy", "quat")

_SHAPES: Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    **{name: (("frame", *sizes), _TURNED) for name, sizes in SIZES.items() if name != "mesh"},
    "half-space": (("frame", "normal"), ("xyz",)),
    "joints": (("joints",), ()),
}
"""The required and the optional keys of each shape of a zone."""

_OF_SHAPES = ("frame", "size", "radius", "length", "normal", "joints", *_TURNED)

_RULES: Mapping[str, tuple[str, ...]] = {
    "allowed": (),
    "forbidden": (),
    "slow": ("speed",),
    "posture": ("joints",),
}
"""The keys that each rule needs."""


def read_zone(table: ZoneTable, path: Path, around: Surroundings) -> Zone | None:
    """Read a zone of a cell.toml, and report its mistakes. Return None if it has mistakes, or if it depends
    on a robot and the robot isn't known.
    """
    measures = around.measures
    units = measures.of_entry(table.units, path)
    is_shaped, is_ruled = _has_keys_of_shape(table, path, around), _has_keys_of_rule(table, path, around)
    region = _region(table, path, units, around) if is_shaped else None
    watch = _watched(table.watch, (*path, "watch"), around)
    margin = measures.factor(units, "length", (*path, "margin")) if table.margin else 1.0
    posture: JointWindow | None = None
    if is_ruled and table.rule == "posture" and table.joints is not None:
        posture = joint_window(table.joints, (*path, "joints"), units, measures, around.robot)
        is_ruled = posture is not None
    speed: float | None = None
    if table.speed is not None:
        length = measures.factor(units, "length", (*path, "speed"))
        time = measures.factor(units, "time", (*path, "speed"))
        if length is None or time is None:
            return None
        speed = table.speed * length / time
    if not is_ruled or table.name is None or table.rule is None or region is None:
        return None
    if watch is None or margin is None:
        return None
    zone = Zone(table.name.upper(), table.rule, region, speed, watch, (table.margin or 0.0) * margin, posture)
    thin = _too_thin(zone)
    if thin is not None:
        message, remedy = thin
        measures.file.say("Y1376", path, f"{table_name(path)} {message}", remedy)
        return None
    return zone


THINNEST, NARROWEST = 1e-4, 1e-4
"""Smallest allowed thickness of a zone including its margins [m], and smallest allowed width of a joint
window [rad or m]. Zones with the rule `allowed` may be smaller.

Both are several times the resolution of a proof, so that no motion crosses a zone unnoticed.
"""


def _too_thin(zone: Zone) -> tuple[str, str] | None:
    """Return a message and a remedy if a zone is so thin that a motion could cross it unnoticed; None for
    other zones.
    """
    if zone.rule == "allowed" or isinstance(zone.region, HalfSpace | Pointed):
        return None
    if isinstance(zone.region, JointWindow):
        if float((zone.region.upper - zone.region.lower).min()) >= NARROWEST:
            return None
        remedy = f"Make it at least {NARROWEST:g} rad or m wide."
        return "is too narrow to be proved: a joint could cross it between two checks.", remedy
    match zone.region.shape:
        case Box(size=size):
            thick = float(size.min())
        case Cylinder(radius=radius, length=length):
            thick = min(2.0 * radius, length)
        case Sphere(radius=radius) | Capsule(radius=radius):
            thick = 2.0 * radius
    thick += 2.0 * zone.margin
    if thick >= THINNEST:
        return None
    remedy = f"Make it at least {THINNEST / MM:g} mm thick, or give it a margin."
    return (
        f"is {thick / MM:.3g} mm thick, too thin to be proved: a point could cross it between two checks.",
        remedy,
    )


def _has_keys_of_shape(table: ZoneTable, path: Path, around: Surroundings) -> bool:
    """Return True if a zone has the keys that its shape needs, and no keys of other shapes; otherwise report
    the wrong keys.
    """
    if table.shape is None:
        return False
    if table.rule == "posture" and table.shape == "joints":
        message = f'{table_name(path)} is a joint window with rule = "posture": both would limit the joints.'
        remedy = (
            'Give it a shape in space, such as "box", or write rule = "allowed" to keep the joints in the '
            "window."
        )
        around.measures.file.say("Y1305", (*path, "shape"), message, remedy)
        return False
    needed, optional = _SHAPES[table.shape]
    optional += ("joints",) if table.rule == "posture" else ()
    sound = belong(table, path, table.shape, needed, _OF_SHAPES, around, optional)
    if table.shape == "joints":
        watches = ("watch",) if table.rule == "slow" else ()
        sound &= belong(table, path, "joints", (), ("watch", "margin"), around, watches)
    return sound


def _has_keys_of_rule(table: ZoneTable, path: Path, around: Surroundings) -> bool:
    """Return True if a zone has the keys that its rule needs, and no keys of other rules; otherwise report
    the wrong keys.
    """
    if table.rule is None:
        return False
    every = ("speed", "joints") if table.rule == "posture" else ("speed",)
    return belong(table, path, table.rule, _RULES[table.rule], every, around)


def _region(table: ZoneTable, path: Path, units: Units, around: Surroundings) -> Region | None:
    """Return the region of a zone in {B}, or in joint space. Report a wrong entry, and return None for it."""
    measures = around.measures
    if table.shape == "joints" and table.joints is not None:
        return joint_window(table.joints, (*path, "joints"), units, measures, around.robot)
    mount = mounted(table, path, units, around)
    if mount is not None and mount.on_flange:
        message = f"{table_name(path)} is fixed to {table.frame}, which the robot carries."
        measures.file.say(
            "Y1371", (*path, "frame"), message, "A zone can't move: name B, or a frame that is fixed to B."
        )
        return None
    if table.normal is not None:
        return _half_space(table.normal, (*path, "normal"), mount, measures)
    shape = simple_shape(table, path, units, around)
    return None if mount is None or shape is None else ShapeRegion(mount.transform, shape, mount.told)


def _half_space(
    values: Sequence[float], path: Path, mount: Mount | None, measures: Measures
) -> HalfSpace | None:
    if not measures.sized(values, 3, path):
        return None
    given: Array = np.array(values)
    norm = float(np.linalg.norm(given))
    if norm < 1e-9:
        measures.file.say("Y1308", path, "The normal has no direction: its length is 0.", "Write [0, 0, 1].")
        return None
    if mount is None:
        return None
    normal = mount.transform[:3, :3] @ (given / norm)
    return HalfSpace(constant(normal), float(normal @ mount.transform[:3, 3]), mount.told, constant(given))


def _watched(names: Sequence[str] | None, path: Path, around: Surroundings) -> tuple[str, ...] | None:
    """Return the names of the bodies and points that a zone watches. Report a wrong entry, and return None
    for it.
    """
    if names is None:
        return ("tool",)
    file, robot = around.measures.file, around.robot
    if not names:
        file.say(
            "Y1308", path, "The list watch of the zone is empty.", f"Write {_FOR_EXAMPLE}, or remove watch."
        )
        return None
    sound = True
    links = dict.fromkeys(shape.link for shape in robot.shapes) if robot else {}
    chosen: list[str] = []
    for at, name in enumerate(names):
        part = name.lower() if name.lower() in PARTS else name
        if part in chosen:
            file.say("Y1311", (*path, at), f"{part[:40]} is named twice.", "Name it once.")
            sound = False
        elif robot is not None and (fault := _unknown(part, robot, links)) is not None:
            file.say("Y0906", (*path, at), *fault)
            sound = False
        chosen.append(part)
    return tuple(chosen) if sound else None


_FOR_EXAMPLE = 'watch = ["tool", "elbow"]'


def _unknown(part: str, robot: Robot, links: Mapping[str, None]) -> tuple[str, str, Name] | None:
    """Return the reason why a robot doesn't have the body or point that a zone watches, the remedy, and the
    name; None if the robot has it.
    """
    if part == "elbow":
        if elbow_of(robot.chain) is None:
            return f"{robot.name} has no elbow.", "Name the links to watch.", Name(part)
    elif part == "arm":
        if not any(shape.joint for shape in robot.shapes):
            return (
                f"{robot.name} has no link with a shape.",
                "Add <collision> shapes to its URDF.",
                Name(part),
            )
    elif part not in PARTS and part not in links:
        message = f"{robot.name} has no link {part[:40]} with a shape."
        return message, *did_you_mean(part, {*PARTS, *links})
    return None
