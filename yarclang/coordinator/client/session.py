"""Who may move the robot, what was declared, and what is told."""

from __future__ import annotations

from yarclang.coordinator.client.part import Part
from yarclang.coordinator.lines import Lines
from yarclang.coordinator.mailbox import CAPACITY
from yarclang.coordinator.offers import Offer
from yarclang.coordinator.subscription import Subscription
from yarclang.diagnostics import Result
from yarclang.semantics.names.scope import Frame


class Session(Part):
    """The part of a client that belongs to the session as a whole."""

    # who owns the robot

    @property
    def owns(self) -> bool:
        """Whether this client may move the robot."""
        return self._coordinator.owner == self._name

    def own(self, *, shared: bool = False) -> None:
        """Own the robot from now on.

        Args:
            shared: whether others may resume and change the pace as well, as people do from another terminal.

        Raises:
            NotOwner: somebody else does.
        """
        self._coordinator.own(self._name, shared=shared)

    def give(self, to: str) -> None:
        """Give the robot over to another client.

        Raises:
            NotOwner: it isn't this client's, or nobody is called so.
        """
        self._coordinator.give(self._name, to)

    def release(self) -> None:
        """Leave the robot to nobody; nothing where this client doesn't own it."""
        if self.owns:
            self._coordinator.give(self._name, "")

    def leave(self) -> None:
        """Go away. If this client owned the robot, it comes to rest on its path."""
        self._coordinator.detach(self._name)

    def events(self, capacity: int = CAPACITY) -> Subscription:
        """Return all events from now on."""
        return self._coordinator.subscribe(capacity)

    # what holds

    @property
    def declarations(self) -> tuple[str, ...]:
        """What was declared and accepted, as it was written."""
        return tuple(self._coordinator.lines.declarations)

    def frame(self, name: str) -> Result[Frame]:
        """Return a frame that motions may move: its transform is (4, 4) flange_from_frame [m]."""
        return self._coordinator.names.moving(name)

    async def adopt(self, declarations: tuple[str, ...]) -> Result[tuple[str, ...]]:
        """Let these declarations hold from now on, in the place of all that were accepted before: of a file, or one of them touched up.

        Returns:
            None, with findings, where they can't; then those before hold on.

        Raises:
            NotOwner: this client only watches.
            Trouble: the robot is under way, or there is no connection.
        """
        coordinator = self._coordinator
        coordinator.check_owner(self._name, "to change the session")
        start = await coordinator.stands()
        text = "\n".join(declarations)
        await coordinator.look_around()
        made: Result[Offer] = await coordinator.plan(
            coordinator.planner.offer, text, Lines(), start, next(coordinator.numbers)
        )
        if text and made.value is None:
            return Result(None, made.diagnostics)
        coordinator.lines.adopt(declarations)
        return Result(declarations, made.diagnostics)
