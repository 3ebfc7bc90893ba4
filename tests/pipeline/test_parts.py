"""Tests of parts of programs: the steps that belong to a part, and the places at which one may begin."""

import pytest
from programs import planned

from yarclang.diagnostics import Diagnostic
from yarclang.pipeline.parts import beginning, can_begin_at, chain_place, chains, motion_number, part
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
    assert "the indexes are P0030(I=0), P0030(I=1), P0050" in found.help


CHAIN = """DEFAULT [1] (deg,s)
OUTPUT GLUE M1
P0010 MOVEJ 10 0 0 0 0 0
REPEAT I 2
  P0020 MOVEJ $(20 + I) 0 0 0 0 0 BLEND 2
  P0030 SET GLUE ON
  P0040 MOVEJ $(20 + I) 10 0 0 0 0
END
P0050 MOVEJ 0 0 0 0 0 0 BLEND 2
P0060 MOVEJ 0 0 10 0 0 0 BLEND 2
P0070 MOVEJ 0 0 10 0 10 0
"""


@pytest.fixture(scope="module")
def blended():
    value, found = planned(CHAIN)
    assert value is not None, found
    assert [motion.flows for motion in value.motions] == [0, 1, 0, 1, 0, 1, 1, 0]
    return value


def test_motions_that_flow_into_each_other_are_one_group(blended):
    assert chains(blended) == [(0, 1), (1, 3), (3, 5), (5, 8)]
    assert chains(blended, 3) == [(3, 5), (5, 8)]


def test_the_groups_are_the_whole_motion(blended):
    durations = [part(blended, REQUEST, first, last).value.plan.duration for first, last in chains(blended)]
    assert sum(durations) == pytest.approx(blended.duration, abs=1e-9)
    whole = part(blended, REQUEST, 5).value.plan.motions
    for made, motion in zip(whole, blended.motions[5:], strict=True):
        assert made.curve.points == pytest.approx(motion.curve.points, abs=1e-12)


@pytest.mark.parametrize(("first", "last"), [(2, None), (4, 5), (6, 8), (7, None), (1, 2), (5, 7)])
def test_a_part_never_begins_or_ends_in_a_corner(blended, first, last):
    refused = part(blended, REQUEST, first, last)
    assert refused.value is None
    assert [one.code for one in refused.diagnostics] == ["Y1608"]


def test_the_motion_that_begins_the_chain_is_named(blended):
    (inner,) = part(blended, REQUEST, 7).diagnostics
    assert inner.message.startswith("P0060 MOVEJ flows into P0070 MOVEJ")
    assert inner.help == "begin with P0050 MOVEJ, where the chain begins: --from P0050"
    assert inner.span.line == 11
    (looped,) = part(blended, REQUEST, 4).diagnostics
    assert looped.help.endswith("--from 'P0020(I=1)'")


@pytest.mark.parametrize(
    ("place", "begins"),
    [
        ("P0010", "P0010"),
        ("P0040(I=1)", "P0020(I=1)"),
        ("P0070", "P0050"),
        ("P0050", "P0050"),
        ("P0099", "P0099"),
        ("", ""),
    ],
)
def test_where_to_go_on(blended, place, begins):
    assert chain_place(blended, place) == begins


def test_a_program_may_begin_where_the_robot_stands(plan):
    """A program may begin at a WAIT or a SET: the robot then stands where the next motion begins."""
    labels = [step.origin.label for step in plan.program.steps]
    for place, number in (("P0020", 0), ("P0040(I=0)", 1), ("P0040(I=1)", 2), ("P0030(I=1)", 1)):
        assert beginning(plan, place) == (number, labels.index(place))
        assert can_begin_at(plan, place)
    number, step = beginning(plan, "P0040(I=0)")
    assert places(part(plan, REQUEST, number, step=step)) == [
        "P0040(I=0)",
        "P0030(I=1)",
        "P0040(I=1)",
        "P0050",
    ]
    assert isinstance(beginning(plan, "P0070"), Diagnostic)


def test_nothing_begins_after_the_last_motion_or_within_a_when():
    text = """DEFAULT [1] (deg,s)
INPUT DOOR M11
P0010 MOVEJ 10 0 0 0 0 0
WHEN DOOR ON
  P0020 WAIT [1]
  P0030 MOVEJ 20 0 0 0 0 0
  P0035 MOVEJ 10 0 0 0 0 0
END
P0040 MOVEJ 0 0 0 0 0 0
P0050 WAIT [1]
"""
    value, found = planned(text)
    assert value is not None, found
    finding = beginning(value, "P0050")
    assert finding.code == "Y1164"
    assert "P0040 MOVEJ" in finding.help
    assert not can_begin_at(value, "P0020")
    assert can_begin_at(value, "P0040")


WAYS = """\
INPUT DOOR M11
REGISTER N 0..9
DEFAULT [1] (deg,s)
P0010 MOVEJ 5 0 0 0 0 0
WHEN DOOR ON
  P0020 MOVEJ 10 0 0 0 0 0
  P0030 MOVEJ 5 0 0 0 0 0
END
P0040 MOVEJ 0 0 0 0 0 0
LOOP
  P0050 MOVEJ 1 0 0 0 0 0
  WHEN N = 3
    P0060 EXIT
  END
  P0070 MOVEJ 0 0 0 0 0 0
END
P0080 MOVEJ 2 0 0 0 0 0
P0090 MOVEJ 3 0 0 0 0 0
"""


def test_ways_and_loops_are_one_group_with_what_stands_before_them():
    program, found = planned(WAYS)
    assert not [one for one in found if one.is_error]
    groups = chains(program)
    assert groups == [(0, 3), (3, 6), (6, 7), (7, 8)]
    for first, last in groups:
        made = part(program, REQUEST, first, last)
        assert made.value is not None, made.diagnostics


@pytest.mark.parametrize("place", ["P0020", "P0030", "P0050", "P0070"])
def test_no_part_begins_in_a_way_or_a_loop(place):
    program, _ = planned(WAYS)
    made = part(program, REQUEST, motion_number(program, place))
    assert made.value is None
    (one,) = made.diagnostics
    assert one.code == "Y1164"
    word = "LOOP" if place in ("P0050", "P0070") else "WHEN"
    assert f"inside a {word}" in one.message
