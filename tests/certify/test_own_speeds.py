"""Tests of the judge's own speeds in slow zones: they are never below fine samples, sharp, and independent of
the planner's.
"""

from dataclasses import replace

import numpy as np
import pytest

from tests.collision.test_proof import ROBOTS, drawn, random_motion
from tests.collision.zones.clouds import Clouds, drawn_zone, inside
from tests.collision.zones.test_workspace import COUNT, window
from yarclang.cell.model import HalfSpace, JointWindow, Zone
from yarclang.certify.bodies.borders import directions_to, extent
from yarclang.certify.bodies.fastest import SHARP, Motions, fastest_in
from yarclang.certify.kinematics.arm import motions
from yarclang.certify.motion.bounds import Cubics
from yarclang.collision.scene import scene_of
from yarclang.collision.zones import regions, speed
from yarclang.collision.zones.watched import tool_frame
from yarclang.collision.zones.workspace import watches_of
from yarclang.robot.description import load_robot

STEP = 1e-5
"""Time step for velocities by differences of point clouds [s]."""


def cubics_of(course):
    return Cubics(course.x, course.v, course.a, course.j, np.diff(course.begins))


def found_of(scene, course, spans, watch):
    moved = Motions(scene.chain, cubics_of(course), spans)
    return fastest_in(moved, watch.zone.region, watch.zone.margin, watch.item)


@pytest.mark.parametrize("seed", range(COUNT))
def test_no_speed_is_missed(seed):
    random = np.random.default_rng(seed + 911)
    robot = load_robot(ROBOTS[seed % 2]).value
    zones = [drawn_zone(random, f"Z{at}", "slow", speed=0.25) for at in range(3)]
    zones.append(Zone("W", "slow", window(-1.0, 0.5, 1), speed=0.25))
    cell, moving = replace(drawn(random, count=0), zones=tuple(zones)), tool_frame(robot)
    scene, watches = scene_of(robot, cell).value, watches_of(robot, cell, moving)
    course = random_motion(robot, random)
    count = len(course.x)
    spans = np.array([[0, count // 2], [count // 2, count]])
    clouds = Clouds(robot, cell, moving.flange_from_moving, random)
    for zone in zones:
        own = [one for one in watches if one.zone is zone]
        assert own
        found = np.max([found_of(scene, course, spans, one).speed for one in own], axis=0)
        planned = np.max([speed.fastest_inside(scene, course, spans, one).speed for one in own], axis=0)
        # The searches of planner and judge both have sharp bounds, so a plan that respects a zone isn't
        # refused.
        assert (found <= planned * (1 + 3 * SHARP)).all()
        for row, (first, last) in enumerate(spans):
            times = np.linspace(course.begins[first], course.begins[last], 42)[1:-1]
            q = course.at(times)
            for part in zone.watch:
                before, after = (clouds.watched(part, course.at(times + side * STEP)) for side in (-1, 1))
                for name, points in clouds.watched(part, q).items():
                    seen = np.linalg.norm(after[name] - before[name], axis=2).max(axis=1) / (2 * STEP)
                    if isinstance(zone.region, JointWindow):
                        within = ((q >= zone.region.lower) & (q <= zone.region.upper)).all(axis=1)
                    else:
                        within = inside(zone.region, points).any(axis=1)
                    assert (seen[within] <= found[row] * (1 + 1e-6)).all()


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("name", ROBOTS)
def test_velocities_are_those_of_differences(name, seed):
    robot = load_robot(name).value
    random = np.random.default_rng(seed)
    q, rate = random.uniform(-1, 1, (5, robot.size)), random.uniform(-1, 1, (5, robot.size))
    placed, spin, drift = motions(robot.chain, q, rate)
    before, after = (motions(robot.chain, q + side * STEP * rate, rate)[0] for side in (-1, 1))
    point = random.uniform(-1, 1, 3)
    for joint in range(robot.size + 1):
        here, one, other = (
            np.einsum("ijp,j->ip", at[joint, :, :3], point) + at[joint, :, 3]
            for at in (placed, before, after)
        )
        velocity = np.cross(spin[joint], here, axis=0) + drift[joint]
        np.testing.assert_allclose(velocity, (other - one) / (2 * STEP), atol=1e-8)


@pytest.mark.parametrize("seed", range(30))
def test_borders_are_those_of_the_other_geometry(seed):
    """Distances of points outside, and extents, agree with those of `yarclang.collision`."""
    random = np.random.default_rng(seed)
    region = drawn_zone(random, "Z", "slow", speed=0.25).region
    points = random.uniform(-2, 3, (200, 3))
    toward = directions_to(region, points.T)
    gaps = (toward * points.T).sum(axis=0) - extent(region, toward)
    wanted = regions.outside(region, points)
    beyond = wanted > 0
    np.testing.assert_allclose(gaps[beyond], wanted[beyond], atol=1e-9)
    assert (gaps[~beyond] <= 1e-9).all()
    if not isinstance(region, HalfSpace):
        np.testing.assert_allclose(extent(region, toward), regions.reach(region, toward.T), atol=1e-9)


def test_an_error_of_the_planner_is_none_of_the_judge(monkeypatch, industrial6):
    """The judge calls no function of the planner's search."""
    for name in ("_Search", "fastest_inside", "least_outside", "roughly_outside", "rates", "outside"):
        monkeypatch.delattr(speed, name)
    zone = Zone("ALL", "slow", HalfSpace(np.array([0, 0, 1.0]), -9.0), speed=0.25, watch=("arm", "tcp"))
    cell = replace(drawn(np.random.default_rng(0), count=0), zones=(zone,))
    scene = scene_of(industrial6, cell).value
    course = random_motion(industrial6, np.random.default_rng(1))
    spans = np.array([[0, len(course.x)]])
    for watch in watches_of(industrial6, cell, tool_frame(industrial6)):
        assert found_of(scene, course, spans, watch).speed[0] > 0.0


def test_what_is_no_number_is_never_slow(industrial6):
    """A rate that isn't a number ends the search, and isn't a speed that a zone allows."""
    zone = Zone("ALL", "slow", HalfSpace(np.array([0, 0, 1.0]), -9.0), speed=0.25, watch=("tcp",))
    cell = replace(drawn(np.random.default_rng(0), count=0), zones=(zone,))
    scene = scene_of(industrial6, cell).value
    (watch,) = watches_of(industrial6, cell, tool_frame(industrial6))
    course = random_motion(industrial6, np.random.default_rng(1))
    course.v[2, 1] = np.nan
    with np.errstate(invalid="ignore"):
        found = found_of(scene, course, np.array([[0, len(course.x)]]), watch)
    assert not found.speed[0] <= 1e9
