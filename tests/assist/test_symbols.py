"""Tests of names: where they are known, and where they are used."""

import pytest

from tests.assist.texts import looked_at

TEXT = """\
USE PALLET
FRAME {A} 0 0 0 0 0 0 {B}
LET N = 3
SUB TURN {AT} N2 (mm)
  FRAME {IN} $N2 0 0 0 0 0 {AT}
  P0010 MOVEL 0 0 0 0 0 0 {IN}
END
REPEAT I $N
  FRAME {A2} $(I*10) 0 0 0 0 0 {A}
  P0020 CALL TURN {A2} $I
  P0030 CALL PALLET.PUT {PALLET.X}
END
P0040 CALL TURN { A } 5 ! {A}
INPUT DOOR M11
P0050 WAIT DOOR ON [5] (s)
P0060 MOVEJ HOME NEAR READY
JOINTS READY 0 0 0 0 0 0
"""


def names():
    return looked_at(TEXT).sketch.names


def test_symbols_and_where_they_are_known():
    found = {(one.kind, one.name): (one.first, one.last, one.inside) for one in names().symbols}
    end = 1 << 30
    assert found == {
        ("module", "PALLET"): (1, end, ""),
        ("frame", "A"): (2, end, ""),
        ("number", "N"): (3, end, ""),
        ("sub", "TURN"): (4, end, ""),
        ("parameter", "AT"): (4, 7, "TURN"),
        ("parameter", "N2"): (4, 7, "TURN"),
        ("frame", "IN"): (5, 7, "TURN"),
        ("number", "I"): (8, 12, ""),
        ("frame", "A2"): (9, 12, ""),
        ("input", "DOOR"): (14, end, ""),
        ("joints", "READY"): (17, end, ""),
    }


@pytest.mark.parametrize(
    ("name", "lines"),
    [
        ("A", [9, 13]),
        ("N", [8]),
        ("TURN", [10, 13]),
        ("AT", [5]),
        ("N2", [5]),
        ("IN", [6]),
        ("I", [9, 10]),
        ("A2", [10]),
        ("PALLET", [11, 11]),
        ("DOOR", [15]),
        ("READY", []),
    ],
)
def test_uses_lead_to_what_is_declared_above(name: str, lines: list[int]):
    uses = [one for one in names().uses if one.symbol is not None and one.symbol.name == name]
    assert [one.span.line for one in uses] == lines


def test_names_of_others_have_no_symbol():
    others = [(one.name, one.module, one.is_frame) for one in names().uses if one.symbol is None]
    assert others == [
        ("B", "", True),
        ("PUT", "PALLET", False),
        ("X", "PALLET", True),
        ("HOME", "", False),
        ("READY", "", False),
    ]


def test_spans_are_those_of_the_names_alone():
    lines = TEXT.split("\n")
    for one in (*names().symbols, *names().uses):
        written = lines[one.span.line - 1][one.span.column - 1 : one.span.end_column - 1]
        assert written.upper() == one.name


def test_a_block_without_an_end_goes_on():
    view = looked_at("REPEAT I 4\nP0010 MOVEJ $I 0 0 0 0 0\nP0020 MOVEJ $I 0 0 0 0 0\n")
    assert [one.symbol.name for one in view.sketch.names.uses] == ["I", "I"]
