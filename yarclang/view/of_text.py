"""Build the scene of a controller text (the compiler's output). If its program is found, the scene has the
program's frames and cell.
"""

from __future__ import annotations

from pathlib import Path, PurePath

import numpy as np

from yarclang.cell.model import Cell
from yarclang.diagnostics import Result, has_errors
from yarclang.hir import Program
from yarclang.pipeline.cells import session_cell
from yarclang.pipeline.executed import Executed, executed
from yarclang.pipeline.origins import origins_of_text
from yarclang.report.carried import carried_in_text
from yarclang.report.pictures.plot import time_facts
from yarclang.robot.model import Robot
from yarclang.source import SourceFile
from yarclang.view.parts import facts_of_motion, facts_of_set, parts_of_text, unfollowed, with_parts
from yarclang.view.stage import Piece, Stage
from yarclang.view.surroundings import followed_frame, surroundings_of
from yarclang.view.track import Curves, way_of_curves


def stage_of_text(source: SourceFile, folder: Path, robot: Robot, cell: str | None = None) -> Result[Stage]:
    """Return a scene with the motions of a controller text.

    Args:
        source: the controller text.
        folder: folder of the text, in which its program and cell are looked up.
        robot: the robot for which the text was compiled.
        cell: path of a cell.toml named on the command line.

    Returns:
        None, with a finding, if the text isn't one that yarcc writes, or its cell can't be used.
    """
    read = executed(source.text, robot, source.name)
    if read.value is None:
        return Result(None, read.diagnostics)
    given = session_cell(folder, robot, cell)
    if has_errors(given.diagnostics):
        return Result(None, given.diagnostics)
    around = None if given.value is None else given.value.loaded.value
    origins = origins_of_text(source.text, folder, robot, cell=cell)
    stage = _stage(source.name, read.value, origins.program, origins.missing, around)
    return Result(stage, (*read.diagnostics, *given.diagnostics))


def _stage(name: str, does: Executed, program: Program | None, missing: str, cell: Cell | None) -> Stage:
    robot = does.robot
    frame = followed_frame(robot, program)
    around = surroundings_of(robot, program, frame.name, missing, cell)
    carried = carried_in_text(does, program)
    begins, pieces, owners = [], [], []
    now = 0.0
    for number, act in enumerate(does.acts):
        facts: tuple[tuple[str, str], ...] = (("does", act.what),) if act.what else ()
        facts = (*facts, *facts_of_set(carried, act.step))
        if act.curve is not None:
            begins.append(now)
            owners.append(number)
            segments = f"{act.curve.segments} of {act.curve.segment * 1e3:g} ms"
            told = (("duration", f"{act.duration:.3f} s"), ("segments", segments))
            facts = (*told, *facts_of_motion(carried, act.step))
        ends = now + act.duration
        pieces.append(
            Piece(act.place, act.name, act.source_line, now, ends, act.curve is not None, True, facts)
        )
        now = ends
    curves = Curves(
        does.start,
        tuple(act.curve for act in does.acts if act.curve is not None),
        np.array(begins, dtype=np.float64),
    )
    motions = f"{len(begins):,} motions as the controller executes them"
    stage = Stage(
        title=PurePath(name).name,
        subtitle=" · ".join((robot.name, *time_facts(does.lasting, now), motions)),
        notes=(*around.notes, *unfollowed(around.cell, carried)),
        robot=robot,
        items=around.items,
        axes=around.axes,
        frame=frame.name,
        flange_from_frame=frame.flange_from_frame,
        track=curves,
        ghost=None,
        way=way_of_curves(curves, robot.chain, frame.flange_from_frame, owners),
        ghost_way=None,
        pieces=tuple(pieces),
        marks=(),
        scene=around.scene,
        duration=now,
        cell=around.cell,
    )
    return with_parts(stage, parts_of_text(does, carried))
