"""A robot that is running as it is to be seen: the messages of its coordinator become a stage, and figures beside it. It knows no clock."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from yarclang.cell.model import Cell, Parts
from yarclang.coordinator.describing import joints_of
from yarclang.coordinator.messages import events
from yarclang.coordinator.messages.replies import Status
from yarclang.coordinator.picture import Picture
from yarclang.handling.parts import first_parts
from yarclang.robot.model import Array, Robot
from yarclang.runtime.state import State
from yarclang.view.figures import rows_html, stand_rows
from yarclang.view.live_parts import LiveParts
from yarclang.view.parts import standing_parts
from yarclang.view.stage import Stage
from yarclang.view.surroundings import followed_frame, surroundings_of
from yarclang.view.track import way_of_track

_UNDER_WAY = (State.INIT, State.MOVE, State.HOLD)
"""In these states a status tells of what is carried out; else of what the process is for."""


@dataclass(frozen=True, slots=True, eq=False)
class _Still:
    """Joints that stand at `q` (n,) [rad or m]."""

    q: Array

    def at(self, times: Array) -> tuple[Array, Array]:
        """As `Track` says."""
        q = np.tile(self.q, (len(times), 1))
        return q, np.zeros_like(q)


def stage_of_live(
    robot: Robot, cell: Cell | None, q: Array, *, subtitle: str = "", parts: Parts | None = None
) -> Stage:
    """Show a robot where it is now.

    Args:
        robot: that runs.
        cell: what is around it; None if no cell is known.
        q: where it is (n,) [rad or m].
        subtitle: who tells of it.
        parts: where the parts of the cell are; None: where its file says.
    """
    frame = followed_frame(robot, None)
    around = surroundings_of(robot, None, frame.name, given=cell)
    items, unread = standing_parts(robot, first_parts(cell) if parts is None else parts)
    track = _Still(q)
    return Stage(
        title=robot.name,
        subtitle=subtitle,
        notes=(*around.notes, *unread),
        robot=robot,
        items=(*around.items, *items),
        axes=around.axes,
        frame=frame.name,
        flange_from_frame=frame.flange_from_frame,
        track=track,
        ghost=None,
        way=way_of_track(track, np.zeros(1), robot.chain, frame.flange_from_frame),
        ghost_way=None,
        pieces=(),
        marks=(),
        scene=around.scene,
        duration=0.0,
        cell=around.cell,
    )


class Live:
    """What a robot does, as of the last message.

    Args:
        robot: whose messages they are.
        status: what was told at first.

    Attributes:
        robot: likewise.
        said: the last warning, or how the last program ended badly; empty: nothing is to be said.
        parts: where the parts of the cell are; None: no cell is known, or it has none.
    """

    def __init__(self, robot: Robot, status: Status) -> None:
        self.robot = robot
        self.said = ""
        self.parts: LiveParts | None = None
        self.look(status)

    def look(self, status: Status) -> None:
        """Begin anew with what was told of everything: after events were missed, too."""
        self._known = Picture(status)
        self._why = status.why
        if status.state in _UNDER_WAY:
            command = status.command
            began = events.ProgressMade(
                time_s=0.0,
                done_s=status.done,
                left_s=status.left,
                command="" if command is None else command.title,
                line=0 if command is None else command.line,
            )
            self._known.under_way, self._known.progress = status.program, began

    def hear(self, event: events.BaseEvent) -> None:
        """Take note of an event."""
        self._known.hear(event)
        match event:
            case events.StateChanged(why=why):
                self._why = why
            case events.Told(text=text, warning=True):
                self.said = text
            case events.Began():
                self.said = ""
            case events.Finished(name=name, well=False, what=what):
                self.said = f"{name}: {what}"
        if self.parts is None or (q := self.joints) is None:
            return
        if isinstance(event, events.OutputSet):
            self.parts.output_set(event.variable, event.value, q)
        elif isinstance(event, events.Position):
            self.parts.stands(q)

    @property
    def joints(self) -> Array | None:
        """Actual positions (n,) [rad or m]; None: not known yet, or of other joints than the robot's."""
        told = self._known.joints
        if told is None or told.keys() != set(self.robot.joint_names):
            return None
        return joints_of(self.robot, told)

    @property
    def is_under_way(self) -> bool:
        """True while something is carried out; parts that it moves are known here, and to the coordinator afterwards."""
        return bool(self._known.under_way)

    @property
    def stale(self) -> str:
        """Why the positions aren't those of now; empty: they are."""
        return self._why if self._known.state is State.DISCONNECTED else ""

    def html(self, stage: Stage, q: Array) -> str:
        """Return the figures of now: state, command, times, pace, and where the robot is (n,) [rad or m]."""
        known, progress = self._known, self._known.progress
        state = known.state.value
        rows = [("state", f"{state}: {self._why}" if self._why else state)]
        if known.under_way:
            rows.append(("runs", known.under_way))
            if progress is not None and progress.command:
                line = f", line {progress.line}" if progress.line else ""
                rows.append(("command", f"{progress.command}{line}"))
            if progress is not None:
                rows.append(("time", f"{progress.done_s:.1f} s done, {progress.left_s:.1f} s left"))
        rows.append(("override", f"{known.override:g} %"))
        rows.append(("owner", known.owner or "nobody"))
        if self.parts is not None:
            rows += self.parts.rows
        return rows_html([*rows, *stand_rows(stage, q)])
