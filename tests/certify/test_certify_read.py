"""Tests of the reader: it reads texts of the emitter, number by number, and refuses all other texts at a
line.
"""

import re

import numpy as np
import pytest
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.certify.certify_bench import everything, industrial6
from yarclang.certify.pmac.own import own_of
from yarclang.certify.pmac.read import read
from yarclang.certify.read.numbers import read_numbers
from yarclang.certify.read.text import ControllerText, Run, Stood, Unreadable
from yarclang.memory import Recent

CONTROLLER = industrial6().controller


@pytest.mark.parametrize("target", ["rotary", "prog"])
def test_what_was_emitted(target):
    case = everything()
    text = read(case.text(target), CONTROLLER)
    assert isinstance(text, ControllerText)
    assert text.target == target
    assert text.decimals == 9
    assert [run.segment_ms for run in text.runs] == [50.0, 47.5, 50.0]
    units = case.robot.axis_units
    wanted = np.concatenate([job.points for job in case.jobs if job.points is not None]) / units
    printed = np.concatenate([run.points for run in text.runs])
    distinct = np.r_[True, np.abs(np.diff(printed, axis=0)).max(axis=1) > 0]
    kept = np.r_[True, np.abs(np.diff(wanted.round(9), axis=0)).max(axis=1) > 0]
    assert np.abs(printed[distinct] - wanted[kept]).max() <= 0.6e-9
    lines = case.text(target).split("\n")
    for run in text.runs:
        assert all(lines[line - 1].startswith("X") for line in run.lines)
    assert [(entry.step, entry.name) for entry in text.entries][-1] == (8, "STOP")
    assert text.entries[-1].first is None
    if target == "rotary":
        assert np.allclose(text.start.printed, case.start / units)
    else:
        assert np.allclose(own_of(text).guard.width, 3072)
        assert own_of(text).guard.place[5] < 0


@pytest.mark.parametrize(
    ("form", "value"),
    [("-5", 5.0), ("+5", -5.0), ("-(-5)", -5.0), ("-0.25", 0.25), ("-5*2", None), ("--5", None)],
)
def test_the_guard_compares_with_a_number(form, value):
    lines = everything().text("prog").split("\n")
    place = next(i for i, line in enumerate(lines) if line.startswith("IF(ABS(M361"))
    lines[place] = f"IF(ABS(M361{form})>3072)"
    text = read("\n".join(lines), CONTROLLER)
    if value is None:
        assert isinstance(text, Unreadable)
        assert text.line == place + 1
    else:
        assert own_of(text).guard.place[2] == value


REFUSED = [  # target, beginning of a line, its replacement (None: the line is left out)
    ("rotary", "; target", "; target tape"),
    ("rotary", "; target", None),
    ("rotary", "; command 3", "; command three"),
    ("rotary", "; command 3", "; command 3 P0004 MOVEL 4 12 -"),
    ("rotary", "CLOSE ALL", None),
    ("rotary", "END GATHER", "END  GATHER"),
    ("rotary", "&1", "&2"),
    ("rotary", "&1", "&1B0R"),
    ("rotary", "#1J/", "#1J/#2J/#3J/#4J/#5J/"),
    ("rotary", "#1J/", "#1J+#2J/#3J/#4J/#5J/#6J/"),
    ("rotary", "DEFINE ROT", "DEFINE ROT"),
    ("rotary", "DEFINE ROT", None),
    ("rotary", "I16=", None),
    ("rotary", "I17=", "I17=1\nI17=1"),
    ("rotary", "I16=", "I15=0"),
    ("rotary", "; robot", None),
    ("rotary", "; start", None),
    ("rotary", "; sha256", "; sha256 0"),
    ("rotary", "; command 0", "; a remark\n; command 0"),
    ("rotary", "TM47.5", "; a remark\nTM47.5"),
    ("rotary", "B0", None),
    ("rotary", "CLEAR", None),
    ("rotary", "RAPID", "LINEAR"),
    ("rotary", "ABS", "INC"),
    ("rotary", "DWELL0", "X0Y0Z0A0B0C0"),
    ("rotary", "SPLINE1", "SPLINE2"),
    ("rotary", "TM50", None),
    ("rotary", "TM50", "TM-50"),
    ("rotary", "TM50", "TM50\nTM47.5"),
    ("rotary", "TM47.5", "TM50"),
    ("rotary", "TM47.5", "DWELL0"),
    ("rotary", "TM47.5", "R"),
    ("rotary", "TM47.5", "TM47.5\nM1==1"),
    ("rotary", "TM47.5", "M1==1\nTM47.5"),
    ("rotary", "TM47.5", "M1==1\n; a remark\nM2==0\nDWELL0"),
    ("rotary", "CLOSE", "M1==1\nCLOSE"),
    ("rotary", "TM47.5", "P8101=1"),
    ("rotary", "TM47.5", "P8100=2"),
    ("rotary", "TM47.5", "; command 9 P1 MOVEL 1 2 3"),
    ("rotary", "TM47.5", "X1Y2Z3A4B5C6 ; remark"),
    ("rotary", "TM47.5", ""),
    ("rotary", "TM47.5", "garbage"),
    ("rotary", "CLOSE", None),
    ("rotary", "CLOSE", "CLOSE\nR"),
    ("rotary", "CLOSE", "CLOSE\nCLOSE"),
    ("prog", "OPEN PROG", "OPEN PROG 1"),
    ("prog", "OPEN PROG", "OPEN PROG 0 CLEAR"),
    ("prog", "WHILE", None),
    ("prog", "IF(ABS(M261", "IF(ABS(M262-0)>3072)"),
    ("prog", "IF(ABS(M261", "IF(ABS(M361-0)>3072)"),
    ("prog", "SEND", 'CMD"#1J+"'),
    ("prog", "SEND", 'SEND"a"CMD"#1J+"'),
    ("prog", "ENDIF", None),
    ("prog", "STOP", None),
    ("prog", "ABS", "INC"),
]


@pytest.mark.parametrize(("target", "begins", "becomes"), REFUSED)
def test_refused_lines(target, begins, becomes):
    lines = everything().text(target).split("\n")
    # Change the last CLOSE, and of all other lines the first one.
    order = reversed(range(len(lines))) if begins == "CLOSE" else range(len(lines))
    place = next(
        i for i in order if lines[i].startswith(begins) and (begins != "CLOSE" or lines[i] == "CLOSE")
    )
    lines[place : place + 1] = [] if becomes is None else becomes.split("\n")
    found = read("\n".join(lines), CONTROLLER)
    assert isinstance(found, Unreadable)
    assert found.code == "Y1151"
    if begins != "; target":
        # The error is reported at the line, or at the next line if the line is missing.
        assert place + 1 <= found.line <= place + 2
    if becomes in ("R", "CLOSE\nR"):
        assert "starts the motion by itself" in found.reason


@pytest.mark.parametrize(
    "becomes",
    """XnanY0Z0A0B0C0 XinfY0Z0A0B0C0 X1e3Y0Z0A0B0C0 X1Y0Z0A0B0 Y1X0Z0A0B0C0 X1Y0Z0A0B0C0R X1Y0Z0A0B0C0U0
    X--1Y0Z0A0B0C0 X1.Y0Z0A0B0C0 X.5Y0Z0A0B0C0 X(1)Y0Z0A0B0C0 X99999999Y0Z0A0B0C0 x1Y0Z0A0B0C0 X+1Y0Z0A0B0C0
    X1Y0Z0A0B0C0; X1_Y0Z0A0B0C0 X1Y0Z0A0B0C0\r X1Y0Z0A0B0C0\x00""".replace("\n    ", " ").split(" "),
)
def test_refused_move_lines(becomes):
    lines = everything().text().split("\n")
    moves = [i for i, line in enumerate(lines) if line.startswith("X")]
    for place in (moves[0], moves[1], moves[100], moves[-1]):
        changed = [*lines]
        changed[place] = becomes
        found = read("\n".join(changed), CONTROLLER)
        assert isinstance(found, Unreadable)
        assert found.line == place + 1


@pytest.mark.parametrize(
    ("tm", "kept"),
    [
        ("50", True),
        ("0.000244140625", True),
        ("4095.999755859375", True),
        ("49.999755859375", True),
        ("4096", False),
        ("0", False),
        ("50.0001", False),
        ("0.00012207031", False),
        ("47.571411132812", False),
    ],
)
def test_segment_times_are_exact(tm, kept):
    found = read(everything().text().replace("TM47.5\n", f"TM{tm}\n"), CONTROLLER)
    if tm == "50":  # a segment time of the neighbouring sequence, which can't be distinguished
        assert isinstance(found, Unreadable)
        assert found.code == "Y1151"
    elif kept:
        assert found.runs[1].segment_ms == float(tm)
    else:
        assert (found.code, found.line) == ("Y1152", everything().text().split("\n").index("TM47.5") + 1)


def test_text_of_other_kinds():
    text = everything().text()
    assert read(text.replace("a free remark", "eine freie Äußerung"), CONTROLLER).line == 5
    assert isinstance(read(text[:-1], CONTROLLER), Unreadable)
    assert isinstance(read("", CONTROLLER), Unreadable)
    assert isinstance(read(text.replace("\n", "\r\n"), CONTROLLER), Unreadable)
    guarded = read(text, CONTROLLER)
    arms = [one.on for one in own_of(guarded).arms]
    assert arms == [True, *[False] * (len(arms) - 1)]
    older = read(text.replace("P8100=P8100&2", "P8100=0"), CONTROLLER)
    assert "older texts have P8100=0" in older.reason
    assert isinstance(read(text.replace("TM50\n", "TM50\n; a remark\n", 1), CONTROLLER), Unreadable)


@pytest.mark.parametrize(
    "character",
    ["\r", "\v", "\f", "\x1b", "\x1c", "\x1d", "\x1e", "\x85", "\xa0", "\u2028", "\0", "\t", "\x7f"],
)
@pytest.mark.parametrize("target", ["rotary", "prog"])
def test_characters_that_end_a_line_for_some(target, character):
    """Some programs treat these characters as line ends, so other lines would be sent than judged. They are
    refused by name and place.
    """
    lines = everything().text(target).split("\n")
    for place in (3, lines.index("CLOSE ALL"), len(lines) - 3):
        changed = [*lines]
        changed[place] += f"{character}#1J+"
        found = read("\n".join(changed), CONTROLLER)
        assert isinstance(found, Unreadable)
        assert found.line == place + 1
        assert f"0x{ord(character):02X}) in column {len(lines[place]) + 1}" in found.reason


@pytest.mark.parametrize("target", ["rotary", "prog"])
def test_the_lines_that_are_sent_are_those_that_were_read(target):
    """Each line of the text, except for its header, is sent once and in order."""
    whole = everything().text(target)
    text = read(whole, CONTROLLER)
    if target == "prog":
        assert (own_of(text).setup, own_of(text).loaded, own_of(text).marks) == ((), (), None)
        return
    lines = whole.split("\n")[:-1]
    loaded = [numbered for sent in own_of(text).loaded for numbered in sent.numbered()]
    assert all(lines[number - 1] == line for number, line in loaded)
    assert [*own_of(text).setup, "OPEN ROT", "CLEAR", *(line for _, line in loaded), "CLOSE"] == [
        line for line in lines if not line.startswith(";")
    ]


def edited(data, text, least):
    """Change a text at a place from `least` on: replace a digit, or replace a part of the text
    by anything.
    """
    if data.draw(st.booleans()):
        at = data.draw(st.sampled_from([one.start() for one in re.finditer(r"\d", text[least:])])) + least
        return text[:at] + data.draw(st.sampled_from("0123456789")) + text[at + 1 :]
    first = data.draw(st.integers(least, len(text)))
    last = min(len(text), first + data.draw(st.integers(0, 200)))
    return text[:first] + data.draw(st.text(alphabet="XYZABCRTM01579.-+;()=&#\n ", max_size=12)) + text[last:]


@exercises(text=0.1, refusal=0.1)
@settings(max_examples=150, deadline=None)
@given(st.data())
def test_never_raises(tally, data):
    """Whatever is changed, the result is a text or an Unreadable."""
    text = everything().text(data.draw(st.sampled_from(["rotary", "prog"])))
    found = read(edited(data, text, 0), CONTROLLER)
    assert isinstance(found, ControllerText | Unreadable)
    tally.count("text", isinstance(found, ControllerText))
    tally.count("refusal", isinstance(found, Unreadable))
    if isinstance(found, Unreadable):
        assert 1 <= found.line <= text.count("\n") + 14
        assert found.reason


REMEMBERED = Recent(10_000)
"""Cache for all texts below, many of whose lines are equal."""


@exercises(text=0.1, refusal=0.1)
@settings(max_examples=100, deadline=None)
@given(st.data())
def test_what_was_read_before_is_read_as_afresh(tally, data):
    """Numbers, lines and refusals don't depend on texts that were read before, even if a text was changed in
    the middle of moves.
    """
    text = everything().text()
    changed = edited(data, text, text.index("SPLINE1"))
    found, afresh = read(changed, CONTROLLER, REMEMBERED), read(changed, CONTROLLER)
    tally.count("text", not isinstance(afresh, Unreadable))
    tally.count("refusal", isinstance(afresh, Unreadable))
    if isinstance(afresh, Unreadable):
        assert found == afresh
        return
    assert isinstance(found, ControllerText)
    assert (found.entries, found.outputs, found.decimals) == (
        afresh.entries,
        afresh.outputs,
        afresh.decimals,
    )
    for one, other in zip(found.course, afresh.course, strict=True):
        if isinstance(other, Run):
            assert (one.segment_ms, one.tm_line, one.puts) == (other.segment_ms, other.tm_line, other.puts)
            assert np.array_equal(one.points, other.points)
            assert np.array_equal(one.lines, other.lines)
        elif not isinstance(other, Stood):
            assert one == other


WRITTEN = st.from_regex(r"-?[0-9]{1,7}(\.[0-9]{1,12})?", fullmatch=True)


@given(st.lists(st.tuples(WRITTEN, WRITTEN, WRITTEN), min_size=1, max_size=40), st.sampled_from([1, 1000]))
def test_numbers_are_the_floats_nearest_to_what_is_written(rows, times):
    rows = (rows * times)[:2000]
    values, decimals = read_numbers("".join("X{}Y{}C{}\n".format(*row) for row in rows), 3)
    assert values.tobytes() == np.array([[float(one) for one in row] for row in rows]).tobytes()
    assert decimals == max(len(one.partition(".")[2]) for row in rows for one in row)
