"""Tests of splines through hundreds of poses: their bounds hold for scipy's splines, and time and memory grow
only in proportion to their length.
"""

import tracemalloc

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from programs import codes, compiled, planned, robot_of
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from tests.certify.certify_paths import spline_poses
from yarclang.certify.motion.posespline import CELLS, FEWEST_CELLS, PoseSpline
from yarclang.robot.kinematics.fk import tool_poses

CENTRE = np.array([0.0, 1050.0, 1000.0])
TOLERANCE, ANGLE = 0.02e-3, np.radians(0.002)


def wander(seed, count, *, huge=False, doubled=False, closed=False):
    """Return waypoints (count, 6) [mm, deg] that are 0.3 to 3 mm apart. On request, one leg has 80 mm, some
    waypoints come twice, or the path is closed.
    """
    chance = np.random.default_rng(seed)
    heading = np.cumsum(chance.uniform(-0.15, 0.15, count))
    steps = chance.uniform(0.3, 3.0, count)
    if huge:
        steps[count // 2] = 80.0
    ways = steps[:, None] * np.stack(
        [np.cos(heading), np.sin(heading), chance.uniform(-0.03, 0.03, count)], axis=1
    )
    points = np.cumsum(ways, axis=0)
    points -= points[0]
    reach = np.abs(points).max()
    points *= min(1.0, 150.0 / reach)
    turns = (
        8.0 * np.sin(np.linspace(0.0, chance.uniform(2.0, 20.0), count))[:, None] * chance.uniform(-1, 1, 3)
    )
    rows = np.round(np.hstack([CENTRE + points, turns - turns[0]]), 4)
    if doubled:
        rows = np.repeat(rows, 1 + (chance.uniform(size=count) < 0.2), axis=0)
    return np.vstack([rows, rows[0]]) if closed else rows


def coil(count):
    """Return waypoints (count, 6) [mm, deg] on a coil, 0.5 to 3 mm apart."""
    angles = np.cumsum(np.random.default_rng(5).uniform(0.5, 3.0, count)) / 60.0
    places = CENTRE + np.stack([60 * np.cos(angles), 60 * np.sin(angles), 0.1 * angles], axis=1)
    return np.round(np.hstack([places, np.zeros((count, 3))]), 4)


def program_of(rows, time, command="MOVEL_SPLINE"):
    said = [" ".join(f"{value:.4f}" for value in row) for row in rows]
    way = ";\n  ".join(said[1:])
    return f"DEFAULT {{TCP}} [5] (mm,deg,s) {{B}}\nP1 MOVEJ_RPY {said[0]}\nP2 {command} {way} {time}\n"


def poses_of(rows):
    """Return the poses (w, 4, 4) of waypoints. Equal neighbours count once."""
    rows = rows[np.r_[True, np.abs(np.diff(rows, axis=0)).max(axis=1) > 0]]
    poses = np.tile(np.eye(4), (len(rows), 1, 1))
    poses[:, :3, 3] = rows[:, :3] * 1e-3
    poses[:, :3, :3] = Rotation.from_euler("ZYX", rows[:, :2:-1], degrees=True).as_matrix()
    return poses


def missed(executed, poses, branches=24):
    """Return the largest distance of executed poses (N, 4, 4) from the curve through waypoints [m], and the
    angle at the nearest point [rad].

    The curve may cross itself, so several points near each pose are compared.
    """
    grid = np.linspace(0.0, 1.0, 24 * len(poses) + 1)
    near = cKDTree(spline_poses(poses, grid)[:, :3, 3]).query(executed[:, :3, 3], k=branches)[1]
    best, width, row = grid[near.ravel()], grid[1], np.arange(branches * len(executed))
    wanted = np.repeat(executed, branches, axis=0)
    for _ in range(9):
        s = np.clip(best[:, None] + np.linspace(-width, width, 7), 0.0, 1.0)
        there = spline_poses(poses, s.ravel()).reshape(*s.shape, 4, 4)
        far = np.linalg.norm(there[..., :3, 3] - wanted[:, None, :3, 3], axis=-1)
        nearest = np.argmin(far, axis=1)
        best, width = s[row, nearest], width / 2.5
    far = far[row, nearest].reshape(-1, branches)
    turns = Rotation.from_matrix(there[row, nearest, :3, :3]).inv() * Rotation.from_matrix(wanted[:, :3, :3])
    chosen = np.arange(len(far)), np.argmin(far, axis=1)
    return float(far[chosen].max()), float(turns.magnitude().reshape(far.shape)[chosen].max())


@settings(max_examples=4, deadline=None)
@example(688172268, "closed", "[V 8]")  # was faster than its law at a sharp turn
@example(128, "closed", "[V 8]")  # its largest speed is between two samples of the planner
@example(2962381006, "doubled", "[40]")  # the first waypoint is a nanometre from the start
@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from(["plain", "huge", "doubled", "closed"]),
    st.sampled_from(["[V 8]", "[40]"]),
)
def test_what_is_proved_of_a_long_spline_holds(seed, kind, time):
    rows = wander(seed, 80, **({kind: True} if kind != "plain" else {}))
    text = program_of(rows, time)
    made, found = compiled(text)
    if made is None:  # the limits don't allow this path at this speed, which must be reported
        assert {code[:3] for code in codes(found)} in ({"Y06"}, {"Y05", "Y06"})
        return
    deviation = made.certificate.commands[1].deviation
    motion = planned(text)[0].motions[1]
    times = np.linspace(0.0, motion.curve.duration, 500)
    robot = robot_of("INDUSTRIAL6")
    tool = motion.path.flange_from_moving
    executed = tool_poses(robot.chain, motion.curve.sample(times)[0], tool)
    least, angle = missed(executed, poses_of(rows))
    assert least - 1e-7 <= deviation.position <= TOLERANCE
    assert deviation.angle <= ANGLE
    assert angle - deviation.angle <= 1e-4
    # A curve that misses a waypoint, in any direction, isn't proved.
    far, at = [], len(rows) // 3
    away = np.linalg.norm(executed[:, :3, 3] - rows[at, :3] * 1e-3, axis=1)
    near = executed[np.argsort(away)[:25]]
    for axis in range(3):
        other = rows.copy()
        other[at, axis] += 0.2
        far.append(missed(near, poses_of(other))[0])
    assert max(far) > TOLERANCE


@pytest.mark.parametrize("count", [3, 200, 3_000, 20_000])
def test_bounds_are_as_many_as_spans(count):
    spline = PoseSpline.through(poses_of(wander(1, count)), np.eye(4))
    each = (len(spline.cells) - 1) / (count - 1)
    assert FEWEST_CELLS <= each <= CELLS
    assert each == FEWEST_CELLS or each * (count - 1) <= 2 * 16_384


def test_fewer_bounds_are_bounds_still():
    """Bounds of the derivatives are valid even with few cells on each span. They are compared with scipy's
    spline.
    """
    poses = poses_of(wander(2, 5_000))
    spline = PoseSpline.through(poses, np.eye(4))
    s = np.sort(np.random.default_rng(0).uniform(0.001, 0.999, 400))
    width = 1e-6
    bounds = spline.bounds(np.zeros(len(s), dtype=int), s - width, s + width)
    before, behind = np.split(spline_poses(poses, np.concatenate([s - width / 2, s + width / 2])), 2)
    speed = np.linalg.norm(behind[:, :3, 3] - before[:, :3, 3], axis=1) / width
    spin = np.linalg.norm(behind[:, :3, :3] - before[:, :3, :3], axis=(1, 2)) / width
    assert (speed <= bounds.position[:, 0] * (1 + 1e-6)).all()
    assert (spin <= bounds.rotation[:, 0] * (1 + 1e-4) + 1e-6).all()


def peak(count, command, time):
    text = program_of(coil(count), time, command)
    tracemalloc.start()
    try:
        made, found = compiled(text)
        assert made is not None, found
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(("command", "pace"), [("MOVEL_SPLINE", 0.03), ("MOVEJ_SPLINE_RPY", 0.03)])
def test_memory_grows_with_the_way_and_no_faster(command, pace):
    """At the same pace, memory grows in proportion to the path's length, apart from the memory that short
    paths need as well.
    """
    first, second, third = (peak(count, command, f"[{count * pace:g}]") for count in (500, 1_000, 2_500))
    assert third - first < 4.0 * 1.4 * max(second - first, 2_000_000)
    assert third < 2_500 * 25_000


def test_a_thousand_short_legs_are_no_motion_of_thousands_of_segments():
    """Ramps that take only a small part of a motion don't determine its segment time."""
    rows = coil(2_000)
    plan, found = planned(program_of(rows, "[V 40]"))
    assert not [one for one in found if one.is_error]
    curve = plan.motions[1].curve
    assert curve.segments < 3 * len(rows)
