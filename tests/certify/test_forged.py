"""Tests of forged texts, which do something other than their program says. They aren't carried out, and each
gives one clear finding.
"""

import re
from functools import cache

import pytest
from click.testing import CliRunner

import yarclang
from tests.certify.forging import Forger
from yarclang.cli.commands.check import command as check
from yarclang.cli.commands.run import command as run
from yarclang.pipeline import stages

HEAD = "ROBOT INDUSTRIAL6\nDEFAULT {TCP} [2] (mm,deg,s) {B}\n"
PROGRAMS = {
    "rotary": HEAD + "P0010 MOVEJ 20 0 0 0 -30 0\nP0020 DMOVE 0 0 -60 0 0 0\nP0030 MOVEJ HOME\n",
    "barriers": HEAD
    + "INPUT DOOR M11\nOUTPUT GLUE M1 OFF\nP0010 MOVEJ 20 0 0 0 -30 0\nP0020 SET GLUE ON\nP0030 WAIT [0.5]\n"
    'P0040 WAIT DOOR ON [5]\nP0050 DMOVE 0 0 -40 0 0 0\nWHEN DOOR ON\nP0060 MOVEJ HOME\nELSE\nP0070 HOLD "look"\n'  # noqa: E501
    "P0080 MOVEJ HOME\nEND\nP0090 PULSE GLUE [0.5]\nP0100 MOVEJ 5 0 0 0 0 0\n",
    "blends": HEAD + "OUTPUT GLUE M1 OFF\n"
    "P0010 MOVEJ 20 0 0 0 -30 0 BLEND 5\n"
    "P0020 DMOVE 0 0 -60 0 0 0 BLEND 10\n"
    "P0030 SET GLUE ON\n"
    "P0040 DMOVE 60 0 0 0 0 0\n"
    "P0050 DMOVE 0 0 80 0 0 0 [V 50]\n",
    "TOPP": HEAD
    + "P0010 MOVEJ_TOPP 40 10 -10 0 -30 0 [MIN]\nP0020 DMOVE_TOPP 0 0 -80 0 0 0 [MIN]\nP0030 MOVEJ HOME\n",
    "timed": HEAD
    + "P0010 MOVEJ_TIMED 20 0 0 0 -10 0 [1]; 40 10 -10 0 -30 0 [2.5] (deg,s)\nP0020 DMOVE 0 0 -60 0 0 0\n"
    "P0030 MOVEJ_TIMED 20 0 0 0 -10 0 [1.5] VEL -10 0 0 0 10 0; 0 0 0 0 0 0 [3] VEL 0 0 0 0 0 0 (deg,s)\n",
    "prog": HEAD + "INPUT DOOR M11\n"
    "OUTPUT GLUE M1 OFF\n"
    "P0010 MOVEJ 20 0 0 0 -30 0\n"
    "P0020 SET GLUE ON\n"
    "P0030 WAIT DOOR ON [5]\n"
    "P0040 DMOVE 0 0 -40 0 0 0\n"
    "P0050 WAIT [0.5]\n"
    "P0060 MOVEJ HOME\n",
}
ROTARY = ("rotary", "barriers", "blends", "TOPP", "timed")
ALL = tuple(PROGRAMS)
LIMIT = "X169.9Y0Z0A0B0C0"
"""A position just before a limit switch."""


@pytest.fixture(scope="module", autouse=True)
def planned_once():
    """Plan each program only once, because only texts are changed."""
    known = {}
    plan = stages.plan_program

    def remembered(program, request):
        if any(one is not None for one in (request.cell, request.start, request.fallback_start)):
            return plan(program, request)
        source = program.source
        key = source.name, source.text, request.robot, request.target, request.tm, request.tolerance
        if key not in known:
            known[key] = plan(program, request)
        return known[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(stages, "plan_program", remembered)
        yield


@cache
def original(name):
    made = yarclang.compile(PROGRAMS[name], name="p.yarc", target="prog" if name == "prog" else "rotary")
    assert made.value is not None, made.diagnostics
    return Forger.of(made.value.text)


def first_move(text):
    return text.moves()[0]


def in_header(text):
    return text.find("; command 0 .*")


def jump(text):
    """Insert a RAPID to another position and back, where the robot rests."""
    place = text.find("CLOSE")
    here = re.sub(r"(?<=\d)$", "", text.lines[text.moves()[-1]])
    there = ("RAPID", "ABS", LIMIT, "DWELL0", "SPLINE1", "RAPID", "ABS", here, "DWELL0", "SPLINE1")
    return text.put(place, "DWELL0", *there)


def with_letter(line, letter, value):
    return re.sub(rf"{letter}-?[0-9.]+", f"{letter}{value}", line)


def point(row, letter, value):
    def change(text):
        place = text.moves()[row]
        changed = with_letter(text.lines[place], letter, value)
        return Forger((*text.lines[:place], changed, *text.lines[place + 1 :]))

    return change


def swapped_points(text):
    one, other = text.moves()[4:6]
    lines = [*text.lines]
    lines[one], lines[other] = lines[other], lines[one]
    return Forger(tuple(lines))


def late_arm(text):
    dropped = text.drop(text.find("P8100=1"))
    return dropped.put(dropped.moves()[6], "P8100=1")


def early_disarm(text):
    dropped = text.drop(text.find("P8100=P8100&2"))
    return dropped.put(dropped.moves()[-1], "P8100=P8100&2")


def never_disarmed(text):
    while any(line == "P8100=P8100&2" for line in text.lines):
        text = text.drop(text.find("P8100=P8100&2"))
    return text


def moved_barrier(text):
    """Swap a wait with the next barrier."""
    lines = [*text.lines]
    one, other = text.find("; barrier .* wait .*"), text.find("; barrier .* when .*")
    numbers = [re.match(r"; barrier (\d+)", lines[k])[1] for k in (one, other)]
    for k, number in ((one, numbers[1]), (other, numbers[0])):
        lines[k] = re.sub(r"; barrier \d+", f"; barrier {number}", lines[k])
    return Forger(tuple(lines))


CHANGES = {
    # control characters
    "vertical tab and a move in the header": (ALL, lambda t: t.put(in_header(t), "; hi\vX30Y0Z0A0B0C0")),
    "vertical tab and a jog": (ALL, lambda t: t.put(t.find("CLOSE ALL"), "; hi\v#1J+")),
    "form feed": (ALL, lambda t: t.change("; made with (.*)", r"; made with \1" + "\fR")),
    "file separator": (ALL, lambda t: t.change("END GATHER", "END GATHER\x1cR")),
    "next line": (ALL, lambda t: t.change("SPLINE1", "SPLINE1\x85#1J+")),
    "carriage return": (ALL, lambda t: t.change("CLOSE", "CLOSE\rR")),
    "line separator": (ALL, lambda t: t.change("; made with (.*)", r"; made with \1" + "\u2028R")),
    "escape": (ALL, lambda t: t.change("; made with (.*)", r"; made with \1" + "\x1b[2J")),
    # lines that don't belong there
    "a comment in the body": (ALL, lambda t: t.put(first_move(t), "; hi")),
    "a comment in the header": (ALL, lambda t: t.put(in_header(t), "; hi")),
    "a jog in the setup": (ALL, lambda t: t.put(t.find("CLOSE ALL"), "#1J+")),
    "an R behind": (ALL, lambda t: t.put(len(t.lines), "R")),
    "another system": (ALL, lambda t: t.change("&1", "&2")),
    "an address with R": (ALL, lambda t: t.change("&1", "&1B1R")),
    "another spline": (ALL, lambda t: t.change("SPLINE1", "SPLINE2")),
    "lines instead of splines": (ALL, lambda t: t.change("SPLINE1", "LINEAR")),
    "increments": (ALL, lambda t: t.change("ABS", "INC")),
    "motors aren't closed": (ROTARY, lambda t: t.drop(t.find("#1J/.*"))),
    "cut": (ALL, lambda t: Forger(t.lines[:-20])),
    "empty lines": (ALL, lambda t: t.put(first_move(t), "")),
    "a very long line": (ALL, lambda t: t.put(first_move(t), "X" + "1" * 300)),
    # assignments
    "a limit in the setup": (ALL, lambda t: t.put(t.find("CLOSE ALL"), "I122=999999")),
    "a limit in the body": (ALL, lambda t: t.put(first_move(t), "I122=999999")),
    "a limit at rest": (ALL, lambda t: t.put(t.find("CLOSE"), "DWELL0", "I122=999999")),
    "a limit in the safe values": (
        ("barriers", "blends", "prog"),
        lambda t: t.put(t.find("ENDIF"), "I122=999999"),
    ),
    "a motor's register": (ALL, lambda t: t.put(t.find("CLOSE"), "DWELL0", "M161=0")),
    "a motor's register in the safe values": (
        ("barriers", "blends", "prog"),
        lambda t: t.put(t.find("ENDIF"), "M161=0"),
    ),
    "a reported position": (ALL, lambda t: t.put(t.find("CLOSE"), "DWELL0", "P1=0")),
    "the guard's flag is 2": (ALL, lambda t: t.put(t.find("CLOSE"), "DWELL0", "P8100=2")),
    # the guard
    "never armed": (ROTARY, lambda t: t.change("P8100=1", "P8100=P8100&2")),
    "not armed": (ROTARY, lambda t: t.drop(t.find("P8100=1"))),
    "armed late": (ROTARY, late_arm),
    "disarmed at once": (ROTARY, lambda t: t.put(t.find("P8100=1") + 1, "P8100=P8100&2")),
    "disarmed early": (ROTARY, early_disarm),
    "disarmed, and too few lines follow": (ROTARY, lambda t: t.drop(t.find("P8100=P8100&2"))),
    "never disarmed": (ROTARY, never_disarmed),
    "low mark": (ROTARY, lambda t: t.change("I16=.*", "I16=0")),
    "full mark": (ROTARY, lambda t: t.change("I17=.*", "I17=1")),
    "marks beyond the buffer": (ROTARY, lambda t: t.change("I17=.*", "I17=99999")),
    "a small buffer": (ROTARY, lambda t: t.change("DEFINE ROT .*", "DEFINE ROT 20")),
    "armed in a program buffer": (("prog",), lambda t: t.put(first_move(t), "P8100=1")),
    # moves
    "a RAPID to a limit switch and back": (ALL, jump),
    "a point beyond the limits": (ALL, point(10, "X", 175)),
    "a point ten thousand turns away": (ALL, point(10, "C", 9999999)),
    "a point too far": (ALL, point(10, "Y", 1.5)),
    "two points in the wrong order": (ALL, swapped_points),
    "not at rest at the end": (ALL, point(-1, "Z", 3)),
    "half the segment time": (ALL, lambda t: t.all(r"TM.*", "TM4")),
    "a segment time that isn't kept": (ALL, lambda t: t.change("TM.*", "TM7.3")),
    "a start elsewhere": (ROTARY, lambda t: t.change("X0Y0Z0A0B0C0", "X0Y0Z0A0B5C0")),
    "a start beyond the limits": (ROTARY, lambda t: t.change("X0Y0Z0A0B0C0", "X200Y0Z0A0B0C0")),
    "a start that waits for nothing": (
        ("prog",),
        lambda t: t.change(r"IF\(ABS\(M161.*", "IF(ABS(M161-0)>99999999)"),
    ),
    # the map and the header
    "another duration": (ALL, lambda t: t.change(r"; duration [0-9.]+ s(.*)", r"; duration 1.000 s\1")),
    "another start in the header": (ALL, lambda t: t.change("; start X0.000000(.*)", r"; start X1.000000\1")),
    "another robot": (ALL, lambda t: t.change(r"; robot (\S+) .*", r"; robot \1 " + "0" * 64)),
    "another target": (ALL, lambda t: t.change("; target rotary|; target prog", "; target tape")),
    "the other target": (ROTARY, lambda t: t.change("; target rotary", "; target prog")),
    "a number of five thousand digits": (
        ALL,
        lambda t: t.change("(; command )0( .*)", r"\g<1>" + "9" * 5000 + r"\2"),
    ),
    "another step": (ALL, lambda t: t.change("(; command )1( .*)", r"\g<1>7\2")),
    "lines of the map": (ALL, lambda t: t.change(r"(; command 0 .* )(\d+)( .*)?", r"\g<1>999999\3")),
    "a motion less in the map": (ALL, lambda t: t.drop(in_header(t))),
    "a blend less": (("blends",), lambda t: t.change("(; command 0 .*) blend .*", r"\1")),
    "an odd blend": (("blends",), lambda t: t.change("(; command 0 .*) blend .*", r"\1 blend 7")),
    # between motions
    "a dwell less": (("barriers",), lambda t: t.drop(t.find("DWELL0", 1))),
    "a barrier less": (("barriers",), lambda t: t.drop(t.find("STOP"))),
    "a barrier that isn't one": (("barriers",), lambda t: t.change("STOP", "DWELL0")),
    "barriers that change places": (("barriers",), moved_barrier),
    "a barrier of no command": (
        ("barriers",),
        lambda t: t.change(r"(; barrier \d+ wait )\d+(.*)", r"\g<1>99\2"),
    ),
    "a way without an end": (
        ("barriers",),
        lambda t: t.change(r"(; barrier \d+) end (\d+).*", r"\1 hold \2 - - x"),
    ),
    "a wait for a motor's register": (
        ("barriers",),
        lambda t: t.change("(; barrier .* wait .*) M11=1 (.*)", r"\1 M161=1 \2"),
    ),
    "a wait for a command": (
        ("barriers",),
        lambda t: t.change("(; barrier .* wait .*) M11=1 (.*)", r"\1 #1J+=1 \2"),
    ),
    "a time that is no number": (
        ("barriers",),
        lambda t: t.change("(; barrier .* wait .* M11=1) 5 (.*)", r"\1 5.5.5 \2"),
    ),
    "a slow RAPID elsewhere": (("barriers",), lambda t: t.change(r"(X.*)", LIMIT, t_number_of_stand(t))),
    "an output while it moves": (("rotary", "TOPP"), lambda t: t.put(t.moves()[5], "M1==1")),
    "a wait that is over at once": (
        ("prog",),
        lambda t: t.change(r"WHILE\(M11!=1 AND .*", "WHILE(M11!=1 AND I5111>5000)WAIT"),
    ),
    "a wait without a stop": (("prog",), lambda t: t.drop(t.find("STOP", 1))),
    "no comparison of the start": (("prog",), lambda t: t.change("P8101=1", "P8101=0")),
}
"""Changes, and the texts to which they apply. They are refused with and without the program."""

WITH_PROGRAM = {
    "a condition the other way round": (
        ("barriers",),
        lambda t: t.all("(; barrier .*) M11=1 (.*)", r"\1 M11=0 \2"),
    ),
    "a wait for another input": (
        ("barriers",),
        lambda t: t.all("(; barrier .* wait .*) M11=1 (.*)", r"\1 M12=1 \2"),
    ),
    "a longer wait": (("barriers",), lambda t: t.change("(; barrier .* wait .* M11=1) 5 (.*)", r"\1 500 \2")),
    "a wait for ever": (("barriers",), lambda t: t.change("(; barrier .* wait .* M11=1) 5 (.*)", r"\1 - \2")),
    "a wait instead of a way": (("barriers",), lambda t: t.change("(; barrier .*) wait (.*)", r"\1 when \2")),
    "another text for the operator": (
        ("barriers",),
        lambda t: t.change("(; barrier .* hold .*) look", r"\1 go on"),
    ),
    "an output that stays off": (("barriers", "prog"), lambda t: t.change("M1=1", "M1=0")),
    "another output": (("barriers", "prog"), lambda t: t.change("M1=1", "M2=1")),
    "an output less": (("barriers", "prog"), lambda t: t.drop(t.find("M1=1"))),
    "an output in a blend the other way round": (("blends",), lambda t: t.change("M1==1", "M1==0")),
    "no safe values": (("barriers", "blends", "prog"), lambda t: t.drop(t.find("OPEN PLC 28 CLEAR"), 6)),
    "another safe value": (("barriers", "blends", "prog"), lambda t: t.change("M1=0", "M1=1")),
    "a blend that isn't": (
        ("rotary", "TOPP"),
        lambda t: t.change(r"(; command 0 [^b]*\d)( any-jerk)?", r"\1 blend 4\2"),
    ),
    "a dwell that is shorter": (("barriers", "prog"), lambda t: t.change("DWELL500", "DWELL5")),
    "a dwell more": (ALL, lambda t: t.put(t.find("CLOSE"), "DWELL1000")),
    "a point beside the path": (ALL, lambda t: t.scaled(1.0005)),
    "twice as slow": (
        ("rotary", "prog"),
        lambda t: t.all(r"TM.*", "TM100").change(r"; duration [0-9.]+ s(.*)", ""),
    ),
    "another index": (ALL, lambda t: t.change("(; command 0 )P0010( .*)", r"\1P0011\2")),
    "another command": (ALL, lambda t: t.change(r"(; command 0 P0010 )\S+( .*)", r"\1MOVEL\2")),
    "any jerk": (("rotary", "blends", "prog"), lambda t: t.change(r"(; command 0 .*)", r"\1 any-jerk")),
}
"""Changes that are noticed only with the program."""


def t_number_of_stand(text):
    """Return the number of the first move line after a barrier's RAPID, counted over all lines that begin
    with X.
    """
    rapid = text.find("RAPID", 1)
    return sum(line.startswith("X") for line in text.lines[: rapid + 2])


def cases(changes):
    return [
        pytest.param(name, change, id=f"{name}-{what}".replace(" ", "_"))
        for what, (names, change) in changes.items()
        for name in names
    ]


def errors(found):
    return [one for one in found if one.is_error]


def refused(command, text, folder):
    """Check that `yarc check` or `yarc run --dry-run` refuses a text: exit status 1, and a single finding."""
    (folder / "p.pmc").write_bytes(text.encode("utf-8", "surrogatepass"))
    # No controller has this address: errors in a text are found before a connection is made.
    words = ["p.pmc", "--dry-run", "--to", "tcp://127.0.0.1:1"] if command is run else ["p.pmc"]
    done = CliRunner().invoke(command, words)
    assert done.exit_code == 1, done.output
    assert not done.exception or isinstance(done.exception, SystemExit)
    assert len(re.findall(r"(?m)^p\.pmc\S*: error Y\d{4}: ", done.output)) == 1, done.output
    assert "error Y1169" not in done.output, "only the seal has shown it"
    assert "help: " in done.output


@pytest.mark.parametrize("name", ALL)
def test_what_yarcc_wrote_is_accepted(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = original(name).text
    (tmp_path / "p.pmc").write_text(text)
    alone = yarclang.prove(text)
    assert alone.value is not None
    assert [one.code for one in alone.diagnostics] == ["Y1193"]
    assert yarclang.prove(text, PROGRAMS[name]).ok
    assert CliRunner().invoke(check, ["p.pmc"]).exit_code == 0
    (tmp_path / "p.yarc").write_text(PROGRAMS[name])
    done = CliRunner().invoke(check, ["p.pmc"])
    assert (done.exit_code, "Y1193" in done.output) == (0, False)


@pytest.mark.parametrize(("name", "change"), cases(CHANGES))
def test_a_forged_text_is_refused(name, change, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = change(original(name)).text
    assert text != original(name).text
    assert yarclang.prove(text, PROGRAMS[name]).value is None
    alone = yarclang.prove(text)
    assert alone.value is None
    assert len(errors(alone.diagnostics)) == 1
    assert errors(alone.diagnostics)[0].code != "Y1169"
    refused(run, text, tmp_path)
    (tmp_path / "p.yarc").write_text(PROGRAMS[name])
    refused(check, text, tmp_path)


@pytest.mark.parametrize(("name", "change"), cases(WITH_PROGRAM))
def test_a_text_that_does_something_else_than_its_program_is_refused(name, change, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = change(original(name)).text
    assert text != original(name).text
    assert yarclang.prove(text, PROGRAMS[name]).value is None
    (tmp_path / "p.yarc").write_text(PROGRAMS[name])
    refused(run, text, tmp_path)


def test_links_that_meet_are_refused_without_the_program(tmp_path, monkeypatch):
    """All points are scaled, slowly enough for all limits, so that link 5 enters link 1."""
    program = HEAD + "P0010 MOVEJ 0 40 -80 0 0 0 [20]\n"
    text = Forger.of(yarclang.compile(program).value.text)
    assert yarclang.prove(text.text).value is not None
    forged = text.scaled(2.1)
    (finding,) = errors(yarclang.prove(forged.text).diagnostics)
    assert finding.code.startswith("Y09")


def test_a_text_without_its_program_says_what_it_waits_for_and_sets():
    (note,) = yarclang.prove(original("barriers").text).diagnostics
    assert note.severity == "warning"
    assert re.search(r"what it waits for \('M11=1' in line \d+, 'M11=1' in line \d+\)", note.message)
    assert "M1=0 in the PLC of safe values, M1=1 in line " in note.message
    (note,) = yarclang.prove(original("TOPP").text).diagnostics
    assert "the jerk of 2 commands" in note.message
