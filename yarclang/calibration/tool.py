"""Calibrate the tip of a tool (TCP): the four-point method, in which the tip touches one fixed point in
several poses.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from yarclang.calibration.spread import tip_information, touch_error
from yarclang.diagnostics import Diagnostic, Result
from yarclang.frozen import frozen
from yarclang.robot.model import Array
from yarclang.transforms import constant
from yarclang.units import DEG, MM

FEWEST_TOUCHES = 4
LEAST_TILT = 15.0 * DEG
"""Least angle [rad] by which each direction of the tool must change between touches. The direction that
changes least is checked.
"""
LARGEST_MISS = 1.0 * MM
"""Distance between tip and fixed point at a touch above which a warning is given [m]."""


@frozen(eq=False)
class TipCalibration:
    """A calibrated tool tip.

    Attributes:
        flange_from_tip: (3,) the tip in {FLANGE} [m].
        fixed: (3,) the touched point in {B} [m].
        misses: (k,) distance of the tip from the touched point in each pose [m].
        uncertainty: (3,) extent of the uncertainty ellipsoid along x, y and z of {FLANGE} [m]; it
            contains the true tip in 95 of 100 calibrations.
        error: error of one touch, estimated from the misses [m].
    """

    flange_from_tip: Array
    fixed: Array
    misses: Array
    uncertainty: Array
    error: float

    @property
    def worst(self) -> int:
        """Index of the touch with the largest distance from the point."""
        return int(np.argmax(self.misses))


def find_tip(base_from_flange: Sequence[Array] | Array) -> Result[TipCalibration]:
    """Compute the position of a tool tip that has touched one fixed point in several poses.

    Each pose gives R p + t = c, with the tip p in {FLANGE} and the point c in {B}. These linear equations are
    solved for p and c by least squares.

    Args:
        base_from_flange: k poses (4, 4) of the flange [m], at least four.

    Returns:
        The tip, with a warning if the poses contradict each other. None, with a finding, if there are too few
        poses, or if they are too similar.
    """
    poses = np.asarray(base_from_flange, dtype=np.float64).reshape(-1, 4, 4)
    count = len(poses)
    if count < FEWEST_TOUCHES:
        message = f"{count} touches of the point, but at least {FEWEST_TOUCHES} are needed"
        return _refused("Y1901", message, "touch the same point again, with another orientation of the tool")
    rotation, place = poses[:, :3, :3], poses[:, :3, 3]
    lean, axis = _least_tilt(rotation)
    if lean < LEAST_TILT:
        along = " ".join(f"{value:.2f}" for value in axis)
        message = (
            f"the tool's direction {along} (in {{FLANGE}}) was the same within {lean / DEG:.1f} deg in all "
            "touches, so the tip's position along it can't be computed"
        )
        return _refused(
            "Y1902",
            message,
            f"tilt the tool by {LEAST_TILT / DEG:g} deg or more in several directions between the touches",
        )
    # Three equations R p - c = -t for each touch, with the unknowns p and c.
    matrix = np.concatenate([np.concatenate(rotation), -np.tile(np.eye(3), (count, 1))], axis=1)
    solution, *_ = np.linalg.lstsq(matrix, -place.reshape(-1), rcond=None)
    errors = (matrix @ solution + place.reshape(-1)).reshape(-1, 3)
    misses = np.linalg.norm(errors, axis=1)
    error = touch_error(float(np.sum(errors**2)), 3 * count - 6)
    spread = np.sqrt(np.diagonal(np.linalg.inv(tip_information(rotation, error))))
    tip, fixed = solution[:3], solution[3:]
    found = TipCalibration(constant(tip), constant(fixed), constant(misses), constant(spread), error)
    if misses.max() <= LARGEST_MISS:
        return Result(found)
    message = (
        f"the touches disagree: touch {found.worst + 1} by {misses.max() / MM:.2f} mm, all of them by "
        f"{np.sqrt(np.mean(misses**2)) / MM:.2f} mm (rms)"
    )
    help_ = f"repeat touch {found.worst + 1}; if that doesn't help, check the arm's zeros and its geometry"
    return Result(found, (Diagnostic("Y1904", message, help=help_),))


def _least_tilt(rotation: Array) -> tuple[float, Array]:
    """Return the direction on the flange that changes least between the given orientations, and its change.

    Args:
        rotation: (k, 3, 3) orientations.

    Returns:
        The largest angle between the images in {B} of this direction in two orientations [rad], and the
        direction (3,) in {FLANGE}.
    """
    apart = rotation - rotation.mean(axis=0)
    # The direction of the smallest singular value has the images that differ least, in the sum of squares.
    *_, directions = np.linalg.svd(np.concatenate(apart))
    axis: Array = directions[-1] * np.sign(directions[-1][np.argmax(np.abs(directions[-1]))])
    images = rotation @ axis
    return float(np.arccos(np.clip((images @ images.T).min(), -1.0, 1.0))), axis


def _refused(code: str, message: str, help_: str) -> Result[TipCalibration]:
    return Result(None, (Diagnostic(code, message, help=help_),))
