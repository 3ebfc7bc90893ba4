"""Tests of the largest speed in a slow zone: it is never below that of fine samples, and sharp."""

from dataclasses import replace

import numpy as np
import pytest

from tests.collision.test_proof import ROBOTS, drawn, motion, random_motion
from tests.collision.zones.clouds import Clouds, drawn_zone, inside
from tests.collision.zones.test_workspace import COUNT, window
from yarclang.cell.model import HalfSpace, Zone
from yarclang.collision.scene import scene_of
from yarclang.collision.zones.speed import SHARP, fastest_inside
from yarclang.collision.zones.watched import tool_frame
from yarclang.collision.zones.workspace import watches_of
from yarclang.robot.description import load_robot

STEP = 1e-5
"""Time step of the differences by which velocities of clouds are computed [s]."""


def slowed(random):
    zones = [drawn_zone(random, f"Z{at}", "slow", speed=0.25) for at in range(3)]
    zones.append(Zone("W", "slow", window(-1.0, 0.5, 1), speed=0.25))
    return replace(drawn(random, count=0), zones=tuple(zones))


@pytest.mark.parametrize("seed", range(COUNT))
def test_no_speed_is_missed(seed):
    random = np.random.default_rng(seed + 333)
    robot = load_robot(ROBOTS[seed % 2]).value
    cell, moving = slowed(random), tool_frame(robot)
    scene, watches = scene_of(robot, cell).value, watches_of(robot, cell, moving)
    course = random_motion(robot, random)
    count = len(course.x)
    spans = np.array([[0, count // 2], [count // 2, count]])
    clouds = Clouds(robot, cell, moving.flange_from_moving, random)
    for zone in cell.zones:
        own = [one for one in watches if one.zone is zone]
        assert own
        found = np.max([fastest_inside(scene, course, spans, one).speed for one in own], axis=0)
        for row, (first, last) in enumerate(spans):
            times = np.linspace(course.begins[first], course.begins[last], 42)[1:-1]
            q = course.at(times)
            for part in zone.watch:
                before, behind = (clouds.watched(part, course.at(times + side * STEP)) for side in (-1, 1))
                for name, points in clouds.watched(part, q).items():
                    speed = np.linalg.norm(behind[name] - before[name], axis=2).max(axis=1) / (2 * STEP)
                    if zone.name == "W":
                        within = ((q >= zone.region.lower) & (q <= zone.region.upper)).all(axis=1)
                    else:
                        within = inside(zone.region, points).any(axis=1)
                    assert (speed[within] <= found[row] * (1 + 1e-6)).all()


@pytest.mark.parametrize("seed", range(6))
def test_it_is_sharp(seed):
    """If the zone is the whole space, the largest speed of a point equals that of fine samples."""
    random = np.random.default_rng(seed)
    robot = load_robot("INDUSTRIAL6").value
    everywhere = Zone("ALL", "slow", HalfSpace(np.array([0, 0, 1.0]), -9.0), speed=0.25, watch=("tcp",))
    cell, moving = replace(drawn(random, count=0), zones=(everywhere,)), tool_frame(robot)
    scene = scene_of(robot, cell).value
    (watch,) = watches_of(robot, cell, moving)
    course = random_motion(robot, random)
    found = fastest_inside(scene, course, np.array([[0, len(course.x)]]), watch)
    times = np.linspace(0, course.begins[-1], 4000)
    clouds = Clouds(robot, cell, moving.flange_from_moving, random)
    (points,) = clouds.watched("tcp", course.at(times)).values()
    speeds = np.linalg.norm(np.diff(points[:, 0], axis=0), axis=1) / np.diff(times)
    assert speeds.max() <= found.speed[0] * (1 + 1e-9)
    assert found.speed[0] <= speeds.max() * (1 + 2 * SHARP + 2e-3)
    assert abs(found.time[0] - times[np.argmax(speeds)]) < 0.2


def test_what_is_slow_enough_is_passed_over(industrial6):
    everywhere = Zone("ALL", "slow", HalfSpace(np.array([0, 0, 1.0]), -9.0), speed=0.25, watch=("tcp",))
    cell = replace(drawn(np.random.default_rng(0), count=0), zones=(everywhere,))
    scene = scene_of(industrial6, cell).value
    (watch,) = watches_of(industrial6, cell, tool_frame(industrial6))
    course = motion(np.linspace(0, 0.3, 20)[:, None] * np.ones(6), 3.0)
    span = np.array([[0, len(course.x)]])
    peak = fastest_inside(scene, course, span, watch).speed[0]
    assert fastest_inside(scene, course, span, watch, least=2 * peak).segment[0] == -1
    assert fastest_inside(scene, course, span, watch, least=peak / 2).speed[0] == pytest.approx(
        peak, rel=2 * SHARP
    )


def test_outside_of_it_any_speed_is_right(industrial6):
    far = Zone("FAR", "slow", HalfSpace(np.array([0, 0, 1.0]), 9.0), speed=0.25)
    cell = replace(drawn(np.random.default_rng(0), count=0), zones=(far,))
    scene = scene_of(industrial6, cell).value
    course = random_motion(industrial6, np.random.default_rng(1))
    for watch in watches_of(industrial6, cell, tool_frame(industrial6)):
        found = fastest_inside(scene, course, np.array([[0, len(course.x)]]), watch)
        assert (found.speed[0], found.segment[0]) == (0.0, -1)
