"""Tests of leaving out findings: a fault is reported once, without those that only follow from it."""

from pathlib import Path

import pytest
from conftest import EXAMPLES, HERE
from programs import planned

from yarclang.pipeline.checking import check_text
from yarclang.pipeline.followers import without_followers
from yarclang.pipeline.inputs import Options
from yarclang.source import SourceFile

REJECTED = sorted((HERE / "rejected").glob("*.yarc"))


def said(text):
    found = check_text(
        SourceFile("a.yarc", text), EXAMPLES, Options(robot="INDUSTRIAL6"), plans=False
    ).diagnostics
    return [(one.span.line, one.code) for one in found]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (
            "FRMAE {A} 0 0 5 0 0 0 (mm,deg) {B}\nP0010 MOVEL {TCP} 0 0 0 0 0 0 [5] (mm,deg,s) {A}",
            [(1, "Y0202")],
        ),
        ("DEFUALT [5] (deg,s)\nP0010 MOVEJ 1 0 0 0 0 0\nP0020 MOVEJ 2 0 0 0 0 0", [(1, "Y0202")]),
        ("RPEAT I 3\nP0010 MOVEJ $I 0 0 0 0 0 [5] (deg,s)\nEND", [(1, "Y0202")]),
        ("REPEAT 3\nP0010 MOVEJ 1 0 0 0 0 0 [5] (deg,s)\nED", [(3, "Y0202")]),
        ("P0010 CALL LIFT\nP0020 CALL LIFT\nP0030 CALL DROP", [(1, "Y0210"), (3, "Y0210")]),
        (
            "FRAME {A} 0 0 0 0 0 0 (mm,deg) {C}\nFRAME {C} 0 0 0 0 0 0 (mm,deg) {A}\nP0010 STOP",
            [(1, "Y0301")],
        ),
        ("P0010 MOVEK 1\nP0020 MOVEJ 1 2 3 4 5 [5] (deg,s)", [(1, "Y0202"), (2, "Y0401")]),
        (
            "{TCP} [50%] (mm,deg,s) {B}\nP0010 MOVEL 0 1174 1276 0 0 0\nP0020 MOVEJ 1 0 0 0 0 0",
            [(1, "Y0101")],
        ),
        (
            'REPEAT 2\nCELL "cell.toml"\nP0010 MOVEJ AWAY [5] (s)\nEND\nP0020 MOVEJ READY [5] (s)',
            [(2, "Y0116")],
        ),
        (
            "SUB A\nP0010 MOVEJ 1 0 0 0 0 0 [5] (deg,s)\nP0010 CALL A\nP0020 CALL A",
            [(1, "Y0113")],
        ),
        ("DEFAULT [5] (mm,deg)\nP0010 MOVEJ 1 0 0 0 0 0", [(2, "Y0304")]),
    ],
)
def test_one_fault(text, expected):
    assert said(text) == expected


HEAD = "DEFAULT {TCP} [50%] (mm,deg,s) {B}\n"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        # findings that depend on the unreadable frame {A} are left out, the others aren't
        (
            (
                "FRAME {A} x 0 0 0 0 0\n"
                "FRAME {C} 0 0 0 0 0 0 {A}\n"
                "P0010 MOVEJ_RPY 0 0 0 0 0 0 {C}\n"
                "P0020 MOVEJ 400 0 0 0 0 0"
            ),
            [(2, "Y0402"), (5, "Y0502")],
        ),
        ("P0010 MOVEJ 10 0 0 0 0 0 [5\nP0020 MOVEJ 20 0 0 0 0 0", [(2, "Y0102")]),
        # Y0407 is reported although the start of the motion is unknown: the law of _POLY5 has no cruise
        (
            "P0010 MOVEJ_RPY 0 2174 1376 0 0 0\nP0020 MOVEL_POLY5 0 1174 1276 0 0 0 [V 25]",
            [(2, "Y0501"), (3, "Y0407")],
        ),
        ("P0010 MOVEJ 400 0 0 0 0 0\nP0020 MOVEJ 500 0 0 0 0 0", [(2, "Y0502"), (3, "Y0502")]),
    ],
)
def test_what_is_planned(text, expected):
    found = check_text(SourceFile("a.yarc", HEAD + text), Path(), Options(robot="INDUSTRIAL6")).diagnostics
    assert [(one.span.line, one.code) for one in found] == expected


@pytest.mark.parametrize("path", REJECTED, ids=lambda path: path.stem)
def test_a_program_with_errors_keeps_some_and_gets_none(path):
    source = SourceFile("test.yarc", path.read_text())
    found = planned(source.text)[1]
    left = without_followers(found, source)
    assert any(one.is_error for one in left) == any(one.is_error for one in found)
    assert {(one.code, one.span) for one in left} <= {(one.code, one.span) for one in found}


def test_of_many_mistakes_in_one_line_the_first_are_told():
    text = "P0010 MOVEJ " + "a " * 500 + "[5] (deg,s)\nP0020 MOVEJ " + "q " * 20 + "[5] (deg,s)\n"
    found = [
        one
        for one in check_text(SourceFile("a.yarc", text), Path(), Options(robot="INDUSTRIAL6")).diagnostics
        if one.code == "Y0402"
    ]
    lines = [one.span.line for one in found]
    assert (lines.count(1), lines.count(2)) == (20, 20)
    assert found[19].message == "`a` is not a number; 480 more like it in this line"
    assert not any("more like it" in one.message for one in found if one is not found[19])
