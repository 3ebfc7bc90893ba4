"""Tests with arms of the package example-robot-data, created from its files. Pinocchio, which reads the
original text, checks joints, solutions and the emitted line.
"""

import numpy as np
import pytest
from programs import compiled

from tests.robot.made_arms import made, yarc
from tests.robot.test_new_robot import DATA
from tests.robot.trap_arms import poses
from yarclang.independent.reading import read
from yarclang.robot.kinematics import flange_poses, reaching
from yarclang.robot.kinematics.search import within

ARMS = {
    # file, given tip, base, flange, number of joints
    "kinova": ("kinova_description/robots/kinova.urdf", "", "j2s6s200_link_base", "j2s6s200_end_effector", 6),
    "panda": ("panda_description/urdf/panda.urdf", "", "panda_link0", "panda_link8", 7),
    "ur5": ("ur_description/urdf/ur5_robot.urdf", "", "base_link", "tool0", 6),
    "ur3 with gripper": ("ur_description/urdf/ur3_gripper.urdf", "", "base_link", "tool0", 6),
    "xarm7": ("xarm_description/urdf/xarm7.urdf", "", "link_base", "link_eef", 7),
    "z1": ("z1_description/urdf/z1.urdf", "", "link00", "link06", 6),
    "tiago on its torso": (
        "tiago_description/robots/tiago_no_hand.urdf",
        "",
        "base_link",
        "arm_tool_link",
        8,
    ),
    "baxter, left": ("baxter_description/urdf/baxter.urdf", "left_hand_link", "base", "left_hand_link", 7),
    "pr2, right": ("pr2_description/urdf/pr2.urdf", "r_wrist_roll_link", "base_link", "r_wrist_roll_link", 8),
    "romeo, left": ("romeo_description/urdf/romeo.urdf", "l_wrist", "base_link", "l_wrist", 8),
    "a quadruped's arm": ("b1_description/urdf/b1-z1.urdf", "link06", "base", "link06", 6),
}


@pytest.mark.parametrize("name", ARMS)
def test_the_arm_of_the_file_by_pinocchio(name, tmp_path):
    file, tip, base, flange, size = ARMS[name]
    path = next(iter(DATA.rglob(file.rpartition("/")[2])))
    text = path.read_text()
    folder = tmp_path / "r"
    arm = made(path, folder, "--tcp", "0,0,0", *(("--tip", tip) if tip else ()))
    toml = (folder / "robot.toml").read_text()
    assert f'base = "{base}"' in toml
    assert f'flange = "{flange}"' in toml
    assert arm.size == size
    q = within(arm.chain, arm.limits, 300)
    true = poses(text, base, flange, arm.joint_names, q)
    np.testing.assert_allclose(flange_poses(arm.chain, q), true, atol=1e-9)
    found, solved = reaching(arm.chain, arm.limits, true)
    assert solved.mean() >= 0.995
    np.testing.assert_allclose(
        poses(text, base, flange, arm.joint_names, found[solved]), true[solved], atol=3e-6
    )
    way = np.array([12.0, -9.0, 15.0])
    result, diagnostics = compiled(
        "DEFAULT {TCP} [MIN] (mm,deg,s) {B}\nP0020 DMOVE 12 -9 15 0 0 0\n", str(folder)
    )
    assert result is not None, diagnostics
    (line,) = read(result.text)[1].values()
    passed = poses(text, base, flange, arm.joint_names, line.sample(per_segment=16) * arm.axis_units)
    shift = (passed[:, :3, 3] - passed[0, :3, 3]) * 1e3
    np.testing.assert_allclose(shift[-1], way, atol=0.01)
    along = shift @ way / (way @ way)
    assert np.linalg.norm(shift - along[:, None] * way, axis=1).max() < 0.01


@pytest.mark.parametrize(
    "name", ["baxter", "pr2", "tiago_dual", "tiago_pro", "romeo", "b1-z1", "anymal-kinova", "centauro",
        "iris", "a1", "solo12"]
)  # fmt: skip
def test_a_file_with_more_than_one_limb_asks(name, tmp_path):
    path = next(iter(DATA.rglob(f"{name}.urdf")))
    result = yarc("robot", "new", path, "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 1
    assert "Y1365" in result.output
    assert not (tmp_path / "r").exists()


def test_a_package_with_three_slashes_is_that_package(tmp_path):
    """A URI with three slashes (package:///...) names the same package. Talos uses such URIs for
    23 meshes.
    """
    path = next(iter(DATA.rglob("talos_full_v2.urdf")))
    result = yarc("robot", "new", path, "--yes", "--tip", "gripper_left_base_link", "-o", tmp_path / "r")
    assert result.exit_code == 0, result.output
    assert "24 collision meshes copied" in result.output
