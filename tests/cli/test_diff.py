"""`yarc diff` as its users run it."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from yarclang.cli.yarc import main
from yarclang.cli.yarcc import main as yarcc

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
LINES = EXAMPLES / "02_lines_and_deltas.yarc"


def run(*arguments):
    return CliRunner().invoke(main, ["diff", *map(str, arguments)])


@pytest.fixture
def slower(tmp_path):
    file = tmp_path / "slower.yarc"
    file.write_text(
        LINES.read_text().replace("[4]", "[5]").replace("P0030 DMOVE 0 0 -50", "P0030 DMOVE 0 0 -52")
    )
    return file


def test_a_program_and_what_was_made_of_it_are_equal(tmp_path):
    made = tmp_path / "out.pmc"
    assert CliRunner().invoke(yarcc, [str(LINES), "-o", str(made)]).exit_code == 0
    for pair in ((LINES, made), (made, LINES), (made, made), (LINES, LINES)):
        result = run(*pair)
        assert result.exit_code == 0, result.output
        assert result.stdout.startswith("7 same; ")


def test_differences(slower):
    result = run(LINES, slower)
    assert result.exit_code == 1
    assert "~ P0020 MOVEL" in result.stdout
    assert "4.000 s -> 5.000 s (+1.000 s)" in result.stdout
    assert "path differs by at most 2 mm" in result.stdout
    assert "error" not in result.output
    assert "\x1b" not in result.output
    assert len(run(LINES, slower, "--all").stdout.splitlines()) == 8


def test_json(slower):
    result = run(LINES, slower, "--format", "json")
    assert result.exit_code == 1
    document = json.loads(result.stdout)
    assert document["equal"] is False
    assert [one["status"] for one in document["commands"]].count("changed") >= 2
    assert json.loads(run(LINES, LINES, "--format", "json").stdout)["equal"] is True


def test_a_tolerance(tmp_path):
    file = tmp_path / "near.yarc"
    file.write_text(LINES.read_text().replace("P0030 DMOVE 0 0 -50", "P0030 DMOVE 0 0 -50.5"))
    assert run(LINES, file, "--tolerance", "0.01").exit_code == 1
    result = run(LINES, file, "--tolerance", "1,1")
    assert "path differs" not in result.stdout


def test_an_error_is_told_apart_from_a_difference(tmp_path):
    broken = tmp_path / "broken.yarc"
    broken.write_text(LINES.read_text().replace("P0020 MOVEL", "P0020 MOVEX"))
    result = run(LINES, broken)
    assert result.exit_code == 1
    assert result.stdout == ""
    assert "error Y02" in result.stderr
    assert "nothing was compared" in result.stderr
    for file in (tmp_path / "no.yarc", tmp_path / "no.pmc"):
        assert "Y0107" in run(LINES, file).stderr
    other = tmp_path / "other.pmc"
    other.write_text("CLOSE\n")
    assert "Y1151" in run(LINES, other).stderr


def test_programs_for_different_robots_are_not_compared(tmp_path):
    one = tmp_path / "one.yarc"
    one.write_text("ROBOT TRACKED_MANIPULATOR\nP0010 MOVEJ HOME [5] (s)\n")
    result = run(LINES, one)
    assert result.exit_code == 1
    assert "Y1163" in result.stderr


def test_wrong_usage():
    assert run(LINES).exit_code == 2
    assert run("-", "-").exit_code == 2
    assert run(LINES, LINES, "--tolerance", "x").exit_code == 2


ON = """ROBOT INDUSTRIAL6
INPUT CURTAIN M11
SUB AWAY
  P0001 MOVEJ 10 0 0 0 0 0 [2] (deg,s)
END
ON CURTAIN OFF HOLD
P0010 MOVEJ 0 0 0 0 30 0 [2] (deg,s)
"""


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        (
            (("OFF HOLD", "OFF CALL AWAY"),),
            "~ when CURTAIN (M11) is OFF: CURTAIN: hold -> CURTAIN: hold, then leave by AWAY",
        ),
        ((("ON CURTAIN OFF HOLD\n", ""),), "- when CURTAIN (M11) is OFF: removed: hold"),
        ((("OFF HOLD", "OFF HOLD\nON CURTAIN ON HOLD"),), "+ when CURTAIN (M11) is ON: added: hold"),
        ((("CURTAIN", "GATE"),), "~ when GATE (M11) is OFF: CURTAIN: hold -> GATE: hold"),
    ],
)
def test_what_holds_the_motions(tmp_path, changes, told):
    first, second = tmp_path / "a.yarc", tmp_path / "b.yarc"
    first.write_text(ON)
    text = ON
    for old, new in changes:
        text = text.replace(old, new)
    second.write_text(text)
    result = run(first, second)
    assert result.exit_code == 1
    assert told in result.stdout.splitlines()
    assert result.stdout.splitlines()[-1].startswith("1 same; ")
    held = json.loads(run(first, second, "--format", "json").stdout)["held_by"]
    assert held[0] == [{"input": "CURTAIN", "variable": "M11", "value": 0.0, "then": "", "way": ""}]


def test_another_way_out(tmp_path):
    first, second = tmp_path / "a.yarc", tmp_path / "b.yarc"
    first.write_text(ON.replace("OFF HOLD", "OFF CALL AWAY"))
    second.write_text(first.read_text().replace("MOVEJ 10", "MOVEJ 11"))
    result = run(first, second)
    assert result.exit_code == 1
    assert result.stdout.startswith("~ when CURTAIN (M11) is OFF: AWAY follows a different path\n1 same; ")
