"""Tests of a robot that is referred to by its name in a project with a yarc.toml."""

import re
import shutil

import pytest

import yarclang
from yarclang.pipeline.controller_text import check_controller_text, robot_of_text
from yarclang.pipeline.inputs import Options, named_robot, open_program, robot_for, robot_made_for
from yarclang.pipeline.stages import compile_module
from yarclang.robot.description import load_robot
from yarclang.robot.library import stdlib_folder
from yarclang.source import SourceFile


@pytest.fixture
def project(tmp_path):
    """Return a project whose robot MINE has a folder beside it."""
    (tmp_path / "arm").mkdir()
    for file in (stdlib_folder() / "robots" / "industrial6").iterdir():
        text = re.sub(r'^name = "INDUSTRIAL6"', 'name = "MINE"', file.read_text(), flags=re.MULTILINE)
        (tmp_path / "arm" / file.name).write_text(text)
    folder = tmp_path / "cell"
    (folder / "yarc-runs").mkdir(parents=True)
    (folder / "yarc.toml").write_text('robot = "../arm/robot.toml"\n')
    return folder


def test_a_name_is_that_of_the_library_a_path_or_that_of_yarc_toml(project):
    for find in (named_robot, robot_for):
        assert find(project, "MINE").value.name == "MINE"
        assert find(project / "yarc-runs", "mine").value.name == "MINE"
        assert find(project, "INDUSTRIAL6").value.name == "INDUSTRIAL6"
        assert find(project, str(project.parent / "arm")).value.name == "MINE"
        assert [one.code for one in find(project, "OTHER").diagnostics] == ["Y1301"]
    assert [one.code for one in named_robot(project.parent, "MINE").diagnostics] == ["Y1301"]


def test_what_a_text_was_made_for_is_looked_for_in_its_project_first(project):
    assert robot_made_for(project, "MINE").value.name == "MINE"
    assert robot_made_for(project, "INDUSTRIAL6").value.folder == stdlib_folder() / "robots" / "industrial6"
    arm = project.parent / "arm" / "robot.toml"
    arm.write_text(arm.read_text().replace('"MINE"', '"INDUSTRIAL6"'))
    assert robot_made_for(project, "INDUSTRIAL6").value.folder.resolve() == project.parent / "arm"


def test_a_controller_text_finds_the_robot_of_its_project(project):
    made = yarclang.compile(
        "P0010 MOVEJ 0 0 0 0 -30 0 [5] (deg,s)\n", robot=str(project.parent / "arm"), folder=project
    )
    text = SourceFile(str(project / "p.pmc"), made.value.text)
    assert robot_of_text(text, None).value.name == "MINE"
    elsewhere = SourceFile(str(project.parent / "p.pmc"), made.value.text)
    assert [one.code for one in robot_of_text(elsewhere, None).diagnostics] == ["Y1301"]


def test_the_file_of_a_robot_may_have_any_name(tmp_path):
    """A folder has two robots. A text for the one in left.robot.toml is proved with this robot's file."""
    shutil.copytree(stdlib_folder() / "robots" / "industrial6", tmp_path, dirs_exist_ok=True)
    description = (tmp_path / "robot.toml").read_text()
    left = tmp_path / "left.robot.toml"
    left.write_text(description.replace('"INDUSTRIAL6"', '"LEFT"', 1))
    (tmp_path / "robot.toml").write_text("not this one")
    (tmp_path / "job.yarc").write_text('ROBOT "left.robot.toml"\nP0010 MOVEJ 0 0 0 0 30 0 [2] (deg,s)\n')
    assert load_robot(str(left)).value.file == left
    opened = open_program(str(tmp_path / "job.yarc"), Options())
    compiled = compile_module(opened.value.module, opened.value.request)
    (tmp_path / "job.pmc").write_text(compiled.value.text)
    assert check_controller_text(str(tmp_path / "job.pmc"), Options(robot=str(left))) == ()
