"""The shapes of a robot and of the cell around it, for programs that draw them. This module makes the replies
to `model` and `scene`, and detects changes of the scene.
"""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any, Literal, assert_never

import numpy as np

from yarclang.cell.model import Cell, HalfSpace, Mount, Obstacle, Parts, ShapeRegion, Zone
from yarclang.coordinator.around import Around
from yarclang.coordinator.engine import Engine
from yarclang.coordinator.kept_parts import KeptParts
from yarclang.coordinator.lines import Lines
from yarclang.coordinator.messages import replies
from yarclang.coordinator.messages.findings import finding_messages
from yarclang.diagnostics import Diagnostic
from yarclang.export.moveit.described import described
from yarclang.export.moveit.package import urdf_of
from yarclang.handling.parts import first_parts
from yarclang.handling.surroundings import bodies_of
from yarclang.handling.switched import Switched, parts_after
from yarclang.pipeline.cells import CellLoader, cell_loader, is_same_file
from yarclang.robot.description import load_robot
from yarclang.robot.kinds import title_of
from yarclang.robot.model import Array, Robot
from yarclang.runtime.actions import Trouble
from yarclang.shapes import Box, Capsule, Cylinder, Mesh, Shape, Sphere
from yarclang.units import MM

MOST_ITEMS = 500
"""Largest number of bodies, zones and parts in one reply to the order `scene`. If there are more, the others
are left out, and a note says so. A longer reply would block the event loop, and thereby delay the robot.
"""
_MOST_NOTES = 100
_MOST_SWITCHED = 10_000
"""Largest number of output changes that are stored during one action. Further changes are ignored."""
_DIGITS = 9
"""Number of decimals of lengths in m in messages."""


class Scenes:
    """Describes the robot and the cell around it for programs that draw them.

    Args:
        robot: the robot.
        engine: engine that knows whether anything is in progress.
        lines: declarations of the session.
        around: provides the cell.
        kept_parts: places of the cell's parts.
    """

    def __init__(
        self, robot: Robot, engine: Engine, lines: Lines, around: Around, kept_parts: KeptParts
    ) -> None:
        self._robot = robot
        self._engine = engine
        self._lines = lines
        self._around = around
        self._kept = kept_parts
        self._loader: tuple[Path, CellLoader] | None = None
        self._switched: list[Switched] = []
        self._told = self._state()

    def begin(self) -> None:
        """Record the start of an action. Until the action sets an output, the scene shows the cell's parts in
        the places that are known from earlier actions.
        """
        self._switched.clear()

    def output_set(self, variable: str, value: float, q: Array | None) -> None:
        """Record that the current action has set an output, which may have moved a part of the cell.

        Args:
            variable: controller variable of the output.
            value: value of the output.
            q: position of the robot at that time (n,) [rad or m]; None: unknown.
        """
        if q is not None and self._engine.under_way and len(self._switched) < _MOST_SWITCHED:
            self._switched.append((variable, value, q))

    def is_another(self) -> bool:
        """Return True if the scene may have changed since the last call. This doesn't read the disk."""
        before, self._told = self._told, self._state()
        return before != self._told

    def _state(self) -> tuple[Any, ...]:
        cell, _ = self._around.cells
        return self._lines.revision, cell, self._kept.all, len(self._switched)

    def model(self) -> replies.Model:
        """Return the robot's shapes as a message. Waits for the disk.

        Raises:
            Trouble: the robot's files can't be read any more, or have changed since the start.
        """
        return model_described(self._robot)

    def scene(self) -> replies.Scene:
        """Return the cell around the robot as a message, with its parts at their present places. Waits for
        the disk.

        Raises:
            Trouble: the robot's files can't be read any more.
        """
        robot = self._robot
        cell, notes = self._cell()
        if cell is None:
            return _versioned(replies.Scene(version="", cell=None, items=(), notes=notes, doubt=None))
        known = self._kept.known(cell)
        parts = first_parts(cell) if known is None else known.present.parts
        parts = parts_after(robot, cell, parts, tuple(self._switched))
        return scene_described(robot, cell, parts, "" if known is None else known.doubt, notes)

    def _cell(self) -> tuple[Cell | None, tuple[str, ...]]:
        """Return the cell as its file describes it now, and notes. If the file can't be read any more, return
        the cell that was read before, and a note about this.
        """
        around = self._around
        around.look()
        program, session = around.cells
        if program is None:
            return session, ()
        path = Path(program.source.name)
        if session is not None and is_same_file(path, Path(session.source.name)):
            return session, ()
        if self._loader is None or self._loader[0] != path or not self._loader[1].is_current:
            self._loader = path, cell_loader(path.parent, self._robot)
        read = self._loader[1].at(path)
        errors = [one.message for one in read.diagnostics if one.is_error]
        if read.value is not None and not errors:
            return read.value, ()
        first = errors[0] if errors else "it can't be read"
        return program, (f"{path} is shown as it was when the program was loaded: {first}",)


def model_described(robot: Robot) -> replies.Model:
    """Return the shapes of a robot as a message.

    Raises:
        Trouble: the robot's files can't be read any more, or have changed since the robot was read.
    """
    _check_files(robot)
    result = described(robot)
    if result.value is None:
        raise _unread(result.diagnostics[0])
    description, limits, units = result.value, robot.limits, robot.axis_units
    return replies.Model(
        name=robot.name,
        controller=title_of(robot.controller.kind),
        urdf=description.urdf,
        base=description.base,
        flange=description.flange,
        tool=description.tool,
        joints=tuple(
            replies.ModelJoint(
                name=name,
                unit=robot.axis_unit_names[at],
                lower=_finite(limits.lower[at] / units[at]),
                upper=_finite(limits.upper[at] / units[at]),
                velocity=float(limits.velocity[at] / units[at]),
                acceleration=float(limits.acceleration[at] / units[at]),
            )
            for at, name in enumerate(robot.joint_names)
        ),
        findings=finding_messages(result.diagnostics),
    )


def scene_described(
    robot: Robot, cell: Cell, parts: Parts, doubt: str, notes: tuple[str, ...]
) -> replies.Scene:
    """Return the cell around a robot as a message.

    Args:
        robot: robot whose URDF names the links to which poses refer.
        cell: cell with bodies and zones.
        parts: places of the cell's parts.
        doubt: reason why the places are unknown; empty: they are known.
        notes: further remarks.

    Raises:
        Trouble: the robot's files can't be read any more.
    """
    found = urdf_of(robot)
    if isinstance(found, Diagnostic):
        raise _unread(found)
    _, base, flange = found
    items: list[replies.SceneItem] = []
    notes_said, number_left = [*notes], 0
    bodies: tuple[Obstacle | Zone, ...] = (
        *cell.obstacles,
        *cell.zones,
        *(body for item in parts.items for body in bodies_of(item)),
    )
    for one in bodies:
        made = _described(one, base, flange)
        if isinstance(made, str):
            notes_said.append(made)
        elif len(items) < MOST_ITEMS:
            items.append(made)
        else:
            number_left += 1
    if number_left:
        notes_said.insert(
            0, f"{number_left} more bodies, zones and parts are left out: at most {MOST_ITEMS} are sent"
        )
    return _versioned(
        replies.Scene(
            version="",
            cell=str(Path(cell.source.name).absolute()),
            items=tuple(items),
            notes=tuple(notes_said[:_MOST_NOTES]),
            doubt=doubt or None,
        )
    )


def _described(obstacle: Obstacle | Zone, base: str, flange: str) -> replies.SceneItem | str:
    """Return a body, zone or part as a message, or the reason why it can't be shown."""
    match obstacle:
        case Obstacle():
            kind: Literal["body", "part"] = "part" if obstacle.is_part else "body"
            return _item(
                obstacle.name, kind, obstacle.shape, obstacle.mount, (base, flange), sure=obstacle.is_sure
            )
    match obstacle.region:
        case ShapeRegion(base_from_shape=pose, shape=shape):
            return _item(obstacle.name, "zone", shape, Mount(pose, False), (base, flange), obstacle)
        case HalfSpace() as region:
            return _item(
                obstacle.name, "zone", None, Mount(region.base_from_plane, False), (base, flange), obstacle
            )
    if obstacle.keep is not None:
        return f"the rule {obstacle.name} limits directions, which can't be drawn"
    return f"the zone {obstacle.name} is a window of joint positions, which can't be drawn"


def _item(
    name: str,
    kind: Literal["body", "zone", "part"],
    shape: Shape | None,
    mount: Mount,
    links: tuple[str, str],
    zone: Zone | None = None,
    *,
    sure: bool = True,
) -> replies.SceneItem | str:
    described_shape = _shape(shape)
    if isinstance(described_shape, str):
        return f"{name} isn't shown: {described_shape}"
    return replies.SceneItem(
        name=name,
        kind=kind,
        rule=None if zone is None else zone.rule,
        speed=None if zone is None or zone.speed is None else round(zone.speed / MM, 6),
        sure=sure,
        carried=mount.on_flange,
        frame=links[mount.on_flange],
        pose=tuple(map(tuple, (np.round(mount.transform, _DIGITS) + 0.0).tolist())),
        shape=described_shape,
    )


def _shape(shape: Shape | None) -> replies.SceneShape | str:
    """Return a shape as a message, or the reason why it can't be drawn. None as the argument means a
    half-space.
    """
    match shape:
        case None:
            return replies.SceneShape(type="half-space")
        case Box(size=size):
            return replies.SceneShape(type="box", size=tuple(np.round(size, _DIGITS).tolist()))
        case Sphere(radius=radius):
            return replies.SceneShape(type="sphere", radius=radius)
        case Cylinder(radius=radius, length=length):
            return replies.SceneShape(type="cylinder", radius=radius, length=length)
        case Capsule(radius=radius, length=length):
            return replies.SceneShape(type="capsule", radius=radius, length=length)
        case Mesh(path=path, unit=unit, scale=scale):
            if not path.is_file():
                return f"there is no file {path}"
            factors = tuple(unit * one for one in scale)
            return replies.SceneShape(type="mesh", mesh=path.resolve().as_uri(), scale=factors)
    assert_never(shape)


def _check_files(robot: Robot) -> None:
    """Check that a robot's files haven't changed since the robot was read.

    Raises:
        Trouble: the files can't be read, or have changed.
    """
    read = load_robot(str(robot.folder))
    if read.value is None:
        raise _unread(read.diagnostics[0])
    if read.value.fingerprint != robot.fingerprint:
        what = f"the robot in {robot.folder} has changed since it was served"
        raise Trouble(what, "restart the process that serves it", "Y1302")


def _unread(finding: Diagnostic) -> Trouble:
    return Trouble(f"the robot's files can't be read: {finding.message}", finding.help or "", finding.code)


def _versioned(scene: replies.Scene) -> replies.Scene:
    """Return a scene with a version that is derived from its content."""
    version = hashlib.sha256(scene.model_dump_json().encode()).hexdigest()[:16]
    return scene.model_copy(update={"version": version})


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
