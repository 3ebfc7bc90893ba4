"""A client's actions on the places of the cell's parts (workpieces and tools)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from yarclang.cell.model import Cell, Present
from yarclang.coordinator.client.part import Part
from yarclang.coordinator.kept_parts import Known
from yarclang.coordinator.placing import as_filed, gone, put
from yarclang.diagnostics import Result
from yarclang.handling.parts import first_parts
from yarclang.robot.model import Array
from yarclang.runtime.actions import Trouble


class Parts(Part):
    """Group of a client's actions: read and set the places of parts (workpieces and tools) in the session's
    cell.
    """

    def where(self, file: str | None = None) -> Result[Known]:
        """Return the known places of the parts in a cell.

        Args:
            file: file of the cell; None: the session's cell.

        Returns:
            The places. For a given file: None if no places are stored, so that the parts are in the places
            that the file gives.

        Raises:
            Trouble: the session's cell has no parts.
        """
        if file is not None:
            return Result(self._coordinator.carrying.kept.of_file(Path(file)))
        made = self._coordinator.names.cell()
        if made.value is None:
            return Result(None, made.diagnostics)
        return Result(self._known(made.value.cell))

    async def as_filed(self, part: str | None = None) -> Result[Known]:
        """Declare that a part (None: each part) is in the place that the cell's file gives.

        Raises:
            NotOwner: this client only watches, and the owner doesn't share the robot.
            Trouble: there is no part with this name, or the robot is moving.
        """
        return await self._say(lambda known: Result(as_filed(known, part)), part or "all parts")

    async def gone(self, part: str) -> Result[Known]:
        """Declare that a part is no longer in the cell.

        Raises:
            NotOwner: this client only watches, and the owner doesn't share the robot.
            Trouble: there is no part with this name, or the robot is moving.
        """
        return await self._say(lambda known: Result(gone(known, part)), part)

    async def put(self, part: str, frame: str, frame_from_part: Array) -> Result[Known]:
        """Declare the place of a part, or that a gripper holds it.

        Args:
            part: name of the part.
            frame: frame in which the place is given; a gripper's frame means that the gripper holds the part.
            frame_from_part: (4, 4) place of the part [m].

        Raises:
            NotOwner: this client only watches, and the owner doesn't share the robot.
            Trouble: there is no part with this name, or the robot is moving.
        """

        def placed(known: Known) -> Result[Known]:
            names, plain = self._coordinator.names, frame.strip(" {}").upper()
            grips = {one.frame: variable for variable, one in known.cell.grips.items()}
            gripper = grips.get(plain)
            found = names.base(frame) if gripper is None else names.moving(frame)
            if found.value is None:
                return Result(None, found.diagnostics)
            pose = np.asarray(found.value.transform) @ frame_from_part
            return Result(put(known, self._coordinator.robot, part, pose, gripper))

        return await self._say(placed, part)

    async def _say(self, change: Callable[[Known], Result[Known]], action: str) -> Result[Known]:
        coordinator = self._coordinator
        coordinator.check_pace(self._name, "to enter the places of parts")
        places = self.where()
        stands = await coordinator.stands()
        if places.value is None:
            return places
        changed = change(replace(places.value, stands=stands))
        if changed.value is None:
            return changed
        kept = coordinator.carrying.kept
        kept.say(changed.value)
        known = self._known(changed.value.cell)
        if coordinator.surroundings is not None:
            coordinator.surroundings.place(known.present.parts, known.cell)
        coordinator.tell(f"{self._name} has entered the place of {action}")
        return Result(known, places.diagnostics)

    def _known(self, cell: Cell | None) -> Known:
        if cell is None or not cell.parts:
            raise Trouble(
                "the session's cell has no parts", "declare them in its cell.toml: [[parts]]", "Y1601"
            )
        return self._coordinator.carrying.kept.known(cell) or Known(cell, Present(first_parts(cell)))
