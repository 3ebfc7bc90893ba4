"""Tests of a run over a real connection: only one packet is in flight, stops are sent at once, and a hold is
sent when a connection ends in motion.
"""

import asyncio
import contextlib
import re

import numpy as np
import pytest
from runtime.virtual import place_at, prepared, robot_machine, world_of

from yarclang.pipeline.settings import items_of
from yarclang.pmac.requests import Code
from yarclang.robot.actuation import to_counts
from yarclang.runtime import session as session_module
from yarclang.runtime.actions import Trouble
from yarclang.runtime.notices import Abort, Changed, Hold, Remark, Resume, Stop
from yarclang.runtime.operation import WAKING
from yarclang.runtime.pmac.performance import connect, look, perform
from yarclang.runtime.session import Session
from yarclang.runtime.state import State
from yarclang.simulator.network.ethernet import PacketReader, Station

PACE = 5.0
"""Speed of the controller's time relative to real time. With a higher speed, a busy computer can't send the
lines in time.
"""


class Controller(asyncio.Protocol):
    """A machine on a port. `heard` has (connection, code, value, data, early); early is True if the request
    came before the reply to the previous one.
    """

    def __init__(self, machine):
        self.machine = machine
        self.heard = []
        self.delay = 0.0
        self.pieces = False
        self.silent = False
        self.connections = 0

    @contextlib.asynccontextmanager
    async def served(self):
        loop = asyncio.get_running_loop()
        self.since = loop.time() - self.machine.now / PACE
        server = await loop.create_server(lambda: _Wire(self), "127.0.0.1", 0)
        ticking = asyncio.ensure_future(self._tick())
        try:
            session = Session("127.0.0.1", server.sockets[0].getsockname()[1], pace=PACE, reply_time=0.3)
            session.operation.wanted_silence = 1.0 * PACE
            yield session
        finally:
            ticking.cancel()
            server.close()

    def catch_up(self):
        passed = (asyncio.get_running_loop().time() - self.since) * PACE - self.machine.now
        self.machine.advance(max(passed, 0.0))

    async def _tick(self):
        while True:
            self.catch_up()
            await asyncio.sleep(0.005)

    def texts(self):
        """Return the received requests as text."""
        return [
            f"^{chr(value + 64)}" if code == Code.SENDCTRLCHAR else data.decode()
            for _, code, value, data, _ in self.heard
        ]


class _Wire(asyncio.Protocol):
    def __init__(self, controller):
        self.controller = controller
        self.reader = PacketReader()
        self.busy = False

    def connection_made(self, transport):
        self.transport = transport
        self.controller.connections += 1
        self.station = Station(self.controller.machine, 0)

    def data_received(self, data):
        controller = self.controller
        for packet in self.reader.receive(data):
            controller.heard.append(
                (controller.connections, packet.code, packet.value, packet.data, self.busy)
            )
            controller.catch_up()
            reply = self.station.answer(packet)
            if controller.silent and packet.code != Code.SENDCTRLCHAR:
                continue
            self.busy = True
            asyncio.get_running_loop().call_later(controller.delay, self._answer, reply)

    def _answer(self, reply):
        self.busy = False
        if self.controller.pieces:
            for place in range(len(reply)):
                self.transport.write(reply[place : place + 1])
        else:
            self.transport.write(reply)


@pytest.fixture
def job():
    return prepared(tm=50)[0]


@pytest.fixture
def controller(job):
    _, machine = robot_machine(job.robot.name, False)
    return Controller(machine)


async def begun(session, job):
    """Connect, inspect, and begin a job. Return the task that performs it, when the robot moves."""
    operation = session.operation
    await session.perform(connect(operation))
    found = await session.perform(look(operation, job.robot, items_of(job.robot)))
    assert not found.errors
    task = asyncio.ensure_future(session.perform(perform(operation, job)))
    while operation.state is not State.MOVE and not task.done():
        await asyncio.sleep(0.005)
    return task


def stands(controller, job):
    return controller.machine.positions(motors=job.robot.controller.motors)


@pytest.mark.parametrize("pieces", [False, True])
def test_a_run_to_its_end(controller, job, pieces):
    async def run():
        controller.pieces = pieces
        async with controller.served() as session:
            told = []
            session.listen(told.append)
            ended = await (await begun(session, job))
            session.close()
            return ended, told

    ended, told = asyncio.run(run())
    assert ended.well
    assert np.abs(stands(controller, job) - to_counts(job.robot, job.end)).max() <= 1.0
    assert [notice.state for notice in told if isinstance(notice, Changed)][-2:] == [State.MOVE, State.STOP]
    assert not any(early for *_, early in controller.heard), "one packet in flight"


@pytest.mark.parametrize(("order", "text"), [(Stop(), "&1H"), (Hold(), "&1H"), (Abort(), "^A")])
def test_an_order_goes_out_right_behind_the_reply_that_is_awaited(controller, job, order, text):
    async def run():
        async with controller.served() as session:
            task = await begun(session, job)
            controller.delay = 0.02
            await asyncio.sleep(0.065)
            heard = len(controller.heard)
            session.order(order)
            await asyncio.sleep(0.06)
            controller.delay = 0.0
            if order == Hold():
                session.order(Resume())
            ended = await task
            session.close()
            return ended, heard

    ended, heard = asyncio.run(run())
    assert ended.well == (order == Hold())
    # The order comes at the latest after a request that was already being sent.
    assert text in controller.texts()[heard : heard + 2]
    assert not any(early for *_, early in controller.heard)


def test_last_words_on_a_connection_whose_reply_is_missing(controller, job):
    async def run():
        async with controller.served() as session:
            task = await begun(session, job)
            controller.silent = True
            while not task.done() and session.operation.state is State.MOVE:
                await asyncio.sleep(0.01)
            controller.silent = False
            ended = await task
            session.close()
            return ended

    ended = asyncio.run(run())
    assert "no reply" in ended.what
    assert ended.joints is not None
    first = next(n for n, text in enumerate(controller.texts()) if text == "^O")
    # The hold was sent on the old connection, and on the new one.
    assert controller.heard[first][0] == 1
    last = controller.connections
    assert last >= 2
    assert (last, Code.SENDCTRLCHAR, 15) in [heard[:3] for heard in controller.heard]


def test_a_session_that_is_closed_in_motion_holds(controller, job):
    """A session that is closed during a motion, for example because its program fails, holds the robot."""

    async def run():
        async with controller.served() as session:
            task = await begun(session, job)
            await asyncio.sleep(0.05)
            task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await task
            session.close()
            await asyncio.sleep(0.1)
            return stands(controller, job)

    assert not np.allclose(asyncio.run(run()), 0.0)
    assert controller.texts()[-1] == "^O"


def test_who_watches_and_fails_stops_the_run_on_its_path(controller, job):
    async def run():
        async with controller.served() as session:
            task = await begun(session, job)
            session.listen(lambda notice: 1 / 0)
            ended = await task
            session.close()
            return ended

    ended = asyncio.run(run())
    assert not ended.well
    assert "an internal observer of this run has failed: ZeroDivisionError" in ended.what
    assert "&1H" in controller.texts()


def test_a_computer_that_was_suspended(controller, job, monkeypatch):
    """The lid of the computer was closed: its clock stood still meanwhile, but a person has to resume."""
    off = [7.0]
    monkeypatch.setattr(session_module, "switched_off", lambda: off[0])

    async def run():
        async with controller.served() as session:
            task = await begun(session, job)
            off[0] += 60.0
            while session.operation.state is State.MOVE and not task.done():
                await asyncio.sleep(0.005)
            session.order(Resume())  # it was given while nobody could see the robot
            await asyncio.sleep(0.6)
            state = session.operation.state
            session.order(Resume())
            ended = await task
            session.close()
            return state, ended

    state, ended = asyncio.run(run())
    assert state is State.HOLD
    assert ended.well


def test_an_order_for_the_next_step_that_came_during_a_suspension(monkeypatch):
    off = [7.0]
    monkeypatch.setattr(session_module, "switched_off", lambda: off[0])

    async def run():
        session = Session("127.0.0.1", 1)
        told = []
        session.listen(told.append)
        waiting = asyncio.ensure_future(session.order_given(Resume))
        await asyncio.sleep(0.05)
        off[0] += 60.0
        session.order(Resume())
        await asyncio.sleep(0.1)
        session.order(Resume())
        await asyncio.sleep(WAKING + 0.1)
        ignored = not waiting.done()
        session.order(Resume())
        await asyncio.wait_for(waiting, 5.0)
        return ignored, told

    ignored, told = asyncio.run(run())
    assert ignored
    assert sum("is ignored" in one.text for one in told if isinstance(one, Remark)) == 2


def test_nobody_at_the_address():
    async def run():
        session = Session("127.0.0.1", 1)
        try:
            await session.perform(connect(session.operation))
        finally:
            session.close()

    with pytest.raises(Trouble, match=r"127.0.0.1:1 can't be reached: connection refused"):
        asyncio.run(run())


def test_the_wire_is_the_same_as_in_virtual_time(controller, job):
    """A session sends the same requests as the virtual connection of the other tests."""

    async def run():
        async with controller.served() as session:
            await (await begun(session, job))
            session.close()

    asyncio.run(run())
    world = world_of(job, stand=False)
    place_at(world, job.robot, job.start)
    world.perform(perform(world.operation, job))
    words = [text for text in controller.texts() if text and "\0" not in text]
    asked = world.asked

    def once(lines):
        lines = [re.sub(r"I5112=\d+", "I5112=", line) for line in lines]
        return [line for line in dict.fromkeys(lines) if line not in ("^L", "P8100", "P8104", "%")]

    assert once(words) == once(asked)
