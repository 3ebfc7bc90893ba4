"""Compute which parts of the workspace an arm's flange can reach, and in how many orientations it reaches
each of them. The result is shown as a picture, which reveals mistakes in a robot's description.
"""

from __future__ import annotations

import numpy as np

from yarclang.frozen import frozen
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.robot.kinematics.search import within
from yarclang.robot.model import Array, Robot

CELLS = 32
"""Number of cells along each side of a section."""

TRIED = 300_000
"""Number of joint positions within limits, spread evenly. The flange poses of these joint positions are used
instead of inverse kinematics, whose time depends on the arm.
"""


@frozen(eq=False)
class Held:
    """A section through the workspace, divided into cells. Each cell has the fraction of all orientations
    that the flange can have in this cell.

    Attributes:
        axes: names of the horizontal and of the vertical axis.
        across: (CELLS + 1,) edges of the columns of cells, along the horizontal axis [m].
        up: (CELLS + 1,) edges of the rows of cells, along the vertical axis [m].
        share: (CELLS, CELLS) fraction of the 24 orientations of a cube, from 0 to 1; NaN for cells that the
            flange didn't reach. Each flange pose counts for the nearest of these orientations.
    """

    axes: tuple[str, str]
    across: Array
    up: Array
    share: Array


def sections(robot: Robot) -> tuple[Held, Held]:
    """Return two sections of the workspace: the side view (distance from the z axis of {B}, and z), and the
    top view (x and y).

    In the top view, orientations are relative to {B}. In the side view, they are relative to a frame that
    turns about z so that its x axis points from the z axis to the flange. If the arm's first joint turns
    about z, its position makes no difference to the side view. The side view then represents the whole
    workspace.
    """
    poses = flange_poses(robot.chain, within(robot.chain, robot.limits, TRIED))
    x, y, z = poses[:, :3, 3].T
    around = np.arctan2(y, x)
    turned = poses[:, :3, :3].copy()
    turned[:, 0] = np.cos(around)[:, None] * poses[:, 0, :3] + np.sin(around)[:, None] * poses[:, 1, :3]
    turned[:, 1] = np.cos(around)[:, None] * poses[:, 1, :3] - np.sin(around)[:, None] * poses[:, 0, :3]
    return (
        _section(("from the z axis", "z"), np.hypot(x, y), z, turned),
        _section(("x", "y"), x, y, poses[:, :3, :3]),
    )


def _section(axes: tuple[str, str], across: Array, up: Array, turns: Array) -> Held:
    from scipy.spatial.transform import Rotation

    cube = Rotation.create_group("O").as_matrix()
    # the nearest orientation C of the cube has the smallest angle from R, and so the largest trace of RᵀC
    nearest = np.argmax(turns.reshape(-1, 9) @ cube.reshape(-1, 9).T, axis=1)
    edges = [np.linspace(values.min() - 1e-9, values.max() + 1e-9, CELLS + 1) for values in (across, up)]
    column, row = (
        np.clip(np.searchsorted(edge, values) - 1, 0, CELLS - 1)
        for edge, values in zip(edges, (across, up), strict=True)
    )
    seen = np.zeros((CELLS, CELLS, len(cube)), dtype=bool)
    seen[row, column, nearest] = True
    share = seen.mean(axis=2)
    return Held(axes, edges[0], edges[1], np.where(share > 0.0, share, np.nan))
