"""Build the scene of a recorded run: the actual motion beside the planned one."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path, PurePath

import numpy as np

from yarclang.cell.model import Cell
from yarclang.diagnostics import Diagnostic, Result, has_errors
from yarclang.findings import Severity
from yarclang.pipeline.cells import session_cell
from yarclang.pipeline.executed import Executed, executed
from yarclang.pipeline.inputs import named_robot, robot_made_for
from yarclang.pipeline.origins import Origins, origins_of_text
from yarclang.report.pictures.plot import duration_text
from yarclang.report.runs.course import marks_of, outcome_text
from yarclang.report.runs.log import RecordedRun, read_run
from yarclang.report.runs.planned import Planned, planned_motion
from yarclang.report.runs.tracking import Tracking, tracking_of
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.model import Array, Robot
from yarclang.view.parts import facts_of_motion, unfollowed, with_parts
from yarclang.view.recorded_parts import RecordedParts, recorded_parts
from yarclang.view.stage import Mark, Piece, Stage
from yarclang.view.surroundings import followed_frame, surroundings_of
from yarclang.view.track import Recorded, Shifted, way_of_track

_MOST_POINTS = 20_000

_SEEN = 0.2
"""A command that is longer than this and has no sample wasn't executed [s]. Samples of a motion are at most
this time apart.
"""


def stage_of_run(file: str, robot_name: str | None, cell: str | None = None) -> Result[Stage]:
    """Return the scene of a recorded run.

    Args:
        file: the log of the run.
        robot_name: robot named on the command line. By default it is the robot that the log names, from the
            folder's yarc.toml or from the library.
        cell: path of a cell.toml named on the command line; by default that of the folder's yarc.toml.

    Returns:
        None, with findings, if the file is no log, has no positions, or its robot isn't found.
    """
    read = read_run(file)
    if read.value is None:
        return Result(None, read.diagnostics)
    run, found = read.value, read.diagnostics
    if not len(run.times):
        message = f"{file} has no positions: {outcome_text(run)[0]}"
        help_ = f"`yarc replay {file}` shows the messages of the run"
        return Result(None, (*found, Diagnostic("Y1405", message, help=help_)))
    folder = Path(file).parent
    loaded = robot_made_for(folder, run.robot.name) if robot_name is None else named_robot(folder, robot_name)
    robot = loaded.value
    if robot is None:
        help_ = "for a robot of your own, give its path: --robot PATH"
        return Result(None, (*found, *(_with_help(one, help_) for one in loaded.diagnostics)))
    if (robot.name, robot.joint_names) != (run.robot.name, run.robot.joint_names):
        theirs, ours = (
            f"{one.name} with the joints {', '.join(one.joint_names)}" for one in (run.robot, robot)
        )
        message = f"{file} is of {theirs}, and --robot is {ours}"
        help_ = "name the robot of the run: --robot PATH"
        return Result(None, (*found, Diagnostic("Y1406", message, help=help_)))
    planned = planned_motion(run)
    if planned.value is None:
        return Result(None, (*found, *planned.diagnostics))
    given = session_cell(Path(file).parent, robot, cell)
    found = (*found, *given.diagnostics)
    if has_errors(given.diagnostics):
        return Result(None, found)
    around = None if given.value is None else given.value.loaded.value
    origins = origins_of_text(run.text, Path(file).parent, robot, cell=cell)
    stage = _stage(run, planned.value, robot, origins, around)
    return Result(stage, (*found, *planned.diagnostics))


def _with_help(finding: Diagnostic, help_: str) -> Diagnostic:
    return Diagnostic(finding.code, finding.message, finding.source, finding.span, help_)


def _stage(run: RecordedRun, planned: Planned, robot: Robot, origins: Origins, cell: Cell | None) -> Stage:
    program = origins.program
    tracking = tracking_of(run, planned)
    frame = followed_frame(robot, program)
    flange_from_frame = frame.flange_from_frame
    around = surroundings_of(robot, program, frame.name, origins.missing, cell)
    notes = around.notes
    track = Recorded(run.times, run.actual)
    plan_times = _plan_times(run, tracking)
    ghost = Shifted(_AsPlanned(planned), *plan_times)
    every = max(-(-len(run.times) // _MOST_POINTS), 1)
    times = np.unique(np.append(run.times[::every], run.times[-1]))
    if robot.fingerprint != run.robot.fingerprint:
        notes = (f"{robot.name} has changed since the run: the present robot is shown", *notes)
    text, _ = outcome_text(run)
    does = executed(run.text, robot, run.file).value
    parts = recorded_parts(run, tracking, does, program) if does is not None else None
    stage = Stage(
        title=PurePath(run.file).name,
        subtitle=f"a run of {run.program} on {run.robot.name} · {duration_text(run.end)} · {text}",
        notes=(*notes, *unfollowed(around.cell, parts.carried if parts is not None else None)),
        robot=robot,
        items=around.items,
        axes=around.axes,
        frame=frame.name,
        flange_from_frame=flange_from_frame,
        track=track,
        ghost=ghost,
        way=way_of_track(track, times, robot.chain, flange_from_frame),
        ghost_way=way_of_track(
            _AsPlanned(planned), np.linspace(0.0, planned.duration, 2_000), robot.chain, flange_from_frame
        ),
        pieces=_pieces(run, tracking, _carries(run, does, parts)),
        marks=_marks(run, tracking, track, robot, flange_from_frame),
        scene=around.scene,
        duration=float(run.end),
        cell=around.cell,
    )
    return with_parts(stage, parts.shown if parts is not None else None)


def _carries(
    run: RecordedRun, does: Executed | None, parts: RecordedParts | None
) -> tuple[tuple[tuple[str, str], ...], ...]:
    """For each command of the run, return the facts about the workpieces that it carries."""
    if does is None or parts is None:
        return ((),) * len(run.commands)
    steps = [act.step for act in does.acts if act.curve is not None]
    return tuple(facts_of_motion(parts.carried, step) for step in steps)


class _AsPlanned:
    """The planned motion over the program's time."""

    def __init__(self, planned: Planned) -> None:
        self._planned = planned

    def at(self, times: Array) -> tuple[Array, Array]:
        """Return positions and velocities; see `Track.at`."""
        return self._planned.at(times)


def _plan_times(run: RecordedRun, tracking: Tracking) -> tuple[Array, Array]:
    """Return times of the run and the corresponding times of the program, (K,) each [s].

    Before the program begins, the time of the program is that of its start. In each further pass of a
    repeated program, the time of the program begins again.
    """
    if not len(tracking.rows):
        return np.array([0.0]), np.array([0.0])
    return run.times[tracking.rows], tracking.times


def _pieces(
    run: RecordedRun, tracking: Tracking, carries: Sequence[tuple[tuple[str, str], ...]]
) -> tuple[Piece, ...]:
    """Return the commands with the times at which they were executed. If the program was repeated, the times
    are those of the last pass.

    Commands that weren't executed have no time and are left out.
    """
    if not len(tracking.rows):
        return ()
    passes = run.passes[tracking.rows]
    last = np.flatnonzero(passes == passes[-1])
    real, program = run.times[tracking.rows][last], tracking.times[last]
    off = np.abs(tracking.error[last]) / run.robot.axis_units
    found = []
    for one, carried in zip(run.commands, carries, strict=False):
        if not (program[0] <= one.ends and one.begins <= program[-1]):
            continue
        begins, ends = (float(np.interp(time, program, real)) for time in (one.begins, one.ends))
        here = (program >= one.begins) & (program <= one.ends)
        if not here.any() and one.ends - one.begins > _SEEN:
            continue  # belongs to the branch of a WHEN that wasn't taken
        planned_ends = one.clock + one.ends - one.begins
        facts = [("planned", f"{one.clock:.3f} to {planned_ends:.3f} s of the program")]
        if here.any():
            joint = int(np.argmax(off[here].max(axis=0)))
            unit = run.robot.axis_unit_names[joint]
            facts.append(
                ("farthest off", f"{run.robot.joint_names[joint]} by {off[here, joint].max():.3f} {unit}")
            )
        facts += carried
        if one.begins < program[-1] < one.ends and outcome_text(run)[1] is not True:
            facts.append(("", "the run ended in it"))
        found.append(
            Piece(
                one.index, one.name, one.source_line, begins, ends, one.ends > one.begins, True, tuple(facts)
            )
        )
    return tuple(sorted(found, key=lambda piece: piece.begins))


def _marks(
    run: RecordedRun, tracking: Tracking, track: Recorded, robot: Robot, flange_from_frame: Array
) -> tuple[Mark, ...]:
    """Return marks for the remarks in the log and for the end of the run. Each mark is at the position of the
    robot at its time.
    """
    told: list[tuple[float, str, Severity]] = [
        (one.time, one.text, "note") for one in marks_of(run, tracking)
    ]
    text, is_well = outcome_text(run)
    if is_well is False:
        told = [one for one in told if one[1] != text]
        told.append((run.end, text, "error"))
    found = []
    for time, what, severity in told:
        place = tool_poses(robot.chain, track.at(np.array([time]))[0], flange_from_frame)[0, :3, 3]
        found.append(Mark("", severity, f"{time:.2f} s: {what}", "", time, place, -1))
    return tuple(found)
