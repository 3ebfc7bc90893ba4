"""Tests of the theorems: each bound holds for dense samples, computed by other formulas, and isn't far above
them.
"""

from itertools import product

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.certify.certify_bench import FLANGE_FROM_TCP, industrial6, natural, railed, sample
from yarclang.certify.motion.bounds import (
    Cubics,
    Fuzz,
    arm_fourth,
    catch_up,
    fourth,
    hermite_bezier,
    reaches,
)
from yarclang.certify.motion.pieces import arm_bounds
from yarclang.certify.motion.pose import angle_of_chord, axis_and_angle, distance
from yarclang.certify.motion.spline import NaturalSpline
from yarclang.robot.kinematics.fk import tool_poses

seeds = st.integers(0, 2**32 - 1)


def of_lines(start, points, h):
    control = np.vstack([np.tile(start, (3, 1)), points, np.tile(points[-1], (2, 1))])
    at = np.arange(len(control) - 3)
    return Cubics.of_spline(control, at, np.full(len(at), h))


def test_conformance_positions(conformance):
    data = conformance("spline1")
    h = data["tm_ms"] * 1e-3
    cubics = of_lines(np.array(data["start"]), np.array(data["points"]), h)
    t = np.array(data["t"])
    segment = np.minimum((t / h + 1e-9).astype(int), len(cubics.h) - 1)
    x, v = cubics.take(segment).at(t - segment * h)
    assert np.abs(x - data["x"]).max() < 1e-8
    assert np.abs(v - data["v"]).max() < 1e-6
    a = cubics.take(segment).a + (t - segment * h)[:, None] * cubics.take(segment).j
    assert np.abs(a - data["a"]).max() < 1e-4
    assert len(cubics.h) == len(data["points"]) + 2


@settings(max_examples=60, deadline=None)
@given(seeds, st.integers(1, 12), st.sampled_from([0.05, 0.005]))
def test_extremes_are_those_of_dense_sampling(seed, count, h):
    rng = np.random.default_rng(seed)
    start, points = rng.normal(size=3), rng.normal(size=(count, 3))
    points[rng.random(count) < 0.3] = start  # some joints rest or turn back
    cubics = of_lines(start, points, h)
    _, x, v, a, j = sample(start, points, h, per_segment=200)
    lower, upper = cubics.position_range()
    for bound, truth, scale in (
        (upper.max(axis=0), x.max(axis=0), 1.0),
        (-lower.min(axis=0), -x.min(axis=0), 1.0),
        (cubics.velocity_peaks().max(axis=0), np.abs(v).max(axis=0), 1.0 / h),
        (cubics.acceleration_peaks().max(axis=0), np.abs(a).max(axis=0), 1.0 / h**2),
        (np.abs(cubics.j).max(axis=0), np.abs(j).max(axis=0), 1.0 / h**3),
    ):
        assert (bound >= truth - 1e-12 * scale).all()
        assert (bound <= truth + 2e-3 * scale).all()
    mapping = rng.normal(size=(3, 3))
    mapped = cubics.mapped(mapping).velocity_peaks().max(axis=0)
    truth = np.abs(v @ mapping.T).max(axis=0)
    assert (mapped >= truth - 1e-12 / h).all()
    assert (mapped <= truth + 2e-3 * np.abs(mapping).sum() / h).all()


def test_position_turns_inside_a_segment_that_starts_at_rest():
    # v = a t + j t^2 / 2, where the product of the velocities at both ends is zero: the turn at t = 2/3 is
    # easily missed.
    one = np.ones((1, 1))
    cubics = Cubics(0 * one, 0 * one, one, -3.0 * one, np.array([1.0]))
    assert cubics.position_range()[1][0, 0] == 2.0 / 27.0


@settings(max_examples=40, deadline=None)
@given(seeds, st.sampled_from(["industrial6", "railed"]))
def test_fourth_derivatives_of_the_arm(seed, name):
    """A fourth divided difference is the fourth derivative at some point, so it is never above the bound."""
    robot = industrial6() if name == "industrial6" else railed()
    rng = np.random.default_rng(seed)
    n = robot.size
    x, v, a, j = (rng.normal(size=n) * 10 ** rng.uniform(-1, 1, n) for _ in range(4))
    step = 0.04
    t = np.arange(5) * step
    q = x + np.outer(t, v) + np.outer(t**2, a) / 2 + np.outer(t**3, j) / 6
    cubics = Cubics(*(row[None] for row in (x, v, a, j)), np.array([4 * step]))
    travel = np.abs(q).max(axis=0) + 1.0
    reach = reaches(robot.chain, FLANGE_FROM_TCP, travel)
    peaks = cubics.velocity_peaks(), cubics.acceleration_peaks(), np.abs(cubics.j)
    bound = arm_fourth(reach, robot.chain.is_prismatic, *peaks)
    poses = tool_poses(robot.chain, q, FLANGE_FROM_TCP)
    kernel = np.array([1, -4, 6, -4, 1]) / step**4
    noise = 1e-15 * 100 / step**4
    assert np.linalg.norm(np.tensordot(kernel, poses[:, :3, 3], 1)) <= bound.origin[0] + noise
    assert np.linalg.norm(np.tensordot(kernel, poses[:, :3, :3], 1)) <= bound.rotation[0] + noise


@settings(max_examples=20, deadline=None)
@given(seeds)
def test_fourth_derivatives_term_by_term(seed):
    """Compare with Faa di Bruno's formula written out: a sum over all partitions of four derivatives into
    blocks, and over all ways to assign a joint to each block.
    """
    rng = np.random.default_rng(seed)
    n = 5
    rates = rng.random((3, n))
    prismatic, reach = rng.random(n) < 0.4, rng.random(n)
    blocks = {(0, 0, 0, 0): 1, (0, 0, 1): 6, (1, 1): 3, (0, 2): 4}
    total = 0.0
    for orders, times in blocks.items():
        for joints in product(range(n), repeat=len(orders)):
            last = max(joints)
            if prismatic[list(joints)].sum() > prismatic[last] * (joints.count(last) == 1):
                # a slide counts only as the joint nearest to the tool, and only once
                continue
            size = 1.0 if prismatic[last] else reach[last]
            total += (
                times
                * size
                * np.prod([rates[order, joint] for order, joint in zip(orders, joints, strict=True)])
            )
    bound = arm_fourth(reach, prismatic, *(row[None] for row in rates))
    assert np.isclose(bound.origin[0], total, rtol=1e-12)


def test_fourth_derivative_is_reached():
    """With a single joint, the bound is exact: w^4 R for a steady turn, and 3 a^2 R at the beginning of a
    turn.
    """
    robot = industrial6()
    reach = reaches(robot.chain, FLANGE_FROM_TCP, np.zeros(6))
    only = np.zeros((1, 6))
    only[0, 5] = 2.0
    bound = arm_fourth(reach, robot.chain.is_prismatic, only, 0 * only, 0 * only)
    assert np.isclose(bound.origin[0], 16.0 * reach[5])
    assert np.isclose(bound.rotation[0], 16.0 * np.sqrt(2.0))
    assert fourth(0.0, 2.0, 5.0) == 12.0


@settings(max_examples=30, deadline=None)
@given(seeds)
def test_reach_holds_in_every_configuration(seed):
    rng = np.random.default_rng(seed)
    for robot in (industrial6(), railed()):
        q = rng.uniform(-np.pi, np.pi, (200, robot.size))
        tool = np.eye(4)
        tool[:3, 3] = rng.normal(size=3) * 0.2
        reach = reaches(robot.chain, tool, np.abs(q).max(axis=0))
        from yarclang.robot.kinematics.fk import poses_and_jacobians

        # The linear part of a joint's column is axis x arm, so its length is the distance from the axis.
        _, jacobian = poses_and_jacobians(robot.chain, q, tool)
        far = np.linalg.norm(jacobian[:, :3], axis=1).max(axis=0)
        turning = ~robot.chain.is_prismatic
        assert (far[turning] <= reach[turning] + 1e-12).all()
    # The reach isn't much too large: the outer joints can stretch the arm to most of it.
    assert reach[1] < 3.0 * far[1]


@settings(max_examples=60, deadline=None)
@given(seeds)
def test_hermite_remainder_with_a_jump(seed):
    """For a piecewise quartic and its Hermite cubic, the bound is d^4/384 max|e''''| + d^3/192 |jump|."""
    rng = np.random.default_rng(seed)
    d, at = 10 ** rng.uniform(-2, 0), rng.random()
    c = rng.normal(size=5)
    jump = rng.normal() * 10 ** rng.uniform(-1, 3)
    t = np.linspace(0, d, 2001)

    def e(t):
        return np.polyval(c, t) + jump / 6 * np.maximum(t - at * d, 0) ** 3

    def rate(t):
        return np.polyval(np.polyder(c), t) + jump / 2 * np.maximum(t - at * d, 0) ** 2

    hull = np.array(hermite_bezier(e(0.0), rate(0.0), e(d), rate(d), d))
    u = t / d
    basis = np.stack([(1 - u) ** 3, 3 * u * (1 - u) ** 2, 3 * u * u * (1 - u), u**3])
    off = np.abs(e(t) - hull @ basis).max()
    rest = d**4 / 384 * 24 * abs(c[0]) + d**3 / 192 * abs(jump)
    assert off <= rest * (1 + 1e-9) + 1e-14
    assert np.abs(e(t)).max() <= np.abs(hull).max() + rest + 1e-14


def test_catch_up_sees_running_back_stopping_short_and_overshooting():
    forward = np.array([[0.0, 0.0, 0.2, 0.5], [0.5, 0.8, 1.0, 1.0]])
    group = np.zeros(2, dtype=np.int64)
    assert catch_up(forward, group).max() < 1e-15
    assert np.isclose(catch_up(forward - [[0, 0, 0.3, 0], [0, 0, 0, 0]], group).max(), 0.1)
    assert np.isclose(catch_up(forward * 0.75, group).max(), 0.25)
    assert np.isclose(catch_up(forward + 0.125, group).max(), 0.125)
    two = np.concatenate([forward, forward])
    assert catch_up(two, np.array([0, 0, 1, 1])).max() < 1e-15
    assert catch_up(two, np.array([0, 0, 0, 0])).max() > 0.5  # both executions count as one command


@given(st.lists(st.lists(st.floats(-0.1, 1.1), min_size=4, max_size=4), min_size=1, max_size=6))
def test_what_one_command_has_to_catch_up_does_not_depend_on_the_others(points):
    own = np.array(points)
    three = catch_up(np.concatenate([own] * 3), np.repeat(np.arange(3), len(own)))
    assert np.array_equal(three, np.tile(catch_up(own, np.zeros(len(own), dtype=np.int64)), 3))


def test_how_far_one_command_reaches_does_not_depend_on_the_others():
    """The reach of a command doesn't depend on other commands. A sliding joint adds the travel in this
    command.
    """
    robot = railed()
    own, other = (
        of_lines(start, start + np.linspace(0.0, way, 9)[1:, None] * np.ones(robot.chain.size), 0.02)
        for start, way in ((np.zeros(robot.chain.size), 0.1), (np.full(robot.chain.size, 0.9), 0.5))
    )
    fuzz = Fuzz(
        *(np.concatenate([getattr(one.fuzz, name) for one in (own, other)]) for name in ("size", "step", "h"))
    )
    both = Cubics(*(np.concatenate([getattr(one, name) for one in (own, other)]) for name in "xvajh"), fuzz)
    count = len(own.h)
    alone = arm_bounds(own, np.zeros(count, dtype=np.int64), FLANGE_FROM_TCP[None], robot)
    command = np.repeat([0, 1], [count, len(other.h)])
    together = arm_bounds(both, command, np.stack([FLANGE_FROM_TCP] * 2), robot)
    for one, many in zip(alone, together, strict=True):
        assert np.array_equal(one, many[:count])


@settings(max_examples=50, deadline=None)
@given(seeds, st.floats(0.0, np.pi))
def test_axis_and_angle(seed, angle):
    from tests.certify.certify_bench import rotation

    axis = np.random.default_rng(seed).normal(size=3)
    turn = rotation(axis, angle)
    found, size = axis_and_angle(turn[None])
    assert abs(size[0] - angle) < 1e-7
    if found.any():
        assert np.abs(rotation(found[0], size[0]) - turn).max() < 1e-7
    else:
        assert angle < 1e-7
    poses = np.tile(np.eye(4), (2, 1, 1))
    poses[1, :3, :3] = turn
    assert abs(distance(poses[0], poses[1])[1] - angle) < 1e-7
    assert np.isclose(angle_of_chord(np.array(np.linalg.norm(turn - np.eye(3)))), angle, atol=1e-7)


@settings(max_examples=40, deadline=None)
@given(seeds, st.integers(2, 9))
def test_natural_spline_is_the_one_of_scipy(seed, count):
    points = np.random.default_rng(seed).normal(size=(count, 4))
    spline = NaturalSpline.through(np.repeat(points, 2, axis=0))
    share = np.linspace(0, 1, 100)
    y, slope = spline.at(share * spline.s[-1])
    assert np.abs(y - natural(points)(share)).max() < 1e-11
    assert np.abs(np.diff(y, axis=0) - (slope[1:] + slope[:-1]) / 2 * spline.s[-1] / 99).max() < 0.05
    assert len(spline.s) == count
