"""A client's actions on the session: ownership of the robot, declarations, and events."""

from __future__ import annotations

from yarclang.coordinator.client.part import Part
from yarclang.coordinator.lines import Lines
from yarclang.coordinator.mailbox import CAPACITY
from yarclang.coordinator.offers import Offer
from yarclang.coordinator.subscription import Subscription
from yarclang.diagnostics import Result
from yarclang.semantics.names.scope import Frame


class Session(Part):
    """Group of a client's actions on the whole session: ownership, declarations, events."""

    # ownership

    @property
    def owns(self) -> bool:
        """Return True if this client may move the robot."""
        return self._coordinator.owner == self._name

    def own(self, *, shared: bool = False) -> None:
        """Become the owner of the robot.

        Args:
            shared: True if other clients and terminals may also resume and change the override.

        Raises:
            NotOwner: another client owns the robot.
        """
        self._coordinator.own(self._name, shared=shared)

    def give(self, to: str) -> None:
        """Hand the robot over to another client.

        Raises:
            NotOwner: this client doesn't own the robot, or there is no client with this name.
        """
        self._coordinator.give(self._name, to)

    def release(self) -> None:
        """Give up the robot, so that nobody owns it. Do nothing if this client doesn't own the robot."""
        if self.owns:
            self._coordinator.give(self._name, "")

    def leave(self) -> None:
        """Leave the coordinator. If this client owned the robot, the robot comes to rest on its path."""
        self._coordinator.detach(self._name)

    def events(self, capacity: int = CAPACITY) -> Subscription:
        """Return an iterator over all events from now on."""
        return self._coordinator.subscribe(capacity)

    # declarations

    @property
    def declarations(self) -> tuple[str, ...]:
        """Return the accepted declarations, as they were written."""
        return tuple(self._coordinator.lines.declarations)

    def frame(self, name: str) -> Result[Frame]:
        """Return the frame with a given name, if motions can move it. Its transform is flange_from_frame
        (4, 4) [m].
        """
        return self._coordinator.names.moving(name)

    async def adopt(self, declarations: tuple[str, ...]) -> Result[tuple[str, ...]]:
        """Replace all accepted declarations of the session by other ones, for example from a file or an
        editor.

        Returns:
            The new declarations. None, with findings, if they contain an error; then the earlier declarations
            remain in force.

        Raises:
            NotOwner: this client only watches.
            Trouble: the robot is moving, or there is no connection.
        """
        coordinator = self._coordinator
        coordinator.check_owner(self._name, "to change the session")
        start = await coordinator.stands()
        text = "\n".join(declarations)
        await coordinator.look_around()
        offered: Result[Offer] = await coordinator.plan(
            coordinator.planner.offer, text, Lines(), start, next(coordinator.numbers)
        )
        if text and offered.value is None:
            return Result(None, offered.diagnostics)
        coordinator.lines.adopt(declarations)
        return Result(declarations, offered.diagnostics)
