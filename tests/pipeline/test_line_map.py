"""Tests of finding the command of a line of controller text; the certificate reads the text independently."""

import re
from pathlib import Path

import pytest
from programs import compiled

from yarclang.certify.pmac.read import read
from yarclang.certify.read.text import Barred, Dwelt, Put, Run
from yarclang.emitted.purposes import MOVE, OPENING
from yarclang.pipeline.inputs import Options, open_program
from yarclang.pipeline.line_map import HEADER, is_compiled_text, map_lines
from yarclang.pipeline.origins import origins_of_text
from yarclang.pipeline.stages import compile_module
from yarclang.robot.description import load_robot

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
TENDING = EXAMPLES / "08_machine_tending.yarc"
ROBOT = load_robot("INDUSTRIAL6").value


def text_of(path, target):
    opened = open_program(str(path), Options(target=target)).value
    return compile_module(opened.module, opened.request).value.text


@pytest.fixture(scope="module", params=["rotary", "prog"])
def tending(request):
    return text_of(TENDING, request.param)


def test_every_line_has_one_purpose(tending):
    mapped = map_lines(tending)
    covered = [line for one in mapped.stretches for line in range(one.first, one.last + 1)]
    assert covered == list(range(1, len(tending.splitlines()) + 1))
    assert mapped.at(len(covered)).what == "it ends the program"
    assert mapped.at(0) is None
    assert mapped.at(len(covered) + 1) is None


def test_lines_lead_to_the_commands_that_the_reader_finds(tending):
    mapped, content = map_lines(tending), read(tending, ROBOT.controller)
    by_step = {entry.step: entry for entry in content.entries}
    assert [one.step for one in mapped.commands] == list(by_step)
    for entry in content.entries:
        assert mapped.at(entry.at).command.step == entry.step
        if entry.first is not None:
            assert {mapped.at(line).command.step for line in (entry.first, entry.last)} == {entry.step}
            assert mapped.at(entry.last).what == MOVE
    kinds = {"SET": 0, "WAIT": 0}
    last = -1
    for item in content.course:
        match item:
            case Barred(line=line, step=step):
                assert mapped.at(line).command.step == last == step or step > last
                last = step
            case Put(line=line):
                assert mapped.at(line).command.name == "SET"
                assert mapped.at(line).command.step > last
                last = mapped.at(line).command.step
                kinds["SET"] += 1
            case Dwelt(line=line, milliseconds=milliseconds) if milliseconds > 0:
                assert mapped.at(line).command.name == "WAIT"
                kinds["WAIT"] += 1
            case Run(tm_line=line, lines=lines):
                assert mapped.at(line).command == mapped.at(int(lines[0])).command
                last = mapped.at(int(lines[-1])).command.step
    assert kinds["SET"] == sum(entry.name == "SET" for entry in content.entries)
    assert kinds["WAIT"] > 3


def test_what_stands_before_the_first_command_is_told_of():
    text = compiled("P0010 MOVEJ 1 2 3 4 5 6 [2] (deg,s)")[0].text
    mapped = map_lines(text)
    assert mapped.program == "test.yarc"
    assert mapped.robot == "INDUSTRIAL6"
    assert next(one.what for one in mapped.stretches if one.command) == HEADER
    assert OPENING in {one.what for one in mapped.stretches}
    assert is_compiled_text(text)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "x\ny\n",
        "; yarcc 0.1: a\n",
        "; command 0 P0010 MOVEJ 1 3 900\nX1\n",
        "TM5\nSPLINE1\nDWELL0\nM1=1\n",
    ],
)
def test_texts_that_are_none_of_ours_are_mapped_as_well(text):
    mapped = map_lines(text)
    assert sum(one.last - one.first + 1 for one in mapped.stretches) == len(text.splitlines())


def test_a_header_that_is_another_is_no_map():
    text = compiled("P0010 MOVEJ 1 2 3 4 5 6 [2] (deg,s)")[0].text
    mapped = map_lines(re.sub(r"^(; command .*)$", r"\1 and more 12", text, flags=re.MULTILINE))
    assert mapped.commands == ()
    (stretch,) = mapped.stretches
    assert stretch.what.startswith("unknown: line 12 is no line of the map of commands")


# finding the program from which a controller text was made


def test_the_program_is_known_again_by_what_it_does(tmp_path):
    text = text_of(TENDING, "rotary")
    copy = tmp_path / TENDING.name
    copy.write_text("! a comment more\n\n" + TENDING.read_text())
    origins = origins_of_text(text, tmp_path, ROBOT)
    assert origins.missing == ""
    mapped = map_lines(text)
    glued = next(one for one in mapped.commands if one.index == "P0050")
    assert origins.of_listed(glued).span.line == glued.source_line + 2
    in_module = origins.of_listed(next(one for one in mapped.commands if one.index.startswith("P0040>")))
    assert in_module.source.name.endswith("approach.yarc")


def test_a_changed_or_missing_program_is_told_of(tmp_path):
    text = text_of(TENDING, "rotary")
    assert "isn't there" in origins_of_text(text, tmp_path, ROBOT).missing
    copy = tmp_path / TENDING.name
    copy.write_text(TENDING.read_text().replace("WAIT [0.3]", "WAIT [0.4]"))
    missing = origins_of_text(text, tmp_path, ROBOT)
    assert "the source has changed, or is another program" in missing.missing
    assert missing.of("P0050", "SET", 30) is None
    copy.write_text("nonsense\n")
    assert "the source has changed, or is another program" in origins_of_text(text, tmp_path, ROBOT).missing


def test_a_start_of_its_own_is_found_in_the_header(tmp_path):
    program = tmp_path / "p.yarc"
    program.write_text("P0010 MOVEJ 1 2 3 4 5 6 [4] (deg,s)\n")
    opened = open_program(str(program), Options(robot="INDUSTRIAL6", start=(10.5, 0, 0, 0, 0, 0))).value
    text = compile_module(opened.module, opened.request).value.text
    assert origins_of_text(text, tmp_path, ROBOT).missing == ""
