"""Tests of the Pygments lexer: it knows all words, loses no character, and finds no error in the examples."""

import doctest
import re

import pytest
from conftest import EXAMPLES, HERE
from hypothesis import given
from hypothesis import strategies as st
from pygments.lexers import get_lexer_by_name, get_lexer_for_filename
from pygments.token import Comment, Error, Keyword, Name, Number, Token

from yarclang.commands.registry import commands
from yarclang.highlight.lexer import YarcLexer
from yarclang.highlight.words import words
from yarclang.motion.profile import profile_names
from yarclang.source import SourceFile
from yarclang.syntax.lines import code_of
from yarclang.syntax.words import DECLARATIONS, RESERVED
from yarclang.units import UNITS

PROGRAMS = [*sorted(EXAMPLES.glob("*.yarc")), *sorted((HERE.parent / "stdlib" / "modules").glob("*.yarc"))]
BLANK = Token.Text.Whitespace


def kinds(line):
    return [(kind, piece) for _, kind, piece in YarcLexer().get_tokens_unprocessed(line) if kind is not BLANK]


def test_others_find_it():
    assert isinstance(get_lexer_by_name("yarc"), YarcLexer)
    assert isinstance(get_lexer_for_filename("a.yarc"), YarcLexer)


@pytest.mark.parametrize("path", PROGRAMS, ids=lambda path: path.stem)
def test_no_error_in_programs(path):
    text = path.read_text()
    pieces = list(YarcLexer().get_tokens_unprocessed(text))
    assert [piece for _, kind, piece in pieces if kind is Error] == []
    assert "".join(piece for _, _, piece in pieces) == text


def test_a_command():
    assert kinds("P0010 MOVEJ_RPY_LSPB {TCP} 1.5 [MIN] (mm,deg) ! x") == [
        (Name.Label, "P0010"),
        (Name.Function, "MOVEJ"),
        (Name.Decorator, "_RPY_LSPB"),
        (Name.Namespace, "{TCP}"),
        (Number, "1.5"),
        (Token.Punctuation, "["),
        (Keyword.Constant, "MIN"),
        (Token.Punctuation, "]"),
        (Token.Punctuation, "("),
        (Keyword.Type, "mm"),
        (Token.Punctuation, ","),
        (Keyword.Type, "deg"),
        (Token.Punctuation, ")"),
        (Comment.Single, "! x"),
    ]


@pytest.mark.parametrize("spec", commands().values(), ids=lambda spec: spec.name)
def test_all_commands_with_all_suffixes(spec):
    for suffix in ("", *spec.targets, *(profile_names() if spec.is_motion else ())):
        name = "_".join(filter(None, (spec.name, suffix)))
        assert kinds(f"P0010 {name}")[1] == (Name.Function, spec.name)
        assert "".join(piece for _, piece in kinds(name)) == name
        assert (Name, name) not in kinds(name)


def test_all_reserved_words_are_known():
    for word in sorted(RESERVED):
        call = f"{word}(1)" if word in words().functions else word
        assert kinds(call)[0][0] is not Name, word
    for word in DECLARATIONS:
        assert kinds(word)[0][0] in (Keyword, Keyword.Declaration)
    for unit in UNITS:
        assert kinds(f"3 ({unit})")[2] == (Keyword.Type, unit)


@given(st.text(alphabet=st.characters(codec="utf-8"), max_size=80))
def test_any_text_comes_back_whole(text):
    pieces = list(YarcLexer().get_tokens_unprocessed(text))
    assert "".join(piece for _, _, piece in pieces) == text
    at = 0
    for start, _, piece in pieces:
        assert start == at
        assert piece
        at += len(piece)


@given(st.lists(st.sampled_from([*'{}!"P1 TCP;$\n\r', "{TCP}", "\u2028", "\x0b"]), max_size=30).map("".join))
def test_comments_are_those_of_the_compiler(text):
    for line in SourceFile("a.yarc", text).lines:
        comments = [piece for kind, piece in kinds(line) if kind is Comment.Single]
        assert "".join(comments) == line[len(code_of(line)) :]


def test_lines_are_those_of_the_compiler():
    assert (Name.Function, "STOP") not in kinds("! a comment\u2028P0010 STOP\x0bP0020 STOP")
    assert (Error, "\u00a0") in kinds("P0010\u00a0STOP")


def test_what_it_does_not_know_is_an_error():
    assert (Error, "#") in kinds("P0010 MOVEJ # 1")
    assert not re.search("Error", str(kinds("P0010 MOVEJ 1")))


def test_the_page_of_editors_shows_it():
    page = HERE.parent / "docs" / "editors.md"
    failures, tried = doctest.testfile(str(page), module_relative=False)
    assert (failures, tried) == (0, 4)
