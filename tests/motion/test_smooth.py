"""Tests of joint paths as polynomials: they are as exact as the inverse kinematics, and no polynomial is
returned if this is impossible.
"""

import numpy as np
import pytest
from programs import planned

from yarclang.motion.cartesian import joints_of
from yarclang.motion.smooth import smooth
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.kinematics.inverse import extent

HEAD = "DEFAULT {TCP} [4] (mm,deg,s) {B}\nP0001 MOVEJ_RPY 0 1174.4 1176 0 0 0 [MIN]\n"
WAYS = {
    "line": "P0010 MOVEL 60 1134.4 1206 4 -3 2\n",
    "long line": "P0010 MOVEL 400 1000 1000 20 0 30 [8]\n",
    "arc": "P0010 MOVEC 60 1134.4 1176; 120 1174.4 1176 0 0 10\n",
    "pure turn": "P0010 MOVEL 0 1174.4 1176 0 20 15\n",
}
PLACES = np.linspace(0, 1, 997)


def path_of(line, robot="INDUSTRIAL6"):
    plan, _ = planned(HEAD + line, robot)
    return plan.motions[1].path


@pytest.mark.parametrize("name", WAYS)
def test_they_are_the_solutions(name):
    path = path_of(WAYS[name])
    (found,) = smooth([path])
    assert found.at(PLACES) == pytest.approx(joints_of([path], [PLACES])[0], abs=1e-11)
    poses = tool_poses(path.chain, found.at(PLACES), path.flange_from_moving)
    assert poses == pytest.approx(path.frame.poses(PLACES), abs=2e-12)


@pytest.mark.parametrize("name", WAYS)
def test_a_deviation_is_bounded(name):
    path = path_of(WAYS[name])
    (found,) = smooth([path])
    random = np.random.default_rng(1)
    for size in (1e-9, 1e-7, 1e-5):
        q = joints_of([path], [PLACES])[0] + random.normal(0.0, size, (len(PLACES), 6))
        bound, is_ = found.deviation(q, PLACES), path.deviation(q, PLACES)
        assert (np.array(bound) >= np.array(is_)).all()
        assert bound[0] <= 30 * extent(path.chain) * size
    assert max(found.deviation(joints_of([path], [PLACES])[0], PLACES)) < 1e-10


def test_a_path_close_to_a_singularity_has_none_or_an_exact_one():
    # The wrist is straight at joint 5 = 0. The path passes this position more and more closely.
    for away in (3.0, 0.3, 0.03, 0.003):
        plan, _ = planned(
            "DEFAULT {TCP} [60] (mm,deg,s) {B}\n"
            "P0001 MOVEJ 0 0 0 0 -8 0 [5]\n"
            "P0010 DMOVE 0 0 0 0 16 0 [60]\n"
            f"P0020 DMOVE 0 {away} 0 {away} 0 0 [60]\n"
        )
        if plan is None:
            continue
        for motion in plan.motions[1:]:
            (found,) = smooth([motion.path])
            if found is not None:
                poses = tool_poses(motion.path.chain, found.at(PLACES), motion.path.flange_from_moving)
                assert poses == pytest.approx(motion.path.frame.poses(PLACES), abs=1e-10)


def test_a_spline_of_poses_has_none():
    assert smooth([path_of("P0010 MOVEL_SPLINE 60 1134.4 1176 0 0 0; 120 1174.4 1176 0 0 10\n")]) == [None]


def test_many_are_found_as_each_by_itself():
    paths = [path_of(WAYS[name]) for name in ("line", "arc", "long line")]
    together, alone = smooth(paths), [smooth([path])[0] for path in paths]
    for one, other in zip(together, alone, strict=True):
        assert one.coefficients == pytest.approx(other.coefficients, abs=1e-14)
