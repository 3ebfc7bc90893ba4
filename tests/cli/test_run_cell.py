"""The approach to the start of a controller text uses the text's cell, and says if none is known."""

import json
import shutil

import numpy as np
import pytest
from click.testing import CliRunner
from conftest import EXAMPLES

from yarclang.cli.loading import load, source_of
from yarclang.cli.yarc import main
from yarclang.cli.yarcc import main as yarcc
from yarclang.coordinator.programs import way_to_start

PROGRAM, CELL = "12_machine_cell.yarc", "12_machine_cell.toml"
BEHIND_THE_GAUGE = np.radians([-30.0, -30.0, -45.0, 0.0, -20.0, 0.0])
"""Joint positions from which the straight path to the program's start leads through the gauge."""


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Return a folder with the program, its cell and its text, and a copy of the text in a folder alone."""
    folder = tmp_path_factory.mktemp("made")
    for name in (PROGRAM, CELL):
        shutil.copy(EXAMPLES / name, folder / name)
    (folder / "alone").mkdir()
    result = CliRunner().invoke(yarcc, [str(folder / PROGRAM), "-o", str(folder / "made.pmc")])
    assert result.exit_code == 0, result.output
    shutil.copy(folder / "made.pmc", folder / "alone")
    return folder


def loaded(file, **options):
    words = {"robot": None, "step": False, "approach": True, "cell": None, **options}
    return load(source_of(str(file), None, words))


def commands(found):
    way = way_to_start(found.program.robot, found, BEHIND_THE_GAUGE)
    return [one.name for one in way.job.commands]


def test_it_is_the_cell_of_the_program_beside_it(made):
    found, diagnostics = loaded(made / "made.pmc")
    assert diagnostics == ()
    assert commands(found) == ["MOVEJ_SPLINE_LSPB"]


def test_or_the_cell_that_is_named(made):
    found, diagnostics = loaded(made / "alone" / "made.pmc", cell=str(made / CELL))
    assert [one.code for one in diagnostics] == ["Y1193"]
    assert "its surroundings" not in diagnostics[0].message
    assert commands(found) == ["MOVEJ_SPLINE_LSPB"]


def test_else_it_is_said_once_that_it_knows_none(made):
    found, diagnostics = loaded(made / "alone" / "made.pmc")
    assert [one.code for one in diagnostics] == ["Y0927", "Y1193"]
    assert "isn't there" in diagnostics[0].message
    assert commands(found) == ["MOVEJ_LSPB"]
    # without an approach, the only finding is that the program wasn't judged
    assert [one.code for one in loaded(made / "alone" / "made.pmc", approach=False)[1]] == ["Y1193"]


def test_a_program_that_does_something_else_forbids_the_run(made, tmp_path):
    shutil.copy(made / "made.pmc", tmp_path)
    shutil.copy(made / CELL, tmp_path)
    (tmp_path / PROGRAM).write_text((made / PROGRAM).read_text().replace("[V 100]", "[V 90]"))
    found, (finding,) = loaded(tmp_path / "made.pmc")
    assert found is None
    assert finding.code == "Y1167"
    assert "90 mm/s are programmed" in finding.message
    assert f"{PROGRAM} has changed since" in finding.help
    # the right program is accepted, even from another folder
    found, diagnostics = loaded(tmp_path / "made.pmc", source=str(made / PROGRAM))
    assert diagnostics == ()
    assert found is not None


def test_a_program_with_errors_forbids_the_run(made, tmp_path):
    shutil.copy(made / "made.pmc", tmp_path)
    (tmp_path / PROGRAM).write_text("P0010 MOVEK 1\n")
    found, (finding,) = loaded(tmp_path / "made.pmc")
    assert found is None
    assert finding.code == "Y1192"
    assert f"yarc check {PROGRAM}" in finding.help
    found, (finding,) = loaded(tmp_path / "made.pmc", source=str(tmp_path / "missing.yarc"))
    assert (found, finding.code) == (None, "Y0107")


def test_a_program_that_was_only_laid_out_anew_is_the_same(made, tmp_path):
    shutil.copy(made / "made.pmc", tmp_path)
    shutil.copy(made / CELL, tmp_path)
    (tmp_path / PROGRAM).write_text("! a comment more\n\n" + (made / PROGRAM).read_text())
    found, diagnostics = loaded(tmp_path / "made.pmc")
    assert diagnostics == ()
    assert found is not None


def test_a_program_of_another_name_beside_it_is_not_its_program(made, tmp_path):
    """A program of another name beside a text isn't taken as the text's program.

    A program of the text's own name must be proved, whatever the text's header says.
    """
    for name, code in (("other.yarc", "Y1193"), ("made.yarc", "Y1153")):
        shutil.copy(made / "made.pmc", tmp_path)
        (tmp_path / name).write_text("ROBOT INDUSTRIAL6\nP0010 MOVEJ 5 0 0 0 0 0 [2] (deg,s)\n")
        _, (finding,) = loaded(tmp_path / "made.pmc", approach=False)
        assert finding.code == code


def test_a_tolerance_that_it_was_compiled_with(tmp_path):
    """A text is judged with the tolerance that it was compiled with.

    A wide tolerance leads to fewer digits and longer segments, which a narrow one would refuse.
    """
    program = tmp_path / "p.yarc"
    program.write_text(
        "ROBOT INDUSTRIAL6\n"
        "DEFAULT {TCP} (mm,deg,s) {B}\n"
        "P1 MOVEJ 20 0 0 0 -30 0 [2]\n"
        "P2 DMOVE 0 0 -300 0 0 0 [1.5]\n"
    )
    options = [str(program), "--tolerance", "1,1", "-o", str(tmp_path / "p.pmc")]
    assert CliRunner().invoke(yarcc, options).exit_code == 0
    found, diagnostics = loaded(tmp_path / "p.pmc", tolerance=(1.0, 1.0), approach=False)
    assert diagnostics == ()
    assert found is not None


def test_a_cell_that_cant_be_read_forbids_the_run(made, tmp_path):
    broken = tmp_path / "broken.toml"
    broken.write_text("[[obstacles]]\nname = 3\n")
    for cell in (broken, tmp_path / "missing.toml"):
        found, diagnostics = loaded(made / "made.pmc", cell=str(cell))
        assert found is None
        assert any(one.is_error for one in diagnostics)


@pytest.mark.parametrize("command", ["run", "exec"])
def test_a_program_names_its_cell_itself(command, made, tmp_path):
    """If the program names its cell, the command line may only name the same file."""
    other = shutil.copy(made / CELL, tmp_path / "other.toml")
    result = CliRunner().invoke(main, [command, str(made / PROGRAM), "--cell", str(other)])
    assert result.exit_code == 1
    assert "Y1373" in result.output
    found, diagnostics = loaded(made / PROGRAM, cell=str(made / "alone" / ".." / CELL), approach=False)
    assert not any(one.is_error for one in diagnostics)
    assert found.around.obstacles


def test_exec_tells_it_as_an_event(made):
    arguments = [
        "exec",
        str(made / "alone" / "made.pmc"),
        "--approach",
        "--to",
        "tcp://127.0.0.1:1",
        "--no-log",
    ]
    first = CliRunner().invoke(main, arguments).stdout.splitlines()[0]
    event = json.loads(first)
    assert event["event"] == "findings"
    assert [one["code"] for one in event["findings"]] == ["Y0927", "Y1193"]
