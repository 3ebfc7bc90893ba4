"""The examples with inputs, outputs and holds run on the simulator and end to a count, whatever the operator's patience."""

import numpy as np
import pytest
from conftest import EXAMPLES

from tests.runtime.virtual import World
from yarclang.backend_pmac.settings import settings_text
from yarclang.pipeline.inputs import Options, open_program
from yarclang.pipeline.jobs import job_of_compiled
from yarclang.pipeline.stages import compile_module
from yarclang.robot.actuation import to_counts
from yarclang.runtime.notices import Changed, Resume
from yarclang.runtime.performance import connect, perform
from yarclang.runtime.state import State
from yarclang.simulator.commissioning import commissioned, stand

NAMES = sorted(path.name for path in EXAMPLES.glob("*.yarc") if path.name >= "05")


class Cell:
    """Plays the operator and the machines around the robot: what is waited for comes half a second later."""

    def __init__(self, world, job):
        self.world, self.waits = world, 0
        self.variables = {
            leg.barrier.name: leg.barrier for leg in job.legs if leg.barrier and leg.barrier.kind == "wait"
        }
        for leg in job.legs:
            if leg.barrier is not None and leg.barrier.variable.startswith("M"):
                world.machine.command(f"{leg.barrier.variable}->*", 7)
        self.look()

    def look(self):
        self.world.at.append((self.world.now + 0.5, self.look))
        changes = [one for one in self.world.told if isinstance(one, Changed)]
        if self.world.operation.state is not State.HOLD or not changes:
            return
        why = changes[-1].why
        self.waits += 1
        if "waits for" in why:
            name = why.split("waits for ")[1].split()[0]
            value = 1 if why.endswith("ON") else 0
            self.world.machine.command(f"{self.variables[name].variable}={value}", 7)
        else:
            self.world.operation.orders.append(Resume())


@pytest.mark.parametrize("name", NAMES)
def test_an_example_runs_to_its_end(name):
    opened = open_program(str(EXAMPLES / name), Options(robot="INDUSTRIAL6")).value
    compiled = compile_module(opened.module, opened.request).value
    robot = opened.request.robot
    job = job_of_compiled(compiled, name)
    machine = commissioned(robot, settings_text(robot))
    stand(machine, robot, job.start)
    world = World(machine)
    world.perform(connect(world.operation))
    cell = Cell(world, job)
    for variable, _ in job.outputs:
        machine.command(f"{variable}->*", 7)
    ended = world.perform(perform(world.operation, job))
    assert ended.well, ended.what
    counts = machine.positions(motors=robot.controller.motors)
    assert np.abs(counts - to_counts(robot, ended.joints)).max() < 1.0
    assert all(float(machine.command(variable, 7).items[0]) == safe for variable, safe in job.outputs)
    assert cell.waits > 0 or not any(leg.barrier and leg.barrier.kind in ("wait", "hold") for leg in job.legs)


def test_there_are_such_examples():
    assert len(NAMES) == 8
