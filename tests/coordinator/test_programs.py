"""Tests of whole programs in a session: from a given command, command by command, repeatedly, and from
another position.
"""

import asyncio
from pathlib import Path

import pytest
from coordinator.virtual import coordinating, done, run

from yarclang.coordinator.messages import events
from yarclang.coordinator.programs import load_program
from yarclang.pipeline.inputs import Options, open_source
from yarclang.runtime.actions import Trouble
from yarclang.runtime.state import State
from yarclang.source import SourceFile

TEXT = """ROBOT INDUSTRIAL6
P0010 MOVEJ 5 0 0 0 0 0 [0.5] (deg,s)
P0020 MOVEJ 5 5 0 0 0 0 [0.5] (deg,s)
P0030 MOVEJ 0 0 0 0 0 0 [0.5] (deg,s)
"""


def loaded(text=TEXT, **options):
    opened = open_source(SourceFile("p.yarc", text), Path(), Options()).value
    made = load_program(opened, "p.yarc", **options)
    assert made.value is not None, made.diagnostics
    return made.value


def test_a_program_is_run_twice():
    async def session():
        async with coordinating() as (world, _, client):
            stream = client.session.events()
            assert (await client.motion.run(loaded(), times=2)).well
            assert world.stands() == pytest.approx([0.0] * 6, abs=1e-4)
            commands = {one.command for one in stream.waiting() if isinstance(one, events.ProgressMade)}
            assert commands  # at least the newest event is still stored

    run(session())


def test_command_by_command():
    async def session():
        async with coordinating() as (world, coordinator, client):
            running = asyncio.create_task(client.motion.run(loaded(by_steps=True)))
            for place in ([5, 0, 0, 0, 0, 0], [5, 5, 0, 0, 0, 0]):
                await world.until(lambda: coordinator.engine.session.paused)
                assert world.stands() == pytest.approx(place, abs=1e-4)
                client.motion.resume()
                await asyncio.sleep(0.05)
            assert (await running).well
            running = asyncio.create_task(client.motion.run(loaded(by_steps=True)))
            await world.until(lambda: coordinator.engine.session.paused)
            client.motion.stop()
            ended = await running
            assert (ended.well, ended.what) == (False, "ended before P0020 MOVEJ")
            assert coordinator.state is State.STOP

    run(session())


def test_from_a_command_on_and_from_elsewhere():
    async def session():
        async with coordinating() as (world, _, client):
            await done(client, "MOVEJ 1 0 0 0 0 0 [1] (deg,s)")
            rest = loaded(first="P0020")
            with pytest.raises(
                Trouble, match=r"the robot doesn't stand where P0020 MOVEJ starts: J1 -4\.0000 deg"
            ):
                await client.motion.run(rest)
            assert (await client.motion.run(rest, approach=True)).well
            assert world.stands() == pytest.approx([0.0] * 6, abs=1e-4)

    run(session())


def test_a_program_that_waits_for_the_operator():
    async def session():
        async with coordinating() as (world, coordinator, client):
            text = TEXT.replace("P0020 MOVEJ", 'P0015 HOLD "look"\nP0020 MOVEJ')
            running = asyncio.create_task(client.motion.run(loaded(text)))
            await world.until(lambda: coordinator.state is State.HOLD)
            assert world.stands() == pytest.approx([5, 0, 0, 0, 0, 0], abs=1e-4)
            client.motion.resume()
            assert (await running).well

    run(session())
