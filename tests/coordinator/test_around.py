"""Tests of the reply about a robot's surroundings: its cell, its inputs and outputs, and their values."""

import asyncio

import pytest
from coordinator.virtual import coordinating, done, run

from yarclang.coordinator.desk import Desk
from yarclang.coordinator.messages import orders
from yarclang.coordinator.ownership import NotOwner
from yarclang.runtime.actions import Trouble
from yarclang.simulated_cell.playing import SimulatedCell
from yarclang.simulator.beside import Beside

DECLARED = "INPUT DOOR M11\nOUTPUT GLUE M1 OFF\nMOVEJ 1 0 0 0 0 0 [1] (deg,s)"
CELL = '[inputs]\nREADY = "M12"\n\n[outputs]\nGRIP = "M2"\n'


async def around(coordinator, name="watcher"):
    return await Desk(coordinator, coordinator.attach(name)).answer(orders.AskSurroundings())


def by_name(signals):
    return {one.name: (one.variable, one.value) for one in signals}


def test_signals_of_the_session_and_what_they_are():
    async def asked():
        async with coordinating() as (world, coordinator, client):
            assert (await around(coordinator)).inputs == ()
            await done(client, DECLARED)
            world.machine.variables.write("M", 11, 1.0, 1)
            told = await around(coordinator)
            assert by_name(told.inputs) == {"DOOR": ("M11", 1.0)}
            assert by_name(told.outputs) == {"GLUE": ("M1", 0.0)}
            assert "Y1619" in told.fixed
            assert told.robot == str(world.robot.folder)
            offer = (await client.motion.offer("MOVEJ 0 0 0 0 0 0 [2] (deg,s)")).value
            going = asyncio.create_task(client.motion.go(offer))
            await world.until(lambda: coordinator.under_way)
            told = await around(coordinator)
            # the value isn't known while the robot moves
            assert by_name(told.inputs) == {"DOOR": ("M11", None)}
            await going

    run(asked())


def test_a_cell_of_the_session(tmp_path):
    (tmp_path / "c.toml").write_text(CELL)

    async def asked():
        async with coordinating(folder=tmp_path) as (_, coordinator, client):
            await done(client, 'CELL "c.toml"\nMOVEJ 1 0 0 0 0 0 [1] (deg,s)')
            told = await around(coordinator)
            assert told.cell == str(tmp_path / "c.toml")
            assert [one.name for one in told.inputs] == ["READY"]
            assert [one.name for one in told.outputs] == ["GRIP"]

    run(asked())


def test_a_simulated_robot_tells_at_any_time_and_its_inputs_can_be_set():
    async def asked():
        async with coordinating() as (world, coordinator, client):
            coordinator.surroundings = cell = SimulatedCell()
            assert cell.value("M11") is None
            cell.attach(Beside(world.machine))
            await done(client, DECLARED)
            watcher = coordinator.attach("watcher")
            with pytest.raises(NotOwner):
                watcher.signals.set_input("DOOR", "ON")
            client.session.own(shared=True)
            watcher.signals.set_input("DOOR", "ON")
            cell.handle()
            told = await around(coordinator)
            assert by_name(told.inputs) == {"DOOR": ("M11", 1.0)}
            assert told.fixed == ""
            client.session.release()
            watcher.signals.set_input("DOOR", "OFF")  # allowed, since nobody owns the robot
            with pytest.raises(Trouble, match="No input is named"):
                watcher.signals.set_input("DOORS", "ON")
            cell.handle()
            assert by_name((await around(coordinator)).inputs) == {"DOOR": ("M11", 0.0)}

    run(asked())
