"""Tests that no solution is listed twice: where two solutions meet, where axes coincide, and half a turn from
zero.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.robot.kinematics import arms
from yarclang.robot.kinematics import Solutions, branches, flange_poses, nearest_solutions
from yarclang.robot.kinematics.geometry import form_of
from yarclang.robot.model import Chain

HALF_TURNS = arms.limits_of(-np.full(6, np.pi), np.full(6, np.pi))


def coincident(rng):
    """Return a random arm of six turning joints, two of them about the same axis."""
    chain = arms.random6(rng)
    one, other = rng.choice(6, 2, replace=False)
    screws = chain.screws.copy()
    screws[other] = screws[one] * rng.choice([-1.0, 1.0])
    return Chain(arms.frozen(screws), chain.base_from_flange)


ARMS = {
    **{name: lambda _, chain=chain: chain for name, chain in arms.COBOTS.items()},
    "INDUSTRIAL6": lambda _: arms.industrial6()[0],
    "calibrated": lambda rng: arms.off_nominal(arms.industrial6()[0], rng, 1e-4),
    "two axes in one": coincident,
    "by chance": arms.random6,
}


def least_apart(q):
    """Return the smallest distance between two of the joint positions (m, 6), without full turns."""
    away = q[:, None] - q[None]
    away -= 2.0 * np.pi * np.round(away / (2.0 * np.pi))
    least = np.abs(away).max(axis=2)
    np.fill_diagonal(least, np.inf)
    return least.min(initial=np.inf)


@pytest.mark.parametrize("name", ARMS)
@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    quarters=st.lists(st.sampled_from([None, 0, 1, 2, -1, -2]), min_size=6, max_size=6),
)
def test_no_solution_is_listed_twice(name, seed, quarters):
    """With joints at quarter turns, solutions meet, or a joint is free."""
    rng = np.random.default_rng(seed)
    chain = ARMS[name](rng)
    q = np.array([rng.uniform(-3.0, 3.0) if one is None else one * np.pi / 2.0 for one in quarters])
    pose = flange_poses(chain, q[None])
    found = nearest_solutions(chain, HALF_TURNS, pose[0], q, measures=False)
    assert isinstance(found, Solutions)
    assert least_apart(found.q) > 4e-5
    assert np.abs(flange_poses(chain, found.q) - pose).max() < 1e-8
    if form_of(chain) is None:  # a closed form keeps eight separate places, even for equal solutions
        every, valid = branches(chain, pose)
        assert least_apart(every[0][valid[0]]) > 4e-5
