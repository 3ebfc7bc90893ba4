"""Tests of bounds of which each term matters. Dense sampling wouldn't notice that a term is missing, because
the bound would exceed the truth even without it. So the bounds are compared with a second computation: power
series, and arms whose lengths are obvious.
"""

from dataclasses import replace
from math import factorial

import numpy as np
import pytest

from yarclang.certify.bodies.torque_bounds import torque_bends
from yarclang.certify.kinematics.elbow import find_elbow
from yarclang.certify.motion.bounds import Cubics
from yarclang.certify.motion.pieces import arm_bounds
from yarclang.certify.motion.speed import speed_bounds
from yarclang.robot.description import load_robot
from yarclang.robot.model import Chain, Dynamics, Lines

X, Z, NOTHING = np.eye(3)[0], np.eye(3)[2], np.zeros(3)
GRAVITY, TRAVEL = 9.81, 0.7
MASSES, STIFF = np.array([4.0, 7.0]), np.array([0.3, 0.8])


def arm(kinds):
    """Return joints at x = 0 and 1 m that turn about z (R) or slide along x (P), with centers of mass at 0.5
    m and 3 m.
    """
    screws = [
        np.concatenate([-np.cross(Z, place * X), Z]) if kind == "R" else np.concatenate([X, NOTHING])
        for place, kind in enumerate(kinds)
    ]
    size = len(kinds)
    center = np.array([0.5 * X, 3.0 * X])[-size:]
    inertia = np.array([np.diag([0.1, 0.2, 1.0]) * one for one in STIFF[-size:]])
    dynamics = Dynamics(MASSES[-size:], center, inertia, -GRAVITY * Z, np.full(size, np.inf), wanted=True)
    return Chain(np.array(screws), np.eye(4)), dynamics


def series(*derivatives):
    """Return a power series (5,) with these derivatives at 0."""
    return np.array(
        [one / factorial(at) for at, one in enumerate(derivatives)] + [0.0] * (5 - len(derivatives))
    )


def times(*factors):
    """Return the product of power series, up to the fourth power."""
    product = series(1.0)
    for one in factors:
        product = np.convolve(product, one)[:5]
    return product


def grown(w, a, j):
    """Return exp(w t + a t^2/2 + j t^3/6), which bounds the rotation of a vector of length 1."""
    inner, term, total = series(0.0, w, a, j), series(1.0), series(1.0)
    for at in range(1, 5):
        term = times(term, inner) / at
        total = total + term
    return total


def from_the(derivative, power_series):
    """Return the series of a derivative of a series. It has correspondingly fewer powers."""
    values = [factorial(at) * one for at, one in enumerate(power_series)]
    return series(*values[derivative:])


# Kinds of each arm's joints, and for each body the lengths from the axes to its center of mass [m].
ARMS = {"R": [[3.0]], "RR": [[0.5], [3.0, 2.0]], "PR": [[TRAVEL], [2.0 + TRAVEL, 2.0]]}


@pytest.mark.parametrize("kinds", ARMS)
@pytest.mark.parametrize("seed", range(5))
def test_torques_bend_as_the_series_say(kinds, seed):
    chain, dynamics = arm(kinds)
    size = len(kinds)
    peaks = np.random.default_rng(seed).uniform(0.5, 4.0, (3, size))
    turning = np.array([kind == "R" for kind in kinds])
    wanted = np.zeros(size)
    for body, lengths in enumerate(ARMS[kinds]):
        turn = [float(one[: body + 1][turning[: body + 1]].sum()) for one in peaks]
        slide = [float(one[: body + 1][~turning[: body + 1]].sum()) for one in peaks]
        reach = lengths[0]
        moved = reach * grown(*(t + s / reach for t, s in zip(turn, slide, strict=True)))
        force = dynamics.mass[body] * (from_the(2, moved) + series(GRAVITY))
        spin = times(grown(*turn), series(*turn))
        largest = float(np.linalg.eigvalsh(dynamics.inertia[body]).max())
        momentum = times(largest * grown(*(2.0 * one for one in turn)), spin)
        for joint in range(body + 1):
            own = peaks[:, :joint][:, turning[:joint]].sum(axis=1)
            axis = grown(*own)
            if turning[joint]:
                length = lengths[joint]
                lever = length * grown(*(t + s / length for t, s in zip(turn, slide, strict=True)))
                torque = times(axis, lever, force) + times(axis, from_the(1, momentum))
            else:
                torque = times(axis, force)
            wanted[joint] += 2.0 * torque[2]
    found = torque_bends(chain, dynamics, np.full((1, size), TRAVEL), tuple(one[None] for one in peaks))
    np.testing.assert_allclose(found[0], wanted, rtol=1e-12)


def test_a_slide_reaches_as_far_as_it_goes():
    """For an arm that turns and then slides, the bound grows with the position of the slide."""
    robot = load_robot("INDUSTRIAL6").value
    screws = np.array([np.concatenate([NOTHING, Z]), np.concatenate([X, NOTHING])])
    placed = replace(robot, chain=Chain(screws, np.eye(4)))
    one = np.array([[0.1, 0.0]])
    found = []
    for out in (0.5, 2.0):
        q = np.array([[0.0, out]])
        cubics = Cubics(q, one, np.zeros((1, 2)), np.zeros((1, 2)), np.array([0.01]))
        origin, _ = arm_bounds(cubics, np.array([0]), np.eye(4)[None], placed)
        found.append(origin[0])
    # A point at distance r from an axis that turns at w has the fourth derivative r w^4.
    assert found[0] >= 0.5 * 0.1**4
    assert found[1] >= 2.0 * 0.1**4


@pytest.mark.parametrize("seed", range(20))
def test_speeds_of_parabolas_are_bounded_sharply(seed):
    """If the remainder is 0, the bounds enclose the speeds, and are accurate to 0.1 %."""
    random = np.random.default_rng(seed)
    d = 0.2
    v0, change, curve = random.uniform(-1, 1, (3, 3)) * np.array([1.0, 0.05, 0.05])[:, None]
    t = np.linspace(0.0, 1.0, 1001)[:, None]
    velocity = v0 + change * t + curve * t**2

    class Moved:
        p = np.array([NOTHING, d * (v0 + change / 2.0 + curve / 3.0)])

    Moved.velocity = velocity[[0, -1]]
    low, high = speed_bounds(Moved, np.array([0]), np.array([d]), np.array([0.0]))
    seen = np.linalg.norm(velocity, axis=1)
    assert low[0] <= seen.min() * (1 + 1e-12)
    assert high[0] >= seen.max() * (1 - 1e-12)
    # The squared speed is a polynomial of degree 4 with little curvature. Its bounds on the quarters of a
    # segment are accurate to 0.1 %.
    assert high[0] <= seen.max() * 1.001
    assert low[0] >= seen.min() * 0.999


def test_a_steady_speed_is_told_to_the_last_digits():
    steady = np.array([[0.3, -0.4, 1.2]])

    class Moved:
        p = np.concatenate([np.zeros((1, 3)), 0.2 * steady])
        velocity = np.repeat(steady, 2, axis=0)

    low, high = speed_bounds(Moved, np.array([0]), np.array([0.2]), np.array([0.0]))
    np.testing.assert_allclose([low[0], high[0]], 1.3, rtol=1e-12)


def test_the_elbow_of_an_arm_on_a_slide():
    """The shoulder is where the first two turning axes meet, whatever numbers their joints have."""
    axes = np.array([X, Z, np.eye(3)[1], np.eye(3)[1]])
    aside = 0.2 * np.eye(3)[1]
    points = np.array([NOTHING, 0.3 * X, 0.3 * X + 0.4 * Z + aside, 0.3 * X + 1.0 * Z])
    lines = Lines(axes, points, np.array([0.0, 1.0, 1.0, 1.0]), np.array([1.0, 0.0, 0.0, 0.0]))
    joint, elbow = find_elbow(lines, 1.3 * X + 1.0 * Z)
    assert joint == 3
    np.testing.assert_allclose(elbow, 0.3 * X + 1.0 * Z, atol=1e-12)
