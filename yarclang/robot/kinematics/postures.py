"""Look up joint positions that nearly reach a pose: starts of the inverse kinematics of a redundant arm.

The first and the last joint need no table. A pose gives the line of the last joint's axis. The position of
this line relative to the first axis doesn't depend on the first joint, and the last joint only turns about
the line. The table therefore varies only the joints between, and records in each row the position of the last
axis relative to the first axis. The rows that come nearest to the pose then determine the first and the last
joint.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from yarclang.frozen import frozen
from yarclang.robot.kinematics.fk import flange_poses, links_of
from yarclang.robot.kinematics.inverse import extent, restarts
from yarclang.robot.model import Array, Chain, Limits
from yarclang.transforms import sealed

ROWS = 8192
"""Number of joint positions in a table."""

SEEDS = 48
"""Number of joint positions from which the search for one pose starts."""

NEAREST = 192
"""Number of rows nearest to a pose that are considered. Of these rows, those nearest to the reference are
used.
"""

LONG = 3.0
"""The table covers sliding joints up to this distance to either side [multiples of the arm's size]."""

BEYOND = 10.0
"""Cost of a joint position whose first or last joint exceeds its limit, for each rad or m of excess [squared
joint differences].
"""


@frozen(eq=False)
class Table:
    """A table of joint positions with the first and the last joint at zero, and of the last joint's axis at
    each of them. Lengths are in units of `unit`.

    Attributes:
        q: (ROWS, n) joint positions [rad or m].
        places: (ROWS, 5) coordinates of the last axis (of a point on it, and of its direction) that don't
            depend on the first joint.
        sizes: (ROWS,) squared norms of the rows of `places`.
        bearings: (ROWS,) the one coordinate of the point that the first joint changes [rad or m].
        across: (ROWS, 3) a direction perpendicular to the last axis.
        axis: (3,) direction of the last axis in {FLANGE}.
        point: (3,) a point on the last axis in {FLANGE}.
        side: (3,) the direction `across` in {FLANGE}.
        first: (4, 4) the first joint's frame in {B}.
        turns: True if the first joint turns, False if it slides.
        unit: unit of lengths [m].
    """

    q: Array
    places: Array
    sizes: Array
    bearings: Array
    across: Array
    axis: Array
    point: Array
    side: Array
    first: Array
    turns: bool
    unit: float


def seeds_near(
    chain: Chain,
    limits: Limits,
    lower: Array,
    upper: Array,
    base_from_flange: Array,
    reference: Array,
    count: int = SEEDS,
) -> Array:
    """Return joint positions (count, n) [rad or m] from which to search for a pose. The first one is the
    reference.

    Args:
        chain: an arm with more than six joints.
        limits: its limits.
        lower: (n,) lower limits of the result [rad or m].
        upper: (n,) upper limits of the result [rad or m].
        base_from_flange: (4, 4).
        reference: (n,) [rad or m].
        count: number of joint positions, at most NEAREST + 1.
    """
    table = _table_of(chain, limits.lower.tobytes(), limits.upper.tobytes())
    if table is None:
        others = spread(chain, lower, upper, reference, count - 1)
    else:
        others = near_pose(table, lower, upper, base_from_flange, reference)[: count - 1]
    return np.vstack((reference, others))


@lru_cache(maxsize=16)
def _table_of(chain: Chain, lower: bytes, upper: bytes) -> Table | None:
    """Return an arm's table, cached by the identity of the chain and its limits.

    Return None if the first joint is a screw, if the last joint doesn't purely turn, or if another joint
    slides so far that a table would be too coarse.
    """
    links = links_of(chain)
    turns = bool(links.turn[0])
    far = np.frombuffer(upper) - np.frombuffer(lower) > 2.0 * LONG * extent(chain)
    if (far & chain.is_prismatic)[1:].any():
        return None
    if not links.turn[-1] or links.slide[-1] != 0.0 or (turns and links.slide[0] != 0.0):
        return None
    q = spread(chain, np.frombuffer(lower), np.frombuffer(upper), np.zeros(chain.size), ROWS)
    q[:, [0, -1]] = 0.0
    home = chain.base_from_flange
    turned = home[:3, :3].T
    axis = turned @ links.frames[-1, :3, 2]
    side = turned @ links.frames[-1, :3, 0]
    point = turned @ (links.frames[-1, :3, 3] - home[:3, 3])
    # the point of the axis that is nearest to the flange
    point = point - axis * (axis @ point)
    unit = 0.5 * extent(chain)
    poses = flange_poses(chain, q)
    places, bearings = _coordinates(poses, links.frames[0], turns, axis, point, unit)
    across = poses[:, :3, :3] @ side
    return Table(
        sealed(q),
        sealed(places),
        sealed(np.square(places).sum(axis=1)),
        sealed(bearings),
        sealed(across),
        axis,
        point,
        side,
        links.frames[0],
        turns,
        unit,
    )


def near_pose(table: Table, lower: Array, upper: Array, base_from_flange: Array, reference: Array) -> Array:
    """Return joint positions (NEAREST, n) [rad or m] within limits that nearly reach a pose, on the full
    turns nearest to the reference.

    Args:
        table: the arm's table.
        lower: (n,) the lower limits [rad or m].
        upper: (n,) the upper limits [rad or m].
        base_from_flange: (4, 4).
        reference: (n,) [rad or m].

    Returns:
        The rows in the order of their distance from the reference.
    """
    wanted, bearing = _coordinates(
        base_from_flange[None], table.first, table.turns, table.axis, table.point, table.unit
    )
    # squared distances of the rows from the pose, except for a constant that all rows share
    apart = table.sizes - table.places @ (2.0 * wanted[0])
    rows = np.argpartition(apart, NEAREST)[:NEAREST]
    q = table.q[rows].copy()
    # the first joint turns or slides from the row's bearing to the pose's bearing
    q[:, 0] = bearing[0] - table.bearings[rows]
    across = table.across[rows]
    if table.turns:
        across = _about(table.first[:3, 2], across, q[:, 0])
    axis, side = base_from_flange[:3, :3] @ table.axis, base_from_flange[:3, :3] @ table.side
    # the turn about the last axis that brings the direction `across` of each row to that of the pose
    q[:, -1] = -np.arctan2(across @ np.cross(axis, side), across @ side)
    turning = [0, -1] if table.turns else [-1]
    q[:, turning] += 2.0 * math.pi * np.round((reference[turning] - q[:, turning]) / (2.0 * math.pi))
    inside = np.clip(q, lower, upper)
    away = np.square(q - reference).sum(axis=1) + BEYOND * np.abs(q - inside).max(axis=1)
    q = inside
    return q[np.argsort(away, kind="stable")]


def spread(chain: Chain, lower: Array, upper: Array, about: Array, count: int) -> Array:
    """Return joint positions (count, n) [rad or m] spread evenly over limits, turning joints at most half a
    turn to either side of `about` (n,).
    """
    reach = np.where(chain.is_prismatic, LONG * extent(chain), math.pi)
    # if `about` is near a limit or beyond it, shift the interval instead of narrowing it
    about = np.clip(about, np.minimum(lower + reach, upper), np.maximum(upper - reach, lower))
    low, high = np.maximum(lower, about - reach), np.minimum(upper, about + reach)
    even = restarts(chain, count)
    even = (even - even.min(axis=0)) / np.ptp(even, axis=0)
    result: Array = low + even * (high - low)
    return result


def _coordinates(
    poses: Array, first: Array, turns: bool, axis: Array, point: Array, unit: float
) -> tuple[Array, Array]:
    """Return the coordinates of the last joint's axis, divided into those that don't depend on the first
    joint and the one that does. The latter is the bearing about the first axis or, if the first joint slides,
    the position along this axis.

    Args:
        poses: flange poses (N, 4, 4).
        first: the first joint's frame in {B} (4, 4).
        turns: True if the first joint turns, False if it slides.
        axis: the last axis in the flange (3,).
        point: a point of it in the flange (3,) [m].
        unit: unit of lengths [m].

    Returns:
        The independent coordinates (N, 5), and the dependent coordinate (N,) [rad or m].
    """
    # Point and direction of the last axis in the frame of the first joint.
    place = (poses[:, :3, :3] @ point + poses[:, :3, 3] - first[:3, 3]) @ first[:3, :3]
    way = (poses[:, :3, :3] @ axis) @ first[:3, :3]
    # a sliding first joint changes only the coordinate along its axis
    if not turns:
        return np.column_stack((place[:, :2] / unit, way)), place[:, 2].copy()
    # in cylinder coordinates about the first axis, a turning first joint changes only the bearing
    bearing = np.arctan2(place[:, 1], place[:, 0])
    sin, cos = np.sin(bearing), np.cos(bearing)
    radius = np.hypot(place[:, 0], place[:, 1])
    return (
        np.column_stack(
            (
                radius / unit,
                place[:, 2] / unit,
                way[:, 2],
                cos * way[:, 0] + sin * way[:, 1],
                cos * way[:, 1] - sin * way[:, 0],
            )
        ),
        bearing,
    )


def _about(axis: Array, vectors: Array, angle: Array) -> Array:
    """Return vectors (N, 3) turned about a unit axis (3,) by angles (N,) [rad], by Rodrigues' formula."""
    sin, cos = np.sin(angle)[:, None], np.cos(angle)[:, None]
    result: Array = (
        cos * vectors + sin * np.cross(axis, vectors) + (1.0 - cos) * (vectors @ axis)[:, None] * axis
    )
    return result
