"""Three-dimensional scenes of loaded programs. A session sees only the programs that it has loaded itself.
Each program is shown in its own cell.
"""

from __future__ import annotations

import asyncio
import hashlib
from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from yarclang.coordinator.attached import Attached, Here
from yarclang.coordinator.loading import Source, load
from yarclang.coordinator.messages import orders
from yarclang.coordinator.messages.courses import ProgramCourse
from yarclang.coordinator.programs import Loaded
from yarclang.pendant.accounts.sessions import Session
from yarclang.pendant.scene.described import Drawn, drawn
from yarclang.pendant.scene.meshes import Blob
from yarclang.pendant.scene.of_loaded import stage_of_loaded
from yarclang.pendant.seats import Seats
from yarclang.pipeline.inputs import Options
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Trouble

_MOST = 8
"""Largest number of sessions for which a scene is cached, one scene for each. If there are more, the scene
that wasn't used for the longest time is dropped.
"""
_MOST_LOADS = 4
"""Number of orders `load` that are stored for each session. Only the latest orders are kept."""


@dataclass(frozen=True, slots=True, eq=False)
class _Kept:
    """A cached scene of a program.

    A program is identified by its number together with the seat (the session's client of the coordinator).
    The number alone isn't enough, because a restarted coordinator counts from the beginning again.
    """

    seat: Attached
    number: int
    drawn: Drawn
    meshes: Mapping[str, Blob]


class ProgramScenes:
    """Scenes of loaded programs. Each scene is made once and then cached.

    Args:
        robot: the robot.
        seats: the sessions' clients of the coordinator, through which the programs were loaded.
        live: returns the scene of the real robot in its cell, whose meshes are reused; None if there is none
            yet.
    """

    def __init__(self, robot: Robot, seats: Seats, live: Callable[[], Drawn | None]) -> None:
        self._robot = robot
        self._seats = seats
        self._live = live
        self._kept: OrderedDict[str, _Kept] = OrderedDict()
        self._loads: dict[str, OrderedDict[int, orders.Load]] = {}
        self._drawing = asyncio.Lock()

    def remember(self, session: Session, number: int, order: orders.Load) -> None:
        """Remember the order by which a session has loaded a program.

        Args:
            session: session that has loaded the program.
            number: number of the program.
            order: the order, with the paths of its files.
        """
        if self._seats.taken(session) is None:  # the session has ended while the program was loaded
            return
        loads = self._loads.setdefault(session.id, OrderedDict())
        loads[number] = order
        loads.move_to_end(number)
        while len(loads) > _MOST_LOADS:
            loads.popitem(last=False)

    def forget(self, id_: str) -> None:
        """Forget everything about a session that has ended."""
        self._kept.pop(id_, None)
        self._loads.pop(id_, None)

    def mesh(self, id_: str) -> Blob | None:
        """Return a mesh of a scene by its id; None if there is none."""
        return next((found for one in self._kept.values() if (found := one.meshes.get(id_))), None)

    async def shown(self, session: Session, number: int) -> Drawn:
        """Return the scene of a program in its cell.

        Args:
            session: session that has loaded the program.
            number: number of the program.

        Raises:
            Trouble: the session has no such program, or the program's files can't be read again.
        """
        async with self._drawing:
            seat = self._seats.taken(session)
            if seat is None:
                raise _unknown(number)
            before = self._kept.get(session.id)
            if before is not None and before.seat is seat and before.number == number:
                self._kept.move_to_end(session.id)
                return before.drawn
            loaded = await self._loaded(session, seat, number)
            drawn = await asyncio.to_thread(self._draw, loaded)
            if self._seats.taken(session) is not seat:  # the session has ended while the scene was drawn
                raise _unknown(number)
            # A page may still request meshes of the previous scene.
            meshes = {**(before.drawn.meshes if before else {}), **drawn.meshes}
            self._kept[session.id] = _Kept(seat, number, drawn, meshes)
            self._kept.move_to_end(session.id)
            while len(self._kept) > _MOST:
                self._kept.popitem(last=False)
            return drawn

    async def loaded(self, session: Session, number: int) -> Loaded:
        """Return a program that a session has loaded.

        Args:
            session: session that has loaded the program.
            number: number of the program.

        Raises:
            Trouble: the session has no such program, or the program's files can't be read again.
        """
        seat = self._seats.taken(session)
        if seat is None:
            raise _unknown(number)
        return await self._loaded(session, seat, number)

    def _draw(self, loaded: Loaded) -> Drawn:
        return drawn(stage_of_loaded(self._robot, loaded), self._live())

    async def _loaded(self, session: Session, seat: Attached, number: int) -> Loaded:
        if isinstance(seat, Here):
            found = seat.desk.loaded_of(number)
            if found is None:
                raise _unknown(number)
            return found
        loads = self._loads.get(session.id)
        order = None if loads is None else loads.get(number)
        if order is None:
            raise _unknown(number)
        course = await seat.ask(orders.AskCourse(program=number))
        cell = order.cell or seat.welcome.status.cell
        return await asyncio.to_thread(_again, self._robot, order, course, cell)


def _again(robot: Robot, order: orders.Load, course: ProgramCourse, cell: str | None) -> Loaded:
    """Compile a program again, because the coordinator that has loaded it is in another process.

    Args:
        robot: robot that runs the program.
        order: order by which the program was loaded.
        course: the coordinator's reply about the program, with its joint positions and the hash of its text.
        cell: path of the cell that the coordinator uses.

    Raises:
        Trouble: the files have changed since the program was loaded.
    """
    options = Options(start=order.start, tm=order.tm, cell=cell)
    if (tolerance := order.tolerance) is not None:
        options = replace(options, tolerance=(tolerance[0], tolerance[1] if len(tolerance) > 1 else None))
    rows = course.course.joints
    stands = np.array(rows[0]) * robot.axis_units if order.here and rows else None
    made = load(Source(order.file, order.text, options=options, program=order.source), robot, stands)
    found = made.value
    if found is None or _sha256(found.program.source) != course.sha256:
        what = f"{Path(order.file).name} has changed since it was loaded: its cell can't be shown"
        raise Trouble(what, "load it again", "")
    return found


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest() if text else ""


def _unknown(number: int) -> Trouble:
    return Trouble(f"there is no program {number}", "load it again", "Y1613")
