"""Build the scene of a running robot, and the figures beside it, from the messages of its coordinator. This
module reads no clock.
"""

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
"""States in which the texts of a status describe the running program. In all other states, they describe the
purpose of the process.
"""


@dataclass(frozen=True, slots=True, eq=False)
class _Still:
    """Joint positions `q` (n,) [rad or m] of a robot at rest, as a function of time."""

    q: Array

    def at(self, times: Array) -> tuple[Array, Array]:
        """Return positions and velocities; see `Track.at`."""
        q = np.tile(self.q, (len(times), 1))
        return q, np.zeros_like(q)


def stage_of_live(
    robot: Robot, cell: Cell | None, q: Array, *, subtitle: str = "", parts: Parts | None = None
) -> Stage:
    """Return the scene of a running robot at its current position.

    Args:
        robot: the running robot.
        cell: its cell; None if none is known.
        q: (n,) current joint positions [rad or m].
        subtitle: text that says where the messages come from.
        parts: places of the cell's workpieces; None for the places in the cell's file.
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
    """The state of a running robot after the last message from its coordinator.

    Args:
        robot: the robot.
        status: first status message.

    Attributes:
        robot: the robot.
        said: the last warning, or the error of the last program; empty if there is none.
        parts: places of the cell's workpieces; None if no cell is known or it has no workpieces.
    """

    def __init__(self, robot: Robot, status: Status) -> None:
        self.robot = robot
        self.said = ""
        self.parts: LiveParts | None = None
        self.look(status)

    def look(self, status: Status) -> None:
        """Replace the state by a complete status, for example after events were missed."""
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
        """Update the state from an event."""
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
        """Return the actual joint positions (n,) [rad or m].

        None if no message has reported them yet, or if the message's joints aren't those of the robot.
        """
        told = self._known.joints
        if told is None or told.keys() != set(self.robot.joint_names):
            return None
        return joints_of(self.robot, told)

    @property
    def is_under_way(self) -> bool:
        """Return True while the robot runs a program or a single command.

        During this time, the view itself follows the workpieces that the robot moves, since the coordinator
        updates their places only afterwards.
        """
        return bool(self._known.under_way)

    @property
    def stale(self) -> str:
        """Return the reason why the positions are outdated; empty if they aren't."""
        return self._why if self._known.state is State.DISCONNECTED else ""

    def html(self, stage: Stage, q: Array) -> str:
        """Return the figures beside the picture as HTML: state, command, times, override, and the robot's
        position.

        Args:
            stage: the scene that is drawn.
            q: (n,) joint positions [rad or m].
        """
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
