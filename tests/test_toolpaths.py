"""Tests of tool paths of short pieces, drawn by the benchmark: they are certified and fast, and the simulator
executes them to within a count.
"""

import sys
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from programs import compiled, robot_of

from tests.runtime.virtual import World
from yarclang.backend_pmac.settings import settings_text
from yarclang.pipeline.jobs import job_of_compiled
from yarclang.robot.actuation import to_counts
from yarclang.runtime.pmac.performance import connect, perform
from yarclang.simulator.commissioning import commissioned, stand

MOST_BYTES = 9_000
"""Most memory that the compilation may take for a line of a long chain [bytes]."""

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"


@pytest.fixture
def toolpaths(monkeypatch):
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    yield __import__("toolpaths")
    for name in ("toolpaths", "measure"):
        sys.modules.pop(name, None)


@pytest.mark.parametrize(
    ("path", "name"),
    [
        ("weld", "INDUSTRIAL6"),
        ("bead", "TRACKED_MANIPULATOR"),
        ("pocket", "INDUSTRIAL6"),
        ("spiral", "TRACKED_MANIPULATOR"),
    ],
)
def test_a_tool_path_runs_to_its_end(toolpaths, path, name):
    text = toolpaths.text(name, path, 120, turning=False)
    made, found = compiled(text, name)
    assert made is not None, [(one.code, one.message) for one in found if one.is_error]
    assert all(motion.flows for motion in made.plan.motions[1:-1])
    robot, job = robot_of(name), job_of_compiled(made, f"{path}.yarc")
    machine = commissioned(robot, settings_text(robot))
    stand(machine, robot, job.start)
    world = World(machine)
    world.perform(connect(world.operation))
    ended = world.perform(perform(world.operation, job))
    assert ended.well, ended.what
    counts = machine.positions(motors=robot.controller.motors)
    assert np.abs(counts - to_counts(robot, ended.joints)).max() < 1.0
    assert ended.joints == pytest.approx(made.plan.motions[-1].curve.points[-1], abs=1e-6)


def test_a_line_of_a_long_chain_takes_little_room(toolpaths):
    peaks = []
    for count in (1_200, 2_400):
        text = toolpaths.text("INDUSTRIAL6", "weld", count, turning=False)
        tracemalloc.start()
        made, found = compiled(text, "INDUSTRIAL6")
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
        assert made is not None, [(one.code, one.message) for one in found if one.is_error]
    assert (peaks[1] - peaks[0]) / 1_200 < MOST_BYTES
