"""What `yarc robot check` says of a robot's bodies: whether they are there, and which links always touch."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from yarclang.collision.placing import distances, place, relative
from yarclang.collision.scene import Scene, scene_of
from yarclang.robot.checklist.item import Item, listed
from yarclang.robot.kinematics.search import within
from yarclang.robot.model import Array, Robot

POSITIONS = 200
"""Joint positions, spread over the limits, at which links are looked at."""
OFTEN = 0.9
"""Links that touch in more of them than this share are drawn too large, or are joined."""


def body_items(robot: Robot) -> Iterator[Item]:
    """Links with shapes, and those that touch."""
    if not robot.shapes:
        found = "no link has a collision shape: nothing is checked for collisions"
        yield Item("bodies", "note", found, "add <collision> with simple shapes to the URDF")
        return
    made = scene_of(robot, None)
    if made.value is None:
        yield from (Item(one.code, "to do", one.message, one.help) for one in made.diagnostics)
        return
    scene = made.value
    links = dict.fromkeys(body.name for body in scene.bodies)
    yield Item("bodies", "ok", f"{len(scene.bodies)} shapes on {len(links)} links: {listed(list(links))}")
    touch = _touching(scene, within(robot.chain, robot.limits, POSITIONS))
    often = [scene.names(int(pair)) for pair in np.flatnonzero(touch.mean(axis=0) > OFTEN)]
    always = sorted(scene.at_home | set(often))
    if always:
        found = f"{listed([' and '.join(pair) for pair in always])} touch in HOME, or in more than {OFTEN:.0%} of {POSITIONS} positions"
        found += "; those that touch in HOME aren't checked against each other" if scene.at_home else ""
        pairs = ", ".join(f'["{one}", "{other}"]' for one, other in always)
        remedy = (
            f"if they can't harm each other, write into robot.toml: [collision] allowed = [{pairs}]; else make "
            "their shapes smaller"
        )
        yield Item("touching links", "to do", found, remedy)
    else:
        yield Item("touching links", "ok", "none touch all the time, but for neighbours, which may")
    free = float((~touch.any(axis=1)).mean())
    yield Item(
        "self-collision", "ok", f"the robot doesn't touch itself in {free:.0%} of {POSITIONS} positions"
    )


def _touching(scene: Scene, q: Array) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """Which pairs touch (P, K) at joint positions `q` (P, n)."""
    count, pairs = len(q), len(scene.first)
    at, pair = np.repeat(np.arange(count), pairs), np.tile(np.arange(pairs), count)
    apart = distances(scene, pair, relative(place(scene, q), at, pair))
    return apart.reshape(count, pairs) <= 0.0
