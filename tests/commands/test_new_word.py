"""Tests of a command whose file is put beside those of the others: all parts of yarclang know it. The command
of this test sets an output for 0.1 s, in three steps.
"""

import sys

import pytest
from click.testing import CliRunner
from programs import compiled

from yarclang.assist.vocabulary import action_entries
from yarclang.cli.yarc import main
from yarclang.commands import builtin, registry
from yarclang.highlight.words import words
from yarclang.hir import Dwell, SetOutput
from yarclang.pipeline.line_map import map_lines
from yarclang.semantics.names.commands import _known

FILE = """
from yarclang.commands.spec import ActionForm, ActionSpec
from yarclang.hir import Dwell, SetOutput
from yarclang.words.spec import Slot


def _build(arguments):
    output, = arguments.values
    origin = arguments.origin
    return SetOutput(origin, output, 1.0), Dwell(origin, 0.1), SetOutput(origin, output, 0.0)


COMMAND = ActionSpec(
    name="PING", title="Pulse", summary="sets an output for 0.1 s", wants="an output", build=_build,
    forms=(ActionForm((Slot.OUTPUT,)),), examples=("PING GRIP",),
)
"""
CACHES = (registry._found, registry.commands, registry.actions, action_entries, words, _known)
HEAD = "DEFAULT [50%] (deg,s)\nOUTPUT GRIP M1 OFF\nINPUT DOOR M11\n"


@pytest.fixture(autouse=True)
def _ping(tmp_path, monkeypatch):
    (tmp_path / "ping.py").write_text(FILE)
    for one in CACHES:
        one.cache_clear()
    with monkeypatch.context() as patch:
        patch.setattr(builtin, "__path__", [*builtin.__path__, str(tmp_path)])
        yield
    sys.modules.pop(f"{builtin.__name__}.ping", None)
    for one in CACHES:
        one.cache_clear()


def test_its_steps_are_carried_out_one_after_the_other():
    made, found = compiled(
        f"{HEAD}P0010 MOVEJ 10 0 0 0 0 0\nP0020 PING GRIP\nREPEAT 2\n  P0030 PING GRIP\nEND\n"
    )
    assert not found
    steps = made.program.steps[1:]
    assert [type(one) for one in steps] == [SetOutput, Dwell, SetOutput] * 3
    lines = made.text.splitlines()
    begin = lines.index("M1=1")
    assert lines[begin : begin + 9] == ["M1=1", "DWELL100", "M1=0"] * 3
    # each line of the text is mapped to one of the three steps
    meant = {one.first: (one.command.step, one.what) for one in map_lines(made.text).stretches if one.command}
    assert [meant[begin + number] for number in range(4)] == [
        (1, "the robot comes to rest before it"),
        (1, "its assignment"),
        (2, "its dwell"),
        (3, "its assignment"),
    ]


@pytest.mark.parametrize(
    ("line", "code", "told"),
    [
        ("P0010 PING", "Y0401", "PING takes an output"),
        ("P0010 PING DOOR", "Y0209", "DOOR is an input, not an output"),
        ("P0010 PING GRIP ON", "Y0401", "PING takes an output"),
        ("P0010 PING GRIP [2]", "Y0408", "PING doesn't take a motion time"),
        ("P0010 PINGG GRIP", "Y0202", "PINGG is no command"),
        ("LET PING = 3\nP0010 MOVEJ 10 0 0 0 0 0", "Y0211", "PING is a word of the language"),
    ],
)
def test_its_mistakes_are_found(line, code, told):
    _, found = compiled(f"{HEAD}{line}\n")
    (first,) = [one for one in found if one.is_error]
    assert first.code == code
    assert told in first.message
    if code in ("Y0401", "Y0202"):
        assert "PING" in first.help


def test_inspect_shows_all_of_its_steps(tmp_path):
    program = tmp_path / "ping.yarc"
    program.write_text(f"{HEAD}P0010 MOVEJ 10 0 0 0 0 0\nP0020 PING GRIP\n")
    done = CliRunner().invoke(main, ["inspect", str(program), "P0020", "--robot", "INDUSTRIAL6"])
    assert done.exit_code == 0, done.output
    told = [line for line in done.output.splitlines() if "GRIP (M1) becomes" in line or "waits for" in line]
    assert [line.split()[-1] for line in told] == ["ON", "s", "OFF"]
    assert "places" not in done.output


def test_it_is_among_the_words():
    assert action_entries()["PING"].summary == "sets an output for 0.1 s"
    assert "PING" in words().commands
    assert "PING" not in registry.commands()
