"""Conditions of the small checker hold at every sampled instant, and changed rules are refused.

The samples come from the compiler's kinematics, which share no code with the checker.
"""

import hashlib
import json
import re

import numpy as np
import pytest

import yarclang
from tests.verify.proof_forging import made, table
from tests.verify.test_apart import Case
from yarclang.cell.keeping import Height, Keep, Sight, Tilt
from yarclang.certify.kinematics.arm import flange_poses
from yarclang.certify.pmac.proof.room import exactly
from yarclang.emitted.quoting import quoted
from yarclang.pipeline.proofs import proof_of
from yarclang.verify.apart import PARTS, Timeline
from yarclang.verify.conditions import Window, rules_of
from yarclang.verify.exact import RefusedError
from yarclang.verify.verdict import ALWAYS_UNCHECKED, verify

CASES = 40
KINDS = ("UPRIGHT", "ABOVE", "FACING", "SEEN")
SLACK = 1.1e-5
"""Largest amount by which samples may exceed a rule [rad or m]."""


def unit(vector):
    return tuple((vector / np.sqrt(vector @ vector)).tolist())


def amounts(kind, poses, own, other, axis):
    """Return for each pose the angle [rad] or height [m] of a rule, and the distance from the apex."""
    turn, shift = poses[:, :3, :3], poses[:, :3, 3]
    if kind == "UPRIGHT":
        return np.arccos(np.clip(turn @ own @ other, -1, 1)), np.ones(len(poses))
    point = turn @ own + shift
    if kind == "ABOVE":
        return point @ other, np.ones(len(poses))
    way = other - point if kind == "FACING" else point - other
    axes = turn @ axis if kind == "FACING" else np.broadcast_to(axis, way.shape)
    size = np.sqrt((way**2).sum(axis=1))
    return np.arccos(np.clip((axes * way).sum(axis=1) / size, -1, 1)), size


def rule_line(kind, own, other, axis, limit, near, far):
    own, other, axis = (tuple(one.tolist()) for one in (own, other, axis))
    region = {
        "UPRIGHT": lambda: Tilt(own, other, limit),
        "ABOVE": lambda: Height(own, other, 0.0, limit),
        "FACING": lambda: Sight(own, other, axis, True, limit, near, far),
        "SEEN": lambda: Sight(own, other, axis, False, limit, near, far),
    }[kind]()
    return f"; keep 0 {quoted(Keep(kind, 'CUP', 'B', region).told)}"


@pytest.mark.parametrize("kind", KINDS)
def test_a_rule_that_holds_on_a_curve_holds_at_each_sample(kind):
    held = broken = sharp = 0
    for seed in range(CASES):
        case = Case(seed)
        random, timeline = case.random, Timeline(case.rows, case.arm)
        for _ in range(6):
            begin = int(random.integers(timeline.count * PARTS - 1))
            end = min(begin + int(random.choice([1, 8, PARTS, 3 * PARTS])), timeline.count * PARTS)
            try:
                stretch = timeline.stretch(begin, end, True)
            except RefusedError:  # a curve across a rest
                continue
            poses = flange_poses(case.robot.chain, case.joints(begin, end, 60))
            own = np.array(unit(random.normal(size=3))) if kind == "UPRIGHT" else random.uniform(-0.3, 0.3, 3)
            is_axis = kind in ("UPRIGHT", "ABOVE")
            other = np.array(unit(random.normal(size=3))) if is_axis else random.uniform(-2, 2, 3)
            axis = np.array(unit(random.normal(size=3)))
            angle, size = amounts(kind, poses, own, other, axis)
            worst = angle.min() if kind == "ABOVE" else angle.max()
            # the limit is beyond the samples, or short of them, often by very little
            limit = worst + float(random.choice([-1, 1])) * 10.0 ** random.uniform(-4.5, -0.5)
            near, far = size.min() * random.uniform(0.9, 1.02), size.max() * random.uniform(0.98, 1.1)
            if kind != "ABOVE" and not 0.002 < limit < 3.0:
                continue
            (rule,) = rules_of(
                [rule_line(kind, own, other, axis, limit, near, far)], case.arm, timeline.travel
            )
            is_kept = angle.min() >= limit - SLACK if kind == "ABOVE" else angle.max() <= limit + SLACK
            if kind in ("FACING", "SEEN"):
                is_kept &= size.min() >= near - SLACK and size.max() <= far + SLACK
            holds = rule.holds(stretch, None)
            assert is_kept or not holds, (seed, kind, begin, end)
            held, broken = held + holds, broken + (not is_kept)
            sharp += holds and abs(limit - worst) < 0.01
    assert held >= 25
    assert broken >= 25
    assert sharp >= 5


def test_ranges_of_joints_hold_at_each_sample():
    inside = outside = 0
    for seed in range(CASES):
        case = Case(seed)
        random, timeline = case.random, Timeline(case.rows, case.arm)
        begin = int(random.integers(timeline.count * PARTS - 1))
        end = min(begin + int(random.integers(1, PARTS)), timeline.count * PARTS)
        try:
            stretch = timeline.stretch(begin, end, True)
        except RefusedError:  # a curve across a rest
            continue
        q = case.joints(begin, end, 60) / case.robot.axis_units
        for _ in range(6):
            room = random.uniform(5, 50, (2, case.robot.size))
            room[int(random.integers(2)), int(random.integers(case.robot.size))] = random.choice(
                [1, -1]
            ) * 10.0 ** random.uniform(-4, 0.5)
            low, high = q.min(axis=0) - room[0], q.max(axis=0) + room[1]
            low[random.random(case.robot.size) < 0.2] = -np.inf
            ends = [(None if np.isinf(a) else a, b) for a, b in zip(low.tolist(), high.tolist(), strict=True)]
            is_in = (q >= low - 1e-4).all() and (q <= high + 1e-4).all()
            is_out = ((q <= low + 1e-4) | (q >= high - 1e-4)).all(axis=0).any()
            stays_in = Window(exactly(ends), case.arm.turns).holds(stretch, None)
            stays_out = Window(exactly(ends), case.arm.turns, outside=True).holds(stretch, None)
            assert is_in or not stays_in, seed
            assert is_out or not stays_out, seed
            inside, outside = inside + stays_in, outside + stays_out
    assert inside >= 30
    assert outside >= 10


KEPT = """FRAME {CUP} 0 0 50 0 0 0 (mm,deg) {TCP}
FRAME {PART} 0 1500 900 0 0 0 (mm,deg) {B}
DEFAULT {TCP} (mm,deg,s) {B}
P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [4]
KEEP {CUP} UPRIGHT 60 (deg)
KEEP {CUP} ABOVE 500 (mm)
KEEP {TCP} SEEN 175 10 3000 (deg,mm) {PART}
P0020 MOVEL 100 1174.4 1176 0 5 0 [4]
P0030 MOVEL 100 1074.4 1100 0 0 10 [4] BLEND 10
P0040 MOVEL 0 1074.4 1176 0 0 0 [4]
END
END
END
P0050 MOVEJ 0 0 0 0 0 0 [4]
P0060 STOP
"""


def judged(text, proof):
    return verify(text.encode(), json.dumps(proof).encode())


def keep_lines(text):
    return [line for line in text.split("\n") if line.startswith("; keep ")]


def changed_rule(text, proof, old, new):
    """Return the verdict about a text whose rules are changed, with the same changes in the proof."""
    forged, told = text.replace(old, new), json.loads(json.dumps(proof).replace(old, new))
    assert forged != text
    told["text"] = hashlib.sha256(forged.encode()).hexdigest()
    return judged(forged, told)


def test_path_constraints_are_decided_and_nothing_is_left():
    text, proof = made(KEPT)
    assert len(keep_lines(text)) == 9
    verdict = judged(text, json.loads(proof))
    assert verdict.refused == ""
    assert [one for one in verdict.unchecked if one not in ALWAYS_UNCHECKED] == []


def test_a_rule_with_other_words_than_numbers_is_refused():
    text, _ = made(KEPT)
    proof = table(KEPT, bodies=True)
    for old, new in (
        ("UPRIGHT%2060%20", "UPRIGHT%2061%20"),
        ("ABOVE%20500%20", "ABOVE%20490%20"),
        ("%203000%20", "%203001%20"),
    ):
        assert "the words and the numbers" in changed_rule(text, proof, old, new).refused, old
    for line in keep_lines(text)[:3]:
        word = line.split(" ")[3]
        for forged in (
            word[:-3],
            word + "%209",
            word.replace("%20", "%20x", 1),
            word[4:],
            "%7B",
            word + "e99",
        ):
            assert changed_rule(text, proof, word, forged).refused, forged


def test_a_tighter_rule_is_refused_and_a_rule_without_its_proof_is_named():
    text, _ = made(KEPT)
    for old, new in ((r"UPRIGHT%2060%20(.*?)%201.0471975512", r"UPRIGHT%201%20\1%200.0174532925199"),):
        for word in {line.split(" ")[3] for line in keep_lines(text) if "UPRIGHT" in line}:
            tight = re.sub(old, new, word)
            assert tight != word
            assert (
                "isn't shown to comply with {CUP} UPRIGHT 1"
                in changed_rule(text, table(KEPT, bodies=True), word, tight).refused
            )
    bare = table(KEPT, bodies=True)
    pairs = {number for stretch in bare["planes"] if stretch[2] == 2 for number, *_ in stretch[3:]}
    assert len(pairs) == 3
    bare["planes"] = [one for one in bare["planes"] if one[2] != 2]
    named = [one for one in judged(text, bare).unchecked if "{CUP}" in one or "{TCP}" in one]
    assert [re.search("UPRIGHT|ABOVE|SEEN", one)[0] for one in named] == ["UPRIGHT", "ABOVE", "SEEN"]


def test_a_condition_on_a_stretch_across_a_rest_is_refused():
    text, _ = made(KEPT)
    proof = table(KEPT, bodies=True)
    kept = [one for one in proof["planes"] if one[2] == 2]
    proof["planes"] = [one for one in proof["planes"] if one[2] != 2]
    proof["planes"].append([kept[0][0], max(one[1] for one in kept), 2, *kept[0][3:]])
    assert (
        "isn't within one sequence" in judged(text, proof).refused
        or "comply with" in judged(text, proof).refused
    )


ZONES = """units = "mm,deg,s"
[[zones]]
name = "TURN"
rule = "allowed"
shape = "joints"
joints = { J1 = [-15, 25], J3 = [-60, 60] }
[[zones]]
name = "FLIP"
rule = "forbidden"
shape = "joints"
joints = { J1 = [-100, 100], J5 = [-80, -30] }
[[zones]]
name = "GENTLE"
rule = "slow"
shape = "joints"
joints = { J1 = [5, 30] }
speed = 400
watch = ["tcp"]
[[zones]]
name = "PRESS"
rule = "posture"
shape = "box"
frame = "B"
xyz = [250, 1100, 1850]
size = [300, 600, 600]
joints = { J1 = [-180, -2] }
watch = ["tcp"]
[[zones]]
name = "ROUND"
rule = "allowed"
shape = "sphere"
frame = "B"
xyz = [0, 1100, 1850]
radius = 700
watch = ["tcp"]
[[zones]]
name = "DRUM"
rule = "allowed"
shape = "cylinder"
frame = "B"
xyz = [0, 1100, 1850]
radius = 600
length = 1200
watch = ["tcp", "link_6"]
margin = 5
[[zones]]
name = "PILL"
rule = "allowed"
shape = "capsule"
frame = "B"
xyz = [0, 1100, 1850]
radius = 600
length = 400
watch = ["tool"]
"""
IN_ZONES = """ROBOT INDUSTRIAL6
CELL "cell.toml"
DEFAULT {TCP} [50%] (mm,deg,s) {B}
P0010 MOVEJ 20 0 0 0 20 0
P0020 MOVEJ -10 5 -10 10 20 0
P0030 MOVEJ 0 0 0 0 0 0 [4]
"""
WRONG = {
    "TURN": lambda zone: zone.__setitem__("window", [[-15, 9], *zone["window"][1:]]),
    "FLIP": lambda zone: zone.__setitem__("window", [[-100, 100]] * 6),
    "GENTLE": lambda zone: zone.__setitem__("speed", 0.05),
    "PRESS": lambda zone: zone.__setitem__("posture", [[-180, -60], *zone["posture"][1:]]),
    "ROUND": lambda zone: zone["region"].__setitem__("radius", 0.3),
    "DRUM": lambda zone: zone["region"].__setitem__("disc", 0.3),
    "PILL": lambda zone: zone["region"].__setitem__("radius", 0.2),
}
"""Zones of each kind that the robot doesn't keep to."""


@pytest.fixture(scope="module")
def in_zones(tmp_path_factory):
    folder = tmp_path_factory.mktemp("zones")
    (folder / "cell.toml").write_text(ZONES)
    found = yarclang.compile(IN_ZONES, folder=folder)
    assert found.value is not None, [one.message for one in found.diagnostics]
    return found.value.text, proof_of(found.value).value


def test_zones_of_all_kinds_are_decided(in_zones):
    text, proof = in_zones
    verdict = judged(text, json.loads(proof))
    assert verdict.refused == ""
    assert [one for one in verdict.unchecked if one not in ALWAYS_UNCHECKED] == []


@pytest.mark.parametrize("name", WRONG)
def test_another_zone_of_each_kind_is_refused(in_zones, name):
    text, proof = in_zones
    told = json.loads(proof)
    WRONG[name](next(zone for zone in told["cell"]["zones"] if zone["name"] == name))
    refused = judged(text, told).refused
    assert name in refused, refused


@pytest.mark.parametrize("name", WRONG)
def test_what_is_unknown_of_a_zone_leaves_it_unchecked_or_is_refused(in_zones, name):
    text, proof = in_zones
    for number, change in enumerate(
        (
            lambda zone: zone.__setitem__("tilt", 1),
            lambda zone: zone.__setitem__("rule", "avoided"),
            lambda zone: zone.pop("window", None) or zone.__setitem__("region", None),
            lambda zone: zone.__setitem__("posture", None),
            lambda zone: zone.__setitem__("window", [[1]] * 6),
            lambda zone: zone.__setitem__("window", [[1, 2]] * 5),
            lambda zone: zone.__setitem__("watched", [-1]),
            lambda zone: zone.__setitem__("watched", [10**6]),
        )
    ):
        told = json.loads(proof)
        change(next(zone for zone in told["cell"]["zones"] if zone["name"] == name))
        verdict = judged(text, told)
        assert verdict.refused or any(name in one for one in verdict.unchecked), number
