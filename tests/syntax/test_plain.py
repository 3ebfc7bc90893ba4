"""Tests of the quick reader: it reads statements exactly as the grammar does, including all columns."""

import re
from pathlib import Path

import pytest
from floors import exercises
from hypothesis import example, given
from hypothesis import strategies as st
from syntax.writing import statement

from yarclang.syntax.parse import _parser, parse_statement, statement_by_grammar
from yarclang.syntax.plain import plain_statement, terminals

COMMANDS = (
    "P0010",
    "p2",
    "P",
    "P1x",
    "MOVEJ",
    "movel_rpy",
    "MOVEJ,",
    "WAIT",
    "JOINTS",
    "CALL",
    "SUB",
    "LET",
    "IF",
    "END",
    "else",
)
WORDS = (
    "HOME",
    "X.Y",
    "_a",
    "MIN",
    "V",
    "ON",
    "M1",
    "BLEND",
    "acc",
    "TOL",
    "NEAR",
    "FUNC",
    "BLEND<=5",
    "V<=5",
    "<=",
)
NUMBERS = ("0", "-1.5", "+.5", "5.", "1e-3", "2E+", "3x", "1,5", "50%", "30 %", "$X", "$(1 + 2)")
BRACKETS = ("{TCP}", "{ B }", "{}", '{A!"}', "[", "]", "[5]", "[MIN]", "[ V 250 ]", "[50%]", "[1 2]", "[]")
UNITS = ("(mm,deg,s)", "( mm , s )", "()", "(mm deg)", "(5)")
OTHERS = (";", ",", "=", '"text"', '"', "!", "! said", "\ufeff", "\u00a0", "\u2003", "\x0c", "%", "\\")
PARTS = st.sampled_from([*COMMANDS, *WORDS, *NUMBERS, *BRACKETS, *UNITS, *OTHERS])
GAPS = st.sampled_from([" ", " ", " ", "  ", "\t", "", "\n"])
PLAIN = re.compile(r"^[^$\"<>]*[^$\"<>; ] *$")


@exercises(plain=0.02)
@given(st.lists(st.tuples(GAPS, PARTS), max_size=9).map(lambda parts: "".join(map("".join, parts))))
@example("P1 P2 MOVEJ")
@example("P1")
@example("BLEND 5 BLEND 5")
@example("MOVEJ 1 BLEND ACC 30 %TOL 1")
@example("MOVEJ {A} {B} {C}")
@example("MOVEJ [50%](mm){B}BLEND 5!x")
@example("MOVEJ [V<=5] BLEND <=5")
@example("FUNC 1 2")
@example("ENDE 1 2")
@example("MOVEJ 1 2 ; HOME;3")
@example("MOVEJ 1;;2")
@example("MOVEJ ;1")
@example("MOVEJ 1; [5]")
def test_any_row_of_parts_is_read_alike(tally, text):
    plain = plain_statement(text)
    tally.count("plain", plain is not None)
    assert plain is None or plain == statement_by_grammar(text)


@exercises(plain=0.05)
@given(statement, st.data())
def test_any_statement_is_read_alike_whole_or_damaged(tally, text, data):
    at = data.draw(st.integers(0, len(text)))
    end = data.draw(st.integers(at, min(at + 2, len(text))))
    damaged = text[:at] + data.draw(st.text(alphabet="$()[]{}=*-!;,. A5%\t", max_size=2)) + text[end:]
    for one in (text, damaged):
        plain = plain_statement(one)
        tally.count("plain", plain is not None)
        assert plain is None or plain == statement_by_grammar(one)


EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.yarc"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_lines_of_the_examples_are_plain_or_say_why(path):
    before = ""
    for text in path.read_text().splitlines():
        is_continued, before = before.rstrip().endswith(";"), text.partition("!")[0]
        code = before.split()
        if (
            is_continued
            or not code
            or code[0] in {"LET", "SUB", "IF", "END", "ELSE", "CALL", "REGISTER", "CASE", "OF", "WHEN"}
            or "CALL" in code[1:2]
            or "ALLOW" in code  # ALLOW is followed by two words
            or "=" in code
        ):
            continue
        if PLAIN.match(before):
            assert plain_statement(text) == parse_statement(text) == statement_by_grammar(text)


NAMES = ("INDEX", "WORD", "FRAME", "NUMBERS", "PERCENT", "OPTION", "CALL", "SUB", "LET", "IF", "LONE")


def test_terminals_are_those_of_the_grammar():
    of_lark = {one.name: one.pattern for one in _parser().terminals}
    for name in NAMES:
        own = re.compile(terminals()[name])
        pattern = own.pattern.partition(":")[2][:-1].replace("\\n", "\n").replace("\\t", "\t")
        assert pattern == of_lark[name].value
        assert own.pattern.startswith("(?i:") == ("i" in of_lark[name].flags)
