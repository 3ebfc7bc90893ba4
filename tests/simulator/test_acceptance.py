"""Acceptance: compiled programs end where the plan ends, and move as the certificate says.

An hour of simulation takes no more memory than ten minutes.
"""

import gc
import sys
import time
from functools import cache
from types import BuiltinFunctionType, FunctionType, ModuleType

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from simulator.machines import EXAMPLES, bare, error, example, feed, lines_of, robot_machine, say
from simulator.serving import Client, served

from yarclang.backend_pmac.settings import settings_text
from yarclang.independent.arm import Arm
from yarclang.independent.reading import off_line
from yarclang.robot.actuation import from_counts, to_counts
from yarclang.runtime.pmac.protocol import Ask, Write, Written, fitting
from yarclang.simulator.machine import Machine

BOTH = pytest.mark.parametrize("name", EXAMPLES)
TARGETS = pytest.mark.parametrize("target", ["prog", "rotary"])

FULL = 6
"""Number of the error for a full buffer (ERR006)."""

STEP = 1e-3
"""Time between two instants of a trace [s]."""


# over TCP


def numbers(client, question):
    event = client.ask(Ask(question))
    assert event.error is None, event
    return np.array([float(item) for item in event.items])


def write(client, lines):
    """Send lines in a packet; return how many were accepted before the buffer was full."""
    event = client.ask(Write(tuple(lines)))
    assert isinstance(event, Written), event
    assert event.error in (None, FULL), (event, lines[event.line - 1])
    return len(lines) if event.error is None else event.line - 1


def stream(client, lines):
    """Stream lines: fill the buffer, send R, and refill it when there is room; the rotary stays open."""
    at, running = 0, False
    while at < len(lines):
        wanted = fitting(lines, at)
        taken = write(client, lines[at : at + wanted])
        at += taken
        if taken == wanted:
            continue
        if not running:
            assert client.ask(Ask("R")).error is None
            running = True
        until = time.monotonic() + 3.0
        while numbers(client, "PR")[0] > 65:
            assert time.monotonic() < until, "the rotary stands still (held by the guard?)"
            time.sleep(0.005)
    if not running:
        assert client.ask(Ask("R")).error is None


def when_it_stands(client, motors):
    """Wait until all lines are calculated and no motor moves; with a rotary, "running" never ends."""
    for _ in range(5000):
        word = int(client.ask(Ask("&1??")).items[0][:6], 16)
        still = [int(client.ask(Ask(f"#{n}?")).items[0][:6], 16) >> 13 & 1 for n in motors]
        if all(still) and (not word & 1 or numbers(client, "PR")[0] == 0):
            return
        time.sleep(0.005)
    raise AssertionError("the program doesn't end")


def over_tcp(name, target, rate):
    """Execute an example that was sent over TCP.

    Return the machine and the positions that it reported: P1 to P6, and the motors' commanded and actual
    positions in counts.
    """
    robot, machine = robot_machine(name)
    lines = lines_of(example(name, target).text)
    motors = robot.controller.motors
    with served(machine, rate=rate) as port, Client(port, timeout=20.0) as client:
        assert client.ask(Ask("I6=1 I3=2")).error is None
        if target == "rotary":
            stream(client, lines)
        else:
            at = 0
            while at < len(lines):
                wanted = fitting(lines, at)
                assert write(client, lines[at : at + wanted]) == wanted
                at += wanted
            assert client.ask(Ask("&1B1R")).error is None
        when_it_stands(client, motors)
        scale = numbers(client, "".join(f"I{n}08" for n in motors)) * 32.0
        joints = numbers(client, "".join(robot.controller.feedback))
        commanded = numbers(client, "".join(f"M{n}61" for n in motors)) / scale
        actual = numbers(client, "".join(f"M{n}62" for n in motors)) / scale
    return robot, machine, joints, commanded, actual


@BOTH
@pytest.mark.parametrize(("target", "rate"), [("prog", None), ("rotary", 5.0)])
def test_examples_through_tcp_end_where_the_plan_ends(name, target, rate):
    robot, machine, joints, commanded, actual = over_tcp(name, target, rate)
    compiled = example(name, target)
    end = compiled.plan.sample(np.array([compiled.plan.duration]))[0][0]
    counts = to_counts(robot, end)
    assert np.abs(commanded - counts).max() < 1.0
    assert np.abs(actual - counts).max() < 1.0
    a_count = np.abs(from_counts(robot, counts + 1.0) - from_counts(robot, counts)).max()
    assert np.abs(joints * robot.axis_units - end).max() < a_count
    # the examples end where they begin, so the path is compared as well
    begun, times = clock(machine, compiled)
    planned = to_counts(robot, compiled.plan.sample(times)[0])
    assert np.ptp(planned, axis=0).max() > 100_000
    assert np.abs(machine.positions(begun + times) - planned).max() < 1.0


def clock(machine, compiled, count=400):
    """Return the time at which the programmed motions began in a machine's record, and later instants."""
    times = [time for times in machine.record._times.values() for time in times]
    duration = compiled.certificate.duration
    return max(times) - duration, np.linspace(0.0, duration - 1e-9, count)


# the trace and the certificate


@cache
def executed(name, target):
    """Return the robot, the compiled example, and the joint positions of each executed command (N, n)."""
    robot, machine = robot_machine(name)
    compiled = example(name, target)
    if target == "prog":
        say(machine, *lines_of(compiled.text), "&1B1R")
        machine.advance(compiled.certificate.duration + 2.0)
    else:
        feed(machine, lines_of(compiled.text))
        machine.advance(6.0)
    begun, _ = clock(machine, compiled)
    traces, at = [], begun
    for command in compiled.certificate.commands:
        count = round(command.duration / STEP)
        times = at + np.arange(count + 1) * (command.duration / count)
        counts = machine.positions(np.minimum(times, machine.now), robot.controller.motors)
        traces.append((command, command.duration / count, counts))
        at += command.duration
    return robot, compiled, traces


@BOTH
@TARGETS
def test_the_trace_agrees_with_the_certificate(name, target):
    """Differences of positions are means of velocity and acceleration, so they never exceed a true bound."""
    robot, _, traces = executed(name, target)
    limits = robot.limits
    for command, step, counts in traces:
        q = from_counts(robot, counts)
        seen = {
            "velocity": np.abs(np.diff(q, axis=0) / step / limits.velocity).max(),
            "acceleration": np.abs(np.diff(q, 2, axis=0) / step**2 / limits.acceleration).max(),
            "motor_velocity": np.abs(np.diff(counts, axis=0) / step / robot.actuation.velocity).max(),
        }
        for kind, share in seen.items():
            proved = getattr(command, kind).share
            assert 0.95 * proved <= share <= proved * (1 + 1e-6), (command.index, kind, share, proved)


class Trace:
    """Joint positions in the form that `independent.off_line` expects."""

    def __init__(self, q):
        self.q = np.degrees(q)

    def sample(self, order=0, per_segment=8):
        assert order == 0
        del per_segment
        return self.q


def goal_of(index, point, rotation):
    """Return the goal of a line in examples/03, computed here: position [mm] and orientation of the tool."""
    match index:
        case "P0040":
            return point - np.array([0, 0, 80]), rotation
        case "P0050":
            return point + rotation.apply([40, 0, 0]), rotation * Rotation.from_euler("xyz", [0, 20, 0], True)
        case "P0060":
            return np.array([0, 950, 600]), Rotation.from_euler("xyz", [-90, 0, 0], True)


@TARGETS
def test_the_tool_stays_as_near_to_its_line_as_the_certificate_proves(target):
    robot, _, traces = executed("TRACKED_MANIPULATOR", target)
    arm = Arm.in_folder(robot.folder)
    lines = [(command, counts) for command, _, counts in traces if command.kind == "line"]
    assert [command.index for command, _ in lines] == ["P0040", "P0050", "P0060"]
    points, rotations = arm.poses(np.degrees(robot.home[None]))
    goal = points[0], rotations[0]
    for command, counts in lines:
        goal = goal_of(command.index, *goal)  # each line begins at the goal of the motion before
        distance, angle = off_line(arm, Trace(from_counts(robot, counts)), *goal)
        # The distance is that from the line that begins at the executed start, which may be off, too.
        assert distance <= 2.0 * command.deviation.position * 1e3 + 1e-5, (command.index, distance)
        assert angle <= 2.0 * np.degrees(command.deviation.angle) + 1e-6, (command.index, angle)


# accepted and refused texts


@BOTH
@TARGETS
def test_all_that_yarclang_writes_is_accepted(name, target):
    robot, machine = robot_machine(name, record=False)
    for line in settings_text(robot).splitlines():
        assert error(machine, line) is None, line
    if target == "prog":
        for line in example(name, target).text.splitlines():
            assert error(machine, line) is None, line
    else:
        assert feed(machine, lines_of(example(name, target).text)) == len(
            lines_of(example(name, target).text)
        )
    assert not machine.unknown_words


def test_a_bare_machine_refuses_a_program_until_it_is_set_up(industrial6):
    machine = Machine()
    lines = lines_of(example("INDUSTRIAL6", "prog").text)
    say(machine, "$$$***", "I3=2I6=1", "&1")
    assert error(machine, "B1R") == 14
    say(machine, *lines, "B1")
    assert error(machine, "R") == 14
    refused = [line for line in settings_text(industrial6).splitlines() if error(machine, line) is not None]
    assert refused == []
    assert error(machine, "&1B1R") == 13
    say(machine, *(f"I{motor}00=1" for motor in industrial6.controller.motors))
    assert error(machine, "R") == 12
    say(machine, "A", "B1R")
    machine.advance(1.0)
    assert machine.systems[1].running


# memory


def size(root):
    """Return the bytes of all objects that can be reached from an object, except code and types."""
    seen, total, todo = {id(root)}, 0, [root]
    while todo:
        one = todo.pop()
        total += sys.getsizeof(one)
        for each in gc.get_referents(one):
            if id(each) not in seen and not isinstance(
                each, type | ModuleType | FunctionType | BuiltinFunctionType
            ):
                seen.add(id(each))
                todo.append(each)
    return total


def after_ten_minutes_and_an_hour(machine, work):
    """Return the sizes of a machine after 10 and 60 minutes of its time, which `work` lets pass."""
    sizes = []
    for minutes in (10, 60):
        while machine.now < minutes * 60.0:
            work()
        sizes.append(size(machine))
    return sizes


def test_an_hour_of_a_program_that_is_run_again_and_again():
    _, machine = robot_machine("TRACKED_MANIPULATOR", record=False)
    compiled = example("TRACKED_MANIPULATOR", "prog")
    say(machine, *lines_of(compiled.text), "I5=1", "&1")
    runs = 0

    def again():
        nonlocal runs
        runs += 1
        say(machine, "B1R")
        machine.advance(compiled.certificate.duration + 0.5)
        assert not machine.systems[1].running
        machine.messages()

    ten, sixty = after_ten_minutes_and_an_hour(machine, again)
    assert runs > 240
    assert sixty < 1.01 * ten, (ten, sixty)


def test_an_hour_of_a_rotary_that_is_refilled():
    machine = bare("1000X", "1000Y", "500A", record=False)
    say(machine, "B0", "OPEN ROT", "SPLINE1 TM250", "X0Y0A0", "R")
    lines = 0

    def refill():
        nonlocal lines
        while int(say(machine, "PR")[0]) < 60:
            lines += 1
            say(machine, f"X{lines % 17}Y{lines % 5}A{lines % 11}.25")
        machine.advance(5.0)

    ten, sixty = after_ten_minutes_and_an_hour(machine, refill)
    assert lines > 3600 * 4
    assert sixty < 1.01 * ten, (ten, sixty)
