"""yarcc tells of a program what `yarc check` tells, and comments and yarc.toml silence the same in both."""

import json
import re

import pytest
from click.testing import CliRunner
from conftest import EXAMPLES, HERE

from yarclang.cli.yarc import main as yarc
from yarclang.cli.yarcc import main as yarcc

PROGRAMS = sorted([*(HERE / "rejected").glob("*.yarc"), *EXAMPLES.glob("*.yarc")])
NOWHERE = "ROBOT INDUSTRIAL6\nP0010 MOVEJ HOME [5] (s)"
"""Y0603: the motion goes nowhere."""


def both(files, robot, out):
    """What yarcc and what yarc check find: file, line, severity, code, message."""
    named = ["--robot", robot] if robot else []
    runner = CliRunner()
    compiled = json.loads(
        runner.invoke(yarcc, [*files, *named, "--out-dir", str(out), "--format", "json"]).stdout
    )
    checked = json.loads(runner.invoke(yarc, ["check", *files, *named, "--format", "json"]).stdout)
    by_yarcc = [one for report in compiled["files"] for one in report["diagnostics"]]
    return tuple(
        sorted(
            (one["file"] or "", one["line"] or 0, one["severity"], one["code"], one["message"])
            for one in found
        )
        for found in (by_yarcc, checked["diagnostics"])
    )


def robot_of(path):
    text = path.read_text()
    named = re.search(r"! robot: (\S+)", text)
    return named[1] if named else None if re.search(r"^ROBOT", text, re.MULTILINE) else "INDUSTRIAL6"


def test_there_are_programs():
    assert len(PROGRAMS) > 20


@pytest.mark.parametrize("robot", sorted({robot_of(path) or "" for path in PROGRAMS}))
def test_both_find_the_same(robot, tmp_path):
    files = [str(path) for path in PROGRAMS if (robot_of(path) or "") == robot]
    by_yarcc, by_check = both(files, robot, tmp_path)
    assert by_yarcc == by_check
    assert by_yarcc


@pytest.mark.parametrize(
    ("comment", "settings", "expected", "written"),
    [
        ("", "", [("Y0603", "warning")], True),
        ("! yarc: ignore[Y0603]", "", [], True),
        ("", 'Y0603 = "off"', [], True),
        ("", 'Y0603 = "note"', [("Y0603", "note")], True),
        ("", 'Y0603 = "error"', [("Y0603", "error")], False),
        ("! yarc: ignore[Y0611]", "", [("Y0603", "warning"), ("Y1701", "warning")], True),
        ("! yarc: ignore[Y0502]", "", [("Y0603", "warning"), ("Y1702", "warning")], True),
    ],
)
def test_comments_and_settings(comment, settings, expected, written, tmp_path):
    program = tmp_path / "p.yarc"
    program.write_text(f"{NOWHERE} {comment}\n")
    (tmp_path / "yarc.toml").write_text(f"[findings]\n{settings}\n")
    by_yarcc, by_check = both([str(program)], None, tmp_path)
    assert by_yarcc == by_check
    assert [(code, severity) for _, _, severity, code, _ in by_yarcc] == expected
    assert (tmp_path / "p.pmc").is_file() == written


def test_a_suppressed_warning_is_none_for_strict(tmp_path):
    program = tmp_path / "p.yarc"
    for comment, status in (("", 1), ("! yarc: ignore[no-motion]", 0)):
        program.write_text(f"{NOWHERE} {comment}\n")
        assert CliRunner().invoke(yarcc, [str(program), "--strict"]).exit_code == status


def test_an_error_stays_whatever_a_comment_says(tmp_path):
    program = tmp_path / "p.yarc"
    program.write_text("ROBOT INDUSTRIAL6\nP0010 MOVEJ 200 0 0 0 0 0 [5] (deg,s) ! yarc: ignore[Y0502]\n")
    done = CliRunner().invoke(yarcc, [str(program)])
    assert done.exit_code == 1
    assert "error Y0502" in done.stderr
    assert not (tmp_path / "p.pmc").exists()


def test_run_and_plot_hold_to_them_too(tmp_path):
    program = tmp_path / "p.yarc"
    program.write_text(f"{NOWHERE} ! yarc: ignore[no-motion]\n")
    drawn = CliRunner().invoke(yarc, ["plot", str(program), "-o", str(tmp_path / "p.svg")])
    assert drawn.exit_code == 0, drawn.stderr
    assert "Y0603" not in drawn.stderr
    program.write_text(f"{NOWHERE}\n")
    (tmp_path / "yarc.toml").write_text('[findings]\nno-motion = "error"\n')
    run = CliRunner().invoke(yarc, ["run", str(program)])
    assert run.exit_code == 1
    assert "error Y0603" in run.stderr
