"""Tests of recognizing typed texts that are complete, and texts that continue on another line."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from yarclang.repl.whole import is_whole


@pytest.mark.parametrize(
    ("text", "whole"),
    [
        ("", True),
        ("MOVEJ 1 2 3 4 5 6 [1] (deg,s)", True),
        ("MOVJE 1 2", True),
        ("REPEAT 2", False),
        ("REPEAT 2\n  DMOVEJ 1 0 0 0 0 0 [1] (deg,s)", False),
        ("REPEAT 2\n  DMOVEJ 1 0 0 0 0 0 [1] (deg,s)\nEND", True),
        ("SUB A\nREPEAT 2\nEND", False),
        ("END", True),
        ("MOVEJ_SPLINE 1 2 3 4 5 6;", False),
        ("MOVEJ_SPLINE 1 2 3 4 5 6; ! more", False),
        ("MOVEJ_SPLINE 1 2 3 4 5 6;\n 2 3 4 5 6 7 [2] (deg,s)", True),
        (".plan REPEAT 2", True),
    ],
)
def test_whole(text, whole):
    assert is_whole(text) is whole


@given(st.text(max_size=60))
def test_any_text_is_whole_or_not(text):
    assert is_whole(text) in (True, False)
