"""Arms for the kinematics tests, defined by numbers."""

from __future__ import annotations

import math

import numpy as np

from yarclang.robot.model import Array, Chain, Limits

JOINTS_SEED6 = [
    ((0, 0, 0.23), (0, 0, 1)),
    ((0, 0.2, 0.449), (1, 0, 0)),
    ((0, 0, 0.89), (1, 0, 0)),
    ((0, 0.4369, 0.195), (0, -1, 0)),
    ((0, 0.1995, 0), (1, 0, 0)),
    ((0, 0.238, 0), (0, -1, 0)),
]


def chain_of(joints, flange=(0.0, 0.0, 0.0), prismatic=(), rotation=None) -> Chain:
    """Return a chain that is given by its joints' origins and axes. Each origin is in the previous frame; all
    frames are parallel to {B}.
    """
    point = np.zeros(3)
    screws = []
    for index, (origin, axis) in enumerate(joints):
        point = point + np.asarray(origin, float)
        w = np.asarray(axis, float)
        w = w / np.linalg.norm(w)
        screws.append(np.r_[w, 0, 0, 0] if index in prismatic else np.r_[-np.cross(w, point), w])
    home = np.eye(4)
    home[:3, 3] = point + np.asarray(flange, float)
    if rotation is not None:
        home[:3, :3] = rotation
    return Chain(frozen(np.array(screws)), frozen(home))


def frozen(array: Array) -> Array:
    array = np.ascontiguousarray(array, dtype=float)
    array.setflags(write=False)
    return array


def limits_of(lower, upper) -> Limits:
    lower, upper = np.asarray(lower, float), np.asarray(upper, float)
    one = np.ones(len(lower))
    return Limits(frozen(lower), frozen(upper), frozen(one), frozen(one), frozen(one), frozen(one))


def degrees(*values) -> Array:
    return np.radians(np.array(values, float))


def industrial6() -> tuple[Chain, Limits]:
    """Return the arm of the paper's Fig. 5; its flange has no tool."""
    high = degrees(170, 135, 150, 190, 130, 360)
    return chain_of(JOINTS_SEED6), limits_of(-high, high)


TCP = np.eye(4)
TCP[1, 3] = 0.1


def offset6() -> tuple[Chain, Limits]:
    """Return the arm of `industrial6` with a wrist whose axes don't meet."""
    joints = list(JOINTS_SEED6)
    joints[5] = ((0.03, 0.238, 0.05), (0, -1, 0))
    high = degrees(170, 135, 150, 190, 130, 360)
    return chain_of(joints), limits_of(-high, high)


def skewed6() -> tuple[Chain, Limits]:
    """Return an arm with a spherical wrist whose axes aren't at right angles, offsets at shoulder and elbow,
    and a tilted base.
    """
    joints = [
        ((0.0, 0.0, 0.3), (0.1, 0.2, 1.0)),
        ((0.15, 0.08, 0.3), (0, 1, 0)),
        ((0.1, 0.05, 0.6), (0, -1, 0)),
        ((0.1, 0.03, 0.2), (1, 0.2, 0.1)),
        ((0.5, 0.1, 0.05), (0.2, 1, 0.3)),
        ((0.0, 0.0, 0.0), (1, 0.4, -0.2)),
    ]
    high = np.full(6, math.pi)
    return chain_of(joints, flange=(0.1, 0.02, -0.03)), limits_of(-high, high)


def scara4() -> tuple[Chain, Limits]:
    """Return a SCARA: two parallel turning joints, a sliding joint, a turning joint (R R P R)."""
    joints = [
        ((0, 0, 0.2), (0, 0, 1)),
        ((0.3, 0, 0), (0, 0, 1)),
        ((0.25, 0, 0), (0, 0, -1)),
        ((0, 0, 0), (0, 0, 1)),
    ]
    return chain_of(joints, prismatic=(2,)), limits_of([-2.5, -2.6, -0.05, -6.3], [2.5, 2.6, 0.2, 6.3])


def seven7() -> tuple[Chain, Limits]:
    """Return an arm of seven joints with a spherical shoulder and wrist."""
    z, y = (0, 0, 1), (0, 1, 0)
    joints = [
        ((0, 0, 0.36), z),
        ((0, 0, 0), y),
        ((0, 0, 0.21), z),
        ((0, 0, 0.21), y),
        ((0, 0, 0.2), z),
        ((0, 0, 0.2), y),
        ((0, 0, 0.126), z),
    ]
    high = degrees(170, 120, 170, 120, 170, 120, 175)
    return chain_of(joints), limits_of(-high, high)


def planar3() -> tuple[Chain, Limits]:
    """Return an arm of three parallel turning joints."""
    z = (0, 0, 1)
    high = np.full(3, 3.0)
    return chain_of([((0, 0, 0), z), ((0.4, 0, 0), z), ((0.3, 0, 0), z)], (0.1, 0, 0)), limits_of(-high, high)


def slider9() -> tuple[Chain, Limits]:
    """Return an arm of nine joints: an arm with a spherical shoulder on a rail, and two more
    turning joints.
    """
    x, y, z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
    joints = [
        ((0, 0, 0.1), y),
        ((0, 0, 0.2), z),
        ((0, 0.05, 0.1), x),
        ((0, 0, 0.3), z),
        ((0, 0, 0.1), x),
        ((0, 0.02, 0.3), y),
        ((0, 0.1, 0.1), x),
        ((0, 0.1, 0), y),
        ((0, 0.1, 0.03), z),
    ]
    high = np.r_[0.5, np.full(8, 2.8)]
    return chain_of(joints, flange=(0.02, 0.1, 0), prismatic=(0,)), limits_of(-high, high)


def of_dh(rows, *, modified=False) -> Chain:
    """Return a chain from Denavit-Hartenberg parameters a, alpha, d, theta at zero [m, rad], as manufacturers
    publish them. With `modified`, these are Craig's parameters, where a and alpha come first.
    """
    frame, screws = np.eye(4), []
    for a, alpha, d, theta in rows:
        across, along = np.eye(4), np.eye(4)
        across[1:3, 1:3] = [[math.cos(alpha), -math.sin(alpha)], [math.sin(alpha), math.cos(alpha)]]
        across[0, 3] = a
        along[:2, :2] = [[math.cos(theta), -math.sin(theta)], [math.sin(theta), math.cos(theta)]]
        along[2, 3] = d
        if modified:
            frame = frame @ across
        axis, point = frame[:3, 2], frame[:3, 3]
        screws.append(np.r_[-np.cross(axis, point), axis])
        frame = frame @ along if modified else frame @ along @ across
    return Chain(frozen(np.array(screws)), frozen(frame))


RIGHT = math.pi / 2
COBOTS = {
    "ur5": of_dh(
        [
            (0, RIGHT, 0.089159, 0),
            (-0.425, 0, 0, 0),
            (-0.39225, 0, 0, 0),
            (0, RIGHT, 0.10915, 0),
            (0, -RIGHT, 0.09465, 0),
            (0, 0, 0.0823, 0),
        ]
    ),
    "crx10": of_dh(
        [
            (0, 0, 0, 0),
            (0, -RIGHT, 0, 0),
            (0.54, math.pi, 0, 0),
            (0, -RIGHT, -0.54, 0),
            (0, RIGHT, 0.15, 0),
            (0, -RIGHT, -0.16, 0),
        ],
        modified=True,
    ),
    "hc10": of_dh(
        [
            (0, -RIGHT, 0.275, 0),
            (0.7, math.pi, 0, -RIGHT),
            (0, -RIGHT, 0, 0),
            (0, RIGHT, -0.5, 0),
            (0, -RIGHT, 0.162, 0),
            (0, math.pi, -0.17, 0),
        ]
    ),
    "crb15000": of_dh(
        [
            (0, -RIGHT, 0.265, 0),
            (0.444, 0, 0, -RIGHT),
            (0.11, -RIGHT, 0, 0),
            (0, RIGHT, 0.47, 0),
            (0.08, -RIGHT, 0, 0),
            (0, 0, 0.101, math.pi),
        ]
    ),
    "lite6": of_dh(
        [
            (0, -RIGHT, 0.2433, 0),
            (0.2, math.pi, 0, -RIGHT),
            (0.087, RIGHT, 0, -RIGHT),
            (0, RIGHT, 0.2276, 0),
            (0, -RIGHT, 0, 0),
            (0, 0, 0.0615, 0),
        ]
    ),
    "gen3_lite": of_dh(
        [
            (0, RIGHT, 0.2433, 0),
            (0.28, math.pi, 0.03, RIGHT),
            (0, RIGHT, 0.02, RIGHT),
            (0, RIGHT, 0.245, RIGHT),
            (0, RIGHT, 0.057, 0),
            (0, 0, 0.235, 0),
        ]
    ),
}
"""Arms of six joints, with their published parameters."""


SEVEN = {
    "iiwa14": of_dh(
        [
            (0, -RIGHT, 0.36, 0),
            (0, RIGHT, 0, 0),
            (0, RIGHT, 0.42, 0),
            (0, -RIGHT, 0, 0),
            (0, -RIGHT, 0.4, 0),
            (0, RIGHT, 0, 0),
            (0, 0, 0.126, 0),
        ]
    ),
    "panda": of_dh(
        [
            (0, 0, 0.333, 0),
            (0, -RIGHT, 0, 0),
            (0, RIGHT, 0.316, 0),
            (0.0825, RIGHT, 0, 0),
            (-0.0825, -RIGHT, 0.384, 0),
            (0, RIGHT, 0, 0),
            (0.088, RIGHT, 0.107, 0),
        ],
        modified=True,
    ),
    "xarm7": of_dh(
        [
            (0, -RIGHT, 0.267, 0),
            (0, RIGHT, 0, 0),
            (0.0525, RIGHT, 0.293, 0),
            (0.0775, RIGHT, 0, 0),
            (0, RIGHT, 0.3425, 0),
            (0.076, -RIGHT, 0, 0),
            (0, 0, 0.097, 0),
        ]
    ),
    "gen3": of_dh(
        [
            (0, RIGHT, -0.2848, 0),
            (0, RIGHT, -0.0118, 0),
            (0, RIGHT, -0.4208, 0),
            (0, RIGHT, -0.0128, 0),
            (0, RIGHT, -0.3143, 0),
            (0, RIGHT, 0, 0),
            (0, math.pi, -0.1674, 0),
        ]
    ),
}
"""Arms of seven joints, with their published parameters."""

SEVEN_LIMITS = {
    "iiwa14": degrees(170, 120, 170, 120, 170, 120, 175),
    "panda": (
        [-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973],
        [2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973],
    ),
    "xarm7": (degrees(-360, -118, -360, -11, -360, -97, -360), degrees(360, 120, 360, 225, 360, 180, 360)),
    "gen3": np.array([math.inf, 2.24, math.inf, 2.57, math.inf, 2.09, math.inf]),
}
"""Limits of the arms of seven joints [rad]: the lower and the upper ones, or one array for
both directions.
"""


def seven(name: str) -> tuple[Chain, Limits]:
    """Return an arm of seven joints and its limits."""
    high = SEVEN_LIMITS[name]
    return SEVEN[name], limits_of(*high) if isinstance(high, tuple) else limits_of(-high, high)


def on_rail(chain: Chain, upper: Array, travel: float = 1.0) -> tuple[Chain, Limits]:
    """Return an arm on a rail along x. The limits (n,) of the joints [rad] and the `travel` of the rail [m]
    apply to both directions.
    """
    rail = np.array([[1.0, 0.0, 0.0, 0.0, 0.0, 0.0]])
    high = np.r_[travel, upper]
    return Chain(frozen(np.vstack([rail, chain.screws])), chain.base_from_flange), limits_of(-high, high)


def with_turn_at_tip(chain: Chain, upper: Array) -> tuple[Chain, Limits]:
    """Return an arm with a further turning joint after its last one, with an offset and a skewed axis."""
    home = chain.base_from_flange
    axis, point = home[:3, :3] @ np.array([0.0, 0.6, 0.8]), home[:3, 3] + [0.1, 0.02, 0.1]
    screws = np.vstack([chain.screws, np.r_[-np.cross(axis, point), axis]])
    return Chain(frozen(screws), home), limits_of(-np.r_[upper, 3.0], np.r_[upper, 3.0])


def random6(rng) -> Chain:
    """Return a random arm of six turning joints. No two axes are parallel, and none meet."""
    axes = rng.normal(size=(6, 3))
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    points = np.cumsum(0.3 * rng.normal(size=(6, 3)), axis=0)
    home = np.eye(4)
    home[:3, 3] = points[-1] + 0.2 * rng.normal(size=3)
    return Chain(frozen(np.hstack([-np.cross(axes, points), axes])), frozen(home))


def parallel6(rng) -> Chain:
    """Return a random arm of six turning joints. Axes 2, 3 and 4 are parallel, in either direction; axes 5
    and 6 meet.
    """
    axes = rng.normal(size=(6, 3))
    axes[2], axes[3] = (rng.choice([-1.0, 1.0]) * axes[1] for _ in range(2))
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    points = np.cumsum(0.3 * rng.normal(size=(6, 3)), axis=0)
    points[5] = points[4] + 0.2 * axes[5]
    home = np.eye(4)
    home[:3, 3] = points[-1] + 0.1
    return Chain(frozen(np.hstack([-np.cross(axes, points), axes])), frozen(home))


def off_nominal(chain: Chain, rng, size: float) -> Chain:
    """Return a chain as if it were calibrated: each axis is off by about `size` [rad, and m]."""
    axes = chain.screws[:, 3:] + size * rng.normal(size=(6, 3))
    points = np.cross(chain.screws[:, 3:], chain.screws[:, :3]) + size * rng.normal(size=(6, 3))
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    return Chain(frozen(np.hstack([-np.cross(axes, points), axes])), chain.base_from_flange)


def on_base(travel: float = 0.3) -> tuple[Chain, Limits]:
    """Return the Panda on a base with a turning and a sliding joint, which slides by `travel` [m] in both
    directions: nine joints.
    """
    chain, limits = seven("panda")
    place = np.array([0.15, 0.0, 0.38])
    arm = np.hstack([chain.screws[:, :3] + np.cross(place, chain.screws[:, 3:]), chain.screws[:, 3:]])
    home = chain.base_from_flange.copy()
    home[:3, 3] += place
    base = np.array([[0, 0, 0, 0, 0, 1.0], [1.0, 0, 0, 0, 0, 0]])
    high = np.r_[3.1, travel, limits.upper]
    return Chain(frozen(np.vstack([base, arm])), frozen(home)), limits_of(
        np.r_[-3.1, -travel, limits.lower], high
    )


def yumi7() -> tuple[Chain, Limits]:
    """Return an arm of seven joints, similar to ABB's YuMi: no three axes meet, and no two neighbours are
    parallel.
    """
    rows = [
        (-0.03, -RIGHT, 0.1, 0),
        (0.03, RIGHT, 0.0, 0),
        (0.0405, RIGHT, 0.2515, 0),
        (0.0405, -RIGHT, 0.0, -RIGHT),
        (0.027, -RIGHT, 0.265, math.pi),
        (0.027, RIGHT, 0.0, 0),
        (0.0, 0.0, 0.036, 0),
    ]
    lower = degrees(-168.5, -143.5, -168.5, -123.5, -290, -88, -229)
    upper = degrees(168.5, 43.5, 168.5, 80, 290, 138, 229)
    return of_dh(rows), limits_of(lower, upper)


def sawyer7() -> tuple[Chain, Limits]:
    """Return an arm of seven joints, similar to Rethink's Sawyer: neighbouring axes meet, but no
    three axes.
    """
    rows = [
        (0.081, -RIGHT, 0.317, 0),
        (0, RIGHT, 0.1925, RIGHT),
        (0, -RIGHT, 0.4, 0),
        (0, RIGHT, -0.1685, 0),
        (0, -RIGHT, 0.4, 0),
        (0, RIGHT, 0.1363, 0),
        (0, 0, 0.13375, 0),
    ]
    lower, upper = (
        [-3.05, -3.81, -3.04, -3.04, -2.98, -2.98, -4.71],
        [3.05, 2.27, 3.04, 3.04, 2.98, 2.98, 4.71],
    )
    return of_dh(rows), limits_of(lower, upper)
