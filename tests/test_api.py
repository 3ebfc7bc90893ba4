"""Tests of the public functions: their examples run unchanged, and they report what the command line does."""

import doctest

import numpy as np
import pytest
from conftest import EXAMPLES, HERE

import yarclang
from yarclang.pipeline.checking import check_file
from yarclang.pipeline.inputs import Options

GOOD = "P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)"
NOWHERE = "P0010 MOVEJ HOME [5] (s)"


def test_examples_of_docstrings():
    failures, tried = doctest.testmod(yarclang)
    assert tried > 20
    assert failures == 0


def test_examples_of_the_page():
    failures, tried = doctest.testfile(str(HERE.parent / "docs" / "api.md"), module_relative=False)
    assert tried > 15
    assert failures == 0


def test_all_public_functions_have_examples():
    for name in yarclang.__all__:
        if name != "__version__":
            assert ">>> " in getattr(yarclang, name).__doc__, name


def test_a_program_keeps_to_the_cell_that_is_named(tmp_path):
    cell = tmp_path / "cell.toml"
    box = 'shape = "box"\nframe = "B"\nxyz = [0, 1174.4, 1300]\nsize = [1200, 1200, 100]\n'
    cell.write_text(f'units = "mm,deg"\n[[obstacles]]\nname = "TABLE"\n{box}')
    text = "P0010 DMOVE {TCP} 0 0 -600 0 0 0 [5] (mm,deg,s) {B}"
    settings = {"robot": "INDUSTRIAL6", "folder": tmp_path}
    made = yarclang.compile(text, **settings)
    assert made.ok
    found = yarclang.compile(text, **settings, cell=cell)
    assert (found.value, [one.code for one in found.diagnostics]) == (None, ["Y0901"])
    assert yarclang.plan(text, **settings, cell=str(cell)).value.program.cell is not None
    assert [one.code for one in yarclang.check(text, **settings, cell=cell)] == ["Y0901"]
    assert not yarclang.prove(made.value.text, text, **settings, cell=cell).ok
    (tmp_path / "yarc.toml").write_text('cell = "other.toml"\n')
    assert [one.code for one in yarclang.check(text, **settings, cell=cell)] == ["Y1373"]


@pytest.mark.parametrize("name", ["06_palletising.yarc", "09_fixture_cell.yarc"])
def test_a_program_finds_what_lies_beside_it(name):
    path = EXAMPLES / name
    found = yarclang.check(path.read_text(), robot="INDUSTRIAL6", name=str(path), folder=EXAMPLES)
    assert found == check_file(str(path), Options(robot="INDUSTRIAL6")).diagnostics


def test_where_the_robot_stands():
    far = yarclang.plan(GOOD, robot="INDUSTRIAL6", start=[9.0, 0, 0, 0, 0, 0]).value
    assert far.sample(np.zeros(1))[0][0, 0] == pytest.approx(9.0 * 0.017453292519943295)
    (found,) = yarclang.check(GOOD, robot="INDUSTRIAL6", start=[1.0, 2.0])
    assert found.code == "Y1394"


@pytest.mark.parametrize("function", [yarclang.check, yarclang.plan, yarclang.compile])
@pytest.mark.parametrize(("settings", "severity"), [("error", "error"), ("note", "note"), ("off", None)])
def test_the_project_says_how_severe(function, settings, severity, tmp_path):
    (tmp_path / "yarc.toml").write_text(f'[findings]\nno-motion = "{settings}"\n')
    result = function(NOWHERE, robot="INDUSTRIAL6", folder=tmp_path)
    found = result if function is yarclang.check else result.diagnostics
    assert [one.severity for one in found] == ([severity] if severity else [])
    if function is not yarclang.check:
        assert (result.value is None) == (severity == "error")


@pytest.mark.parametrize("function", [yarclang.check, yarclang.plan, yarclang.compile])
@pytest.mark.parametrize(
    "text", ["", "\x00", "P", "END", "P0010 MOVEJ", "P0010 MOVEJ [", "{" * 50, "; yarcc "]
)
def test_nothing_raises(function, text):
    result = function(text, robot="INDUSTRIAL6")
    assert any(one.is_error for one in (result if function is yarclang.check else result.diagnostics))


def test_no_robot():
    assert [one.code for one in yarclang.check(GOOD)] == ["Y1391"]
    assert yarclang.prove("", GOOD).value is None


@pytest.mark.parametrize("text", ["", "CLOSE", "; nothing\n"])
def test_what_is_no_controller_text_is_refused(text):
    result = yarclang.prove(text, GOOD, robot="INDUSTRIAL6")
    assert result.value is None
    assert not result.ok


def test_format_refuses_what_it_cannot_read():
    with pytest.raises(ValueError, match="line 1"):
        yarclang.format("P1 MOVEJ [5")
