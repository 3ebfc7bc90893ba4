"""Tests of start zones of a cell, which are joint windows of all joints in the cell's units. Mistakes are
reported at their lines.
"""

import numpy as np
import pytest
from cell.test_description import read
from hypothesis import given
from hypothesis import strategies as st
from programs import codes

from yarclang.cell.starts import start_zone

ALL = "J1 = [-10, 10], J2 = [-20, 20], J3 = [-30, 30], J4 = [-40, 40], J5 = [-50, 50], J6 = [-60, 60]"
HALF = np.radians([10.0, 20, 30, 40, 50, 60])


def starts(joints=ALL, name='"HOME"', units="mm,deg"):
    return f'units = "{units}"\n[[starts]]\nname = {name}\njoints = {{ {joints} }}\n'


def test_a_start_zone_has_all_joints_in_si():
    made = read(starts())
    assert made.diagnostics == ()
    (zone,) = made.value.starts
    assert zone.name == "HOME"
    assert zone.window.upper == pytest.approx(HALF)
    assert zone.window.lower == pytest.approx(-HALF)


@given(st.tuples(*(st.floats(-1.5, 1.5) for _ in range(6))))
def test_the_robot_stands_in_it_if_all_joints_do(share):
    cell = read(starts()).value
    found = start_zone(cell, np.array(share) * HALF)
    assert (found is not None) == bool((np.abs(np.array(share) * HALF) <= cell.starts[0].window.upper).all())


def test_two_zones_and_no_cell():
    both = read(starts() + starts(ALL.replace("[-10, 10]", "[80, 100]"), '"PARK"').split("\n", 1)[1]).value
    assert start_zone(both, np.radians([90.0, 0, 0, 0, 0, 0])).name == "PARK"
    assert start_zone(both, np.radians([50.0, 0, 0, 0, 0, 0])) is None
    assert start_zone(None, np.zeros(6)) is None


@pytest.mark.parametrize(
    ("text", "code", "said"),
    [
        (starts(ALL.rpartition(", J6")[0]), "Y1308", "doesn't limit J6"),
        (starts("J1 = [-1, 1]"), "Y1308", "doesn't limit J2, J3, J4, J5, J6"),
        (starts(ALL.replace("[-10, 10]", "[10, -10]")), "Y1316", "must be below its end"),
        (starts(ALL.replace("[-10, 10]", "[-10, 10, 3]")), "Y1309", "must have 2 values, but has 3"),
        (starts(ALL.replace("J6", "J7")), "Y1372", "has no joint J7"),
        (starts(name='"2 many"'), "Y1310", "which a program can't write"),
        (starts() + starts().split("\n", 1)[1], "Y1311", "HOME is already used for"),
        ('[[starts]]\nname = "HOME"\njoints = { J1 = [-1, 1] }\n', "Y0304", "unit"),
        ('units = "mm,deg"\n[[starts]]\njoints = { J1 = [-1, 1] }\n', "Y1304", "name"),
        ('units = "mm,deg"\n[[starts]]\nname = "HOME"\n', "Y1304", "joints"),
        ('units = "mm,deg"\n[[starts]]\nname = "HOME"\njoints = 3\n', "Y1306", "joints"),
        ('units = "mm,deg"\nstarts = 3\n', "Y1306", "[[starts]]"),
        (starts() + 'rule = "allowed"\n', "Y1305", "doesn't know the key rule"),
    ],
)
def test_what_is_no_start_zone_is_said(text, code, said):
    made = read(text)
    assert code in codes(made.diagnostics)
    told = " ".join(f"{one.message} {one.help}" for one in made.diagnostics)
    assert said in told, told
