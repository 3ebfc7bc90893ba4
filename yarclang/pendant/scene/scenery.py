"""The three-dimensional scene of the robot in its cell, which all pages share. It is made again when the
cell, the workpieces (parts) in it, or the robot's description have changed.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from yarclang.cell.model import Cell, Item, Parts
from yarclang.collision.scene import Scene
from yarclang.coordinator.attached import Attached
from yarclang.coordinator.messages import events, orders, replies
from yarclang.handling.parts import first_parts
from yarclang.handling.switched import parts_after
from yarclang.pendant.messages.scene import Placements
from yarclang.pendant.scene.described import Drawn, drawn
from yarclang.pendant.scene.meshes import Blob
from yarclang.pendant.scene.placements import moved_links, packed
from yarclang.pendant.showing import Showing
from yarclang.pipeline.kept import Stamp, meshes_of, stamp_of
from yarclang.report.clearance import touching
from yarclang.robot.model import Array, Robot
from yarclang.runtime.actions import Trouble
from yarclang.view.of_live import stage_of_live
from yarclang.view.parts import standing_parts
from yarclang.view.reaching import Place, read_place
from yarclang.view.stage import Stage

_EACH = 0.25
"""Time between two checks of the distances between bodies [s]."""
_LOOKS = 4
"""Number of distance checks after which the coordinator is asked again for the cell and the parts."""


@dataclass(frozen=True, slots=True, eq=False)
class _Seen:
    """Data from which the last scene was made. If the data change, the scene is made again."""

    around: tuple[str, str | None]
    place: Place
    stage: Stage
    parts: Parts
    stamp: Stamp


class Scenery:
    """The scene of the robot in its cell, shared by all pages.

    Args:
        robot: the robot.
        showing: state of the display, in which this class stores the version of the scene, the bodies that
            are too near to another one, and the bodies that have stopped the robot.
        is_watched: returns True if a page is connected. Nothing is computed while no page is.
    """

    def __init__(self, robot: Robot, showing: Showing, is_watched: Callable[[], bool]) -> None:
        self._robot = robot
        self._showing = showing
        self._is_watched = is_watched
        self._seen: _Seen | None = None
        self._drawn: Drawn | None = None
        self._meshes: Mapping[str, Blob] = {}
        self._renewing = asyncio.Lock()
        self._changed = asyncio.Event()
        self._looked_at: tuple[Scene | None, bytes] = (None, b"")
        self._switched: list[tuple[str, float, Array]] = []

    async def shown(self, attached: Attached) -> Drawn:
        """Return the present scene.

        Raises:
            Trouble: the coordinator can't be reached, or the files of the robot can't be read.
        """
        async with self._renewing:
            return await self._renewed(attached)

    @property
    def drawn(self) -> Drawn | None:
        """The last scene; None before the first."""
        return self._drawn

    def mesh(self, id_: str) -> Blob | None:
        """Return a mesh of a scene by its id; None if there is none."""
        return self._meshes.get(id_)

    async def watch(self, attached: Attached) -> None:
        """Check the scene regularly until cancelled."""
        turn = 0
        while True:
            if self._is_watched() and self._drawn is not None:
                try:
                    if turn == 0 or self._switched:
                        await self.shown(attached)
                    await self._look_what_touches()
                except Trouble:
                    pass  # a request for the scene reports the reason
            turn = (turn + 1) % _LOOKS
            if await _came_within(self._changed, _EACH):
                turn = 0

    def hear(self, event: events.BaseEvent) -> None:
        """Handle an event that may have changed the scene."""
        match event:
            case events.OutputSet(variable=variable, value=value):
                q = self._showing.joints
                if q is not None and self._seen is not None and self._seen.place.cell is not None:
                    self._switched.append((variable, value, q))
                    self._changed.set()
            case events.Finished() | events.Began():
                self._showing.stopped_by = ()
                self._changed.set()
            case events.Told(stopped_by=names, warning=warning):
                if names:
                    self._showing.stopped_by = names
                if not warning:
                    self._changed.set()  # the message may report that a user has moved parts
            case _:
                pass

    async def _renewed(self, attached: Attached) -> Drawn:
        surroundings = await attached.ask(orders.AskSurroundings())
        around = (surroundings.robot, surroundings.cell)
        drawn_state, before = self._seen, self._drawn
        stamp = await asyncio.to_thread(
            _stamp, around[1], None if drawn_state is None else drawn_state.place.cell
        )
        if drawn_state is None or drawn_state.around != around or drawn_state.stamp != stamp:
            place = await asyncio.to_thread(read_place, attached.welcome, surroundings)
            stage = await asyncio.to_thread(self._empty, place)
            stamp = await asyncio.to_thread(_stamp, around[1], place.cell)
        else:
            place, stage = drawn_state.place, drawn_state.stage
        parts = await self._parts(
            attached,
            place.cell,
            None if drawn_state is None or drawn_state.place is not place else drawn_state.parts,
        )
        if (
            before is not None
            and drawn_state is not None
            and drawn_state.place is place
            and drawn_state.parts == parts
        ):
            return before
        drawn = await asyncio.to_thread(self._draw, stage, parts)
        self._seen, self._drawn = _Seen(around, place, stage, parts, stamp), drawn
        # A page may still request meshes of the previous scene.
        self._meshes = drawn.meshes if before is None else {**before.meshes, **drawn.meshes}
        self._showing.scene = drawn.shown.version
        return drawn

    def _empty(self, place: Place) -> Stage:
        """Return the stage (all that is drawn) of the robot in its cell, without workpieces (parts). It is
        reused: while the robot works, only the parts change.
        """
        stage = stage_of_live(self._robot, place.cell, self._robot.home, parts=Parts(()))
        return replace(stage, notes=(*place.notes, *stage.notes))

    def _draw(self, stage: Stage, parts: Parts) -> Drawn:
        items, notes = standing_parts(self._robot, parts)
        return drawn(replace(stage, items=(*stage.items, *items), notes=(*stage.notes, *notes)), self._drawn)

    async def _parts(self, attached: Attached, cell: Cell | None, before: Parts | None) -> Parts:
        """Return the places of the workpieces (parts) of a cell. During a run they follow from the outputs
        that the program has set. Otherwise the coordinator reports them.
        """
        first = first_parts(cell)
        if cell is None or not cell.parts:
            self._switched.clear()
            return first
        switched, self._switched = self._switched, []
        if before is not None and self._showing.under_way:
            return await asyncio.to_thread(parts_after, self._robot, cell, before, switched)
        try:
            told = await attached.ask(orders.AskParts())
        except Trouble:  # the cell that the session uses has no parts
            return first if before is None else before
        return parts_told(cell, told) or (first if before is None else before)

    async def _look_what_touches(self) -> None:
        scene = None if self._drawn is None else self._drawn.near
        q = self._showing.joints
        if scene is None or q is None:
            self._showing.touching = ()
            return
        key = (scene, np.round(q, 4).tobytes())
        if key == self._looked_at:
            return
        self._looked_at = key
        self._showing.touching = tuple(sorted(await asyncio.to_thread(touching, scene, q)))


def _stamp(file: str | None, cell: Cell | None) -> Stamp:
    """Return a value that changes when the cell's file or one of its meshes changes."""
    return stamp_of((*(() if file is None else (Path(file),)), *(() if cell is None else meshes_of(cell))))


async def _came_within(event: asyncio.Event, within: float) -> bool:
    try:
        await asyncio.wait_for(event.wait(), within)
    except TimeoutError:
        return False
    event.clear()
    return True


def parts_told(cell: Cell, reply: replies.Parts) -> Parts | None:
    """Convert the coordinator's reply about workpieces (parts) to `Parts` of a cell; None if the reply names
    parts that the cell doesn't have.
    """
    kinds = {part.body.name: part for part in cell.parts}
    variables = {name: told_part.variable for name, told_part in cell.outputs.items()}
    items: list[Item] = []
    for told_part in reply.parts:
        name, _, number = told_part.name.rpartition(" ")
        part = kinds.get(told_part.name) or (kinds.get(name) if number.isdecimal() else None)
        if part is None:
            return None
        gripper = None if told_part.held is None else variables.get(told_part.held, "")
        pose = np.array(told_part.pose).tobytes()
        items.append(
            Item(
                part,
                int(number) if part.count > 1 and number.isdecimal() else 1,
                pose,
                gripper,
                told_part.sure,
            )
        )
    return Parts(tuple(items))


def placed(robot: Robot, request: Placements) -> bytes:
    """Return the displacements of the links, from their poses with all joints at zero, for N joint positions.
    The bytes are float32 (N, n, 7), little endian: x y z [m] and the quaternion x y z w.

    Raises:
        Trouble: one of the joint positions has the wrong number of joints.
    """
    for number, row in enumerate(request.joints):
        if len(row) != robot.size:
            what = (
                f"row {number + 1} has {len(row)} joint positions, and {robot.name} has {robot.size} joints"
            )
            raise Trouble(what, "give one value per joint", "")
    q = np.array(request.joints, dtype=float).reshape(-1, robot.size) * robot.axis_units
    return packed(moved_links(robot.chain, q)).astype("<f4").tobytes()
