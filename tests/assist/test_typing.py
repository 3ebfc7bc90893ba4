"""Tests of texts that are typed only in part: each request at each place gets an answer, and never an
exception.
"""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.assist.texts import EXAMPLES, checked, looked_at, marked
from yarclang.assist.changes import formatted
from yarclang.assist.completion import candidates_at
from yarclang.assist.hints import ShortestTimes, hints_in
from yarclang.assist.hover import hover_at
from yarclang.assist.navigation import RenameError, definition_at, references, renamable_at, rename, target_at
from yarclang.assist.outline import folds, outline
from yarclang.assist.repairs import repairs_of
from yarclang.assist.signatures import signature_at
from yarclang.assist.tints import tints
from yarclang.assist.view import View

PATHS = sorted(EXAMPLES.glob("*.yarc"))
PIECES = [
    "", " ", "{", "}", "[", "]", "(", ")", "$", "$(", ";", "!", '"', "\n", "\r", "\x0c", "\t", "%", ".", "ä",
        "🤖", "P", "P0", "SUB ", "END",
    "REPEAT I 3\n", "ELSE\n", "1e999", "MOVEL ", "{TCP", "$PITCH", "_", "=", "USE ", "BLEND ",
        "! yarc: ignore[", "\u2028", "-",
]  # fmt: skip


def ask_here(view: View, line: int, column: int) -> None:
    """Make all requests for a place, and check their answers."""
    hover_at(view, line, column)
    for one in candidates_at(view, line, column):
        assert one.span.line == line
        assert one.span.column <= column == one.span.end_column
    signature_at(view, line, column)
    definition_at(view, line, column)
    target = target_at(view, line, column)
    if target is not None:
        assert list(references(target, [view]))
        try:
            renamable_at(view, line, column)
            assert rename(target, [view], "NEW_NAME_9")
        except RenameError:
            pass


def ask_all(view: View) -> None:
    """Make all requests for a whole text."""
    sketch = view.sketch
    outline(sketch)
    folds(sketch)
    list(tints(sketch))
    formatted(sketch.source)
    list(hints_in(view, 1, len(sketch.source.lines) + 1, ShortestTimes()))
    found = view.checked.diagnostics if view.checked else ()
    for finding in found:
        list(repairs_of(sketch.source, sketch, finding, found))


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.name)
def test_examples_typed_letter_by_letter(path):
    whole = path.read_text()
    for size in range(len(whole) + 1):
        text, line, column = marked(whole[:size] + "|")
        view = looked_at(text, path.name)
        ask_here(view, line, column)
        if size % 61 == 0:
            ask_all(view)


@given(data=st.data())
@settings(max_examples=150)
def test_any_edit_and_any_place(data: st.DataObject):
    text = data.draw(st.sampled_from(PATHS)).read_text()
    for _ in range(data.draw(st.integers(0, 4))):
        begin = data.draw(st.integers(0, len(text)))
        end = min(len(text), begin + data.draw(st.integers(0, 12)))
        text = text[:begin] + data.draw(st.sampled_from(PIECES)) + text[end:]
    has_findings = data.draw(st.booleans())
    view = checked(text) if has_findings else looked_at(text)
    lines = view.sketch.source.lines
    line = data.draw(st.integers(1, len(lines) + 1))
    column = data.draw(st.integers(1, len(view.sketch.source.line(line)) + 1))
    ask_here(view, line, column)
    ask_all(view)


@given(st.text(st.sampled_from('PMOVEL 0123{}[]()$;!"%.,=<*-_äITCP\n'), max_size=120), st.data())
@settings(max_examples=100)
def test_any_text(text: str, data: st.DataObject):
    view = looked_at(text)
    line = data.draw(st.integers(1, len(view.sketch.source.lines) + 1))
    ask_here(view, line, data.draw(st.integers(1, len(view.sketch.source.line(line)) + 1)))
    ask_all(view)


def test_planned_programs_are_asked_everywhere():
    """In a planned program, hovering at every word works, too."""
    view = checked(PATHS[6].read_text(), plans=True)
    assert view.checked.plan is not None
    for number, line in enumerate(view.sketch.source.lines, 1):
        for column in range(1, len(line) + 2, 7):
            hover_at(view, number, column)
    ask_all(view)
