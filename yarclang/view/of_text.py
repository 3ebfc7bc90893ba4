"""A controller text as it is to be seen: what it makes the robot do, with the frames and the cell of its program where that is found."""

from __future__ import annotations

from pathlib import Path, PurePath

import numpy as np

from yarclang.diagnostics import Result
from yarclang.hir import Program
from yarclang.pipeline.executed import Executed, executed
from yarclang.pipeline.origins import origins_of_text
from yarclang.report.pictures.plot import duration_text
from yarclang.robot.model import Robot
from yarclang.source import SourceFile
from yarclang.view.stage import Piece, Stage
from yarclang.view.surroundings import followed_frame, surroundings_of
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
    frame = followed_frame(robot, program)
    around = surroundings_of(robot, program, missing)
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
    return Stage(
        title=PurePath(name).name,
        subtitle=f"{robot.name} · {duration_text(now)} · {len(begins):,} motions as the controller executes them",
        notes=around.notes,
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
    )
