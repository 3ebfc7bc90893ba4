"""Tests of formatting: it keeps words, numbers and comments, and changes nothing when repeated."""

import pytest
from conftest import EXAMPLES
from hypothesis import given
from hypothesis import strategies as st
from syntax.writing import module, parsed

import yarclang.syntax.form as form_module
from yarclang.source import SourceFile
from yarclang.syntax.form import usual_form
from yarclang.syntax.lines import code_of
from yarclang.syntax.print import print_module

BRACES = ["{!TCP}", "{TCP!}", "{ ! }", '{"TCP"}', '{T"CP}', '{"}', "{!", "{TCP ! x}"]


def form(text, renumber=None):
    return usual_form(SourceFile("a.yarc", text), renumber)


def comments(text):
    return [line[len(code_of(line)) :].rstrip() for line in text.splitlines() if "!" in line]


@pytest.mark.parametrize("brace", BRACES)
def test_a_comment_begins_in_braces_too(brace):
    text = f"DEFAULT {brace} [5] (mm,deg,s) {{B}}\n"
    (found,) = parsed(text).diagnostics
    mark = min(text.find(one) for one in '!"' if one in text)
    assert found.code in {"Y0101", "Y0102"}
    assert found.span.column == (mark if "}" in brace[1:] else text.index("{")) + 1
    assert form(text).value is None


def test_the_line_that_grew_at_each_run_is_refused_at_its_exclamation_mark():
    (found,) = parsed("DEFAULT {!TCP} [5] (mm,deg,s) {B}").diagnostics
    assert (found.code, found.span.column) == ("Y0102", 10)
    assert "starts a comment" in found.message


@given(module(), st.sampled_from([None, (10, 10), (7, 3)]))
def test_every_form_is_proved(text, renumber):
    made = form(text, renumber)
    assert made.diagnostics == ()
    assert comments(made.value) == comments(text)
    assert form(made.value, renumber).value == made.value


ALPHABET = st.sampled_from(
    [
        *'P01 MOVEJ_{}[]();,.!"$%-+=\t\n',
        "P0010 ",
        "MOVEJ ",
        "HOME",
        "{TCP}",
        "[5]",
        " (deg,s)",
        "LET A = ",
        "HOLD ",
        '"a!b"',
        "! c",
        ";\n",
    ]
)


@given(st.lists(ALPHABET, max_size=30).map("".join))
def test_any_text_is_refused_or_keeps_its_comments(text):
    made = form(text)
    assert all(one.code != "Y2002" for one in made.diagnostics)
    if made.value is not None:
        assert comments(made.value) == comments(text)
        assert form(made.value).value == made.value


WRONG = [
    (lambda text: text.replace("10", "11"), 2, "has different words"),
    (lambda text: text.replace("{B}", ""), 1, "has different words"),
    (lambda text: text.replace(" 0 0 ", " 00 "), 2, "is read differently"),
    (lambda text: text.replace("MOVEJ 10", "MOVEJ10"), 2, "can't be read|is read differently"),
    (lambda text: text.replace("why", "who"), 2, "has a different comment"),
    (lambda text: text.replace("  ! why", ""), 2, "has a different comment"),
    (lambda text: text.replace("  ! why", "\n! why"), 2, "has a different comment|has different words"),
    (lambda text: text.replace("P0020 STOP\n", ""), 3, "has a different number of lines"),
    (lambda text: text + "P0030 STOP\n", 1, "has a different number of lines"),
    (lambda text: text.replace("[5]", "[5 ]"), 2, "is formatted differently the second time"),
    (lambda text: text.replace("(deg,s)", "(deg,s"), 2, "has different words"),
]
TEXT = "DEFAULT {TCP} {B}\np0010 movej 10 0 0 0 0 0 [5] (deg,s) ! why\np0020 STOP\n"


@pytest.mark.parametrize(("spoil", "line", "what"), WRONG)
def test_what_a_wrong_printer_does_is_found(monkeypatch, spoil, line, what):
    before = print_module
    first = []

    def wrong(tree):
        first.append(tree)
        return spoil(before(tree)) if len(first) == 1 else before(tree)

    monkeypatch.setattr(form_module, "print_module", wrong)
    made = form(TEXT)
    assert made.value is None
    (found,) = made.diagnostics
    assert (found.code, found.span.line) == ("Y2002", line)
    assert any(one in found.message for one in what.split("|")), found.message
    assert "please report" in found.help


def test_a_text_in_form_is_itself_and_keeps_its_ends():
    for path in sorted(EXAMPLES.glob("*.yarc")):
        text = form(path.read_text()).value
        for end in ("\n", "\r\n"):
            assert form(text.replace("\n", end)).value == text.replace("\n", end)


def test_a_form_that_is_too_long_is_no_bug():
    text = "P0010 STOP\n\nLET A = MAX(" + ",".join(["1"] * 49_000) + ")\n"
    (found,) = form(text).diagnostics
    assert (found.code, found.span.line) == ("Y0106", 3)
