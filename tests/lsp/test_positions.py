"""Positions as the protocol counts them."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lsprotocol import types

from yarclang.lsp.documents import Document, changed
from yarclang.lsp.positions import UTF8, UTF16, UTF32, column_of, place_of, position_of, span_of, units_of
from yarclang.source import SourceFile, Span

LINE = "P0010 HOLD ! Grüße 🤖 an alle"
ENCODINGS = (UTF8, UTF16, UTF32)
TEXTS = st.text(st.sampled_from("aB1 !ä€😀\t\x0c\u2028\r\n"), max_size=40)


@pytest.mark.parametrize(("encoding", "units"), [(UTF8, 26), (UTF16, 22), (UTF32, 21)])
def test_columns_behind_wide_characters(encoding: str, units: int):
    source, column = SourceFile("x", LINE), LINE.index("an alle") + 1
    assert position_of(source, 1, column, encoding) == types.Position(0, units)
    assert column_of(LINE, units, encoding) == column


def test_the_middle_of_a_character_is_its_beginning():
    assert column_of("🤖a", 1, UTF16) == 1
    assert column_of("ä", 1, UTF8) == 1


@given(text=TEXTS, encoding=st.sampled_from(ENCODINGS), data=st.data())
def test_a_place_there_and_back(text: str, encoding: str, data: st.DataObject):
    source = SourceFile("x", text)
    line = data.draw(st.integers(1, max(len(source.lines), 1)))
    column = data.draw(st.integers(1, len(source.line(line)) + 1))
    assert place_of(source, position_of(source, line, column, encoding), encoding) == (line, column)


@given(text=TEXTS, line=st.integers(0, 9), character=st.integers(0, 99), encoding=st.sampled_from(ENCODINGS))
def test_any_position_is_a_place(text: str, line: int, character: int, encoding: str):
    source = SourceFile("x", text)
    found, column = place_of(source, types.Position(line, character), encoding)
    assert 1 <= found <= len(source.lines) + 1
    assert 1 <= column <= len(source.line(found)) + 1


@given(before=TEXTS, put=TEXTS, encoding=st.sampled_from(ENCODINGS), data=st.data())
def test_edits_do_what_they_say(before: str, put: str, encoding: str, data: st.DataObject):
    """An edit between two offsets, given as positions, replaces exactly the text between them."""
    begin = data.draw(st.integers(0, len(before)))
    end = data.draw(st.integers(begin, len(before)))
    if any("\r\n" in before[at - 1 : at + 1] and before[at - 1 : at] == "\r" for at in (begin, end) if at):
        return  # between CR and LF is no place
    document = Document("file:///x.yarc", 1, before)
    starts = [_position(before, at, encoding) for at in (begin, end)]
    change = types.TextDocumentContentChangePartial(range=types.Range(*starts), text=put)
    after = changed(document, [change], 2, encoding)
    assert (after.text, after.version) == (before[:begin] + put + before[end:], 2)


def _position(text: str, offset: int, encoding: str) -> types.Position:
    before = text[:offset].replace("\r\n", "\n").replace("\r", "\n")
    return types.Position(before.count("\n"), units_of(before.rpartition("\n")[2], encoding))


def test_whole_texts_and_several_edits():
    document = Document("file:///x.yarc", 1, "one\ntwo\n")
    whole = types.TextDocumentContentChangeWholeDocument(text="three\n")
    part = types.TextDocumentContentChangePartial(
        range=types.Range(types.Position(0, 5), types.Position(1, 0)), text="!"
    )
    assert changed(document, [whole, part], 5, UTF16).text == "three!"


def test_spans():
    source = SourceFile("x", "ä😀b\r\nzwei")
    range_ = types.Range(types.Position(0, 3), types.Position(1, 2))
    assert span_of(source, range_, UTF16) == Span(1, 3, 2, 3)
