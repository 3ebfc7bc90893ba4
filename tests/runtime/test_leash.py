"""A host that is kept from its work, beside a simulator in its own process: the simulation is slower, and otherwise the same."""

import asyncio
import time

import pytest
from runtime.virtual import prepared, robot_machine

from yarclang.pipeline.settings import items_of
from yarclang.runtime.actions import Wait
from yarclang.runtime.feedback import Sample
from yarclang.runtime.notices import Changed, Remark
from yarclang.runtime.performance import connect, look, perform
from yarclang.runtime.session import Session
from yarclang.runtime.state import State
from yarclang.simulator.commissioning import stand
from yarclang.simulator.embedded import EmbeddedSimulator
from yarclang.simulator.leash import leash

TEXT = """P0010 MOVEJ 20 10 -20 30 20 15 [3] (deg,s)
P0020 MOVEJ 0 0 0 0 0 0 [3] (deg,s)
"""
PACE = 4.0


class Starved:
    """A listener that keeps the whole of its thread from its work, a few times while the robot moves."""

    def __init__(self, seconds, at):
        self.seconds, self.at, self.told = seconds, list(at), []

    def __call__(self, notice):
        self.told.append(notice)
        if isinstance(notice, Sample) and self.at and notice.program_time > self.at[0]:
            self.at.pop(0)
            time.sleep(self.seconds)

    @property
    def oddities(self):
        """What a person would be told of, besides the way of an undisturbed run."""
        usual = {State.STOP, State.INIT, State.MOVE, State.DISCONNECTED}
        return [
            one
            for one in self.told
            if (isinstance(one, Changed) and one.state not in usual)
            or (isinstance(one, Remark) and one.warning)
        ]


def carried_out(job, starved, leashed):
    """How a job ends on a simulator in this process, at another pace."""
    robot, machine = robot_machine(job.robot.name, record=False)
    stand(machine, robot, job.start)

    async def run(port):
        session = Session(
            "127.0.0.1", port, pace=PACE, reply_time=20.0, leash=leash(PACE) if leashed else None
        )
        session.listen(starved)
        await session.perform(connect(session.operation))
        await session.perform(look(session.operation, robot, items_of(robot)))
        ended = await session.perform(perform(session.operation, job))
        session.close()
        return ended

    with EmbeddedSimulator(machine, rate=PACE, leashed=leashed) as simulator:
        return asyncio.run(run(simulator.port))


@pytest.fixture(scope="module")
def job():
    return prepared(TEXT, tm=5.0)[0]


def test_a_host_that_stands_still_is_waited_for(job):
    starved = Starved(2.0, (0.5, 2.9, 3.1, 4.0))
    ended = carried_out(job, starved, leashed=True)
    assert ended.well, ended
    assert not starved.at
    assert not starved.oddities


def test_without_a_leash_the_guard_holds_meanwhile(job):
    starved = Starved(2.0, (0.5,))
    carried_out(job, starved, leashed=False)
    assert starved.oddities


def test_time_that_is_left_out_is_not_in_the_hosts_clock_either():
    """Waits are as long as they are asked for; what a host is late beyond the leash is left out, and the clock never goes back."""

    async def clock():
        session = Session("127.0.0.1", 1, leash=0.06)
        seen = []

        def script():
            for _ in range(3):
                seen.append(session.operation.now)
                yield Wait(session.operation.now + 0.2)
                seen.append(session.operation.now)
                before = session.now()
                time.sleep(0.5)
                seen.append(session.now())
                assert session.now() - before < 0.07
                yield Wait(session.operation.now)

        await session.perform(script())
        return seen

    seen = asyncio.run(clock())
    assert seen == sorted(seen)
    for begun, waited, late in zip(seen[::3], seen[1::3], seen[2::3], strict=True):
        assert 0.2 - 0.01 <= waited - begun <= 0.2 + 0.06 + 0.001
        assert late - waited == pytest.approx(0.06)
    assert seen[3] - seen[2] < 0.001
