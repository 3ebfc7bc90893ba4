"""Tests of a controller with another clock speed than this computer. The message names the simulator's rate,
not the controller's settings.
"""

import asyncio

import pytest
from runtime.virtual import robot_machine

from yarclang.pipeline.settings import items_of
from yarclang.runtime.pmac.performance import connect, look
from yarclang.runtime.session import Session
from yarclang.simulator.network.embedded import EmbeddedSimulator


def looked_at(rate):
    """Return the errors of an inspection of a simulator with its own clock, as with `yarc sim --rate`."""
    robot, machine = robot_machine("INDUSTRIAL6", record=False)

    async def looked(port):
        session = Session("127.0.0.1", port)
        try:
            await session.perform(connect(session.operation))
            return await session.perform(look(session.operation, robot, items_of(robot)))
        finally:
            session.close()

    with EmbeddedSimulator(machine, rate=rate, leashed=False) as simulator:
        return asyncio.run(looked(simulator.port)).errors


@pytest.mark.parametrize("rate", [4.0, 20.0])
def test_time_that_passes_too_fast_is_what_is_wrong(rate):
    (error,) = looked_at(rate)
    assert error.subject == "the controller's time"
    assert float(error.found.split()[2]) == pytest.approx(rate, rel=0.3)
    assert error.wanted == "real time"
    assert "without --rate" in error.remedy
