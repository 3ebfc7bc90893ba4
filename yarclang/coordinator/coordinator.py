"""The coordinator: owns one robot, takes commands and programs, plans from where the robot really stands, moves, and tells.

Everything runs in one event loop; `plan` may hand planning to a thread. docs/coordinator.md shows it in use.
"""

from __future__ import annotations

import asyncio

from yarclang.coordinator.client import Client
from yarclang.coordinator.shared import SharedRobot
from yarclang.coordinator.signals import hear_inputs, receive_values
from yarclang.runtime.inspection import Inspection


class Coordinator(SharedRobot):
    """A robot from the connection to the end, to which clients attach."""

    async def start(self) -> Inspection | None:
        """Connect to the controller, look at everything, and be at work from now on.

        Returns:
            What was found; None if a patient one doesn't reach the controller yet.

        Raises:
            Trouble: it can't be reached, or isn't what the robot needs (`NotReady`).
        """
        if self.surroundings is not None:
            later = asyncio.get_running_loop().call_soon_threadsafe
            hear_inputs(self.surroundings, self._session, later)
            receive_values(self.surroundings, self.values, later)
        return await self.engine.start(patient=self._patient)

    def give_up(self) -> None:
        """End without waiting for a robot that can't be reached: nobody knows then what it does."""
        self.engine.give_up()

    async def close(self) -> None:
        """Bring the robot to rest on its path, end the connection, and all event streams."""
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
        """Somebody new, who watches at first.

        Args:
            name: what others know the client by; where it is taken, a number is added.
        """
        return Client(self, self.enter(name))
