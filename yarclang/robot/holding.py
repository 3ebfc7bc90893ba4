"""Compute for a picture where in the workspace an arm can place its flange, and in how many orientations. The
picture reveals mistakes in a robot's description.
"""

from __future__ import annotations

import numpy as np

from yarclang.frozen import frozen
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.robot.kinematics.search import within
from yarclang.robot.model import Array, Robot

CELLS = 32
"""Cells along each side of a section."""

TRIED = 300_000
"""Number of joint positions within limits, spread evenly. Sampling takes the same time for any arm; solving
poses doesn't.
"""


@frozen(eq=False)
class Held:
    """For each cell of a section through the workspace, the share of orientations in which the flange can be
    there.

    `share` (CELLS, CELLS) is from 0 to 1, and NaN for cells that the flange never reached. It is counted in
    the 24 orientations of a cube: each flange pose counts for the nearest of these. The rows of `share` run
    along `up`, its columns along `across`; both are the edges (CELLS + 1,) of the cells [m] in {B}.
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
    about z, all its positions therefore give the same side view, and the side view shows everything.
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
    nearest = np.argmax(turns.reshape(-1, 9) @ cube.reshape(-1, 9).T, axis=1)  # the largest trace of R' C
    edges = [np.linspace(values.min() - 1e-9, values.max() + 1e-9, CELLS + 1) for values in (across, up)]
    column, row = (
        np.clip(np.searchsorted(edge, values) - 1, 0, CELLS - 1)
        for edge, values in zip(edges, (across, up), strict=True)
    )
    seen = np.zeros((CELLS, CELLS, len(cube)), dtype=bool)
    seen[row, column, nearest] = True
    share = seen.mean(axis=2)
    return Held(axes, edges[0], edges[1], np.where(share > 0.0, share, np.nan))
