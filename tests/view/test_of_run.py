"""Tests of stages of runs and of controller texts."""

from dataclasses import replace

import numpy as np
import pytest
from report.runs.made_up_runs import made, whole
from view.stages import EXAMPLES

import yarclang
from yarclang.diagnostics import Result
from yarclang.pipeline.inputs import Options
from yarclang.report.runs.kind import is_log
from yarclang.robot.description import load_robot
from yarclang.view import of_run
from yarclang.view.of_run import stage_of_run
from yarclang.view.of_text import stage_of_text
from yarclang.view.opening import opened
from yarclang.view.show import ramps_of, values_of


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    return whole(tmp_path_factory.mktemp("log") / "a.mcap", *made())


def test_the_run_stands_beside_its_plan(log):
    path, truth = log
    stage = stage_of_run(str(path), None).value
    assert stage.ghost is not None
    assert stage.ghost_way is not None
    assert set(ramps_of(stage)) == {"speed", "deviation", "clearance"}
    # the samples of this log were made from the plan itself
    assert values_of(stage, "deviation").max() < 1.0
    assert [piece.label for piece in stage.pieces] == ["P0010", "P0020", "P0030"]
    assert [piece.ends - piece.begins for piece in stage.pieces] == pytest.approx([3.0, 4.0, 2.0], abs=0.1)
    times = np.array([stage.pieces[1].ends])
    assert stage.track.at(times)[0][0] == pytest.approx(np.zeros(6), abs=2e-3)
    assert stage.ghost.at(times)[0][0] == pytest.approx(np.zeros(6), abs=2e-3)
    # a note says that the cell is missing, because the program isn't beside the log
    assert any("cell" in note for note in stage.notes)
    assert truth.commanded.shape[1] == 6


def test_a_robot_with_other_joints_is_refused(log):
    result = stage_of_run(str(log[0]), "TRACKED_MANIPULATOR")
    assert result.value is None
    assert [one.code for one in result.diagnostics] == ["Y1406"]


def test_a_log_without_positions(log, monkeypatch):
    read = of_run.read_run(str(log[0])).value
    bare = replace(read, times=read.times[:0], actual=read.actual[:0])
    monkeypatch.setattr(of_run, "read_run", lambda _: Result(bare))
    result = stage_of_run(str(log[0]), None)
    assert result.value is None
    assert [one.code for one in result.diagnostics] == ["Y1405"]


def test_what_is_a_log(log, tmp_path):
    other = tmp_path / "log.bin"
    other.write_bytes(log[0].read_bytes())
    assert is_log(str(other))
    assert is_log("missing.mcap")
    assert not is_log(str(EXAMPLES / "01_listing4.yarc"))
    assert not is_log("-")
    assert opened(str(other), Options(), None).value is not None


def test_a_controller_text_does_what_its_program_does(tmp_path):
    text = (EXAMPLES / "09_fixture_cell.yarc").read_text()
    robot = None if "\nROBOT" in text else "INDUSTRIAL6"
    compiled = yarclang.compile(text, robot=robot, name="09_fixture_cell.yarc", folder=EXAMPLES).value
    assert compiled is not None
    arm = load_robot("INDUSTRIAL6").value
    path = tmp_path / "a.pmc"
    path.write_text(compiled.text)
    asked = []
    made_of = opened(str(path), Options(), lambda source, name: asked.append(name) or Result(arm))
    assert asked == [None]
    assert made_of.value is not None
    stage = made_of.value
    assert stage.duration == pytest.approx(compiled.plan.duration, abs=1e-6)
    times = np.linspace(0.0, stage.duration, 200)
    assert stage.track.at(times)[0] == pytest.approx(compiled.plan.sample(times)[0], abs=1e-6)
    assert any("cell" in note for note in stage.notes)
    # a text in the folder of its program gets the program's cell
    source = replace(made_of_source(path), name="09.pmc")
    beside = stage_of_text(source, EXAMPLES, arm).value
    assert {item.name for item in beside.items} >= {"BENCH", "FINGERS"}
    assert beside.frame == "GRIPPER"


def made_of_source(path):
    from yarclang.pipeline.sources import read_source

    return read_source(str(path)).value
