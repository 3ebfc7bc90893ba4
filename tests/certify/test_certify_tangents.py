"""Tests of corners that the motion must not leave at all (BLEND 0): the chain is on both paths, even if it
passes the corner between two knots.
"""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.certify.certify_bench import (
    DEG,
    FLANGE_FROM_TCP,
    emit,
    industrial6,
    inverse,
    inverted,
    knots,
    origin,
)
from tests.certify.certify_chains import Chain, Leg, exact_joints
from tests.certify.certify_paths import arc_poses, moved
from tests.certify.test_certify_blends import Q0, START, TIMING, codes, edited, judge, line, line_of
from yarclang import hir
from yarclang.certify.blends.tangent import _crossing
from yarclang.certify.certifying import certify_text

ZERO = hir.Reading(0.0, 0.0)
WAY = np.array([0.1, 0.02, 0.0])


def one_law(paths, lengths, n):
    """Return a chain with one law over the joined paths, so that corners are passed at any instant. Each leg
    ends at the nearest knot.
    """
    from tests.certify.certify_bench import grid_law

    s = knots(grid_law(n)) * sum(lengths)
    ends = np.cumsum(lengths)
    poses = np.tile(np.eye(4), (len(s), 1, 1))
    for k, path in enumerate(paths):
        inside = (s <= ends[k] + 1e-12) & (s >= ends[k] - lengths[k] - 1e-12)
        poses[inside] = path(np.clip((s[inside] - ends[k] + lengths[k]) / lengths[k], 0, 1))
    q = inverse(industrial6(), poses, Q0)
    lines = inverted(q)
    seams = [0, *(round(np.interp(end, s, np.arange(n + 1))) for end in ends[:-1]), n]
    control = np.vstack([np.tile(Q0, (3, 1)), lines, np.tile(lines[-1], (2, 1))])
    return Chain(control, list(itertools.pairwise(seams)), [])


def straight(share=0.4, n=60, overlap=0):
    middle, goal = moved(START, WAY * share, np.zeros(3)), moved(START, WAY, np.zeros(3))
    legs = [line(0, START, middle, 0, ZERO), line(1, middle, goal, 0)]
    chain = one_law([leg.path for leg in legs], [share, 1 - share], n)
    chain.overlaps.append(overlap)
    return chain.jobs(legs), middle


@pytest.mark.parametrize("share", [0.4, 0.4321, 0.5])
@pytest.mark.parametrize("overlap", [0, 2, 12])
def test_lines_in_one_line(share, overlap):
    jobs, _ = straight(share, overlap=overlap)
    # the segments of the test's chains take 50 ms
    result = judge(industrial6(), Q0, jobs, overlaps={0: overlap * 0.05})
    assert codes(result) == []
    assert result.value.commands[0].blended.segments == overlap
    assert result.value.commands[0].blended.position == 0.0
    for step, row in ((0, 10), (0, -1), (1, 0), (1, 15)):
        bad = edited(jobs, step, row, 0.01 * DEG * np.array([0, 0, 1, 0, 0, 0]))
        assert "Y1159" in codes(judge(industrial6(), Q0, bad, overlaps={0: overlap * 0.05}))
    text = emit(industrial6(), Q0, jobs)
    assert codes(certify_text(text, industrial6(), jobs[0].motion.origin.source)) == ["Y1193"]


def test_an_arc_that_flows_into_a_line():
    """An arc flows into a line along its tangent. Only the curvature jumps, with a short blend in time."""
    robot = industrial6()
    radius, x, y = 0.06, np.array([1.0, 0, 0]), np.array([0, 0.8, 0.6])

    def on(phi):
        return START[:3, 3] + radius * (np.sin(phi) * x + (1 - np.cos(phi)) * y)

    via, end = on(0.4), moved(START, on(0.9) - START[:3, 3], np.zeros(3))
    tangent = np.cos(0.9) * x + np.sin(0.9) * y
    goal = moved(end, 0.05 * tangent, np.zeros(3))
    arc = hir.ArcMove(origin(0, "MOVEC"), via, hir.PoseGoal(end, FLANGE_FROM_TCP), "LSPB", TIMING, blend=ZERO)
    legs = [Leg(arc, lambda s: arc_poses(START, via, end, s), 0), line(1, end, goal, 0)]
    # The speed is low enough for the jump of the curvature to stay within the tolerance.
    chain = one_law([leg.path for leg in legs], [radius * 0.9, 0.05], 160)
    chain.overlaps.append(0)
    jobs = chain.jobs(legs)
    assert codes(judge(robot, Q0, jobs)) == []
    # At a line at an angle to the tangent, the text can't be on both paths.
    for angle, found in ((1e-5, []), (0.01, ["Y1159", "Y1160"])):
        bent = moved(end, 0.05 * (np.cos(angle) * tangent + np.sin(angle) * np.cross(x, y)), np.zeros(3))
        other = [legs[0], line(1, end, bent, 0)]
        assert set(codes(judge(robot, Q0, chain.jobs(other)))) <= set(found)
        assert bool(codes(judge(robot, Q0, chain.jobs(other)))) == bool(found)


def test_joint_motions_in_one_line():
    robot = industrial6()
    way = np.array([20, 10, 5, -20, 10, 0]) * DEG
    for share in (0.5, 0.37):
        legs = [
            Leg(hir.JointMove(origin(k), hir.JointGoal(q), "LSPB", TIMING, blend=blend), None, 60)
            for k, (q, blend) in enumerate(((Q0 + share * way, ZERO), (Q0 + way, None)))
        ]
        chain = exact_joints(legs[:1], (), Q0, [way])
        seam = round(np.interp(share, knots(legs[0].control), np.arange(61)))
        chain = Chain(chain.control, [(0, seam), (seam, 60)], [0])
        jobs = chain.jobs(legs)
        assert codes(judge(robot, Q0, jobs)) == []
        bad = edited(jobs, 0, 15, 4e-3 * DEG * np.array([0, 0, 1, 0, 0, -1]))
        assert codes(judge(robot, Q0, bad)) == ["Y1159"]
        # The text is refused if the program's corner isn't on the path.
        away = hir.JointGoal(Q0 + share * way + 0.01 * DEG * np.array([0, 0, 1, 0, 0, -1]))
        other = [*jobs]
        from dataclasses import replace

        other[0] = replace(jobs[0], motion=replace(jobs[0].motion, goal=away))
        assert "Y1159" in codes(judge(robot, Q0, other))


def test_many_corners_in_one_line():
    """One of the legs has only two segments."""
    robot = industrial6()
    shares = [0.0, 0.3, 0.475, 0.515, 0.75, 1.0]
    poses = [moved(START, WAY * share, np.zeros(3)) for share in shares]
    legs = [line(k, poses[k], poses[k + 1], 0, ZERO if k < 4 else None) for k in range(5)]
    chain = one_law([leg.path for leg in legs], np.diff(shares), 60)
    chain.overlaps.extend([0] * 4)
    jobs = chain.jobs(legs)
    assert codes(judge(robot, Q0, jobs)) == []
    assert line_of(START, poses[-1])(np.ones(1))[0][0, 3] == pytest.approx(poses[-1][0, 3])
    bad = edited(jobs, 2, 0, 0.01 * DEG * np.array([0, 0, 1, 0, 0, 0]))
    assert "Y1159" in codes(judge(robot, Q0, bad))


@given(st.integers(0, 2**32 - 1), st.integers(1, 12))
def test_a_crossing_is_found_whatever_is_looked_for_beside_it(seed, count):
    chance = np.random.default_rng(seed)
    root, steep = chance.uniform(-0.2, 1.2, count), 10.0 ** chance.uniform(-3, 3, (count, 2))
    power, low = chance.choice([0.3, 1.0, 3.0], count), chance.integers(0, 3, count) / 8.0
    high = low + chance.choice([0.0, 0.125, 0.25], count)
    asked = [0]

    def rate(rows, place):
        asked[0] += 1
        off = place - root[rows]
        side = np.where(off > 0.0, steep[rows, 0], steep[rows, 1])
        return side * np.sign(off) * np.abs(off) ** power[rows]

    found = _crossing(rate, np.arange(count), low, high)
    assert np.abs(found - np.clip(root, low, high)).max() < 1.1e-9
    assert asked[0] <= 50
    for row in range(count):
        alone = _crossing(rate, np.array([row]), low[[row]], high[[row]])
        assert alone[0] == found[row]
