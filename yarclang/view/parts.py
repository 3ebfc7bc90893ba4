"""The workpieces of a cell as bodies to draw: their places over time, and the bodies of the collision check
at these times.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from yarclang.cell.model import Cell, Parts
from yarclang.cell.model import Item as Placed
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.executed import Executed
from yarclang.report.carried import Carried, State, begins_in_text
from yarclang.report.solids import Solid, solid_of
from yarclang.robot.model import Array, Robot
from yarclang.view import colours
from yarclang.view.stage import Item, Scenes, Stage

SURE, UNSURE = 1.0, 0.45
"""Opacity of a part whose place is known, and of a part that may be elsewhere."""
_NAMED = 8
"""Largest number of workpieces of one kind that all show their names.

If there are more, only the first workpiece and held ones show their names, since the others are close
together.
"""


@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """The state of all workpieces from a given time on: which are held, and where the others are.

    Attributes:
        begins: the time [s].
        state: the state of the workpieces.
    """

    begins: float
    state: State


@dataclass(frozen=True, slots=True, eq=False)
class ShownParts:
    """The workpieces in a picture.

    Attributes:
        items: bodies of the workpieces.
        scenes: bodies of the collision check over time.
        notes: workpieces that can't be shown.
    """

    items: tuple[Item, ...]
    scenes: Scenes
    notes: tuple[str, ...]


def moments_of(carried: Carried, begins: Sequence[float] | Mapping[int, float]) -> tuple[Moment, ...]:
    """Return the states of the workpieces during a program, with their times.

    Args:
        carried: the workpieces during the program.
        begins: time at which each step of the program begins [s].
    """
    first, *rest = carried.states
    return (Moment(-np.inf, first), *(Moment(begins[one.step], one) for one in rest))


def shown_parts(robot: Robot, moments: Sequence[Moment], carried: Carried) -> ShownParts:
    """Return the bodies to draw for workpieces that a program moves.

    Args:
        robot: the robot that carries the workpieces.
        moments: states in order of time. Of several states at one time, the last one counts.
        carried: the workpieces during the program.
    """
    moments = [
        one
        for one, following in zip(moments, [*moments[1:], None], strict=True)
        if following is None or following.begins > one.begins
    ]
    solids: dict[int, tuple[Solid | None, ...]] = {}
    items: list[Item] = []
    notes: list[str] = []
    since: dict[Placed, float] = {}

    def end(placed: Placed, ends: float) -> None:
        begins = since.pop(placed)
        if id(placed.part) not in solids:
            solids[id(placed.part)] = tuple(solid_of(shape) for _, shape in placed.solids)
        for (pose, _), solid in zip(placed.solids, solids[id(placed.part)], strict=True):
            if solid is None:
                notes.append(_unread(placed))
            else:
                items.append(_item(robot, placed, pose, solid, begins, ends))

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
    """Return the bodies to draw for workpieces that stay in place, and notes about those that can't be drawn.

    Args:
        robot: the robot whose flange carries held workpieces.
        parts: places of the workpieces.
    """
    items: list[Item] = []
    notes: list[str] = []
    for placed in parts.items:
        for pose, shape in placed.solids:
            solid = solid_of(shape)
            if solid is None:
                notes.append(_unread(placed))
            else:
                items.append(_item(robot, placed, pose, solid, -np.inf, np.inf))
    return tuple(items), tuple(dict.fromkeys(notes))


def _unread(placed: Placed) -> str:
    return f"the shape of {placed.part.body.name} can't be read and isn't shown"


def _item(robot: Robot, placed: Placed, pose: Array, solid: Solid, begins: float, ends: float) -> Item:
    is_held = placed.gripper is not None
    if is_held:
        pose = robot.chain.base_from_flange @ pose
    is_first = placed.pose == placed.part.body.mount.transform.tobytes()
    return Item(
        placed.name,
        "part",
        robot.size if is_held else 0,
        pose,
        solid,
        colours.PART if placed.part.rack is None else colours.TOOL,
        SURE if placed.is_sure else UNSURE,
        begins,
        ends,
        is_held or is_first or placed.part.count <= _NAMED,
    )


def with_parts(stage: Stage, shown: ShownParts | None) -> Stage:
    """Return a scene with the cell's workpieces added."""
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
    """Return the workpieces of a planned program to draw; None if the program's cell has none."""
    if carried is None:
        return None
    return shown_parts(plan.robot, moments_of(carried, plan.schedule.places), carried)


def parts_of_text(does: Executed, carried: Carried | None) -> ShownParts | None:
    """Return the workpieces of a controller text to draw; None if their places aren't known."""
    if carried is None:
        return None
    begins = begins_in_text(does, len(carried.handling.steps))
    return shown_parts(does.robot, moments_of(carried, begins), carried)


def unfollowed(cell: Cell | None, carried: Carried | None) -> tuple[str, ...]:
    """Return a note if the places of a cell's workpieces are unknown."""
    if carried is not None or cell is None or not cell.parts:
        return ()
    return ("the cell's parts aren't shown: only the program shows where they are taken",)


def facts_of_set(carried: Carried | None, step: int) -> tuple[tuple[str, str], ...]:
    """Return the workpieces that a SET takes, puts down or removes, as names and texts to show."""
    deeds = carried.deeds(step) if carried is not None else ()
    return tuple((verb, ", ".join(names)) for verb, names in deeds)


def facts_of_motion(carried: Carried | None, step: int) -> tuple[tuple[str, str], ...]:
    """Return the workpieces that a motion carries, and the bodies that may touch during it, as names and
    texts to show.
    """
    if carried is None:
        return ()
    names = carried.names.get(step)
    may = [f"{one.first} and {one.second} ({one.giver})" for one in carried.handling.allowances.get(step, ())]
    return (
        *((("carries", ", ".join(names)),) if names else ()),
        *((("may touch", ", ".join(may)),) if may else ()),
    )
