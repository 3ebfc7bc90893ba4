"""Tests of KEEP ... FACING and SEEN: a point stays in the cone of a frame during the whole motion."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import codes, compiled, robot_of

import yarclang
from tests.certify.forging import Forger
from tests.floors import exercises
from yarclang.cell.keeping import Sight
from yarclang.certify.bodies.fastest import Motions
from yarclang.certify.bodies.sights import seen_at, sighted
from yarclang.certify.certifying import certify
from yarclang.certify.motion.bounds import Cubics
from yarclang.robot.kinematics.fk import tool_poses

HEAD = "DEFAULT {TCP} [50%%] (mm,deg,s) {B}\nFRAME {PART} %s 0 0 0 (mm,deg) {B}\n"
PASSED = ("Y0920", "Y0215", "Y0506", "Y0507")
LINE = "  P0010 MOVEJ 0 0 0 0 30 0\nEND\n"


def kept(program):
    result, found = compiled(program)
    return result, [one for one in codes(found) if one not in PASSED]


def seen_over(way, sight, count=2000):
    """Return the largest angle and both extreme distances in samples of straight joint motions."""
    robot = robot_of("INDUSTRIAL6")
    dense = np.concatenate([a + np.linspace(0, 1, count)[:, None] * (b - a) for a, b in pairwise(way)])
    poses = tool_poses(robot.chain, dense, robot.flange_from_frame["TCP"])
    facing, spot, axis = sight
    toward = (spot - poses[:, :3, 3]) * (1.0 if facing else -1.0)
    axes = poses[:, :3, 2] if facing else np.broadcast_to(axis, toward.shape)
    away = np.linalg.norm(toward, axis=1)
    across = np.linalg.norm(np.cross(axes, toward), axis=1)
    return float(np.arctan2(across, (axes * toward).sum(axis=1)).max()), float(away.min()), float(away.max())


@exercises(facing=0.1, seen=0.1, outside=0.1, beyond=0.1)
@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32))
def test_random_ways_are_judged_as_dense_samples_do(tally, seed):
    drawn = np.random.default_rng(seed)
    ways = drawn.integers(-40, 41, (drawn.integers(1, 3), 6)).tolist()
    kind, spot = ("FACING", "SEEN")[drawn.integers(2)], drawn.integers(-700, 701, 3).tolist()
    limit, near, far = drawn.integers(20, 170), drawn.integers(1, 700), drawn.integers(1500, 4000)
    lines = "".join(f"  P{10 * (at + 1):04d} MOVEJ {' '.join(map(str, q))}\n" for at, q in enumerate(ways))
    # in HOME, {TCP} is at 0 1174 1764 with its z axis upwards
    spot = [spot[0], spot[1] + 600, spot[2] + (2500 if kind == "FACING" else -300)]
    head = HEAD % " ".join(map(str, spot))
    result, found = kept(f"{head}KEEP {{TCP}} {kind} {limit} {near} {far} (deg,mm) {{PART}}\n{lines}END\n")
    way = [np.zeros(6), *(np.radians(one) for one in ways)]
    sight = kind == "FACING", np.array(spot) / 1000, np.array([0.0, 0.0, 1.0])
    angle, least, most = seen_over(way, sight)
    over = max(angle - np.radians(limit), near / 1000 - least, most - far / 1000)
    if abs(over) < 1e-3:
        return
    broken = {"Y0957", "Y0958"} & set(found)
    if not broken and (result is None or not result.text):
        return  # the program has another error: a collision or a limit
    assert bool(broken) == (over > 0.0)
    tally.count("outside", "Y0957" in broken)
    tally.count("beyond", "Y0958" in broken)
    tally.count("facing", not broken and kind == "FACING")
    tally.count("seen", not broken and kind == "SEEN")
    if not broken:
        rules = [one.kept[0] for one in result.certificate.commands]
        assert max(one.largest for one in rules) >= angle - 1e-5
        assert min(one.nearest for one in rules) <= least + 1e-5
        assert max(one.farthest for one in rules) >= most - 1e-5


@exercises(kept=0.1, broken=0.1, near=0.02)
@settings(max_examples=150, deadline=None)
@given(st.integers(0, 2**32), st.booleans())
def test_bounds_hold_for_any_cubic(tally, seed, is_carried):
    """The bounds contain all samples for fast motions, and for points near or far from the apex; else the
    motion is refused.
    """
    drawn = np.random.default_rng(seed)
    chain = robot_of("INDUSTRIAL6").chain
    x, v, a, j = drawn.uniform(-2.0, 2.0, (4, 1, 6)) * np.array([1.0, 1.0, 4.0, 10.0])[:, None, None]
    long, limit, near = drawn.uniform(0.02, 0.5), drawn.uniform(0.1, 3.0), 10.0 ** drawn.uniform(-3.0, -0.5)
    cubics = Cubics(x, v, a, j, np.array([long]))
    own, axis = drawn.uniform(-0.3, 0.3, 3), np.array([0.6, 0.0, 0.8])
    flange = tool_poses(chain, x + v * long / 2.0, np.eye(4))[0]
    ahead = flange[:3, :3] @ axis if is_carried else -axis
    away = 10.0 ** drawn.uniform(-2.5, 0.5)
    spot = flange[:3, :3] @ own + flange[:3, 3] + away * (ahead + drawn.uniform(-0.5, 0.5, 3))
    sight = Sight(tuple(own), tuple(spot), tuple(axis), is_carried, limit, near, 5.0)
    found = sighted(Motions(chain, cubics, np.array([[0, 1]])), sight)
    t = np.linspace(0.0, long, 3000)[:, None]
    q = x + t * (v + t * (a / 2.0 + t * j / 6.0))
    poses = tool_poses(chain, q, np.eye(4))
    carried = poses[:, :3, :3] @ own + poses[:, :3, 3]
    toward = (spot - carried) * (1.0 if is_carried else -1.0)
    axes = poses[:, :3, :3] @ axis if is_carried else np.broadcast_to(axis, toward.shape)
    away = np.linalg.norm(toward, axis=1)
    angle = np.arctan2(np.linalg.norm(np.cross(axes, toward), axis=1), (axes * toward).sum(axis=1))
    worst = max(angle.max() - limit, near - away.min(), away.max() - 5.0)
    if worst > 1e-5:
        assert found.exceeds[0]
    else:
        tally.count("near", away.min() < 0.1)
    if worst < -1e-3:
        assert not found.exceeds[0]
    tally.count("kept", not found.exceeds[0])
    tally.count("broken", found.exceeds[0])
    if not found.exceeds[0]:
        assert angle.max() - 1e-9 <= found.most[0] <= limit + 1e-5
        assert near - 1e-5 <= found.least[0] <= away.min() + 1e-9
        assert found.farthest[0] >= away.max() - 1e-9


def test_a_point_that_passes_the_apex_is_refused_and_not_searched_for_ever():
    robot = robot_of("INDUSTRIAL6")
    middle = tool_poses(robot.chain, np.radians([[0, 0, 0, 0, 15.0, 0]]), robot.flange_from_frame["TCP"])[
        0, :3, 3
    ]
    place = " ".join(f"{1000 * one:.9f}" for one in middle)
    for kind in ("FACING", "SEEN"):
        _, found = kept(f"{HEAD % place}KEEP {{TCP}} {kind} 175 (deg) {{PART}}\n{LINE}")
        assert len(found) == 1
        assert found[0] in ("Y0957", "Y0958")


def test_the_message_says_where_and_by_how_much():
    _, found = compiled(f"{HEAD % '0 1174.4 0'}KEEP {{TCP}} FACING 20 (deg) {{PART}}\n{LINE}")
    (one,) = [each for each in found if each.is_error]
    assert one.code == "Y0957"
    assert "{PART} is 180 deg off the z axis of {TCP}, 160 deg more than the 20 deg of KEEP" in one.message
    _, found = compiled(f"{HEAD % '0 0 0'}KEEP {{TCP}} SEEN 60 200 1000 (deg,mm) {{PART}}\n{LINE}")
    (one,) = [each for each in found if each.is_error]
    assert one.code == "Y0958"
    assert "{TCP} is 2,238.61 mm from {PART}, 1,239 mm more than the 1000 mm of KEEP" in one.message


EXAMPLE = Path(__file__).parents[2] / "examples" / "33_camera_in_sight.yarc"


def test_a_way_that_keeps_a_place_in_sight():
    """Without the rule, the planned path leaves the cone; with it, it provably stays inside."""
    text = EXAMPLE.read_text()
    kept_ = yarclang.compile(text, folder=EXAMPLE.parent)
    (rule,) = kept_.value.certificate.commands[1].kept
    assert rule.largest <= np.radians(15.0) + 1e-5
    assert 0.3 <= rule.nearest <= rule.farthest <= 1.2
    free = yarclang.compile(text.replace("FACING 15", "FACING 170"), folder=EXAMPLE.parent)
    assert free.value.certificate.commands[1].kept[0].largest > np.radians(18.0)


@pytest.mark.parametrize(
    ("rule", "code"),
    [
        ("FACING 0 (deg)", "Y0480"),
        ("FACING 176 (deg)", "Y0480"),
        ("FACED 5 (deg)", "Y0480"),
        ("FACING 5 (mm)", "Y0304"),
        ("FACING 5 0 (deg,mm)", "Y0482"),
        ("FACING 5 -100 (deg,mm)", "Y0482"),
        ("SEEN 5 900 200 (deg,mm)", "Y0482"),
        ("SEEN 5 200 200.5 (deg,mm)", "Y0482"),
        ("SEEN 5 200 300 400 (deg,mm)", "Y0401"),
        ("SEEN 5; 200 (deg,mm)", "Y0401"),
        ("ABOVE 5 200 (mm)", "Y0401"),
        ("SEEN (deg)", "Y0401"),
        ("SEEN 5 200 (deg)", "Y0304"),
        ("SEEN ON (deg)", "Y0402"),
        ("SEEN 5 (deg) {TCP}", "Y0303"),
    ],
)
def test_a_wrong_head_is_one_finding(rule, code):
    result, found = compiled(f"DEFAULT {{TCP}} [50%] (deg,s) {{B}}\nKEEP {{TCP}} {rule}\n{LINE}")
    assert result is None or not result.text
    assert [one.code for one in found if one.is_error] == [code]


@pytest.mark.parametrize(
    ("outer", "inner", "is_needless"),
    [
        ("UPRIGHT 100 (deg)", "UPRIGHT 100 (deg)", True),
        ("UPRIGHT 100 (deg)", "UPRIGHT 120 (deg)", True),
        ("UPRIGHT 120 (deg)", "UPRIGHT 100 (deg)", False),
        ("ABOVE 200 (mm)", "ABOVE 100 (mm)", True),
        ("ABOVE 100 (mm)", "ABOVE 200 (mm)", False),
        ("SEEN 100 200 3000 (deg,mm)", "SEEN 100 (deg)", True),
        ("SEEN 100 (deg)", "SEEN 120 200 (deg,mm)", False),
        ("SEEN 100 (deg)", "UPRIGHT 100 (deg)", False),
        ("SEEN 100 (deg) {B}", "SEEN 100 (deg) {PART}", False),
    ],
)
def test_a_rule_inside_of_a_narrower_one_is_a_warning(outer, inner, is_needless):
    inside = f"KEEP {{TCP}} {outer}\n  KEEP {{TCP}} {inner}\n    P0010 MOVEJ 0 0 0 0 30 0\n  END\nEND\n"
    _, found = compiled(HEAD % "0 0 -500" + inside)
    assert codes(found) == ["Y0483"] * is_needless


def test_a_rule_in_a_sub_is_not_needless_where_it_is_called_in_another():
    sub = "SUB GO\n  KEEP {TCP} UPRIGHT 120 (deg)\n    P0010 MOVEJ 0 0 0 0 30 0\n  END\nEND\n"
    program = HEAD % "0 0 0" + sub + "KEEP {TCP} UPRIGHT 100 (deg)\n  P0020 CALL GO\nEND\n"
    assert codes(compiled(program)[1]) == []


def test_the_words_of_a_rule_are_what_was_written():
    for rule in ("FACING 40 (deg) {B}", "SEEN 40 200 (deg,mm) {B}", "FACING 40.5 1 3000 (deg,mm) {B}"):
        line = f"KEEP {{TCP}} {rule}"
        result, found = kept(f"DEFAULT {{TCP}} [50%] (mm,deg,s) {{B}}\n{line.replace('40', '170')}\n{LINE}")
        assert found == []
        assert result.certificate.commands[0].kept[0].rule == line.replace("40", "170")[5:]


def test_forged_maps_are_refused():
    made, found = kept(f"{HEAD % '0 0 0'}KEEP {{TCP}} SEEN 60 200 3000 (deg,mm) {{PART}}\n{LINE}")
    assert found == []
    program, robot = made.plan.program, robot_of("INDUSTRIAL6")
    forger = Forger.of(made.text)
    at = forger.find("; keep .*")
    line = forger.lines[at]
    others = [line.replace(old, new) for old, new in (("1.0471975512", "1.1"), ("SEEN", "FACING"))]
    others += [line.replace("%200.2%20", "%200.1%20"), line[:-1], line[:-1] + "4"]
    assert all(one != line for one in others)
    forged = [forger.drop(at), forger.put(at, line)]
    forged += [Forger((*forger.lines[:at], one, *forger.lines[at + 1 :])) for one in others]
    for one in forged:
        judged = certify(one.text, program, robot, robot.tolerance)
        assert judged.value is None or any(each.is_error for each in judged.diagnostics)


def test_the_judge_measures_as_the_planner_does():
    robot = robot_of("INDUSTRIAL6")
    for at, is_carried in enumerate([True, False] * 10):
        q = np.random.default_rng(at).uniform(-2.0, 2.0, 6)
        sight = Sight((0.1, 0.2, 0.3), (0.5, -0.4, 0.3), (0.0, 0.6, 0.8), is_carried, 1.0, 0.001, np.inf)
        pose = tool_poses(robot.chain, q[None], np.eye(4))[0]
        carried = pose[:3, :3] @ np.array(sight.own) + pose[:3, 3]
        way = (np.array(sight.spot) - carried) * (1 if is_carried else -1)
        axis = pose[:3, :3] @ np.array(sight.axis) if is_carried else np.array(sight.axis)
        angle, distance = seen_at(robot.chain, sight, q)
        assert np.cos(angle) == pytest.approx(axis @ way / distance, abs=1e-9)
        assert distance == pytest.approx(np.linalg.norm(way))
