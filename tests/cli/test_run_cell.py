"""The approach to the start of a controller text: which cell it knows, and that it is told where it knows none."""

import json
import shutil

import numpy as np
import pytest
from click.testing import CliRunner
from conftest import EXAMPLES

from yarclang.cli.loading import load
from yarclang.cli.yarc import main
from yarclang.cli.yarcc import main as yarcc
from yarclang.coordinator.programs import way_to_start

PROGRAM, CELL = "12_machine_cell.yarc", "12_machine_cell.toml"
BEHIND_THE_GAUGE = np.radians([-30.0, -30.0, -45.0, 0.0, -20.0, 0.0])
"""From here the straight way to the program's start leads through the gauge."""


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The program, its cell, and its text, which stands beside them and alone in a folder of its own."""
    folder = tmp_path_factory.mktemp("made")
    for name in (PROGRAM, CELL):
        shutil.copy(EXAMPLES / name, folder / name)
    (folder / "alone").mkdir()
    result = CliRunner().invoke(yarcc, [str(folder / PROGRAM), "-o", str(folder / "made.pmc")])
    assert result.exit_code == 0, result.output
    shutil.copy(folder / "made.pmc", folder / "alone")
    return folder


def loaded(file, **options):
    return load(str(file), None, {"robot": None, "step": False, "approach": True, "cell": None, **options})


def commands(found):
    way = way_to_start(found.program.robot, found, BEHIND_THE_GAUGE)
    return [one.name for one in way.job.commands]


def test_it_is_the_cell_of_the_program_beside_it(made):
    found, diagnostics = loaded(made / "made.pmc")
    assert diagnostics == ()
    assert commands(found) == ["MOVEJ_SPLINE_LSPB"]


def test_or_the_cell_that_is_named(made):
    found, diagnostics = loaded(made / "alone" / "made.pmc", cell=str(made / CELL))
    assert diagnostics == ()
    assert commands(found) == ["MOVEJ_SPLINE_LSPB"]


def test_else_it_is_said_once_that_it_knows_none(made):
    found, diagnostics = loaded(made / "alone" / "made.pmc")
    assert [one.code for one in diagnostics] == ["Y0927"]
    assert "isn't there" in diagnostics[0].message
    assert commands(found) == ["MOVEJ_LSPB"]
    # without an approach there is nothing to say
    assert loaded(made / "alone" / "made.pmc", approach=False)[1] == ()


def test_a_program_that_does_something_else_is_not_believed(made, tmp_path):
    shutil.copy(made / "made.pmc", tmp_path)
    shutil.copy(made / CELL, tmp_path)
    (tmp_path / PROGRAM).write_text((made / PROGRAM).read_text().replace("[V 100]", "[V 90]"))
    _, diagnostics = loaded(tmp_path / "made.pmc")
    assert [one.code for one in diagnostics] == ["Y0927"]
    assert "does something else" in diagnostics[0].message


def test_a_cell_that_cant_be_read_forbids_the_run(made, tmp_path):
    broken = tmp_path / "broken.toml"
    broken.write_text("[[obstacles]]\nname = 3\n")
    for cell in (broken, tmp_path / "missing.toml"):
        found, diagnostics = loaded(made / "made.pmc", cell=str(cell))
        assert found is None
        assert any(one.is_error for one in diagnostics)


@pytest.mark.parametrize("command", ["run", "exec"])
def test_a_program_names_its_cell_itself(command, made):
    result = CliRunner().invoke(main, [command, str(made / PROGRAM), "--cell", str(made / CELL)])
    assert result.exit_code == 2
    assert "CELL line" in result.stderr


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
    assert [one["code"] for one in event["findings"]] == ["Y0927"]
