"""The stage of a loaded program, that is, all that the 3D viewer draws: the program's cell and frames, and
the workpieces (parts) at each time of the program's longest branches.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from yarclang.cell.model import Parts
from yarclang.coordinator.course import longest_way
from yarclang.coordinator.programs import Loaded
from yarclang.motion.plan import MotionPlan
from yarclang.report.carried import carried_parts
from yarclang.report.pictures.drawn_frame import drawn_frame
from yarclang.robot.model import Robot
from yarclang.view.of_live import stage_of_live
from yarclang.view.parts import ShownParts, moments_of, shown_parts, with_parts
from yarclang.view.stage import Stage
from yarclang.view.surroundings import surroundings_of
from yarclang.view.track import Curves, way_of_curves

_UNPLANNED = "only the controller text is known: frames of the program and motions of its parts aren't shown"


def stage_of_loaded(robot: Robot, loaded: Loaded) -> Stage:
    """Return the stage of a program before it is run. Its times are those of the program, as in the
    coordinator's reply to the order `course`.

    Args:
        robot: robot that runs the program.
        loaded: the program.
    """
    plan = loaded.plan or loaded.text_plan
    if plan is None:
        stage = stage_of_live(robot, loaded.around, loaded.rest.start, parts=loaded.assumed or Parts(()))
        return _noted(stage, loaded.name, (_UNPLANNED,))
    program, frame = plan.program, drawn_frame(plan)
    around = surroundings_of(robot, program, frame.name)
    longest = longest_way(plan)
    motions = [one for one in plan.motions if one.step in longest]
    clocks = plan.schedule.clocks
    curves = Curves(
        program.start, tuple(one.curve for one in motions), np.array([clocks[one.step] for one in motions])
    )
    stage = Stage(
        title=loaded.name,
        subtitle="",
        notes=around.notes,
        robot=robot,
        items=around.items,
        axes=around.axes,
        frame=frame.name,
        flange_from_frame=frame.flange_from_frame,
        track=curves,
        ghost=None,
        way=way_of_curves(curves, robot.chain, frame.flange_from_frame, [-1] * len(motions)),
        ghost_way=None,
        pieces=(),
        marks=(),
        scene=around.scene,
        duration=plan.lasting.most,
        cell=around.cell,
    )
    return with_parts(stage, _parts(robot, plan, longest))


def _noted(stage: Stage, title: str, notes: tuple[str, ...]) -> Stage:
    return replace(stage, title=title, notes=(*notes, *stage.notes))


def _parts(robot: Robot, plan: MotionPlan, longest: set[int]) -> ShownParts | None:
    """Return where the workpieces (parts) are at each time of the program; None if the program moves none.
    Only the actions in the longest branches of the program are considered.
    """
    ends = {one.step: one.curve.points[-1] for one in plan.motions}
    left_out = [number for number in range(len(plan.program.steps)) if number not in longest]
    carried = carried_parts(robot, plan.program, plan.program.start, ends, left_out)
    if carried is None:
        return None
    return shown_parts(robot, moments_of(carried, plan.schedule.clocks), carried)
