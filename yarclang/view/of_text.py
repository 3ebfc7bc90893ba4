"""A controller text as it is to be seen: what it makes the robot do, with the frames and the cell of its program where that is found."""

from __future__ import annotations

from pathlib import Path, PurePath

import numpy as np

from yarclang.cell.model import Cell
from yarclang.collision.scene import scene_of
from yarclang.diagnostics import Result
from yarclang.hir import Motion, PoseDelta, PoseGoal, Program
from yarclang.pipeline.executed import Executed, executed
from yarclang.pipeline.origins import origins_of_text
from yarclang.report.pictures.plot import duration_text
from yarclang.robot.model import Array, Robot
from yarclang.source import SourceFile
from yarclang.view.bodies import axes_of, cell_items, robot_items
from yarclang.view.stage import Item, Piece, Stage
from yarclang.view.track import Curves, way_of_curves


def stage_of_text(source: SourceFile, folder: Path, robot: Robot) -> Result[Stage]:
    """What a controller text shows; None, with a finding, where it isn't as yarcc wrote it."""
    read = executed(source.text, robot, source.name)
    if read.value is None:
        return Result(None, read.diagnostics)
    origins = origins_of_text(source.text, folder, robot)
    return Result(_stage(source.name, read.value, origins.program, origins.missing), read.diagnostics)


def _stage(name: str, does: Executed, program: Program | None, missing: str) -> Stage:
    robot = does.robot
    frame, flange_from_frame = followed_frame(robot, program)
    begins, pieces, owners = [], [], []
    now = 0.0
    for number, act in enumerate(does.acts):
        facts: tuple[tuple[str, str], ...] = (("does", act.what),) if act.what else ()
        if act.curve is not None:
            begins.append(now)
            owners.append(number)
            segments = f"{act.curve.segments} of {act.curve.segment * 1e3:g} ms"
            facts = (("duration", f"{act.duration:.3f} s"), ("segments", segments))
        ends = now + (act.duration if act.curve is not None else 0.0)
        pieces.append(
            Piece(act.place, act.name, act.source_line, now, ends, act.curve is not None, True, facts)
        )
        now = ends
    curves = Curves(
        does.start,
        tuple(act.curve for act in does.acts if act.curve is not None),
        np.array(begins, dtype=np.float64),
    )
    items, notes = bodies(robot, program.cell if program is not None else None)
    axes, more = axes_of(robot, program, program.cell if program is not None else None)
    if program is None:
        notes = (f"without the program's cell and frames: {missing}", *notes)
    scene = scene_of(robot, program.cell if program is not None else None).value
    return Stage(
        title=PurePath(name).name,
        subtitle=f"{robot.name} · {duration_text(now)} · {len(begins):,} motions as the controller executes them",
        notes=(*notes, *more),
        robot=robot,
        items=items,
        axes=axes,
        frame=frame,
        flange_from_frame=flange_from_frame,
        track=curves,
        ghost=None,
        way=way_of_curves(curves, robot.chain, flange_from_frame, owners),
        ghost_way=None,
        pieces=tuple(pieces),
        marks=(),
        scene=scene if scene is not None and len(scene.first) else None,
        duration=now,
    )


def bodies(robot: Robot, cell: Cell | None) -> tuple[tuple[Item, ...], tuple[str, ...]]:
    """Robot and cell, and what of them isn't shown."""
    links, unread = robot_items(robot)
    around, placeless = cell_items(robot, cell) if cell is not None else ((), ())
    return (*links, *around), (*unread, *placeless)


def followed_frame(robot: Robot, program: Program | None) -> tuple[str, Array]:
    """The frame that the first Cartesian motion of a program moves, else {TCP}, else the flange."""
    for step in program.steps if program is not None else ():
        goals = getattr(step, "waypoints", None) or (getattr(step, "goal", None),)
        if (
            isinstance(step, Motion)
            and isinstance(goals[-1], PoseGoal | PoseDelta)
            and step.origin.moving is not None
        ):
            return step.origin.moving.name, goals[-1].flange_from_moving
    name = "TCP" if "TCP" in robot.flange_from_frame else "FLANGE"
    return name, robot.flange_from_frame.get(name, np.eye(4))
