"""What a client of a coordinator may order: who owns the robot, stops, the pace, and what goes on behind a hold or a fault."""

from __future__ import annotations

from yarclang.coordinator.asking import Asking
from yarclang.coordinator.mailbox import CAPACITY
from yarclang.coordinator.subscription import Subscription
from yarclang.runtime.actions import Trouble
from yarclang.runtime.notices import Override, Resume
from yarclang.runtime.state import State


class Commanding(Asking):
    """What needs no plan. Stops are for everybody, all else is for the robot's owner: else `NotOwner`."""

    # who owns the robot

    @property
    def owns(self) -> bool:
        """Whether this client may move the robot."""
        return self._coordinator.owner == self.name

    def own(self) -> None:
        """Own the robot from now on.

        Raises:
            NotOwner: somebody else does.
        """
        self._coordinator.own(self.name)

    def give(self, to: str) -> None:
        """Give the robot over to another client.

        Raises:
            NotOwner: it isn't this client's, or nobody is called so.
        """
        self._coordinator.give(self.name, to)

    def release(self) -> None:
        """Nobody owns the robot any more; nothing where this client doesn't."""
        if self.owns:
            self._coordinator.give(self.name, "")

    def leave(self) -> None:
        """Go away. If this client owned the robot, it comes to rest on its path."""
        self._coordinator.detach(self.name)

    def events(self, capacity: int = CAPACITY) -> Subscription:
        """All events from now on."""
        return self._coordinator.subscribe(capacity)

    # what happens at once

    def stop(self) -> None:
        """Come to rest on the path and end what is under way. Overtakes everything; for everybody."""
        self._coordinator.stop()

    def abort(self) -> None:
        """Each motor comes to rest at once, off the path. For everybody."""
        self._coordinator.abort()

    def hold(self) -> None:
        """Come to rest on the path, ready to go on. For everybody."""
        self._coordinator.hold()

    def resume(self) -> None:
        """Go on: behind a hold, at a HOLD of the program, to the next step.

        Raises:
            NotOwner: this client only watches.
        """
        self._coordinator.check_owner(self.name, "to go on")
        session = self._coordinator.engine.session
        if session.paused or self._coordinator.state is State.HOLD:
            session.order(Resume())

    def override(self, percent: float) -> None:
        """Another pace, for what is under way and what comes: `percent` of the programmed speed, 1 to 100.

        Raises:
            NotOwner: this client only watches.
            Trouble: the number isn't one.
        """
        coordinator = self._coordinator
        coordinator.check_owner(self.name, "to change the override")
        if not 1.0 <= percent <= 100.0:
            raise Trouble(f"an override of {percent:g} %", "it may be 1 to 100", code="Y1601")
        engine = coordinator.engine
        if engine.under_way:
            engine.session.order(Override(percent))
        else:
            engine.operation.override = percent / 100.0
            coordinator.tell(f"override {percent:g} %")

    async def clear(self) -> None:
        """Look at the controller behind a fault; where all is well, motions are possible again.

        Raises:
            NotOwner: this client only watches.
            Trouble: it isn't well, and why.
        """
        self._coordinator.check_owner(self.name, "to clear a fault")
        await self._coordinator.engine.clear()
