"""Tests of finding commands by index and place."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from yarclang.pipeline.places import matching, parts_of

LABELS = {
    0: "P0010",
    1: "P0020(I=0)>P0010",
    2: "P0020(I=0)>P0020",
    3: "P0020(I=1)>P0010",
    4: "P0020(I=1)>P0020",
    5: "P0030(ROW=0,COLUMN=1)",
    6: "P0030(ROW=1,COLUMN=1)",
    7: "P0040>P0050>P0070",
}


@pytest.mark.parametrize(
    ("text", "numbers"),
    [
        ("P0010", (0,)),
        ("p10", (0,)),
        ("P0020(I=1)>P0010", (3,)),
        ("p20 (i=1) > p10", (3,)),
        ("P0020", (1, 2, 3, 4)),
        ("P0020(I=1)", (3, 4)),
        ("P0020>P0010", (1, 3)),
        ("P0030(COLUMN=1)", (5, 6)),
        ("P0030(ROW=1)", (6,)),
        ("P0070", (7,)),
        ("P0050>P0070", (7,)),
        ("P0099", ()),
        ("P0020(I=2)", ()),
        ("nonsense", ()),
        ("", ()),
        (">", ()),
    ],
)
def test_what_a_text_means(text, numbers):
    assert matching(LABELS, text) == numbers


@given(st.sampled_from(sorted(LABELS)))
def test_a_whole_place_means_itself(number):
    assert matching(LABELS, LABELS[number]) == (number,)


@given(st.text(max_size=30))
def test_any_text_is_a_place_or_none(text):
    parts = parts_of(text)
    assert parts is None or parts
    matching(LABELS, text)
