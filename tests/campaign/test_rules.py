"""Tests of random programs with KEEP and _AVOID: most compile, the independent judge finds no fault in them,
and finds faults that a test puts in.
"""

import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from floors import Tally
from programs import compiled

from tests.motion.avoid.cells import box, loading
from yarclang.campaign.drawing import features
from yarclang.campaign.judging import arm_of, told_by_step
from yarclang.campaign.rules import drawn_ruled
from yarclang.independent.found_ways import unfolded
from yarclang.independent.judging import judge
from yarclang.robot.description import load_robot

ROBOT = load_robot("INDUSTRIAL6").value
ARM = arm_of(ROBOT)
BLOCK = box("BLOCK", [0.0, 1.2, 1.44], [0.05, 0.05, 0.05], 0.003)
REFUSALS = {
    "Y0501",
    "Y0502",
    "Y0503",
    "Y0504",
    "Y0901",
    "Y0903",
    "Y0921",
    "Y0922",
    "Y0923",
    "Y0925",
    "Y0955",
    "Y0956",
}


def made(seed, *obstacles):
    program = drawn_ruled(ARM, np.random.default_rng(seed))
    load = {"load_cell": loading(*obstacles)} if obstacles else {}
    text = f'CELL "cell.toml"\n{program.text}' if obstacles else program.text
    return program, *compiled(text, ROBOT, **load)


def judged(program, value, found):
    chosen = {motion.step: motion.waypoints for motion in value.plan.motions}
    return judge(ARM, program.said, value.text, chosen, told_by_step(found))


@pytest.mark.parametrize("obstacles", [(), (BLOCK,)], ids=["free", "block"])
def test_rules_and_ways_round_hold_by_another_reading(obstacles):
    tally = Tally()
    for seed in range(14):
        program, value, found = made(seed, *obstacles)
        errors = {one.code for one in found if one.is_error}
        assert errors <= REFUSALS, found
        for _, names in features(program):
            for name in {"_AVOID", "KEEP", "line", "joints of a pose"} & set(names):
                tally.count(name, value is not None)
        if value is None:
            continue
        tally.count("legs", len(value.plan.motions) > len(program.said))
        judgement = judged(program, value, found)
        assert not judgement.faults, (seed, judgement.faults)
    floors = dict.fromkeys(("_AVOID", "KEEP", "line", "joints of a pose"), 0.25)
    assert not tally.below(floors | ({"legs": 0.05} if obstacles else {}))


def test_a_rule_that_is_broken_is_found():
    program, value, found = next(
        one
        for one in map(made, range(30))
        if one[1] is not None and any(said.rules for said in one[0].said.values())
    )
    kept = {one.kind for said in program.said.values() for one in said.rules}
    for kind, limit in (("upright", 0.01), ("above", 5e3)):
        if kind not in kept:
            continue
        for step, said in program.said.items():
            rules = tuple(replace(one, limit=limit) if one.kind == kind else one for one in said.rules)
            program.said[step] = replace(said, rules=rules)
        assert any(f"breaks {kind}" in one for one in judged(program, value, found).faults)


def test_legs_that_lead_elsewhere_are_found():
    for seed in range(40):
        program, value, found = made(seed, BLOCK)
        if value is not None and len(value.plan.motions) > len(program.said):
            break
    assert not judged(program, value, found).faults
    chosen = {motion.step: motion.waypoints for motion in value.plan.motions}
    said, _ = unfolded(ARM, program.said, value.text, chosen)
    assert len(said) == len(value.plan.motions)
    # change the written goal, which the last leg of a detour must reach
    steps = re.findall(r"^; command (\d+) (\S+) MOVEL_AVOID ", value.text, re.MULTILINE)
    first, index = next(one for one, other in pairwise(steps) if one[1] == other[1])
    number = sorted(program.said)[int(index[1:]) // 10 - 1]
    point, turn = program.said[number].goals[0]
    program.said[number].goals[0] = np.add(point, (0.0, 0.0, 0.1)), turn
    assert judged(program, value, found).faults
    program.said[number].goals[0] = point, turn
    # claim waypoints that the legs don't reach
    step = int(first)
    moved = {**chosen, step: chosen[step] + 1e-3}
    faults = judge(ARM, program.said, value.text, moved, told_by_step(found)).faults
    assert any("off the path" in one or "not at its place" in one for one in faults)
