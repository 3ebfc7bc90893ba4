"""Keys of what steps do."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from yarclang.identity import flat

plain = st.one_of(
    st.none(),
    st.floats().map(lambda value: np.nan if np.isnan(value) else value),
    st.integers(),
    st.text(),
    st.binary(),
)
parts = st.recursive(plain, lambda inner: st.lists(inner, max_size=3).map(tuple), max_leaves=8)


def spelled(part):
    """What is to be told apart: 0.0 is another value than -0.0, 1 another than 1.0, and any NaN is like another (of either sign, which nothing computes)."""
    return tuple(map(spelled, part)) if isinstance(part, tuple) else (type(part), repr(part))


@given(one=parts, other=parts)
def test_pieces_are_equal_where_their_parts_are(one, other):
    assert (flat(one) == flat(other)) == (spelled(one) == spelled(other))


@given(part=parts)
def test_it_is_the_value_that_counts_not_the_object(part):
    """A text that was put together anew, or that another name holds as well, is the same."""
    again = eval(repr(part), {"nan": float("nan"), "inf": float("inf")})
    assert flat(again) == flat(part)
    assert flat(part, part) == flat(again, part)


def test_a_number_of_numpy_is_taken():
    assert flat(np.float64(1.5)) == flat(np.float64(1.5))
    assert flat(np.float64(1.5)) != flat(np.float64(2.5))
