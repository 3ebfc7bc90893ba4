"""What was proved: the table behind every program that yarcc writes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

from yarclang.robot.model import Tolerance
from yarclang.units import DEG, MM, MS

Kind = Literal["joint", "line", "spline"]
Quantity = Literal["position", "velocity", "acceleration", "jerk", "motor_velocity", "hold"]


@dataclass(frozen=True, slots=True)
class Load:
    """The joint (or motor) that is used most, and its share of its limit; 1.0 is the limit itself.

    For positions the share is |q - middle| / (half of the range). No name where there is no motion or no
    limit.
    """

    name: str
    share: float

    def to_json(self) -> dict[str, Any]:
        """Name and share."""
        return {"name": self.name, "share": _number(self.share)}


IDLE = Load("", 0.0)


@dataclass(frozen=True, slots=True)
class Deviation:
    """How far the executed path is from the programmed one, at most: `position` [m] and `angle` [rad].

    Of a line: the moving frame's. Of joint motions: each prismatic or revolute joint's, and the moving
    frame's at a pose that is programmed as a goal. `remainder_position` and `remainder_angle` are
    what of it comes from bounding between the places that were calculated. `end_position` and `end_angle`
    are the distance of the end from the goal. Infinite where nothing could be proved.
    """

    position: float
    angle: float
    end_position: float
    end_angle: float
    remainder_position: float = 0.0
    remainder_angle: float = 0.0

    def to_json(self) -> dict[str, Any]:
        """In mm and deg."""
        return {
            "position_mm": _number(self.position / MM),
            "angle_deg": _number(self.angle / DEG),
            "end_position_mm": _number(self.end_position / MM),
            "end_angle_deg": _number(self.end_angle / DEG),
            "remainder_position_mm": _number(self.remainder_position / MM),
            "remainder_angle_deg": _number(self.remainder_angle / DEG),
        }


@dataclass(frozen=True, slots=True)
class CommandCertificate:
    """What was proved for one motion command.

    `step` is its number in the program; `lines` are its first and last move line in the controller's text
    (None where it has none). Times are in s; `programmed_duration` is None for the shortest that the
    limits allow. `hold`
    is the most that a hold in the worst moment asks of a joint, |a| + |v| / hold time, against the
    acceleration of an emergency stop: stated, not judged.
    """

    step: int
    index: str
    name: str
    kind: Kind
    source_line: int
    lines: tuple[int, int] | None
    segments: int
    segment_time: float
    duration: float
    programmed_duration: float | None
    position: Load
    velocity: Load
    acceleration: Load
    jerk: Load
    motor_velocity: Load
    hold: Load
    deviation: Deviation

    def to_json(self) -> dict[str, Any]:
        """Plain data, the unit in each name."""
        return {
            "step": self.step,
            "index": self.index,
            "name": self.name,
            "kind": self.kind,
            "source_line": self.source_line,
            "first_pmc_line": self.lines[0] if self.lines else None,
            "last_pmc_line": self.lines[1] if self.lines else None,
            "segments": self.segments,
            "segment_time_ms": self.segment_time / MS,
            "duration_s": self.duration,
            "programmed_duration_s": self.programmed_duration,
            "position": self.position.to_json(),
            "velocity": self.velocity.to_json(),
            "acceleration": self.acceleration.to_json(),
            "jerk": self.jerk.to_json(),
            "motor_velocity": self.motor_velocity.to_json(),
            "hold": self.hold.to_json(),
            "deviation": self.deviation.to_json(),
        }


@dataclass(frozen=True, slots=True)
class Certificate:
    """What was proved for a whole program, command by command.

    The proofs are about the motion that the controller is told to make: they can't
    know the servo loop's following error nor the controller's own rounding.
    """

    target: Literal["rotary", "prog"]
    commands: tuple[CommandCertificate, ...]
    tolerance: Tolerance

    @property
    def duration(self) -> float:
        """The duration of all motions [s]."""
        return math.fsum(command.duration for command in self.commands)

    @property
    def position(self) -> float:
        """The largest deviation in position of all commands [m]."""
        return max((command.deviation.position for command in self.commands), default=0.0)

    @property
    def angle(self) -> float:
        """The largest deviation in angle of all commands [rad]."""
        return max((command.deviation.angle for command in self.commands), default=0.0)

    def worst(self, kind: Quantity) -> Load:
        """The largest load of a kind of all commands."""
        loads: list[Load] = [getattr(command, kind) for command in self.commands]
        return max(loads, key=lambda load: load.share, default=IDLE)

    def to_json(self) -> dict[str, Any]:
        """Plain data, the unit in each name."""
        kinds: tuple[Quantity, ...] = (
            "position",
            "velocity",
            "acceleration",
            "jerk",
            "motor_velocity",
            "hold",
        )
        return {
            "target": self.target,
            "duration_s": self.duration,
            "tolerance": {
                "position_mm": self.tolerance.position / MM,
                "angle_deg": self.tolerance.angle / DEG,
            },
            "deviation": {"position_mm": _number(self.position / MM), "angle_deg": _number(self.angle / DEG)},
            "loads": {kind: self.worst(kind).to_json() for kind in kinds},
            "commands": [command.to_json() for command in self.commands],
        }

    def summary(self) -> str:
        """One line for the header of the controller's text, ASCII."""
        shares = {
            "velocity": self.worst("velocity"),
            "acceleration": self.worst("acceleration"),
            "jerk": self.worst("jerk"),
            "motor speed": self.worst("motor_velocity"),
        }
        loads = ", ".join(f"{name} {load.share * 100.0:.0f} %" for name, load in shares.items())
        return f"path within {bound_text(self.position / MM)} mm, {bound_text(self.angle / DEG)} deg; {loads} of the limits"


def bound_text(value: float) -> str:
    """A bound with four decimals, rounded up: what is printed is proved as well."""
    return f"{math.ceil(value * 1e4 - 1e-9) / 1e4:.4f}" if math.isfinite(value) else "unproved"


def _number(value: float) -> float | None:
    """JSON has no infinity: null says that nothing was proved."""
    return value if math.isfinite(value) else None
