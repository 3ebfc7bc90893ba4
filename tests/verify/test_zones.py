"""Zones in the small checker: it proves what the judge certifies, or lists it as unchecked.

Zones that the proof states otherwise are broken.
"""

import copy
import json

import numpy as np
from programs import compiled, robot_of

from tests.collision.zones.test_zone_programs import cell
from yarclang.campaign.drawing import drawn
from yarclang.diagnostics import Result
from yarclang.independent.arm import Arm
from yarclang.pipeline.proofs import proof_of
from yarclang.verify.verdict import verify

COUNT = 14


def refused(text, proof):
    return verify(text.encode(), json.dumps(proof).encode()).refused


def named(text, proof):
    return " ".join(verify(text.encode(), json.dumps(proof).encode()).unchecked)


def test_zones_by_chance():
    proved = slow = broken = tried = 0
    kinds = set()
    for seed in range(COUNT):
        random = np.random.default_rng(seed + 34_000)
        name = ("INDUSTRIAL6", "TRACKED_MANIPULATOR")[seed % 2]
        robot, around = robot_of(name), cell(random)
        program = drawn(Arm.in_folder(robot.folder), random, most=2)
        found, _ = compiled(
            'CELL "cell.toml"\n' + program.text, name, load_cell=lambda *_, made=around: Result(made, ())
        )
        if found is None:
            continue
        written = proof_of(found)
        assert written.value is not None, (seed, written.diagnostics)
        proof = json.loads(written.value)
        said = named(found.text, proof)
        zones = {zone["name"]: zone for zone in proof["cell"]["zones"]}
        for zone in zones.values():
            assert f" {zone['name']}" not in said, (seed, zone)
            kinds.add((zone["rule"], "window" in zone))
            proved += 1
            slow += zone["rule"] == "slow"
            moved = copy.deepcopy(proof)
            told = moved["cell"]["zones"][list(zones).index(zone["name"])]
            if not zone["watched"]:
                continue
            tried += 1
            if "window" in zone or zone["rule"] == "posture":
                # a range that contains no joint position of the program
                told["window" if "window" in zone else "posture"] = [[7, 8]] * robot.size
                told["margin"] = 50
            elif zone["rule"] == "allowed":
                # a margin so large that nothing can be inside
                told["margin"] = 50
            else:
                # a region that contains everything, in which nothing may move
                told["region"] = {"pose": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -50]}
                told["speed"] = 1e-4
            broken += bool(refused(found.text, moved)) or f" {zone['name']}" in named(found.text, moved)
    assert proved >= 10
    assert slow >= 3
    assert broken == tried >= 8
    print(kinds)
