"""`yarc check cell.toml`: cells and robots are checked alone, with the same formats and exit statuses."""

import json

import pytest
from click.testing import CliRunner
from conftest import EXAMPLES

from yarclang.cli.yarc import main
from yarclang.robot.library import stdlib_folder

CELL = str(EXAMPLES / "cell.toml")


def yarc(*arguments):
    return CliRunner().invoke(main, ["check", *arguments])


@pytest.mark.parametrize("robot", [(), ("--robot", "INDUSTRIAL6"), ("--robot", "TRACKED_MANIPULATOR")])
def test_a_sound_cell(robot):
    done = yarc(CELL, *robot)
    assert (done.exit_code, done.output) == (0, "1 file checked, no problems found\n")


def test_a_cell_with_mistakes(tmp_path):
    path = tmp_path / "bench.toml"
    path.write_text((EXAMPLES / "cell.toml").read_text().replace('"B"', '"BASE"', 1))
    done = yarc(str(path))
    assert done.exit_code == 1
    assert f"{path}:15:10: error Y1329: parent of [frames.FIXTURE] is BASE" in done.output
    assert done.output.endswith("1 file checked: 1 error\n")
    done = yarc(str(path), "--format", "json")
    (found,) = json.loads(done.output)["diagnostics"]
    assert (found["code"], found["line"], found["column"], found["file"]) == ("Y1329", 15, 10, str(path))


def test_a_robot_beside_a_program_and_a_cell(tmp_path):
    robot = str(stdlib_folder() / "robots" / "industrial6" / "robot.toml")
    done = yarc(robot, CELL, str(EXAMPLES / "09_fixture_cell.yarc"), "--robot", "INDUSTRIAL6")
    assert done.exit_code == 0
    assert done.output.endswith("3 files checked, no problems found\n")
    (tmp_path / "robot.toml").write_text("name = 5\n")
    assert yarc(str(tmp_path / "robot.toml")).exit_code == 1


def test_a_cell_that_is_not_there(tmp_path):
    done = yarc(str(tmp_path / "cell.toml"))
    assert done.exit_code == 1
    assert "error Y1302" in done.output
    assert "Traceback" not in done.output
