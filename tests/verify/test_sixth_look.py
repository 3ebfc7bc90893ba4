"""Forgeries that a sixth look has found, at paths that begin at programmed goals: all are refused."""

import json
from dataclasses import replace

import numpy as np
import pytest
from programs import checked, compiled

from tests.certify.forging import Forger
from tests.verify.proof_forging import made, table
from tests.verify.test_fourth_look import ROBOT, judged_as
from tests.verify.test_third_look import verdict
from yarclang.certify.certifying import certify
from yarclang.pipeline.stages import claims_of

HEAD = "OUTPUT LAMP M20 OFF\nDEFAULT {TCP} (mm,deg,s) {B}\n"
TABLE = "P0010 MOVEJ_TIMED {} 0 0 0 0 0 [5] TOL 5\n"


@pytest.mark.parametrize(
    ("after", "other"),
    [
        ("P0020 MOVEJ 20 0 0 0 0 0 [5]\n", None),
        ("P0020 MOVEJ 14.1 0 0 0 0 0 [5]\n", None),
        (
            "P0015 SET LAMP ON\nP0020 DMOVEJ 10 0 0 0 0 0 [5]\n",
            "P0015 SET LAMP ON\nP0020 DMOVEJ 6 0 0 0 0 0 [5]\n",
        ),
    ],
)
def test_a_joint_motion_covers_its_path_from_the_start(after, other):
    """The motion before may end 4 deg off, by its own TOL. The next one would leave out 4 deg of its path."""
    program = HEAD + TABLE.format(10) + after
    text, found = judged_as(program, HEAD + TABLE.format(14) + (other or after))
    assert "Y1159" in {one.code for one in found}
    assert any("P0020" in one.message for one in found)
    assert "P0020" in verdict(text, table(program)).refused


TURN = HEAD + "P0010 MOVEJ_RPY 200 1000 900 0 0 0 [5]\nBETWEENP0020 MOVEL 200 1000 900 0 170 0 [30]\n"


@pytest.mark.parametrize(
    ("between", "forge"),
    [
        ("P0015 SET LAMP ON\n", lambda step, line: step.update({**line, "title": step["title"]})),
        (
            "P0015 DMOVE 0 0 0 0 0 0 [1]\n",
            lambda step, _: [step.pop(name) for name in [*step] if name != "title"],
        ),
    ],
    ids=["a SET as a motion", "a motion as none"],
)
def test_what_is_no_motion_is_told_as_none(between, forge):
    """The next path begins at the goal of a motion. Its kind is in its name, which the map states."""
    program = TURN.replace("BETWEEN", between)
    text, _ = made(program)
    proof = table(program)
    assert not verdict(text, proof).refused
    steps = proof["program"]["steps"]
    forge(steps[1], json.loads(json.dumps(steps[2])))
    assert "P0015" in (refused := verdict(text, proof).refused)
    assert "none as a motion" in refused


def test_joints_that_the_planner_claims_for_a_pose_at_rest_are_at_it():
    """The next relative motions begin there."""
    program = (
        "DEFAULT {TCP} (mm,deg,s) {B}\nP0010 MOVEJ_RPY 200 1000 900 0 20 0 [5] TOL 20\n"
        "P0020 DMOVEJ 1 0 0 0 0 0 [3] (deg,s)\nP0030 DMOVEJ 1 0 0 0 0 0 [3] (deg,s)\n"
    )
    honest, _ = compiled(program)
    source, _ = checked(program)
    claims = claims_of(honest.plan)
    assert certify(honest.text, source, ROBOT, ROBOT.tolerance, claims).value is not None
    wrong = claims.witnesses[0] + np.deg2rad([0.03, 0, 0, 0, 0, 0])
    forged = replace(claims, witnesses={**claims.witnesses, 0: wrong})
    judged = certify(Forger.of(honest.text).text, source, ROBOT, ROBOT.tolerance, forged)
    assert "Y1161" in {one.code for one in judged.diagnostics}


def test_joints_for_a_pose_at_rest_are_in_the_proof():
    """The path of a joint motion begins there, and not at the numbers of the text."""
    program = HEAD + "P0010 MOVEL 200 1000 900 0 20 0 [8] TOL 20\nP0020 MOVEJ 20 0 0 0 0 0 [5]\n"
    program = program.replace("P0010", "P0005 MOVEJ_RPY 150 1000 900 0 20 0 [5]\nP0010", 1)
    text, _ = made(program)
    proof = table(program)
    start = proof["motions"]["2"]["start"]
    assert not verdict(text, proof).refused
    proof = table(program)
    proof["motions"]["2"]["start"] = [start[0] + 0.01, *start[1:]]
    assert "chosen for the goal before" in verdict(text, proof).refused
    proof = table(program)
    proof["motions"]["2"]["start"] = [*start[:3], start[3] + 180, -start[4], start[5] - 180]
    assert "another posture" in verdict(text, proof).refused
    moved, found = judged_as(program, program.replace("200 1000 900", "200 1008 900"))
    assert any("P0020" in one.message for one in found)
    assert "P0020" in verdict(moved, table(program)).refused
