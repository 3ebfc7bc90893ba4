"""Tests of words of other robot languages: the finding names the word to use instead."""

import pytest
from programs import planned

from yarclang.commands.registry import actions, commands
from yarclang.semantics.names.foreign import INSTEAD
from yarclang.syntax.words import RESERVED

HEAD = "INPUT DOOR M11\nOUTPUT GLUE M1 OFF\n"


def told_of(line, code):
    _, found = planned(HEAD + line + "\nP0900 STOP\n")
    return next(one for one in found if one.span.line == 3 and one.code == code)


@pytest.mark.parametrize("word", sorted(INSTEAD))
def test_each_word_is_answered_with_what_serves(word):
    assert told_of(f"P0010 {word} DOOR", "Y0202").help == INSTEAD[word]


def test_no_word_of_the_language_is_foreign():
    assert not INSTEAD.keys() & (set(RESERVED) | set(commands()) | set(actions()))


@pytest.mark.parametrize(
    ("line", "code", "told"),
    [
        ("P0010 GOTO P0900", "Y0202", "CALL"),
        ("IF DOOR = 1", "Y0209", "WHEN"),
    ],
)
def test_what_people_write_of_other_languages(line, code, told):
    assert told in told_of(line, code).help
