"""Random tests of the runtime's check that the robot follows its streamed lines: correct programs cause no
alarm.

Usually 24 programs are run; with YARCLANG_RANDOM_RUNS=1000 in the environment, that many.
"""

import os

import numpy as np
import pytest
from floors import Tally
from programs import robot_of
from runtime.virtual import World

from yarclang.backend_pmac.settings import settings_text
from yarclang.campaign.drawing import drawn
from yarclang.independent.arm import Arm
from yarclang.pipeline.jobs import job_of_compiled
from yarclang.pipeline.settings import items_of
from yarclang.pipeline.stages import Request, compile_module
from yarclang.runtime.notices import Override
from yarclang.runtime.pmac.course import Course
from yarclang.runtime.pmac.performance import connect, look, perform
from yarclang.runtime.sample import Sample
from yarclang.simulator.commissioning import commissioned, stand
from yarclang.source import SourceFile
from yarclang.syntax.parse import parse

COUNT = int(os.environ.get("YARCLANG_RANDOM_RUNS", "24"))
ROBOTS = ("INDUSTRIAL6", "TRACKED_MANIPULATOR")


@pytest.mark.parametrize("name", ROBOTS)
def test_random_programs_run_without_an_alarm(name):
    """Programs with joint motions, lines, arcs, splines, all motion laws, BLENDs and outputs run without an
    alarm: with any segment time, over links with any delay, at any override.
    """
    robot = robot_of(name)
    arm = Arm.in_folder(robot.folder)
    tally = Tally()
    for seed in range(COUNT // len(ROBOTS)):
        random = np.random.default_rng([17, seed])
        program = drawn(arm, random, most=4)
        request = Request(robot, tm=float(random.choice([4.0, 5.0, 10.0, 20.0, 50.0])))
        module = parse(SourceFile("drawn.yarc", program.text)).value
        made = None if module is None else compile_module(module, request).value
        tally.count("runs", made is not None)
        if made is None:
            continue
        job = job_of_compiled(made, "drawn")
        machine = commissioned(robot, settings_text(robot))
        stand(machine, robot, job.start)
        world = World(machine, delay=float(random.choice([0.0005, 0.005, 0.02])), seed=seed)
        world.perform(connect(world.operation))
        for line in ("M11->*", "M11=1"):  # Variables that programs watch.
            world.say(line)
        assert not world.perform(look(world.operation, robot, items_of(robot))).errors
        for after in random.uniform(0.0, job.duration, 2):
            world.order(Override(float(random.choice([20.0, 60.0, 100.0]))), after)
        ended = world.perform(perform(world.operation, job), within=60.0 + 8.0 * job.duration)
        assert ended.well, f"seed {seed}: {ended.what}\n{program.text}"
    assert not tally.below({"runs": 0.3})


def off(course, place, executed=(0, 10)):
    counts = np.asarray(place, dtype=float)
    return course.off(Sample(0.0, 0.0, counts, np.zeros_like(counts)), executed, 0.0)


@pytest.fixture
def course(industrial6):
    """Fixture: the course of a motion along J1, one degree for each line."""
    found = Course(industrial6, np.zeros(6), np.full(6, 1e-9), 0.05)
    found.append(
        ["RAPID", "SPLINE1", "TM50", *(f"X{n}Y0Z0A0B0C0" for n in range(1, 40)), "P8100=P8100&2", "DWELL0"]
    )
    return found


COUNTS = 25532.8278
"""Counts of motor 1 for one degree."""


@pytest.mark.parametrize("at", [0.0, 0.5, 3.3, 6.0])
def test_a_place_on_the_way_is_no_alarm(course, at):
    assert off(course, [at * COUNTS, 0, 0, 0, 0, 0]) == (0.0, 0)


def test_a_place_beside_the_way_is_one(course):
    counts, row = off(course, [3.0 * COUNTS, 0, 0, 1000, 0, 0])
    assert row == 3
    assert counts == pytest.approx(1000.0)


def test_a_place_too_far_ahead_or_behind_is_one(course):
    assert off(course, [30.0 * COUNTS, 0, 0, 0, 0, 0])[0] > COUNTS
    assert off(course, [2.0 * COUNTS, 0, 0, 0, 0, 0], (25, 30))[0] > COUNTS


def test_what_is_forgotten_is_far_behind(industrial6):
    found = Course(industrial6, np.zeros(6), np.full(6, 1e-9), 0.05)
    for first in range(0, 4000, 50):
        found.append([f"X{n / 100:.2f}Y0Z0A0B0C0" for n in range(first, first + 50)])
        found.forget(first)
    assert len(found._points) < 2000
    assert off(found, [39.0 * COUNTS, 0, 0, 0, 0, 0], (3895, 3905)) == (0.0, 0)
