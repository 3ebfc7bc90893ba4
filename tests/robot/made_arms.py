"""Robots that `yarc robot new` creates from real URDFs and from random ones, and programs that each of them
can execute.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pinocchio
from click.testing import CliRunner
from scipy.spatial.transform import Rotation

from yarclang.cli.yarc import main
from yarclang.commands.registry import commands
from yarclang.commands.spec import Values
from yarclang.robot.description import load_robot
from yarclang.robot.kinematics import tool_poses

DATA = Path(pinocchio.__file__).parents[4] / "share" / "example-robot-data" / "robots"
UR = "ur_description/urdf/"
REAL = {
    # name: file, further arguments, number of joints
    "ur3": (UR + "ur3_robot.urdf", (), 6),
    "ur5": (UR + "ur5_robot.urdf", (), 6),
    "ur5-limited": (UR + "ur5_joint_limited_robot.urdf", (), 6),
    "ur10": (UR + "ur10_robot.urdf", (), 6),
    "ur3-gripper": (UR + "ur3_gripper.urdf", (), 6),
    "ur5-gripper": (UR + "ur5_gripper.urdf", (), 6),
    "panda": ("panda_description/urdf/panda.urdf", (), 7),
    "kinova": ("kinova_description/robots/kinova.urdf", (), 6),
    "z1": ("z1_description/urdf/z1.urdf", (), 6),
    "xarm7": ("xarm_description/urdf/xarm7.urdf", (), 7),
    "so100": ("so_arm_description/urdf/so100.urdf", (), 5),
    "so101": ("so_arm_description/urdf/so101.urdf", (), 5),
    "two-dofs": ("asr_twodof_description/urdf/TwoDofs.urdf", (), 2),
    "double-pendulum": ("double_pendulum_description/urdf/double_pendulum.urdf", (), 2),
    "double-pendulum-continuous": ("double_pendulum_description/urdf/double_pendulum_continuous.urdf", (), 2),
    "finger-edu": ("finger_edu_description/robots/finger_edu.urdf", (), 3),
    "talos-arm": ("talos_data/robots/talos_left_arm.urdf", (), 6),
    "talos-7": (
        "talos_data/robots/talos_reduced.urdf",
        ("--base", "torso_2_link", "--tip", "wrist_left_ft_link"),
        7,
    ),
    "talos-9": ("talos_data/robots/talos_reduced.urdf", ("--tip", "wrist_left_ft_link"), 9),
    "baxter-right": ("baxter_description/urdf/baxter.urdf", ("--tip", "right_hand_link"), 7),
    "baxter-left": ("baxter_description/urdf/baxter.urdf", ("--tip", "left_hand_link"), 7),
    "tiago-8": ("tiago_description/robots/tiago.urdf", (), 8),
    "tiago-pro": ("tiago_pro_description/robots/tiago_pro.urdf", ("--tip", "arm_left_tool_link"), 8),
    "romeo-8": ("romeo_description/urdf/romeo_small.urdf", ("--tip", "l_wrist"), 8),
}
NEAR = 0.12
"""Largest distance of the programs from HOME [rad or m]."""


def yarc(*arguments: object):
    """Run `yarc` with arguments."""
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def made(urdf: Path, folder: Path, *arguments: str):
    """Return the robot that `yarc robot new` creates without questions."""
    result = yarc("robot", "new", urdf, "--yes", "-o", folder, *arguments)
    assert result.exit_code == 0, result.output
    loaded = load_robot(str(folder))
    assert loaded.value is not None, loaded.diagnostics
    return loaded.value


def program(robot, seed: int = 0, pick=lambda spec, target: True) -> str:
    """Return a program of all motion commands with all kinds of goals, each from HOME to a position near
    HOME.
    """
    random = np.random.default_rng(seed)
    lines = ["DEFAULT {TCP} [MIN] (mm,deg,s) {B}"]
    for spec in commands().values():
        for target, values in spec.targets.items():
            if not spec.is_motion or not pick(spec, values):
                continue
            count = spec.waypoints[0] if spec.waypoints[1] == spec.waypoints[0] else max(spec.waypoints[0], 3)
            kinds = [*spec.leading, *(values for _ in range(count))][:count]
            name = f"{spec.name}_{target}" if target else spec.name
            goals = _goals(robot, random, kinds)
            if spec.is_timed:
                goals = [f"{goal} [{20 * number}]" for number, goal in enumerate(goals, 1)]
            lines.append(f"P{len(lines) * 10:04d} {name} {'; '.join(goals)}")
            lines.append(f"P{len(lines) * 10:04d} MOVEJ HOME")
    return "\n".join([*lines, "P9999 STOP", ""])


def _goals(robot, random, kinds) -> list[str]:
    """Return values for waypoints. A waypoint that is only a position, except for the last one, is placed
    beside the straight way from the start to the next waypoint.
    """
    limits, units = robot.limits, robot.axis_units
    room = np.minimum(NEAR, 0.8 * np.minimum(robot.home - limits.lower, limits.upper - robot.home))
    tcp = robot.flange_from_frame["TCP"]
    (start,) = tool_poses(robot.chain, robot.home[None], tcp)
    texts = []
    for kind in kinds:
        q = robot.home + room * (random.random(robot.size) - 0.5)
        (pose,) = tool_poses(robot.chain, q[None], tcp)
        place, turn = pose[:3, 3] * 1e3, Rotation.from_matrix(pose[:3, :3])
        small = Rotation.from_euler("xyz", random.random(3) * 2.0, degrees=True)
        numbers = {
            Values.JOINTS: q / units,
            Values.JOINT_DELTAS: 0.1 * (q - robot.home) / units,
            Values.POSE_RPY: [*place, *turn.as_euler("xyz", degrees=True)],
            Values.POSE_QUAT: [*place, *turn.as_quat()],
            Values.POSITION: place,
            Values.DELTA_RPY: [*(random.random(3) * 4.0), *small.as_euler("xyz", degrees=True)],
            Values.DELTA_QUAT: [*(random.random(3) * 4.0), *small.as_quat()],
        }[kind]
        texts.append(np.array(numbers))
    for at, kind in enumerate(kinds[:-1]):
        # halfway to the next waypoint, and aside by a fifth of this distance
        if kind is Values.POSITION:
            way = texts[at + 1][:3] - start[:3, 3] * 1e3
            aside = np.cross(way, [0.6, 0.0, 0.8])
            texts[at] = (
                start[:3, 3] * 1e3 + 0.5 * way + 0.2 * np.linalg.norm(way) * aside / np.linalg.norm(aside)
            )
    return [" ".join(f"{value:.9f}" for value in numbers) for numbers in texts]


def calibrated(text: str, seed: int = 1) -> str:
    """Return a URDF as if it were calibrated: each joint's frame is off by about 0.1 mm and 0.01 deg in all
    directions, so no axes meet.
    """
    random = np.random.default_rng(seed)

    def off(origin: re.Match[str]) -> str:
        parts = []
        for key, size in (("xyz", 1e-4), ("rpy", np.radians(0.01))):
            said = re.search(rf'{key}="([^"]*)"', origin[0])
            values = [float(value) for value in said[1].split()] if said else [0.0, 0.0, 0.0]
            parts.append(f'{key}="{" ".join(f"{value + size * random.normal():.12g}" for value in values)}"')
        return f"<origin {' '.join(parts)}/>"

    joints = re.compile(r"<joint\b.*?</joint>", re.DOTALL)
    return joints.sub(lambda joint: re.sub(r"<origin\b[^>]*/>", off, joint[0]), text)


def urdf_of(joints) -> str:
    """Return a URDF of joints (kind, origin xyz, origin rpy, axis, limits), beginning at the base."""
    lines = ['<robot name="chain" version="1.1">', '<link name="base_link"/>']
    above = "base_link"
    for number, (kind, xyz, rpy, axis, (low, high)) in enumerate(joints, 1):
        shape = '<sphere radius="0.01"/>'
        lines += [
            f'<link name="L{number}"><collision><geometry>{shape}</geometry></collision></link>',
            f'<joint name="J{number}" type="{kind}"><parent link="{above}"/><child link="L{number}"/>',
            f'<origin xyz="{_numbers(xyz)}" rpy="{_numbers(rpy)}"/><axis xyz="{_numbers(axis)}"/>',
            f'<limit lower="{low:.6f}" upper="{high:.6f}" velocity="1.5" effort="10"/></joint>',
        ]
        above = f"L{number}"
    lines += [
        '<link name="flange"/><joint name="end" type="fixed">',
        f'<parent link="{above}"/><child link="flange"/><origin xyz="0.05 0.02 0.1"/></joint></robot>',
    ]
    return "\n".join(lines)


def _numbers(values) -> str:
    return " ".join(f"{value:.6f}" for value in values)
