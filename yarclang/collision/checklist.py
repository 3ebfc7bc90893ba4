"""What `yarc robot check` says of a robot's bodies: whether they are there, and which of them always touch."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

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
    """Links and tools with shapes, and those that touch."""
    yield from _tools(robot)
    if not robot.shapes:
        found = "no link has a collision shape: nothing is checked for collisions"
        yield Item("bodies", "note", found, "add <collision> with simple shapes to the URDF")
        return
    made = scene_of(robot, None)
    if made.value is None:
        yield from (Item(one.code, "to do", one.message, one.help) for one in made.diagnostics)
        return
    scene = made.value
    links = list(dict.fromkeys(one.link for one in robot.shapes))
    yield Item("bodies", "ok", f"{len(robot.shapes)} shapes on {len(links)} links: {listed(links)}")
    touch = _touching(scene, within(robot.chain, robot.limits, POSITIONS))
    always = _always(scene, robot, touch)
    if always:
        found = f"{listed([' and '.join(pair) for pair in always])} touch in HOME, or in more than {OFTEN:.0%} of {POSITIONS} positions"
        found += "; links that touch in HOME aren't checked against each other" if scene.at_home else ""
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


def touching_pairs(robot: Robot) -> tuple[tuple[tuple[str, str], str], ...]:
    """The pairs of bodies, by name, that touch in HOME or nearly everywhere, and which of both; none where a mesh can't be read."""
    scene = scene_of(robot, None).value
    if scene is None or not len(scene.first) + len(scene.at_home):
        return ()
    touch = _touching(scene, within(robot.chain, robot.limits, POSITIONS))
    often = {scene.names(int(pair)) for pair in np.flatnonzero(touch.mean(axis=0) > OFTEN)}
    always = _always(scene, robot, touch)
    everywhere = f"touch in more than {OFTEN:.0%} of {POSITIONS} positions"
    return tuple((pair, everywhere if pair in often else "touch in HOME") for pair in always)


def _tools(robot: Robot) -> Iterator[Item]:
    for tool in robot.tools:
        shapes = f"{len(tool.shapes)} shape{'s' * (len(tool.shapes) != 1)}"
        mass = f", {tool.mass:g} kg" if tool.mass else ""
        if not tool.mounted:
            yield Item(
                "tools",
                "note",
                f"{tool.name} isn't mounted: nothing is checked with it",
                "mounted = true puts it on the flange",
            )
        elif not tool.shapes:
            found = f"{tool.name} has no shape{mass}: nothing is checked for collisions with it"
            yield Item("tools", "note", found, 'add [[bodies]] with tool = "..." and a shape')
        else:
            yield Item("tools", "ok", f"{tool.name}: {shapes}{mass}")


def _always(scene: Scene, robot: Robot, touch: NDArray[np.bool_]) -> list[tuple[str, str]]:
    """The pairs that touch in HOME or nearly everywhere."""
    often = [scene.names(int(pair)) for pair in np.flatnonzero(touch.mean(axis=0) > OFTEN)]
    here = [scene.names(int(pair)) for pair in np.flatnonzero(_touching(scene, robot.home[None])[0])]
    return sorted(scene.at_home | set(often) | set(here))


def _touching(scene: Scene, q: Array) -> NDArray[np.bool_]:
    """Which pairs touch (P, K) at joint positions `q` (P, n)."""
    count, pairs = len(q), len(scene.first)
    at, pair = np.repeat(np.arange(count), pairs), np.tile(np.arange(pairs), count)
    apart = distances(scene, pair, relative(place(scene, q), at, pair))
    return apart.reshape(count, pairs) <= 0.0
