"""Splines of poses, from rest to rest and in chains: a text whose frame leaves its curve is refused."""

import re

import numpy as np
import pytest
from programs import compiled

from tests.verify.proof_forging import changed, made, numbers, refused, refused_text, table
from yarclang.pipeline.proofs import proof_of
from yarclang.verify.verdict import ALWAYS_UNCHECKED, verify

ALONE = """DEFAULT {TCP} [MIN] (mm,deg,s) {B}
P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [5]
P0020 MOVEL_SPLINE 100 1150 1276 0 10 0; 50 1174.4 1300 0 0 20; 0 1200 1250 10 0 0 [9]
P0030 MOVEL_SPLINE 60 1174.4 1200 0 0 0; 0 1174.4 1176 0 0 0 [V 40]
P0040 STOP
"""
CHAINED = """DEFAULT {TCP} [3] (mm,deg,s) {B}
P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [5]
P0020 MOVEL 100 1150 1176 0 0 0 [2] BLEND 10
P0030 MOVEL_SPLINE 100 1150 1276 0 10 0; 50 1174.4 1300 0 0 0; 0 1200 1250 10 0 0 [4] BLEND 10
P0040 MOVEJ 0 -5 -45 0 50 0 [3]
P0050 STOP
"""


def left_of(text, proof):
    verdict = verify(text.encode(), proof.encode())
    assert verdict.refused == ""
    return [one for one in verdict.unchecked if one not in ALWAYS_UNCHECKED]


@pytest.mark.parametrize("program", [ALONE, CHAINED])
def test_a_spline_of_poses_is_decided(program):
    assert left_of(*made(program)) == []


@pytest.mark.parametrize("program", [ALONE, CHAINED])
def test_every_number_of_a_spline_of_poses_counts(program):
    text, _ = made(program)
    proof = table(program)
    splines = [k for k, step in enumerate(proof["program"]["steps"]) if step.get("move") == "spline of poses"]
    told = [
        path for path in numbers(proof["motions"]) if path[:2] in {(str(k), "quaternions") for k in splines}
    ]
    told += [path for path in numbers(proof["motions"]) if path[:2] in {(str(k), "turns") for k in splines}]
    assert len(told) > 15
    for path in told[::3]:
        forged = changed(proof, ("motions", *path), lambda one: one + 1e-4)
        assert refused(text, forged), path
    for k in splines:
        for number in range(1, 12, 4):
            step = ("program", "steps", k, "poses", 0, number)
            forged = changed(proof, step, lambda one: one + 0.001)
            assert refused(text, forged), (k, number)


FORGED = {
    "a pose less": lambda step: step["poses"].pop(),
    "poses in another order": lambda step: step["poses"].reverse(),
    "another goal": lambda step: step["pose"].__setitem__(3, step["pose"][3] + 0.0005),
    "another tool": lambda step: step["tool"].__setitem__(3, step["tool"][3] + 0.001),
    "a line": lambda step: (step.__setitem__("move", "line"), step.pop("poses")),
    "a smaller tolerance": lambda step: step.__setitem__("tolerance", [1e-9, 1e-9]),
}


@pytest.mark.parametrize("change", FORGED)
@pytest.mark.parametrize("program", [ALONE, CHAINED])
def test_a_spline_of_poses_of_which_something_else_is_told_is_refused(program, change):
    text, _ = made(program)
    forged = table(program)
    step = next(one for one in forged["program"]["steps"] if one.get("move") == "spline of poses")
    if change == "poses in another order" and step["poses"] == step["poses"][::-1]:
        pytest.skip("one pose has one order")
    FORGED[change](step)
    assert refused(text, forged)


def test_moves_off_the_curve_are_refused():
    text, _ = made(ALONE)
    lines = text.split("\n")
    span = next(
        re.fullmatch(r"; command 1 .* ([0-9]+) ([0-9]+)", one) for one in lines if "; command 1 " in one
    )
    first, last = (int(one) for one in span.groups())
    tried = 0
    for k in range(first + 2, last - 2, 41):
        for axis in "XC":
            moved = re.sub(
                rf"{axis}(-?[0-9.]+)", lambda one, a=axis: f"{a}{float(one[1]) + 0.05:.6f}", lines[k]
            )
            assert refused_text(ALONE, "\n".join([*lines[:k], moved, *lines[k + 1 :]])), (k, axis)
            tried += 1
    assert tried > 6


def test_splines_of_poses_by_chance_are_decided():
    decided = 0
    for seed in range(10):
        random = np.random.default_rng(5200 + seed)
        lines = ["DEFAULT {TCP} [MIN] (mm,deg,s) {B}", "P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [5]"]
        for number in range(int(random.integers(1, 3))):
            here = np.array([0.0, 1174.4, 1200.0])
            poses = [
                " ".join(
                    f"{one:.4f}"
                    for one in (*(here + random.uniform(-90, 90, 3)), *random.uniform(-25, 25, 3))
                )
                for _ in range(int(random.integers(2, 5)))
            ]
            timing = random.choice(["[12]", "[20]", "[V 15]"])
            lines.append(f"P{20 + 10 * number:04d} MOVEL_SPLINE {'; '.join(poses)} {timing}")
        found, _ = compiled("\n".join([*lines, "P0900 STOP"]))
        if found is None:
            continue
        proof = proof_of(found)
        assert proof.value is not None, (seed, proof.diagnostics)
        assert not [one for one in left_of(found.text, proof.value) if "its speed" not in one], seed
        decided += 1
    assert decided > 4
