"""Estimates of a compilation: the share that is done, and the time that is left."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from yarclang.cli.estimate import Estimate, left_text, stage_of

STAGES = (
    ("reading", 100),
    ("checking", 0),
    ("planning", 100),
    ("writing the controller text", 0),
    ("certifying: reading the text", 0),
    ("certifying", 50),
    ("certifying: paths", 0),
    ("looking for warnings and notes", 0),
)


def test_what_is_told_belongs_to_a_stage():
    for what, _ in STAGES:
        assert stage_of(what) is not None
        assert stage_of(f"a.yarc: {what}") == stage_of(what)
    assert stage_of("comparing") is None
    assert stage_of("drawing") is None


@given(st.lists(st.floats(0.01, 30.0), min_size=len(STAGES), max_size=len(STAGES)))
def test_the_share_never_falls_and_ends_near_the_whole(seconds):
    estimate, now, before = Estimate(), 100.0, 0.0
    for (what, total), takes in zip(STAGES, seconds, strict=True):
        for step in range(20):
            estimate.tell(stage_of(what), step * total // 20, total, now)
            now += takes / 20.0
            share, left = estimate.share(now), estimate.left(now)
            assert before <= share <= 1.0
            assert left is None or left >= 0.0
            before = share
    assert before > 0.9


def test_the_time_left_is_found_and_does_not_jump():
    # the stages take ten times their usual durations
    seconds = (6.0, 8.0, 45.0, 6.0, 2.0, 30.0, 1.0, 2.0)
    estimate, now, whole = Estimate(), 0.0, sum(seconds)
    told = []
    for (what, total), takes in zip(STAGES, seconds, strict=True):
        for step in range(round(10 * takes)):
            # planning counts motions first, and chains of motions later, so its count is complete after half
            # of its time
            done = min(step / (10 * takes) * (2 if what == "planning" else 1), 1.0)
            estimate.tell(stage_of(what), int(done * total), total, now)
            now += 0.1
            left = estimate.left(now)
            if left is not None:
                told.append((left, whole - now))
    assert len(told) > 0.8 * 10 * whole
    assert all(abs(left - true) < 0.1 * whole for left, true in told)
    # between two reports, which are 0.1 s apart, the estimated time left changes by less than a second
    assert max(abs(left - before) for (before, _), (left, _) in pairwise(told)) < 1.0


def test_a_file_of_many_and_another_try_begin_anew():
    estimate = Estimate(1, 4)
    estimate.tell(stage_of("planning"), 50, 100, 0.0)
    assert 0.25 < estimate.share(0.0) < 0.5
    estimate.tell(stage_of("reading"), 0, 100, 5.0)
    assert estimate.share(5.0) == pytest.approx(0.25, abs=0.01)
    assert estimate.left(5.0) is None


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (None, ""),
        (0.0, "a few seconds left"),
        (22.0, "about 20 s left"),
        (70.0, "about a minute left"),
        (200.0, "about 3 min left"),
    ],
)
def test_the_time_left_is_rounded(seconds, text):
    assert left_text(seconds) == text
