"""Tests of parsing: it never raises, each error has one finding, and a printed tree is parsed to the same
tree.
"""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from syntax.writing import bare, motion, parsed, statement, statements

from yarclang.syntax.ast import Place
from yarclang.syntax.lines import end_of
from yarclang.syntax.parse import LONGEST_LINE
from yarclang.syntax.print import print_module


@given(st.lists(motion(), min_size=1, max_size=5).map("\n".join))
def test_print_then_parse_gives_the_same_tree(text):
    first = parsed(text)
    assert first.diagnostics == ()
    printed = print_module(first.value)
    second = parsed(printed)
    assert bare(second.value.statements) == bare(first.value.statements)
    assert print_module(second.value) == printed


@given(st.text(max_size=200))
def test_no_text_makes_the_parser_raise(text):
    assert parsed(text).value is not None


@given(st.text(alphabet='P01 MOVEJL_{}[]();,.!"$%-+ \n', max_size=120))
def test_no_broken_statement_makes_the_parser_raise(text):
    result = parsed(text)
    lines = {one.span.line for one in result.diagnostics}
    assert len(lines) == len(result.diagnostics), "one line, one finding"


@given(st.data(), statement)
def test_no_damaged_statement_makes_the_parser_raise(data, text):
    at = data.draw(st.integers(0, len(text)))
    end = data.draw(st.integers(at, min(at + 3, len(text))))
    put = data.draw(st.text(alphabet='$()[]{}=*-!;,." A5%', max_size=3))
    result = parsed(text[:at] + put + text[end:])
    lines = {one.span.line for one in result.diagnostics}
    assert len(lines) == len(result.diagnostics), "one line, one finding"
    for one in result.diagnostics:
        assert one.span.column < one.span.end_column
        assert one.help


@given(st.lists(motion(), min_size=1, max_size=4), st.integers(0, 3))
def test_a_broken_line_costs_one_finding_and_nothing_else(statements, where):
    where = min(where, len(statements))
    broken = [*statements[:where], "P5 MOVEJ 1 2 [5", *statements[where:]]
    result = parsed("\n".join(broken))
    assert [one.code for one in result.diagnostics] == ["Y0102"]
    assert len(result.value.statements) == len(statements)


@given(statement)
def test_a_statement_ends_where_its_code_does(text):
    (one,) = statements(text)
    end = end_of(text)
    assert (one.whole_span.end_line - one.line, one.whole_span.end_column) == (end.row, end.start)


def test_crlf_and_lone_returns_are_line_ends():
    for end in ("\r\n", "\r", "\n"):
        result = parsed(f"P1 MOVEJ HOME{end}P2 STOP{end}")
        assert [one.line for one in result.value.statements] == [1, 2]


def test_a_list_goes_on_after_a_semicolon_but_never_into_a_command():
    text = "P1 MOVEJ_SPLINE 1 2;\n! remark\n\n  3 4 [5]\nP2 STOP\n"
    result = parsed(text)
    assert result.diagnostics == ()
    assert [one.line for one in result.value.statements] == [1, 5]
    assert result.value.statements[0].span(result.value.statements[0].time.place).line == 4
    stops = parsed("P1 MOVEJ_SPLINE 1 2;\nP2 STOP\n")
    assert [one.code for one in stops.diagnostics] == ["Y0101"]
    assert [one.name.name for one in stops.value.statements] == ["STOP"]


def test_places_are_columns_from_one():
    (one,) = parsed("P1 MOVEJ {TCP} 1.5 -2 [20] (deg,s) {B}").value.statements
    assert one.moving.place == Place(0, 10, 15)
    assert [value.place for value in one.waypoints[0].values] == [Place(0, 16, 19), Place(0, 20, 22)]
    assert one.time.place == Place(0, 23, 27)
    assert one.units.place == Place(0, 28, 35)
    assert one.base.place == Place(0, 36, 39)


def test_an_endless_line_is_one_finding():
    result = parsed("P1 MOVEJ " + "0 " * LONGEST_LINE)
    assert [one.code for one in result.diagnostics] == ["Y0106"]


@pytest.mark.parametrize(
    "head", ["IF", "LET", "FUNC", "REPEAT", "P0010 MOVEJ", "SUB", "P0010 BLEND", "P0010", "END", "V"]
)
def test_at_most_stands_behind_no_head(head):
    assert parsed(f"{head}<= 1 = 1").diagnostics
