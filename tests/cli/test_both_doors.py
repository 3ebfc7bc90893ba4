"""Commands agree in their findings.

yarcc and `yarc check` have the same findings, and comments and yarc.toml silence the same findings
everywhere.
"""

import json
import re

import pytest
from click.testing import CliRunner
from conftest import EXAMPLES, HERE

from yarclang.cli.loading import load, source_of
from yarclang.cli.yarc import main as yarc
from yarclang.cli.yarcc import main as yarcc
from yarclang.pipeline.controller_text import robot_of_text
from yarclang.pipeline.inputs import Options
from yarclang.view.opening import opened

PROGRAMS = sorted([*(HERE / "rejected").glob("*.yarc"), *EXAMPLES.glob("*.yarc")])
NOWHERE = "ROBOT INDUSTRIAL6\nP0010 MOVEJ HOME [5] (s)"
"""A program with the warning Y0603, because its motion doesn't go anywhere."""


def both(files, robot, out):
    """Return the findings of yarcc and of `yarc check`: file, line, severity, code, message."""
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


def by_plot(program):
    return invoked("plot", program, "-o", f"{program}.svg")


def by_inspect(program):
    return invoked("inspect", program, "P0010")


def by_diff(program):
    return invoked("diff", program, program)


def by_run(program):
    loaded, found = load(source_of(program, None, {"robot": None, "step": False}))
    return loaded is not None, [(one.code, one.severity) for one in found]


def by_view(program):
    shown = opened(program, Options(), robot_of_text)
    return shown.value is not None, [(one.code, one.severity) for one in shown.diagnostics]


def invoked(*arguments):
    """Return whether a command succeeded, and the codes and severities of its findings."""
    done = CliRunner().invoke(yarc, arguments)
    told = re.findall(r"(error|warning|note) (Y[0-9]{4})", done.stderr)
    return done.exit_code == 0, list(dict.fromkeys((code, severity) for severity, code in told))


@pytest.mark.parametrize("door", [by_plot, by_inspect, by_run, by_view])
@pytest.mark.parametrize(
    ("comment", "settings", "expected"),
    [
        ("", "", [("Y0603", "warning")]),
        ("! yarc: ignore[no-motion]", "", []),
        ("", 'no-motion = "off"', []),
        ("", 'no-motion = "note"', [("Y0603", "note")]),
        ("", 'no-motion = "error"', [("Y0603", "error")]),
    ],
)
def test_every_door_holds_to_them(door, comment, settings, expected, tmp_path):
    program = tmp_path / "p.yarc"
    program.write_text(f"{NOWHERE} {comment}\n")
    (tmp_path / "yarc.toml").write_text(f"[findings]\n{settings}\n")
    done, told = door(str(program))
    assert told == expected
    # the view also shows a program with errors, as far as possible
    assert done == (door is by_view or ("Y0603", "error") not in expected)


@pytest.mark.parametrize(
    ("settings", "expected", "compared"),
    [("", [], True), ('no-motion = "error"', [("Y0603", "error")], False)],
)
def test_diff_tells_errors_alone(settings, expected, compared, tmp_path):
    program = tmp_path / "p.yarc"
    program.write_text(f"{NOWHERE}\n")
    (tmp_path / "yarc.toml").write_text(f"[findings]\n{settings}\n")
    assert by_diff(str(program)) == (compared, expected)


WRONG_FRAME = """ROBOT INDUSTRIAL6
DEFAULT {TCP} [MIN] (mm,deg,s) {B}
FRAME {PART} 0 9OO 700 0 0 0 {B}
P0010 MOVEJ_RPY 0 0 0 0 0 0 {PART}
P0020 MOVEL 0 0 50 0 0 0 {PART}
P0030 MOVEJ HOME
"""
"""A program with the error Y0402, a letter in a number, from which other errors would follow."""


@pytest.mark.parametrize("door", [by_plot, by_diff, by_run, by_view])
def test_no_door_tells_what_only_follows_from_something_else(door, tmp_path):
    program = tmp_path / "p.yarc"
    program.write_text(WRONG_FRAME)
    assert [code for code, _ in door(str(program))[1]] == ["Y0402"]


def test_inspect_counts_what_check_shows(tmp_path):
    program = tmp_path / "p.yarc"
    program.write_text(WRONG_FRAME)
    done = CliRunner().invoke(yarc, ["inspect", str(program), "P0020"])
    assert done.exit_code == 1
    assert "elsewhere: 1 error; `yarc check` shows them" in done.stderr
