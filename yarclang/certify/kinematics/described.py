"""The judge's description of a robot, read from the contents of robot.toml and of the URDF.

The judge has its own readers and conventions. The contents come with the robot (`Robot.written`) as they were
first read, so that a later change of the files has no effect. A robot without files is defined only by its
numbers. The judge uses them unchanged, with its own kinematics.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any
from xml.etree import ElementTree
from xml.parsers import expat

import numpy as np

from yarclang.certify.kinematics.arm import KINEMATICS
from yarclang.certify.kinematics.rotations import inverse, of_numbers
from yarclang.frozen import frozen
from yarclang.robot.model import (
    Actuation,
    Array,
    Chain,
    Dynamics,
    Limits,
    LinkShape,
    Robot,
    Tool,
    ToolShape,
    Written,
)
from yarclang.shapes import Box, Capsule, Cylinder, Mesh, Shape, Sphere

_DEGREE = np.pi / 180.0
_MILLIMETRE = 1e-3
_MOVING = ("revolute", "continuous", "prismatic")
_FLANGE = "FLANGE"
_GRAVITY = 9.81
"""Gravity along the negative z axis of the URDF's root, unless robot.toml gives another one [m/s^2]."""


@frozen(eq=False)
class _Joint:
    """A joint of the URDF.

    Attributes:
        name: name of the joint.
        kind: type of the joint in the URDF.
        parent: name of the parent link.
        child: name of the child link.
        parent_from_joint: (4, 4) frame of the joint in the parent link, with the joint at zero [m].
        axis: (3,) unit vector of the axis.
    """

    name: str
    kind: str
    parent: str
    child: str
    parent_from_joint: Array
    axis: Array


@frozen(eq=False)
class _Tree:
    """The content of a URDF, by links.

    Attributes:
        above: for each link, the joint that connects it to its parent.
        shapes: for each link, its collision shapes with their poses in the link (4, 4); None in place of a
            mesh.
        efforts: effort limits of the joints that have one [N m or N].
    """

    above: Mapping[str, _Joint]
    shapes: Mapping[str, tuple[tuple[Array, Shape | None], ...]]
    efforts: Mapping[str, float]


@frozen
class Ends:
    """Names of the links that define {B} and {FLANGE}."""

    base: str
    flange: str


def ends_of(written: Written) -> Ends:
    """Return the names of the links at both ends of an arm."""
    table = tomllib.loads(written.toml)
    return Ends(table["base"], table["flange"])


class ContradictionError(Exception):
    """The robot contradicts the contents of its files; the message says where."""


@lru_cache(maxsize=64)
def own_robot(robot: Robot) -> Robot:
    """Return the robot as the judge reads it from its files, with the judge's own kinematics.

    Geometry, frames, tools, limits and actuation are read again.

    Raises:
        ContradictionError: the files describe another robot, or cannot be read.
    """
    if robot.written is None:
        chain = Chain(robot.chain.screws, robot.chain.base_from_flange, KINEMATICS)
        return replace(robot, chain=chain)
    try:
        table, tree = tomllib.loads(robot.written.toml), _read_urdf(robot.written.urdf)
        base, flange = table["base"], table["flange"]
        moving = [joint for joint in _between(tree, base, flange) if joint.kind in _MOVING]
        if tuple(joint.name for joint in moving) != robot.joint_names:
            raise ContradictionError("the joints between base and flange differ")
        # All transforms are with the joints at zero: from the root of the URDF to the base, and from there to
        # each joint.
        base_from_root = inverse(_place(tree, base)[0])
        screws = np.array([_screw(base_from_root @ _place(tree, joint.child)[0], joint) for joint in moving])
        chain = Chain(_sealed(screws), _sealed(base_from_root @ _place(tree, flange)[0]), KINEMATICS)
        frames = _frames(table)
        units = np.array([_MILLIMETRE if joint.kind == "prismatic" else _DEGREE for joint in moving])
        return replace(
            robot,
            chain=chain,
            limits=_limits(table, robot.joint_names, units),
            flange_from_frame=frames,
            actuation=_actuation(table, robot.size),
            shapes=_link_shapes(
                robot.shapes,
                tree,
                base_from_root,
                robot.joint_names,
                table.get("collision", {}).get("pieces", {}),
            ),
            tools=_tools(robot.tools, table, frames),
            dynamics=_dynamics(robot.dynamics, table, tree, moving, base_from_root),
        )
    except (ValueError, TypeError, LookupError, RecursionError, expat.ExpatError) as error:
        raise ContradictionError(
            f"its files can't be read again ({type(error).__name__}: {error})"
        ) from error


def _read_urdf(text: str) -> _Tree:
    # As other readers of URDF do, ignore namespaces, and decode as UTF-8 even if the text declares otherwise.
    builder = ElementTree.TreeBuilder()
    parser = expat.ParserCreate("utf-8")
    parser.StartElementHandler, parser.EndElementHandler = builder.start, builder.end
    parser.Parse(text, True)
    root = builder.close()
    above: dict[str, _Joint] = {}
    efforts: dict[str, float] = {}
    for element in root.findall("joint"):
        axis = np.array(_numbers(element.find("axis"), "xyz", (1.0, 0.0, 0.0)))
        joint = _Joint(
            element.attrib["name"],
            element.attrib["type"],
            _link(element, "parent"),
            _link(element, "child"),
            _origin(element),
            axis / np.sqrt(axis @ axis) if axis.any() else axis,
        )
        above[joint.child] = joint
        (effort,) = _numbers(element.find("limit"), "effort", (0.0,))
        if effort > 0.0:
            efforts[joint.name] = effort
    shapes = {
        link.attrib["name"]: tuple((_origin(one), _size(one)) for one in link.findall("collision"))
        for link in root.findall("link")
    }
    return _Tree(above, shapes, efforts)


def _link(element: ElementTree.Element, key: str) -> str:
    found = element.find(key)
    if found is None:
        raise KeyError(key)
    return found.attrib["link"]


def _numbers(
    element: ElementTree.Element | None, key: str, otherwise: tuple[float, ...]
) -> tuple[float, ...]:
    if element is None or key not in element.attrib:
        return otherwise
    return tuple(float(number) for number in element.attrib[key].split())


def _origin(element: ElementTree.Element) -> Array:
    """Return the transform (4, 4) of an <origin>, given in metres and fixed-axis angles [rad]."""
    origin = element.find("origin")
    nothing = (0.0, 0.0, 0.0)
    return of_numbers(np.array(_numbers(origin, "xyz", nothing) + _numbers(origin, "rpy", nothing)))


def _size(element: ElementTree.Element) -> Shape | None:
    """Return the shape of a <collision> [m]; None for a mesh."""
    for one in element.findall("geometry/*"):
        if one.tag == "box":
            return Box(_sealed(np.array(_numbers(one, "size", ()))))
        if one.tag == "sphere":
            (radius,) = _numbers(one, "radius", ())
            return Sphere(radius)
        if one.tag in {"cylinder", "capsule"}:
            (radius,), (length,) = _numbers(one, "radius", ()), _numbers(one, "length", ())
            return Cylinder(radius, length) if one.tag == "cylinder" else Capsule(radius, length)
    return None


def _between(tree: _Tree, base: str, flange: str) -> list[_Joint]:
    """Return the joints from one link to another, starting at the base."""
    joints, here = [], flange
    while here != base:
        joints.append(tree.above[here])
        here = joints[-1].parent
    return joints[::-1]


def _place(tree: _Tree, link: str) -> tuple[Array, tuple[str, ...]]:
    """Return root_from_link (4, 4) with all joints at zero, and the names of the joints in between."""
    placed, names = np.eye(4), []
    while link in tree.above:
        joint = tree.above[link]
        placed = joint.parent_from_joint @ placed
        names.append(joint.name)
        link = joint.parent
    return placed, tuple(names)


def _screw(base_from_joint: Array, joint: _Joint) -> Array:
    """Return the screw (6,) of a joint's axis, linear part first."""
    axis = base_from_joint[:3, :3] @ joint.axis
    if joint.kind == "prismatic":
        return np.concatenate([axis, np.zeros(3)])
    # The screw of a rotation about an axis through p has the linear part p x axis (Lynch and Park, ch. 3.3).
    return np.concatenate([np.cross(base_from_joint[:3, 3], axis), axis])


def _link_shapes(
    known: Sequence[LinkShape],
    tree: _Tree,
    base_from_root: Array,
    moving: tuple[str, ...],
    pieces: Mapping[str, int],
) -> tuple[LinkShape, ...]:
    """Compute the poses and sizes of the collision shapes of all links again.

    Only the content of meshes is taken from the `known` shapes.
    """
    count: dict[str, int] = {}
    shapes = []
    for one in known:
        number = count.get(one.link, 0)
        count[one.link] = number + 1
        placed, above = _place(tree, one.link)
        joint = sum(name in moving for name in above)
        link_from_shape, shape = tree.shapes[one.link][number]
        if (shape is None) != isinstance(one.shape, Mesh):
            raise ContradictionError(f"a collision shape of {one.link} differs")
        if isinstance(one.shape, Mesh) and one.shape.pieces != pieces.get(one.link, 0):
            raise ContradictionError(f"a mesh of {one.link} has another number of pieces")
        made = _sealed(base_from_root @ placed @ link_from_shape)
        shapes.append(LinkShape(one.link, joint, made, one.shape if shape is None else shape))
    if sum(map(len, tree.shapes.values())) != len(known):
        raise ContradictionError("the URDF has another number of collision shapes")
    return tuple(shapes)


def _frames(table: Mapping[str, Any]) -> dict[str, Array]:
    """Return flange_from_frame (4, 4) of each frame by its name in capitals."""
    tables = {name.upper(): frame for name, frame in table.get("frames", {}).items()}

    placed = {_FLANGE: np.eye(4)}
    for name in tables:
        above, waiting = name, dict[str, None]()  # a dict serves as an ordered set
        while above not in placed:
            if above in waiting:
                raise ContradictionError(f"the frame {above} is given in itself")
            # Follow the parents up to a known frame, and then place the frames on the way back.
            waiting[above] = None
            above = tables[above].get("parent", _FLANGE).upper()
        for one in reversed(waiting):
            placed[one] = placed[tables[one].get("parent", _FLANGE).upper()] @ _in_millimetres(tables[one])
    return {name: _sealed(placed[name]) for name in (_FLANGE, *tables)}


def _in_millimetres(entry: Mapping[str, Any]) -> Array:
    """Return the transform (4, 4) of an entry with xyz [mm] and rpy [deg]."""
    nothing = (0.0, 0.0, 0.0)
    numbers = np.array([*entry.get("xyz", nothing), *entry.get("rpy", nothing)], dtype=np.float64)
    return of_numbers(numbers * np.repeat([_MILLIMETRE, _DEGREE], 3))


def _tools(known: Sequence[Tool], table: Mapping[str, Any], frames: Mapping[str, Array]) -> tuple[Tool, ...]:
    """Compute the poses of tools and of their shapes, and the masses of tools, again."""
    tables = {name.upper(): tool for name, tool in table.get("tools", {}).items()}
    bodies: dict[str, list[Array]] = {name: [] for name in tables}
    for body in table.get("bodies", ()):
        bodies[body["tool"].upper()].append(_in_millimetres(body))
    tools = []
    for tool in known:
        written = tables[tool.name]
        if len(bodies[tool.name]) != len(tool.shapes) or written.get("mounted", True) != tool.mounted:
            raise ContradictionError(f"the tool {tool.name} differs")
        frame = frames[written.get("frame", _FLANGE).upper()]
        shapes = tuple(
            ToolShape(_sealed(frame @ placed), one.shape)
            for placed, one in zip(bodies[tool.name], tool.shapes, strict=True)
        )
        turned = frame[:3, :3]
        center = (
            turned @ (np.array(written.get("center_of_mass", (0.0, 0.0, 0.0))) * _MILLIMETRE) + frame[:3, 3]
        )
        # robot.toml gives center of mass and inertia in the tool's frame; turn both into the flange's axes.
        xx, yy, zz, xy, xz, yz = written.get("inertia", (0.0,) * 6)
        inertia = turned @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ turned.T
        own_tool = replace(
            tool,
            shapes=shapes,
            mass=float(written.get("mass", 0.0)),
            center=_sealed(center),
            inertia=_sealed(inertia),
        )
        tools.append(own_tool)
    return tuple(tools)


def _limits(table: Mapping[str, Any], names: Sequence[str], units: Array) -> Limits:
    """Return the limits of the joints in SI units.

    Args:
        table: the content of robot.toml.
        names: names of the joints.
        units: (n,) axis unit of each joint, deg or mm, in SI units [rad or m].
    """
    rows = [table["joints"][name] for name in names]
    ends = np.array([row.get("position", (-np.inf, np.inf)) for row in rows], dtype=np.float64)

    def column(key: str, otherwise: Array) -> Array:
        found = [row.get(key, other) for row, other in zip(rows, otherwise, strict=True)]
        return np.array(found, dtype=np.float64)

    nothing = np.full(len(rows), np.nan)
    times = table.get("ramps", {})
    rise, ease = (1e-3 * float(times.get(key, np.nan)) for key in ("rise", "ease"))
    velocity = column("velocity", nothing)
    # If robot.toml gives a joint no acceleration limit, use the acceleration with which the joint reaches its
    # largest velocity within the rise time. If it gives no jerk limit, use the jerk with which the joint
    # reaches its largest acceleration within the ease time.
    acceleration = column("acceleration", velocity / rise)
    jerk = column("jerk", acceleration / ease)
    stops = column("stop_acceleration", acceleration)
    if not np.isfinite([velocity, acceleration, jerk, stops]).all():
        raise ContradictionError("a joint has no limit of its velocity, acceleration or jerk")
    bounds = (ends[:, 0], ends[:, 1], velocity, acceleration, jerk, stops)
    return Limits(*(_sealed(one * units) for one in bounds))


def _dynamics(
    known: Dynamics | None,
    table: Mapping[str, Any],
    tree: _Tree,
    moving: Sequence[_Joint],
    base_from_root: Array,
) -> Dynamics | None:
    """Return the `known` masses, with gravity and effort limits read again.

    The masses are checked elsewhere: torques are compared with Pinocchio's, motion by motion.
    """
    if known is None:
        return None
    said = table.get("dynamics", {}).get("gravity")
    gravity = (
        base_from_root[:3, :3] @ np.array([0.0, 0.0, -_GRAVITY])
        if said is None
        else np.array(said, dtype=np.float64)
    )
    efforts = [
        table["joints"][joint.name].get("effort", tree.efforts.get(joint.name, np.inf)) for joint in moving
    ]
    return replace(known, gravity=_sealed(gravity), effort=_sealed(np.array(efforts, dtype=np.float64)))


def _actuation(table: Mapping[str, Any], size: int) -> Actuation:
    """Return the gear ratios K, the coupling J of the joints to the motors, the motors' offsets a0 and the
    largest motor speeds [counts/s] from robot.toml, which states the speeds in counts/ms.
    """
    said = table["actuation"]
    return Actuation(
        _sealed(np.array(said["K"], dtype=np.float64)),
        _sealed(np.array(said["J"], dtype=np.float64)),
        _sealed(np.array(said.get("a0", [0.0] * size), dtype=np.float64)),
        _sealed(np.array(table["motors"]["velocity"], dtype=np.float64) / _MILLIMETRE),
    )


def _sealed(values: Array) -> Array:
    """Return the values as a read-only array without negative zeros."""
    made = np.ascontiguousarray(values, dtype=np.float64) + 0.0
    made.setflags(write=False)
    return made
