"""`yarc inspect` as its users run it."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from yarclang.cli.yarc import main
from yarclang.cli.yarcc import main as yarcc

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
PALLET = str(EXAMPLES / "06_palletising.yarc")
HEAD = "ROBOT INDUSTRIAL6\nDEFAULT {TCP} [MIN] (mm,deg,s) {B}\n"


def run(*arguments):
    return CliRunner().invoke(main, ["inspect", *map(str, arguments)])


@pytest.fixture(scope="module")
def compiled(tmp_path_factory):
    folder = tmp_path_factory.mktemp("compiled")
    program = folder / "tending.yarc"
    program.write_text((EXAMPLES / "08_machine_tending.yarc").read_text())
    assert CliRunner().invoke(yarcc, [str(program)]).exit_code == 0
    return folder / "tending.pmc"


def test_an_index_of_many_places_lists_them_and_takes_the_first():
    result = run(PALLET, "P0020")
    assert result.exit_code == 0
    assert "P0020 is at 120 places; this is the first" in result.stderr
    assert "P0020(LAYER=0,ROW=0,COLUMN=0)>P0010>P0020>P0010 MOVEJ_RPY" in result.stdout
    assert "approach.yarc:" in result.stdout
    assert "\x1b" not in result.output


def test_a_place():
    result = run(PALLET, "p20(layer=1,row=2,column=3)>p10>p30", "--format", "json")
    assert result.exit_code == 0
    document = json.loads(result.stdout)
    assert document["places"] == ["P0020(LAYER=1,ROW=2,COLUMN=3)>P0010>P0030"]
    assert document["command"]["frames"]["base"][0]["frame"] == "CONVEYOR"
    assert document["command"]["certificate"]["deviation"]["position_mm"] < 0.02
    assert document["command"]["controller_text"]


def test_a_line_of_the_program(tmp_path):
    program = tmp_path / "p.yarc"
    program.write_text(HEAD + "P0010 MOVEJ 10 0 0 0 0 0\n")
    assert "p.yarc:3: P0010 MOVEJ" in run(program, "--line", 3).stdout
    missing = run(program, "--line", 2)
    assert missing.exit_code == 1
    assert "line 2 has no command" in missing.stderr


def test_a_program_with_errors_elsewhere(tmp_path):
    program = tmp_path / "p.yarc"
    program.write_text(
        HEAD + "P0010 MOVEJ 10 0\nP0020 MOVEJ 0 -10 -20 0 -60 0\nP0030 DMOVE 0 0 9 0 0 0 {B}\n"
    )
    result = run(program, "P0030")
    assert result.exit_code == 1
    assert "elsewhere: 1 error" in result.stderr
    assert "P0030 DMOVE" in result.stdout
    wrong = run(program, "P0010")
    assert wrong.exit_code == 1
    assert wrong.stdout == ""
    assert "Y0401" in wrong.stderr
    assert "there is no command P0010; errors may hide it" in wrong.stderr


def test_an_unknown_place_says_what_there_is(tmp_path):
    program = tmp_path / "p.yarc"
    program.write_text(HEAD + "P0010 MOVEJ 10 0 0 0 0 0\nP0700 MOVEJ 0 0 0 0 0 0\n")
    result = run(program, "P0500")
    assert result.exit_code == 1
    assert "there is no command P0500" in result.stderr
    assert "help:" in result.stderr


# a line of controller text


def test_a_line_of_controller_text_leads_to_its_command_and_place(compiled):
    text = compiled.read_text().splitlines()
    line = next(number for number, one in enumerate(text, 1) if one == "M2=0")
    result = run(compiled, "--line", line)
    assert result.exit_code == 0
    assert "tending.yarc:" in result.stdout
    assert "P0070 SET" in result.stdout
    assert "P0070 SET CHUCK_SHUT OFF" in result.stdout
    document = json.loads(run(compiled, "--line", line, "--format", "json").stdout)
    assert (document["command"]["place"], document["text"]) == ("P0070", "M2=0")
    assert document["source_missing"] is None


def test_by_its_own_comments(compiled, tmp_path):
    alone = tmp_path / "alone.pmc"
    alone.write_text(compiled.read_text())
    result = run(alone, "P0040>P0030")
    assert result.exit_code == 0
    assert "of tending.yarc or of a module of it" in result.stdout
    assert "isn't there" in result.stdout
    named = run(alone, "P0040>P0030", "--source", compiled.with_suffix(".yarc"))
    assert "approach.yarc:" in named.stdout
    changed = tmp_path / "other.yarc"
    changed.write_text(HEAD + "P0010 MOVEJ 10 0 0 0 0 0\n")
    assert "differs from this text" in run(alone, "P0040>P0030", "--source", changed).stdout


def test_lines_of_no_command(compiled):
    assert "before the first command" in run(compiled, "--line", 70).stdout
    last = len(compiled.read_text().splitlines())
    assert "ends the program" in run(compiled, "--line", last).stdout
    beyond = run(compiled, "--line", last + 1)
    assert beyond.exit_code == 1
    assert f"has no line {last + 1}: it has {last}" in beyond.stderr


def test_wrong_usage(compiled, tmp_path):
    assert run(PALLET).exit_code == 2
    assert run(PALLET, "P0010", "--line", 3).exit_code == 2
    assert run(PALLET, "P0010", "--source", PALLET).exit_code == 2
    assert run(compiled, "P0010", "--tm", 10).exit_code == 2
    assert run(tmp_path / "no.yarc", "P0010").exit_code == 1
    assert run(tmp_path / "no.pmc", "--line", 1).exit_code == 1
    other = tmp_path / "other.pmc"
    other.write_text("CLOSE\n")
    result = run(other, "--line", 1)
    assert result.exit_code == 1
    assert "Y1151" in result.stderr
