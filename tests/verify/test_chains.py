"""Lines and arcs that flow into each other: the checker accepts what the judge certifies.

Changed texts and proofs are refused.
"""

import hashlib
import json
import re

import numpy as np
import pytest
from programs import compiled

from tests.verify.proof_forging import changed, made, numbers, refused, refused_text, table
from tests.verify.test_agreement import is_wrong
from yarclang.pipeline.proofs import proof_of
from yarclang.robot.model import Tolerance
from yarclang.verify.verdict import ALWAYS_UNCHECKED, verify

CHAIN = """DEFAULT {TCP} [3] (mm,deg,s) {B}
OUTPUT LAMP M20
P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [5]
P0020 MOVEL 150 1174.4 1176 0 0 0 [V 100] BLEND 20
P0030 SET LAMP ON
P0040 MOVEL 150 1074.4 1176 10 0 5 [V 100] BLEND 15
P0050 MOVEC 80 1044.4 1176; 0 1074.4 1176 0 0 0 [V 80] BLEND 10
P0060 DMOVE 0 80 20 0 0 0 [2]
P0070 STOP
"""
SHARP = """DEFAULT {TCP} [3] (mm,deg,s) {B}
P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [5]
P0020 MOVEL 60 1174.4 1176 0 0 0 [V 50] BLEND 0
P0030 MOVEL 140 1174.4 1176 0 0 0 [V 50] BLEND 0
P0040 MOVEC 175.35533905932738 1159.7553390593274 1176; 190 1124.4 1176 0 0 0 [V 50]
P0050 STOP
"""
JOINED = """DEFAULT {TCP} [3] (mm,deg,s) {B}
P0010 MOVEJ 10 -10 -50 5 60 0 [2] BLEND 5
P0020 MOVEJ 0 -5 -45 0 50 0 [2] BLEND 20
P0030 MOVEL 150 1174.4 1176 0 0 0 [2] BLEND 10
P0040 MOVEL 150 1100 1176 0 5 0 [2] BLEND 15
P0050 MOVEJ 15 -10 -40 0 50 5 [2]
P0060 STOP
"""
"""Joint motions and motions of a frame, with all kinds of corners."""
SPLINED = """DEFAULT {TCP} [3] (mm,deg,s) {B}
P0010 MOVEJ 10 -10 -50 5 60 0 [2] BLEND 5
P0020 MOVEJ_SPLINE 20 0 -45 0 50 0; 20 5 -40 0 40 10 [4] BLEND 3
P0025 MOVEJ 10 0 -40 5 45 0 [2] BLEND 3
P0030 MOVEJ_SPLINE 5 -5 -45 0 45 0; 0 -5 -45 0 50 0 [3] BLEND 10
P0040 MOVEL 150 1174.4 1176 0 0 0 [2] BLEND 10
P0050 MOVEJ_SPLINE 5 -5 -45 0 45 0; 0 -5 -45 0 55 0 [3]
P0060 STOP
"""
"""Splines of joints before and after straight joint motions and a line."""
FRAMES = """DEFAULT {TCP} [3] (mm,deg,s) {B}
FRAME {CAMERA} 0 60 80 90 0 0 (mm,deg) {FLANGE}
P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [5]
P0020 MOVEL 150 1174.4 1176 0 0 0 [2] BLEND 20
P0040 MOVEL {CAMERA} 150 1094.4 1276 100 0 5 [3] BLEND 15
P0050 MOVEL 80 1044.4 1176 0 0 0 [3] BLEND 10
P0060 DMOVE 0 80 20 0 0 0 [2]
P0070 STOP
"""
"""A line of another frame between lines of the same frame."""


def left_of(text, proof):
    verdict = verify(text.encode(), proof.encode())
    assert verdict.refused == ""
    return [one for one in verdict.unchecked if one not in ALWAYS_UNCHECKED]


@pytest.mark.parametrize("program", [CHAIN, SHARP, JOINED, SPLINED, FRAMES])
def test_a_chain_is_decided_whole(program):
    text, proof = made(program)
    assert left_of(text, proof) == []
    verdict = verify(text.encode(), proof.encode())
    assert any("motions that flow into others keep paths" in one for one in verdict.checked)


def moves(text):
    return [k for k, line in enumerate(text.split("\n")) if re.match(r"X-?[0-9].*C-?[0-9]", line)]


@pytest.mark.parametrize("program", [CHAIN, SHARP, JOINED, SPLINED, FRAMES])
def test_every_move_that_leaves_the_path_is_refused(program):
    text, _ = made(program)
    lines = text.split("\n")
    tried = 0
    for k in moves(text)[1::7]:
        for axis, off in (("Y", 0.05), ("Z", -0.05)):
            moved = re.sub(
                rf"{axis}(-?[0-9.]+)", lambda one, a=axis, o=off: f"{a}{float(one[1]) + o:.6f}", lines[k]
            )
            forged = "\n".join([*lines[:k], moved, *lines[k + 1 :]])
            assert refused_text(program, forged), (k, axis)
            tried += 1
    assert tried > 20


TOLD = {
    "another goal": lambda step: step["pose"].__setitem__(3, step["pose"][3] + 0.0005),
    "another turn of the goal": lambda step: step.__setitem__("pose", turned(step["pose"])),
    "another tool": lambda step: step["tool"].__setitem__(3, step["tool"][3] + 0.001),
    "a smaller tolerance": lambda step: step.__setitem__("tolerance", [1e-9, 1e-9]),
    "another duration": lambda step: step.__setitem__("duration", 7.0),
    "another speed": lambda step: step.__setitem__("speed", [40, None]),
    "a lower ceiling": lambda step: step.__setitem__("ceiling", 4),
}


def turned(pose):
    rows = np.array(pose).reshape(3, 4)
    turn = np.array([[np.cos(0.01), -np.sin(0.01), 0], [np.sin(0.01), np.cos(0.01), 0], [0, 0, 1]])
    rows[:, :3] = rows[:, :3] @ turn
    return rows.ravel().tolist()


@pytest.mark.parametrize("change", TOLD)
@pytest.mark.parametrize("program", [CHAIN, SHARP, FRAMES])
def test_a_chain_of_which_something_else_is_told_is_refused(program, change):
    text, _ = made(program)
    steps = [
        at
        for at, step in enumerate(table(program)["program"]["steps"])
        if step.get("move") in ("line", "arc")
    ]
    for at in steps:
        forged = table(program)
        TOLD[change](forged["program"]["steps"][at])
        assert verify(text.encode(), json.dumps(forged).encode()).refused, at


def test_a_ball_has_its_radius():
    text, _ = made(CHAIN)
    for at, step in enumerate(table(CHAIN)["program"]["steps"]):
        if "blend" in step:
            for radius in (0, -1, step["blend"][0] * 0.5):
                assert refused(
                    text, changed(table(CHAIN), ("program", "steps", at, "blend"), lambda _, r=radius: [r, 0])
                )


@pytest.mark.parametrize("program", [CHAIN, SHARP, JOINED, SPLINED, FRAMES])
def test_every_number_of_a_chains_proof_counts(program):
    text, _ = made(program)
    proof = table(program)
    places = [path for path in numbers(proof) if path[0] == "motions"]
    few = [path for path in places if path[2] not in ("s", "rates")]
    many = [path for path in places if path[2] in ("s", "rates")][::23]
    for path in [*few, *many]:
        if path[2] in ("pieces", "corner"):
            continue
        big = {"s": 10**9, "rates": 3 * 10**9, "from": 1 << 21, "until": 1 << 21}.get(path[2], 0.01)
        for sign in (-1, 1):
            assert refused(text, changed(proof, path, lambda one, by=sign * big: one + by)), (path, sign)
    assert len(few) > 10
    assert len(many) > 10


BESIDE = {
    "another goal of joints": lambda steps: steps[1]["through"][0]["q"].__setitem__(2, -45.1),
    "another last goal": lambda steps: steps[4]["through"][0]["q"].__setitem__(0, 15.1),
    "a smaller ball of joints": lambda steps: steps[0].__setitem__("blend", [1000, 0.5]),
    "a ball of frames between joints": lambda steps: steps[0].__setitem__("blend", [1000, 0]),
    "a smaller ball before a line": lambda steps: steps[1].__setitem__("blend", [10, 0]),
    "an angle before a line": lambda steps: steps[1].__setitem__("blend", [0, 90]),
    "a smaller ball after a line": lambda steps: steps[3].__setitem__("blend", [7, 0]),
    "another time": lambda steps: steps[4].__setitem__("duration", 2.1),
    "another tolerance": lambda steps: steps[0].__setitem__("tolerance", [1, 1e-8]),
}


@pytest.mark.parametrize("change", BESIDE)
def test_joints_in_a_chain_of_which_something_else_is_told_are_refused(change):
    text, _ = made(JOINED)
    forged = table(JOINED)
    assert refused(text, forged) == ""
    BESIDE[change](forged["program"]["steps"])
    assert refused(text, forged)


def test_a_spline_in_a_chain_of_which_something_else_is_told_is_refused():
    text, _ = made(SPLINED)
    changes = {
        "another waypoint": lambda steps: steps[1]["through"][0]["q"].__setitem__(2, -45.1),
        "another goal": lambda steps: steps[3]["through"][1]["q"].__setitem__(0, 0.1),
        "a waypoint less": lambda steps: steps[1]["through"].pop(0),
        "a waypoint more": lambda steps: steps[1]["through"].insert(0, {"q": [15, -5, -47, 2, 55, 0]}),
        "a smaller ball of joints": lambda steps: steps[1].__setitem__("blend", [1000, 0.2]),
        "a smaller ball before a line": lambda steps: steps[3].__setitem__("blend", [5, 0]),
        "a smaller ball after a line": lambda steps: steps[4].__setitem__("blend", [5, 0]),
        "a straight way": lambda steps: (
            steps[1].__setitem__("move", "joint"),
            steps[1]["through"].pop(0),
        ),
    }
    for name, change in changes.items():
        forged = table(SPLINED)
        change(forged["program"]["steps"])
        assert refused(text, forged), name


def test_a_frame_that_changes_in_a_chain_keeps_its_speeds():
    program = FRAMES.replace("1276 100 0 5 [3]", "1276 100 0 5 [V 50]")
    text, proof = made(program)
    assert left_of(text, proof) == []
    for name, value in (("speed", [49, None]), ("speed", [51, None]), ("ceiling", 40)):
        forged = table(program)
        at = next(k for k, step in enumerate(forged["program"]["steps"]) if "speed" in step)
        forged["program"]["steps"][at][name] = value
        assert "its speed" in refused(text, forged) or "its ceiling" in refused(text, forged), (name, value)


CEILED = """DEFAULT {TCP} (mm,deg,s) {B}
P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [4]
P0020 MOVEJ_RPY 100 1174.4 1176 0 0 0 [V<=120] BLEND 1
P0030 MOVEJ_RPY 100 1074.4 1176 0 0 0 [V<=150] BLEND 5
P0040 MOVEL 0 1074.4 1176 0 0 0 [V<=90]
P0050 STOP
"""
"""Joint motions and a line with speed ceilings, in one chain."""


def test_ceilings_of_joint_motions_in_a_chain_are_decided():
    text, proof = made(CEILED)
    assert left_of(text, proof) == []
    broken = 0
    for at, step in enumerate(table(CEILED)["program"]["steps"]):
        if "ceiling" in step:
            forged = table(CEILED)
            forged["program"]["steps"][at]["ceiling"] = 25
            broken += "faster than its ceiling" in refused(text, forged)
    assert broken == 3


def test_joints_of_a_corner_are_chosen_by_the_proof_and_are_at_its_pose():
    text, _ = made(JOINED)
    for step in ("2", "4"):
        assert ("start" in table(JOINED)["motions"][step]) == (step == "4")
    for joint in range(6):
        forged = table(JOINED)
        forged["motions"]["4"]["start"][joint] += 0.005
        assert "chosen for the goal" in refused(text, forged)


def test_a_chain_is_followed_from_its_start_to_its_end():
    """A proof that follows only a part of the path is refused."""
    text, _ = made(SHARP)
    proof = table(SHARP)
    steps = sorted((step for step, one in proof["motions"].items() if "from" in one), key=int)
    first, last = steps[0], steps[-1]
    for step, name in ((first, "from"), (last, "until")):
        forged = table(SHARP)
        one = forged["motions"][step]
        pieces = one["pieces"]
        cut = slice(pieces, None) if name == "from" else slice(None, -pieces)
        one["s"], one["rates"] = one["s"][cut], one["rates"][cut]
        one[name] += (1 << 20) * (1 if name == "from" else -1)
        assert refused(text, forged)


def test_the_corner_is_where_the_map_has_it():
    """A proof can't let the text leave its path far from the corner, even inside a large blend zone."""
    text, _ = made(SHARP)
    forged = table(SHARP)
    steps = sorted((step for step, one in forged["motions"].items() if "from" in one), key=int)
    for step in steps[:-1]:
        forged["program"]["steps"][int(step)]["blend"] = [1000, 0]
        one = forged["motions"][step]
        keep = one["pieces"] * 8 + 1
        one["until"] = (one["from"] >> 20 << 20) + (8 << 20)
        one["s"], one["rates"] = one["s"][:keep], one["rates"][:keep]
    assert refused(text, forged)


def drawn_lines(random):
    """Return a random chain of lines with all kinds of corners."""
    lines = ["DEFAULT {TCP} [MIN] (mm,deg,s) {B}", "P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [5]"]
    count, turns = int(random.integers(2, 6)), random.choice([0, 1])
    here, way = np.array([0.0, 1174.4, 1176.0]), random.normal(size=3)
    for number in range(count):
        here = here + way / np.linalg.norm(way) * random.uniform(30, 90)
        goes_on = random.random() < 0.3
        if not goes_on:
            way = way + random.normal(size=3) * random.choice([0.1, 1.0])
        turn = random.uniform(-8, 8, 3) * turns
        timing = random.choice(
            ["", f"[V {random.integers(20, 150)}]", f"[{random.uniform(1, 3):.2f}]", "[V<=90]"]
        )
        blend = "BLEND 0" if goes_on and not turn.any() else f"BLEND {random.choice([1, 5, 12])}"
        goal = " ".join(f"{one:.6f}" for one in (*here, *turn))
        lines.append(f"P{(number + 2) * 10:04d} MOVEL {goal} {timing} {blend if number < count - 1 else ''}")
    return "\n".join([*lines, "P0900 STOP"])


def drawn_with_joints(random):
    """Return a random chain of lines and of joint motions, to poses and to joint positions.

    It has all kinds of corners.
    """
    lines = ["DEFAULT {TCP} [MIN] (mm,deg,s) {B}", "P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [5]"]
    count, here = int(random.integers(3, 6)), np.array([0.0, 1174.4, 1176.0])
    for number in range(count):
        here = np.array([0.0, 1174.4, 1176.0]) + random.uniform(-120, 120, 3)
        name = random.choice(["MOVEL", "MOVEJ", "MOVEJ_RPY"])
        goal = np.array([*here, *random.uniform(-8, 8, 3)])
        if name == "MOVEJ":
            goal = np.array([0, -6.2, -46.5, 0, 52.7, 0]) + random.uniform(-6, 6, 6)
        blend = random.choice(["BLEND 0.5", "BLEND 1", "BLEND 2"])
        timing = random.choice(["", "[1.5]"])
        said = " ".join(f"{one:.6f}" for one in goal)
        lines.append(f"P{(number + 2) * 10:04d} {name} {said} {timing} {blend if number < count - 1 else ''}")
    return "\n".join([*lines, "P0900 STOP"])


@pytest.mark.parametrize("drawn", [drawn_lines, drawn_with_joints])
def test_chains_by_chance_are_decided_and_judged_as_the_judge_does(drawn):
    decided, balls, refusals, kept = 0, 0, 0, 0
    for seed in range(16):
        random = np.random.default_rng(3400 + seed)
        found, _ = compiled(drawn(random))
        if found is None:
            continue
        proof = proof_of(found)
        assert proof.value is not None, (seed, proof.diagnostics)
        assert not [one for one in left_of(found.text, proof.value) if "its speed" not in one], seed
        decided += 1
        balls += '"corner"' in proof.value
        lines, places = found.text.split("\n"), moves(found.text)
        wider = Tolerance(
            *(1.1 * one for one in (found.certificate.tolerance.position, found.certificate.tolerance.angle))
        )
        for _ in range(3):
            k, axis = int(random.choice(places)), str(random.choice(list("XYZABC")))
            by = float(random.choice([-1, 1])) * 10.0 ** random.uniform(-4.0, -1.0)
            moved = re.sub(
                rf"{axis}(-?[0-9.]+)", lambda one, a=axis, o=by: f"{a}{float(one[1]) + o:.6f}", lines[k]
            )
            text = "\n".join([*lines[:k], moved, *lines[k + 1 :]])
            nothing = {"cell": {"bodies": [], "exceptions": [], "zones": []}, "planes": []}
            forged = json.loads(proof.value) | nothing | {"text": hashlib.sha256(text.encode()).hexdigest()}
            told = verify(text.encode(), json.dumps(forged).encode()).refused
            wrong = is_wrong(found, text, found.certificate.tolerance)
            assert told or not wrong or not is_wrong(found, text, wider), (seed, moved)
            refusals, kept = refusals + wrong, kept + (not wrong and not told)
    assert decided > 10
    assert balls > 8
    assert refusals > 10
    assert kept > 5
