"""Tests of arms with one spare joint: their closed form with this joint held, and their nearest solutions."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.robot.kinematics import arms
from yarclang.robot.kinematics import Solutions, flange_poses, nearest_solutions
from yarclang.robot.kinematics import nearest as nearest_module
from yarclang.robot.kinematics.nearest_spare import nearest_along
from yarclang.robot.kinematics.spare import HeldAtEnd, HeldWithin, solutions_with, spare_form
from yarclang.robot.kinematics.within import beyond, clear_of_limits, nearest_turn
from yarclang.robot.model import Chain

SIX = np.radians([170, 135, 150, 190, 130, 360])
ARMS = {
    **{name: arms.seven(name) for name in arms.SEVEN},
    "INDUSTRIAL6 on a rail": arms.on_rail(arms.industrial6()[0], SIX),
    "UR5 on a rail": arms.on_rail(arms.COBOTS["ur5"], np.full(6, 2.0 * np.pi)),
    "INDUSTRIAL6 with a turn at its tip": arms.with_turn_at_tip(arms.industrial6()[0], SIX),
}


def drawn(limits, rng):
    """Return a random joint position within limits. Turning joints are within half a turn of zero."""
    return rng.uniform(np.maximum(limits.lower, -np.pi), np.minimum(limits.upper, np.pi))


def apart(q, other):
    """Return the distances of joint positions from another one, without full turns."""
    away = q - other
    return np.abs(away - 2.0 * np.pi * np.round(away / (2.0 * np.pi))).max(axis=-1)


def test_which_joint_is_held():
    held = {
        name: (type(form), form.joint) for name, (chain, _) in ARMS.items() if (form := spare_form(chain))
    }
    assert held == {
        "iiwa14": (HeldWithin, 2),
        "panda": (HeldWithin, 6),
        "xarm7": (HeldWithin, 6),
        "gen3": (HeldWithin, 2),
        "INDUSTRIAL6 on a rail": (HeldAtEnd, 0),
        "UR5 on a rail": (HeldAtEnd, 0),
        "INDUSTRIAL6 with a turn at its tip": (HeldAtEnd, 6),
    }


def test_other_arms_have_none():
    rng = np.random.default_rng(0)
    chains = [
        arms.industrial6()[0],
        arms.slider9()[0],
        arms.planar3()[0],
        arms.on_rail(arms.offset6()[0], SIX)[0],
    ]
    for chain in chains:
        assert spare_form(chain) is None
    # After small random changes of all its axes, no axes of the Panda meet any more.
    panda = arms.SEVEN["panda"]
    screws = panda.screws + 1e-4 * rng.normal(size=panda.screws.shape)
    screws[:, 3:] /= np.linalg.norm(screws[:, 3:], axis=1)[:, None]
    screws[:, :3] -= screws[:, 3:] * (screws[:, :3] * screws[:, 3:]).sum(axis=1)[:, None]
    assert spare_form(Chain(arms.frozen(screws), panda.base_from_flange)) is None


@pytest.mark.parametrize("name", ARMS)
@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_what_made_the_pose_is_among_its_solutions(name, seed):
    chain, limits = ARMS[name]
    rng = np.random.default_rng(seed)
    q = drawn(limits, rng)
    pose = flange_poses(chain, q[None])[0]
    form = spare_form(chain)
    values = np.r_[q[form.joint], rng.uniform(-2.5, 2.5, 6)]
    found, valid = solutions_with(form, pose, values, np.zeros(7))
    assert np.abs(flange_poses(chain, found[valid]) - pose).max() < 1e-8
    np.testing.assert_array_equal(found[..., form.joint], np.broadcast_to(values, valid.shape))
    assert apart(found[:, 0], q)[valid[:, 0]].min() < 1e-5


@pytest.mark.parametrize("name", ARMS)
def test_joints_that_a_singularity_frees_are_held(name):
    chain, _ = ARMS[name]
    form = spare_form(chain)
    rng = np.random.default_rng(2)
    for q in (np.zeros(7), *np.where(rng.uniform(size=(12, 7)) < 0.5, 0.0, rng.uniform(-1.0, 1.0, (12, 7)))):
        pose = flange_poses(chain, q[None])[0]
        found, valid = solutions_with(form, pose, q[form.joint : form.joint + 1], q)
        assert np.isfinite(found).all()
        assert np.abs(flange_poses(chain, found[valid]) - pose).max(initial=0.0) < 1e-8
        assert apart(found[:, 0], q)[valid[:, 0]].min(initial=9.0) < 1e-4


@pytest.mark.parametrize("name", ARMS)
def test_no_sample_is_nearer(name):
    """No solution at 4,000 samples of the spare joint is nearer than the result."""
    chain, limits = ARMS[name]
    form = spare_form(chain)
    rng = np.random.default_rng(4)
    near = 0
    for number in range(30):
        q = drawn(limits, rng)
        reference = (
            drawn(limits, rng)
            if number % 2
            else np.clip(q + rng.uniform(-0.3, 0.3, 7), limits.lower, limits.upper)
        )
        pose = flange_poses(chain, q[None])[0]
        found = nearest_along(chain, limits, form, pose, reference)
        assert len(found)
        assert np.abs(flange_poses(chain, found) - pose).max() < 1e-8
        assert np.abs(beyond(limits, found)).max() <= 1e-8
        low, high = clear_of_limits(limits, reference)
        ends = np.maximum(limits.lower, -np.pi)[form.joint], np.minimum(limits.upper, np.pi)[form.joint]
        every, valid = solutions_with(form, pose, np.linspace(*ends, 4000), reference)
        every = nearest_turn(chain, limits, every, reference)[valid]
        clear = every[((every >= low) & (every <= high)).all(axis=1)]
        own = np.square(found - reference).sum(axis=1).min()
        least = np.square((clear if len(clear) else every) - reference).sum(axis=1).min()
        near += bool(own <= 1.01 * least + 0.002)
    assert near >= 27, near


@pytest.mark.parametrize("name", ARMS)
def test_where_it_stands_is_nearest(name):
    chain, limits = ARMS[name]
    rng = np.random.default_rng(5)
    for _ in range(10):
        q = drawn(limits, rng)
        found = nearest_solutions(chain, limits, flange_poses(chain, q[None])[0], q)
        assert isinstance(found, Solutions)
        np.testing.assert_allclose(found.q[0], q, atol=1e-6)
        again = nearest_solutions(chain, limits, flange_poses(chain, q[None])[0], q)
        np.testing.assert_array_equal(found.q, again.q)


def test_a_pose_that_leaves_more_joints_free_is_searched_as_well(monkeypatch):
    """A stretched arm has several free joints at once. The closed form keeps them fixed, so other solutions
    are searched for as well.
    """
    chain, limits = ARMS["iiwa14"]
    pose = flange_poses(chain, np.zeros((1, 7)))[0]
    reference = np.array([1.0, 0.1, 0.5, 0.1, -0.5, 0.1, 0.3])
    found = nearest_solutions(chain, limits, pose, reference)
    assert isinstance(found, Solutions)
    assert np.abs(flange_poses(chain, found.q) - pose).max() < 1e-8
    monkeypatch.setattr(nearest_module, "spare_form", lambda _: None)
    searched = nearest_solutions(chain, limits, pose, reference)
    assert isinstance(searched, Solutions)
    assert np.square(found.q[0] - reference).sum() <= np.square(searched.q[0] - reference).sum() + 1e-3
