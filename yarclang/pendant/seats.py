"""Seats: the clients of the coordinator that belong to the sessions of users. Each session that gives
orders is a client of its own, named after its user.
"""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable

from yarclang.coordinator.attached import Attached
from yarclang.pendant.accounts.sessions import Session
from yarclang.runtime.actions import Trouble

Attach = Callable[[str], Awaitable[Attached]]
"""Type of a function that attaches a new client to the coordinator. Its argument is the name of the client,
which other clients see.
"""


class Seats:
    """The seats of all sessions.

    Args:
        attach: attaches new clients to the coordinator.

    Attributes:
        jogging: for each session id, the connection of the page that jogs at present. No other page of the
            same session may jog, because it would change this page's motion.
    """

    def __init__(self, attach: Attach) -> None:
        self.jogging: dict[str, object] = {}
        self._attach = attach
        self._seats: dict[str, Attached] = {}
        self._taking = asyncio.Lock()
        self._leaving: set[asyncio.Task[None]] = set()

    async def of(self, session: Session) -> Attached:
        """Return the seat of a session. It is created when the session gives its first order.

        Raises:
            Trouble: the coordinator can't be reached.
        """
        if (found := self._seats.get(session.id)) is not None:
            return found
        async with self._taking:
            if session.id not in self._seats:
                self._seats[session.id] = await self._attach(session.user)
            return self._seats[session.id]

    def taken(self, session: Session) -> Attached | None:
        """Return the seat of a session; None if it has none."""
        return self._seats.get(session.id)

    def name(self, session: Session) -> str:
        """Return the name by which the coordinator knows a session; empty if the session has no seat."""
        seat = self._seats.get(session.id)
        return "" if seat is None else seat.welcome.name

    def session_called(self, client: str | None) -> str:
        """Return the id of the session that the coordinator knows by the given client name; empty if there
        is none.
        """
        return next((id_ for id_, seat in self._seats.items() if seat.welcome.name == client), "")

    def leave(self, id_: str) -> None:
        """Give up the seat of the session with this id. If the seat owns the robot, the robot comes to rest
        on its path.
        """
        seat = self._seats.pop(id_, None)
        if seat is not None:
            task = asyncio.ensure_future(_leave(seat))
            self._leaving.add(task)
            task.add_done_callback(self._leaving.discard)

    async def leave_all(self) -> None:
        """Give up all seats."""
        for id_ in tuple(self._seats):
            self.leave(id_)
        await asyncio.gather(*self._leaving, return_exceptions=True)


async def _leave(seat: Attached) -> None:
    try:
        await seat.leave()
    except Trouble:
        return  # the coordinator has ended, and the guard PLC brings the robot to rest
