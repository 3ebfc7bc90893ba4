"""Tests of reusing results in the commands `yarc check` and `yarcc`, as long as no input has changed."""

import shutil
import sqlite3
from pathlib import Path

import pytest
from click.testing import CliRunner

from yarclang.cli.yarc import main as yarc
from yarclang.cli.yarcc import main as yarcc

PROGRAM = (
    "USE TOOLS\n"
    'CELL "cell.toml"\n'
    "DEFAULT (deg,s)\n"
    "P0010 MOVEJ 10 0 0 0 0 0 [MIN]\n"
    "P0020 MOVEJ 20 0 0 0 0 0 [MIN]\n"
)


@pytest.fixture
def project(tmp_path, monkeypatch):
    monkeypatch.setenv("YARCLANG_CACHE", str(tmp_path / "cache" / "yarclang"))
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.delenv("YARCLANG_NO_CACHE")
    folder = tmp_path / "project"
    folder.mkdir()
    shutil.copytree("stdlib/robots/industrial6", folder / "ours")
    (folder / "yarc.toml").write_text('robot = "ours"\n')
    (folder / "cell.toml").write_text(
        'units = "mm,deg"\n'
        "[[obstacles]]\n"
        'name = "FLOOR"\n'
        'shape = "box"\n'
        "size = [10, 10, 10]\n"
        'frame = "B"\n'
        "xyz = [3000, 0, 0]\n"
    )
    (folder / "tools.yarc").write_text("LET X = 1\n")
    (folder / "way.yarc").write_text(PROGRAM)
    monkeypatch.chdir(folder)
    return folder


def run(command, *arguments):
    return CliRunner().invoke(command, arguments)


def reused(result):
    return "as before" in result.stderr


def test_the_second_time_is_as_the_first(project):
    first = run(yarcc, "way.yarc", "--certificate", "a.json")
    text, certificate = Path("way.pmc").read_bytes(), Path("a.json").read_bytes()
    Path("way.pmc").unlink()
    second = run(yarcc, "way.yarc", "--certificate", "a.json")
    assert first.exit_code == second.exit_code == 0, first.output
    assert not reused(first)
    assert reused(second)
    assert first.stdout == second.stdout
    assert Path("way.pmc").read_bytes() == text
    assert Path("a.json").read_bytes() == certificate


@pytest.mark.parametrize("file", ["way.yarc", "tools.yarc", "cell.toml", "yarc.toml", "ours/robot.toml"])
def test_a_change_of_any_file_is_seen(project, file):
    run(yarcc, "way.yarc")
    assert reused(run(yarcc, "way.yarc"))
    before = Path(file).read_text()
    Path(file).write_text(before + ("\n! changed\n" if file.endswith(".yarc") else "\n# changed\n"))
    assert not reused(run(yarcc, "way.yarc"))
    Path(file).write_text(before)
    assert reused(run(yarcc, "way.yarc"))


def test_a_change_of_a_urdf_and_a_new_file_are_seen(project):
    run(yarc, "check", "way.yarc")
    (urdf,) = Path("ours").glob("*.urdf")
    urdf.write_text(urdf.read_text() + "\n<!-- changed -->\n")
    assert not reused(run(yarc, "check", "way.yarc"))
    assert reused(run(yarc, "check", "way.yarc"))
    Path("yarc.toml").rename("../yarc.toml")
    assert not reused(run(yarc, "check", "way.yarc"))


@pytest.mark.parametrize(
    "option", [("--tm", "10"), ("--strict",), ("--cell", "cell.toml"), ("--start", "0,0,0,0,0,1")]
)
def test_options_distinguish_results(project, option):
    run(yarcc, "way.yarc")
    assert not reused(run(yarcc, "way.yarc", *option))
    assert reused(run(yarcc, "way.yarc", *option))


def test_no_cache(project):
    run(yarcc, "way.yarc", "--no-cache")
    assert not reused(run(yarcc, "way.yarc"))
    assert reused(run(yarcc, "way.yarc"))
    assert not reused(run(yarcc, "way.yarc", "--no-cache"))


def test_a_copy_of_the_project_elsewhere_is_the_same_work(project, monkeypatch):
    run(yarc, "check", "way.yarc")
    shutil.copytree(project, project.parent / "copy")
    monkeypatch.chdir(project.parent / "copy")
    assert reused(run(yarc, "check", "way.yarc"))


def test_findings_are_as_before_also_of_a_program_with_errors(project):
    Path("way.yarc").write_text(PROGRAM.replace("P0020 MOVEJ 20", "P0020 MOVEJ 2000"))
    first, second = (run(yarc, "check", "way.yarc", "--format", "json") for _ in range(2))
    assert first.exit_code == second.exit_code == 1
    assert first.stdout == second.stdout
    first, second = (run(yarc, "check", "way.yarc") for _ in range(2))
    assert reused(second)
    assert "2000" in second.stderr


def test_a_forged_entry_is_not_taken(project):
    run(yarcc, "way.yarc")
    with sqlite3.connect(project.parent / "cache" / "yarclang" / "results.sqlite") as base:
        for number, value in base.execute("SELECT id, value FROM entries").fetchall():
            base.execute(
                "UPDATE entries SET value = ? WHERE id = ?", (value.replace(b"MOVEJ", b"MOVEL"), number)
            )
            base.execute("UPDATE entries SET value = ? WHERE id = ?", (value + b" ", number))
    assert not reused(run(yarcc, "way.yarc"))


def test_bugs_of_ours_are_not_kept(project, monkeypatch):
    def fail(*_):
        raise ZeroDivisionError

    from yarclang.pipeline import checking

    with monkeypatch.context() as patch:
        patch.setattr(checking, "plan_checked", fail)
        assert "Y2001" in run(yarc, "check", "way.yarc").stderr
    result = run(yarc, "check", "way.yarc")
    assert not reused(result)
    assert "Y2001" not in result.stderr


def test_another_installation_is_another_result(project, monkeypatch):
    from yarclang.fleet import reuse

    run(yarcc, "way.yarc")
    monkeypatch.setattr(reuse, "stamp", lambda: "another")
    monkeypatch.setattr(reuse, "this_installation", lambda: type("Other", (), {"digest": "another"}))
    assert not reused(run(yarcc, "way.yarc"))


def test_a_cache_that_cannot_be_used_is_said_and_costs_nothing_else(project):
    (project.parent / "cache").mkdir()
    (project.parent / "cache" / "yarclang").write_text("a file")
    result = run(yarcc, "way.yarc")
    assert result.exit_code == 0
    assert "the cache can't be used" in result.stderr
