"""The offsets a0 of the motors, from joints that were brought to their marks."""

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
"""Visits of one mark that differ by more than this are told."""


@frozen(eq=False)
class OffsetCalibration:
    """Offsets that were found.

    `offsets` (n,) [counts] are a0 of all motors. `shift` (n,) [rad or m] says by how much each joint's position reads higher than before;
    `spread` (n,) [rad or m] is the largest distance of a visit of the mark from the mean of all, zero for a single one and for joints that weren't brought to a mark.
    """

    offsets: Array
    shift: Array
    spread: Array


def find_offsets(
    robot: Robot, counts: Sequence[Array] | Array, marks: Mapping[str, float]
) -> Result[OffsetCalibration]:
    """The offsets with which the joints read what their marks say.

    counts = K J q + a0 (the paper's eq. 5). Joints without a mark keep the positions that they read today, also where a motor follows several joints.

    Args:
        robot: with the offsets that it has today.
        counts: (k, n) motor positions [counts], one row a visit of the marks; several visits, each approached anew, show how well the marks repeat.
        marks: the joint position [rad or m] at the mark, by the joint's name.

    Returns:
        None, with a finding, for no visit, no mark or a joint that the robot doesn't have. A warning where visits differ.
    """
    rows = np.asarray(counts, dtype=np.float64).reshape(-1, robot.size)
    if not len(rows) or not marks:
        missing = "no joint has a mark" if len(rows) else "the joints weren't at their marks yet"
        return _refused("Y1901", missing, "bring at least one joint to its mark")
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
    offsets = rows.mean(axis=0) - counts_per_joint(robot) @ target
    spread = np.where(marked, np.abs(read - mean).max(axis=0), 0.0)
    found = OffsetCalibration(constant(offsets), constant(target - mean), constant(spread))
    share = spread / [LARGEST_SPREAD[unit] for unit in robot.axis_unit_names]
    worst = int(np.argmax(share))
    if share[worst] <= 1.0:
        return Result(found)
    unit = robot.axis_unit_names[worst]
    message = f"the visits of the mark of {robot.joint_names[worst]} differ by {spread[worst] / robot.axis_units[worst]:.3f} {unit} from their mean"
    return Result(
        found,
        (Diagnostic("Y1904", message, help="approach the mark from the same side each time, and slowly"),),
    )


def _refused(code: str, message: str, help_: str) -> Result[OffsetCalibration]:
    return Result(None, (Diagnostic(code, message, help=help_),))
