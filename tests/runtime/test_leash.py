"""Tests of a host that is blocked while a simulator runs in its own process. The simulation becomes slower,
but nothing else changes.
"""

import asyncio
import time

import pytest
from runtime.virtual import prepared, robot_machine

from yarclang.pipeline.settings import items_of
from yarclang.runtime.actions import Wait
from yarclang.runtime.notices import Changed, Remark
from yarclang.runtime.pmac.performance import connect, look, perform
from yarclang.runtime.sample import Sample
from yarclang.runtime.session import Session
from yarclang.runtime.state import State
from yarclang.simulator.commissioning import stand
from yarclang.simulator.network.embedded import EmbeddedSimulator

TEXT = """P0010 MOVEJ 20 10 -20 30 20 15 [3] (deg,s)
P0020 MOVEJ 0 0 0 0 0 0 [3] (deg,s)
"""
PACES = [4.0, 20.0]


class Starved:
    """A listener that blocks its thread several times while the robot moves."""

    def __init__(self, seconds, at):
        self.seconds, self.at, self.told = seconds, list(at), []

    def __call__(self, notice):
        self.told.append(notice)
        if isinstance(notice, Sample) and self.at and notice.program_time > self.at[0]:
            self.at.pop(0)
            time.sleep(self.seconds)

    @property
    def oddities(self):
        """Return the notices that an undisturbed run wouldn't give."""
        usual = {State.STOP, State.INIT, State.MOVE, State.DISCONNECTED}
        return [
            one
            for one in self.told
            if (isinstance(one, Changed) and one.state not in usual)
            or (isinstance(one, Remark) and one.warning)
        ]


def carried_out(job, starved, leashed, pace=4.0):
    """Return the outcome of a job on a simulator in this process, at `pace` times real time. If `leashed`,
    the simulator waits for its client.
    """
    robot, machine = robot_machine(job.robot.name, record=False)
    stand(machine, robot, job.start)

    async def run(port, leash):
        session = Session("127.0.0.1", port, pace=pace, reply_time=20.0, leash=leash)
        session.listen(starved)
        await session.perform(connect(session.operation))
        await session.perform(look(session.operation, robot, items_of(robot)))
        ended = await session.perform(perform(session.operation, job))
        session.close()
        return ended

    with EmbeddedSimulator(machine, rate=pace, leashed=leashed) as simulator:
        return asyncio.run(run(simulator.port, simulator.leash))


@pytest.fixture(scope="module")
def job():
    return prepared(TEXT, tm=5.0)[0]


@pytest.mark.parametrize("pace", PACES)
def test_a_host_that_stands_still_is_waited_for(job, pace):
    starved = Starved(1.0, (0.5, 2.9, 3.1, 4.0))
    ended = carried_out(job, starved, leashed=True, pace=pace)
    assert ended.well, ended
    assert not starved.at
    assert not starved.oddities


def test_without_a_leash_the_guard_holds_meanwhile(job):
    starved = Starved(2.0, (0.5,))
    carried_out(job, starved, leashed=False)
    assert starved.oddities


@pytest.mark.parametrize("pace", PACES)
def test_a_process_that_is_stopped_again_and_again_holds_nothing(job, pace):
    """The guard PLC doesn't hold the motion of a process that is stopped repeatedly. When the process
    continues, a request is already waiting in the simulator's socket. Even then, the time since the last
    request doesn't count as silence.
    """
    starved = Starved(0.2, [0.3 * number for number in range(15)])
    ended = carried_out(job, starved, leashed=True, pace=pace)
    assert ended.well, ended
    assert not starved.oddities


class Machine:
    """Replacement for a simulator on a leash, whose time the test sets."""

    def __init__(self):
        self.until = None
        self.time = 0.0

    def now(self):
        return self.time


def test_the_clock_is_the_simulators_and_who_waits_lets_it_pass():
    leash = Machine()
    allowed = []

    async def clock():
        session = Session("127.0.0.1", 1, leash=leash)

        def script():
            for _ in range(3):
                allowed.append(leash.until - leash.time)
                yield Wait(session.operation.now + 0.2)

        async def pass_time():
            while True:
                leash.time += 0.01
                await asyncio.sleep(0.001)

        passing = asyncio.create_task(pass_time())
        await session.perform(script())
        passing.cancel()
        return session.now()

    assert asyncio.run(clock()) >= 0.6
    assert max(allowed) <= 0.02 + 1e-9
    assert leash.until is None, "without a script nobody has the leash"


def test_an_order_ends_a_wait_of_a_simulator_that_does_not_go_on():
    leash = Machine()

    async def clock():
        session = Session("127.0.0.1", 1, leash=leash)

        def script():
            yield Wait(1.0)

        asyncio.get_running_loop().call_later(0.05, session.wake)
        await asyncio.wait_for(session.perform(script()), 5.0)

    asyncio.run(clock())
