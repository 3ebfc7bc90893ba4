"""Parts of programs: which steps belong to them, and at which places they may begin."""

import pytest
from programs import planned

from yarclang.diagnostics import Diagnostic
from yarclang.pipeline.parts import motion_number, part
from yarclang.pipeline.stages import Request
from yarclang.robot.description import load_robot

REQUEST = Request(load_robot("INDUSTRIAL6").value)
TEXT = """DEFAULT [1] (deg,s)
OUTPUT GLUE M1
P0010 WAIT [0.5]
P0020 SET GLUE ON
REPEAT I 2
  P0030 MOVEJ $(10 + I) 0 0 0 0 0
  P0040 WAIT [0.25]
END
P0050 MOVEJ 0 0 0 0 0 0
"""


@pytest.fixture(scope="module")
def plan():
    value, found = planned(TEXT)
    assert value is not None, found
    return value


def places(made):
    return [step.origin.label for step in made.value.program.steps]


def test_what_comes_first_belongs_to_the_first_motion(plan):
    assert places(part(plan, REQUEST, 0, 1)) == ["P0010", "P0020", "P0030(I=0)", "P0040(I=0)"]
    assert places(part(plan, REQUEST, 0, 1, with_lead=False)) == ["P0030(I=0)", "P0040(I=0)"]
    assert places(part(plan, REQUEST, 1, 2)) == ["P0030(I=1)", "P0040(I=1)"]
    assert places(part(plan, REQUEST, 2)) == ["P0050"]


def test_all_parts_together_are_the_program(plan):
    parts = [
        place
        for number in range(len(plan.motions))
        for place in places(part(plan, REQUEST, number, number + 1))
    ]
    assert parts == [step.origin.label for step in plan.program.steps]


@pytest.mark.parametrize(
    ("place", "number"),
    [("P0030", 0), ("p30(i=1)", 1), ("P0030(I=0)", 0), ("P50", 2), ("P0050", 2)],
)
def test_a_motion_by_its_place(plan, place, number):
    assert motion_number(plan, place) == number


@pytest.mark.parametrize("place", ["P0010", "P0030(I=2)", "P0099", "", "x"])
def test_a_place_without_a_motion(plan, place):
    found = motion_number(plan, place)
    assert isinstance(found, Diagnostic)
    assert found.code == "Y1164"
    assert "there are P0030(I=0), P0030(I=1), P0050" in found.help
