"""Tests of characters that are invisible, or that look like plain ones.

Each gets a finding with its place and name, and a fix if it is safe.
"""

import re

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from syntax.writing import parsed, statement

from yarclang.pipeline.fixing import edited
from yarclang.pipeline.sources import decode_source
from yarclang.source import SourceFile
from yarclang.syntax.characters import character_name, fault_in, instead_of, is_not_text
from yarclang.syntax.lines import code_of
from yarclang.syntax.parse import statement_by_grammar

BLANKS = "\u00a0\u1680\u2000\u2001\u2002\u2003\u2004\u2005\u2006\u2007\u2008\u2009\u200a\u202f\u205f\u3000"
BREAKS = "\v\f\u0085\u2028\u2029"
UNSEEN = "\u00ad\u061c\u200b\u200c\u200d\u200e\u200f\u2060\ufeff"
TURNS = "\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"
MINUS = "\u2010\u2011\u2012\u2013\u2014\u2015\u2212\ufe63\uff0d"
QUOTES = "\u201c\u201d\u201e\u201f\uff02"
DIGITS = "\uff10\uff19\u0660\u0663\u06f9\u0966"
NOT_TEXT = "\0\x01\x07\x08\x1a\x1b\x1c\x1d\x1e\x1f\x7f\ud800\udc80\udfff"
OTHERS = "äßМı²½℃…—🤖\u0301\ufe0f\x80\x9f\ue000\U000e0041"
FOREIGN = BLANKS + BREAKS + UNSEEN + TURNS + MINUS + QUOTES + DIGITS + NOT_TEXT + OTHERS


def one_finding(text):
    (found,) = parsed(text).diagnostics
    return found


def fixed(text):
    found = one_finding(text)
    return edited(SourceFile("a.yarc", text), [found.fix])


@pytest.mark.parametrize("character", FOREIGN, ids=lambda one: f"U+{ord(one):04X}")
def test_in_code_each_is_a_finding_at_its_place(character):
    text = f"P0010 STOP\nP0020 MOVEJ 1{character}2 [5] (deg,s)\n"
    found = one_finding(text)
    assert found.code == ("Y0103" if character in NOT_TEXT else "Y0118")
    assert (found.span.line, found.span.column, found.span.end_column) == (2, 14, 15)
    assert f"U+{ord(character):04X} " in found.message
    assert found.help
    put = "\x7f" if found.fix is None else "".join(edit.text for edit in found.fix.edits)
    if character in BLANKS + BREAKS:
        assert put == " "
    elif character in UNSEEN + TURNS:
        assert put == ""
    elif character in MINUS:
        assert put == "-"
    elif character in QUOTES:
        assert put == '"'
    elif character in DIGITS:
        assert put in "0123456789"
    else:
        assert found.fix is None


@pytest.mark.parametrize(
    ("character", "name"),
    [
        ("\u00a0", "U+00A0 no-break space"),
        ("\u2028", "U+2028 line separator"),
        ("\ufeff", "U+FEFF byte order mark"),
        ("\x1c", "U+001C file separator"),
        ("\0", "U+0000 null"),
        ("\x85", "U+0085 next line"),
        ("\x81", "U+0081 control character"),
        ("\udc80", "U+DC80 half of a character"),
        ("\u200f", "U+200F right-to-left mark"),
        ("\u2212", "U+2212 minus sign"),
        ("\U000e0fff", "U+E0FFF unknown character"),
    ],
)
def test_names(character, name):
    assert character_name(character) == name


def test_messages_show_only_what_can_be_shown():
    assert one_finding("P1 MOVEJ\u00a0HOME").message == "U+00A0 no-break space isn't allowed in code"
    assert (
        one_finding("P1 MÖVEJ").message
        == "`Ö` (U+00D6 latin capital letter o with diaeresis) isn't allowed in code"
    )
    several = one_finding("P1\u00a0MOVEJ\u00a0HOME\u00a0[5]")
    assert several.message.endswith(", and neither are 2 more of this statement")
    for character in FOREIGN:
        message = one_finding(f"P1 STOP {character}").message
        assert (character in message) == (
            character in MINUS + QUOTES + DIGITS + OTHERS and character.isprintable()
        )


@pytest.mark.parametrize("character", FOREIGN, ids=lambda one: f"U+{ord(one):04X}")
@pytest.mark.parametrize(
    ("line", "where"),
    [("P1 STOP ! a{}b", "a comment"), ('P1 HOLD "a{}b"', "a text"), ("! a{}b", "a comment")],
)
def test_comments_and_texts_hold_what_shows_what_is_read(character, line, where):
    found = parsed(line.format(character)).diagnostics
    if character in BREAKS + TURNS + NOT_TEXT + "\x80\x9f":
        (one,) = found
        assert one.message == f"{character_name(character)} isn't allowed in {where}"
        # no fix for a character that some editors show as a line break: the text after it may be meant as
        # code
        assert (one.fix is None) == (character not in TURNS)
    else:
        assert found == ()


def test_a_line_is_one_finding_and_one_fix():
    text = (
        "P0010\u00a0MOVEJ\u2003\u221230 0\u200b 0 0 0 ٣ [５] (deg,s) ! größer\u00a0als \u2212 \nP0020 STOP\n"
    )
    assert fixed(text) == "P0010 MOVEJ -30 0 0 0 0 3 [5] (deg,s) ! größer\u00a0als \u2212 \nP0020 STOP\n"
    full = "".join(
        chr(ord(one) + 0xFEE0) if one != " " else "\u3000"
        for one in 'P0010 MOVEJ {TCP} 1.5;-2 [50%] (mm,deg) "a"'
    )
    assert fixed(full) == 'P0010 MOVEJ {TCP} 1.5;-2 [50%] (mm,deg) "a"'
    assert one_finding("P0010\u00a0MOVEJ ä").fix is None


def test_a_line_end_of_some_editors_is_one_if_a_statement_follows():
    for character in BREAKS:
        text = f"P0010 MOVEJ{character}HOME [5] (s)  {character}P0020 STOP{character}let A = 3\n"
        assert fixed(text) == "P0010 MOVEJ HOME [5] (s)  \nP0020 STOP\nlet A = 3\n"


def test_a_list_of_way_points_is_one_statement():
    text = "P1 MOVEJ_SPLINE 1\u00a02; ! \u2212\n\u00a0\n 3\u22124 [5]\n"
    assert fixed(text) == "P1 MOVEJ_SPLINE 1 2; ! \u2212\n \n 3-4 [5]\n"


def test_files_that_are_put_together_have_a_mark_within():
    assert fixed("P0010 STOP\n\ufeffP0020 STOP\n") == "P0010 STOP\nP0020 STOP\n"


def test_lines_without_code_have_findings_too():
    assert [one_finding(text).code for text in ("\u00a0", "\f", "\u2028! x", "\t\u200b\t")] == ["Y0118"] * 4


def test_operators_of_other_languages_keep_their_help():
    for operator in "≤≥≠×·÷²³√π°":
        found = one_finding(f"LET A = 2 {operator} 3")
        assert (found.code, found.span.column) == ("Y0111", 11)
    assert fixed("LET A = B \u2013 3\n") == "LET A = B - 3\n"


def test_controls_say_that_it_is_no_text_from_an_editor_as_from_a_file():
    for character in "\0\x1c\x1b\x7f":
        found = one_finding(f"P0010 STOP\nP0020 ST{character}OP")
        (from_file,) = decode_source("a.yarc", f"P0010 STOP\nP0020 ST{character}OP".encode()).diagnostics
        assert (found.code, found.span) == (from_file.code, from_file.span)
        assert character_name(character) in from_file.message


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-be", "utf-32", "utf-32-be"])
def test_other_encodings_are_named(encoding):
    content = "\ufeff".encode(encoding) * encoding.endswith("be") + "P0010 STOP\n".encode(encoding)
    (found,) = decode_source("a.yarc", content).diagnostics
    assert found.code == "Y0103"
    assert encoding[:6].upper() in found.message


@given(st.text(max_size=120))
def test_no_text_makes_a_finding_that_cannot_be_written(text):
    for found in parsed(text).diagnostics:
        (found.message + found.help + (found.fix.title if found.fix else "")).encode("utf-8")


@given(statement, st.data())
def test_a_fix_leaves_nothing_foreign(text, data):
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(text)))
        text = text[:at] + data.draw(st.sampled_from(FOREIGN)) + text[at:]
    # several rounds may be needed: an invisible character after a semicolon splits a statement into two, each
    # with its own finding, and a repaired quotation mark can turn a text into code
    rounds = 0
    while fixes := [one.fix for one in parsed(text).diagnostics if one.fix is not None]:
        rounds += 1
        assert rounds <= 4
        text = edited(SourceFile("a.yarc", text), fixes)
    assume(rounds)
    left = fault_in(text)
    assert left is None or not left.edits


@given(st.text(max_size=60))
def test_what_stands_in_code_is_plain_or_found(text):
    rows = re.split(r"\r\n|\r|\n", text)
    for row in rows:
        in_code = {one for one in code_of(row) if not (" " <= one <= "~" or one == "\t")}
        if in_code and '"' not in row:
            assert fault_in(row) is not None


@given(st.text(alphabet='P1 LET=A+(){}[]"!$,;\u00a0\u2003\u2028\ufeff\x0b\x1c\u2212', max_size=40))
def test_the_grammar_explains_any_text(text):
    """The grammar is used only for characters that are operators elsewhere, but it raises for no text."""
    for row in text.split("\n"):
        statement_by_grammar(row)


def test_every_substitute_is_plain():
    for code in range(0x80, 0x11000):
        put = instead_of(chr(code))
        assert put is None or fault_in(put.replace('"', "")) is None
        assert not is_not_text(chr(code)) or 0xD800 <= code < 0xE000
