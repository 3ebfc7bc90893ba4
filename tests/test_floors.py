"""Tests of floors: a test without exercised cases fails, whatever made it leave them."""

import pytest
from floors import Tally, exercises
from hypothesis import assume, given
from hypothesis import strategies as st


@exercises(even=0.2)
@given(st.integers(0, 9))
def half(tally, number):
    tally.count("even", number % 2 == 0)


@exercises(even=0.2)
@given(number=st.integers(0, 9))
def none(tally, number):
    tally.count("even", False)


@exercises(even=0.0)
@given(number=st.integers(0, 9))
def uncounted(tally, number):
    assume(number < 9)


def test_a_run_that_exercises_enough_passes():
    half()


@pytest.mark.parametrize("empty", [none, uncounted])
def test_an_empty_run_fails(empty):
    with pytest.raises(AssertionError, match="even: 0 of"):
        empty()


def test_an_unlucky_round_is_followed_by_others():
    rounds = []

    @exercises(one=0.5)
    def unlucky(tally):
        rounds.append(len(rounds) >= 2)
        tally.count("one", rounds[-1])

    unlucky()
    assert rounds == [False, False, True, True]


@pytest.mark.parametrize(("reached", "passes"), [(2, False), (3, True)])
def test_a_floor_is_a_share_of_what_is_drawn(reached, passes):
    tally = Tally()
    for number in range(10):
        tally.count("one", number < reached)
    assert (tally.below({"one": 0.3}) == []) == passes


@pytest.mark.parametrize("word", ["a", "b"])
@exercises(short=1.0)
@given(count=st.integers(1, 3))
def test_parameters_and_drawn_values_come_together(tally, word, count):
    tally.count("short", len(word * count) <= 3)
