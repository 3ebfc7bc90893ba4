"""Write the SRDF of a MoveIt configuration: planning group, end effector, named states, and the pairs of
links that MoveIt doesn't check for collisions.
"""

from __future__ import annotations

from itertools import combinations
from xml.sax.saxutils import quoteattr

from yarclang.collision.scene import Scene
from yarclang.export.moveit.bodies import Bodies
from yarclang.export.numbers import number
from yarclang.robot.model import Robot
from yarclang.robot.urdf import MOVING, Urdf

GROUP, END_EFFECTOR = "manipulator", "end_effector"


def srdf_text(robot: Robot, urdf: Urdf, ends: tuple[str, str], bodies: Bodies, scene: Scene) -> str:
    """Return the text of the SRDF of a robot.

    Args:
        robot: the robot.
        urdf: its URDF.
        ends: the links {B} and {FLANGE}.
        bodies: additional links on the flange.
        scene: the pairs of bodies that are checked for collisions. All other pairs are disabled.
    """
    base, flange = ends
    root = next(link for link in urdf.links if link not in {joint.child for joint in urdf.joints.values()})
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        "<!-- Written by yarc export for MoveIt. -->",
        f"<robot name={quoteattr(urdf_name(urdf))}>",
        f"  <group name={quoteattr(GROUP)}>",
        f"    <chain base_link={quoteattr(base)} tip_link={quoteattr(flange)}/>",
        "  </group>",
    ]
    if bodies.links:
        lines += [
            f"  <group name={quoteattr(END_EFFECTOR)}>",
            *(f"    <link name={quoteattr(link)}/>" for link in bodies.links),
            "  </group>",
        ]
    for name, q in robot.positions.items():
        lines.append(f"  <group_state name={quoteattr(name.lower())} group={quoteattr(GROUP)}>")
        lines += [
            f"    <joint name={quoteattr(joint)} value={quoteattr(number(value))}/>"
            for joint, value in zip(robot.joint_names, q.tolist(), strict=True)
        ]
        lines.append("  </group_state>")
    if bodies.links:
        lines.append(
            f"  <end_effector name={quoteattr(END_EFFECTOR)} parent_link={quoteattr(flange)} "
            f"group={quoteattr(END_EFFECTOR)} parent_group={quoteattr(GROUP)}/>"
        )
    lines.append(
        f'  <virtual_joint name="fixed_base" type="fixed" parent_frame="world" child_link={quoteattr(root)}/>'
    )
    lines += [
        f"  <passive_joint name={quoteattr(joint.name)}/>"
        for joint in urdf.joints.values()
        if joint.kind in MOVING
        and joint.name not in robot.joint_names
        and joint.element.first("mimic") is None
    ]
    lines += [
        f"  <disable_collisions link1={quoteattr(one)} link2={quoteattr(other)} reason={quoteattr(reason)}/>"
        for one, other, reason in disabled_pairs(robot, bodies, scene)
    ]
    return "\n".join([*lines, "</robot>"]) + "\n"


def urdf_name(urdf: Urdf) -> str:
    """Return the robot's name in its URDF. The SRDF must use the same name."""
    assert urdf.root is not None  # a sound URDF has a root
    return urdf.root.attributes.get("name", "")


def disabled_pairs(robot: Robot, bodies: Bodies, scene: Scene) -> list[tuple[str, str, str]]:
    """Return the pairs of links that aren't checked for collisions, in alphabetical order, each with the
    reason.

    MoveIt's reasons are: Adjacent (they meet in a joint, or never move relative to each other), Default (they
    touch in HOME), User (allowed in robot.toml).
    """
    joints = {body.name: body.joint for body in scene.bodies}
    checked = {frozenset(scene.names(pair)) for pair in range(len(scene.pairs.first))}
    at_home = {frozenset(pair) for pair in scene.at_home}
    pairs = []
    for one, other in combinations(sorted(joints), 2):
        pair = frozenset((one, other))
        if pair in checked:
            continue
        allowed = tuple(sorted((one, other))) in robot.allowed
        reason = "User" if allowed else "Default" if pair in at_home else "Adjacent"
        links = sorted((bodies.link_of(one), bodies.link_of(other)))
        pairs.append((links[0], links[1], reason))
    return sorted(pairs)
