"""Hold-to-run of what was planned to its end: an offer that is carried out only as long as somebody says that it is still wanted."""

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
"""Nothing is wanted any more if nobody has said so for this time [s]."""

_LOOKED_EACH = 0.01


class Held(Part):
    """The motion that one client holds, when there is one. Whoever falls silent brings it to rest on its path; `resume` goes on."""

    def __init__(self, coordinator: Coordinator, name: str) -> None:
        super().__init__(coordinator, name)
        self._heard = 0.0
        self._carried = False

    @property
    def rests(self) -> bool:
        """True if a motion was begun that nobody holds now."""
        return self._carried and self._is_silent

    @property
    def _is_silent(self) -> bool:
        return asyncio.get_running_loop().time() - self._heard > SILENCE

    def keep(self) -> None:
        """Note that the motion is still wanted."""
        self._heard = asyncio.get_running_loop().time()

    async def carry_out(self, going: Coroutine[Any, Any, Ended]) -> Ended:
        """Carry a motion out while it is wanted; without that it rests, and before its beginning doesn't begin."""
        if self._carried:
            going.close()
            raise Trouble("something is held already", "wait for its end, or stop it", UNDER_WAY)
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
                coordinator.stop()  # it was given to somebody who holds nothing
                return
            if not self._is_silent:
                continue
            if not coordinator.under_way:
                coordinator.stop()  # what is about to begin doesn't begin then
                return
            session = coordinator.engine.session
            if coordinator.state is not State.HOLD and Hold() not in session.operation.orders:
                coordinator.hold()
