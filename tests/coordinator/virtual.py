"""A coordinator and the simulator in virtual time: an event loop whose clock jumps to what comes next, and
a wire without a socket.
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
"""A port of the machine that nobody else uses."""

PATIENCE = 5.0
"""The time goes on although a thread still works after so long [s of the real clock]."""


class _Selector(selectors.SelectSelector):
    """Never waits but for threads: the time goes on instead."""

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
    """An event loop in virtual time [s]: what threads do takes none, however busy the computer is."""

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
        """True while a thread works on something that isn't meant to last."""
        since = time.monotonic() - PATIENCE
        return any(began > since for began in self._works.values())

    def time(self):
        return self.virtual


def run(coroutine):
    """Run in virtual time; nothing may be left behind."""
    with asyncio.Runner(loop_factory=VirtualLoop) as runner:
        return runner.run(coroutine)


class VirtualWire:
    """A connection to a machine; a reply takes as long as the world says."""

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
    """A machine that a coordinator owns.

    Attributes:
        machine: the simulator.
        unplugged: whether the cable is out.
        lines: what was asked and written, with the time.
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
        """Take the cable out: connections end."""
        self.unplugged = True
        for wire in self.wires:
            wire.close()
        self.wires.clear()

    def plug(self):
        self.unplugged = False

    def catch_up(self):
        """The machine's time is the loop's."""
        passed = self._loop.time() - self._since - self.machine.now
        if passed > 0.0:
            self.machine.advance(passed)

    def heard(self, packet):
        self.lines.append((self.machine.now, packet.code, packet.data.decode("ascii", "replace")))

    def stands(self):
        """Commanded joints [axis units]."""
        self.catch_up()
        counts = self.machine.positions(motors=self.robot.controller.motors)
        return from_counts(self.robot, counts) / self.robot.axis_units

    @property
    def moving(self):
        """Whether a motor has a desired velocity."""
        self.catch_up()
        words = self.machine.control(2, SPY).items[0].split()
        return not all(int(word, 16) >> 24 & (1 << 13 | 1 << 18) for word in words)

    async def until(self, condition, within=60.0, each=0.005):
        """Wait until something is so; how long it took [s]."""
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
    """Planning takes no time in virtual time, and no thread."""
    return function(*arguments)


@contextlib.asynccontextmanager
async def coordinating(*, folder=Path(), log=NO_LOG, world=None, patient=False, **options):
    """A coordinator at work, an owner, and its world."""
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
    """Offer and go; it must be well."""
    made = await client.motion.offer(text)
    assert made.value is not None, made.diagnostics
    ended = await client.motion.go(made.value)
    assert ended.well, ended
    return made.value


def codes(result):
    return [one.code for one in result.diagnostics]
