"""The coordinator. It owns one robot, accepts commands and programs, plans them from the robot's actual
position, executes them, and reports.

Everything runs in one event loop; `plan` may pass planning to a thread. docs/coordinator.md shows examples.
"""

from __future__ import annotations

import asyncio

from yarclang.coordinator.client import Client
from yarclang.coordinator.shared import SharedRobot
from yarclang.coordinator.signals import hear_inputs, receive_values
from yarclang.runtime.inspection import Inspection


class Coordinator(SharedRobot):
    """A robot to which clients attach, from the first connection until the coordinator is closed."""

    async def start(self) -> Inspection | None:
        """Connect to the controller, inspect it, and begin to serve clients.

        Returns:
            The inspection; None if the coordinator is patient and can't reach the controller yet.

        Raises:
            Trouble: the controller can't be reached, or isn't in the state that the robot needs (`NotReady`).
        """
        if self.surroundings is not None:
            later = asyncio.get_running_loop().call_soon_threadsafe
            hear_inputs(self.surroundings, self._session, later)
            receive_values(self.surroundings, self.values, later)
        return await self.engine.start(patient=self._patient)

    def give_up(self) -> None:
        """End at once even if the robot can't be reached. The robot's state is then unknown."""
        self.engine.give_up()

    async def close(self) -> None:
        """Bring the robot to rest on its path, close the connection, and end all streams of events."""
        if self.surroundings is not None:
            self.surroundings.listen(None)
            self.surroundings.receive(None)
        await self.engine.close()
        for one in tuple(self._subscriptions):
            one.close()

    async def __aenter__(self) -> Coordinator:
        await self.start()
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    def attach(self, name: str) -> Client:
        """Add a client. It doesn't own the robot yet.

        Args:
            name: name of the client that others see; a number is added if the name is taken.
        """
        return Client(self, self.enter(name))
