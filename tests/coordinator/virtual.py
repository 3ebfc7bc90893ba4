"""Fixtures: a coordinator and the simulator in virtual time, with an event loop whose clock jumps to the next
event, and a connection without a socket.
"""

import asyncio
import contextlib
import random
import selectors
import time
from functools import cache
from pathlib import Path

import numpy as np
from simulator.machines import robot_machine

from yarclang.coordinator.coordinator import Coordinator
from yarclang.coordinator.engine import NO_LOG
from yarclang.coordinator.ordered import OrderedSession
from yarclang.robot.actuation import from_counts
from yarclang.robot.description import load_robot
from yarclang.simulator.commissioning import stand
from yarclang.simulator.network.ethernet import PacketReader, Station

SPY = 9
"""Port of the machine that only the tests use."""

PATIENCE = 5.0
"""Real time after which virtual time continues although a thread is still working [s]."""


class _Selector(selectors.SelectSelector):
    """Selector that waits only for threads. Instead of waiting for a time, it advances virtual time."""

    loop = None

    def select(self, timeout=None):
        found = super().select(0)
        if found or timeout == 0.0:
            return found
        if self.loop.works():
            return super().select(0.05)
        assert timeout is not None, "everybody waits for somebody"
        self.loop.virtual += timeout
        return found


class VirtualLoop(asyncio.SelectorEventLoop):
    """Event loop in virtual time. Work of threads takes no virtual time, however busy the computer is."""

    def __init__(self):
        selector = _Selector()
        super().__init__(selector)
        selector.loop = self
        self.virtual = 0.0
        self._clock_resolution = 1e-9
        self._works = {}

    def run_in_executor(self, executor, func, *args):
        work = super().run_in_executor(executor, func, *args)
        self._works[work] = time.monotonic()
        work.add_done_callback(lambda done: self._works.pop(done, None))
        return work

    def works(self):
        """True while a thread has been working for less than `PATIENCE`."""
        since = time.monotonic() - PATIENCE
        return any(began > since for began in self._works.values())

    def time(self):
        return self.virtual


def run(coroutine):
    """Run a coroutine in virtual time, and return its result."""
    with asyncio.Runner(loop_factory=VirtualLoop) as runner:
        return runner.run(coroutine)


class VirtualWire:
    """A connection to the simulated machine. The world determines how long a reply takes."""

    def __init__(self, world):
        self.arrived = asyncio.Event()
        self.closed = False
        self._world = world
        self._station = Station(world.machine, 0)
        self._reader = PacketReader()
        self._received = bytearray()
        world.wires.append(self)

    def send(self, data):
        world = self._world
        if self.closed or world.unplugged:
            return
        there = world.delay()
        loop = asyncio.get_running_loop()
        loop.call_later(there / 2.0, self._answer, data, there / 2.0)

    def _answer(self, data, back):
        world = self._world
        if world.unplugged:
            return
        world.catch_up()
        for packet in self._reader.receive(data):
            world.heard(packet)
            reply = self._station.answer(packet)
            if reply:
                asyncio.get_running_loop().call_later(back, self._arrive, reply)

    def _arrive(self, reply):
        if not self.closed and not self._world.unplugged:
            self._received += reply
            self.arrived.set()

    def take(self):
        data = bytes(self._received)
        self._received.clear()
        self.arrived.clear()
        return data

    def close(self):
        self.closed = True
        self.arrived.set()


class World:
    """A simulated machine for a coordinator.

    Attributes:
        machine: the simulator.
        unplugged: True while the cable is unplugged.
        lines: all requests and written lines, with their times.
    """

    def __init__(self, robot="INDUSTRIAL6", joints=None, delay=0.0005, seed=0, record=False):
        self.robot, self.machine = robot_machine(robot, record)
        if joints is not None:
            stand(self.machine, self.robot, np.asarray(joints) * self.robot.axis_units)
        self.random = random.Random(seed)
        self.delay = lambda: self.random.uniform(0.2, 1.0) * delay
        self.unplugged = False
        self.wires = []
        self.lines = []
        self._loop = asyncio.get_running_loop()
        self._since = self._loop.time() - self.machine.now

    async def connect(self, host, port, within):
        if self.unplugged:
            raise OSError(113, "No route to host")
        await asyncio.sleep(0.001)
        return VirtualWire(self)

    def unplug(self):
        """Unplug the cable: all connections end."""
        self.unplugged = True
        for wire in self.wires:
            wire.close()
        self.wires.clear()

    def plug(self):
        self.unplugged = False

    def catch_up(self):
        """Advance the machine to the event loop's time."""
        passed = self._loop.time() - self._since - self.machine.now
        if passed > 0.0:
            self.machine.advance(passed)

    def heard(self, packet):
        self.lines.append((self.machine.now, packet.code, packet.data.decode("ascii", "replace")))

    def stands(self):
        """Return the commanded joint positions [axis units]."""
        self.catch_up()
        counts = self.machine.positions(motors=self.robot.controller.motors)
        return from_counts(self.robot, counts) / self.robot.axis_units

    @property
    def moving(self):
        """Return True if a motor has a desired velocity other than zero."""
        self.catch_up()
        words = self.machine.control(2, SPY).items[0].split()
        return not all(int(word, 16) >> 24 & (1 << 13 | 1 << 18) for word in words)

    async def until(self, condition, within=60.0, each=0.005):
        """Wait until a condition holds. Return how long this took [s]."""
        loop = asyncio.get_running_loop()
        since = loop.time()
        while not condition():
            assert loop.time() - since < within, "it never came"
            await asyncio.sleep(each)
        return loop.time() - since


@cache
def _robot(name):
    return load_robot(name).value


async def planned_here(function, *arguments):
    """Plan without a thread, which takes no virtual time."""
    return function(*arguments)


@contextlib.asynccontextmanager
async def coordinating(*, folder=Path(), log=NO_LOG, world=None, patient=False, **options):
    """Yield the world, a running coordinator, and the client that owns the robot."""
    world = world or World(**options)
    session = OrderedSession("sim", 1025, connector=world.connect)
    coordinator = Coordinator(
        world.robot, session, folder=folder, log=log, plan=planned_here, patient=patient
    )
    async with coordinator:
        client = coordinator.attach("test")
        client.session.own()
        yield world, coordinator, client


async def done(client, text):
    """Offer a text and carry the offer out. It must end well."""
    made = await client.motion.offer(text)
    assert made.value is not None, made.diagnostics
    ended = await client.motion.go(made.value)
    assert ended.well, ended
    return made.value


def codes(result):
    return [one.code for one in result.diagnostics]
