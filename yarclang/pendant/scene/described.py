"""Description of a stage (all that the 3D viewer draws) for pages, with the meshes of its bodies."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from yarclang.collision.scene import Scene
from yarclang.pendant.messages.scene import SceneAxes, SceneItem, SceneShown
from yarclang.pendant.scene.meshes import Blob, blob_of
from yarclang.report.solids import Solid
from yarclang.robot.model import Array
from yarclang.view import colours
from yarclang.view.bodies import shapes_beside
from yarclang.view.camera import first_view, shown_box
from yarclang.view.stage import Item, Stage

MOST_TRIANGLES = 600_000
"""Largest number of triangles of all meshes together, so that tablets can draw them. Further bodies aren't
drawn, and a note on the page says so.
"""
MOST_ITEMS = 2000
"""Largest number of bodies in a scene. Further bodies aren't drawn, and a note on the page says so."""


@dataclass(frozen=True, slots=True, eq=False)
class Drawn:
    """A scene that pages draw.

    Attributes:
        shown: message that describes the scene.
        meshes: meshes of the scene by their ids.
        near: bodies and margins for the check whether bodies are too near to each other; None if there is no
            such check.
        made: meshes by the bodies from which they were made, for reuse in the next scene.
    """

    shown: SceneShown
    meshes: Mapping[str, Blob]
    near: Scene | None
    made: Mapping[bytes, Blob]


def drawn(stage: Stage, before: Drawn | None = None) -> Drawn:
    """Convert a stage to a scene that pages draw.

    Args:
        stage: all that the 3D viewer draws of the robot at rest or of a program. For a program, this includes
            the times at which workpieces (parts) are placed or moved.
        before: the previous scene, whose meshes are reused.
    """
    drawn_items, notes = _bounded((*stage.items, *shapes_beside(stage.robot, stage.items)))
    blobs: dict[bytes, Blob] = {}
    items: list[SceneItem] = []
    for item in drawn_items:
        key = _key(item.solid)
        if key not in blobs:
            known = None if before is None else before.made.get(key)
            blobs[key] = known or blob_of(item.solid)
        items.append(_item(item, blobs[key].id))
    low, high = _box(drawn_items)
    robot_low, robot_high = shown_box(stage, whole=False)
    eye, target = first_view(stage)
    scene = SceneShown(
        version="",
        title=stage.title,
        notes=(*stage.notes, *notes),
        joints=stage.robot.joint_names,
        items=tuple(items),
        axes=tuple(
            SceneAxes(
                name=one.name,
                joint=one.joint,
                pose=_rows(one.base_from_frame),
                program=one.of_program,
                matters=one.matters,
            )
            for one in stage.axes
        ),
        tool=stage.frame,
        tool_pose=_rows(stage.robot.chain.base_from_flange @ stage.flange_from_frame),
        tool_axis=_three(_tool_axis(stage)),
        low=_three(np.minimum(low, robot_low)),
        high=_three(np.maximum(high, robot_high)),
        robot_low=_three(robot_low),
        robot_high=_three(robot_high),
        eye=_three(eye),
        target=_three(target),
        speeds=colours.RAMPS["speed"],
        ghost=colours.GHOST,
        touching=colours.TOUCHING,
        stale=colours.STALE,
    )
    version = hashlib.sha256(scene.model_dump_json().encode()).hexdigest()[:16]
    meshes = {blob.id: blob for blob in blobs.values()}
    return Drawn(scene.model_copy(update={"version": version}), meshes, stage.scene, blobs)


def _key(solid: Solid) -> bytes:
    return hashlib.sha256(solid.vertices.tobytes() + solid.faces.tobytes()).digest()


def _bounded(items: Iterable[Item]) -> tuple[tuple[Item, ...], tuple[str, ...]]:
    """Return two values: the items of a stage that are drawn, and notes about those that are left out."""
    drawn_items: list[Item] = []
    omitted: list[str] = []
    sizes: dict[int, int] = {}
    for item in items:
        size = sizes.get(id(item.solid), len(item.solid.faces))
        if len(drawn_items) >= MOST_ITEMS or sum(sizes.values()) + size > MOST_TRIANGLES:
            omitted.append(item.name)
            continue
        sizes[id(item.solid)] = size
        drawn_items.append(item)
    if not omitted:
        return tuple(drawn_items), ()
    more = f" and {len(omitted) - 3} more" if len(omitted) > 3 else ""
    note = (
        f"not drawn, since more than {MOST_TRIANGLES:,} triangles or {MOST_ITEMS} bodies would be "
        f"needed: {', '.join(omitted[:3])}{more}"
    )
    return tuple(drawn_items), (note,)


def _item(item: Item, mesh: str) -> SceneItem:
    named = item.is_named or item.kind in ("obstacle", "zone")
    return SceneItem(
        name=item.name,
        kind=item.kind,
        joint=item.joint,
        pose=_rows(item.base_from_item),
        colour=item.colour,
        opacity=item.opacity,
        mesh=mesh,
        named=named,
        begins_s=_time(item.begins),
        ends_s=_time(item.ends),
    )


def _time(value: float) -> float | None:
    return round(value, 4) if np.isfinite(value) else None


def _box(items: Iterable[Item]) -> tuple[Array, Array]:
    """Return the lower and the upper corner of a box around all bodies that no joint moves."""
    points = [np.zeros((1, 3))]
    for item in items:
        if item.joint == 0:
            turn, shift = item.base_from_item[:3, :3], item.base_from_item[:3, 3]
            points.append(item.solid.vertices @ turn.T + shift)
    every = np.concatenate(points)
    return every.min(axis=0), every.max(axis=0)


def _tool_axis(stage: Stage) -> Array:
    """Return the axis of the last joint with all joints at zero, as a unit vector (3,) in {B} that points
    towards the tool.
    """
    chain = stage.robot.chain
    axis = chain.screws[-1, 3:] if chain.screws[-1, 3:].any() else chain.screws[-1, :3]
    tool = (chain.base_from_flange @ stage.flange_from_frame)[:3, 3]
    before = [
        item.base_from_item[:3, :3] @ item.solid.vertices.mean(axis=0) + item.base_from_item[:3, 3]
        for item in stage.items
        if item.kind == "robot" and item.joint == chain.size - 1
    ]
    begin = np.mean(before, axis=0) if before else np.zeros(3)
    found: Array = -axis if float(axis @ (tool - begin)) < 0.0 else axis
    return found


def _rows(pose: Array) -> tuple[float, ...]:
    return tuple(np.round(pose[:3], 7).ravel().tolist())


def _three(values: Array) -> tuple[float, ...]:
    return tuple(np.round(values, 5).tolist())
