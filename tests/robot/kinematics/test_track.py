"""Tests of following paths: the paper's line, exact passage through singularities, and all kinds
of breaks.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.robot.kinematics import arms
from yarclang.robot.kinematics import (
    Broken,
    Solutions,
    Track,
    Unreachable,
    flange_poses,
    follow,
    nearest_solutions,
    tool_poses,
    track,
)
from yarclang.robot.kinematics.numeric import damped_step
from yarclang.robot.kinematics.track import followed

DATA = Path(__file__).parents[2] / "conformance"


def line(first, last):
    """Return the straight line between two poses (4, 4), with a turn about one axis."""
    turn = Rotation.from_matrix(first[:3, :3].T @ last[:3, :3]).as_rotvec()

    def pose_at(s):
        poses = np.zeros((len(s), 4, 4))
        poses[:, :3, 3] = first[:3, 3] + s[:, None] * (last[:3, 3] - first[:3, 3])
        poses[:, :3, :3] = first[:3, :3] @ Rotation.from_rotvec(s[:, None] * turn).as_matrix()
        poses[:, 3, 3] = 1.0
        return poses

    return pose_at


def moved(pose, way=(0, 0, 0), turn=(0, 0, 0)):
    """Return `pose` moved along {B} and turned about its own axes."""
    result = pose.copy()
    result[:3, 3] += way
    result[:3, :3] = result[:3, :3] @ Rotation.from_rotvec(turn).as_matrix()
    return result


def check(chain, limits, pose_at, q_start, found):
    """Check that the track begins at the start, has no jumps, and that its seeds lead to exact solutions
    everywhere.
    """
    assert isinstance(found, Track), found
    assert not found.s.flags.writeable
    assert not found.q.flags.writeable
    assert found.s[0] == 0.0
    assert found.s[-1] == 1.0
    assert (np.diff(found.s) > 0).all()
    np.testing.assert_allclose(found.q[0], q_start, atol=1e-5)
    assert np.abs(np.diff(found.q, axis=0)).max() <= 0.2
    assert (found.q >= limits.lower - 1e-8).all()
    assert (found.q <= limits.upper + 1e-8).all()
    # Check the track's samples, and five positions between each two of them.
    share = np.linspace(0, 1, 7)[:-1]
    s = np.append((found.s[:-1, None] + np.diff(found.s)[:, None] * share).ravel(), 1.0)
    q, miss, turn = follow(chain, pose_at(s), found.at(s))
    assert max(miss.max(), turn.max()) < 1e-9
    assert np.abs(np.diff(q, axis=0)).max() <= 0.2
    assert np.abs(q[::6] - found.q).max() < 1e-7
    return q


def test_the_papers_line():
    case = json.loads((DATA / "movel_line.json").read_text())
    chain, limits = arms.industrial6()
    start = np.radians(case["start_deg"])
    first = tool_poses(chain, start[None], arms.TCP)[0]
    last = np.eye(4)
    last[:3, 3] = [0.2, 1.0744, 1.326]
    last[:3, :3] = Rotation.from_euler("ZYX", [20, -5, 10], degrees=True).as_matrix()
    tool = line(first, last)

    def pose_at(s):
        return tool(s) @ np.linalg.inv(arms.TCP)

    found = track(chain, limits, pose_at, start)
    check(chain, limits, pose_at, start, found)
    s = np.array([sample["s"] for sample in case["samples"]])
    q = follow(chain, pose_at(s), found.at(s))[0]
    np.testing.assert_allclose(np.degrees(q), [sample["q_deg"] for sample in case["samples"]], atol=1e-6)


@pytest.mark.parametrize(
    "way", [(0, 0, -0.3), (0, 0, 0.03), (0, -0.3, 0), (0, 0.05, 0), (0, -0.2, -0.3), (0, -0.3, 0.1)]
)
@pytest.mark.parametrize("bend", [0.0, 0.6, -0.4])
def test_from_home_in_the_plane_of_the_arm(way, bend):
    """At home the wrist is straight. Lines in the plane of the arm need no motion of joints 1, 4 and 6."""
    chain, limits = arms.industrial6()
    home = chain.base_from_flange
    pose_at = line(home, moved(home, way, (bend, 0, 0)))
    found = track(chain, limits, pose_at, np.zeros(6))
    q = check(chain, limits, pose_at, np.zeros(6), found)
    np.testing.assert_allclose(q[:, [0, 3, 5]], 0.0, atol=1e-6)


@pytest.mark.parametrize("q1", [0.0, 0.5])
@pytest.mark.parametrize("q4", [0.0, 0.7])
def test_straight_through_a_straight_wrist(q1, q4):
    """The hand tilts in the plane of its bend, from 20 deg on one side to 37 deg on the other."""
    chain, limits = arms.industrial6()
    start = np.array([q1, 0.2, -0.5, q4, np.radians(20), 0.3])
    first = flange_poses(chain, start[None])[0]
    axis = flange_poses(chain, (start - [0, 0, 0, 0, start[4], start[5]])[None])[0][:3, 0]

    # Turn about axis 5, which doesn't move, like the wrist center.
    def pose_at(s):
        poses = np.repeat(first[None], len(s), axis=0)
        turn = Rotation.from_rotvec(-s[:, None] * axis).as_matrix()
        centre = first[:3, 3] - first[:3, :3] @ [0, 0.238, 0]
        poses[:, :3, :3] = turn @ first[:3, :3]
        poses[:, :3, 3] = centre + (poses[:, :3, :3] @ [0, 0.238, 0])
        return poses

    found = track(chain, limits, pose_at, start)
    q = check(chain, limits, pose_at, start, found)
    np.testing.assert_allclose(q[-1], start - [0, 0, 0, 0, 1, 0], atol=1e-6)
    np.testing.assert_allclose(q[:, 3], q4, atol=1e-5)


@pytest.mark.parametrize("q4", [0.0, 0.7])
@pytest.mark.parametrize("turn", [1.5, -3.0, 0.01])
def test_turning_about_the_common_axis_holds_q4(q4, turn):
    chain, limits = arms.industrial6()
    start = np.array([0, 0, 0, q4, 0, -q4])
    pose_at = line(chain.base_from_flange, moved(chain.base_from_flange, turn=(0, turn, 0)))
    found = track(chain, limits, pose_at, start)
    q = check(chain, limits, pose_at, start, found)
    np.testing.assert_allclose(q[:, :5], np.tile(start[:5], (len(q), 1)), atol=1e-9)
    np.testing.assert_allclose(q[-1, 5], -q4 - turn, atol=1e-9)


def test_past_a_straight_wrist_the_joints_swing():
    """At a distance of 0.1 mrad from the singularity, q4 turns by half a turn, fast but without a jump."""
    chain, limits = arms.industrial6()
    start = np.array([0.3, 0.2, -0.5, 1e-4, 0.35, 0.0])
    first = flange_poses(chain, start[None])[0]
    pose_at = line(first, moved(first, turn=(-0.8, 0, 0)))
    found = track(chain, limits, pose_at, start)
    q = check(chain, limits, pose_at, start, found)
    assert abs(abs(q[-1, 3]) - np.pi) < 0.01


@pytest.mark.parametrize("arm", [arms.industrial6, arms.skewed6, arms.offset6, arms.scara4, arms.seven7])
def test_random_lines(arm):
    chain, limits = arm()
    rng = np.random.default_rng(11)
    whole = 0
    for _ in range(12):
        start = rng.uniform(0.7 * limits.lower, 0.7 * limits.upper).clip(-2.5, 2.5)
        end = start + rng.uniform(-0.4, 0.4, chain.size) * np.where(chain.is_prismatic, 0.1, 1.0)
        pose_at = line(*flange_poses(chain, np.array([start, end])))
        found = track(chain, limits, pose_at, start)
        if isinstance(found, Broken):
            check_break(chain, limits, pose_at, found)
            continue
        whole += 1
        check(chain, limits, pose_at, start, found)
    assert whole >= 8


def check_break(chain, limits, pose_at, found):
    """Check what holds for each break: its joint position is on the path and within limits."""
    assert 0.0 <= found.s < 1.0
    pose = pose_at(np.array([found.s]))
    np.testing.assert_allclose(flange_poses(chain, found.q[None]), pose, atol=1e-7)
    assert (found.q >= limits.lower - 1e-7).all()
    assert (found.q <= limits.upper + 1e-7).all()


def test_a_circle_of_a_redundant_arm_is_smooth():
    chain, limits = arms.seven7()
    start = np.array([0.2, 0.5, -0.2, 1.2, 0.3, 0.7, 0.1])
    first = flange_poses(chain, start[None])[0]

    def pose_at(s):
        poses = np.repeat(first[None], len(s), axis=0)
        poses[:, :3, 3] += 0.1 * np.stack([np.cos(6 * s) - 1, np.sin(6 * s), 0 * s], axis=1)
        return poses

    found = track(chain, limits, pose_at, start)
    check(chain, limits, pose_at, start, found)
    s = np.linspace(0, 1, 4001)
    q = follow(chain, pose_at(s), found.at(s))[0]
    # No kinks: the second derivative is bounded, and has no steps at the track's samples.
    curvature = np.diff(q, n=2, axis=0) * 4000.0**2
    assert np.abs(curvature).max() < 200.0
    assert np.abs(np.diff(curvature, axis=0)).max() < 10.0


@pytest.mark.parametrize(("way", "amount"), [((0.2, 0, 0), np.pi / 2), ((-0.2, 0, 0), np.pi / 2)])
def test_broken_by_a_singularity_at_the_start(way, amount):
    """Sideways from home, joint 4 would first have to turn by 90 deg."""
    chain, limits = arms.industrial6()
    pose_at = line(chain.base_from_flange, moved(chain.base_from_flange, way))
    found = track(chain, limits, pose_at, np.zeros(6))
    assert isinstance(found, Broken)
    assert found.kind == "singular"
    assert found.s < 1e-6
    assert found.joint in {3, 5}
    assert abs(abs(found.amount) - amount) < 1e-3
    check_break(chain, limits, pose_at, found)


@pytest.mark.parametrize("length", [1e-8, 1e-6, 1e-4, 1e-3, 5e-3, 0.05, 0.2])
def test_a_singularity_at_the_start_breaks_short_ways_as_it_does_long_ones(length):
    """A singularity at the start breaks short paths like long ones. A short path has samples within a few
    1e-10 rad of the singularity, where the held angle changes to the one that the pose determines.
    """
    chain, limits = arms.industrial6()
    pose_at = line(chain.base_from_flange, moved(chain.base_from_flange, (length, 0, 0)))
    found = track(chain, limits, pose_at, np.zeros(6))
    assert isinstance(found, Broken)
    assert found.kind == "singular"
    assert found.s * length < 1e-9
    assert found.joint in {3, 5}
    assert abs(abs(found.amount) - np.pi / 2) < 0.05
    check_break(chain, limits, pose_at, found)


@pytest.mark.parametrize("length", [1e-9, 1e-7, 1e-5, 1e-3, 0.1])
def test_a_short_way_straight_through_the_straight_wrist_is_followed(length):
    """In the arm's own plane, q5 passes zero and q4 stays constant."""
    chain, limits = arms.industrial6()
    start = np.array([0.0, 0.2, -0.5, 0.0, 0.0, 0.0])
    first = flange_poses(chain, start[None])[0]
    pose_at = line(first, moved(first, (0, 0, length)))
    q = check(chain, limits, pose_at, start, track(chain, limits, pose_at, start))
    assert np.abs(q[:, 3]).max() < 1e-5


def test_broken_by_a_singularity_on_the_way():
    """The path enters the straight wrist in one plane, and leaves it in another."""
    chain, limits = arms.industrial6()
    start = np.array([0.0, 0.2, -0.5, 0.0, 0.3, 0.0])
    straight = flange_poses(chain, np.array([[0.0, 0.2, -0.5, 0.0, 0.0, 0.0]]))[0]

    def pose_at(s):
        poses = np.repeat(straight[None], len(s), axis=0)
        about_x, about_z = 0.3 * np.maximum(0.5 - s, 0) * 2, 0.3 * np.maximum(s - 0.5, 0) * 2
        turn = Rotation.from_rotvec(np.stack([about_x, 0 * s, about_z], axis=1)).as_matrix()
        centre = straight[:3, 3] - straight[:3, :3] @ [0, 0.238, 0]
        poses[:, :3, :3] = straight[:3, :3] @ turn
        poses[:, :3, 3] = centre + poses[:, :3, :3] @ [0, 0.238, 0]
        return poses

    found = track(chain, limits, pose_at, start)
    assert isinstance(found, Broken)
    assert found.kind == "singular"
    assert abs(found.s - 0.5) < 1e-6
    assert found.joint == 3
    assert abs(abs(found.amount) - np.pi / 2) < 1e-3
    check_break(chain, limits, pose_at, found)


@pytest.mark.parametrize("arm", [arms.industrial6, arms.offset6])
def test_broken_by_reach(arm):
    chain, limits = arm()
    start = np.array([0.0, -0.2, -0.3, 0.1, 0.5, 0.0])
    first = flange_poses(chain, start[None])[0]
    pose_at = line(first, moved(first, (0, 0.7, 0.3)))
    found = track(chain, limits, pose_at, start)
    assert isinstance(found, Broken)
    assert found.kind == "reach"
    assert 0.1 < found.s < 0.9
    check_break(chain, limits, pose_at, found)
    # The largest deviation is at the end, and equals that of a search for the end pose alone.
    single = nearest_solutions(chain, limits, pose_at(np.ones(1))[0], start)
    assert abs(found.amount - single.miss) < 1e-3
    assert found.amount > 0.05
    before = nearest_solutions(chain, limits, pose_at(np.array([found.s - 1e-5]))[0], start)
    assert isinstance(before, Solutions)
    if arm is arms.industrial6:
        behind = nearest_solutions(chain, limits, pose_at(np.array([found.s + 1e-5]))[0], start)
        assert isinstance(behind, Unreachable)
        assert behind.kind == "reach"


def test_a_short_gap_in_reach_is_seen():
    """An arc leaves the workspace by 0.1 mm, within one interval of the first samples."""
    chain, _ = arms.industrial6()
    limits = arms.limits_of(np.full(6, -7.0), np.full(6, 7.0))
    q = np.array([0.0, -0.5, 0.0, 0.0, 0.3, 0.0])
    q[2] = np.pi / 2 - np.arctan2(0.195, 0.6364)
    edge = flange_poses(chain, q[None])[0]
    outwards = edge[:3, 3] - edge[:3, :3] @ [0, 0.238, 0] - [0, 0.2, 0.679]
    outwards /= np.linalg.norm(outwards)
    along = np.array([0, -outwards[2], outwards[1]])
    for top in np.linspace(0.4, 0.45, 8):
        for height in (1e-4, -1e-4):

            def pose_at(s, top=top, height=height):
                poses = np.repeat(edge[None], len(s), axis=0)
                away = 0.9 * (s - top)
                poses[:, :3, 3] += away[:, None] * along + (height - away**2)[:, None] * outwards
                return poses

            first = pose_at(np.zeros(1))[0]
            start = nearest_solutions(chain, limits, first, q).q[0]
            found = track(chain, limits, pose_at, start)
            if height < 0:
                check(chain, limits, pose_at, start, found)
            else:
                assert isinstance(found, Broken)
                assert found.kind == "reach"
                assert 0 < top - found.s < 0.02
                assert 3e-5 < found.amount < 1.1e-4


@pytest.mark.parametrize("sign", [-1, 1])
def test_broken_by_limits(sign):
    """Joint 1 would have to exceed its limit. The other shoulder configuration is impossible with such narrow
    limits.
    """
    chain, _ = arms.industrial6()
    high = np.radians([40, 135, 150, 190, 130, 360])
    limits = arms.limits_of(-high, high)
    start = np.radians([0, 10, -30, 5, 40, 0])
    first = flange_poses(chain, start[None])[0]

    def pose_at(s):
        turn = np.eye(4)[None].repeat(len(s), axis=0)
        turn[:, :3, :3] = Rotation.from_rotvec(np.outer(s, [0, 0, sign * np.radians(50)])).as_matrix()
        return turn @ first

    found = track(chain, limits, pose_at, start)
    assert isinstance(found, Broken)
    assert found.kind == "limits"
    assert found.joint == 0
    assert abs(found.s - 0.8) < 1e-6
    assert abs(found.amount - sign * np.radians(10)) < 1e-9
    check_break(chain, limits, pose_at, found)


def test_broken_by_a_configuration_that_limits_force():
    """Joint 6 reaches its limit. If it began a full turn lower, the path could be followed."""
    chain, _ = arms.industrial6()
    high = np.radians([170, 135, 150, 190, 130, 200])
    limits = arms.limits_of(-high, high)
    start = np.radians([0, 10, -30, 5, 40, 150])
    first = flange_poses(chain, start[None])[0]

    def pose_at(s):
        turn = np.eye(4)[None].repeat(len(s), axis=0)
        turn[:, :3, :3] = Rotation.from_rotvec(np.outer(s, [0, -np.radians(100), 0])).as_matrix()
        return first @ turn

    found = track(chain, limits, pose_at, start)
    assert isinstance(found, Broken)
    assert found.kind == "configuration"
    assert found.joint == 5
    assert abs(found.s - 0.5) < 1e-6
    assert abs(found.amount - np.radians(50)) < 1e-9
    check_break(chain, limits, pose_at, found)
    # With joint 6 a full turn lower at the start, and with wider limits, the path is followed.
    other = start - [0, 0, 0, 0, 0, 2 * np.pi]
    wide = arms.limits_of(-high - 1.0, high + 1.0)
    check(chain, wide, pose_at, other, track(chain, wide, pose_at, other))


def test_broken_where_a_configuration_ends():
    """The near configuration of the shoulder ends where the far one can still reach the pose."""
    chain, _ = arms.skewed6()
    limits = arms.limits_of(np.full(6, -7.0), np.full(6, 7.0))
    rng = np.random.default_rng(0)
    kinds = set()
    for _ in range(60):
        start = rng.uniform(-2, 2, 6)
        end = start + rng.uniform(-1, 1, 6)
        pose_at = line(*flange_poses(chain, np.array([start, end])))
        found = track(chain, limits, pose_at, start)
        if isinstance(found, Broken):
            kinds.add(found.kind)
            check_break(chain, limits, pose_at, found)
            if found.kind == "configuration":
                behind = nearest_solutions(chain, limits, pose_at(np.array([found.s + 1e-5]))[0], found.q)
                assert isinstance(behind, Solutions)
                assert np.abs(behind.q[0] - found.q).max() > 0.05
    assert "configuration" in kinds


def test_limits_of_a_slide():
    chain, limits = arms.scara4()
    start = np.array([0.3, 0.5, 0.1, 0.1])
    first = flange_poses(chain, start[None])[0]
    pose_at = line(first, moved(first, (0, 0, -0.15)))
    found = track(chain, limits, pose_at, start)
    assert isinstance(found, Broken)
    assert found.kind == "limits"
    assert found.joint == 2
    assert abs(found.s - 2 / 3) < 1e-6
    assert abs(found.amount - 0.05) < 1e-8


def test_a_start_off_the_path_is_a_mistake_of_the_caller():
    chain, limits = arms.industrial6()
    pose_at = line(chain.base_from_flange, moved(chain.base_from_flange, (0, 0, -0.1)))
    with pytest.raises(ValueError, match="start"):
        track(chain, limits, pose_at, np.full(6, 0.1))


def test_polishes_the_start():
    chain, limits = arms.industrial6()
    start = np.array([0.1, 0.2, -0.4, 0.3, 0.5, 0.6])
    first = flange_poses(chain, start[None])[0]
    pose_at = line(first, moved(first, (0, 0, -0.1)))
    found = track(chain, limits, pose_at, start + 3e-7)
    np.testing.assert_allclose(found.q[0], start, atol=1e-12)


def test_may_start_on_a_limit():
    """A motion may start at a limit, even if the given start is off by 3e-7 rad. A motion beyond the limit
    breaks at its start.
    """
    chain, _ = arms.industrial6()
    start = np.array([0.1, 0.2, -0.4, 0.3, 0.5, 0.6])
    limits = arms.limits_of(start - 2.0, start)
    first = flange_poses(chain, start[None])[0]
    inwards = line(first, flange_poses(chain, (start - 0.1)[None])[0])
    given = start - 3e-7
    found = track(chain, limits, inwards, given)
    assert isinstance(found, Track)
    outwards = line(first, flange_poses(chain, (start + 0.1)[None])[0])
    broken = track(chain, limits, outwards, given)
    assert isinstance(broken, Broken)
    assert broken.kind == "limits"
    assert broken.s < 1e-5


@pytest.mark.parametrize("arm", [arms.industrial6, arms.offset6, arms.skewed6, arms.seven7, arms.slider9])
def test_paths_that_are_followed_together_end_as_one_by_one(arm):
    """Lines of all lengths from random positions, some of which break at limits or out of reach, have the
    same results together as with `track` one by one.
    """
    chain, limits = arm()
    random = np.random.default_rng(5)
    low, high = np.maximum(limits.lower, -2.0), np.minimum(limits.upper, 2.0)
    starts = low + (0.15 + 0.7 * random.random((24, chain.size))) * (high - low)
    poses = flange_poses(chain, starts)
    paths = [
        line(pose, moved(pose, random.normal(size=3) * random.choice([0.02, 0.1, 0.4]))) for pose in poses
    ]
    alone = [
        isinstance(track(chain, limits, path, start, reason="any"), Track)
        for path, start in zip(paths, starts, strict=True)
    ]
    assert followed(chain, limits, paths, starts).tolist() == alone
    assert 4 <= sum(alone) < len(alone)


def test_no_paths_are_followed():
    chain, limits = arms.seven7()
    assert followed(chain, limits, [], np.empty((0, 7))).tolist() == []


@pytest.mark.parametrize("joints", [3, 6, 7, 9])
@pytest.mark.parametrize("count", [1, 8, 128, 129])
def test_few_samples_make_the_steps_of_many(joints, count):
    """Few samples and many samples are solved by different methods. The steps of both methods equal numpy's
    solution, and a singular matrix without damping has a step, too.
    """
    random = np.random.default_rng(count)
    jacobian, error = random.normal(size=(6, joints, count)), random.normal(size=(6, count))
    damping = 10.0 ** random.uniform(-4, 0, count)
    step = damped_step(jacobian, error, damping)
    j = jacobian.transpose(2, 0, 1)
    normal = j.transpose(0, 2, 1) @ j + damping[:, None, None] * np.eye(joints)
    true = np.linalg.solve(normal, j.transpose(0, 2, 1) @ error.T[:, :, None])[:, :, 0].T
    np.testing.assert_allclose(step, true, rtol=1e-6, atol=1e-8)
    assert step.flags.c_contiguous
    assert damped_step(0.0 * jacobian, error, 0.0 * damping).shape == (joints, count)
