"""Tests of changing the joint path of an arm with spare joints: the poses stay the same, and a cost
decreases.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.robot.kinematics import arms
from tests.robot.kinematics.test_redundant import line, starts
from yarclang.robot.kinematics import Track, bending, flange_poses, smallest_singular_values, track
from yarclang.robot.kinematics.bending import bent
from yarclang.robot.kinematics.within import beyond

ARMS = {
    "seven7": arms.seven7,
    "slider9": arms.slider9,
    "panda": lambda: arms.seven("panda"),
    "rail": lambda: arms.on_rail(arms.industrial6()[0], np.radians([170, 135, 150, 190, 130, 360])),
}


def lines(arm, count, seed, length=0.25):
    """Yield straight lines that the arm can follow, each with a joint path."""
    chain, limits, starting, rng = starts(arm, count, seed)
    for q in starting:
        way = rng.normal(size=3)
        pose_at = line(flange_poses(chain, q[None])[0], length * way / np.linalg.norm(way))
        found = track(chain, limits, pose_at, q, reason="any")
        if isinstance(found, Track):
            yield chain, limits, pose_at, found


def kept(chain, limits, pose_at, known, found):
    """Check what holds for each new joint path."""
    np.testing.assert_array_equal(found.q[0], known.q[0])
    assert (found.s[0], found.s[-1]) == (0.0, 1.0)
    assert np.abs(flange_poses(chain, found.q[1:]) - pose_at(found.s[1:])).max() < 1e-8
    assert np.abs(beyond(limits, found.q)).max() <= 1e-8
    assert np.abs(np.diff(found.q, axis=0)).max() <= 0.2


@pytest.mark.parametrize("name", ARMS)
def test_a_joint_keeps_out_of_where_it_was(name):
    """A joint is forbidden to come near its position at the end of the known path. The new path avoids this
    range.
    """
    exercised = freed = 0
    for chain, limits, pose_at, known in lines(ARMS[name], 30, 3):
        joint = 2
        at = known.q[-1, joint]

        def cost(q, at=at, joint=joint):
            return np.maximum(1.0 - np.abs(q[:, joint] - at) / 0.1, 0.0)

        if cost(known.q[:1])[0] > 0.0:
            continue
        exercised += 1
        for found in bent(chain, limits, pose_at, known, cost):
            kept(chain, limits, pose_at, known, found)
            assert cost(found.q).sum() < cost(known.at(found.s)).sum()
            if cost(found.q).max() < 0.5:
                freed += 1
                break
    assert exercised >= 4, exercised
    assert freed >= 0.6 * exercised, (freed, exercised)


def test_property_of_all_ways():
    """For any cost, each new path keeps the poses, the start and the limits, and costs less than the known
    path.
    """
    seen = {"ways": 0}

    @settings(max_examples=25, deadline=None, suppress_health_check=list(HealthCheck))
    @given(st.integers(0, 10_000), st.sampled_from(sorted(ARMS)))
    def every(seed, name):
        rng = np.random.default_rng(seed)
        for chain, limits, pose_at, known in lines(ARMS[name], 1, seed, 0.15):
            weight, off = rng.normal(size=chain.size), rng.normal()

            def cost(q, weight=weight, off=off):
                return np.maximum(np.sin(q @ weight + off), 0.0)

            for found in bent(chain, limits, pose_at, known, cost):
                kept(chain, limits, pose_at, known, found)
                assert cost(found.q).sum() < cost(known.at(found.s)).sum() + 1e-6
                seen["ways"] += 1

    every()
    assert seen["ways"] >= 20, seen


def test_singularities_are_left():
    """On lines with small singular values, the new path has larger ones."""
    tried = better = 0
    for chain, limits, pose_at, known in lines(arms.seven7, 40, 5, 0.2):

        def cost(q, chain=chain):
            return np.maximum(1.0 - smallest_singular_values(chain, q, np.eye(4)) / 0.09, 0.0)

        before = cost(known.q).max()
        if before <= 0.3 or cost(known.q[:1])[0] > 0.3:
            continue
        tried += 1
        found = next(bent(chain, limits, pose_at, known, cost), None)
        better += found is not None and cost(found.q).max() < 0.8 * before
    assert tried >= 3, tried
    assert better >= 1, (better, tried)


def test_an_arm_without_a_spare_joint_has_no_other_way():
    chain, limits = arms.industrial6()
    q = np.array([0.1, 0.2, -0.3, 0.1, -0.4, 0.2])
    pose_at = line(flange_poses(chain, q[None])[0], np.array([0.0, 0.0, 0.05]))
    known = track(chain, limits, pose_at, q, reason="any")
    assert isinstance(known, Track)
    assert list(bent(chain, limits, pose_at, known, lambda q: np.ones(len(q)))) == []


@pytest.mark.parametrize("name", ["panda", "slider9"])
def test_what_is_not_found_is_not_looked_for_endlessly(name):
    """The search ends even if the cost can be reduced a little everywhere but never to zero. It evaluates
    about as many joint positions as for other costs, however long the line is and however many joints there
    are.
    """
    exercised = 0
    for chain, limits, pose_at, known in lines(ARMS[name], 12, 5, length=0.5):
        asked = [0]

        def cost(q, asked=asked):
            asked[0] += len(q)
            return 1.0 + np.sin(3.0 * q).sum(axis=1) ** 2

        found = list(bent(chain, limits, pose_at, known, cost))
        assert asked[0] < 1.3 * bending.MOST_ASKED, asked
        for one in found:
            kept(chain, limits, pose_at, known, one)
        exercised += asked[0] > 0.25 * bending.MOST_ASKED
    assert exercised >= 3, exercised
