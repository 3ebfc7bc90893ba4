"""Tests of completion: the candidates at a place in a text."""

import re

import pytest

from tests.assist.texts import HEAD, checked, looked_at, marked
from yarclang.assist.completion import candidates_at
from yarclang.assist.snippets import declaration_snippet, plain_text
from yarclang.assist.view import View
from yarclang.assist.vocabulary import DECLARED, OPTIONS, action_entries, command_names
from yarclang.syntax.parse import parse_statement
from yarclang.syntax.words import DECLARATIONS
from yarclang.syntax.words import OPTIONS as OPTION_WORDS

BODY = """\
FRAME {TOOL} 0 0 100 0 0 0 {FLANGE}
FRAME {TABLE} 800 200 300 0 0 90 {B}
USE PICKPLACE
LET PITCH = 60 (mm)
TABLE HEIGHTS 10 20 (mm)
FUNC HALF(A) = A / 2
JOINTS READY 0 -10 -20 0 -60 0
POSE SPOT 0 1174.4 1176 0 0 0
INPUT DOOR M11
OUTPUT GRIP M1
SUB GO {AT} DEPTH (mm)
  P0010 MOVEL 0 0 $DEPTH 0 0 0 {AT}
END
"""


def labels(text: str, view_of=looked_at) -> list[str]:
    text, line, column = marked(text)
    view: View = view_of(text)
    return [one.label for one in candidates_at(view, line, column)]


def behind(half: str, view_of=looked_at) -> list[str]:
    return labels(f"{HEAD}{BODY}{half}|\n", view_of)


@pytest.mark.parametrize(
    ("half", "some", "none"),
    [
        ("", ["MOVEJ", "MOVEL", "CALL", "FRAME", "REPEAT", "END"], ["{TABLE}", "MOVEL_POLY5"]),
        ("P0100 ", ["MOVEJ", "WAIT", "HOLD"], ["FRAME", "LET"]),
        ("ON DOOR OFF ", ["HOLD", "CALL"], ["GO", "DOOR"]),
        ("ON DOOR OFF CALL ", ["GO"], ["HOLD", "CALL"]),
        ("ON DOOR OFF HOLD ", [], ["GO"]),
        ("P0100 MOVEJ_RPY", ["MOVEJ_RPY_AVOID", "MOVEJ_RPY_AVOID_TOPP"], ["MOVEJ_AVOID_RPY", "MOVEL_AVOID"]),
        (
            "P0100 MOVEL",
            ["MOVEL", "MOVEL_QUAT", "MOVEL_POLY5", "MOVEL_RPY_SCURVE"],
            ["MOVEJ_RPY", "MOVEC_AVOID"],
        ),
        ("P0100 MOVEJ_", ["MOVEJ_AVOID", "MOVEJ_RPY_AVOID_POLY5"], []),
        ("P0100 MOVEL ", ["{TOOL}", "{TCP}", "SPOT"], ["READY", "BLEND", "MOVEJ"]),
        ("P0100 MOVEL 1 ", [], ["SPOT"]),
        ("KEEP {TOOL} ", ["UPRIGHT", "ABOVE", "FACING", "SEEN", "{TABLE}"], ["MOVEJ"]),
        ("KEEP {TOOL} FACING 20 ", ["{TABLE}"], ["UPRIGHT"]),
        ("P0100 MOVEL_SPLINE SPOT; ", ["SPOT"], []),
        ("P0100 MOVEJ_RPY ", ["READY", "SPOT"], []),
        ("P0100 DMOVE ", [], ["SPOT"]),
        ("POSE OTHER 0 0 0 0 0 0 ", ["{TABLE}"], []),
        ("P0100 MOVEL {", ["{TOOL}", "{TABLE}", "{B}"], ["READY"]),
        ("P0100 MOVEL {TA", ["{TABLE}"], []),
        ("P0100 MOVEJ ", ["READY", "HOME"], ["GRIP"]),
        ("P0100 MOVEL 0 0 $", ["PITCH"], ["READY", "DEPTH", "SIN"]),
        ("P0100 MOVEL 0 0 $(PITCH*", ["PITCH", "SIN", "PI", "HEIGHTS"], ["READY"]),
        ("P0100 MOVEL 0 0 $", [], ["HEIGHTS"]),
        ("P0100 MOVEL 0 0 $(HEIGHTS[", ["PITCH", "HEIGHTS", "SIN"], ["MIN [", "V", "READY"]),
        ("LET A = HEIGHTS[", ["PITCH", "HEIGHTS"], ["V", "READY"]),
        ("P0100 MOVEL 0 0 0 0 0 0 ", ["BLEND", "ACC", "TOL", "{TABLE}", "[MIN]", "[V 250]"], ["READY"]),
        ("P0100 MOVEJ 0 0 0 0 0 0 ", ["[MIN]"], ["[V 250]"]),
        ("P0100 MOVEL 0 0 0 0 0 0 BLEND 5 ", ["ACC"], ["BLEND"]),
        ("P0100 MOVEJ_RPY 0 0 0 0 0 0 NEAR ", ["READY", "HOME"], ["BLEND", "{B}"]),
        ("P0100 MOVEL 0 0 0 0 0 0 [", ["MIN", "V"], ["PITCH"]),
        ("P0100 MOVEJ 0 0 0 0 0 0 [", ["MIN", "V<="], ["V"]),
        ("P0100 MOVEJ 0 0 0 0 0 0 ", ["[V<=250]"], []),
        ("LET A = ", ["HALF", "SIN", "PITCH"], ["READY"]),
        ("P0100 MOVEL 0 0 $", [], ["HALF"]),
        ("P0100 MOVEL 0 0 0 0 0 0 [MIN] (mm,", ["deg", "s", "ms"], ["cm", "mm"]),
        ("P0100 SET ", ["GRIP"], ["DOOR"]),
        ("P0100 SET GRIP ", ["ON", "OFF"], ["GRIP"]),
        ("P0100 WAIT ", ["DOOR"], ["GRIP"]),
        ("WHEN DOOR ", ["ON", "OFF"], []),
        ("P0100 CALL ", ["GO", "PICKPLACE.PICK"], ["{TABLE}"]),
        ("P0100 CALL GO ", ["{TABLE}", "READY", "GRIP", "AT=", "DEPTH="], []),
        ("P0100 CALL GO {TABLE} ", ["READY", "DEPTH="], ["AT="]),
        ("P0100 CALL GO DEPTH=20 ", ["AT="], ["DEPTH="]),
        ("P0100 CALL GO AT=", ["{TABLE}"], ["DEPTH=", "AT="]),
        ("USE ", ["PALLET", "PICKPLACE"], []),
        ("ROBOT ", ["INDUSTRIAL6"], []),
        ("START ", ["READY", "HOME"], ["GRIP"]),
        ("IF ", ["PITCH", "ABS"], ["READY"]),
        ("LET X = ", ["PITCH", "SQRT"], []),
        ("FRAME {X} 0 0 0 0 0 0 {", ["{TABLE}", "{B}"], []),
        ("P0100 MOVEL ! see {", [], ["{TABLE}"]),
        ("P0100 MOVEL ! yarc: ignore[Y06", ["Y0611"], ["Y0601", "{TABLE}"]),
        ('P0100 HOLD "MOV', [], ["MOVEJ"]),
        ("P01", [], ["MOVEJ"]),
        ("P0100 MOVEL 12", [], ["BLEND"]),
    ],
)
def test_what_fits_and_what_does_not(half: str, some: list[str], none: list[str]):
    found = behind(half)
    assert set(some) <= set(found)
    assert not set(none) & set(found)


def test_parameters_are_known_in_their_sub():
    text = f"{HEAD}{BODY}".replace("$DEPTH", "$|")
    assert {"DEPTH", "PITCH"} <= set(labels(text))
    assert "{AT}" in labels(f"{HEAD}{BODY}".replace("{AT}\nEND", "{|}\nEND"))


def test_names_of_the_cell():
    text = HEAD + 'CELL "cell.toml"\nP0010 SET |\nP0020 MOVEL 0 0 0 0 0 0 {B}\n'
    assert {"GRIP", "CLAMP"} <= set(labels(text, checked))
    assert "{FIXTURE}" in labels(text.replace("|", "").replace("{B}\n", "{|\n"), checked)


def test_what_is_written_over():
    text, line, column = marked(HEAD + "P0010 MOVEL_PO|")
    found = next(one for one in candidates_at(looked_at(text), line, column) if one.label == "MOVEL_POLY5")
    assert (found.span.column, found.span.end_column) == (7, 15)
    text, line, column = marked(HEAD + "P0010 MOVEL {T|}")
    found = next(one for one in candidates_at(looked_at(text), line, column) if one.label == "{TCP}")
    assert found.text == "{TCP"
    assert (found.span.column, found.span.end_column) == (13, 15)


@pytest.mark.parametrize("name", command_names())
def test_a_command_is_complete_once_its_holes_are_filled(name: str):
    """A snippet has all parts of a line: with numbers in its holes, it has no error of form."""
    for head in (HEAD, "ROBOT INDUSTRIAL6\n"):
        text, line, column = marked(f"{head}{name}|")
        found = next(one for one in candidates_at(looked_at(text), line, column) if one.label == name)
        filled = re.sub(r"\b(J[1-6]|x|y|z|roll|pitch|yaw|q[xyz])\b", "0", found.plain).replace("qw", "1")
        errors = [one for one in checked(head + filled + "\n").checked.diagnostics if one.is_error]
        of_form = [
            one.code
            for one in errors
            if one.code[:3] in {"Y01", "Y02", "Y03"} or one.code in {"Y0401", "Y0406"}
        ]
        assert of_form == [], filled


def test_every_word_has_its_documentation():
    assert DECLARED.keys() == DECLARATIONS
    assert OPTIONS.keys() == OPTION_WORDS
    for entry in (*DECLARED.values(), *action_entries().values()):
        assert entry.summary
        parsed = parse_statement(entry.example if entry in DECLARED.values() else f"P0010 {entry.example}")
        assert hasattr(parsed, "name"), entry.example
        snippet = declaration_snippet(entry.example)
        assert plain_text(snippet).split("\n")[0] == entry.example
    assert all(one.detail for one in candidates_at(looked_at(""), 1, 1))


@pytest.mark.parametrize(
    ("text", "index"),
    [
        ("|", "P0010"),
        ("P0010 MOVEJ HOME\n|", "P0020"),
        ("P0010 MOVEJ HOME\n|\nP0020 STOP\n", "P0015"),
        ("P0010 MOVEJ HOME\n|\nP0011 STOP\n", "P0012"),
        ("P0001 MOVEJ HOME\n|\n", "P0010"),
    ],
)
def test_a_new_command_gets_an_index(text: str, index: str):
    text, line, column = marked(text)
    found = next(one for one in candidates_at(looked_at(text), line, column) if one.label == "MOVEL")
    assert found.text.startswith(index + " MOVEL")
