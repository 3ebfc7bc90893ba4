"""Tests of motions around obstacles: they are free everywhere, straight if the straight motion is free, and
equal in each process. If no such motion exists, the finding gives the reason.
"""

import subprocess
import sys

import numpy as np
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.collision.dense import Dense
from tests.motion.avoid.cells import LEFT, POST, RIGHT, ROBOT, WALL, box, cell_of, room
from yarclang.motion.avoid import way as ways
from yarclang.motion.avoid.search import Effort
from yarclang.motion.avoid.smooth import course_of
from yarclang.motion.avoid.way import NoWay, Way, find_way
from yarclang.motion.natural import NaturalSpline
from yarclang.motion.paths.spline import through

PAST = room(POST)


def executed(start, way, count=2000):
    path = through(np.concatenate([start[None], way.waypoints]), ROBOT.chain.is_prismatic)
    return path.joints(np.linspace(0, 1, count))


def worst(q, *obstacles):
    """Return the smallest distance minus margin of all pairs at joint positions, by geometry that shares no
    code with the search.
    """
    dense = Dense(ROBOT, cell_of(*obstacles))
    wanted = np.array([dense.wanted(pair) for pair in range(len(dense.pairs))])
    return float((dense.distances(q) - wanted).min())


def test_past_a_post():
    way = find_way(PAST, LEFT, RIGHT)
    assert isinstance(way, Way)
    assert not way.is_straight
    assert np.array_equal(way.waypoints[-1], RIGHT)
    assert worst(executed(LEFT, way), POST) > 0.0
    straight = LEFT + np.linspace(0, 1, 2000)[:, None] * (RIGHT - LEFT)
    assert worst(straight, POST) < -0.01
    assert set(way.between.names) & {"POST"}


def test_a_margin_is_kept():
    wide = box("POST", [0, 0.7, 0.9], [0.12, 0.12, 1.8], margin=0.1)
    way = find_way(room(wide), LEFT, RIGHT)
    assert worst(executed(LEFT, way), wide) > 0.0


def test_the_straight_way_stays_where_it_is_free():
    way = find_way(PAST, LEFT, LEFT + 0.2)
    assert way.is_straight
    assert np.array_equal(way.waypoints, [LEFT + 0.2])
    assert find_way(None, LEFT, RIGHT).is_straight
    assert find_way(PAST, LEFT, LEFT).is_straight


def test_way_points_can_be_written_with_two_decimals():
    way = find_way(PAST, LEFT, RIGHT)
    written = way.waypoints[:-1] / ROBOT.axis_units
    assert np.abs(written - written.round(2)).max() < 1e-9


BEFORE = np.radians([0.0, 20, -20, 0, -30, 0])


def test_what_is_in_the_way_at_the_ends_is_named():
    blocked = find_way(PAST, LEFT, BEFORE)
    assert isinstance(blocked, NoWay)
    assert blocked.start is None
    assert "POST" in blocked.goal.names
    assert blocked.goal.distance < 0.0
    back = find_way(PAST, BEFORE, LEFT)
    assert back.goal is None
    assert back.start.names == blocked.goal.names


def test_it_gives_up_after_its_samples(monkeypatch):
    monkeypatch.setattr(ways, "EFFORTS", (Effort(0.01, 0.05, 60, 1), Effort(0.001, 0.05, 60, 2)))
    shut = find_way(room(*WALL), LEFT, RIGHT)
    assert isinstance(shut, NoWay)
    assert shut.start is None
    assert shut.goal is None
    assert "WALL" in shut.between.names


ASKED = """
import sys
from tests.motion.avoid.cells import LEFT, POST, RIGHT, room
from yarclang.motion.avoid.way import find_way
around = room(POST)
if sys.argv[1] == "after others":
    find_way(around, RIGHT, LEFT)
    find_way(around, LEFT * 1.1, RIGHT * 1.1)
print(find_way(around, LEFT, RIGHT).waypoints.tobytes().hex())
"""


def test_every_process_finds_the_same_way_and_says_nothing():
    here = find_way(PAST, LEFT, RIGHT).waypoints.tobytes().hex()
    for order in ("first", "after others"):
        told = subprocess.run(
            [sys.executable, "-c", ASKED, order], capture_output=True, text=True, check=True
        )
        assert told.stdout.strip() == here
        assert told.stderr == ""


@exercises(way=0.2)
@settings(max_examples=12, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_ways_past_boxes_by_chance_are_free(tally, seed):
    random = np.random.default_rng(seed)
    boxes = [
        box(f"B{at}", random.uniform([-0.8, 0.5, 0.3], [0.8, 1.1, 1.8]), random.uniform(0.05, 0.3, 3), 0.005)
        for at in range(3)
    ]
    ends = [side + np.radians(random.uniform(-25, 25, 6)) for side in (LEFT, RIGHT)]
    found = find_way(room(*boxes), *ends)
    tally.count("way", isinstance(found, Way))
    if isinstance(found, Way):
        assert worst(executed(ends[0], found, 500), *boxes) > -1e-9
    elif found.start is not None:
        assert worst(ends[0][None], *boxes) < 2e-5
    elif found.goal is not None:
        assert worst(ends[1][None], *boxes) < 2e-5


@given(st.integers(0, 2**32 - 1), st.integers(2, 7))
@settings(max_examples=40, deadline=None)
def test_a_spline_is_the_course_that_is_proved(seed, count):
    random = np.random.default_rng(seed)
    knots = np.concatenate([[0.0], np.cumsum(random.uniform(0.1, 1, count - 1))])
    curve = NaturalSpline.through(knots / knots[-1], random.normal(size=(count, 3)))
    course = course_of(curve)
    s = np.linspace(0, 1, 301)
    assert np.abs(course.at(s) - curve.at(s)).max() < 1e-9
    gone = np.diff(course.gone(s), axis=0)
    assert (np.abs(np.diff(curve.at(s), axis=0)) <= gone + 1e-9).all()
