"""Check that motors, encoder resolution and path tolerance fit each other."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from yarclang.robot.actuation import counts_per_joint, from_counts, joints_per_count, to_counts
from yarclang.robot.checklist.item import Item, listed
from yarclang.robot.kinematics.reach import reach_radii
from yarclang.robot.model import Robot
from yarclang.units import DEG, MM, MS

EXACT = 1e-9
"""Largest error of joint positions after conversion to counts and back [rad or m]."""

FINE = 0.25
"""Largest tool motion that is acceptable if every motor is off by half a count, as a fraction of the path
tolerance.
"""


def drive_items(robot: Robot) -> Iterator[Item]:
    """Yield the checklist items about the actuation matrix, the encoder resolution, the motors' speeds, and
    the lengths of the segments that the controller executes.
    """
    yield _invertible(robot)
    yield _resolution(robot)
    yield _speeds(robot)
    controller = robot.controller
    motors = ", ".join(
        f"#{motor} {axis}" for motor, axis in zip(controller.motors, controller.axes, strict=True)
    )
    yield Item("axes", "ok", f"{controller.text}: {motors}")
    low, high = controller.smallest_segment / MS, controller.largest_segment / MS
    yield Item("segments", "ok", f"{low:.4g} to {high:g} ms, by {controller.timing}")


def _invertible(robot: Robot) -> Item:
    condition = float(np.linalg.cond(robot.actuation.coupling))
    q = robot.home[None]
    miss = float(np.abs(from_counts(robot, to_counts(robot, q)) - q).max())
    coupled = int(np.count_nonzero(robot.actuation.coupling - np.diag(np.diag(robot.actuation.coupling))))
    found = f"condition number {condition:.3g}, {coupled or 'no'} coupling{'s' * (coupled != 1)}"
    if miss <= EXACT:
        return Item("actuation matrix", "ok", found)
    remedy = "make the rows of J linearly independent"
    return Item("actuation matrix", "to do", f"{found}; HOME comes back {miss:.2g} off", remedy)


def _resolution(robot: Robot) -> Item:
    """Compare the path tolerance with the encoder resolution. The largest tool motion that occurs if every
    motor is off by half a count must be small relative to the tolerance.
    """
    half = 0.5 * np.abs(joints_per_count(robot)).sum(axis=1)
    frame = robot.flange_from_frame.get("TCP", np.eye(4))
    radii = reach_radii(robot.chain, robot.limits, frame)
    way = float((half * radii).sum())
    turn = float(half[~robot.chain.is_prismatic].sum())
    result = (
        f"half a count of every motor moves TCP by at most {way / MM:.2g} mm, {turn / DEG:.2g} deg; the "
        f"tolerance is "
        f"{robot.tolerance.position / MM:g} mm, {robot.tolerance.angle / DEG:g} deg"
    )
    if way <= FINE * robot.tolerance.position and turn <= FINE * robot.tolerance.angle:
        return Item("encoder resolution", "ok", result)
    remedy = "check K (counts per deg or mm at the joint, gear included), or allow a larger [tolerance]"
    verdict = "note" if way <= robot.tolerance.position and turn <= robot.tolerance.angle else "to do"
    return Item("encoder resolution", "note" if verdict == "note" else "to do", result, remedy)


def _speeds(robot: Robot) -> Item:
    """Compare the speed limit of each motor with the motor speeds at the joints' velocity limits. These
    speeds are computed with one joint moving at a time, and with all joints moving at once.
    """
    needed = np.abs(counts_per_joint(robot)) * robot.limits.velocity
    alone, together = needed.max(axis=1), needed.sum(axis=1)
    have = robot.actuation.velocity
    numbers = robot.controller.motors
    slow = have < alone * (1.0 - 1e-9)
    if slow.any():
        at = int(np.argmin(have / alone))
        remark = (
            f"motor {numbers[at]} reaches {have[at] / alone[at] * 100:.3g} % of the speed needed for its "
            f"joint's limit ({have[at] * MS:.4g} of {alone[at] * MS:.4g} counts/ms)"
        )
        return Item(
            "motor speeds",
            "note",
            remark,
            "plans respect the motor's limit; lower the joint's velocity if it is wrong",
        )
    if (have < together * (1.0 - 1e-9)).any():
        at = int(np.argmin(have / together))
        remark = (
            f"motor {numbers[at]} limits coupled joints to {have[at] / together[at] * 100:.3g} % when "
            f"they move together"
        )
        return Item(
            "motor speeds",
            "note",
            remark,
            "plans respect the motor's limit; nothing is left to do if the number is right",
        )
    fast = have > 3.0 * together
    if fast.any():
        names = listed([str(number) for number, one in zip(numbers, fast, strict=True) if one])
        remark = f"motors {names} may run at more than three times the speed needed for their joints' limits"
        return Item("motor speeds", "note", remark, "check the unit: velocity of [motors] is in counts/ms")
    return Item("motor speeds", "ok", "every motor is fast enough for its joints' limits")
