"""Tests of finding declarations and uses of names, and of renaming."""

from pathlib import Path

import pytest

from tests.assist.texts import HEAD, LIBRARY, checked, looked_at, marked, modules
from yarclang.assist.navigation import (
    RenameError,
    definition_at,
    references,
    renamable_at,
    rename,
    target_at,
)
from yarclang.assist.sketch import sketch_of
from yarclang.assist.view import View
from yarclang.diagnostics import Fix
from yarclang.pipeline.fixing import edited
from yarclang.source import SourceFile, Span

TEXT = """\
USE PICKPLACE
FRAME {TABLE} 800 200 300 0 0 90 {B}
LET PITCH = 60 (mm)
REPEAT I 2
  FRAME {HOLE} $(I*PITCH) 0 0 0 0 0 {TABLE}
  P0010 MOVEL 0 0 0 0 0 0 {HOLE}
END
REPEAT I 2
  FRAME {HOLE} $(I*pitch) 0 0 0 0 0 { table }
  P0020 MOVEL 0 0 0 0 0 0 {hole}
END
P0030 CALL PICKPLACE.PICK {TCP} {TABLE} 60 GRIP 1
P0040 MOVEJ HOME
"""


def at(text: str, piece: str, number: int = 1) -> tuple[int, int]:
    """Return the line and column of the `number`-th occurrence of a piece of a text."""
    place = -1
    for _ in range(number):
        place = text.index(piece, place + 1)
    return marked(text[:place] + "|" + text[place:])[1:]


@pytest.mark.parametrize(
    ("piece", "number", "line"),
    [
        ("TABLE", 3, 2),
        ("table }", 1, 2),
        ("pitch)", 1, 3),
        ("HOLE}\n", 1, 5),
        ("hole}", 1, 9),
        ("I*PITCH", 1, 4),
        ("I*pitch", 1, 8),
    ],
)
def test_definitions(piece: str, number: int, line: int):
    found = definition_at(looked_at(TEXT), *at(TEXT, piece, number))
    assert found.span.line == line
    assert found.source.name == "test.yarc"


def test_definitions_elsewhere():
    view = looked_at(TEXT)
    sub = definition_at(view, *at(TEXT, "PICK {TCP}"))
    assert sub.source.name.endswith("pickplace.yarc")
    assert sub.source.line(sub.span.line).startswith("SUB PICK")
    assert definition_at(view, *at(TEXT, "PICKPLACE\n")).span == Span(1, 1, 1, 1)
    home = definition_at(view, *at(TEXT, "HOME"))
    assert home.source.name.endswith("robot.toml")
    assert home.source.line(home.span.line)[home.span.column - 1 : home.span.end_column - 1] == "HOME"
    cell = HEAD + 'CELL "cell.toml"\nP0010 MOVEJ READY\nP0020 MOVEL 0 0 0 0 0 0 {LEFT}\n'
    for piece, line in (("READY", "READY ="), ("LEFT", "[frames.LEFT]")):
        found = definition_at(checked(cell), *at(cell, piece))
        assert found.source.name.endswith("cell.toml")
        assert found.source.line(found.span.line).startswith(line)
    assert definition_at(view, *at(TEXT, "P0040")) is None
    assert definition_at(view, *at(TEXT, "GRIP")) is None


def test_references_keep_to_their_block():
    view = looked_at(TEXT)
    target = target_at(view, *at(TEXT, "{hole}", 1))
    assert [one.span.line for one in references(target, [view])] == [9, 9, 10][1:]
    table = target_at(view, *at(TEXT, "TABLE"))
    assert [one.span.line for one in references(table, [view], declaration=False)] == [5, 9, 12]


def test_rename_changes_all_uses_and_nothing_else():
    view = looked_at(TEXT)
    edits = rename(target_at(view, *at(TEXT, "pitch")), [view], "STEP")
    ((source, made),) = edits.items()
    after = edited(source, [Fix("", tuple(made))])
    assert after == TEXT.replace("PITCH", "STEP").replace("pitch", "STEP")
    edits = rename(target_at(view, *at(TEXT, "TABLE")), [view], "{BENCH}")
    assert edited(source, [Fix("", tuple(edits[source]))]) == TEXT.replace("TABLE", "BENCH").replace(
        "table", "BENCH"
    )


BOTH = """\
LET N = 3
IF N > 2
  IF N > 3
    LET H = 10
  ELSE
    LET H = 11
  END
ELSE
  LET H = 20
END
LET K = H + 1
"""


@pytest.mark.parametrize("line", [4, 6, 9, 11])
def test_a_name_of_both_ways_of_an_if_is_one_name(line):
    view = looked_at(BOTH)
    column = BOTH.splitlines()[line - 1].index("H") + 1
    ((source, made),) = rename(target_at(view, line, column), [view], "UP").items()
    assert edited(source, [Fix("", tuple(made))]) == BOTH.replace("H", "UP")


FUNCTION = """\
LET K = 2
FUNC MID(A, B (mm)) = (A + B) / K
LET X = MID(1, K)
"""


@pytest.mark.parametrize(
    ("at_", "new", "after"),
    [
        ((2, 6), "HALF", FUNCTION.replace("MID", "HALF")),
        ((3, 9), "HALF", FUNCTION.replace("MID", "HALF")),
        ((2, 10), "C", FUNCTION.replace("(A, ", "(C, ").replace("(A + ", "(C + ")),
        ((2, 28), "C", FUNCTION.replace(", B (", ", C (").replace("+ B)", "+ C)")),
        ((3, 16), "Q", FUNCTION.replace("K", "Q")),
    ],
)
def test_names_of_functions_and_their_parameters(at_, new, after):
    view = looked_at(FUNCTION)
    ((source, made),) = rename(target_at(view, *at_), [view], new).items()
    assert edited(source, [Fix("", tuple(made))]) == after


def test_rename_over_files(tmp_path: Path):
    (tmp_path / "tool.yarc").write_text(
        "SUB OUT\n  P0010 MOVEJ HOME\nEND\nSUB TWICE\n  P0010 CALL OUT\nEND\n"
    )
    users = [
        "USE TOOL\nP0010 CALL TOOL.OUT\n",
        "USE TOOL\nSUB OUT\nEND\nP0010 CALL tool.out\nP0020 CALL OUT\n",
    ]
    find = modules(tmp_path)
    views = [View(find("TOOL"), module=find)]
    views += [View(sketch_of(SourceFile(f"user{n}.yarc", text)), module=find) for n, text in enumerate(users)]
    for view, line, column in ((views[0], 5, 14), (views[1], 2, 17)):
        edits = rename(target_at(view, line, column), views, "AWAY")
        made = {
            source.name.rpartition("/")[2]: [one.span for one in list_] for source, list_ in edits.items()
        }
        assert made == {
            "tool.yarc": [Span(1, 5, 1, 8), Span(5, 14, 5, 17)],
            "user0.yarc": [Span(2, 17, 2, 20)],
            "user1.yarc": [Span(4, 17, 4, 20)],
        }


@pytest.mark.parametrize(
    ("piece", "name", "why"),
    [
        ("TABLE", "TCP", "comes from the robot"),
        ("TABLE", "1X", "no name"),
        ("TABLE", "A.B", "no name"),
        ("TABLE", "", "no name"),
        ("TABLE", "HOLE", "line 5"),
        ("HOLE", "TABLE", "line 2"),
        ("PITCH", "I", "line 4"),
        ("PITCH", "MOVEL", "word of the language"),
        ("PITCH", "P10", "word of the language"),
        ("PITCH", "blend", "word of the language"),
        ("PITCH", "PICKPLACE", "line 1"),
    ],
)
def test_bad_names_are_refused(piece: str, name: str, why: str):
    view = looked_at(TEXT)
    with pytest.raises(RenameError, match=why):
        rename(target_at(view, *at(TEXT, piece)), [view], name)


def test_names_of_the_cell_are_taken():
    text = HEAD + 'CELL "cell.toml"\nFRAME {A} 0 0 0 0 0 0 {B}\nLET N = 1\n'
    view = checked(text)
    with pytest.raises(RenameError, match=r"cell\.toml"):
        rename(target_at(view, *at(text, "A}")), [view], "FIXTURE")
    with pytest.raises(RenameError, match=r"cell\.toml"):
        rename(target_at(view, *at(text, "N = ")), [view], "GRIP")


@pytest.mark.parametrize(
    ("piece", "why"),
    [("HOME", "isn't declared"), ("P0010", "no name"), ("PICKPLACE", "module"), ("TCP", "isn't declared")],
)
def test_what_can_not_be_renamed(piece: str, why: str):
    with pytest.raises(RenameError, match=why):
        renamable_at(looked_at(TEXT), *at(TEXT, piece))


def test_a_sub_of_a_module_can_be_renamed_where_it_is_called():
    assert LIBRARY("PICKPLACE") is not None
    place = renamable_at(looked_at(TEXT), *at(TEXT, "PICK {TCP}"))
    assert TEXT.split("\n")[place.span.line - 1][place.span.column - 1 : place.span.end_column - 1] == "PICK"


def test_renaming_a_parameter_renames_it_in_calls():
    text = (
        "SUB GO {AT} DEPTH=20 (mm)\n  P0010 MOVEL 0 0 $DEPTH 0 0 0 {AT}\nEND\nSUB OTHER DEPTH\nEND\n"
        "P0020 CALL GO DEPTH=20 AT={B}\nP0030 CALL OTHER DEPTH=5\n"
    )
    view = looked_at(HEAD + text)
    first = HEAD.count("\n") + 1
    target = target_at(view, first + 5, text.split("\n")[5].index("DEPTH") + 1)
    assert [place.span.line - first for place in references(target, [view])] == [0, 1, 5]
    (edits,) = rename(target, [view], "DOWN").values()
    assert len(edits) == 3
    frame = target_at(view, first, text.index("AT") + 1)
    assert [place.span.line - first for place in references(frame, [view])] == [0, 1, 5]
