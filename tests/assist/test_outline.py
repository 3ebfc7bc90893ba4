"""Tests of a file's outline, its folds, and the kinds of its words."""

from itertools import pairwise

from hypothesis import given, settings
from hypothesis import strategies as st

from tests.assist.texts import EXAMPLES, looked_at
from yarclang.assist.outline import folds, outline
from yarclang.assist.tints import tints

TEXT = """\
! One.
! Two.
FRAME {A} 0 0 0 0 0 0 {B}
SUB GO {AT} T (s)
  IF T > 1
    P0010 MOVEL 0 0 0 0 0 0 [$T] {AT}
  ELSE
    P0020 STOP
  END
END
REPEAT I 3
  FRAME {C} $(I*10) 0 0 0 0 0 {A}
  P0030 MOVEL_SPLINE 0 0 0 0 0 0;
    1 0 0 0 0 0 [MIN]
END
P0040 SET GRIP ON
"""


def test_outline():
    found = outline(looked_at(TEXT).sketch)
    assert [(one.kind, one.name) for one in found] == [
        ("frame", "{A}"),
        ("sub", "GO"),
        ("block", "REPEAT I 3"),
        ("command", "P0040 SET"),
    ]
    sub = found[1]
    assert (sub.span.line, sub.span.end_line, sub.detail) == (4, 10, "SUB GO {AT} T (s)")
    (condition,) = sub.children
    assert [one.name for one in condition.children] == ["P0010 MOVEL", "P0020 STOP"]
    assert found[3].detail == "GRIP ON"
    assert condition.children[1].detail == ""
    assert [one.name for one in found[2].children] == ["{C}", "P0030 MOVEL_SPLINE"]


def test_folds():
    found = [(one.first, one.last, one.is_comment) for one in folds(looked_at(TEXT).sketch)]
    assert found == [
        (1, 2, True),
        (4, 9, False),
        (5, 6, False),
        (7, 8, False),
        (11, 14, False),
        (13, 14, False),
    ]


def test_kinds_of_words():
    lines = TEXT.split("\n")
    found = {}
    for one in tints(looked_at(TEXT).sketch):
        found.setdefault(lines[one.line - 1][one.start - 1 : one.end - 1], set()).add(
            (one.tint, one.declares)
        )
    assert found["FRAME"] == {("keyword", False)}
    assert found["A"] == {("frame", True), ("frame", False)}
    assert found["B"] == {("frame", False)}
    assert found["GO"] == {("sub", True)}
    assert found["AT"] == {("parameter", True), ("parameter", False)}
    assert found["T"] == {("parameter", True), ("parameter", False)}
    assert found["s"] == {("unit", False)}
    assert found["P0010"] == {("index", False)}
    assert found["MOVEL_SPLINE"] == {("command", False)}
    assert found["I"] == {("variable", True), ("variable", False)}
    assert found["ON"] == {("constant", False)}
    assert found["! One."] == {("comment", False)}


def test_min_is_a_time_and_a_function():
    text = "LET A = MIN(1, 2)\nP0010 MOVEJ HOME [MIN]\n"
    assert [one.tint for one in tints(looked_at(text).sketch) if one.end - one.start == 3] == [
        "keyword",
        "function",
        "constant",
    ]


@given(
    text=st.one_of(
        st.sampled_from([path.read_text() for path in sorted(EXAMPLES.glob("*.yarc"))]),
        st.text(st.sampled_from('PMOVEL 01{}[]()$;!"%.,=<*-_äI\n'), max_size=80),
    ),
    first=st.integers(1, 30),
    size=st.integers(0, 30),
)
@settings(max_examples=60)
def test_words_stand_in_order_and_never_on_each_other(text: str, first: int, size: int):
    sketch = looked_at(text).sketch
    whole = list(tints(sketch))
    for one, other in pairwise(whole):
        assert (one.line, one.end) <= (other.line, other.start) or one.line < other.line
    for one in whole:
        assert 1 <= one.start < one.end <= len(sketch.source.line(one.line)) + 1
    part = list(tints(sketch, first, first + size))
    assert part == [one for one in whole if first <= one.line <= first + size]
