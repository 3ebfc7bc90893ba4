"""Tests of zones to stay inside or outside of: no violation is missed. Violations are found independently,
from points of bodies that Pinocchio places; distances are compared with other computations.
"""

import os
from dataclasses import replace

import numpy as np
import pytest
from floors import Tally

from tests.collision.test_proof import ROBOTS, cell_of, drawn, motion, random_motion
from tests.collision.zones.clouds import Clouds, drawn_region, drawn_zone, inside
from yarclang.cell.model import HalfSpace, JointWindow, ShapeRegion, Zone
from yarclang.collision.proof import KNOWN
from yarclang.collision.scene import scene_of
from yarclang.collision.zones.moved import Pieces, rates
from yarclang.collision.zones.proof import kept
from yarclang.collision.zones.regions import direction, outside, reach
from yarclang.collision.zones.watched import Moving, bodies_of, tool_frame
from yarclang.collision.zones.workspace import slack_at, slack_of, watches_of
from yarclang.robot.description import load_robot
from yarclang.shapes import Box

PART = 24
"""Number of cells in one test. A certain share of them must be respected, and a certain share violated."""
COUNT = int(os.environ.get("YARCLANG_RANDOM_ZONES", "24"))
"""Number of cells that are drawn; for a night, YARCLANG_RANDOM_ZONES=5000."""


def window(lower, upper, joint=2):
    low, high = np.full(6, -np.inf), np.full(6, np.inf)
    low[joint], high[joint] = lower, upper
    return JointWindow(low, high)


def zoned(random, count=4):
    """Return a cell with a tool, and zones of all rules."""
    zones = []
    for at in range(count):
        rule = str(random.choice(["allowed", "forbidden", "posture"]))
        posture = window(*np.sort(random.uniform(-2, 2, 2))) if rule == "posture" else None
        zones.append(drawn_zone(random, f"Z{at}", rule, posture=posture))
    zones.append(Zone("W", str(random.choice(["allowed", "forbidden"])), window(-1.0, 0.8, 1)))
    return replace(drawn(random, count=0), zones=tuple(zones))


def keep_to(scene, watches, q):
    """Return which joint positions respect all zones."""
    return np.all([slack_at(scene, one, q) >= slack_of(one) for one in watches], axis=0)


@pytest.mark.parametrize("seed", range(COUNT))
def test_no_breach_is_missed(seed):
    random = np.random.default_rng(seed)
    robot = load_robot(ROBOTS[seed % 2]).value
    cell, moving = zoned(random), tool_frame(robot)
    scene, watches = scene_of(robot, cell).value, watches_of(robot, cell, moving)
    course = random_motion(robot, random)
    count = len(course.x)
    spans = np.array([[0, count // 2], [count // 2, count]])
    found = kept(scene, course, spans, watches)
    clouds = Clouds(robot, cell, moving.flange_from_moving, random)
    broken = {(one.motion, watches[one.watch].zone.name) for one in found.breaches}
    for row, (first, last) in enumerate(spans):
        q = course.at(np.linspace(course.begins[first], course.begins[last], 60))
        fits = keep_to(scene, watches, q)
        for zone in cell.zones:
            if isinstance(zone.region, JointWindow):
                bad = ((q < zone.region.lower) | (q > zone.region.upper)).any(axis=1)
                bad = bad if zone.rule == "allowed" else ~bad
            else:
                bad = np.zeros(len(q), dtype=bool)
                for part in zone.watch:
                    for points in clouds.watched(part, q).values():
                        within = inside(zone.region, points)
                        bad |= (~within).any(axis=1) if zone.rule == "allowed" else within.any(axis=1)
                if zone.posture is not None:
                    bad &= ((q < zone.posture.lower) | (q > zone.posture.upper)).any(axis=1)
            if bad.any():
                assert (row, zone.name) in broken, (zone.name, zone.rule)
            assert not fits[bad].any()


@pytest.mark.parametrize("first", range(0, COUNT, PART))
def test_what_is_told_is_true(first):
    tally = Tally()
    for seed in range(first, min(first + PART, COUNT)):
        look_whether_it_is_true(tally, seed)
    assert tally.below({"kept": 0.1, "broken": 0.2}) == []


def look_whether_it_is_true(tally, seed):
    """Check that a reported violation is one, and that a reported distance isn't larger than any
    sampled one.
    """
    random = np.random.default_rng(seed + 10_000)
    robot = load_robot(ROBOTS[seed % 2]).value
    cell = zoned(random)
    scene, watches = scene_of(robot, cell).value, watches_of(robot, cell, tool_frame(robot))
    course = random_motion(robot, random)
    span = np.array([[0, len(course.x)]])
    found = kept(scene, course, span, watches)
    tally.count("kept", not found.breaches)
    tally.count("broken", found.breaches)
    for one in found.breaches:
        assert slack_at(scene, watches[one.watch], course.at(np.array([one.time])))[0] < slack_of(
            watches[one.watch]
        )
    if not found.breaches:
        q = course.at(np.linspace(0, course.begins[-1], 400))
        near = [slack_at(scene, one, q).min() + one.zone.margin for one in watches if one.item is not None]
        assert min(near, default=np.inf) >= found.least[0] - 1e-6
        assert found.least[0] >= min(0.9 * min(near, default=np.inf) - 2e-3, KNOWN - 1e-6)


@pytest.mark.parametrize("seed", range(8))
def test_depths_are_those_of_points(seed):
    """The depth of a body inside or outside of a zone agrees with a cloud of its points."""
    random = np.random.default_rng(seed + 77)
    robot = load_robot("INDUSTRIAL6").value
    q = random.uniform(robot.limits.lower, robot.limits.upper, (10, 6))
    for rule in ("allowed", "forbidden"):
        region = drawn_region(random, large=rule == "allowed")
        for part in ("tcp", "elbow", "link_2", "link_4"):
            cell = replace(drawn(random, count=0), zones=(Zone("Z", rule, region, watch=(part,)),))
            moving = Moving("T", robot.flange_from_frame["TCP"])
            clouds = Clouds(robot, cell, moving.flange_from_moving, random)
            scene = scene_of(robot, cell).value
            (watch,) = watches_of(robot, cell, moving)
            (points,) = clouds.watched(part, q).values()
            slack = slack_at(scene, watch, q)
            far = outside(region, points)
            seen = -far.max(axis=1) if rule == "allowed" else far.min(axis=1)
            # Depths aren't compared, because coal computes the penetration depth of convex bodies only
            # roughly.
            assert (slack <= np.maximum(seen, 0.0) + 1e-6).all()
            free = slack > 0.0
            # A cloud has gaps of some centimetres, so its nearest point may be farther away than the body.
            assert (slack >= seen - (1e-6 if len(points[0]) == 1 else 0.08))[free].all()


@pytest.mark.parametrize("seed", range(20))
def test_signed_distances(seed):
    """Signed distances are 1-Lipschitz and convex, agree with membership, and grow along `direction`. No
    point is beyond `reach`.
    """
    random = np.random.default_rng(seed)
    region = drawn_region(random)
    one, other = random.uniform(-2, 2, (2, 500, 3))
    far = outside(region, one)
    assert ((far <= 0) == inside(region, one)).all()
    assert (np.abs(far - outside(region, other)) <= np.linalg.norm(one - other, axis=1) + 1e-12).all()
    assert (outside(region, (one + other) / 2) <= np.maximum(far, outside(region, other)) + 1e-12).all()
    away = direction(region, one)
    assert np.linalg.norm(away, axis=1) == pytest.approx(np.ones(500))
    assert outside(region, one + 1e-6 * away) - far == pytest.approx(np.full(500, 1e-6), abs=1e-9)
    tangent = np.einsum("ij,ij->i", away, one) - far
    assert (far > 0).any()
    assert reach(region, away)[far > 0] == pytest.approx(tangent[far > 0], abs=1e-9)


@pytest.mark.parametrize("robot", ROBOTS)
def test_rates_bound_all_points(robot):
    """Speed, acceleration and jerk of bodies' points, from differences, are within their bounds."""
    robot = load_robot(robot).value
    random = np.random.default_rng(2)
    scene = scene_of(robot, drawn(random, count=0)).value
    course = random_motion(robot, random)
    for _, item in bodies_of(scene):
        if item.joint == 0:
            continue
        bounds = rates(scene.chain, course, item)
        pieces = Pieces.whole(course, 0, len(course.x))
        d = pieces.end / 8.0
        places = [pieces.posed(item, scene, course, d * at).points(item.rim) for at in range(9)]
        bound = np.stack([bounds.first, bounds.second, bounds.third])
        differences = np.stack(places)
        for order in range(3):
            differences = np.diff(differences, axis=0) / d[None, :, None, None]
            fastest = np.linalg.norm(differences, axis=3).max(axis=(0, 2))
            assert (fastest <= bound[order] * (1 + 1e-6) + 1e-6).all()


def test_along_a_border_is_settled_quickly(industrial6):
    """A motion that is exactly on a border respects the zone. A hundredth of a millimetre beyond it, it
    doesn't.
    """
    turn = np.zeros((40, 6))
    turn[:, 0] = np.linspace(-1, 1, 40)
    course = motion(turn, 4.0)
    q = course.at(np.zeros(1))
    from yarclang.robot.kinematics.fk import tool_poses

    tcp = tool_frame(industrial6)
    height = float(tool_poses(industrial6.chain, q, tcp.flange_from_moving)[0, 2, 3])
    for beyond, breaches in ((0.0, 0), (1.1e-5, 1)):
        floor = HalfSpace(np.array([0.0, 0.0, 1.0]), height + beyond)
        top = np.eye(4)
        top[2, 3] = height - beyond + 0.5
        for zone in (
            Zone("FLOOR", "allowed", floor, watch=("tcp",)),
            Zone("OVER", "forbidden", ShapeRegion(top, Box(np.array([9.0, 9.0, 1.0]))), watch=("tcp",)),
        ):
            cell = replace(cell_of(), zones=(zone,))
            scene = scene_of(industrial6, cell).value
            found = kept(scene, course, np.array([[0, len(course.x)]]), watches_of(industrial6, cell, tcp))
            assert len(found.breaches) == breaches, (zone.name, beyond)


def test_a_robot_without_shapes_has_its_points(industrial6):
    bare = replace(industrial6, shapes=())
    floor = Zone("FLOOR", "allowed", HalfSpace(np.array([0.0, 0.0, 1.0]), 0.5), watch=("tool", "elbow"))
    cell = replace(cell_of(), zones=(floor,))
    q = np.random.default_rng(0).uniform(bare.limits.lower, bare.limits.upper, (50, 6))
    watches = watches_of(bare, cell, tool_frame(bare))
    assert len(watches) == 2
    assert 0 < keep_to(scene_of(bare, cell).value, watches, q).sum() < 50
