"""Tests of BLEND <=20: the blend is as large as possible, up to this value."""

import re

import pytest
from programs import codes, compiled

HEAD = "DEFAULT {TCP} [MIN] (mm,deg,s) {B}\nP0010 MOVEJ_RPY 0 1174.4 1176 0 0 0\n"
LINES = (
    "P0020 MOVEL 150 1174.4 1176 0 0 0 BLEND {0}\n"
    "P0030 MOVEL 150 1174.4 1216 0 0 0 BLEND {1}\n"
    "P0040 MOVEL 0 1174.4 1216 0 0 0"
)
JOINTS = (
    "P0020 MOVEJ 20 -6 -46 0 50 0 BLEND {0}\n"
    "P0030 MOVEJ 20 0 -46 0 50 0 BLEND {1}\n"
    "P0040 MOVEJ 0 0 -20 0 40 0"
)
MIXED = (
    "P0020 MOVEL 150 1174.4 1176 0 0 0 BLEND {0}\nP0030 MOVEJ 0 0 0 0 0 0 BLEND {1}\nP0040 MOVEJ 0 10 0 0 0 0"
)


def moves(text):
    return re.findall(r"(?m)^(?:TM|[XYZABC]).*$", text)


@pytest.mark.parametrize(
    ("lines", "asked", "taken"),
    [
        (LINES, ("<=80", "<=10"), ("20", "10")),
        (LINES, ("<=80", "<=80"), ("20", "20")),
        (LINES, ("<=5", "10"), ("5", "10")),
        (LINES, ("<=$(40+40)", "0.5"), ("20", "0.5")),
        (JOINTS, ("<=20", "<=1"), ("3", "1")),
        (JOINTS, ("<=2", "<=90"), ("2", "3")),
        (MIXED, ("<=30", "<=5"), ("30", "5")),
    ],
)
def test_it_is_the_blend_that_there_is_room_for(lines, asked, taken):
    some, found = compiled(HEAD + lines.format(*asked))
    same, _ = compiled(HEAD + lines.format(*taken))
    assert not [one for one in found if one.is_error], found
    assert moves(some.text) == moves(same.text)


@pytest.mark.parametrize("lines", [LINES, JOINTS])
def test_without_the_sign_too_much_stays_an_error_that_names_it(lines):
    _, found = compiled(HEAD + lines.format("80", "1"))
    assert codes(found)[:1] == ["Y0606"]
    assert "BLEND <= uses the largest that fits" in found[0].help


@pytest.mark.parametrize(
    "option", ["BLEND <=0", "BLEND <=-1", "BLEND <=HOME", "BLEND <=5%", "TOL <=1", "ACC <=50%"]
)
def test_nothing_else_is_at_most(option):
    _, found = compiled(f"{HEAD}P0020 MOVEL 150 1174.4 1176 0 0 0 {option}\nP0030 MOVEL 0 1174.4 1176 0 0 0")
    assert codes(found) == ["Y0412"]


def test_a_number_stands_behind_the_sign():
    _, found = compiled(HEAD + LINES.format("<=", "1"))
    assert codes(found) == ["Y0101"]
