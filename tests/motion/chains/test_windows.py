"""Tests of long chains in windows: the plan and proof of a window depend only on the window, and equal those
of the whole chain.
"""

from contextlib import contextmanager
from itertools import pairwise
from unittest.mock import patch

import numpy as np
import pytest
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import compiled

from tests.motion.chains.test_flowing import BEGIN, drawn, looked_at, program
from yarclang.certify import stretches
from yarclang.memory import NO_MEMORY, Recent
from yarclang.motion.chains.flowing import flow, seams
from yarclang.motion.chains.flowing.window import Failed, Window


@contextmanager
def windows_of(motions, proved):
    """Use windows of a given number of motions. Yield a list to which each planned window is added."""
    made, make = [], flow.made

    def listed(way, demands, window, smoothing):
        made.append(window)
        return make(way, demands, window, smoothing)

    with (
        patch.object(seams, "SHORTEST", motions),
        patch.object(seams, "_LONGER", 5.0),
        patch.object(stretches, "WINDOW", proved),
        patch.object(flow, "made", listed),
    ):
        yield made


def told(certificate):
    return certificate.to_json()["commands"]


def wave(count=150):
    """Return waypoints (count + 1, 3) [mm] along a wave."""
    at = np.arange(count) * 2.0
    heading = np.radians(50) * np.sin(at / 30.0)
    ways = 2.0 * np.stack((np.cos(heading), np.sin(heading), 0 * at), axis=1)
    return np.concatenate(([[0, 0, 0]], np.cumsum(ways, axis=0))).round(3)


@exercises(cut=0.1)
@settings(max_examples=5, deadline=None)
@given(
    st.sampled_from(sorted(BEGIN)),
    st.integers(0, 10**6),
    st.integers(70, 100),
    st.sampled_from(["curve", "stairs", "corners"]),
    st.sampled_from([0.0, 0.3]),
    st.sampled_from([8.0, 15.0]),
    st.sampled_from([0.1, 0.3]),
)
def test_what_is_made_in_windows_keeps_to_its_paths_and_limits(
    tally, robot, seed, count, shape, turning, speed, ball
):
    points, turns = drawn(seed, count, shape, turning)
    ball = min(ball, 0.49 * np.linalg.norm(np.diff(points, axis=0), axis=1).min())
    text = program(robot, points, turns, speed, ball, 0.05)
    with windows_of(16, 12) as made:
        one, found = compiled(text, robot)
    assert one is not None, [(each.code, each.message) for each in found][:3]
    tally.count("cut", len(made) > 1)
    looked_at(one.text, robot, points, speed, ball, 0.05)


@pytest.mark.parametrize("proved", [8, 40])
def test_what_is_proved_in_windows_is_what_is_proved_of_the_whole(proved):
    points = wave(90)
    text = program("INDUSTRIAL6", points, np.zeros(len(points)), 50.0, 0.3, 0.05)
    # Relative motions depend on the end of the previous motion, so the chain can't be cut there.
    lines = text.splitlines()
    lines[40:60] = [
        f"P{number:04d} DMOVE 1.5 {number % 3} 0 0 0 0 TOL 0.05 BLEND 0.3" for number in range(3900, 3920)
    ]
    for program_text in (text, "\n".join(lines) + "\n"):
        with windows_of(10**6, 10**6):
            whole, _ = compiled(program_text)
        with windows_of(10**6, proved):
            cut, found = compiled(program_text)
        assert whole is not None, [(each.code, each.message) for each in found][:3]
        assert cut is not None
        assert cut.text == whole.text
        assert told(cut.certificate) == told(whole.certificate)


def test_an_edit_makes_the_windows_around_it_anew():
    points = wave(200)
    memory = Recent(100_000)
    with windows_of(16, 12) as made:
        for edited in (None, 100, 101, 40):
            if edited is not None:
                points[edited] += 0.01
            text = program("INDUSTRIAL6", points, np.zeros(len(points)), 50.0, 0.3, 0.05)
            made.clear()
            recalled, _ = compiled(text, memory=memory)
            number = len(made)
            fresh, _ = compiled(text, memory=NO_MEMORY)
            assert recalled is not None
            assert fresh is not None
            assert recalled.text == fresh.text
            assert told(recalled.certificate) == told(fresh.certificate)
            assert number == len(made) - number if edited is None else 0 < number <= 3


def test_windows_that_fail_are_made_with_those_beside_them():
    points = wave(200)
    text = program("INDUSTRIAL6", points, np.zeros(len(points)), 50.0, 0.3, 0.05)
    with windows_of(16, 12) as made:
        assert compiled(text)[0] is not None
        cut = list(dict.fromkeys(made))
    assert len(cut) > 3
    bad, make = cut[len(cut) // 2].first, flow.made

    def fails(way, demands, window, smoothing):
        return (
            Failed(window.seams)
            if bad in (window.first, window.last)
            else make(way, demands, window, smoothing)
        )

    with windows_of(16, 12), patch.object(flow, "made", fails):
        one, _ = compiled(text)
    assert one is not None
    looked_at(one.text, "INDUSTRIAL6", points, 50.0, 0.3, 0.05)
    # The seam is gone, and the windows on both sides are one.
    assert looked_at(one.text, "INDUSTRIAL6", points, 50.0, 0.3, 0.05) > 0.95


@given(st.lists(st.booleans(), min_size=2, max_size=12), st.integers(1, 4))
def test_merged(failed, reach):
    cut = [
        Window(place, place + 1, (float(place > 0), float(place < len(failed) - 1)))
        for place in range(len(failed))
    ]
    made = seams.merged(cut, failed, reach)
    assert made[0].first == 0
    assert made[-1].last == len(failed)
    assert all(one.last == other.first for one, other in pairwise(made))
    assert made[0].speeds[0] == made[-1].speeds[1] == 0.0
    if any(failed):
        assert len(made) < len(cut)
    for place, bad in enumerate(failed):
        if bad:
            assert not any(
                one.first in (place, place + 1) and one.first not in (0, len(failed)) for one in made
            )
