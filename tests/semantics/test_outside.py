"""Tests of REGISTER ... OUTSIDE: the lines that may declare such a register, and the WAITs that may depend
only on one.
"""

import pytest
from programs import checked, codes

from yarclang.hir import WaitUntil, When
from yarclang.identity import fingerprint


@pytest.mark.parametrize(
    ("line", "first"),
    [
        ("REGISTER X -500..500 OUTSIDE", -500),
        ("REGISTER X -500..500 7 OUTSIDE", 7),
        ("register x -500..500 outside", -500),
    ],
)
def test_it_is_declared(line, first):
    program, found = checked(f"{line}\nP0010 WAIT X > 8 [5] (s)\n")
    assert not [one for one in found if one.is_error]
    (register,) = program.registers
    assert (register.name, register.low, register.first, register.outside) == ("X", -500, first, True)
    assert not register.kept
    assert [type(one) for one in program.steps] == [WaitUntil]


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("REGISTER X 0..5 OUTSIDE KEPT\nP0010 WAIT X > 3 [5] (s)", "Y0431"),
        ("REGISTER X 0..5 KEPT OUTSIDE\nP0010 WAIT X > 3 [5] (s)", "Y0431"),
        ("REGISTER X 0..5 OUTSIDE OUTSIDE\nP0010 WAIT X > 3 [5] (s)", "Y0431"),
        ("REGISTER X OUTSIDE\nP0010 WAIT [5] (s)", "Y0431"),
        ("REGISTER X 0..5 9 OUTSIDE\nP0010 WAIT [5] (s)", "Y0431"),
        ("REGISTER X 0..5\nP0010 WAIT X > 3 [5] (s)", "Y0440"),
        ("REGISTER X 0..5\nREGISTER Y 0..5 OUTSIDE\nP0010 WAIT X > 3 [5] (s)", "Y0440"),
    ],
)
def test_what_is_wrong_is_said(text, code):
    _, found = checked(text + "\n")
    assert code in codes(found)


def test_an_outside_register_beside_another_may_change():
    text = 'REGISTER N 0..5\nREGISTER X 0..5 OUTSIDE\nP0010 WAIT X > N [5] (s) ELSE\nP0020 SAY "no"\nEND\n'
    program, found = checked(text)
    assert not [one for one in found if one.is_error]
    assert isinstance(program.steps[0], When)


def test_a_wait_for_ever_is_warned_of():
    _, found = checked("REGISTER X 0..5 OUTSIDE\nP0010 WAIT X > 3\n")
    assert "Y1003" in codes(found)


def test_a_program_that_takes_values_is_another_one():
    """OUTSIDE changes a program's fingerprint; the fingerprint of a program without it must never change."""
    text = "REGISTER X 0..5{}\nINPUT DOOR M11\nP0010 WAIT X > 3 OR DOOR = ON [5] (s)\n"
    (plain, _), (outside, _) = (checked(text.format(one)) for one in ("", " OUTSIDE"))
    assert fingerprint(plain) != fingerprint(outside)
    assert fingerprint(plain) == "07ac26ccb7ea1dd11d032e8c94a6560886d3cf5d5207136d0895d0fe6b2de029"
