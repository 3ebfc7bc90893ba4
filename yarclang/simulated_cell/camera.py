"""A simulated camera. It sends the position of a workpiece to a program that accepts values from other
processes.

This module has no clock and does no I/O: its callers pass the time.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from yarclang.cell.model import Array, CellFrame, Parts
from yarclang.frozen import frozen
from yarclang.handling.parts import shift
from yarclang.runtime.notices import Wanted
from yarclang.units import DEG, MM

Deed = Literal["answer", "nothing", "late", "twice", "far", "nonsense"]
"""Reaction of a camera to a request. All reactions except `answer` are faults."""

_FAR = 10**8
"""Offset that the fault `far` adds to all values [counts]."""


@frozen(eq=False)
class CameraForm:
    """Description of a simulated camera.

    Attributes:
        name: name of the camera.
        part: kind of the parts (workpieces) for which the camera looks.
        frame: the frame in which the camera reports positions.
        registers: names of the registers that get the values found, by the keys `x`, `y`, `z` and `rz`; with
            the key `found`, the register that gets 1 if a part was found, and 0 if not.
        unit: size of one count [mm; deg for rz].
        delay: time from a request to the reply [s].
        does: reactions to the first requests, in order; some of them may be faults. Later requests are
            answered without a fault.
        lies: for each part, in the order of the parts, the displacement (4, 4) [m] from its place in the
            cell's file to its actual place, in the axes of `frame`. Parts beyond the end of this list are in
            the places of the file.
    """

    name: str
    part: str
    frame: CellFrame
    registers: Mapping[str, str]
    unit: float
    delay: float
    does: tuple[Deed, ...] = ()
    lies: tuple[Array, ...] = ()


@frozen(eq=False)
class Given:
    """Values that a camera sends in reply to a request.

    Attributes:
        camera: name of the camera.
        number: number of the request.
        values: values by the names of the registers.
    """

    camera: str
    number: int
    values: Mapping[str, Any]


class Camera:
    """A simulated camera.

    Args:
        form: description of the camera.
    """

    def __init__(self, form: CameraForm) -> None:
        self.form = form
        self._asked = 0
        self._due: list[tuple[float, Deed, Wanted]] = []
        self._late: Wanted | None = None

    @property
    def next_due(self) -> float:
        """Time of the camera's next reply [s]; inf if there is no request."""
        return min((when for when, _, _ in self._due), default=math.inf)

    def wanted(self, wanted: Wanted | None, now: float) -> None:
        """Handle a program's request for values. The request is ignored if the camera has no values for the
        registers.

        Args:
            wanted: the request; None if the program no longer waits for values.
            now: the time [s].
        """
        if wanted is None:
            late, self._late = self._late, None
            if late is not None:
                self._due.append((now + self.form.delay, "answer", late))
            return
        known = {name for name, _, _ in wanted.registers}
        own = set(self.form.registers.values())
        if not wanted.needed or not set(wanted.needed) <= own or not own <= known:
            return
        deed = self.form.does[self._asked] if self._asked < len(self.form.does) else "answer"
        self._asked += 1
        if deed == "late":
            self._late = wanted
        elif deed != "nothing":
            self._due.append((now + self.form.delay, deed, wanted))
            if deed == "twice":
                self._due.append((now + 2.0 * self.form.delay, "answer", wanted))

    def laid(self, parts: Parts) -> Parts:
        """Move parts from their places in the cell's file to their actual places, which differ by `lies`.
        Return all parts.
        """
        form = self.form
        if not form.lies or form.frame.mount.on_flange:
            return parts
        placed = form.frame.mount.transform
        for number, lies in enumerate(form.lies, 1):
            if any(one.part.body.name == form.part and one.number == number for one in parts.items):
                others = [one for one in parts.items if one.number != number]
                lying = replace(parts, items=tuple(one for one in parts.items if one.number == number))
                lying = shift(lying, (form.part,), placed @ lies @ np.linalg.inv(placed), 0)
                parts = replace(lying, items=(*others, *lying.items))
        return parts

    def answers(self, now: float, parts: Parts, flange: Callable[[], Array]) -> list[Given]:
        """Return the camera's replies that are due by now.

        Args:
            now: the time [s].
            parts: the parts and their poses.
            flange: returns the flange's pose (4, 4) [m], for a camera that the robot carries.
        """
        due = sorted((one for one in self._due if one[0] <= now), key=lambda one: one[0])
        self._due = [one for one in self._due if one[0] > now]
        return [
            Given(self.form.name, wanted.number, self._values(deed, wanted, parts, flange))
            for _, deed, wanted in due
        ]

    def _values(
        self, deed: Deed, wanted: Wanted, parts: Parts, flange: Callable[[], Array]
    ) -> dict[str, Any]:
        registers, ranges = self.form.registers, {name: (low, high) for name, low, high in wanted.registers}
        seen = self._seen(parts, flange)
        values = {} if seen is None else {registers[key]: seen[key] for key in registers if key != "found"}
        is_found = seen is not None and all(
            ranges[name][0] <= value <= ranges[name][1] for name, value in values.items()
        )
        if not is_found:  # there is no position to report
            values = {name: ranges[name][0] for key, name in registers.items() if key != "found"}
        if "found" in registers:
            values[registers["found"]] = int(is_found)
        if deed == "far":
            return {name: value + _FAR for name, value in values.items()}
        if deed == "nonsense":
            return dict.fromkeys(values, "somewhere")
        return dict(values)

    def _seen(self, parts: Parts, flange: Callable[[], Array]) -> dict[str, int] | None:
        """Return the position of the part that is nearest to the camera's frame and in no gripper [counts];
        None if there is no such part.
        """
        form = self.form
        lying = [one for one in parts.items if one.part.body.name == form.part and one.gripper is None]
        if not lying:
            return None
        mount = form.frame.mount
        base_from_frame = flange() @ mount.transform if mount.on_flange else mount.transform
        poses = (np.linalg.inv(base_from_frame) @ one.transform for one in lying)
        pose = min(poses, key=lambda one: float(np.linalg.norm(one[:3, 3])))
        turned = math.atan2(pose[1, 0], pose[0, 0]) / DEG
        told = dict(zip(("x", "y", "z"), (pose[:3, 3] / MM).tolist(), strict=True)) | {"rz": turned}
        return {key: round(value / form.unit) for key, value in told.items()}
