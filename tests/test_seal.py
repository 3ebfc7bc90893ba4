"""Tests of the seal of a controller text: sealing only replaces two lines of the header."""

import hashlib

import pytest

from yarclang.emitted.seal import is_sealed, sealed

HEAD = "; yarcc 1: a.yarc\n; certificate -\n; sha256 -\n"


@pytest.mark.parametrize("rows", [0, 3, 400_000])
def test_both_lines_are_replaced_in_the_header_alone(rows):
    text = HEAD + "X1\n" * rows + "; certificate -\n; sha256 -\n\u00e9\n"
    certified = text.replace("; certificate -", "; certificate fine", 1)
    digest = hashlib.sha256(certified.encode("ascii", "replace")).hexdigest()
    made = sealed(text, "fine")
    assert made == certified.replace("; sha256 -", f"; sha256 {digest}", 1)
    assert is_sealed(made)
    assert not is_sealed(made.replace("X1", "X2", 1) if rows else made.replace("fine", "good"))
