"""Tests of the inputs of a simulated robot as a state machine."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from yarclang.simulated_cell.inputs import Inputs, Set
from yarclang.simulated_cell.script import Change, is_reached

TIMES = st.integers(0, 40).map(lambda n: n * 0.25)
PAUSES = st.integers(1, 8).map(lambda n: n * 0.25)
VARIABLES = st.sampled_from(["M11", "M12"])
VALUES = st.sampled_from([0.0, 1.0, 2.5])
REASONS = st.one_of(
    TIMES.map(lambda at: {"at": at}),
    st.sampled_from(["P0010", "P0020"]).map(lambda place: {"place": place}),
    st.tuples(st.just("M1"), VALUES).map(lambda output: {"output": output}),
)
CHANGES = st.builds(
    lambda reason, **rest: Change(**rest, **reason),
    REASONS,
    variable=VARIABLES,
    value=VALUES,
    delay=st.just(0.0) | TIMES,
    toggle=st.none() | st.tuples(PAUSES, PAUSES),
    stuck=st.booleans(),
)
HAPPENINGS = st.lists(
    st.tuples(
        TIMES,
        st.one_of(
            st.tuples(st.just("output_changed"), st.just("M1"), VALUES),
            st.tuples(st.just("reached"), st.sampled_from(["P0010", "P0020(I=1)", "P0020(I=2)", ""])),
            st.tuples(st.just("set"), VARIABLES, VALUES),
        ),
    ),
    max_size=8,
).map(lambda found: sorted(found, key=lambda one: one[0]))


def played(script, happenings, looks, end=12.0):
    """Return all values that are set until `end`, if time advances from event to event and also stops at
    `looks`.
    """
    inputs, made = Inputs(script), []
    inputs.start(0.0)
    steps = [(when, 0, what) for when, what in happenings] + [(when, -1, None) for when in looks]
    for when, _, what in sorted(steps, key=lambda one: one[:2]):
        if what is None:
            made += inputs.advance(when)
        else:
            name, *values = what
            getattr(inputs, name)(*values, when)
    return [*made, *inputs.advance(end)], inputs.values


@given(st.lists(CHANGES, max_size=6), HAPPENINGS, st.lists(st.floats(0.0, 12.0), max_size=12))
def test_values_do_not_depend_on_how_time_is_divided(script, happenings, looks):
    assert played(script, happenings, looks) == played(script, happenings, [])


@given(st.lists(CHANGES, max_size=6), HAPPENINGS)
def test_everything_happens_at_its_time_and_in_order(script, happenings):
    inputs = Inputs(script)
    inputs.start(0.0)
    made, todo, now = [], list(happenings), 0.0
    while (when := min(inputs.next_due, todo[0][0] if todo else math.inf)) <= 12.0:
        now = max(now, when)
        while todo and todo[0][0] <= now:
            name, *values = todo.pop(0)[1]
            getattr(inputs, name)(*values, now)
        new = inputs.advance(now)
        assert all(one.time == now for one in new)
        made += new
    assert made == played(script, happenings, [])[0]


@given(st.lists(CHANGES, max_size=6), HAPPENINGS)
def test_what_is_stuck_is_changed_no_more(script, happenings):
    made, _ = played(script, happenings, [])
    for variable in ("M11", "M12"):
        states = [one.value for one in made if one.variable == variable]
        if all(one.stuck and one.toggle is None for one in script if one.variable == variable) and not any(
            what[0] == "set" and what[1] == variable for _, what in happenings
        ):
            assert len(states) <= 1


def test_an_input_toggles_until_something_else_sets_it():
    script = [
        Change("M11", 1.0, at=1.0, toggle=(1.0, 2.0)),
        Change("M11", 0.0, at=8.5),
    ]
    made, _ = played(script, [], [])
    assert made == [
        Set(when, "M11", value)
        for when, value in ((1.0, 1), (2.0, 0), (4.0, 1), (5.0, 0), (7.0, 1), (8.0, 0), (8.5, 0))
    ]


def test_a_delay_counts_from_the_output():
    script = [Change("M11", 1.0, output=("M1", 1.0), delay=0.5)]
    told = [
        (1.0, ("output_changed", "M1", 1.0)),
        (1.2, ("output_changed", "M1", 1.0)),
        (2.0, ("output_changed", "M1", 0.0)),
        (3.0, ("output_changed", "M1", 1.0)),
    ]
    assert [one.time for one in played(script, told, [])[0]] == [1.5, 3.5]


def test_what_is_stuck_goes_on_toggling():
    script = [Change("M11", 1.0, at=0.0, toggle=(1.0, 1.0), stuck=True)]
    made, _ = played(script, [(2.5, ("set", "M11", 5.0))], [], end=4.0)
    assert [one.value for one in made] == [1, 0, 1, 0, 1]


@pytest.mark.parametrize(
    ("wanted", "place", "before", "reached"),
    [
        ("P0010", "P0010", "", True),
        ("P0010", "P0010(#1)", "P0050(#0)", True),
        ("P0010", "P0020>P0010", "", False),
        ("P0020", "P0020(I=2)>P0010", "P0010", True),
        ("P0020", "P0020(I=2)>P0020", "P0020(I=2)>P0010", False),
        ("P0020", "P0020(I=3)>P0010", "P0020(I=2)>P0020", True),
        ("P0020(I=2)>P0010", "P0020(I=2)>P0010", "", True),
        ("P0020(I=2)>P0010", "P0020(I=3)>P0010", "", False),
        ("P0020>P0010", "P0020(I=3)>P0010", "", True),
        ("p0010", "P0010", "", True),
        ("P0010", "", "P0010", False),
        (">P0010", "P0020(I=2)>P0010(#1)", "P0020(I=2)>P0010", True),
        (">P0010", "P0030>P0010", "P0020>P0010", True),
        (">P0010", "P0030>P0010", "P0030>P0010", False),
        (">P0010", "P0010", "", False),
        (">P0010", "P0030>P0020", "", False),
    ],
)
def test_a_place_is_reached(wanted, place, before, reached):
    assert is_reached(wanted, place, before) == reached


def test_a_command_that_goes_on_is_reached_once():
    script = [Change("M11", 1.0, place="P0010")]
    told = [
        (when, ("reached", place))
        for when, place in ((1.0, "P0010"), (1.1, "P0010"), (2.0, "P0020"), (3.0, "P0010"))
    ]
    assert [one.time for one in played(script, told, [])[0]] == [1.0, 3.0]
