"""The coordinator: owns one robot, takes commands and programs, plans from where the robot really stands,
moves it, and reports.

Everything runs in one event loop; `plan` may hand planning to a thread. docs/coordinator.md shows it in use.
"""

from __future__ import annotations

import asyncio

from yarclang.coordinator.client import Client
from yarclang.coordinator.shared import SharedRobot
from yarclang.coordinator.signals import hear_inputs, receive_values
from yarclang.runtime.inspection import Inspection


class Coordinator(SharedRobot):
    """A robot to which clients attach, from its connection to the end."""

    async def start(self) -> Inspection | None:
        """Connect to the controller, inspect it, and begin to serve clients.

        Returns:
            The inspection; None if a patient coordinator doesn't reach the controller yet.

        Raises:
            Trouble: the controller can't be reached, or isn't as the robot needs it (`NotReady`).
        """
        if self.surroundings is not None:
            later = asyncio.get_running_loop().call_soon_threadsafe
            hear_inputs(self.surroundings, self._session, later)
            receive_values(self.surroundings, self.values, later)
        return await self.engine.start(patient=self._patient)

    def give_up(self) -> None:
        """End without waiting for a robot that can't be reached; its state is unknown then."""
        self.engine.give_up()

    async def close(self) -> None:
        """Bring the robot to rest on its path, close the connection, and end all event streams."""
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
        """Add a client, which only watches at first.

        Args:
            name: name of the client for others; if it is taken, a number is added.
        """
        return Client(self, self.enter(name))
