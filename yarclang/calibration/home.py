"""Calibrate the motors' offsets a0: the user moves joints to their marks, where the motor positions are
read.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from yarclang.diagnostics import Diagnostic, Result
from yarclang.frozen import frozen
from yarclang.robot.actuation import counts_per_joint, from_counts
from yarclang.robot.model import Array, Robot
from yarclang.subjects import suggest
from yarclang.transforms import constant
from yarclang.units import DEG, MM

LARGEST_SPREAD = {"deg": 0.05 * DEG, "mm": 0.05 * MM}
"""Distance between a visit of a mark and the mean of all visits above which a warning is given, by the unit
of the joint [rad or m].
"""


@frozen(eq=False)
class OffsetCalibration:
    """Calibrated offsets of the motors.

    Attributes:
        offsets: (n,) a0 of all motors [counts].
        shift: (n,) change of the indicated position of each joint by the new offsets [rad or m].
        spread: (n,) repeatability of each joint: the largest distance between a visit of the mark and
            the mean of all visits [rad or m]; zero for a single visit, and for joints without a mark.
    """

    offsets: Array
    shift: Array
    spread: Array


def find_offsets(
    robot: Robot, counts: Sequence[Array] | Array, marks: Mapping[str, float]
) -> Result[OffsetCalibration]:
    """Compute the motor offsets with which the robot indicates the right joint positions at the joints'
    marks.

    counts = K J q + a0, with the gear ratios K, the coupling J of the joints, the joint positions q and the
    offsets a0 (eq. 5 of the paper). The indicated positions of joints without a mark don't change, even if
    one motor moves several joints.

    Args:
        robot: the robot with its current offsets.
        counts: (k, n) motor positions [counts], one row for each visit of the marks. Several visits,
            each with a new approach, show the repeatability of the marks.
        marks: joint positions at the marks [rad or m], by the joints' names.

    Returns:
        The offsets, with a warning if visits differ. None, with a finding, if there is no visit or no mark,
        or if the robot doesn't have one of the joints.
    """
    rows = np.asarray(counts, dtype=np.float64).reshape(-1, robot.size)
    if not len(rows) or not marks:
        missing = "no joint has a mark" if len(rows) else "the joints weren't at their marks yet"
        return _refused("Y1901", missing, "move at least one joint to its mark")
    for name in marks:
        if name not in robot.joint_names:
            return _refused(
                "Y1905",
                f"{robot.name} has no joint {name}",
                suggest(name, robot.joint_names) or f"its joints are {', '.join(robot.joint_names)}",
            )
    read = from_counts(robot, rows)
    mean = read.mean(axis=0)
    marked = np.array([name in marks for name in robot.joint_names])
    target = np.array([marks.get(name, mean[at]) for at, name in enumerate(robot.joint_names)])
    # Solve counts = K J q + a0 for the offsets a0. K J is the matrix of counts per joint, and q are the joint
    # positions at the marks.
    offsets = rows.mean(axis=0) - counts_per_joint(robot) @ target
    spread = np.where(marked, np.abs(read - mean).max(axis=0), 0.0)
    found = OffsetCalibration(constant(offsets), constant(target - mean), constant(spread))
    share = spread / [LARGEST_SPREAD[unit] for unit in robot.axis_unit_names]
    worst = int(np.argmax(share))
    if share[worst] <= 1.0:
        return Result(found)
    unit = robot.axis_unit_names[worst]
    message = (
        f"repeated approaches to the mark of {robot.joint_names[worst]} differ by "
        f"{spread[worst] / robot.axis_units[worst]:.3f} {unit} from their mean"
    )
    return Result(
        found,
        (Diagnostic("Y1904", message, help="approach the mark from the same side each time, and slowly"),),
    )


def _refused(code: str, message: str, help_: str) -> Result[OffsetCalibration]:
    return Result(None, (Diagnostic(code, message, help=help_),))
