"""Tests of motions that flow into each other: correct texts are proved, small errors are found, and no dense
sample exceeds a bound.
"""

import json
import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.certify.certify_bench import (
    DEG,
    FLANGE_FROM_TCP,
    Job,
    emit,
    industrial6,
    inverse,
    origin,
    program,
    railed,
)
from tests.certify.certify_chains import Chain, Leg, exact_joints, in_joints, of_poses
from tests.certify.certify_paths import arc_poses, moved, off_path_at, spline_poses, turn
from yarclang import hir
from yarclang.certify import certify
from yarclang.certify.certifying import certify_text
from yarclang.certify.claims import Claims
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.model import Tolerance

TOLERANCE = Tolerance()
Q0 = np.array([10, 20, -30, 40, 50, -60]) * DEG
TIMING = hir.Timing(None)


def judge(robot, start, jobs, witnesses=None, laws=None, overlaps=None):
    claims = Claims(witnesses or {}, laws or {}, overlaps=overlaps or {})
    return certify(emit(robot, start, jobs), program(start, jobs), robot, TOLERANCE, claims)


def codes(result):
    return [finding.code for finding in result.diagnostics]


def blended(jobs, step, blend):
    """Return the jobs with another blend in the program."""
    jobs = [*jobs]
    jobs[step] = replace(jobs[step], motion=replace(jobs[step].motion, blend=blend))
    return jobs


# in joint space


GOALS = Q0 + np.array([[20, 10, 5, -20, 10, 0], [-5, 20, 15, 10, -10, 30], [10, 0, 0, 0, 5, 0]]) * DEG


@cache
def joint_chain(overlaps=(12, 8)):
    legs = []
    for k, goal in enumerate(GOALS):
        blend = None if k == 2 else hir.Reading(None, 5 * DEG)
        target = hir.JointDelta(goal - GOALS[0]) if k == 1 else hir.JointGoal(goal)
        motion = hir.JointMove(origin(k, "MOVEJ"), target, "LSPB", TIMING, blend=blend)
        legs.append(Leg(motion, None, 60))
    ways = np.diff(np.vstack([Q0, GOALS]), axis=0)
    chain = exact_joints(legs, overlaps, Q0, ways)
    return chain, chain.jobs(legs)


def joint_truth(chain, corner, goal):
    q, _ = chain.sample(industrial6(), *chain.overlap(corner))
    return np.abs(q - goal).max()


def test_joint_motions():
    robot = industrial6()
    chain, jobs = joint_chain()
    result = judge(robot, Q0, jobs)
    assert codes(result) == []
    one, two, last = result.value.commands
    assert [c.segments for c in result.value.commands] == [54, 50, 56]
    assert last.blended is None
    for corner, command in enumerate((one, two)):
        assert command.blended.segments == chain.overlaps[corner]
        truth = joint_truth(chain, corner, GOALS[corner])
        assert truth - 1e-9 <= command.blended.angle <= truth * 1.0001 + 1e-9
        assert command.blended.radius == 0.0
        assert command.blended.turn == 5 * DEG
        # With a radius that is 1 % too small, the motion leaves the ball.
        for share, found in ((0.99, ["Y1166"]), (1.001, [])):
            smaller = blended(jobs, corner, hir.Reading(None, truth * share))
            assert codes(judge(robot, Q0, smaller)) == found
        assert command.deviation.angle < 1e-9
        assert command.deviation.end_angle == 0.0
    assert result.value.to_json()["commands"][0]["blend"]["segments"] == 12
    message = judge(robot, Q0, blended(jobs, 0, hir.Reading(None, 0.1 * DEG))).diagnostics[0].message
    assert message.startswith("P0001 MOVEJ: in the blend after it J")
    assert (
        "from the corner, where the next path is joined: 2.43 more than the 0.1 that are allowed" in message
    )


def test_prismatic_joints_have_a_length():
    robot = railed()
    start, goals = np.zeros(5), np.array([[0.3, 0.2, -0.1, 0.05, 0.1], [0.1, 0.4, 0.0, 0.02, 0.0]])
    legs = [
        Leg(hir.JointMove(origin(k), hir.JointGoal(goal), "LSPB", TIMING, blend=blend), None, 60)
        for k, (goal, blend) in enumerate(zip(goals, (hir.Reading(0.1, 0.1), None), strict=True))
    ]
    chain = exact_joints(legs, (16,), start, np.diff(np.vstack([start, goals]), axis=0))
    jobs = chain.jobs(legs)
    assert codes(judge(robot, start, jobs)) == []
    q, _ = chain.sample(robot, *chain.overlap(0))
    far = np.abs(q - goals[0]).max(axis=0)
    found = judge(robot, start, jobs).value.commands[0].blended
    assert np.isclose(found.position, far[[0, 3]].max(), rtol=1e-3)
    assert np.isclose(found.angle, far[[1, 2, 4]].max(), rtol=1e-3)
    for length, angle, name in ((far[0] * 0.99, 0.1, "J1"), (0.1, far[1] * 0.98, "J2")):
        result = judge(robot, start, blended(jobs, 0, hir.Reading(length, angle)))
        assert codes(result) == ["Y1166"]
        assert name in result.diagnostics[0].message


def edited(jobs, step, row, change):
    jobs = [*jobs]
    points = jobs[step].points.copy()
    points[row] += change
    jobs[step] = replace(jobs[step], points=points)
    return jobs


def test_a_joint_chain_that_is_wrong_by_a_little():
    robot = industrial6()
    _, jobs = joint_chain()
    off = 2 * TOLERANCE.angle * np.array([0, 0, 1, 0, 0, -1])
    for step, row in ((0, 20), (1, 25), (2, 30)):
        assert codes(judge(robot, Q0, edited(jobs, step, row, off))) == ["Y1159"]
    # Within a ball, a small error is allowed, but not this large one.
    for size, found in ((0.01 * DEG, []), (6 * DEG, ["Y1166"])):
        changed = edited(jobs, 1, 0, np.array([0, 0, 0, 0, 0, size]))
        assert ("Y1166" in codes(judge(robot, Q0, changed))) == bool(found)
    # The text is refused if the program has another corner.
    other = [*jobs]
    goal = hir.JointGoal(GOALS[0] + np.array([0, 0, 0.1, 0, 0, 0]) * DEG)
    other[0] = replace(jobs[0], motion=replace(jobs[0].motion, goal=goal))
    assert "Y1159" in codes(judge(robot, Q0, other))
    # A relative motion counts from the programmed corner, not from the robot's position in the middle of the
    # blend.
    delta = hir.JointDelta(GOALS[1] - GOALS[0] + 2 * off)
    other = [*jobs]
    other[1] = replace(jobs[1], motion=replace(jobs[1].motion, goal=delta))
    assert set(codes(judge(robot, Q0, other))) == {"Y1159"}


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        (" blend 12\n", " blend 11\n", "which have no middle"),
        (" blend 12\n", " blend 106\n", "would lie in blends"),
        (" blend 12\n", "\n", None),
        (" blend 12\n", " blend 4\n", None),
        (" blend 8\n", " blend 14\n", None),
    ],
)
def test_a_map_with_another_blend(old, new, reason):
    robot = industrial6()
    _, jobs = joint_chain()
    text = emit(robot, Q0, jobs)
    assert old in text
    result = certify(text.replace(old, new), program(Q0, jobs), robot, TOLERANCE)
    if reason:
        assert codes(result) == ["Y1153"]
        assert reason in result.diagnostics[0].message
    elif new == "\n":
        assert "Y1155" in codes(result)
    elif new == " blend 4\n":
        assert set(codes(result)) == {"Y1159"}
    else:
        assert codes(result) == []  # the text follows less of the paths, and stays inside of the ball


def test_a_blend_on_the_wrong_line():
    robot = industrial6()
    _, jobs = joint_chain()
    text = emit(robot, Q0, jobs)
    # A map that has a blend after the last motion is refused, because this motion ends at rest.
    last = next(line for line in text.split("\n") if line.startswith("; command 2 "))
    result = certify(text.replace(last, last + " blend 4"), program(Q0, jobs), robot, TOLERANCE)
    assert codes(result) == ["Y1153"]
    # A blend where the program has none is refused.
    result = judge(robot, Q0, blended(jobs, 0, None))
    assert codes(result) == ["Y1153"]
    assert "must end at rest" in result.diagnostics[0].message
    ended = blended(jobs, 2, hir.Reading(None, 1.0))
    result = certify(text.replace(last, last + " blend 4"), program(Q0, ended), robot, TOLERANCE)
    assert codes(result) == ["Y1153"]
    assert "the sequence ends" in result.diagnostics[0].message
    # A motion that could flow on, but stops, is correct.
    assert codes(certify(text, program(Q0, ended), robot, TOLERANCE)) == []
    # A blend over a wait is refused.
    waits = [jobs[0], Job(hir.Dwell(origin(1, "WAIT"), 1.0), None), *jobs[1:]]
    assert codes(judge(robot, Q0, waits)) == ["Y1153"]


def test_a_text_without_its_source():
    robot = industrial6()
    _, jobs = joint_chain()
    result = certify_text(emit(robot, Q0, jobs), robot, jobs[0].motion.origin.source)
    assert codes(result) == ["Y1193"]
    assert result.value.commands[0].deviation.position == np.inf
    without = emit(robot, Q0, jobs).replace(" blend 12\n", "\n")
    assert codes(certify_text(without, robot, jobs[0].motion.origin.source)) == ["Y1155"]


def test_times_of_a_chain():
    """The time of a motion counts from mid-blend to mid-blend. Corners are on whole segments, so the end of a
    chain is accurate to half a segment.
    """
    robot = industrial6()
    _, jobs = joint_chain()
    times = [54 * 0.05, 50 * 0.05, 56 * 0.05]
    for off, found in (
        ((0, 0, 0), []),
        ((0.02, 0, 0), []),
        ((0.02, -0.02, 0), []),
        ((0.03, 0, 0), ["Y1156"] * 3),
        ((0.02, 0.02, -0.02), ["Y1156"]),
        ((0, 0, 0.03), ["Y1156"]),
    ):
        timed = [
            replace(job, motion=replace(job.motion, timing=hir.Timing(t + x)))
            for job, t, x in zip(jobs, times, off, strict=True)
        ]
        assert codes(judge(robot, Q0, timed)) == found


# of the moving frame


START = tool_poses(industrial6().chain, Q0[None], FLANGE_FROM_TCP)[0]


def line_of(start, goal):
    def path(s):
        poses = np.tile(np.eye(4), (len(s), 1, 1))
        poses[:, :3, 3] = start[:3, 3] + np.outer(s, goal[:3, 3] - start[:3, 3])
        poses[:, :3, :3] = turn(start, goal, s)
        return poses

    return path


def line(step, start, goal, segments, blend=None, **changes):
    motion = hir.LineMove(
        origin(step, "MOVEL"), hir.PoseGoal(goal, FLANGE_FROM_TCP), "LSPB", TIMING, blend=blend, **changes
    )
    return Leg(motion, line_of(start, goal), segments)


A = moved(START, np.array([0.1, 0.02, 0.0]), np.array([0.1, 0.1, 0]))
B = moved(A, np.array([0.0, 0.08, 0.04]), np.array([0, -0.2, 0.1]))
C = moved(B, np.array([-0.06, 0.0, 0.03]), np.array([0.0, 0.1, 0.1]))


@cache
def frame_chain(kind="lines", overlap=16):
    radius = hir.Reading(0.042, None)
    if kind == "lines":
        legs = [line(0, START, A, 40, radius), line(1, A, B, 40, radius), line(2, B, C, 40)]
    elif kind == "arc":
        via = (A[:3, 3] + B[:3, 3]) / 2 + np.array([0.03, 0, 0])
        arc = hir.ArcMove(
            origin(1, "MOVEC"), via, hir.PoseGoal(B, FLANGE_FROM_TCP), "LSPB", TIMING, blend=radius
        )
        legs = [
            line(0, START, A, 40, radius),
            Leg(arc, lambda s: arc_poses(A, via, B, s), 40),
            line(2, B, C, 40),
        ]
    else:
        middle = moved(A, np.array([0.02, 0.05, 0.0]), np.array([0.1, 0, 0]))
        goals = tuple(hir.PoseGoal(p, FLANGE_FROM_TCP) for p in (middle, B))
        curve = hir.PoseSplineMove(origin(1, "MOVEL_SPLINE"), goals, "LSPB", TIMING, blend=radius)
        legs = [
            line(0, START, A, 40, radius),
            Leg(curve, lambda s: spline_poses([A, middle, B], s), 50),
            line(2, B, C, 40),
        ]
    chain = of_poses(legs, (overlap, overlap), Q0)
    return chain, chain.jobs(legs), legs


@pytest.mark.parametrize("kind", ["lines", "arc", "curve"])
def test_motions_of_the_frame(kind):
    robot = industrial6()
    chain, jobs, legs = frame_chain(kind)
    result = judge(robot, Q0, jobs)
    assert codes(result) == []
    for corner, (command, pose) in enumerate(zip(result.value.commands, (A, B), strict=False)):
        _, poses = chain.sample(robot, *chain.overlap(corner))
        truth = np.linalg.norm(poses[:, :3, 3] - pose[:3, 3], axis=1).max()
        assert truth - 1e-10 <= command.blended.position <= truth * 1.002 + 1e-5
        norm = np.linalg.norm(poses[:, :3, :3] - pose[:3, :3], axis=(1, 2)).max()
        assert (
            2 * np.arcsin(norm / np.sqrt(8)) - 1e-10 <= command.blended.angle <= command.blended.turn + 1e-4
        )
        for share, found in ((0.99, ["Y1166"]), (1.002, [])):
            smaller = blended(jobs, corner, hir.Reading(truth * share, None))
            assert codes(judge(robot, Q0, smaller)) == found
    # Between the balls, the motion is on the path, by dense sampling.
    for k, command in enumerate(result.value.commands):
        first, last = chain.spans[k]
        inside = first + (8 if k else 0), last - (8 if k < 2 else 0)
        least, _ = off_path_at(chain.sample(robot, *inside, per_segment=2)[1], legs[k].path)
        assert least - 1e-9 <= command.deviation.position < TOLERANCE.position
        assert command.deviation.end_position == 0.0 or k == 2


@pytest.mark.parametrize("kind", ["lines", "arc", "curve"])
def test_a_chain_of_the_frame_that_is_wrong_by_a_little(kind):
    robot = industrial6()
    _, jobs, _ = frame_chain(kind)
    off = 0.01 * DEG * np.array([0, 0, 1, 0, 0, 0])
    for step, row in ((0, 16), (1, 9), (2, 20)):
        assert codes(judge(robot, Q0, edited(jobs, step, row, off))) == ["Y1159"]
    # Inside of the ball, the frame turns too far. The last joint turns the frame about its own axis, so the
    # origin of the frame hardly moves.
    assert "Y1166" in codes(judge(robot, Q0, edited(jobs, 1, 0, np.array([0, 0, 0, 0, 0, 60 * DEG]))))
    # The text is refused if the program's corner is displaced by twice the tolerance.
    other = [*jobs]
    motion = jobs[0].motion
    goal = hir.PoseGoal(moved(A, np.array([0, 0, 1e-4]), np.zeros(3)), FLANGE_FROM_TCP)
    other[0] = replace(jobs[0], motion=replace(motion, goal=goal))
    assert "Y1159" in codes(judge(robot, Q0, other))


def test_a_change_counts_from_the_programmed_corner():
    robot = industrial6()
    _, jobs, _ = frame_chain()
    shift = A[:3, :3].T @ (B - A)[:3, 3]
    change = A[:3, :3].T @ B[:3, :3]
    for axes, on_flange in ((A[:3, :3], False), (FLANGE_FROM_TCP[:3, :3], True)):
        for off, found in ((0.0, []), (1e-4, ["Y1159"])):
            goal = hir.PoseDelta(shift + off, change, axes, on_flange, FLANGE_FROM_TCP)
            other = [*jobs]
            other[1] = replace(jobs[1], motion=replace(jobs[1].motion, goal=goal))
            assert sorted(set(codes(judge(robot, Q0, other)))) == found


def test_blends_that_take_all_of_a_motion():
    """Each blend takes half of a motion. Then no part of the path is followed, but all of it is inside of the
    balls.
    """
    robot = industrial6()
    half = np.linalg.norm((B - A)[:3, 3]) / 2
    radius = hir.Reading(half * 1.01, None)
    legs = [line(0, START, A, 60, radius), line(1, A, B, 32, radius), line(2, B, C, 60)]
    chain = of_poses(legs, (16, 16), Q0)
    jobs = chain.jobs(legs)
    assert chain.spans[1] == (52, 68)
    assert codes(judge(robot, Q0, jobs)) == []
    for blend in (hir.Reading(half * 0.98, None),):
        small = blended(blended(jobs, 0, blend), 1, blend)
        assert "Y1166" in codes(judge(robot, Q0, small))


# joints and frames


def mixed_chain(overlap=14):
    robot = industrial6()
    radius = hir.Reading(0.035, None)
    corner = Q0 + np.array([8, 4, -3, 5, 2, 0]) * DEG
    start = tool_poses(robot.chain, corner[None], FLANGE_FROM_TCP)[0]
    goal = moved(start, np.array([0.08, 0.03, 0]), np.array([0.1, 0, 0.1]))
    path = line_of(start, goal)
    end = inverse(robot, path(np.linspace(0, 1, 9)), corner)[-1]
    last = end + np.array([-10, 5, 5, 0, 0, 10]) * DEG
    legs = [
        Leg(
            hir.JointMove(origin(0), hir.PoseGoal(start, FLANGE_FROM_TCP), "LSPB", TIMING, blend=radius),
            lambda s: Q0 + np.outer(s, corner - Q0),
            50,
        ),
        Leg(
            hir.LineMove(origin(1), hir.PoseGoal(goal, FLANGE_FROM_TCP), "LSPB", TIMING, blend=radius),
            lambda s: inverse(robot, path(s), corner),
            50,
        ),
        Leg(
            hir.SplineMove(origin(2), (hir.JointGoal(last),), "LSPB", TIMING),
            lambda s: end + np.outer(s, last - end),
            50,
        ),
    ]
    chain = in_joints(legs, (overlap, overlap), Q0)
    return chain, chain.jobs(legs), (corner, end, last), (start, goal)


def test_joints_and_frames_in_one_chain():
    robot = industrial6()
    chain, jobs, (corner, end, last), poses = mixed_chain()
    claims = {0: corner[None], 1: end[None], 2: last[None]}
    result = judge(robot, Q0, jobs, claims)
    assert codes(result) == []
    # The joints at the end of a line can be computed without a claim.
    assert codes(judge(robot, Q0, jobs, {0: corner[None], 2: last[None]})) == []
    for k in range(2):
        _, at = chain.sample(robot, *chain.overlap(k))
        truth = np.linalg.norm(at[:, :3, 3] - poses[k][:3, 3], axis=1).max()
        found = result.value.commands[k].blended
        assert truth - 1e-10 <= found.position <= truth * 1.01 + 2e-5
        small = blended(jobs, k, hir.Reading(truth * 0.99, None))
        assert codes(judge(robot, Q0, small, claims)) == ["Y1166"]
    # For a joint motion to a pose, a claim is needed, and it must be true.
    assert "Y1161" in codes(judge(robot, Q0, jobs, {2: last[None]}))
    for step, off in ((0, 0.01), (1, 0.01)):
        wrong = dict(claims)
        wrong[step] = claims[step] + off * DEG
        assert "Y1161" in codes(judge(robot, Q0, jobs, wrong))
    other = claims[1] + np.array([[0, 0, 0, 0, 0, 2 * np.pi]])
    assert "Y1161" not in codes(judge(robot, Q0, jobs, {**claims, 1: other}))
    assert "Y1159" in codes(judge(robot, Q0, jobs, {**claims, 1: other}))
    for step, row in ((0, 15), (1, 20), (2, 25)):
        off = 0.02 * DEG * np.array([0, 0, 1, 0, 0, 0])
        assert codes(judge(robot, Q0, edited(jobs, step, row, off), claims)) == ["Y1159"]


def test_claims_about_laws_of_a_chain():
    robot = industrial6()
    _, jobs, legs = frame_chain("curve")
    plain = judge(robot, Q0, jobs).value.commands[1].deviation
    claimed = judge(robot, Q0, jobs, laws={1: legs[1].control})
    assert codes(claimed) == []
    assert claimed.value.commands[1].deviation.position < 2 * plain.position + 1e-6
    for law in (legs[1].control[::-1], legs[1].control[5:], legs[1].control * np.nan):
        assert codes(judge(robot, Q0, jobs, laws={1: law})) == []
        bad = edited(jobs, 1, 20, 0.01 * DEG * np.array([0, 0, 1, 0, 0, 0]))
        assert codes(judge(robot, Q0, bad, laws={1: law})) == ["Y1159"]


# dense sampling


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(-6, -1.5), st.sampled_from(["lines", "arc", "curve"]))
def test_no_sample_is_beyond_what_is_certified(seed, size, kind):
    """If points are moved anywhere, dense samples stay within the proved balls and paths."""
    rng = np.random.default_rng(seed)
    robot = industrial6()
    chain, _jobs, legs = frame_chain(kind)
    control = chain.control.copy()
    rows = rng.integers(6, len(control) - 6, 3)
    control[rows] += 10**size * rng.normal(size=(3, 6))
    changed = Chain(control, chain.spans, chain.overlaps)
    commands = judge(robot, Q0, changed.jobs(legs)).value.commands
    for corner, pose in enumerate((A, B)):
        _, poses = changed.sample(robot, *chain.overlap(corner), per_segment=20)
        found = commands[corner].blended
        assert np.linalg.norm(poses[:, :3, 3] - pose[:3, 3], axis=1).max() <= found.position + 1e-9
        norm = np.linalg.norm(poses[:, :3, :3] - pose[:3, :3], axis=(1, 2)).max()
        assert 2 * np.arcsin(min(norm / np.sqrt(8), 1)) <= found.angle + 1e-9
    for k, command in enumerate(commands):
        first, last = chain.spans[k]
        inside = first + (8 if k else 0), last - (8 if k < 2 else 0)
        least, _ = off_path_at(changed.sample(robot, *inside, per_segment=2)[1], legs[k].path)
        assert command.deviation.position >= least - 1e-9


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(2, 15))
def test_joint_balls(seed, half):
    rng = np.random.default_rng(seed)
    robot = industrial6()
    ways = rng.normal(size=(2, 6)) * 0.2
    goals = Q0 + np.cumsum(ways, axis=0)
    legs = [
        Leg(hir.JointMove(origin(k), hir.JointGoal(goal), "LSPB", TIMING, blend=blend), None, 50)
        for k, (goal, blend) in enumerate(zip(goals, (hir.Reading(None, 1.0), None), strict=True))
    ]
    chain = exact_joints(legs, (2 * half,), Q0, ways)
    jobs = chain.jobs(legs)
    result = judge(robot, Q0, jobs)
    assert "Y1166" not in codes(result)
    assert "Y1159" not in codes(result)
    truth = joint_truth(chain, 0, goals[0])
    assert truth - 1e-9 <= result.value.commands[0].blended.angle <= truth * 1.001 + 1e-8


def test_a_joint_motion_turns_the_frame_by_what_its_joints_turn():
    """In the last part of the joint motion, the joints' rotations nearly cancel each other, so the frame
    turns only a little. The bound is the sum of the signed rotations, not the sum of their absolute values.
    """
    robot = industrial6()
    corner = np.array([0, 20, -30, 0, 10, 0]) * DEG
    start = tool_poses(robot.chain, corner[None], FLANGE_FROM_TCP)[0]
    goal = moved(start, np.array([0.15, 0.0, 0]), np.zeros(3))
    path = line_of(start, goal)
    # Joints 2, 3 and 5 turn about parallel axes.
    first = corner + np.array([0, 5, -12.5, 0, 7.5, 0]) * DEG
    radius = hir.Reading(0.07, None)
    legs = [
        Leg(
            hir.JointMove(origin(0), hir.JointGoal(corner), "LSPB", TIMING, blend=radius),
            lambda s: first + np.outer(s, corner - first),
            50,
        ),
        Leg(
            hir.LineMove(origin(1), hir.PoseGoal(goal, FLANGE_FROM_TCP), "LSPB", TIMING),
            lambda s: inverse(robot, path(s), corner),
            50,
        ),
    ]
    chain = in_joints(legs, (22,), first)
    jobs = chain.jobs(legs)
    result = judge(robot, first, jobs)
    assert codes(result) == []
    found = result.value.commands[0].blended
    assert 0.01 * DEG < found.angle < found.turn
    # A larger turn of the frame is found.
    worse = edited(jobs, 1, 0, np.array([0, 0, 0, 0, 0, 60 * DEG]))
    assert "Y1166" in codes(judge(robot, first, worse))


def test_two_frames_in_one_chain():
    """The ball belongs to the first motion's frame. Outside of the ball, each motion follows its own path."""
    robot = industrial6()
    other = np.eye(4)
    other[:3, 3] = [0.05, 0.2, 0.1]
    corner = inverse(robot, line_of(START, A)(np.linspace(0, 1, 9)), Q0)[-1]
    begin = tool_poses(robot.chain, corner[None], other)[0]
    goal = moved(begin, np.array([0.0, 0.07, 0.03]), np.array([0.1, 0, 0.2]))
    path = line_of(begin, goal)
    first = line(0, START, A, 40, hir.Reading(0.045, None))
    legs = [
        Leg(first.motion, lambda s: inverse(robot, first.path(s), Q0), 40),
        Leg(
            hir.LineMove(origin(1), hir.PoseGoal(goal, other), "LSPB", TIMING),
            lambda s: inverse(robot, path(s), corner, other),
            40,
        ),
    ]
    chain = in_joints(legs, (14,), Q0)
    jobs = chain.jobs(legs)
    result = judge(robot, Q0, jobs)
    assert codes(result) == []
    _, poses = chain.sample(robot, *chain.overlap(0))
    truth = np.linalg.norm(poses[:, :3, 3] - A[:3, 3], axis=1).max()
    assert truth - 1e-10 <= result.value.commands[0].blended.position <= truth * 1.01 + 1e-5
    assert codes(judge(robot, Q0, blended(jobs, 0, hir.Reading(truth * 0.99, None)))) == ["Y1166"]
    for step in range(2):
        bad = edited(jobs, step, (14, 20)[step], 0.02 * DEG * np.array([0, 0, 1, 0, 0, 0]))
        assert codes(judge(robot, Q0, bad)) == ["Y1159"]


@exercises(certificate=0.3)
@settings(max_examples=25, deadline=None)
@given(st.data())
def test_no_text_stops_the_judge(tally, data):
    """With random changes of the numbers of moves, map and TM, the judge gives a certificate or a refusal,
    and each can be printed.
    """
    robot = industrial6()
    _, jobs, _ = frame_chain(data.draw(st.sampled_from(["lines", "arc", "curve"])))
    lines = emit(robot, Q0, jobs).split("\n")
    for _ in range(data.draw(st.integers(1, 3))):
        kind = data.draw(st.sampled_from(["X", "; command", "TM"]))
        k = data.draw(st.sampled_from([k for k, line in enumerate(lines) if line.startswith(kind)]))
        if kind == "X":
            size = data.draw(st.sampled_from(["0", "1000", "-77.5", "9999999"]))
            lines[k] = re.sub(r"Z-?[0-9.]+", f"Z{size}", lines[k])
        elif kind == "TM":
            lines[k] = data.draw(st.sampled_from(["TM4", "TM100", "TM4095"]))
        else:
            lines[k] = re.sub(r" blend \d+", f" blend {2 * data.draw(st.integers(0, 30))}", lines[k])
    result = certify("\n".join(lines), program(Q0, jobs), robot, TOLERANCE)
    assert result.value is not None or codes(result) in (["Y1153"], ["Y1151"])
    tally.count("certificate", result.value is not None)
    if result.value is not None:
        assert json.dumps(result.value.to_json(), allow_nan=False)
        assert result.value.summary()
