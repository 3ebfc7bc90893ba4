"""Tests of parsing after an edit: only the edited line is parsed again."""

import pytest

from yarclang.source import SourceFile
from yarclang.syntax import parse as parsing

LINES = 5_000


class Counted:
    """Records the texts of statements that are parsed, without those taken from the cache."""

    def __init__(self):
        self.read = parsing.plain_statement
        self.texts = []

    def __call__(self, text):
        self.texts.append(text)
        return self.read(text)


@pytest.fixture
def counted(monkeypatch):
    counted = Counted()
    forget()
    monkeypatch.setattr(parsing, "plain_statement", counted)
    yield counted
    forget()


def forget():
    parsing.parse_statement.cache_clear()
    parsing._placed.cache_clear()


def program():
    """Return a program of different lines, with a loop, and with a list in several lines."""
    lines = [
        f"P{number:05} MOVEJ {number % 89} 0 {number / 1e4:.4f} 0 0 0 [5] (deg,s)" for number in range(LINES)
    ]
    lines[100] = "REPEAT I 3"
    lines[103] = "END"
    lines[200:203] = [
        "P00200 MOVEJ_SPLINE 0 0 0 0 0 0;",
        "  ! on the way",
        "  10 0 0 0 0 0; 20 0 0 0 0 0 [9] (deg,s)",
    ]
    return lines


def parsed(lines):
    module = parsing.parse(SourceFile("long.yarc", "\n".join(lines) + "\n"))
    assert module.diagnostics == ()
    return module.value


def test_an_edit_parses_its_own_line_anew(counted):
    lines = program()
    first = parsed(lines)
    assert len(counted.texts) == LINES - 2  # the list of three lines is one statement
    counted.texts.clear()
    parsed(lines)
    assert counted.texts == []
    lines[2500] = "P02500 MOVEJ 1 2 3 4 5 6 [7] (deg,s)"
    edited = parsed(lines)
    assert counted.texts == [lines[2500]]
    assert sum(one is not other for one, other in zip(edited.statements, first.statements, strict=True)) == 1
    assert edited.statements[:2000] == first.statements[:2000]
    assert edited.statements != first.statements


def test_lines_that_only_moved_are_not_parsed(counted):
    lines = program()
    first = parsed(lines)
    counted.texts.clear()
    moved = parsed(["! a title", "", *lines])
    assert counted.texts == []
    assert [one.line - 2 for one in moved.statements] == [one.line for one in first.statements]
    del lines[3000]
    parsed(lines)
    assert counted.texts == []


def test_an_edit_in_a_list_parses_the_list_anew(counted):
    lines = program()
    parsed(lines)
    counted.texts.clear()
    lines[202] = lines[202].replace("20", "21")
    parsed(lines)
    assert counted.texts == ["\n".join(lines[200:203])]


def test_a_line_that_goes_wrong_and_is_mended(counted):
    lines = program()
    parsed(lines)
    counted.texts.clear()
    good, lines[50] = lines[50], "P00050 MOVEJ [5"
    for _ in range(2):
        found = parsing.parse(SourceFile("long.yarc", "\n".join(lines)))
        assert len(found.diagnostics) == 1
    lines[50] = good
    parsed(lines)
    assert counted.texts == ["P00050 MOVEJ [5"]
