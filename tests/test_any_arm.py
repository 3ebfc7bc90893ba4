"""Tests with any serial arm: its robot.toml comes from its URDF by `yarc robot new` alone, and its programs
are planned and certified.
"""

import re
import shutil

import numpy as np
import pytest
from conftest import EXAMPLES
from floors import exercises
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from programs import compiled

from tests.robot.made_arms import DATA, REAL, calibrated, made, program, urdf_of, yarc
from yarclang.collision.homes import first_free
from yarclang.pipeline.inputs import Options, open_program
from yarclang.pipeline.stages import compile_module
from yarclang.robot.checklist import check_robot
from yarclang.robot.checklist.geometry import pinocchio_poses
from yarclang.robot.description import stdlib_folder
from yarclang.robot.kinematics import flange_poses, reaching
from yarclang.robot.kinematics.geometry import wristed_arm
from yarclang.robot.kinematics.search import within

INDUSTRIAL6 = stdlib_folder() / "robots" / "industrial6"


def in_joints(spec, values):
    """Return the values of motions in joint space, as arms with fewer than six joints can't follow arbitrary
    lines.
    """
    return values.of_joints


def errors(diagnostics):
    return [
        f"{one.code} line {one.span and one.span.line}: {one.message}" for one in diagnostics if one.is_error
    ]


HIT_THEMSELVES = {"talos-9", "baxter-left", "baxter-right", "tiago-8"}
"""Arms whose guessed HOME is free, but that hit a leg, a torso or a column close to it."""


OVERLOADED = {"talos-9", "baxter-left", "baxter-right"}
"""Arms that need slightly more than their motors' efforts at the guessed accelerations or when stretched out.
"""


@pytest.mark.parametrize("name", REAL)
def test_a_real_arm_compiles_all_motions(name, tmp_path):
    file, arguments, size = REAL[name]
    robot = made(DATA / file, tmp_path / "arm", *arguments)
    assert robot.size == size
    text = program(robot) if size >= 6 else program(robot, pick=in_joints)
    result, diagnostics = compiled(text, str(tmp_path / "arm"))
    hits = (
        ("Y0902", "Y0925") if name in HIT_THEMSELVES else ()
    )  # collisions on a path, or in all configurations of a target
    home = first_free(robot, robot.home[None])
    assert home == (0, ()), home  # pairs that touch in HOME would not be checked at all
    left = [one for one in errors(diagnostics) if not one.startswith(hits)]
    left = [one for one in left if name not in OVERLOADED or not one.startswith("Y18")]
    assert left == []
    assert (result is None) == (name in HIT_THEMSELVES)
    # apart from guesses, the new robot needs no more work
    left = [item for item in check_robot(str(tmp_path / "arm")).items if item.verdict == "to do"]
    assert {item.subject for item in left} <= {"guess"}, left


def test_every_command_with_every_target_is_in_the_program(industrial6):
    """A new command must be added to the program, so that all arms are tested with it."""
    text = program(industrial6)
    for word in (
        "MOVEJ",
        "MOVEJ_RPY",
        "MOVEJ_QUAT",
        "MOVEL",
        "MOVEL_QUAT",
        "MOVEJ_SPLINE",
        "MOVEJ_TIMED",
        "DMOVEJ",
        "DMOVE",
    ):
        assert re.search(rf"^P\d+ {word} ", text, re.MULTILINE), word


OF_INDUSTRIAL6 = sorted(
    path.name
    for path in EXAMPLES.glob("*.yarc")
    if not re.search(r'ROBOT (TRACKED_MANIPULATOR|")', path.read_text())
)


THROUGH_THE_WRIST = {"07_inspection_tour.yarc": "Y0601"}
"""Example that passes a singularity of the wrist. The calibrated arm only comes within 0.01 deg of a
singularity, where J4 would have to rotate by half a turn in no time, so that the finding is right.
"""


@pytest.mark.parametrize("example", OF_INDUSTRIAL6)
def test_the_examples_compile_on_a_calibrated_arm(example, tmp_path):
    """Each joint frame of INDUSTRIAL6 is off by 0.1 mm and 0.01 deg, so that inverse kinematics has no closed
    form.
    """
    arm, programs = tmp_path / "arm", tmp_path / "programs"
    arm.mkdir()
    (arm / "robot.toml").write_text((INDUSTRIAL6 / "robot.toml").read_text())
    (arm / "industrial6.urdf").write_text(calibrated((INDUSTRIAL6 / "industrial6.urdf").read_text()))
    shutil.copytree(EXAMPLES, programs)
    text = re.sub(r"^ROBOT .*$", "", (programs / example).read_text(), flags=re.MULTILINE)
    (programs / example).write_text(text)
    opened = open_program(str(programs / example), Options(robot=str(arm)))
    assert opened.value is not None, opened.diagnostics
    assert wristed_arm(opened.value.request.robot.chain) is None
    result = compile_module(opened.value.module, opened.value.request)
    said = errors(result.diagnostics)
    if example in THROUGH_THE_WRIST:
        assert said
        assert all(one.startswith(THROUGH_THE_WRIST[example]) and " J4 " in one for one in said), said
        return
    assert said == []
    assert result.value is not None


number = st.floats(-1, 1, allow_nan=False)
place = st.tuples(number, number, number).map(lambda xyz: tuple(round(0.3 * part, 4) for part in xyz))
turn = st.tuples(number, number, number).map(lambda rpy: tuple(round(3.0 * part, 4) for part in rpy))
axis = st.sampled_from([(0, 0, 1), (0, 1, 0), (1, 0, 0), (0, -1, 0), (0.6, 0, 0.8), (-0.6, 0.64, 0.48)])
joint = st.one_of(
    st.tuples(
        st.just("revolute"), place, turn, axis, st.sampled_from([(-2.5, 2.5), (-6.2, 6.2), (0.1, 3.0)])
    ),
    st.tuples(st.just("continuous"), place, turn, axis, st.just((0, 0))),
    st.tuples(st.just("prismatic"), place, turn, axis, st.sampled_from([(0, 0.4), (-0.3, 0.3)])),
)


@exercises(compiled=0.2)
@settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck))
@given(joints=st.lists(joint, min_size=1, max_size=9), seed=st.integers(0, 99))
def test_a_random_chain(tally, joints, seed, tmp_path_factory):
    """Forward kinematics equals Pinocchio's, inverse kinematics inverts it, and a program compiles or has
    errors.
    """
    folder = tmp_path_factory.mktemp("chain")
    (folder / "chain.urdf").write_text(urdf_of(joints))
    robot = made(folder / "chain.urdf", folder / "arm")
    assert robot.size == len(joints)
    assert [kind for kind, *_ in joints] == list(robot.joint_kinds)
    q = within(robot.chain, robot.limits, 24)
    poses = flange_poses(robot.chain, q)
    np.testing.assert_allclose(poses, pinocchio_poses(robot, q), atol=1e-12)
    found, solved = reaching(robot.chain, robot.limits, poses)
    assert ((found >= robot.limits.lower - 1e-12) & (found <= robot.limits.upper + 1e-12)).all()
    np.testing.assert_allclose(flange_poses(robot.chain, found[solved]), poses[solved], atol=3e-6)
    assert solved.mean() >= 0.9
    text = program(robot, seed) if len(joints) >= 6 else program(robot, seed, pick=in_joints)
    made_of_it, diagnostics = compiled(text, str(folder / "arm"))
    said = errors(diagnostics)
    assert (made_of_it is None) == bool(said)
    tally.count("compiled", made_of_it is not None)
    # the only possible errors: a random chain hits itself, or a line passes a singularity or a limit
    said = [one for one in said if not one.startswith(("Y0902", "Y0925"))]
    assert all(one[:3] in {"Y05", "Y06", "Y07", "Y08"} for one in said), said
    if len(joints) < 6:
        assert said == []


@pytest.mark.parametrize(
    "line", ["MOVEL 450 100 50 180 10 30", "MOVEJ_RPY 450 100 50 180 0.5 30", "DMOVE 0 0 0 5 0 0"]
)
def test_a_pose_that_four_joints_cannot_hold_is_one_error(line, tmp_path):
    made(EXAMPLES / "scara.urdf", tmp_path / "scara")
    _, diagnostics = compiled(
        f"DEFAULT {{TCP}} [MIN] (mm,deg,s) {{B}}\nP0010 {line}\n", str(tmp_path / "scara")
    )
    (finding,) = [one for one in diagnostics if one.is_error]
    assert finding.code == "Y0501"
    assert "deg" in finding.message or "mm" in finding.message


def test_four_joints_follow_a_line_that_they_can_hold(tmp_path):
    made(EXAMPLES / "scara.urdf", tmp_path / "scara", "--tcp", "0,0,50")
    text = (
        "DEFAULT {TCP} [MIN] (mm,deg,s) {B}\n"
        "P0010 MOVEL 450 100 50 180 0 30\n"
        "P0020 MOVEL 300 -200 100 180 0 -60\n"
        "P0030 DMOVE 20 10 5 0 0 15\n"
        "P0040 MOVEJ_RPY 450 100 50 180 0 0\n"
    )
    result, diagnostics = compiled(text, str(tmp_path / "scara"))
    assert errors(diagnostics) == []
    assert result is not None


def test_one_joint(tmp_path):
    (tmp_path / "one.urdf").write_text(urdf_of([("prismatic", (0, 0, 1), (0, 0, 0), (0, 0, 1), (0, 0.5))]))
    made(tmp_path / "one.urdf", tmp_path / "one")
    result, diagnostics = compiled(
        "DEFAULT {TCP} [MIN] (mm,deg,s) {B}\nP0010 MOVEJ 200\nP0020 DMOVE 0 0 100 0 0 0\n",
        str(tmp_path / "one"),
    )
    assert errors(diagnostics) == []
    assert result is not None


def test_ten_joints_are_too_many(tmp_path):
    ten = [("revolute", (0, 0, 0.1), (0, 0, 0), (0, 1, 0), (-1, 1))] * 10
    (tmp_path / "ten.urdf").write_text(urdf_of(ten))
    result = yarc("robot", "new", tmp_path / "ten.urdf", "--yes", "-o", tmp_path / "ten")
    assert result.exit_code == 1
    assert "Y1318" in result.output
    assert "10 joints" in result.output
    assert not (tmp_path / "ten").exists()
