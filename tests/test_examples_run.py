"""Tests of the examples with inputs, outputs and holds: on the simulator, each ends within one count of its
goal, however long the operator waits.
"""

import contextlib
from dataclasses import replace

import numpy as np
import pytest
from conftest import EXAMPLES

from tests.runtime.virtual import World
from yarclang.backend_pmac.settings import settings_text
from yarclang.decisions import inputs_of
from yarclang.hir import WaitInput, WaitUntil, When, searches_of
from yarclang.pipeline.inputs import Options, open_program
from yarclang.pipeline.jobs import job_of_compiled
from yarclang.pipeline.replanning import replanned
from yarclang.pipeline.shifting import shifted
from yarclang.pipeline.stages import Request, compile_module
from yarclang.robot.actuation import to_counts
from yarclang.runtime.actions import Trouble
from yarclang.runtime.notices import Changed, Fill, Progress, Reached, Resume, Stop, ValuesWanted
from yarclang.runtime.pmac.performance import connect, perform
from yarclang.runtime.signals import OutputSet
from yarclang.runtime.state import State
from yarclang.runtime.values import checked_values
from yarclang.simulated_cell.cameras import load_cameras
from yarclang.simulated_cell.playing import SimulatedCell
from yarclang.simulated_cell.script import known_in, load_script
from yarclang.simulator.beside import Beside
from yarclang.simulator.commissioning import commissioned, stand

NO_HOLD = ("24_recovery_at_start.yarc",)
"""Examples that hold only if the run before was stopped in a certain phase."""

OWN_ROBOT = ("29_tool_changer.yarc",)
"""Examples with a robot.toml of their own."""

NAMES = sorted(path.name for path in EXAMPLES.glob("*.yarc") if path.name >= "05")


class Operator:
    """A simulated operator: resumes at each HOLD, answers 2 to each question for a number, and reports to the
    simulated cell at which command the program waits, as the coordinator does.
    """

    def __init__(self, world, cell):
        self.world, self.cell, self.heard = world, cell, 0
        self.waits = []
        cell.receive(self.fill)
        self.look()

    def fill(self, given):
        """Give the program a camera's values, as the coordinator does."""
        operation = self.world.operation
        with contextlib.suppress(Trouble):
            values = checked_values(operation.wants, given.number, given.values)
            operation.want(None)
            operation.orders.append(Fill(values, given.camera))

    def look(self):
        self.world.at.append((self.world.now + 0.02, self.look))
        told = self.world.told[self.heard :]
        self.heard += len(told)
        for one in told:
            match one:
                case Progress(command=command) if command:
                    self.cell.reached(command.split(" ")[0])
                case Reached(place=place):
                    self.cell.reached(place)
                case ValuesWanted(wanted=wanted):
                    self.cell.wanted(wanted)
                case Changed(state=State.HOLD, why=why, asks=asks):
                    self.waits.append(why)
                    if "waits for" not in why:
                        answer = Resume(None if asks is None else 2)
                        self.world.do(lambda answer=answer: self.world.operation.orders.append(answer), 0.5)


def cell_of(name, compiled, robot, folder=EXAMPLES):
    """Return the simulated cell of an example's script; a program with a WAIT for an input must have one."""
    cell = compiled.program.cell
    sensed = {one.input for one in cell.sensors} if cell is not None else set()
    file = folder / f"{name.removesuffix('.yarc')}.inputs.toml"
    waits = any(
        (isinstance(step, WaitInput) and step.input.variable not in sensed)
        or (isinstance(step, WaitUntil | When) and inputs_of(step.condition))
        or any(register.outside for register in compiled.program.registers)
        for step in compiled.program.steps
    )
    waits = waits or bool(compiled.program.watches or searches_of(compiled.program))
    assert file.exists() == waits, file
    if not waits:
        return SimulatedCell(cell=cell, robot=robot)
    known = known_in(compiled.program, cell, robot.controller.signal)
    script = load_script(file, known)
    cameras = load_cameras(file, known, cell)
    assert (script.diagnostics, cameras.diagnostics) == ((), ())
    return SimulatedCell(script.value, known, cell=cell, robot=robot, waits=True, cameras=cameras.value)


def played(name, held=None, folder=EXAMPLES, outputs=None, within=600.0, stop=None):
    """Run an example with its script.

    Args:
        held: registers, by name, that hold what a run before left in them.
        folder: where the example and its script are.
        outputs: variables of the controller, by name, that aren't 0 when the run begins.
        within: the longest that the run may take [s].
        stop: when the operator stops the run [s after its start]; None: never.

    Returns:
        The world that the example was run in, its end, its job, and the operator.
    """
    opened = open_program(
        str(folder / name), Options(robot=None if name in OWN_ROBOT else "INDUSTRIAL6")
    ).value
    compiled = compile_module(opened.module, opened.request).value
    robot = opened.request.robot
    job = job_of_compiled(compiled, name)
    begin = held or {}
    assert begin.keys() <= {one.name for one in job.registers}
    job = replace(
        job, registers=tuple(replace(one, first=begin.get(one.name, one.first)) for one in job.registers)
    )
    machine = commissioned(robot, settings_text(robot))
    stand(machine, robot, job.start)
    cell = cell_of(name, compiled, robot, folder)
    cell.attach(Beside(machine))
    world = World(machine)

    def replan(wanted):
        begins = [abs(one.begins - wanted.begins) for one in job.commands]
        number, request = int(np.argmin(begins)), Request(robot)
        if wanted.values is not None:
            return shifted(compiled.plan, number, wanted.joints, wanted.values, request)
        return replanned(compiled.plan, number, wanted.joints, request)

    world.replan = replan
    world.perform(connect(world.operation))
    operator = Operator(world, cell)
    cell.begin()
    for variable, _ in job.outputs:
        machine.command(f"{variable}->*", 7)
    for variable, value in (outputs or {}).items():
        assert machine.command(f"{variable}={value}", 7).error is None
    if stop is not None:
        world.order(Stop(), stop)
    ended = world.perform(perform(world.operation, job), within)
    return world, ended, job, operator


def carried_out(name):
    """Run an example to its end, which must be without a fault. Return the world of the run, and its end."""
    world, ended, job, operator = played(name)
    assert ended.well, ended.what
    robot, machine = job.robot, world.machine
    counts = machine.positions(motors=robot.controller.motors)
    assert np.abs(counts - to_counts(robot, ended.joints)).max() < 1.0
    assert all(float(machine.command(variable, 7).items[0]) == safe for variable, safe in job.outputs)
    stops = {leg.barrier.kind for leg in job.legs if leg.barrier is not None}
    assert operator.waits or "hold" not in stops or name in NO_HOLD
    return world, ended


@pytest.mark.parametrize("name", NAMES)
def test_an_example_runs_to_its_end(name):
    carried_out(name)


def test_there_are_such_examples():
    assert len(NAMES) == 30


def test_the_called_jobs_are_those_of_their_numbers():
    """The number of the first job changes after it is read, the gripper is tried twice, and the second job is
    the other one.
    """
    name = "16_called_by_number.yarc"
    world, ended = carried_out(name)
    told = [one for one in world.told if isinstance(one, OutputSet)]
    answers = [(one.variable, one.value) for one in told if one.variable in ("M80", "M81") and one.value]
    assert answers == [("M80", 1.0), ("M81", 1.0)]
    assert dict(ended.registers) == {"TRIES": 1, "LOADED": 1}


@pytest.mark.parametrize(
    ("name", "registers"),
    [
        ("17_tray_of_trays.yarc", {"TRAYS": 0, "PLACE": 2}),
        ("18_tending_with_retry.yarc", {"BAD": 1, "TRIES": 0}),
        ("19_two_sided_handshake.yarc", {"LATES": 2, "NOW": 7}),
        ("20_tool_change.yarc", {"ON_FLANGE": 0, "TRIES": 0}),
        ("21_good_and_bad_bins.yarc", {"GOOD": 1, "BAD": 1, "ALL_GOOD": 3}),
        ("22_conveyor_batches.yarc", {"BOXES": 2, "SLIPPED": 1, "IN_A_ROW": 0}),
        ("23_touch_up_welding.yarc", {"WELDED": 2, "RELIT": 1}),
        ("24_recovery_at_start.yarc", {"PHASE": 0, "DONE": 0, "LOST": 0}),
        ("25_stack_height.yarc", {"LEFT": 1}),
        ("26_rows_by_camera.yarc", {"SEEN": 1, "ROW": 2, "MISSED": 0, "STAMPED": 2}),
        ("27_bin_picking.yarc", {"SEEN": 1, "DX": 321, "DY": 1100, "TURN": 0, "MISSED": 1}),
    ],
)
def test_what_is_counted_is_what_was_done(name, registers):
    world, ended = carried_out(name)
    held = dict(ended.registers)
    assert {key: held[key] for key in registers} == registers
    if name.startswith("17"):
        assert world.kept == {"PLACE": 2}
    if name.startswith("20"):  # the lock was tried twice
        told = [one.value for one in world.told if isinstance(one, OutputSet) and one.variable == "M1"]
        assert told == [1.0, 0.0, 1.0, 0.0]
