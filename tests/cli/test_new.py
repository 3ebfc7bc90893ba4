"""`yarc new`: the new folder compiles, and its settings for editors and CI are right."""

import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from click.testing import CliRunner

from yarclang.cell.description import Names, load_cell
from yarclang.cli.yarc import main
from yarclang.cli.yarcc import main as yarcc
from yarclang.robot.description import load_robot


@pytest.fixture(autouse=True)
def in_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def new(*arguments):
    return CliRunner().invoke(main, ["new", *arguments])


@pytest.mark.parametrize("robot", ["INDUSTRIAL6", "tracked_manipulator"])
def test_it_compiles_at_once_without_flags(tmp_path, monkeypatch, robot):
    made = new("my-cell", "--robot", robot)
    assert (made.exit_code, made.stderr) == (0, "")
    monkeypatch.chdir(tmp_path / "my-cell")
    compiled = CliRunner().invoke(yarcc, ["my-cell.yarc"])
    assert (compiled.exit_code, compiled.stderr) == (0, "")
    assert Path("my-cell.pmc").read_text().startswith("; yarcc ")
    assert tomllib.loads(Path("yarc.toml").read_text()) == {"robot": robot.upper(), "cell": "cell.toml"}
    tomllib.loads(Path("cell.toml").read_text())


@pytest.mark.parametrize("robot", ["INDUSTRIAL6", "TRACKED_MANIPULATOR"])
def test_the_cell_can_be_read(tmp_path, robot):
    new("demo", "--robot", robot)
    names = Names(lambda _: False, load_robot(robot).value)
    cell = load_cell(tmp_path / "demo" / "cell.toml", names)
    assert cell.diagnostics == ()
    assert "TABLE" in cell.value.frames
    program = tmp_path / "demo" / "demo.yarc"
    program.write_text(program.read_text().replace("P0030 STOP", "P0030 MOVEL 0 0 0 0 0 0 {TABLE} [9]"))
    found = CliRunner().invoke(main, ["check", str(program)]).stderr
    assert "Y0210" not in found  # the frame TABLE is known, whatever other findings there are


def test_no_mark_of_the_template_is_left(tmp_path):
    assert new("demo", "--robot", "INDUSTRIAL6").exit_code == 0
    files = sorted(path for path in (tmp_path / "demo").rglob("*") if path.is_file())
    assert [path for path in files if "@" in path.read_text()] == []
    assert [path.relative_to(tmp_path / "demo").as_posix() for path in files] == [
        ".editorconfig",
        ".gitignore",
        ".vscode/settings.json",
        ".vscode/tasks.json",
        "README.md",
        "cell.toml",
        "check.sh",
        "demo.yarc",
        "yarc.toml",
    ]


def test_the_check_script_sees_a_mistake(tmp_path):
    new("demo", "--robot", "INDUSTRIAL6")
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])

    def check():
        script = tmp_path / "demo" / "check.sh"
        return subprocess.run(
            [script], env={**os.environ, "PATH": path}, capture_output=True, text=True, check=False
        )

    assert check().returncode == 0
    program = tmp_path / "demo" / "demo.yarc"
    program.write_text(program.read_text().replace("HOME", "HOM"))
    assert check().returncode == 1


def test_the_editors_task_finds_the_places_of_findings(tmp_path, monkeypatch):
    new("demo", "--robot", "INDUSTRIAL6")
    monkeypatch.chdir(tmp_path / "demo")
    json.loads(Path(".vscode/settings.json").read_text())
    (task,) = json.loads(Path(".vscode/tasks.json").read_text())["tasks"]
    pattern = task["problemMatcher"]["pattern"]
    Path("demo.yarc").write_text("DEFAULT (deg,s)\nP0010 MOVEJ HOM [5]\n")
    assert task["command"] == "yarc"
    arguments = [word.replace("${relativeFile}", "demo.yarc") for word in task["args"]]
    output = CliRunner().invoke(main, arguments).output
    (found,) = [match for line in output.splitlines() if (match := re.search(pattern["regexp"], line))]
    assert [found[pattern[key]] for key in ("file", "line", "severity", "code")] == [
        "demo.yarc",
        "2",
        "error",
        "Y0205",
    ]
    assert int(found[pattern["column"]]) == 13


def test_a_robot_of_ones_own_is_named_by_its_path(tmp_path, monkeypatch, industrial6):
    (tmp_path / "robots").mkdir()
    for file in industrial6.folder.iterdir():
        (tmp_path / "robots" / file.name).write_bytes(file.read_bytes())
    assert new("demo", "--robot", "robots/robot.toml").exit_code == 0
    written = tomllib.loads((tmp_path / "demo" / "yarc.toml").read_text())
    assert written == {"robot": "../robots/robot.toml", "cell": "cell.toml"}
    monkeypatch.chdir(tmp_path / "demo")
    assert CliRunner().invoke(main, ["check", "demo.yarc"]).exit_code == 0


@pytest.mark.parametrize(
    "name", ["", ".", "..", "2nd", "a/b", "/tmp", "a b", "ü", "-", "con.", "x" * 61, "pallet"]
)
def test_names_that_cannot_be_used(tmp_path, name):
    made = new("--robot", "INDUSTRIAL6", "--", name)
    assert (made.exit_code, "Y1522" in made.stderr) == (1, True)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_with_something_in_it_is_left_alone(tmp_path):
    (tmp_path / "demo").mkdir()
    assert new("demo", "--robot", "INDUSTRIAL6").exit_code == 0
    before = sorted((tmp_path / "demo").rglob("*"))
    (tmp_path / "demo" / "demo.yarc").write_text("mine")
    refused = new("demo", "--robot", "INDUSTRIAL6")
    assert (refused.exit_code, "Y1521" in refused.stderr) == (1, True)
    assert sorted((tmp_path / "demo").rglob("*")) == before
    assert (tmp_path / "demo" / "demo.yarc").read_text() == "mine"
    (tmp_path / "file").write_text("mine")
    assert "isn't a folder" in new("file", "--robot", "INDUSTRIAL6").stderr


def test_an_unknown_robot_and_none(tmp_path):
    made = new("demo", "--robot", "INDUSTRIEL6")
    assert (made.exit_code, "Did you mean INDUSTRIAL6?" in made.stderr) == (1, True)
    made = new("demo")
    assert (made.exit_code, "Y1391" in made.stderr) == (1, True)
    assert list(tmp_path.iterdir()) == []


def test_it_may_begin_with_a_template(tmp_path):
    made = new("line", "--robot", "INDUSTRIAL6", "--template", "tend")
    assert made.exit_code == 0
    assert "WAIT DONE ON" in (tmp_path / "line" / "line.yarc").read_text(encoding="utf-8")
    checked = CliRunner().invoke(main, ["check", "line/line.yarc"])
    assert "no problems found" in checked.output + checked.stderr
    refused = new("other", "--robot", "INDUSTRIAL6", "--template", "../weld")
    assert refused.exit_code == 2
    assert "there are pick-place, pallet, weld, glue, tend, empty" in refused.output
    assert not (tmp_path / "other").exists()
