"""Hold-to-run for planned motions: an offered motion continues only as long as a client keeps confirming
it.
"""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from typing import TYPE_CHECKING, Any

from yarclang.coordinator.client.part import Part
from yarclang.coordinator.engine import UNDER_WAY
from yarclang.runtime.actions import Trouble
from yarclang.runtime.notices import Hold
from yarclang.runtime.outcome import Ended
from yarclang.runtime.state import State

if TYPE_CHECKING:
    from yarclang.coordinator.coordinator import Coordinator

SILENCE = 0.2
"""Longest time between two confirmations [s]."""

_LOOKED_EACH = 0.01


class Held(Part):
    """The hold-to-run motion of one client, if any. If the client stops confirming it, the robot comes to
    rest on its path; `resume` continues the motion.
    """

    def __init__(self, coordinator: Coordinator, name: str) -> None:
        super().__init__(coordinator, name)
        self._heard = 0.0
        self._carried = False

    @property
    def rests(self) -> bool:
        """Return True if a motion has begun, but rests now because the client doesn't confirm it."""
        return self._carried and self._is_silent

    @property
    def _is_silent(self) -> bool:
        return asyncio.get_running_loop().time() - self._heard > SILENCE

    def keep(self) -> None:
        """Confirm that the client still wants the motion."""
        self._heard = asyncio.get_running_loop().time()

    async def carry_out(self, going: Coroutine[Any, Any, Ended]) -> Ended:
        """Carry a motion out as long as the client keeps confirming it. Without confirmation the robot comes
        to rest, or the motion doesn't begin.
        """
        if self._carried:
            going.close()
            raise Trouble("another button is pressed already", "wait for its end, or stop it", UNDER_WAY)
        self.keep()
        self._carried = True
        watching = asyncio.create_task(self._watch())
        try:
            return await going
        finally:
            self._carried = False
            watching.cancel()

    async def _watch(self) -> None:
        coordinator = self._coordinator
        while True:
            await asyncio.sleep(_LOOKED_EACH)
            if coordinator.owner != self._name:
                coordinator.stop()  # another client owns the robot now, and can't confirm this motion
                return
            if not self._is_silent:
                continue
            if not coordinator.under_way:
                coordinator.stop()  # a motion that is about to begin is cancelled
                return
            session = coordinator.engine.session
            if coordinator.state is not State.HOLD and Hold() not in session.operation.orders:
                coordinator.hold()
