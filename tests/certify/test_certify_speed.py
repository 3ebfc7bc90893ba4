"""Tests of the moving frame's speed: bounds compared with dense sampling, programmed speeds that are kept,
and ones that aren't.
"""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import compiled

from tests.certify.certify_bench import (
    DEG,
    FLANGE_FROM_TCP,
    Job,
    curve_points,
    emit,
    grid_law,
    industrial6,
    joint_points,
    origin,
    program,
    sample,
)
from tests.certify.certify_chains import Leg, of_poses
from tests.certify.certify_paths import arc_poses, arm_curve, moved
from tests.certify.test_certify_blends import Q0, START, TIMING, codes, line, line_of
from yarclang import hir
from yarclang.certify import certify
from yarclang.certify.claims import Claims
from yarclang.robot.kinematics.fk import poses_and_jacobians, tool_poses
from yarclang.robot.model import Tolerance

TOLERANCE = Tolerance()
H = 0.05
WAY = np.array([0.15, 0.05, -0.05])


def judge(job, **robot_changes):
    robot = replace(industrial6(), **robot_changes)
    claims = Claims(any_jerk=frozenset({0} if job.any_jerk else ()))
    return certify(emit(robot, Q0, [job]), program(Q0, [job]), robot, TOLERANCE, claims)


def true_speeds(points, h=H, per_segment=60):
    """Return densely sampled speeds of the origin [m/s] and of the rotation [rad/s]."""
    _, q, v, *_ = sample(Q0, points, h, per_segment)
    _, jacobians = poses_and_jacobians(industrial6().chain, q, FLANGE_FROM_TCP)
    twist = np.einsum("nij,nj->ni", jacobians, v)
    return np.linalg.norm(twist[:, :3], axis=1), np.linalg.norm(twist[:, 3:], axis=1)


def straight(speed, n=60, way=WAY, rotvec=(0, 0, 0), law=None):
    goal = moved(START, np.array(way), np.array(rotvec, float))
    curve = arm_curve(industrial6(), Q0, line_of(START, goal))
    if law is None:
        points = curve_points(curve, n)
    else:
        from tests.certify.certify_bench import inverted, knots

        points = inverted(curve(knots(law)))
    timing = hir.Timing(None, speed=speed)
    motion = hir.LineMove(origin(0, "MOVEL"), hir.PoseGoal(goal, FLANGE_FROM_TCP), "LSPB", timing)
    return Job(motion, points), true_speeds(points)


def cruise(n=60, length=None):
    """Return the cruise speed of the tests' law."""
    length = np.linalg.norm(WAY) if length is None else length
    return np.diff(grid_law(n)).max() * length / H


def test_a_speed_that_is_kept():
    speed = cruise()
    job, (true, _) = straight(hir.Reading(speed, None))
    result = judge(job)
    assert codes(result) == []
    found = result.value.commands[0].tool_speed
    assert found.programmed == speed
    assert true.max() - 1e-12 <= found.largest <= true.max() * (1 + 2e-4)
    assert speed * 0.9995 <= found.least <= speed * 1.0001
    assert speed <= found.most <= speed * 1.0005
    data = json.loads(json.dumps(result.value.to_json(), allow_nan=False))["commands"][0]["tool_speed"]
    assert np.isclose(data["programmed_mm_s"], speed * 1e3)
    assert np.isclose(data["cruise_least_mm_s"], speed * 1e3, rtol=1e-3)
    for share, word in (
        (0.998, "% of its allowed speed"),
        (1.002, "never reaches its speed, but at most"),
    ):
        result = judge(straight(hir.Reading(speed * share, None))[0])
        assert codes(result) == ["Y1167"]
        assert word in result.diagnostics[0].message
    assert codes(judge(straight(hir.Reading(speed * 1.0005, None))[0])) == []


def test_a_speed_that_falls_between_the_ramps():
    control = grid_law(80)
    rate = np.diff(control)
    rate[38:42] *= 0.8
    law = np.concatenate([[0.0], np.cumsum(rate)]) / rate.sum()
    speed = rate.max() / rate.sum() * np.linalg.norm(WAY) / H
    result = judge(straight(hir.Reading(speed, None), law=law)[0])
    assert codes(result) == ["Y1167"]
    assert "slows down to" in result.diagnostics[0].message
    assert result.value.commands[0].tool_speed.least < 0.85 * speed


def test_a_speed_that_is_reached_for_an_instant():
    """On a path that is too short for a cruise, the speed is reached only for an instant, and over no whole
    piece of the path.
    """
    rate = np.sin(np.pi * np.arange(1, 60) / 60) ** 8
    law = np.r_[0, 0, 0, np.cumsum(rate) / rate.sum(), 1, 1]
    speed = true_speeds(straight(None, law=law)[0].points)[0].max()
    for share, found in ((1.0, []), (1.002, ["Y1167"]), (0.998, ["Y1167"])):
        assert codes(judge(straight(hir.Reading(speed * share, None), law=law)[0])) == found


def test_a_pure_turn_has_an_angular_speed():
    speed = cruise(length=0.6)
    job, (_, true) = straight(hir.Reading(None, speed), way=(0, 0, 0), rotvec=(0.0, 0.36, 0.48))
    result = judge(job)
    assert codes(result) == []
    found = result.value.commands[0].tool_speed
    assert found.turns
    assert true.max() - 1e-12 <= found.largest <= true.max() * 1.001
    assert "largest_deg_s" in found.to_json()
    wrong = straight(hir.Reading(None, speed * 1.002), way=(0, 0, 0), rotvec=(0.0, 0.36, 0.48))[0]
    assert codes(judge(wrong)) == ["Y1167"]
    # A speed as a length doesn't apply to a pure rotation.
    assert codes(judge(straight(hir.Reading(0.3, None), way=(0, 0, 0), rotvec=(0.0, 0.36, 0.48))[0])) == []


def test_a_turn_whose_origin_moves_only_by_rounding_has_an_angular_speed():
    """If the origin moves by less than 1 um, the judge uses the angular speed, otherwise the speed of the
    origin.
    """
    speed = cruise(length=0.6)

    def judged(way, asked):
        return judge(straight(asked, way=(way, 0, 0), rotvec=(0.0, 0.36, 0.48))[0])

    for way, turns in ((4e-8, True), (9.9e-7, True), (1.01e-6, False)):
        result = judged(way, hir.Reading(0.3, speed))
        assert codes(result) == ([] if turns else ["Y1167"])
        assert result.value.commands[0].tool_speed.turns == turns
    assert codes(judged(4e-8, hir.Reading(0.3, 1.002 * speed))) == ["Y1167"]
    assert codes(judged(4e-8, hir.Reading(0.3, 0.998 * speed))) == ["Y1167"]


def test_an_arc_at_a_speed():
    """The bounds are sharp on an arc, even if the direction changes much within a segment."""
    goal = moved(START, np.array([0.03, 0.0, 0.02]), np.zeros(3))
    via = START[:3, 3] + np.array([0.02, 0.03, -0.02])
    path = lambda s: arc_poses(START, via, goal, s)  # noqa: E731
    length = np.linalg.norm(np.diff(path(np.linspace(0, 1, 20001))[:, :3, 3], axis=0), axis=1).sum()
    speed = cruise(40, length)
    points = curve_points(arm_curve(industrial6(), Q0, path), 40)
    for share, found in ((1.0, []), (1.003, ["Y1167"]), (0.997, ["Y1167"])):
        timing = hir.Timing(None, speed=hir.Reading(speed * share, None))
        motion = hir.ArcMove(origin(0, "MOVEC"), via, hir.PoseGoal(goal, FLANGE_FROM_TCP), "LSPB", timing)
        result = judge(Job(motion, points))
        assert codes(result) == found
    assert result.value.commands[0].tool_speed.largest >= true_speeds(points)[0].max() - 1e-12


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(-7, -2), st.sampled_from([0.05, 0.005]))
def test_no_sample_is_faster(seed, size, h):
    rng = np.random.default_rng(seed)
    goal = moved(START, WAY, np.zeros(3))
    points = joint_points(Q0, Q0 + rng.normal(size=6) * 0.3 * h / 0.05, 24)
    points[:-1] += 10**size * rng.normal(size=(len(points) - 1, 6))
    motion = hir.LineMove(origin(0), hir.PoseGoal(goal, FLANGE_FROM_TCP), "LSPB", TIMING)
    found = judge(Job(motion, points, str(h * 1e3))).value.commands[0].tool_speed
    true = true_speeds(np.round(points / DEG, 9) * DEG, h)[0].max()
    assert true * (1 - 1e-9) <= found.largest
    if size < -5:  # with more noise, the speed changes too much within a segment for sharp bounds
        assert found.largest <= true * 1.01


def test_speeds_in_a_chain():
    """In a blend, the larger of the two motions' speeds is allowed. A motion that consists only of blends
    need not reach its speed.
    """
    middle, goal = moved(START, WAY, np.zeros(3)), moved(START, WAY + np.array([0, 0.1, 0.1]), np.zeros(3))
    lengths = np.linalg.norm(WAY), np.linalg.norm([0, 0.1, 0.1])
    legs = [line(0, START, middle, 60, hir.Reading(0.05, None)), line(1, middle, goal, 50)]
    chain = of_poses(legs, (12,), Q0)
    speeds = [cruise(leg.segments, length) for leg, length in zip(legs, lengths, strict=True)]

    def timed(scale):
        made = []
        for leg, speed, share in zip(legs, speeds, scale, strict=True):
            timing = hir.Timing(None, speed=None if share is None else hir.Reading(speed * share, None))
            made.append(Leg(replace(leg.motion, timing=timing), leg.path, leg.segments))
        return chain.jobs(made)

    robot = industrial6()
    for scale, found in (
        ((1, 1), []),
        ((1, None), []),
        ((None, 1), []),
        ((1.003, 1), ["Y1167"]),
        ((1, 0.997), ["Y1167"]),
    ):
        jobs = timed(scale)
        result = certify(emit(robot, Q0, jobs), program(Q0, jobs), robot, TOLERANCE)
        assert codes(result) == found


def test_a_time_optimal_motion_isnt_judged_by_its_jerk():
    robot = industrial6()
    slack = replace(robot.limits, jerk=np.full(6, 1.0))
    goal = Q0 + np.array([10, 0, 5, 0, 0, 20]) * DEG
    points = joint_points(Q0, goal, 60)
    # The name of a law doesn't matter: the map claims that its jerk has no limit, and the program must agree.
    for profile, free, found in (("LSPB", False, ["Y1157"]), ("TOPP", False, ["Y1157"]), ("ANY", True, [])):
        job = Job(hir.JointMove(origin(0), hir.JointGoal(goal), profile, TIMING), points, any_jerk=free)
        result = judge(job, limits=slack)
        assert codes(result) == found
        command = result.value.commands[0]
        assert command.jerk.share > 1.0
        assert command.jerk_judged == (not free)
        assert command.to_json()["jerk_judged"] == command.jerk_judged
    # The other limits of the motion are judged.
    tight = replace(robot.limits, acceleration=np.full(6, 0.01))
    assert codes(judge(job, limits=tight)) == ["Y1157"]
    # A map that claims this for a law whose jerk has a limit is refused.
    claimed = certify(emit(robot, Q0, [job]), program(Q0, [job]), robot, TOLERANCE)
    assert codes(claimed) == ["Y1153"]
    assert "its jerk has no limit" in claimed.diagnostics[0].message


@pytest.mark.parametrize("order", [("TOPP", "LSPB"), ("LSPB", "TOPP")])
def test_a_blend_with_a_time_optimal_motion(order):
    """The jerk of the blend isn't judged for either motion. The jerk of the rest of the other motion is."""
    from tests.certify.test_certify_blends import GOALS, joint_chain

    _, jobs = joint_chain()
    robot = industrial6()
    jobs = [jobs[0], *jobs[1:]]
    profiles = (*order, order[1])
    jobs = [
        replace(job, motion=replace(job.motion, profile=profile), any_jerk=profile == "TOPP")
        for job, profile in zip(jobs, profiles, strict=True)
    ]
    claims = Claims(any_jerk=frozenset(k for k, profile in enumerate(profiles) if profile == "TOPP"))
    assert len(GOALS) == 3
    plain = certify(emit(robot, Q0, jobs), program(Q0, jobs), robot, TOLERANCE, claims)
    assert codes(plain) == []
    # Here the jerk limit is so low that ramps and blends exceed it. Only motions whose jerk is judged have a
    # finding.
    tight = replace(robot, limits=replace(robot.limits, jerk=robot.limits.jerk * 1e-3), written=None)
    result = certify(emit(tight, Q0, jobs), program(Q0, jobs), tight, TOLERANCE, claims)
    judged = [k for k, profile in enumerate(profiles) if profile != "TOPP"]
    steps = {int(finding.message[4]) - 1 for finding in result.diagnostics}
    assert steps <= set(judged)
    assert set(codes(result)) == {"Y1157"}
    assert tool_poses(robot.chain, Q0[None], np.eye(4)).shape == (1, 4, 4)


def test_a_target_that_is_given_twice_has_no_speed():
    """A target that comes twice, as in tool paths from CAM, has no speed. The robot is already there, and
    continues.
    """
    lines = ["DEFAULT {TCP} [V 50] (mm,deg,s) {B}", "P0010 MOVEJ_RPY 40 1000 1000 0 0 0 [3]"]
    for number, x in enumerate([60, 60, 80, 80, 80, 100]):
        lines.append(f"P{number + 2:03d}0 MOVEL {x} 1000 1000 0 0 0 BLEND 0.3")
    lines.append("P0900 MOVEL 120 1000 1000 0 0 0")
    made, found = compiled("\n".join(lines) + "\n")
    assert made is not None, [(one.code, one.message) for one in found if one.is_error]
    assert "Y0603" in {one.code for one in found}
