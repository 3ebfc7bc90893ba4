"""An interpreter on a coordinator in virtual time, and a simulated person who types."""

import asyncio
import contextlib

from coordinator.virtual import coordinating

from yarclang.coordinator.attached import Here
from yarclang.coordinator.messages import orders
from yarclang.repl.interpreter import Interpreter
from yarclang.repl.session import PROMPT


class Person:
    """A person who types, and reads the output.

    Attributes:
        said: all output since it was last taken.
    """

    def __init__(self, world, coordinator, attached, folder, asks):
        self.world, self.coordinator, self.said = world, coordinator, []
        self.interpreter = Interpreter(attached, world.robot, self.said.append, folder, asks=asks)

    async def type(self, *texts, within=200.0):
        """Type texts, each after the one before is done or asks a question; return the output."""
        for text in texts:
            self.interpreter.typed(text)
            await self.settled(within)
        return self.taken()

    async def settled(self, within=200.0):
        await self.world.until(lambda: self.interpreter.idle or self.interpreter.asked, within)

    async def begin(self, text):
        """Type a text that starts a motion, and return when the robot moves."""
        self.interpreter.typed(text)
        await self.world.until(lambda: self.world.moving)

    def taken(self):
        text = "\n".join(self.said)
        self.said.clear()
        return text

    @property
    def asked(self):
        return self.interpreter.prompt if self.interpreter.prompt != PROMPT else ""


@contextlib.asynccontextmanager
async def talking(folder, *, asks=False, **options):
    """Yield a person who owns a robot."""
    async with coordinating(folder=folder, **options) as (world, coordinator, client):
        client.session.leave()
        attached = Here(coordinator, "person")
        await attached.ask(orders.Own(shared=True))
        person = Person(world, coordinator, attached, folder, asks)
        served = asyncio.create_task(person.interpreter.serve())
        with coordinator.subscribe() as events:
            heard = asyncio.create_task(_hear(events, person.interpreter))
            yield person
            heard.cancel()
        person.interpreter.leave()
        await served


async def _hear(events, interpreter):
    async for event in events:
        interpreter.hear(event)
