"""Find the arm in a URDF: the chain of joints from the base link to the flange link. Compute the screws of
these joints with Pinocchio.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from yarclang.robot.mimic import mimic_of
from yarclang.robot.model import Chain
from yarclang.robot.urdf import MOVING, UNARMED, Joint, Urdf
from yarclang.robot.urdf_xml import Element
from yarclang.subjects import Name
from yarclang.toml.file import did_you_mean


def joints_between(urdf: Urdf, base: str, flange: str) -> tuple[Joint, ...] | None:
    """Return all joints from link `base` to link `flange`, including fixed joints, or None if no chain of
    joints leads from `base` to `flange`.

    The URDF must contain both links, and its links must form one tree.
    """
    above = {joint.child: joint for joint in urdf.joints.values()}
    joints: list[Joint] = []
    link = flange
    while link != base:
        if link not in above:
            return None
        joints.append(above[link])
        link = above[link].parent
    return tuple(reversed(joints))


def check_chain(urdf: Urdf, joints: Sequence[Joint], ignored: Collection[str] = ()) -> bool:
    """Report joints of the arm's chain that no motor can move. Report also moving joints outside of the chain
    that robot.toml doesn't list as ignored.

    Args:
        urdf: the URDF, which collects the findings.
        joints: the joints of the chain, including fixed joints.
        ignored: names of the moving joints that robot.toml ignores.

    Returns:
        True if every joint of the chain has a supported type: revolute, continuous, prismatic or fixed.
    """
    inside = {joint.name for joint in joints}
    sound = True
    every = tuple(urdf.joints.values())
    for joint in joints:
        mimic = mimic_of(joint, every)
        if joint.kind in UNARMED:
            message = f"Joint {joint.name} is {joint.kind}, a type that an arm's joint can't have."
            urdf.say("Y1351", message, _TYPES, joint.element, "type")
            sound = False
        elif mimic is not None:
            message = f"Joint {joint.name} mimics another, {mimic.equation}, so it has no motor of its own."
            place = joint.element.first("mimic") or joint.element
            urdf.say("Y1351", message, f"Make it fixed. {mimic.remedy(joints)}", place)
    for joint in urdf.joints.values():
        if joint.kind != "fixed" and joint.name not in inside and joint.name not in ignored:
            message = f"Joint {joint.name} is {joint.kind}, but isn't between the base and the flange."
            remedy = f'Put "{joint.name}" into ignored_joints of robot.toml: its position is then taken as 0.'
            urdf.say("Y1354", message, remedy, joint.element)
    return sound


_TYPES = "Use revolute, continuous, prismatic or fixed."


def check_bodies(urdf: Urdf, joints: Sequence[Joint], shapes: Mapping[str, Sequence[str]]) -> None:
    """Report moving joints whose link has no collision shape. Links rigidly attached to this link count as
    its parts.

    Args:
        urdf: the URDF, which collects the findings.
        joints: the joints of the chain.
        shapes: the collision shapes of each link.
    """
    below: dict[str, list[Joint]] = {}
    for joint in urdf.joints.values():
        below.setdefault(joint.parent, []).append(joint)
    for joint in joints:
        if joint.kind not in MOVING:
            continue
        body, todo = [], [joint.child]
        while todo:  # collect all links that are rigidly attached to the joint's child link
            body.append(todo.pop())
            todo += [other.child for other in below.get(body[-1], []) if other.kind == "fixed"]
        if not any(shapes.get(link) for link in body):
            message = f"Link {joint.child}, which joint {joint.name} moves, has no <collision>."
            remedy = "Add a <collision> with a simple shape around it, so that the collision check sees it."
            urdf.say("Y1359", message, remedy, urdf.links[joint.child])


def find_links(urdf: Urdf, names: dict[str, str]) -> list[tuple[str, str, str, Name]]:
    """Return a finding (key, message, help, subject) for each link name of robot.toml that the URDF doesn't
    contain.

    Args:
        urdf: the URDF.
        names: for each key of robot.toml whose value is a link name, this name.
    """
    return [
        (key, f"{key} is the link {link[:40]}, which the URDF doesn't have.", *did_you_mean(link, urdf.links))
        for key, link in names.items()
        if link not in urdf.links
    ]


def screws(urdf: Urdf, base: str, flange: str, joints: Sequence[Joint]) -> Chain | None:
    """Return the arm's chain as a product of exponentials; None, with a finding, if Pinocchio rejects the
    URDF.

    Args:
        urdf: a URDF without errors.
        base: the link that is {B}.
        flange: the link that is {FLANGE}.
        joints: the moving joints from base to flange.
    """
    import pinocchio as pin

    try:
        model = pin.buildModelFromXML(urdf.text)
    except Exception as error:  # Boost raises errors of several types
        root = urdf.root or Element("", {}, 0, 0)
        message = f"Pinocchio can't read the URDF: {str(error)[:200].rstrip('.')}."
        urdf.say("Y1360", message, "What it prints on the terminal names the element.", root)
        return None
    data = model.createData()
    pin.computeJointJacobians(model, data, pin.neutral(model))
    pin.updateFramePlacements(model, data)
    world_from_base = data.oMf[model.getFrameId(base, pin.FrameType.BODY)]
    world_from_flange = data.oMf[model.getFrameId(flange, pin.FrameType.BODY)]
    base_from_world = world_from_base.inverse()
    columns = [model.joints[model.getJointId(joint.name)].idx_v for joint in joints]
    # Pinocchio's world Jacobian: velocity of the point at the world's origin, then angular velocity
    jacobian = np.reshape(data.J, (6, -1))  # Pinocchio gives a vector for a single column
    matrix = base_from_world.toActionMatrix() @ jacobian[:, columns]
    placed = (base_from_world * world_from_flange).homogeneous
    return Chain(frozen(matrix.T), frozen(placed))


def frozen(values: object) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Return a read-only float64 array without negative zeros."""
    array = np.array(values, dtype=np.float64) + 0.0
    array.setflags(write=False)
    return array
