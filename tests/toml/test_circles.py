"""Tests of finding circles in tables of parents."""

from hypothesis import given
from hypothesis import strategies as st

from yarclang.toml.circles import circles


def test_each_circle_is_told_once():
    parents = {"A": "B", "B": "C", "C": "A", "D": "A", "E": "E", "F": "ROOT", "G": "F"}
    assert list(circles(parents)) == [["A", "B", "C"], ["E"]]
    assert list(circles({})) == []


@given(st.dictionaries(st.sampled_from("ABCDEFGH"), st.sampled_from("ABCDEFGHR")))
def test_what_never_gets_to_an_end_is_or_leads_to_a_circle(parents):
    found = list(circles(parents))
    ring = [name for circle in found for name in circle]
    assert len(ring) == len(set(ring))
    for circle in found:
        assert [parents[name] for name in circle] == [*circle[1:], circle[0]]
    for name in parents:
        here = name
        for _ in range(len(parents) + 1):
            here = parents.get(here, "")
        assert (here in ring) == bool(here)
