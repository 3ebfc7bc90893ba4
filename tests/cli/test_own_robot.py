"""Every command finds a robot of yarc.toml by its name."""

import shutil

import pytest
from click.testing import CliRunner

from yarclang.cli.yarc import main
from yarclang.robot.library import list_robots


@pytest.fixture
def project(tmp_path, monkeypatch):
    folder = next(one.folder for one in list_robots() if one.name == "INDUSTRIAL6")
    shutil.copytree(folder, tmp_path / "arm")
    path = tmp_path / "arm" / "robot.toml"
    path.write_text(path.read_text().replace('name = "INDUSTRIAL6"', 'name = "BENCHARM"', 1))
    (tmp_path / "yarc.toml").write_text('robot = "arm/robot.toml"\n')
    (tmp_path / "a.yarc").write_text("P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    return tmp_path


NOBODY = ("--to", "tcp://127.0.0.1:1")


@pytest.mark.parametrize(
    ("arguments", "status", "said"),
    [
        (("settings",), 0, "ENABLE PLC"),
        (("doctor", "--robot"), 0, "BENCHARM is commanded to"),
        (("status", *NOBODY, "--robot"), 1, "can't be reached"),
        (("stop", *NOBODY, "--robot"), 1, "can't be reached"),
        (("check", "a.yarc", "--robot"), 0, "no problems found"),
    ],
)
def test_the_robot_of_the_project_has_a_name(project, arguments, status, said):
    done = CliRunner().invoke(main, [*arguments, "bencharm"])
    assert said in done.output
    assert done.exit_code == status
    wrong = CliRunner().invoke(main, [*arguments, "BENCHARN"])
    assert "Y1301" in wrong.output
    assert wrong.exit_code == 1
    (project / "yarc.toml").write_text('robot = "INDUSTRIAL6"\n')
    assert "Y1301" in CliRunner().invoke(main, [*arguments, "BENCHARM"]).output


def test_the_folder_of_a_robot_is_proposed_for_its_name(project):
    (project / "arm").rename(project / "bencharm")
    (project / "yarc.toml").unlink()
    wrong = CliRunner().invoke(main, ["check", "a.yarc", "--robot", "BENCHARM"])
    assert "Did you mean ./bencharm?" in wrong.output
    right = CliRunner().invoke(main, ["check", "a.yarc", "--robot", "./bencharm"])
    assert right.exit_code == 0, right.output


def test_a_urdf_is_no_robot_folder():
    wrong = CliRunner().invoke(main, ["robot", "check", "arm.urdf"])
    assert wrong.exit_code == 2
    assert "yarc robot new" in wrong.output
