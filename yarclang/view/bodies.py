"""Convert the bodies, zones and frames of a robot and its cell to items that a picture shows."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from yarclang.cell.model import Cell, HalfSpace, ShapeRegion, Zone
from yarclang.hir import FrameLink, Gap, Program
from yarclang.report.solids import Solid, solid_of
from yarclang.robot.model import Array, Robot
from yarclang.robot.visuals import sticks, visual_shapes
from yarclang.view import colours
from yarclang.view.stage import Axes, Colour, Item

MOST_AXES = 60
"""Largest number of frames that are shown. More frames would cover the picture."""
_SHAPE_OPACITY = 0.35
_PLANE = 2.4
"""Edge length of the drawn part of a half space's border [m]."""


def robot_items(robot: Robot) -> tuple[tuple[Item, ...], tuple[str, ...]]:
    """Return the bodies of a robot to draw, and notes about shapes that can't be read.

    A link is drawn by its visual shapes, or by its collision shape if it has no visual shape. Mounted tools
    are drawn too. If no link has a shape, bars from joint to joint show the arm.
    """
    visuals: dict[str, list[Item]] = {}
    spoilt: set[str] = set()
    for one in visual_shapes(robot):
        solid = solid_of(one.shape)
        if solid is None:
            spoilt.add(one.link)
            continue
        given = one.colour
        colour = _bytes(given) if given is not None else _link_colour(one.joint)
        item = Item(one.link, "robot", one.joint, one.base_from_shape, solid, colour, 1.0)
        visuals.setdefault(one.link, []).append(item)
    notes, items = [], [item for link, found in visuals.items() if link not in spoilt for item in found]
    for link in robot.shapes:
        if link.link in visuals and link.link not in spoilt:
            continue
        solid = solid_of(link.shape)
        if solid is None:
            notes.append(f"the shape of {link.link} can't be read and isn't shown")
            continue
        colour = _link_colour(link.joint)
        items.append(Item(link.link, "robot", link.joint, link.base_from_shape, solid, colour, 1.0))
    if not items and not robot.shapes:
        for bar in sticks(robot):
            solid = solid_of(bar.shape)
            if solid is not None:
                colour = _link_colour(bar.joint)
                items.append(Item(bar.link, "robot", bar.joint, bar.base_from_shape, solid, colour, 1.0))
        if items:
            notes.append(
                "the robot is shown by bars from joint to joint, because no shape of its links can be read"
            )
    for tool in robot.tools:
        for part in tool.shapes if tool.mounted else ():
            solid = solid_of(part.shape)
            if solid is None:
                notes.append(f"the shape of {tool.name} can't be read and isn't shown")
                continue
            placed = robot.chain.base_from_flange @ part.flange_from_shape
            items.append(Item(tool.name, "tool", robot.size, placed, solid, colours.TOOL, 1.0))
    if spoilt:
        notes.append(
            f"shown by collision shapes, because the visual ones can't be read: {', '.join(sorted(spoilt))}"
        )
    return tuple(items), tuple(dict.fromkeys(notes))


def collision_items(robot: Robot) -> tuple[Item, ...]:
    """Return the collision shapes of the robot links that also have visual shapes.

    For these links the picture shows the visual shapes, although the collision checks use the collision
    shapes. Shapes that can't be read are left out.
    """
    seen = {one.link for one in visual_shapes(robot)}
    found = []
    for link in robot.shapes:
        solid = solid_of(link.shape) if link.link in seen else None
        if solid is not None:
            colour = _link_colour(link.joint)
            found.append(Item(link.link, "shape", link.joint, link.base_from_shape, solid, colour, 1.0))
    return tuple(found)


def shapes_beside(robot: Robot, items: Iterable[Item]) -> tuple[Item, ...]:
    """Return transparent items: the collision shapes of those robot links that the picture shows by visual
    shapes.

    Args:
        robot: the robot.
        items: the bodies in the picture; links that aren't among them are left out.
    """
    shown = {item.name for item in items if item.kind == "robot"}
    return tuple(
        replace(item, opacity=_SHAPE_OPACITY) for item in collision_items(robot) if item.name in shown
    )


def cell_items(robot: Robot, cell: Cell) -> tuple[tuple[Item, ...], tuple[str, ...]]:
    """Return the bodies and zones of a robot cell to draw, and notes about what can't be drawn.

    They are the obstacles, the attached tools, and the borders of zones.
    """
    items: list[Item] = []
    notes: list[str] = []
    for one in cell.obstacles:
        solid = solid_of(one.shape)
        if solid is None:
            notes.append(f"the shape of {one.name} can't be read and isn't shown")
            continue
        carried = one.mount.on_flange
        placed = robot.chain.base_from_flange @ one.mount.transform if carried else one.mount.transform
        kind, colour = ("tool", colours.TOOL) if carried else ("obstacle", colours.OBSTACLE)
        joint = robot.size if carried else 0
        items.append(Item(one.name, kind, joint, placed, solid, colour, 1.0))  # type: ignore[arg-type]
    for zone in cell.zones:
        border = _border(zone)
        if border is None and zone.keep is not None:
            notes.append(rule_note(zone))
        elif border is None:
            notes.append(f"zone {zone.name} limits joint positions, and can't be shown as a body")
        else:
            placed, solid = border
            items.append(Item(zone.name, "zone", 0, placed, solid, colours.ZONES[zone.rule], 0.16))
    return tuple(items), tuple(notes)


def rule_note(zone: Zone) -> str:
    """Return the note that the picture doesn't show a path constraint (KEEP rule) about directions."""
    return f"the rule {zone.name} limits directions, and can't be shown as a body"


def _border(zone: Zone) -> tuple[Array, Solid] | None:
    region = zone.region
    match region:
        case ShapeRegion(base_from_shape=placed, shape=shape):
            solid = solid_of(shape)
            return None if solid is None else (placed, solid)
        case HalfSpace():
            half = _PLANE / 2.0
            corners = np.array(
                [[-half, -half, 0.0], [half, -half, 0.0], [half, half, 0.0], [-half, half, 0.0]]
            )
            return region.base_from_plane, Solid(corners, np.array([[0, 1, 2], [0, 2, 3]]))
    return None


def axes_of(
    robot: Robot, program: Program | None, cell: Cell | None, followed: str
) -> tuple[tuple[Axes, ...], tuple[str, ...]]:
    """Return the coordinate frames to draw, and a note about frames that are left out.

    The frames are {B}, the robot's frames on its flange, the cell's frames, and the frames that commands use.

    Args:
        robot: robot with the frames on its flange.
        program: program whose commands use frames; None without one.
        cell: cell with frames; None without one.
        followed: name of the frame whose path is drawn.
    """
    used = tuple(_used(robot, program)) if program is not None else ()
    matter = {"B", followed, *(one.name for one in used)}
    found = [Axes("B", 0, np.eye(4), False)]
    on_flange = {"FLANGE": np.eye(4), **robot.flange_from_frame}
    found += [_on_flange(robot, name, pose, False, name in matter) for name, pose in on_flange.items()]
    for frame in cell.frames.values() if cell else ():
        pose, matters = frame.mount.transform, program is None or frame.name in matter
        if frame.mount.on_flange:
            found.append(_on_flange(robot, frame.name, pose, False, matters))
        else:
            found.append(Axes(frame.name, 0, pose, False, matters))
    known = {(one.name, one.base_from_frame.tobytes()) for one in found}
    names = {one.name for one in found}
    left = 0
    for one in used:
        key = (one.name, one.base_from_frame.tobytes())
        if key in known:
            continue
        known.add(key)
        if len(found) < MOST_AXES:
            found.append(replace(one, matters=one.name not in names))
            names.add(one.name)
        else:
            left += 1
    return tuple(found), ((f"{left} more frames aren't shown",) if left else ())


def _used(robot: Robot, program: Program) -> Iterable[Axes]:
    """Yield the frames that commands name, and the parents of these frames."""
    done: set[int] = set()
    for step in program.steps:
        if isinstance(step, Gap):
            continue
        for link in (step.origin.moving, step.origin.base):
            here = link
            while here is not None and here.parent is not None and id(here) not in done:
                done.add(id(here))
                root, pose = _rooted(here)
                if root == "FLANGE":
                    yield _on_flange(robot, here.name, pose, True, True)
                elif root == "B":
                    yield Axes(here.name, 0, pose, True)
                here = here.parent


def _rooted(link: FrameLink) -> tuple[str, Array]:
    """Return the root of a frame's chain of parents, {B} or {FLANGE}, and the frame's pose in it."""
    pose = link.parent_from_frame
    while link.parent is not None and link.parent.parent is not None:
        link = link.parent
        pose = link.parent_from_frame @ pose
    root = link.parent.name if link.parent is not None else link.name
    return root, pose


def _on_flange(robot: Robot, name: str, flange_from_frame: Array, of_program: bool, matters: bool) -> Axes:
    placed = robot.chain.base_from_flange @ flange_from_frame
    return Axes(name, robot.size, placed, of_program, matters)


def _link_colour(joint: int) -> Colour:
    """Return the colour of a robot link. Two colours alternate, so that neighbouring links differ."""
    return colours.LINK if joint % 2 == 0 else colours.JOINT_BODY


def _bytes(colour: tuple[float, float, float]) -> Colour:
    red, green, blue = (round(255 * part) for part in colour)
    return red, green, blue
