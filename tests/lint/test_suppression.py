"""Tests of comments that suppress findings, at the end of a line or alone above it. Needless and impossible
ones are reported.
"""

import pytest

from yarclang.diagnostics import Diagnostic
from yarclang.lint.suppression import suppress
from yarclang.pipeline.checking import check_text
from yarclang.pipeline.inputs import Options
from yarclang.source import SourceFile, Span

NOWHERE = "P0010 MOVEJ HOME [5] (s)"
"""A motion that goes nowhere, which is the finding Y0603."""


def check(text, folder, **how):
    return check_text(SourceFile("test.yarc", text), folder, Options(robot="INDUSTRIAL6"), **how).diagnostics


def codes(text, folder, **how):
    return [one.code for one in check(text, folder, **how)]


@pytest.mark.parametrize(
    "text",
    [
        f"{NOWHERE} ! yarc: ignore[Y0603]",
        f"{NOWHERE} !YARC:IGNORE [ y0603 ]",
        f"{NOWHERE} ! yarc: ignore[no-motion] it stands there already",
        f"! yarc: ignore[Y0603]\n\n! another comment\n{NOWHERE}",
    ],
)
def test_a_finding_is_suppressed(text, tmp_path):
    assert codes(NOWHERE, tmp_path) == ["Y0603"]
    assert codes(text, tmp_path) == []


@pytest.mark.parametrize("line", [1, 2, 3, 4])
def test_a_finding_of_many_lines_is_suppressed_in_each_of_them(line):
    lines = ["P0010 WAIT 1;" for _ in range(4)]
    lines[line - 1] += " ! yarc: ignore[Y0603]"
    source = SourceFile("test.yarc", "\n".join(lines))
    finding = Diagnostic("Y0603", "nowhere", source, Span(1, 1, 3, 5))
    assert suppress(source, [finding], is_whole=False) == (() if line < 4 else (finding,))
    assert [one.code for one in suppress(source, [finding])] == ([] if line < 4 else ["Y0603", "Y1701"])


def test_of_many_wrong_words_in_a_comment_the_first_are_told(tmp_path):
    words = ",".join(f"Y0{number}x" for number in range(1_000))
    found = check(f"P0010 STOP ! yarc: ignore[{words}]", tmp_path)
    assert [one.code for one in found if one.code == "Y1702"] == ["Y1702"] * 20
    assert found[-1].message == "there is no finding Y019x; 980 more like it in this line"
    assert all(one.help for one in found)


def test_only_on_its_line_and_only_its_code(tmp_path):
    text = f"{NOWHERE} ! yarc: ignore[Y0603]\nP0020 MOVEJ HOME [5] (s)"
    assert [(one.code, one.span.line) for one in check(text, tmp_path)] == [("Y0603", 2)]
    assert codes(f"{NOWHERE} ! yarc: ignore[Y0611]", tmp_path) == ["Y0603", "Y1701"]


def test_two_codes_of_which_one_is_needless(tmp_path):
    (one,) = check(f"{NOWHERE} ! yarc: ignore[Y0603, Y0611]", tmp_path)
    assert one.code == "Y1701"
    assert (one.span.column, one.span.end_column) == (48, 53)


def test_errors_stay(tmp_path):
    found = check("P0010 MOVEJ 200 0 0 0 0 0 [5] (deg,s) ! yarc: ignore[Y0502]", tmp_path)
    assert sorted(one.code for one in found) == ["Y0502", "Y1702"]


@pytest.mark.parametrize("words", ["", "[]", "[Y0603", "[Y06]", "[Y9999]", "[nothing]"])
def test_what_cannot_be_meant(words, tmp_path):
    assert "Y1702" in codes(f"{NOWHERE} ! yarc: ignore{words}", tmp_path)


def test_what_was_not_looked_for_is_not_called_needless(tmp_path):
    moves = "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s) ! yarc: ignore[Y0603]"
    assert codes(moves, tmp_path) == ["Y1701"]
    assert codes(moves, tmp_path, plans=False) == []
    assert codes(f"{moves}\nP0020 MOVEK", tmp_path) == ["Y0202"]


def test_a_text_in_quotes_is_no_comment(tmp_path):
    assert codes('P0010 HOLD "! yarc: ignore[Y0603]"', tmp_path) == []


@pytest.mark.parametrize(
    ("settings", "expected"),
    [
        ('Y0603 = "off"', []),
        ('no-motion = "note"', [("Y0603", "note")]),
        ('Y06 = "off"\nY0603 = "error"', [("Y0603", "error")]),
        ('Y0603 = "error"\nY06 = "off"', [("Y0603", "error")]),
    ],
)
def test_the_project_says_how_severe(settings, expected, tmp_path):
    (tmp_path / "yarc.toml").write_text(f"[findings]\n{settings}\n")
    assert [(one.code, one.severity) for one in check(NOWHERE, tmp_path)] == expected


def test_a_rule_can_be_switched_off(tmp_path):
    text = "OUTPUT GRIP M1\nP0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)"
    assert codes(text, tmp_path) == ["Y1012"]
    (tmp_path / "yarc.toml").write_text('[findings]\nunset-output = "off"\n')
    assert codes(text, tmp_path) == []


@pytest.mark.parametrize(
    ("settings", "line", "said"),
    [
        ('[findings]\nY0502 = "off"', 2, "Y0502 is an error, which can't be changed"),
        ('[findings]\nY0603 = "loud"', 2, "Y0603 is set to 'loud'"),
        ('[findings]\nno-moton = "off"', 2, "there is no finding no-moton"),
        ("findings = 5", 1, "findings is a table"),
        ('teach = "yes"', 1, "teach is true or false"),
    ],
)
def test_settings_that_cannot_be_meant(settings, line, said, tmp_path):
    (tmp_path / "yarc.toml").write_text(f"{settings}\n")
    (found,) = check(NOWHERE, tmp_path)
    assert (found.code, found.span.line, found.message) == ("Y1393", line, said)
    assert found.help
