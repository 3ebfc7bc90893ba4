"""A client's actions for motions whose end isn't known in advance: jogs, velocities, and motions that follow
a master arm.
"""

from __future__ import annotations

import numpy as np

from yarclang.collision.zones.watched import Moving
from yarclang.coordinator.client.part import Part
from yarclang.coordinator.live.drive import Drive, check_finite
from yarclang.coordinator.live.opening import Settings, live_motion
from yarclang.coordinator.live.steering import Target
from yarclang.diagnostics import Result
from yarclang.lasting import NO_TIME

LIVE = Settings()
"""Default settings of live motions."""


class LiveMotion(Part):
    """Group of a client's actions: move the robot as long as the client sends targets."""

    async def drive(
        self, target: Target, *, moving: str = "{TCP}", settings: Settings = LIVE, name: str = "jog"
    ) -> Result[Drive]:
        """Begin a live motion: a jog, a motion at a given velocity, or a motion that follows a master. The
        motion continues as long as targets arrive.

        Args:
            target: first target.
            moving: frame whose speed is limited; a target that is a twist moves this frame.
            settings: limits of the motion.
            name: name of the motion, for messages.

        Returns:
            The motion; a finding instead if no live motion can begin here.

        Raises:
            NotOwner: this client only watches.
            Trouble: something is in progress, or there is no connection.
        """
        coordinator = self._coordinator
        coordinator.check_owner(self._name, "to move the robot")
        stops = coordinator.stops
        check_finite(target)
        await coordinator.look_around()
        frame, cell = coordinator.names.moving(moving), coordinator.names.cell()
        found = (*frame.diagnostics, *cell.diagnostics)
        if frame.value is None or cell.value is None:
            return Result(None, found)
        moved = Moving(moving.strip("{} ").upper(), np.asarray(frame.value.transform))
        here = await coordinator.commanded()
        around = cell.value.cell
        if around is not None and around.parts:
            around = coordinator.carrying.kept.now_for_lines(around, here)
        made = await coordinator.plan(live_motion, coordinator.robot, here, moved, around, settings, name)
        if made.value is None:
            return Result(None, made.diagnostics)
        live, generator = made.value
        engine = coordinator.engine
        generator.want(target, engine.session.now())
        running = await engine.begin(
            coordinator.carry_out(
                self._name, name, NO_TIME, lambda: coordinator.carrying.perform_live(live), stops
            ),
            name,
        )
        return Result(
            Drive(
                coordinator.robot,
                generator,
                running,
                engine.session.now,
                coordinator.stop,
                coordinator.tell,
                live.lead * live.job.segment,
                lambda: coordinator.check_owner(self._name, "to move the robot"),
            ),
            made.diagnostics,
        )
