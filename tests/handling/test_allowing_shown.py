"""Tests of showing the pairs that may touch: in the table, inspect, diff, the picture and the editor."""

import numpy as np
import pytest
from click.testing import CliRunner
from handling import carrying
from handling.test_allowing import LEADS, down, run  # noqa: F401

from yarclang.cli.commands.diff import command as diff
from yarclang.cli.commands.inspect import command as inspect
from yarclang.cli.yarcc import main as yarcc
from yarclang.source import SourceFile
from yarclang.syntax.parse import parse
from yarclang.syntax.print import print_module
from yarclang.view.of_program import stage_of_program

ALLOW = " ALLOW FINGERS TRACK"


@pytest.fixture
def file(tmp_path):
    """Return a function that writes a program in the cell, with the box at {PUT}."""

    def write(program, more="", name="press.yarc"):
        text = carrying.CELL.format(**carrying.GIVEN).replace('"FEEDER"\nsize', '"PUT"\nsize')
        (tmp_path / "cell.toml").write_text(text + more)
        (tmp_path / name).write_text("ROBOT INDUSTRIAL6\n" + carrying.HEAD + program)
        return str(tmp_path / name)

    return write


def said(command, *arguments):
    found = CliRunner().invoke(command, [str(one) for one in arguments])
    assert found.exit_code in (0, 1), found.output
    return found.output


def test_the_table_says_what_is_not_checked(file, tmp_path):
    told = said(yarcc, file(down(more=ALLOW), LEADS), "-o", tmp_path / "out.pmc")
    assert "Not checked: FINGERS and TRACK on P0020, allowed by line 6." in told
    assert "Not checked: FINGERS and TRACK on P0010, P0030, allowed by line" in told


def test_inspect_says_it(file):
    told = said(inspect, file(down(more=ALLOW, up=ALLOW)), "P0020")
    assert "not checked: FINGERS and TRACK may touch, allowed by line 6; they touch" in told
    told = said(inspect, file(down(depth=0, more=ALLOW)), "P0020")
    assert "they stay apart anyway" in told


def test_diff_says_it(file):
    with_ = file(down(depth=0, more=ALLOW), name="with.yarc")
    told = said(diff, with_, file(down(depth=0), name="without.yarc"))
    assert "may touch: FINGERS and TRACK -> nothing" in told
    assert "may touch" not in said(diff, with_, with_)


def test_a_line_is_printed_as_it_is_meant():
    text = "P0010 MOVEJ 1 2 3 4 5 6 [2] (deg,s) allow  fingers   TRACK BLEND 5 ALLOW A B ! why\n"
    printed = print_module(parse(SourceFile("a.yarc", text)).value)
    assert "ALLOW FINGERS TRACK BLEND 5 ALLOW A B" in printed
    assert print_module(parse(SourceFile("a.yarc", printed)).value) == printed


def test_the_picture_knows_it(run):  # noqa: F811
    found = run(down(more=ALLOW, up=ALLOW)).value
    stage = stage_of_program("press.yarc", found.plan, found.certificate, ())
    facts = {piece.label: dict(piece.facts) for piece in stage.pieces}
    assert facts["P0020"]["may touch"] == "FINGERS and TRACK (line 5)"
    assert "may touch" not in facts["P0010"]
    # the fingers in the track aren't drawn as colliding
    scene = stage.scenes.scene(int(stage.scenes.numbers(np.array([found.plan.begins[1] + 1.0]))[0]))
    names = {scene.names(pair) for pair in range(len(scene.pairs.first))}
    assert ("FINGERS", "TRACK") not in names
    assert ("FINGERS", "TABLE") in names
