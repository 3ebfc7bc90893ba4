"""Find the moving frame and the base frame of a motion command: in its line, or else in DEFAULT."""

from __future__ import annotations

from yarclang.commands.spec import Values
from yarclang.diagnostics import Collector
from yarclang.frozen import frozen
from yarclang.hir import FrameLink
from yarclang.semantics.motions.line import Line
from yarclang.semantics.names.commands import ResolvedName
from yarclang.semantics.names.frames import base_axes, known_frame, moving_frame
from yarclang.semantics.names.scope import Frame, Named, Places, Pose, Scope
from yarclang.semantics.values.evaluate import EvaluationError, place_named
from yarclang.subjects import LeftOut
from yarclang.syntax.ast import Computed, Statement, Word
from yarclang.syntax.expressions import Element


@frozen(eq=False)
class Moved:
    """The frames of a motion command.

    Attributes:
        frames: the moving frame on the flange, and the frame of the values. None for joint values, and for a
            command with errors.
        tool: the moving frame. A motion to joint values has it too, although it doesn't affect the path.
    """

    frames: tuple[Frame, Frame] | None
    tool: FrameLink | None

    @property
    def links(self) -> tuple[FrameLink | None, FrameLink | None]:
        """Links (names and declarations) of both frames."""
        return (None, None) if self.frames is None else (self.frames[0].link, self.frames[1].link)


def moved_by(line: Line) -> Moved:
    """Return the frames of a motion command; add findings if frames are missing, unknown or not allowed."""
    statement, defaults = line.statement, line.defaults
    poses = named_poses(line)
    if not poses and (
        line.values.of_joints or (takes_names(line.name) and _all_named(statement, line.scope))
    ):
        # Joint values need no frames. Frames in the line don't affect the motion, but must exist.
        for frame in (statement.moving, statement.base):
            if frame is not None:
                known_frame(statement, frame, line.scope, line.findings)
        return Moved(None, _tool(line))
    moving = base = None
    if statement.moving is not None:
        moving = moving_frame(statement, statement.moving, line.scope, line.findings)
    elif defaults.moving is not None and defaults.statement is not None:
        moving = moving_frame(defaults.statement, defaults.moving, defaults.scope, line.findings)
    else:
        help_ = "write it after the name, as {TCP}, or in DEFAULT"
        message = f"{line.name.full} has no moving frame"
        subject = LeftOut("the frame that it moves")
        line.findings.add("Y0302", message, statement.head_span, help_, subject=subject)
    may_move = line.name.spec.frames_may_move
    if poses and (line.values.of_joints or _all_named(statement, line.scope)):
        base = _base_of(line, poses)
    elif statement.base is not None:
        base = base_axes(statement, statement.base, line.scope, may_move, line.findings)
    elif defaults.base is not None and defaults.statement is not None:
        base = base_axes(defaults.statement, defaults.base, defaults.scope, may_move, line.findings)
    else:
        help_ = "write the base frame after the units, as {B}, or in DEFAULT"
        message = f"{line.name.full} has no base frame for its values"
        subject = LeftOut("the frame in which its values are given")
        line.findings.add("Y0302", message, statement.head_span, help_, subject=subject)
    if moving is None or base is None:
        return Moved(None, None)
    return Moved((moving, base), moving.link)


def named_poses(line: Line) -> tuple[tuple[Word | Computed, Pose], ...]:
    """Return the waypoints of a command that name a declared pose or a pose in a table, with these poses.

    The result is empty for commands whose waypoints are increments or rows of a timetable.
    """
    if line.values.is_delta or line.name.spec.is_timed:
        return ()
    found: list[tuple[Word | Computed, Pose]] = []
    for waypoint in line.statement.waypoints:
        if len(waypoint.values) == 1 and isinstance(word := waypoint.values[0], Word | Computed):
            meaning = meaning_of(word, line.scope)
            if isinstance(meaning, Pose):
                found.append((word, meaning))
    return tuple(found)


def meaning_of(value: Word | Computed, scope: Scope) -> Named | None:
    """Return the meaning of a name or of an element of a table of places. For a wrong index, return the first
    element.
    """
    if isinstance(value, Word):
        return scope.name(value.name)
    try:
        return place_named(value.expression, scope)
    except EvaluationError:
        found = scope.name(value.expression.table.name) if isinstance(value.expression, Element) else None
        return found.rows[0] if isinstance(found, Places) else None


def _base_of(line: Line, poses: tuple[tuple[Word | Computed, Pose], ...]) -> Frame:
    """Return the frame of the first pose, for a command whose waypoints are all names of poses.

    A base frame in the command has no effect then, and gets a finding.
    """
    word, pose = poses[0]
    if line.statement.base is not None:
        given = f"{{{pose.link.name}}}" if pose.link is not None else "a frame"
        message = f"{word.text} is already given in {given}: {line.statement.base.text} has no effect"
        help_ = "remove it, or declare the pose in the other frame by POSE"
        line.findings.add("Y0408", message, line.statement.span(line.statement.base.place), help_)
    return Frame(pose.transform, on_flange=False, link=pose.link)


def _tool(line: Line) -> FrameLink | None:
    """Return the moving frame of the line or of DEFAULT if this frame is fixed to the flange; else None.

    No finding is added, since joint values don't need a moving frame.
    """
    unheard = Collector(line.findings.source)
    moving, statement, scope = line.statement.moving, line.statement, line.scope
    if moving is None:
        defaults = line.defaults
        if defaults.moving is None or defaults.statement is None:
            return None
        moving, statement, scope = defaults.moving, defaults.statement, defaults.scope
    frame = moving_frame(statement, moving, scope, unheard)
    return None if frame is None else frame.link


def takes_names(name: ResolvedName) -> bool:
    """Return True if waypoints of a command may be names of joint positions, because the command also
    accepts joint values.
    """
    return name.spec.targets.get("") is Values.JOINTS


def _all_named(statement: Statement, scope: Scope) -> bool:
    """Return True if every waypoint is one word, or an element of a table of places."""
    return bool(statement.waypoints) and all(
        len(waypoint.values) == 1
        and (
            isinstance(value := waypoint.values[0], Word)
            or (isinstance(value, Computed) and meaning_of(value, scope) is not None)
        )
        for waypoint in statement.waypoints
    )
