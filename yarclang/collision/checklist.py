"""Check the bodies of a robot for `yarc robot check`: report bodies without shapes, and bodies that always
touch.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from yarclang.collision.geometry import UnreadableError
from yarclang.collision.placing import distances, place, relative
from yarclang.collision.scene import Scene, geometries, scene_of
from yarclang.robot.checklist.item import Item, listed
from yarclang.robot.kinematics.search import within
from yarclang.robot.model import Array, Robot
from yarclang.shapes import Mesh

POSITIONS = 200
"""Number of joint positions, spread over the limits, at which links are checked."""
OFTEN = 0.9
"""Fraction of the positions above which two touching links are reported: their shapes are too large, or the
links are joined.
"""
MOSTLY = 0.5
"""The fraction that replaces `OFTEN` for links that also touch in HOME."""


def body_items(robot: Robot) -> Iterator[Item]:
    """Yield the items of the report about links and tools with shapes, and about shapes that touch."""
    yield from _tools(robot)
    if not robot.shapes:
        found = "no link has a collision shape, so no collision of the robot is checked"
        yield Item("bodies", "note", found, "add <collision> with simple shapes to the URDF")
        return
    made = scene_of(robot, None)
    if made.value is None:
        yield from (Item(one.code, "to do", one.message, one.help) for one in made.diagnostics)
        return
    scene = made.value
    links = list(dict.fromkeys(one.link for one in robot.shapes))
    yield Item("bodies", "ok", f"{len(robot.shapes)} shapes on {len(links)} links: {listed(links)}")
    flat = flat_meshes(robot)
    if flat:
        remedy = "give the link or tool a <box>, or a mesh with its real thickness"
        yield Item(
            "flat meshes", "to do", f"{listed(flat)}, so the collision check ignores its thickness", remedy
        )
    touch = touching(scene, within(robot.chain, robot.limits, POSITIONS))
    always = _always(scene, robot, touch)
    if always:
        found = (
            f"{listed([' and '.join(pair) for pair in always])} touch in HOME, or in more than {OFTEN:.0%} "
            f"of {POSITIONS} positions"
        )
        found += "; links that touch in HOME aren't checked against each other" if scene.at_home else ""
        pairs = ", ".join(f'["{one}", "{other}"]' for one, other in always)
        remedy = (
            f"if they can't collide in reality, write [collision] allowed = [{pairs}] into robot.toml; "
            "otherwise make their shapes smaller, or choose another HOME"
        )
        yield Item("touching links", "to do", found, remedy)
    else:
        yield Item("touching links", "ok", "no links touch all the time, except neighbours, which may")
    free = float((~touch.any(axis=1)).mean())
    yield Item(
        "self-collision", "ok", f"the robot doesn't touch itself in {free:.0%} of {POSITIONS} positions"
    )


def flat_meshes(robot: Robot) -> tuple[str, ...]:
    """Return a clause for the report about each mesh of a link or mounted tool that is flat; no clauses if
    some mesh can't be read.
    """
    if scene_of(robot, None).value is None:
        return ()
    named = [(one.link, one.shape) for one in robot.shapes]
    named += [(tool.name, part.shape) for tool in robot.tools if tool.mounted for part in tool.shapes]
    return tuple(
        f"the mesh {shape.path.name} of {name} is flat"
        for name, shape in named
        if isinstance(shape, Mesh) and _is_flat(shape)
    )


def _is_flat(shape: Mesh) -> bool:
    made = geometries(shape, True)
    return not isinstance(made, UnreadableError) and any(one.is_hollow for one in made)


def touching_pairs(robot: Robot) -> tuple[tuple[tuple[str, str], str], ...]:
    """Return the pairs of bodies, by name, that seem to touch in all positions, each with the reason.

    The result is empty if a mesh can't be read. Bodies that touch in HOME and seldom elsewhere may really
    collide: HOME is then badly chosen, and the pair isn't returned.
    """
    # Use all pairs, including those that touch in HOME.
    scene = scene_of(robot, None, lenient=False).value
    if scene is None or not len(scene.pairs.first):
        return ()
    touch = touching(scene, within(robot.chain, robot.limits, POSITIONS))
    here = touching(scene, robot.home[None])[0]
    shares = _by_names(scene, touch)
    home = {scene.names(int(pair)) for pair in np.flatnonzero(here)}
    found = []
    for pair, share in sorted(shares.items()):
        if share > (MOSTLY if pair in home else OFTEN):
            where = "in HOME and in" if pair in home else "in"
            found.append((pair, f"touch {where} {share:.0%} of {POSITIONS} positions"))
    return tuple(found)


def _by_names(scene: Scene, touch: NDArray[np.bool_]) -> dict[tuple[str, str], float]:
    """Return the fraction of the P joint positions at which two bodies touch, by the names of both.

    `touch` (P, K) is True where a pair of shapes touches. A body may have several shapes.
    """
    rows: dict[tuple[str, str], NDArray[np.bool_]] = {}
    for pair in range(len(scene.pairs.first)):
        names = scene.names(pair)
        rows[names] = rows[names] | touch[:, pair] if names in rows else touch[:, pair]
    return {names: float(row.mean()) for names, row in rows.items()}


def _tools(robot: Robot) -> Iterator[Item]:
    for tool in robot.tools:
        shapes = f"{len(tool.shapes)} shape{'s' * (len(tool.shapes) != 1)}"
        mass = f", {tool.mass:g} kg" if tool.mass else ""
        if not tool.mounted:
            yield Item(
                "tools",
                "note",
                f"{tool.name} isn't mounted, so it is ignored by all checks",
                "mounted = true puts it on the flange",
            )
        elif not tool.shapes:
            found = f"{tool.name} has no shape{mass}, so its collisions aren't checked"
            yield Item("tools", "note", found, 'add [[bodies]] with tool = "..." and a shape')
        else:
            yield Item("tools", "ok", f"{tool.name}: {shapes}{mass}")


def _always(scene: Scene, robot: Robot, touch: NDArray[np.bool_]) -> list[tuple[str, str]]:
    """Return the names of the pairs of bodies that touch in HOME or nearly everywhere."""
    often = [names for names, share in _by_names(scene, touch).items() if share > OFTEN]
    here = [scene.names(int(pair)) for pair in np.flatnonzero(touching(scene, robot.home[None])[0])]
    return sorted(scene.at_home | set(often) | set(here))


def touching(scene: Scene, q: Array) -> NDArray[np.bool_]:
    """Return a mask (P, K) of the pairs of bodies that touch at joint positions `q` (P, n)."""
    return apart(scene, q) <= 0.0


def apart(scene: Scene, q: Array) -> Array:
    """Return the distances of all pairs of bodies at joint positions `q` (P, n), as (P, K) [m]; zero or less
    where they touch.
    """
    count, pairs = len(q), len(scene.pairs.first)
    at, pair = np.repeat(np.arange(count), pairs), np.tile(np.arange(pairs), count)
    found: Array = distances(scene, pair, relative(place(scene, q), at, pair))
    return found.reshape(count, pairs)
