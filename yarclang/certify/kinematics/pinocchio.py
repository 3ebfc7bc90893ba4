"""Comparison of the judge's kinematics and dynamics with Pinocchio's, at a few instants of each motion.

Pinocchio must place all joints and the flange in the same way, and compute the same torques.

The instants are the start of each motion, a knot in its middle, and the end of the last motion. The
comparison takes about 0.1 ms for each motion.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import Any

import numpy as np

from yarclang.certify.kinematics.arm import KINEMATICS
from yarclang.certify.kinematics.described import Ends, ends_of
from yarclang.certify.read.layout import Layout
from yarclang.frozen import frozen
from yarclang.robot.dynamics import torques
from yarclang.robot.model import Array, Robot

SAME_PLACE = 1e-9
"""Largest difference between entries of two transforms that count as equal [m].

If a coordinate of a joint or of the flange is larger than 1 m, the limit is multiplied by the largest
coordinate in metres.
"""
SAME_TORQUE = 1e-7
"""Largest difference between torques that count as equal [N m or N]. If a torque is larger than 1, the limit
is multiplied by the largest torque.
"""


@frozen(eq=False)
class _Witness:
    """Pinocchio's model of a robot.

    Attributes:
        model: the model.
        data: Pinocchio's working data for the model.
        joints: (n,) indices of the arm's joints in the model.
        columns: (n,) indices of the joints' velocities in the model.
        base: index of the base's frame.
        flange: index of the flange's frame.
        at_zero: (n + 1, 4, 4) frames of joints and flange in {B} with all joints at zero.
    """

    model: Any
    data: Any
    joints: tuple[int, ...]
    columns: tuple[int, ...]
    base: int
    flange: int
    at_zero: Array


def disagreements(layout: Layout, robot: Robot) -> Iterator[tuple[int, str]]:
    """Yield the first step at which Pinocchio's result differs from the judge's, with the reason.

    Args:
        layout: the commands of the controller text.
        robot: the robot as the judge reads it. For a robot without files, nothing can be compared.
    """
    witness = _witness_of(robot)
    moving = [place for place in layout.places if place.size]
    if witness is None or not moving:
        return
    segments = np.array([(place.first, (place.first + place.last) // 2) for place in moving]).ravel()
    segments = np.append(segments, moving[-1].last - 1)
    steps = [*np.repeat([place.step for place in moving], 2).tolist(), moving[-1].step]
    at = layout.at[segments]
    ahead, here, after = (layout.control[at + number] for number in range(3))
    h = layout.time[segments][:, None]
    # Compute position, velocity and acceleration at a knot of the uniform cubic B-spline.
    q, v, a = (
        (ahead + 4.0 * here + after) / 6.0,
        (after - ahead) / (2.0 * h),
        (after - 2.0 * here + ahead) / h**2,
    )
    placed = KINEMATICS.placements(robot.chain, q)
    flanges = KINEMATICS.flange(robot.chain, q)
    dynamics = robot.dynamics
    torque = torques(robot.chain, dynamics, q, v, a) if dynamics is not None and dynamics.is_checked else None
    for row, step in enumerate(steps):
        places, needed = _asked(witness, (q[row], v[row], a[row]), loaded=torque is not None)
        ours = np.empty_like(places)
        # The judge's transforms move the frames at zero, which are taken from Pinocchio, to their places at
        # q.
        ours[:-1] = _joined(placed[1:, :, :, row]) @ witness.at_zero[:-1]
        ours[-1] = flanges[row]
        allowed = SAME_PLACE * max(1.0, float(np.abs(places[:, :3, 3]).max()))
        if not float(np.abs(ours - places).max()) <= allowed:
            yield step, "Pinocchio puts the links elsewhere than the judge's kinematics"
            return
        if torque is not None and not float(np.abs(torque[row] - needed).max()) <= SAME_TORQUE * max(
            1.0, float(np.abs(needed).max())
        ):
            yield step, "Pinocchio needs other torques than the judge's dynamics"
            return


def _joined(placed: Array) -> Array:
    """Return transforms (n, 4, 4) from their upper rows (n, 3, 4)."""
    made = np.zeros((len(placed), 4, 4))
    made[:, :3], made[:, 3, 3] = placed, 1.0
    return made


def _asked(witness: _Witness, motion: tuple[Array, Array, Array], *, loaded: bool) -> tuple[Array, Array]:
    """Return Pinocchio's frames of joints and flange (n + 1, 4, 4) in {B}, and the joint torques (n,).

    The torques are zero unless `loaded`.
    """
    import pinocchio as pin

    model, data = witness.model, witness.data
    q, v, a = motion
    full, rate, change = pin.neutral(model), np.zeros(model.nv), np.zeros(model.nv)
    for joint, value in zip(witness.joints, q.tolist(), strict=True):
        kind = model.joints[joint]
        if kind.nq == 2:  # a continuous joint is represented by the cosine and the sine of its angle
            full[kind.idx_q : kind.idx_q + 2] = np.cos(value), np.sin(value)
        else:
            full[kind.idx_q] = value
    columns = list(witness.columns)
    needed = np.zeros(len(columns))
    if loaded:
        rate[columns], change[columns] = v, a
        needed = np.asarray(pin.rnea(model, data, full, rate, change))[columns]
    pin.framesForwardKinematics(model, data, full)
    # Pinocchio's frames are in the URDF's root: base_from_frame = base_from_root root_from_frame.
    back = data.oMf[witness.base].inverse()
    places = [back * data.oMi[joint] for joint in witness.joints] + [back * data.oMf[witness.flange]]
    return np.array([one.homogeneous for one in places]), needed


@lru_cache(maxsize=64)
def _witness_of(robot: Robot) -> _Witness | None:
    """Build Pinocchio's model of a robot; None if the robot has no files."""
    if robot.written is None:
        return None
    import pinocchio as pin

    ends: Ends = ends_of(robot.written)
    model = pin.buildModelFromXML(robot.written.urdf)
    joints = tuple(model.getJointId(name) for name in robot.joint_names)
    base, flange = (model.getFrameId(link, pin.FrameType.BODY) for link in (ends.base, ends.flange))
    data = model.createData()
    pin.framesForwardKinematics(model, data, pin.neutral(model))
    # Pinocchio works in the axes of the URDF's root. The robot's gravity is given in those of {B}.
    turned = data.oMf[base].rotation
    if robot.dynamics is not None:
        model.gravity.linear = turned @ robot.dynamics.gravity
    last = joints[-1]
    for tool in robot.tools:
        if tool.mounted and tool.mass > 0.0:
            # The tool's inertia is given in the flange's frame; move it into the frame of the last joint and
            # add it there.
            body = pin.Inertia(tool.mass, tool.center, tool.inertia)
            model.inertias[last] += (data.oMi[last].inverse() * data.oMf[flange]).act(body)
    data = model.createData()
    columns = tuple(model.joints[joint].idx_v for joint in joints)
    bare = _Witness(model, data, joints, columns, base, flange, np.empty(0))
    still = np.zeros(robot.size)
    at_zero, _ = _asked(bare, (still, still, still), loaded=False)
    return _Witness(model, data, joints, columns, base, flange, at_zero)
