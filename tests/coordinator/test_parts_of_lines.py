"""Tests of splitting a text into declarations, which stay in a session, and commands, which are carried out
once.
"""

import pytest
from programs import source

from yarclang.coordinator.lines import parts_of
from yarclang.syntax.parse import parse


@pytest.mark.parametrize(
    ("text", "stay", "done"),
    [
        ("LET A = 1\nMOVEJ HOME", 1, 1),
        ("FUNC F(A) = A\nTABLE T POSE 0 0 0 0 0 0", 2, 0),
        ("SUB S\nMOVEJ HOME\nEND", 1, 0),
        ("IF 1\nLET A = 1\nELSE\nLET A = 2\nEND", 1, 0),
        ("IF 1\nIF 0\nLET A = 1\nEND\nEND", 1, 0),
        ("IF 1\nLET A = 1\nMOVEJ HOME\nELSE\nLET A = 2\nEND", 0, 1),
        ("REPEAT 2\nLET A = 1\nEND", 0, 1),
    ],
)
def test_declarations_stay_and_an_if_that_only_declares(text, stay, done):
    parts = parts_of(parse(source(text)).value)
    assert (len(parts.declarations), len(parts.commands)) == (stay, done)
    assert "\n".join((*parts.declarations, *parts.commands)) == text
