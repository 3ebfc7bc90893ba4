"""A frame from points that were touched: its origin, a point on its x axis, and points of its plane on the side of y."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from yarclang.diagnostics import Diagnostic, Result
from yarclang.frozen import frozen
from yarclang.robot.model import Array
from yarclang.transforms import constant
from yarclang.units import DEG, MM

LEAST_LENGTH = 10.0 * MM
"""Points nearer to each other than this give no direction worth having."""
LEAST_ANGLE = 5.0 * DEG
"""Between the x axis and the direction to a point of the plane."""
LARGEST_HEIGHT = 0.5 * MM
"""Points off the plane by more than this are told."""


@frozen(eq=False)
class FrameCalibration:
    """A frame that was found: `base_from_frame` (4, 4) [m].

    `heights` (k,) [m] are the signed distances of all points from its x-y plane, in the order given: zero for three points, which any plane holds.
    """

    base_from_frame: Array
    heights: Array


def find_frame(origin: Array, on_x: Array, on_plane: Sequence[Array]) -> Result[FrameCalibration]:
    """The frame with this origin, whose x axis points to `on_x` and whose y axis to the side of the points of the plane.

    Args:
        origin: (3,) in {B} [m].
        on_x: (3,) a point on the x axis, on its positive side.
        on_plane: one or more points (3,) of the x-y plane with y above zero. With more than one the plane is the one that fits all points best
            (least squares of their distances) and goes through the origin; x is the direction to `on_x` in it.

    Returns:
        None, with a finding, where points are too near to each other or in a line. A warning where they aren't in a plane.
    """
    names = ["the point on x", *(f"point {number} of the plane" for number in range(1, len(on_plane) + 1))]
    if not on_plane:
        return _refused(
            "Y1901", "no point of the plane is there", "touch a point of the x-y plane on the side of y"
        )
    along = np.array([on_x, *on_plane], dtype=np.float64) - origin
    lengths = np.linalg.norm(along, axis=1)
    if lengths.min() < LEAST_LENGTH:
        name = names[int(np.argmin(lengths))]
        message = (
            f"{name} is {lengths.min() / MM:.1f} mm from the origin; {LEAST_LENGTH / MM:g} mm are the least"
        )
        return _refused(
            "Y1903",
            message,
            "touch points as far apart as the workpiece allows: an error of 0.1 mm turns the frame by 0.1 mm through their distance",
        )
    sines = np.linalg.norm(np.cross(along[0], along[1:]), axis=1) / (lengths[0] * lengths[1:])
    angles = np.arcsin(np.clip(sines, 0.0, 1.0))
    if angles.max() < LEAST_ANGLE:
        message = (
            f"the points are in a line: seen from the origin they are {angles.max() / DEG:.1f} deg apart"
        )
        return _refused("Y1903", message, "touch a point well beside the x axis")
    first = int(np.argmax(angles)) + 1
    upwards = np.cross(along[0], along[first])
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
        found, (Diagnostic("Y1904", message, help="touch it again, or look whether the surface is flat"),)
    )


def _refused(code: str, message: str, help_: str) -> Result[FrameCalibration]:
    return Result(None, (Diagnostic(code, message, help=help_),))
