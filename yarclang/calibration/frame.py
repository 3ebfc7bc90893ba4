"""Calibrate a frame from touches of its origin, of a point on its x axis, and of points of its x-y plane."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from yarclang.diagnostics import Diagnostic, Result
from yarclang.frozen import frozen
from yarclang.robot.model import Array
from yarclang.transforms import constant
from yarclang.units import DEG, MM

LEAST_LENGTH = 10.0 * MM
"""Least distance of a point from the origin [m]. A nearer point gives no accurate direction."""
LEAST_ANGLE = 5.0 * DEG
"""Least angle between the x axis and the direction from the origin to a point of the plane [rad]."""
LARGEST_HEIGHT = 0.5 * MM
"""Distance of a point from the plane above which a warning is given [m]."""


@frozen(eq=False)
class FrameCalibration:
    """A calibrated frame.

    Attributes:
        base_from_frame: (4, 4) pose of the frame [m].
        heights: (k,) signed distances of all points from its x-y plane, in the order of the points [m]; zero
            for three points, which are always in a plane.
    """

    base_from_frame: Array
    heights: Array


def find_frame(origin: Array, on_x: Array, on_plane: Sequence[Array]) -> Result[FrameCalibration]:
    """Compute a frame from its origin, a point on its x axis, and points of its x-y plane.

    Args:
        origin: (3,) origin of the frame, in {B} [m].
        on_x: (3,) a point on the positive x axis, in {B} [m].
        on_plane: one or more points (3,) of the x-y plane with y > 0, in {B} [m]. With more than one,
            the plane is the best fit through the origin (least squares of the distances of all points),
            and the x axis is the projection of the direction to `on_x`.

    Returns:
        The frame, with a warning if the points aren't in a plane. None, with a finding, if points are too
        near to each other or on a line.
    """
    names = ["the point on x", *(f"point {number} of the plane" for number in range(1, len(on_plane) + 1))]
    if not on_plane:
        return _refused(
            "Y1901", "no point of the plane was touched", "touch a point of the x-y plane on the side of y"
        )
    along = np.array([on_x, *on_plane], dtype=np.float64) - origin
    lengths = np.linalg.norm(along, axis=1)
    if lengths.min() < LEAST_LENGTH:
        name = names[int(np.argmin(lengths))]
        message = (
            f"{name} is {lengths.min() / MM:.1f} mm from the origin, but at least {LEAST_LENGTH / MM:g} mm "
            "are needed"
        )
        return _refused(
            "Y1903",
            message,
            "touch points as far apart as the workpiece allows: an error of 0.1 mm rotates the frame by "
            "0.1 mm divided by their distance",
        )
    sines = np.linalg.norm(np.cross(along[0], along[1:]), axis=1) / (lengths[0] * lengths[1:])
    angles = np.arcsin(np.clip(sines, 0.0, 1.0))
    if angles.max() < LEAST_ANGLE:
        message = (
            "the points are nearly in a line: their directions from the origin differ by "
            f"{angles.max() / DEG:.1f} deg"
        )
        return _refused("Y1903", message, "touch a point farther from the x axis")
    first = int(np.argmax(angles)) + 1
    upwards = np.cross(along[0], along[first])
    # Total least squares: the best plane through the origin has as normal the direction of the smallest
    # singular value. The sign is chosen such that the frame is right-handed.
    *_, directions = np.linalg.svd(along)
    z = directions[2] * (1.0 if directions[2] @ upwards > 0 else -1.0)
    x = along[0] - (along[0] @ z) * z
    x /= np.linalg.norm(x)
    y = np.cross(z, x)
    wrong = np.flatnonzero(along[1:] @ y <= 0.0)
    if len(wrong):
        return _refused(
            "Y1903",
            f"{names[wrong[0] + 1]} lies on the other side of the x axis than {names[first]}",
            "touch all points of the plane on the side of y",
        )
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = np.column_stack((x, y, z)), origin
    heights = np.concatenate(([0.0], along @ z))
    found = FrameCalibration(constant(pose), constant(heights))
    if np.abs(heights).max() <= LARGEST_HEIGHT:
        return Result(found)
    worst = int(np.argmax(np.abs(heights)))
    message = f"the points aren't in a plane: {names[worst - 1]} is {heights[worst] / MM:.2f} mm off"
    return Result(
        found, (Diagnostic("Y1904", message, help="touch it again, or check if the surface is flat"),)
    )


def _refused(code: str, message: str, help_: str) -> Result[FrameCalibration]:
    return Result(None, (Diagnostic(code, message, help=help_),))
