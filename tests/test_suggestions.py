"""Tests of suggestions for mistyped words: the nearest name is suggested, and the time of the search is
bounded.
"""

import random
import string
from difflib import SequenceMatcher
from functools import cache

import pytest

from yarclang.subjects import suggest
from yarclang.suggestions import _common, _places, is_slip, nearest


def ratio(word, name):
    """Return the similarity of two words by difflib."""
    return SequenceMatcher(None, name, word).ratio()


@cache
def table(one, other):
    """Return the length of the longest common subsequence of two words, by its definition."""
    if not one or not other:
        return 0
    if one[0] == other[0]:
        return 1 + table(one[1:], other[1:])
    return max(table(one[1:], other), table(one, other[1:]))


def mistyped(chance, name):
    """Return a name with one or two mistakes."""
    for _ in range(chance.choice((1, 2))):
        at = chance.randrange(len(name))
        kind = chance.randrange(3)
        put = chance.choice(string.ascii_uppercase) if kind < 2 else ""
        name = name[:at] + put + name[at + (kind > 0) :]
    return name


def test_of_many_names_the_nearest_is_named():
    chance, near = random.Random(7), 0
    for _ in range(300):
        names = ["".join(chance.choices("ABCDEFG_12", k=chance.randrange(4, 30))) for _ in range(60)]
        word = mistyped(chance, chance.choice(names))
        said = nearest(word, names)
        best = max(ratio(word, name) for name in names)
        assert not said or ratio(word, said) >= 0.6
        near += said == "" if best < 0.6 else ratio(word, said) == best
    assert near >= 295


@pytest.mark.parametrize("length", [40, 100, 190])
def test_long_names_are_suggested(length):
    chance = random.Random(length)
    names = ["".join(chance.choices(string.ascii_uppercase, k=length)) for _ in range(50)]
    for name in names[:10]:
        assert nearest(mistyped(chance, name), names) == name


@pytest.mark.parametrize("length", [40, 190])
def test_names_of_few_letters_do_not_take_the_square_of_their_length_for_each_name(length, monkeypatch):
    looked = []
    right = SequenceMatcher.find_longest_match

    def counted(self, *place):
        looked.append(len(self.a))
        return right(self, *place)

    monkeypatch.setattr(SequenceMatcher, "find_longest_match", counted)
    names = tuple("AB" * (length // 2) + str(number) for number in range(100))
    assert suggest("BA" * (length // 2) + "5", names)
    assert 0 < sum(looked) < 1_500  # only a few names are compared, each a few times


def test_a_swap_of_two_letters_is_undone():
    assert suggest("MOVJE", ["MOVE", "MOVEJ", "MOVEL", "MOVJ"]) == "did you mean MOVEJ?"
    assert suggest("tpc", ["tcp", "tp", "tc"]) == "did you mean tcp?"
    assert suggest("", ["A"]) == suggest("XYZ", ["ABC"]) == suggest("A", []) == ""


def test_the_longest_common_subsequence_is_that_of_its_definition():
    chance = random.Random(3)
    for _ in range(500):
        one, other = ("".join(chance.choices("ABC1", k=chance.randrange(9))) for _ in range(2))
        assert _common(_places(one), len(one), other) == table(one, other)


@pytest.mark.parametrize(
    ("word", "name"),
    [("REDY", "READY"), ("BNECH", "BENCH"), ("MOVEJJ", "MOVEJ"), ("pikc", "PICK"), ("PIICK", "PICK")],
)
def test_a_slip_of_the_fingers(word, name):
    assert is_slip(word, name)


@pytest.mark.parametrize(
    ("word", "name"),
    [
        ("PICK2", "PICK1"),
        ("PICK12", "PICK21"),
        ("PICK", "PICK1"),
        ("SIDE_B", "SIDE_A"),
        ("PART", "PARTS"),
        ("GRIP_CLOSE", "GRIP_OPEN"),
        ("UP", "UPS"),
        ("IN", "ON"),
        ("READY", "READY"),
    ],
)
def test_another_name_is_no_slip(word, name):
    assert not is_slip(word, name)
    assert not is_slip(name, word)
