"""Tests of the keys that say what steps do."""

from dataclasses import fields, replace
from typing import get_args

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from programs import checked

from yarclang.cell.keeping import Keep, region_of
from yarclang.hir import (
    Allowed,
    ArcMove,
    LineMove,
    Motion,
    Origin,
    PoseGoal,
    PoseSplineMove,
    Reading,
    Search,
    TimedMove,
    Timetable,
    Timing,
)
from yarclang.identity import fingerprint, flat, key_of
from yarclang.source import SourceFile, Span

plain = st.one_of(
    st.none(),
    st.floats().map(lambda value: np.nan if np.isnan(value) else value),
    st.integers(),
    st.text(),
    st.binary(),
)
parts = st.recursive(plain, lambda inner: st.lists(inner, max_size=3).map(tuple), max_leaves=8)


def spelled(part):
    """Return a value that distinguishes 0.0 from -0.0 and 1 from 1.0, but no two NaNs. (The sign of a NaN is
    ignored, because nothing computes it.)
    """
    return tuple(map(spelled, part)) if isinstance(part, tuple) else (type(part), repr(part))


@given(one=parts, other=parts)
def test_pieces_are_equal_where_their_parts_are(one, other):
    assert (flat(one) == flat(other)) == (spelled(one) == spelled(other))


@given(part=parts)
def test_it_is_the_value_that_counts_not_the_object(part):
    """A string that is built again, or that has two names, has the same key."""
    again = eval(repr(part), {"nan": float("nan"), "inf": float("inf")})
    assert flat(again) == flat(part)
    assert flat(part, part) == flat(again, part)


def test_a_number_of_numpy_is_taken():
    assert flat(np.float64(1.5)) == flat(np.float64(1.5))
    assert flat(np.float64(1.5)) != flat(np.float64(2.5))


SOURCE = SourceFile("a.yarc", "MOVEJ HOME\n")
TIMING = Timing(2.0)


def pose(x):
    base_from_moving = np.eye(4)
    base_from_moving[0, 3] = x
    return PoseGoal(base_from_moving, np.eye(4))


def table(scale):
    rows = np.full((2, 2), scale)
    return Timetable(np.array([1.0, 2.0]) * scale, rows, rows, rows)


OTHERS = {
    "goal": (pose(0.1), pose(0.2)),
    "waypoints": ((pose(0.1), pose(0.2)), (pose(0.1), pose(0.3))),
    "via": (np.zeros(3), np.ones(3)),
    "table": (table(1.0), table(2.0)),
    "within": (np.zeros(2), np.ones(2)),
    "stretch": (1.0, 1.5),
    "profile": ("ONE", "OTHER"),
    "timing": (TIMING, Timing(3.0)),
    "tolerance": (None, 1e-3),
    "blend": (None, Reading(1e-3, None)),
    "search": (None, Search("M12", 1.0, "TOUCH")),
    "file": ("", "path.csv"),
    "allowed": ((), (Allowed("BOX", "GRIPPER"),)),
    "avoids": (False, True),
    "keeps": ((), (Keep("UPRIGHT", "TCP", "B", region_of("UPRIGHT", np.eye(4), np.eye(4), 0.2)),)),
}
"""Two values of each field of a motion. A new field needs a pair here."""


@pytest.mark.parametrize("kind", get_args(Motion))
def test_the_key_of_a_motion_has_every_field(kind):
    """A remembered proof is never used for a motion that does something else."""
    named = [one.name for one in fields(kind) if one.name != "origin"]
    origin = Origin("P0010", "MOVE", SOURCE, Span.on_line(1, 1, 2))
    values = {name: OTHERS[name][0] for name in named}
    step = kind(origin=origin, **values)
    assert key_of(kind(origin=replace(origin, index="P0020"), **values)) == key_of(step)
    for name in named:
        is_same = key_of(replace(step, **{name: OTHERS[name][1]})) == key_of(step)
        assert is_same == (name == "file")  # the name of a table's file doesn't change the motion


@pytest.mark.parametrize("part", ["times", "positions", "velocities", "accelerations"])
def test_the_key_of_a_timetable_has_all_of_its_rows(part):
    origin = Origin("P0010", "MOVEJ_TIMED", SOURCE, Span.on_line(1, 1, 2))
    rows = table(1.0)
    steps = [
        TimedMove(origin, one, np.zeros(2), 1.0, TIMING)
        for one in (rows, replace(rows, **{part: getattr(rows, part) * 2.0}))
    ]
    assert key_of(steps[0]) != key_of(steps[1])


@pytest.mark.parametrize("kind", get_args(Motion))
def test_every_motion_says_where_it_ends(kind):
    origin = Origin("P0010", "MOVE", SOURCE, Span.on_line(1, 1, 2))
    values = {one.name: OTHERS[one.name][0] for one in fields(kind) if one.name != "origin"}
    step = kind(origin=origin, **values)
    if kind is TimedMove:
        assert step.goals == ()
        assert step.flange_from_moving is None
        np.testing.assert_array_equal(step.end.q, values["table"].positions[-1])
    else:
        assert step.goals[-1] is step.end
        np.testing.assert_array_equal(step.flange_from_moving, np.eye(4))
    assert step.leads_frame == (kind in (LineMove, ArcMove, PoseSplineMove))


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("P0010 MOVEJ 10 0 0 0 0 0 [MIN]", "P0010 MOVEJ 10 0 0 0 0 0 [V<=250]"),
        ("P0010 MOVEJ 10 0 0 0 0 0 [V<=250]", "P0010 MOVEJ 10 0 0 0 0 0 [V<=251]"),
        ("P0010 MOVEJ 10 0 0 0 0 0 BLEND 2", "P0010 MOVEJ 10 0 0 0 0 0 BLEND <=2"),
    ],
)
def test_ceilings_and_blends_that_may_be_less_are_part_of_a_program(one, other):
    head = "DEFAULT {TCP} [MIN] (mm,deg,s) {B}\n"
    tail = "\nP0020 MOVEJ 0 0 0 0 0 0"
    marks = [fingerprint(checked(f"{head}{line}{tail}")[0]) for line in (one, other)]
    keys = [key_of(checked(f"{head}{line}{tail}")[0].steps[0]) for line in (one, other)]
    assert marks[0] != marks[1]
    assert keys[0] != keys[1]
