"""Combine the masses of a URDF's links and of tools into one body for each joint."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from yarclang.frozen import frozen
from yarclang.robot.link_shapes import link_places, placed_at
from yarclang.robot.model import Array, Chain, Dynamics, Tool
from yarclang.robot.urdf import Joint, Urdf
from yarclang.transforms import constant

GRAVITY = 9.81
"""Gravity along the negative z axis of the URDF's root, unless robot.toml sets another [m/s^2]."""


@frozen(eq=False)
class _Lump:
    """A rigid body on a link of the arm.

    Attributes:
        joint: number of the joint that moves the link, from 1.
        mass: mass [kg].
        center: (3,) centre of mass in {B} [m].
        inertia: (3, 3) inertia about the centre of mass [kg m^2].
    """

    joint: int
    mass: float
    center: Array
    inertia: Array


def dynamics_of(
    urdf: Urdf,
    ends: tuple[str, Sequence[Joint]],
    chain: Chain,
    tools: Sequence[Tool],
    said: tuple[Sequence[float | None], Sequence[float] | None, bool],
) -> Dynamics:
    """Return the masses of the arm's links and mounted tools and the efforts of its joints, as far as they
    are known.

    Args:
        urdf: a URDF without errors.
        ends: the link that is {B}, and the arm's moving joints.
        chain: the same arm as a chain.
        tools: all tools; only the mounted ones count.
        said: three values of robot.toml. The first is the effort of each joint; None for the effort in the
            URDF. The second is gravity in {B} [m/s^2]; None for gravity along negative z of the URDF's root.
            The third is True if torques are checked.
    """
    base, moving = ends
    efforts, gravity, from_toml = said
    places = link_places(urdf, moving)
    base_from_root = np.linalg.inv(places[base][0]).astype(np.float64)
    size = len(moving)
    lumps: list[list[_Lump]] = [[] for _ in range(size + 1)]
    for lump in (*_links(urdf, places, base_from_root), *_tools(tools, chain)):
        lumps[lump.joint].append(lump)
    together = [_together(each) for each in lumps[1:]]
    down = base_from_root[:3, :3] @ np.array([0.0, 0.0, -GRAVITY]) if gravity is None else np.array(gravity)
    return Dynamics(
        constant(np.array([one.mass for one in together])),
        constant(np.array([one.center for one in together]).reshape(size, 3)),
        constant(np.array([one.inertia for one in together]).reshape(size, 3, 3)),
        constant(down),
        constant(np.array([_effort(urdf, *one) for one in zip(moving, efforts, strict=True)])),
        from_toml,
    )


def _links(urdf: Urdf, places: dict[str, tuple[Array, int]], base_from_root: Array) -> Iterator[_Lump]:
    for name, link in urdf.links.items():
        inertial = link.first("inertial")
        mass = urdf.numbers(inertial.first("mass") if inertial else None, "value", 1, (0.0,))
        if inertial is None or not mass:
            continue
        root_from_link, joint = places[name]
        placed = base_from_root @ root_from_link @ placed_at(urdf, inertial.first("origin"))
        part = inertial.first("inertia")
        xx, xy, xz, yy, yz, zz = (
            (urdf.numbers(part, key, 1, (0.0,)) or (0.0,))[0]
            for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
        )
        own = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        if mass[0] == 0.0 and not own.any():
            continue
        turn = placed[:3, :3]
        yield _Lump(joint, mass[0], placed[:3, 3], turn @ own @ turn.T)


def _tools(tools: Sequence[Tool], chain: Chain) -> Iterator[_Lump]:
    flange = chain.base_from_flange
    turn = flange[:3, :3]
    for tool in tools:
        if tool.mounted and tool.mass > 0.0:
            center = turn @ tool.center + flange[:3, 3]
            yield _Lump(chain.size, tool.mass, center, turn @ tool.inertia @ turn.T)


def _together(lumps: Sequence[_Lump]) -> _Lump:
    """Combine bodies that never move relative to each other into one body."""
    mass = sum(lump.mass for lump in lumps)
    if mass == 0.0:
        return _Lump(0, 0.0, np.zeros(3), sum((lump.inertia for lump in lumps), np.zeros((3, 3))))
    center = sum((lump.mass * lump.center for lump in lumps), np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for lump in lumps:
        # parallel axis theorem; the inertia of a body without mass doesn't depend on the body's place
        away = lump.center - center
        inertia += lump.inertia + lump.mass * (away @ away * np.eye(3) - np.outer(away, away))
    return _Lump(lumps[0].joint, mass, center, inertia)


def _effort(urdf: Urdf, joint: Joint, given_effort: float | None) -> float:
    """Return a joint's effort, infinite if it isn't known. CAD exports write 0 for an unknown effort."""
    if given_effort is not None:
        return given_effort
    limit = joint.element.first("limit")
    effort = urdf.numbers(limit, "effort", 1, (0.0,)) if limit else None
    return effort[0] if effort and effort[0] > 0.0 else np.inf


def with_load(dynamics: Dynamics, mass: float, center: Array, inertia: Array) -> Dynamics:
    """Return the masses of an arm with an additional body that the last joint moves.

    Args:
        dynamics: the masses without the body.
        mass: mass of the body [kg].
        center: (3,) center of the body in {B} with all joints at zero [m].
        inertia: (3, 3) about that center, along the axes of {B} [kg m^2].
    """
    size = len(dynamics.mass)
    last = _Lump(size, float(dynamics.mass[-1]), dynamics.center[-1], dynamics.inertia[-1])
    both = _together([last, _Lump(size, mass, center, inertia)])
    return replace(
        dynamics,
        mass=constant(np.append(dynamics.mass[:-1], both.mass)),
        center=constant(np.concatenate([dynamics.center[:-1], both.center[None]])),
        inertia=constant(np.concatenate([dynamics.inertia[:-1], both.inertia[None]])),
    )
