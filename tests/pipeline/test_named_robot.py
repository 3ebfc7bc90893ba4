"""A robot that is called by its name is found beside a yarc.toml, too."""

import re

import pytest

import yarclang
from yarclang.pipeline.controller_text import robot_of_text
from yarclang.pipeline.inputs import named_robot, robot_for, robot_made_for
from yarclang.robot.library import stdlib_folder
from yarclang.source import SourceFile


@pytest.fixture
def project(tmp_path):
    """A project whose robot has its folder beside it, and the name MINE."""
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
