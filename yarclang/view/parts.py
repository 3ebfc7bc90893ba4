"""The parts of a cell as they are to be seen: where each one lies or hangs, from when to when, and the bodies of the collision check then."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from yarclang.cell.model import Cell, Parts
from yarclang.cell.model import Item as Placed
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.executed import Executed
from yarclang.report.carried import Carried, State, begins_in_text
from yarclang.robot.model import Robot
from yarclang.view import colours
from yarclang.view.solids import Solid, solid_of
from yarclang.view.stage import Item, Scenes, Stage

SURE, UNSURE = 1.0, 0.45
"""How opaque a part is, and one that may be elsewhere."""
_NAMED = 8
"""If there are more parts of a kind, those that were put down have no names in the picture: they stand too close together."""


@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """From `begins` on [s], the parts are as in a state."""

    begins: float
    state: State


@dataclass(frozen=True, slots=True, eq=False)
class ShownParts:
    """The bodies of the parts, the bodies of the collision check over time, and notes about what can't be shown."""

    items: tuple[Item, ...]
    scenes: Scenes
    notes: tuple[str, ...]


def moments_of(carried: Carried, begins: Sequence[float] | Mapping[int, float]) -> tuple[Moment, ...]:
    """Give each state its time.

    Args:
        carried: the parts through a program.
        begins: when each step begins [s].
    """
    first, *rest = carried.states
    return (Moment(-np.inf, first), *(Moment(begins[one.step], one) for one in rest))


def shown_parts(robot: Robot, moments: Sequence[Moment], carried: Carried) -> ShownParts:
    """Show the parts.

    Args:
        robot: whose flange carries them.
        moments: in the order of time; of several at one time the last one counts.
        carried: the parts through the program.
    """
    moments = [
        one
        for one, following in zip(moments, [*moments[1:], None], strict=True)
        if following is None or following.begins > one.begins
    ]
    solids: dict[int, Solid | None] = {}
    items: list[Item] = []
    notes: list[str] = []
    since: dict[Placed, float] = {}

    def end(placed: Placed, ends: float) -> None:
        begins = since.pop(placed)
        if id(placed.part) not in solids:
            solids[id(placed.part)] = solid_of(placed.part.body.shape)
        solid = solids[id(placed.part)]
        if solid is None:
            notes.append(_unread(placed))
            return
        items.append(_item(robot, placed, solid, begins, ends))

    for moment in moments:
        here = dict.fromkeys(moment.state.parts.items)
        for placed in [one for one in since if one not in here]:
            end(placed, moment.begins)
        for placed in here:
            since.setdefault(placed, moment.begins)
    for placed in list(since):
        end(placed, np.inf)
    cells = tuple(carried.cell_of(one.state) for one in moments)
    scenes = Scenes(robot, np.array([one.begins for one in moments]), cells)
    items.sort(key=lambda item: item.begins)
    return ShownParts(tuple(items), scenes, tuple(dict.fromkeys(notes)))


def standing_parts(robot: Robot, parts: Parts) -> tuple[tuple[Item, ...], tuple[str, ...]]:
    """Show parts that stay where they are, and say which can't be shown.

    Args:
        robot: whose flange carries what a gripper holds.
        parts: where they are.
    """
    items: list[Item] = []
    notes: list[str] = []
    for placed in parts.items:
        solid = solid_of(placed.part.body.shape)
        if solid is None:
            notes.append(_unread(placed))
        else:
            items.append(_item(robot, placed, solid, -np.inf, np.inf))
    return tuple(items), tuple(dict.fromkeys(notes))


def _unread(placed: Placed) -> str:
    return f"the shape of {placed.part.body.name} can't be read and isn't shown"


def _item(robot: Robot, placed: Placed, solid: Solid, begins: float, ends: float) -> Item:
    is_held = placed.gripper is not None
    pose = robot.chain.base_from_flange @ placed.transform if is_held else placed.transform
    is_first = placed.pose == placed.part.body.mount.transform.tobytes()
    return Item(
        placed.name,
        "part",
        robot.size if is_held else 0,
        pose,
        solid,
        colours.PART,
        SURE if placed.is_sure else UNSURE,
        begins,
        ends,
        is_held or is_first or placed.part.count <= _NAMED,
    )


def with_parts(stage: Stage, shown: ShownParts | None) -> Stage:
    """Return a stage with its parts."""
    if shown is None:
        return stage
    return replace(
        stage,
        items=(*stage.items, *shown.items),
        notes=(*stage.notes, *shown.notes),
        scene=shown.scenes.scene(0),
        scenes=shown.scenes,
    )


def parts_of_plan(plan: MotionPlan, carried: Carried | None) -> ShownParts | None:
    """Show the parts of a program as it is planned; None if its cell has none."""
    if carried is None:
        return None
    return shown_parts(plan.robot, moments_of(carried, plan.schedule.places), carried)


def parts_of_text(does: Executed, carried: Carried | None) -> ShownParts | None:
    """Show the parts of a controller text; None if it isn't known where they are."""
    if carried is None:
        return None
    begins = begins_in_text(does, len(carried.handling.steps))
    return shown_parts(does.robot, moments_of(carried, begins), carried)


def unfollowed(cell: Cell | None, carried: Carried | None) -> tuple[str, ...]:
    """Return a note if a cell has parts and it isn't known where they are."""
    if carried is not None or cell is None or not cell.parts:
        return ()
    return ("the cell's parts aren't shown: only the program says where they are taken",)


def facts_of_set(carried: Carried | None, step: int) -> tuple[tuple[str, str], ...]:
    """Return what is said of the parts that a SET moves."""
    deeds = carried.deeds(step) if carried is not None else ()
    return tuple((verb, ", ".join(names)) for verb, names in deeds)


def facts_of_motion(carried: Carried | None, step: int) -> tuple[tuple[str, str], ...]:
    """Return what is said of the parts that a motion carries."""
    names = carried.names.get(step) if carried is not None else None
    return (("carries", ", ".join(names)),) if names else ()
