"""Tests of long chains as one path, by the emitted text: where paths are left, the tool's speed, and limits;
also tests of single laws and means.
"""

import numpy as np
import pytest
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import compiled, robot_of
from scipy.spatial.transform import Rotation

from yarclang.independent.arm import Arm
from yarclang.independent.reading import overlaps, read, shares
from yarclang.motion.chains.flowing.kept import claimed_shares, without_dips
from yarclang.motion.chains.flowing.law import Law
from yarclang.motion.chains.flowing.turns import angle_between, matrices, product, quaternions, steadied

BEGIN = {"INDUSTRIAL6": (40.0, 1000.0, 1000.0), "TRACKED_MANIPULATOR": (700.0, 0.0, 500.0)}


def drawn(seed, count, shape, turning):
    """Return waypoints (count + 1, 3) [mm] that begin at the origin and are 0.5 to 3 mm apart, and rotations
    about x [deg].
    """
    chance = np.random.default_rng(seed)
    lengths = chance.uniform(0.7, 3.0, count)
    if shape == "curve":
        heading = np.cumsum(
            chance.normal(0.0, 0.02) + 0.03 * np.sin(np.arange(count) / chance.uniform(5, 30))
        )
    elif shape == "stairs":
        heading = np.repeat([0.0, np.pi / 2], 5)[np.arange(count) % 10]
    else:
        heading = np.cumsum(chance.choice([0.0, 0.0, 0.0, 0.5, -0.9, 1.4], count))
    ways = lengths[:, None] * np.stack((np.cos(heading), np.sin(heading), 0.1 * np.sin(heading)), axis=1)
    points = np.concatenate(([[0, 0, 0]], np.cumsum(ways, axis=0))).round(4)
    far = np.abs(points).max()
    points *= min(1.0, 60.0 / far)  # at most a few centimetres long
    gone = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))))
    # The rotation goes back and forth.
    turns = turning * np.abs((gone + 10.0) % 40.0 - 20.0)
    return points, turns


def program(robot, points, turns, speed, ball, tolerance):
    begin = np.array(BEGIN[robot])
    lines = [f"DEFAULT {{TCP}} [V {speed:g}] (mm,deg,s) {{B}}"]
    for number, (point, turn) in enumerate(zip(points + begin, turns, strict=True)):
        x, y, z = point
        place = f"{x:.4f} {y:.4f} {z:.4f} {turn:.4f} 0 0"
        if number == 0:
            lines.append(f"P0001 MOVEJ_RPY {place} [5]")
        else:
            flows = f" BLEND {ball:.6g}" if number < len(points) - 1 else ""
            lines.append(f"P{10 * number:04d} MOVEL {place} TOL {tolerance:g}{flows}")
    return "\n".join(lines) + "\n"


def to_segments(p, a, b):
    """Return the distances (N, k) of points (N, 3) from k straight pieces."""
    way = b - a
    along = np.einsum("nki,ki->nk", p[:, None] - a, way) / np.maximum(np.einsum("ki,ki->k", way, way), 1e-30)
    nearest = a + np.clip(along, 0, 1)[..., None] * way
    return np.linalg.norm(p[:, None] - nearest, axis=2)


def looked_at(text, robot, points, speed, ball, tolerance):
    """Compare a text with its waypoints. Return the mean speed as a share of the programmed one, between the
    first and the last time at which it is reached.
    """
    arm = Arm.in_folder(robot_of(robot).folder)
    _, commands = read(text)
    corners = np.array(BEGIN[robot]) + points
    radii = overlaps(text)
    fast, times = [], 0.0
    for step in sorted(commands)[1:]:
        executed = commands[step]
        for name, share in shares(arm, executed).items():
            assert share <= 1.0 + 1e-6, (step, name, share)
        p, _ = arm.poses(executed.sample())
        own = step - 1
        near = slice(max(own - 1, 0), own + 2)
        off = to_segments(p, corners[:-1][near], corners[1:][near]).min(axis=1)
        at_corner = np.minimum(
            np.linalg.norm(p - corners[own], axis=1) if own and radii[step - 1] else np.full(len(p), np.inf),
            np.linalg.norm(p - corners[own + 1], axis=1) if radii.get(step) else np.full(len(p), np.inf),
        )
        left = off > tolerance * (1 + 1e-6)
        assert (at_corner[left] <= ball + tolerance).all(), (step, off.max(), at_corner[left].max())
        steps = np.linalg.norm(np.diff(p, axis=0), axis=1) / (executed.segment / 8)
        # The chord of an arc is shorter than the arc.
        assert steps.max() <= speed * (1 + 2e-3), (step, steps.max())
        fast.append(steps)
        times += executed.duration
    fast = np.concatenate(fast) / speed
    reached = np.flatnonzero(fast > 0.98)
    return fast[reached[0] : reached[-1] + 1].mean() if len(reached) else 0.0


@exercises(flows=0.85)
@settings(max_examples=12, deadline=None)
@given(
    st.sampled_from(sorted(BEGIN)),
    st.integers(0, 10**6),
    st.integers(45, 80),
    st.sampled_from(["curve", "stairs", "corners"]),
    st.sampled_from([0.0, 0.3, -1.0]),
    st.sampled_from([5.0, 20.0, 50.0]),
    st.sampled_from([0.0, 0.1, 0.3]),
)
def test_what_is_certified_keeps_to_its_paths_and_limits(
    tally, robot, seed, count, shape, turning, speed, ball
):
    points, turns = drawn(seed, count, shape, turning)
    if shape != "curve":
        ball = max(ball, 0.1)
    ball = min(ball, 0.49 * np.linalg.norm(np.diff(points, axis=0), axis=1).min())
    made, found = compiled(program(robot, points, turns, speed, ball, 0.05), robot)
    assert made is not None, [(one.code, one.message) for one in found][:3]
    flows = [motion.flows for motion in made.plan.motions[1:-1]]
    tally.count("flows", all(flows))
    looked_at(made.text, robot, points, speed, ball, 0.05)


def test_a_curve_of_short_pieces_keeps_its_speed():
    """A curve of short pieces keeps its speed. It would be much slower if each corner were passed
    by itself.
    """
    at = np.arange(150) * 2.0
    heading = np.radians(60) * np.sin(at / 40.0)
    points = np.concatenate(
        ([[0, 0, 0]], np.cumsum(2.0 * np.stack((np.cos(heading), np.sin(heading), 0 * at), axis=1), axis=0))
    )
    made, found = compiled(program("INDUSTRIAL6", points.round(3), np.zeros(151), 50.0, 0.3, 0.02))
    assert made is not None
    assert looked_at(made.text, "INDUSTRIAL6", points.round(3), 50.0, 0.3, 0.02) > 0.975
    assert all(motion.flows for motion in made.plan.motions[1:-1])
    assert made.plan.motions[-1].overlap is None
    # Findings concern only the beginning and the end.
    told = [one.span.line for one in found if one.code == "Y0610"]
    assert not [line for line in told if 8 < line < 145]


@given(st.integers(2, 60), st.integers(0, 10**6))
def test_the_law_is_the_fastest_one(count, seed):
    chance = np.random.default_rng(seed)
    s = np.concatenate(([0.0], np.cumsum(chance.uniform(0.01, 1.0, count))))
    ceiling, slope = chance.uniform(0.05, 2.0, count + 1), chance.uniform(0.1, 3.0, count)
    law = Law.fastest(s, ceiling, slope)
    assert law.v[0] == law.v[-1] == 0.0
    assert (law.v <= ceiling * (1 + 1e-9)).all()
    gained = np.abs(np.diff(law.v**2))
    assert (gained <= 2.0 * slope * np.diff(s) * (1 + 1e-9) + 1e-12).all()
    # The speed at each inner node is the largest possible: its ceiling, or the speed that can be reached from
    # a neighbour.
    for k in range(1, count):
        tight = [
            ceiling[k] ** 2,
            law.v[k - 1] ** 2 + 2 * slope[k - 1] * (s[k] - s[k - 1]),
            law.v[k + 1] ** 2 + 2 * slope[k] * (s[k + 1] - s[k]),
        ]
        assert law.v[k] ** 2 == pytest.approx(min(tight), rel=1e-9, abs=1e-12)
    # The positions of the law agree with its speeds.
    t = np.linspace(0.0, law.duration, 4001)
    places = law.places(t)
    assert places[0] == 0.0
    assert places[-1] == pytest.approx(s[-1], abs=1e-9)
    assert (np.diff(places) >= -1e-12).all()
    speeds = np.diff(places) / np.diff(t)
    middle = 0.5 * (t[1:] + t[:-1])
    assert np.abs(speeds - law.speeds(middle)).max() <= 2.0 * slope.max() * (t[1] - t[0]) + 1e-9


@given(st.integers(0, 10**6))
def test_turns(seed):
    rotations = Rotation.random(20, random_state=seed)
    turns = quaternions(rotations.as_matrix())
    np.testing.assert_allclose(matrices(turns), rotations.as_matrix(), atol=1e-12)
    both = (rotations * rotations[::-1]).as_matrix()
    np.testing.assert_allclose(matrices(product(turns, turns[::-1])), both, atol=1e-12)
    steady = steadied(turns)
    assert (np.einsum("ni,ni->n", steady[1:], steady[:-1]) >= 0.0).all()
    np.testing.assert_allclose(matrices(steady), rotations.as_matrix(), atol=1e-12)
    angles = (rotations.inv() * rotations[::-1]).magnitude()
    np.testing.assert_allclose(
        angle_between(rotations.as_matrix(), rotations[::-1].as_matrix()), angles, atol=1e-7
    )


@pytest.mark.parametrize("ball", [0.0, 0.3])
def test_a_slower_speed_on_the_way_is_kept_from_its_corner_on(ball):
    """A law that becomes slower at a corner must become slower a little before the corner: executed speeds
    are means over an interval, and would otherwise be too fast just after the corner.
    """
    at = np.arange(50) * 2.0
    heading = np.radians(2.0) * np.sin(at / 40.0)
    ways = 2.0 * np.stack((np.cos(heading), np.sin(heading), 0.0 * at), axis=1)
    points = np.concatenate(([[0, 0, 0]], np.cumsum(ways, axis=0))).round(3)
    speeds = np.where((np.arange(50) >= 15) & (np.arange(50) < 32), 20.0, 50.0)
    lines = program("INDUSTRIAL6", points, np.zeros(51), 50.0, ball, 0.05).splitlines()
    lines[2:] = [
        line.replace(" TOL", f" [V {speed:g}] TOL") for line, speed in zip(lines[2:], speeds, strict=True)
    ]
    made, found = compiled("\n".join(lines) + "\n")
    assert made is not None, [(one.code, one.message) for one in found if one.is_error]
    assert all(motion.flows for motion in made.plan.motions[1:-1])
    arm = Arm.in_folder(robot_of("INDUSTRIAL6").folder)
    _, commands = read(made.text)
    for step in range(12, 36):
        executed = commands[step]
        p, _ = arm.poses(executed.sample())
        went = np.linalg.norm(np.diff(p, axis=0), axis=1) / (executed.segment / 8)
        # The corner is passed within one segment of the seam in the map, so one segment is left out at both
        # ends.
        inner, allowed = went[8:-8], speeds[max(step - 2, 0) : step + 1].max()
        assert inner.max(initial=0.0) <= speeds[step - 1] * 1.002
        assert went.max() <= allowed * 1.002
        if 18 <= step <= 30:
            assert went.min() >= 0.99 * speeds[step - 1]


STRAIGHT_ON = """DEFAULT {TCP} (mm,deg,s) {B}
P0490 MOVEL -44.6059 857.5660 689.5432 -90.0000 0.0000 0.0000 [V 50] TOL 0.05 BLEND 0.3
P0510 MOVEL -45.6450 856.4820 693.4410 -90.0000 0.0000 0.0000 [MIN] TOL 0.05
"""
AFTER_AN_ARC = """DEFAULT {TCP} (mm,deg,s) {B}
P0001 MOVEJ 0.0000 -5.0000 -20.0000 10.0000 40.0000 0.0000 [MIN]
P0020 MOVEL -36.2322 1259.9130 1556.8441 14.6624 -9.0548 4.2617 [V 20] TOL 0.05 BLEND 0
P0030 MOVEL -34.7717 1258.0041 1555.7996 14.6624 -9.0548 4.2617 [V 20] TOL 0.05 BLEND 0
P0300 MOVEC -2.6430 1212.5835 1528.1192; -1.5881 1211.0991 1527.2198 14.6624 -9.0548 4.2617 [V 50] TOL 0.05 BLEND 0
P0470 MOVEL 19.3535 1182.9156 1511.1275 14.6624 -9.0548 4.2617 [V 50] TOL 0.05 BLEND 0
P0480 MOVEL 20.3733 1181.4566 1510.2253 14.6624 -9.0548 4.2617 [MIN] TOL 0.05 BLEND 0
P0490 MOVEL 21.2390 1180.1922 1509.4236 14.6624 -9.0548 4.2617 [MIN] TOL 0.05
"""  # noqa: E501


@pytest.mark.parametrize(
    ("lines", "robot", "step"),
    [(STRAIGHT_ON, "TRACKED_MANIPULATOR", 0), (AFTER_AN_ARC, "INDUSTRIAL6", 4)],
)
def test_a_faster_motion_begins_only_after_the_slower_one(lines, robot, step):
    """If there is no blend, the speed of the first motion applies up to its last segment."""
    made, found = compiled(lines, robot)
    assert made is not None, [(one.code, one.message) for one in found if one.is_error]
    motion = made.plan.motions[step]
    assert motion.overlap == 0
    arm = Arm.in_folder(robot_of(robot).folder)
    _, commands = read(made.text)
    executed = commands[motion.step]
    p, _ = arm.poses(executed.sample())
    speeds = np.linalg.norm(np.diff(p, axis=0), axis=1) / (executed.segment / 8)
    assert 0.9 * 50 < speeds[-1] < 50 * (1 + 1e-3)
    assert speeds.max() < 50 * (1 + 1e-3)


OUT = """P0010 MOVEJ_RPY -1 1173.97 1176 0 0 0 [5]
P0020 MOVEL_SPLINE -1 1115 1150.3 -6.5 2.6 6.3; 14.043 1188.5 1184.77 -1.1 7.1 1.8; 109 1185.6 1289 0 -4.5 0 [V 60] BLEND <=20
P0030 MOVEL -1.3 1175 1174.6 4.6 0 2.9 [V<=300]
"""  # noqa: E501
BACK = """P0010 MOVEJ_RPY -1.3 1175 1174.6 4.6 0 2.9 [5]
P0020 MOVEL 109 1185.6 1289 0 -4.5 0 [V<=300] BLEND <=20
P0030 MOVEL_SPLINE 14.043 1188.5 1184.77 -1.1 7.1 1.8; -1 1115 1150.3 -6.5 2.6 6.3; -1 1173.97 1176 0 0 0 [V 60]
"""  # noqa: E501


@pytest.mark.parametrize(("lines", "place"), [(OUT, 1), (BACK, 2)])
def test_the_speed_at_a_corner_is_no_claim_for_a_slower_part_of_the_way(lines, place):
    """A curve turns so much on a part of its way that it slows down there, and is faster both before this
    part and after it. It keeps only the speed of this part, however fast it is at the corner.
    """
    made, found = compiled("DEFAULT {TCP} [2] (mm,deg,s) {B}\n" + lines)
    assert made is not None, [(one.code, one.message) for one in found if one.is_error]
    motion = made.plan.motions[place]
    arm = Arm.in_folder(robot_of("INDUSTRIAL6").folder)
    executed = read(made.text)[1][motion.step]
    p, _ = arm.poses(executed.sample())
    speeds = np.linalg.norm(np.diff(p, axis=0), axis=1) / (executed.segment / 8)
    reached = np.flatnonzero(speeds >= 60.0 * motion.least)
    assert speeds[reached[0] : reached[-1] + 1].min() > 0.998 * 60.0 * motion.least
    assert speeds.max() > 59.0  # so the slower part is a dip


@given(
    st.lists(st.floats(0.02, 1.0), min_size=1, max_size=60),
    st.sampled_from([(True, True), (True, False), (False, True)]),
)
def test_what_is_claimed_has_no_dip(speeds, rests):
    """From the first sample at the claimed speed to the last one, no sample is slower. At an end at which the
    motion doesn't rest, it has its speed from the beginning or up to the end.
    """
    values = np.array(speeds)
    claim = float(claimed_shares(np.array(without_dips(values, np.array(rests)))))
    reached = np.flatnonzero(values >= claim)
    begin, end = (reached[0] if rests[0] else 0), (reached[-1] + 1 if rests[1] else len(values))
    assert values[begin:end].min() >= (1.0 - 1e-3) * claim
    if (np.diff(values) >= 0).all() and rests == (True, False):
        assert claim >= 0.5 * values[-5:].min()  # a motion that only speeds up claims what it has at its end
