"""Tests of shortening motions in time: the fastest result of several searches is free, not slower than the
first one, and equal each time.
"""

from itertools import pairwise

import numpy as np
import pytest
from click.testing import CliRunner
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.motion.avoid.cells import LEFT, POST, RIGHT, ROBOT, box, room
from tests.motion.avoid.test_way import executed, worst
from yarclang.cli.yarc import main as yarc
from yarclang.cli.yarcc import main as yarcc
from yarclang.emitted.bounds import MOST_SEARCHES
from yarclang.emitted.seal import sealed
from yarclang.motion.avoid.shorten import _by_halves, duration, shortened
from yarclang.motion.avoid.way import NoWay, Way, find_way
from yarclang.motion.paths.spline import through
from yarclang.pipeline.controller_text import judge_text
from yarclang.pipeline.inputs import Options
from yarclang.source import SourceFile


def lasts(start, way):
    path = through(np.concatenate([start[None], way.waypoints]), ROBOT.chain.is_prismatic)
    return duration(path.spline, ROBOT.limits)


def test_a_straight_way_takes_as_long_as_its_law_says():
    goal = LEFT + np.array([0.0, 0.0, 0.4, 0.0, 0.0, -1.2])
    spline = through(np.stack([LEFT, goal]), ROBOT.chain.is_prismatic).spline
    far = np.abs(goal - LEFT)
    by_velocity = 1.875 * far / ROBOT.limits.velocity
    by_acceleration = np.sqrt(10.0 / np.sqrt(3.0) * far / ROBOT.limits.acceleration)
    assert duration(spline, ROBOT.limits) == pytest.approx(
        max(by_velocity.max(), by_acceleration.max()), rel=1e-3
    )


@given(st.integers(1, 2000))
def test_all_places_of_a_piece_are_looked_at_the_middle_early(count):
    order = _by_halves(count)
    assert sorted(order) == list(range(count + 1))
    assert count < 4 or all(abs(one / count - 0.5) < 0.51 for one in order[:3])


@exercises(shorter=0.5)
@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_a_shortened_way_is_free_and_no_longer(tally, seed):
    """A ball of radius 1 is an obstacle. A random path outside of a slightly larger ball leads around it."""
    random = np.random.default_rng(seed)
    corners = random.normal(size=(12, 3))
    corners *= random.uniform(2.0, 4.0, (12, 1)) / np.linalg.norm(corners, axis=1)[:, None]
    dense = np.concatenate(
        [one + np.linspace(0, 1, 200)[:, None] * (two - one) for one, two in pairwise(corners)]
    )
    middle = random.normal(size=3)
    radius = 0.95 * float(np.linalg.norm(dense - middle, axis=1).min())
    velocity = random.uniform(0.5, 2.0, 3)
    step = np.full(3, 0.02)

    def free(q):
        return bool(np.linalg.norm(q - middle) > radius)

    found = shortened(corners, free, step, velocity, seed % 1000)
    assert np.array_equal(found, shortened(corners, free, step, velocity, seed % 1000))
    assert np.array_equal(found[[0, -1]], corners[[0, -1]])

    def time(points):
        return (np.abs(np.diff(points, axis=0)) / velocity).max(axis=1).sum()

    for one, two in pairwise(found):
        places = one + np.linspace(0, 1, 400)[:, None] * (two - one)
        assert np.linalg.norm(places - middle, axis=1).min() > radius - 0.02
    assert time(found) <= time(corners) * 1.2
    tally.count("shorter", time(found) < 0.7 * time(corners))


@exercises(quicker=0.2)
@settings(max_examples=10, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_the_quickest_of_several_is_free_and_no_slower(tally, seed):
    random = np.random.default_rng(seed)
    boxes = [
        box(f"B{at}", random.uniform([-0.8, 0.5, 0.3], [0.8, 1.1, 1.8]), random.uniform(0.05, 0.3, 3), 0.005)
        for at in range(3)
    ]
    ends = [side + np.radians(random.uniform(-25, 25, 6)) for side in (LEFT, RIGHT)]
    around = room(*boxes)
    first, best = find_way(around, *ends), find_way(around, *ends, searches=3)
    assert isinstance(first, Way) is isinstance(best, Way)
    if isinstance(first, NoWay) or first.is_straight:
        return
    assert lasts(ends[0], best) <= lasts(ends[0], first)
    tally.count("quicker", lasts(ends[0], best) < 0.98 * lasts(ends[0], first))
    assert worst(executed(ends[0], best, 500), *boxes) > -1e-9
    assert np.array_equal(best.waypoints, find_way(around, *ends, searches=3).waypoints)


CELL = """units = "mm,deg,s"
[[obstacles]]
name = "POST"
shape = "box"
frame = "B"
xyz = [0, 700, 900]
size = [120, 120, 1800]
"""
PROGRAM = (
    "ROBOT INDUSTRIAL6\n"
    'CELL "c.toml"\n'
    "START -60 20 -20 0 -30 0 (deg)\n"
    "P0010 MOVEJ_AVOID 60 20 -20 0 -30 0 [MIN] (deg,s)\n"
)
LINE = "; ways round: the quickest of 3 searches"


def compiled(folder, *options, text=PROGRAM):
    (folder / "c.toml").write_text(CELL)
    (folder / "p.yarc").write_text(text)
    done = CliRunner().invoke(yarcc, [str(folder / "p.yarc"), *options])
    assert done.exit_code == 0, done.stderr
    return (folder / "p.pmc").read_text()


def judged(folder, text):
    return judge_text(SourceFile(str(folder / "p.pmc"), text), folder, Options())


def resealed(text):
    certificate = next(line for line in text.split("\n") if line.startswith("; certificate "))
    plain = "\n".join("; sha256 -" if one.startswith("; sha256 ") else one for one in text.split("\n"))
    plain = plain.replace(certificate, "; certificate -")
    return sealed(plain, certificate.removeprefix("; certificate "))


def test_the_text_says_how_many_searches_and_is_judged_by_them(tmp_path):
    text = compiled(tmp_path, "--avoid-effort", "3")
    assert f"\n{LINE}\n" in text
    assert resealed(text) == text
    accepted = judged(tmp_path, text)
    assert accepted.value is not None, accepted.diagnostics
    # The text has the motions of three searches, but claims that they are the result of the first one.
    forged = resealed(text.replace(f"{LINE}\n", ""))
    found = judged(tmp_path, forged)
    assert found.value is None
    assert {one.code for one in found.diagnostics if one.is_error} <= {"Y1153", "Y1161"}, found.diagnostics


def test_nothing_is_said_where_nothing_was_asked_or_nothing_is_gone_round(tmp_path):
    assert "ways round" not in compiled(tmp_path)
    assert compiled(tmp_path) == compiled(tmp_path, "--avoid-effort", "1")
    straight = PROGRAM.replace("_AVOID 60", " -50")
    assert "ways round" not in compiled(tmp_path, "--avoid-effort", "3", text=straight)


@pytest.mark.parametrize("number", ["1", "0", "-3", "65", "99", "100", "3.5", "03", "many", ""])
def test_a_number_that_nobody_writes_is_refused(tmp_path, number):
    text = compiled(tmp_path, "--avoid-effort", "3")
    found = judged(tmp_path, resealed(text.replace(LINE, LINE.replace("3", number))))
    assert found.value is None
    assert all(one.code == "Y1151" for one in found.diagnostics if one.is_error), found.diagnostics


@pytest.mark.parametrize("number", ["0", "65", "-1", "two", "1e3"])
def test_the_option_has_bounds(tmp_path, number):
    (tmp_path / "p.yarc").write_text(PROGRAM)
    done = CliRunner().invoke(yarcc, [str(tmp_path / "p.yarc"), "--avoid-effort", number])
    assert done.exit_code == 2
    assert str(MOST_SEARCHES) in done.stderr or "integer" in done.stderr


def test_check_gives_the_way_points_of_the_quickest(tmp_path):
    compiled(tmp_path)
    asked = ["check", str(tmp_path / "p.yarc"), "--fix", "--select", "Y0920", "--avoid-effort", "3"]
    CliRunner().invoke(yarc, asked)
    fixed = (tmp_path / "p.yarc").read_text()
    assert "MOVEJ_SPLINE" in fixed
    way = find_way(room(POST), LEFT, RIGHT, searches=3)
    assert fixed.count("JOINTS") == len(way.waypoints) - 1
    first = " ".join(
        f"{value:.4f}".rstrip("0").rstrip(".") for value in np.degrees(way.waypoints[0]).round(4) + 0.0
    )
    assert f"_VIA1 {first} (deg)" in fixed
