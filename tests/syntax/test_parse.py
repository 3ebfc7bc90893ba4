"""Parsing never raises, one fault costs one finding, and printing then parsing gives the same tree."""

import dataclasses

from hypothesis import given
from hypothesis import strategies as st

from yarclang.source import SourceFile
from yarclang.syntax.ast import Number, Place, Statement
from yarclang.syntax.parse import LONGEST_LINE, parse
from yarclang.syntax.print import print_module


def parsed(text):
    return parse(SourceFile("test.yarc", text))


def bare(value):
    """A tree without places and comments, names as they are compared: what a statement says."""
    if isinstance(value, Statement):
        kept = [
            field.name
            for field in dataclasses.fields(value)
            if field.name not in {"line", "rows", "comments"}
        ]
        return tuple(bare(getattr(value, name)) for name in kept)
    if isinstance(value, Number):
        return value.text
    if isinstance(value, tuple):
        return tuple(map(bare, value))
    if dataclasses.is_dataclass(value):
        return tuple(
            bare(getattr(value, field.name)) for field in dataclasses.fields(value) if field.name != "place"
        )
    return value.upper() if isinstance(value, str) else value


number = st.one_of(
    st.integers(-999, 999).map(str),
    st.floats(-1e3, 1e3, allow_nan=False).map(lambda value: f"{value:.3f}"),
    st.sampled_from(["+.5", "5.", "1e-3", "-2E+2"]),
)
word = st.from_regex(r"[A-OQ-Za-oq-z][A-Za-z0-9_]{0,8}", fullmatch=True).filter(
    lambda text: text.upper() not in {"BLEND", "ACC", "TOL", "NEAR"}
)
blank = st.sampled_from([" ", "  ", "\t"])
waypoint = st.lists(number, min_size=1, max_size=7).map(" ".join)


@st.composite
def statement(draw):
    parts = [f"P{draw(st.integers(0, 9999)):04d}", draw(word)]
    if draw(st.booleans()):
        parts.append("{" + draw(word) + "}")
    points = draw(st.lists(waypoint, max_size=3))
    if points:
        parts.append(draw(st.sampled_from(["; ", ";", " ;\n  ", "; ! to be continued\n"])).join(points))
        if draw(st.booleans()):
            parts.append(f"[{draw(number)}]")
        if draw(st.booleans()):
            parts.append("(mm,deg,s)")
        if draw(st.booleans()):
            parts.append("{" + draw(word) + "}")
            if draw(st.booleans()):
                parts.append(f"BLEND {draw(number)}")
    text = draw(blank).join(parts)
    return text + draw(st.sampled_from(["", " ! a remark", "   "]))


@given(st.lists(statement(), min_size=1, max_size=5).map("\n".join))
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


@given(st.lists(statement(), min_size=1, max_size=4), st.integers(0, 3))
def test_a_broken_line_costs_one_finding_and_nothing_else(statements, where):
    where = min(where, len(statements))
    broken = [*statements[:where], "P5 MOVEJ 1 2 [5", *statements[where:]]
    result = parsed("\n".join(broken))
    assert [one.code for one in result.diagnostics] == ["Y0102"]
    assert len(result.value.statements) == len(statements)


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
