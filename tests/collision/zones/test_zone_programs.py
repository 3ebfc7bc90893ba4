"""Random tests that each program that compiles in a cell with zones respects them, by an independent reading
of the text and clouds of points.
"""

import os

import numpy as np
import pytest
from floors import Tally
from programs import compiled

from tests.collision.test_proof import cell_of
from tests.collision.test_proof import drawn as drawn_cell
from tests.collision.zones.clouds import Clouds, drawn_zone, inside
from yarclang.campaign.drawing import drawn
from yarclang.cell.model import HalfSpace, Zone
from yarclang.certify.motion.speed import KEPT
from yarclang.diagnostics import Result
from yarclang.independent.arm import Arm
from yarclang.independent.reading import overlaps, read
from yarclang.robot.description import load_robot

COUNT = int(os.environ.get("YARCLANG_ZONE_PROGRAMS", "6"))
"""Number of programs that are drawn; for a night, YARCLANG_ZONE_PROGRAMS=2000."""

PART = 50
"""Number of programs in one test. A certain share of them must compile."""

BREACHES = {"Y0907", "Y0908", "Y0909", "Y0910"}
STEP = 2e-5
"""Time step of the differences by which velocities are computed [s]."""


def cell(random):
    """Return a cell with zones around the middle of the arm's workspace. Some of them are violated, most
    aren't; some are slow ones.
    """
    zones = [drawn_zone(random, f"Z{at}", str(random.choice(["forbidden", "allowed"]))) for at in range(2)]
    zones += [drawn_zone(random, f"S{at}", "slow", speed=float(random.uniform(0.05, 0.5))) for at in range(2)]
    if random.random() < 0.3:
        everywhere = HalfSpace(np.array([0.0, 0.0, 1.0]), -9.0)
        zones.append(Zone("ALL", "slow", everywhere, speed=0.2, watch=("tool", "elbow")))
    made = cell_of()
    tool = drawn_cell(random, count=0).obstacles
    return type(made)(made.source, {}, {}, {}, {}, tool if random.random() < 0.5 else (), tuple(zones), {})


@pytest.mark.parametrize("first", range(0, COUNT, PART))
def test_no_violation_is_certified(first):
    tally = Tally()
    for seed in range(first, min(first + PART, COUNT)):
        look_for_a_violation(tally, seed)
    assert tally.below({"certified": 0.3, "refused for a zone": 0.1}) == []


def look_for_a_violation(tally, seed):
    """Compare one random program in random zones with clouds of points."""
    random = np.random.default_rng(seed + 5008)
    name = ("INDUSTRIAL6", "TRACKED_MANIPULATOR")[seed % 2]
    robot = load_robot(name).value
    arm, around = Arm.in_folder(robot.folder), cell(random)
    program = drawn(arm, random, most=2)
    text = 'CELL "cell.toml"\n' + program.text
    value, found = compiled(text, name, load_cell=lambda *_: Result(around, ()))
    codes = {one.code for one in found if one.is_error}
    tally.count("certified", value is not None)
    tally.count("refused for a zone", value is None and codes <= BREACHES)
    if value is None:
        assert codes
        # A plan always respects the speeds of slow zones, so the certificate never finds a violation.
        assert "Y0911" not in codes, text
        if codes <= BREACHES:
            _has_a_breach(robot, around, text, name, random)
        return
    _, commands = read(value.text)
    clouds = Clouds(robot, around, robot.flange_from_frame["TCP"], random)
    assert not overlaps(value.text) or len(commands) > 1
    for executed in commands.values():
        if executed.duration == 0.0:
            continue
        times = np.linspace(STEP, executed.duration - STEP, 40)
        q = executed.spline(times) * arm.si
        ends = [executed.spline(times + side * STEP) * arm.si for side in (-1, 1)]
        for zone in around.zones:
            for part in zone.watch:
                before, behind = (clouds.watched(part, at) for at in ends) if zone.speed else ({}, {})
                for body, points in clouds.watched(part, q).items():
                    within = inside(zone.region, points)
                    if zone.rule == "allowed":
                        assert within.all(), (zone.name, body, text)
                    elif zone.rule == "forbidden":
                        assert not within.any(), (zone.name, body, text)
                    else:
                        speed = np.linalg.norm(behind[body] - before[body], axis=2).max(axis=1) / (2 * STEP)
                        fast = speed[within.any(axis=1)]
                        assert (fast <= zone.speed * (1.0 + KEPT) + 1e-6).all(), (zone.name, body, text)


def _has_a_breach(robot, around, text, name, random):
    """Check that a program that is refused only for its zones violates them. Without the zones it compiles,
    and some point is where it must not be, or near.
    """
    bare = type(around)(around.source, {}, {}, {}, {}, around.obstacles, (), {})
    value, found = compiled(text, name, load_cell=lambda *_: Result(bare, ()))
    assert value is not None, (found, text)
    arm, (_, commands) = Arm.in_folder(robot.folder), read(value.text)
    clouds = Clouds(robot, around, robot.flange_from_frame["TCP"], random)
    least = np.inf
    for executed in commands.values():
        q = executed.spline(np.linspace(0.0, executed.duration, 60)) * arm.si
        for zone in around.zones:
            if zone.rule == "slow":
                continue
            for part in zone.watch:
                for points in clouds.watched(part, q).values():
                    least = min(least, _room(zone, points) - zone.margin)
    assert least < 0.1, text


def _room(zone, points):
    """Return how far points are inside or outside of a zone, as the rule requires [m]."""
    from yarclang.collision.zones.regions import outside

    far = outside(zone.region, points)
    return float(-far.max() if zone.rule == "allowed" else far.min())
