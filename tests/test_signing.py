"""Tests of signatures of the entries in a cache folder."""

from hypothesis import given
from hypothesis import strategies as st

from yarclang.signing import is_signed, signature

SECRET = bytes(range(32))


@given(st.lists(st.binary(max_size=8), max_size=4), st.lists(st.binary(max_size=8), max_size=4))
def test_other_contents_have_another_signature(one, other):
    assert is_signed(signature(SECRET, one), SECRET, other) == (one == other)


def test_the_places_at_which_contents_end_are_signed():
    assert not is_signed(signature(SECRET, (b"ab", b"c")), SECRET, (b"a", b"bc"))
    assert not is_signed(signature(SECRET, (b"", b"a")), SECRET, (b"a", b""))
