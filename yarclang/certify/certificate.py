"""What was proved: the table behind every program that yarcc writes."""

from __future__ import annotations

import math
from array import array
from dataclasses import field
from typing import Any, Literal

from yarclang.certify.outward import least, most, percent, up
from yarclang.certify.read.text import ControllerText
from yarclang.frozen import frozen
from yarclang.lasting import Lasting
from yarclang.robot.model import Tolerance
from yarclang.units import DEG, MM, MS

Kind = Literal["joint", "avoid", "line", "arc", "spline", "pose_spline", "timed"]
Quantity = Literal["position", "velocity", "acceleration", "jerk", "motor_velocity", "hold", "torque"]


@frozen
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

QUANTITIES: tuple[Quantity, ...] = ("position", "velocity", "acceleration", "jerk", "motor_velocity", "hold")


@frozen(eq=False)
class Peaks:
    """The largest loads of N commands, as arrays: a long text has many.

    Of each command and each of `QUANTITIES`, `joints` is the joint or motor that is used most, one of the quantity's `names`, and `shares` the share of its limit.
    """

    names: tuple[tuple[str, ...], ...]
    joints: array[int]
    shares: array[float]


@frozen(eq=False)
class Loads:
    """The loads of one command: number `row` of `peaks`; all idle without."""

    peaks: Peaks | None
    row: int

    def of(self, quantity: Quantity) -> Load:
        """Return the load of one of `QUANTITIES`."""
        if self.peaks is None:
            return IDLE
        number = _NUMBERS[quantity]
        place = self.row * len(QUANTITIES) + number
        share = self.peaks.shares[place]
        return Load(self.peaks.names[number][self.peaks.joints[place]], share) if share > 0.0 else IDLE

    def share_of(self, quantity: Quantity) -> float:
        """Return the share of the load of one of `QUANTITIES`."""
        if self.peaks is None:
            return 0.0
        share = self.peaks.shares[self.row * len(QUANTITIES) + _NUMBERS[quantity]]
        return share if share > 0.0 else 0.0

    def __eq__(self, other: object) -> bool:
        """Return True for the same loads."""
        return isinstance(other, Loads) and self._all == other._all

    def __hash__(self) -> int:
        """Return the hash of all loads."""
        return hash(self._all)

    def __repr__(self) -> str:
        """Return this command's loads, without those of the others."""
        return f"Loads{self._all}"

    @property
    def _all(self) -> tuple[Load, ...]:
        return tuple(map(self.of, QUANTITIES))


_NUMBERS = {quantity: number for number, quantity in enumerate(QUANTITIES)}


@frozen
class Deviation:
    """How far the executed path is from the programmed one, at most: `position` [m] and `angle` [rad].

    Of lines, arcs and splines of poses: the moving frame's. Of joint motions: each prismatic or revolute joint's, and the moving
    frame's at a pose that is programmed as a goal. `remainder_position` and `remainder_angle` are
    what of it comes from bounding between the places that were calculated. `end_position` and `end_angle`
    are the distance of the end from the goal; zero where the motion flows into the next one, and ends nowhere. Between two
    blends, only what lies between them counts. Infinite where nothing could be proved.
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
            "position_mm": _number(most(self.position, MM)),
            "angle_deg": _number(most(self.angle, DEG)),
            "end_position_mm": _number(most(self.end_position, MM)),
            "end_angle_deg": _number(most(self.end_angle, DEG)),
            "remainder_position_mm": _number(most(self.remainder_position, MM)),
            "remainder_angle_deg": _number(most(self.remainder_angle, DEG)),
        }


@frozen
class Blended:
    """What was proved where a motion flows into the next one, over `segments` segments, half of them its own.

    The moving frame is within `position` [m] of the programmed corner and turned by `angle` [rad] at most, where `radius` and `turn`
    are allowed; between two joint motions the joints are, prismatic by `position` and revolute by `angle`. So is what of
    both paths isn't followed. With a radius of 0 both paths are followed up to the corner.
    """

    segments: int
    radius: float
    turn: float
    position: float
    angle: float

    def to_json(self) -> dict[str, Any]:
        """In mm and deg."""
        return {
            "segments": self.segments,
            "radius_mm": _number(self.radius / MM),
            "turn_deg": _number(self.turn / DEG),
            "position_mm": _number(most(self.position, MM)),
            "angle_deg": _number(most(self.angle, DEG)),
        }


@frozen
class ToolSpeed:
    """How fast the moving frame goes: its origin [m/s], or, where its path only turns (`turns`), its angular speed [rad/s].

    All are proved bounds, not samples: `largest` of the whole command; of a `programmed` speed (NaN: none) also `least` and `most`
    from where it is first reached up to where it is last left, outside of blends (NaN: it never is). `beyond` is the largest
    speed as a share of what is allowed.
    """

    turns: bool
    largest: float
    programmed: float
    least: float
    most: float
    beyond: float

    def to_json(self) -> dict[str, Any]:
        """In mm/s or deg/s."""
        unit, name = (DEG, "deg_s") if self.turns else (MM, "mm_s")
        values = {"largest": most(self.largest, unit)}
        if not math.isnan(self.programmed):
            values["programmed"] = self.programmed / unit
            values["cruise_least"], values["cruise_most"] = least(self.least, unit), most(self.most, unit)
        return {f"{key}_{name}": _number(value) for key, value in values.items()}


@frozen
class Clearance:
    """How far apart the bodies of two kinds stay at least [m], and the two that come nearest.

    Without names, all of them stay farther apart than that. `at` is when, after the command's start, they were seen nearest [s]; None where that isn't told.
    """

    distance: float
    first: str = ""
    second: str = ""
    at: float | None = None

    def to_json(self) -> dict[str, Any]:
        """In mm."""
        return {
            "at_least_mm": _number(least(self.distance, MM)),
            "bodies": [self.first, self.second] if self.first else None,
            **({} if self.at is None else {"at_s": self.at}),
        }


@frozen
class ZoneSpeed:
    """How fast something goes at most while it is in a slow zone [m/s], a proved bound: `part` in `zone`, where `limit` is allowed.

    With `of_motion` it is no zone's speed but that which the motion says of itself (`[V<=250]`); `zone` is empty.
    """

    largest: float
    limit: float
    part: str
    zone: str
    of_motion: bool = False

    @property
    def share(self) -> float:
        """How much of what is allowed."""
        return self.largest / self.limit

    def to_json(self) -> dict[str, Any]:
        """In mm/s."""
        return {
            "largest_mm_s": _number(most(self.largest, MM)),
            "limit_mm_s": _number(self.limit / MM),
            "part": self.part,
            "zone": self.zone,
        }


@frozen
class CommandCertificate:
    """What was proved for one motion command.

    `step` is its number in the program; `lines` are its first and last move line in the controller's text
    (None where it has none). Times are in s; `programmed_duration` is None for the shortest that the
    limits allow. `hold`
    is the most that a hold in the worst moment asks of a joint, |a| + |v| / hold time, against the
    acceleration of an emergency stop: stated, not judged. `tool_speed` is that of Cartesian motions; `blended` is the blend behind
    the command. The jerk of a motion whose profile lets the acceleration jump, of blends with one, and of a timetable is stated as well, and not judged: `jerk_judged`.
    `clearance` is how near the robot and what it carries come to the cell, `own_clearance` how near they come to themselves, `zone_clearance` how near what zones
    watch comes to borders that it must not cross (its bodies are what is watched, and the zone), `zone_speed` how fast it is in slow zones, where that is nearest to
    what is allowed; None where there is nothing. `torque` is the largest share of a motor's effort, None of a robot whose masses or efforts aren't known. `module` is the module that `source_line` is in; empty for the program's own lines.
    `carries` are the parts that grippers hold meanwhile; `tolerance` is the command's own, None where that of all counts.
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
    loads: Loads
    deviation: Deviation
    tool_speed: ToolSpeed | None = None
    blended: Blended | None = None
    jerk_judged: bool = True
    clearance: Clearance | None = None
    own_clearance: Clearance | None = None
    zone_clearance: Clearance | None = None
    zone_speed: ZoneSpeed | None = None
    torque: Load | None = None
    carries: tuple[str, ...] = ()
    module: str = ""
    tolerance: Tolerance | None = None

    @property
    def position(self) -> Load:
        """The load of the joint that comes nearest to an end of its range."""
        return self.loads.of("position")

    @property
    def velocity(self) -> Load:
        """The load of the joint that is the fastest for its limit."""
        return self.loads.of("velocity")

    @property
    def acceleration(self) -> Load:
        """The load of the joint whose acceleration uses the largest share of its limit."""
        return self.loads.of("acceleration")

    @property
    def jerk(self) -> Load:
        """The load of the joint whose jerk uses the largest share of its limit."""
        return self.loads.of("jerk")

    @property
    def motor_velocity(self) -> Load:
        """The load of the motor that is the fastest for its limit."""
        return self.loads.of("motor_velocity")

    @property
    def hold(self) -> Load:
        """The load of the joint of which a hold in the worst moment asks most."""
        return self.loads.of("hold")

    def to_json(self) -> dict[str, Any]:
        """Plain data, the unit in each name."""
        return {
            "step": self.step,
            "index": self.index,
            "name": self.name,
            "kind": self.kind,
            "source_line": self.source_line,
            **({"module": self.module} if self.module else {}),
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
            "tool_speed": self.tool_speed.to_json() if self.tool_speed else None,
            "blend": self.blended.to_json() if self.blended else None,
            "jerk_judged": self.jerk_judged,
            "clearance": self.clearance.to_json() if self.clearance else None,
            "own_clearance": self.own_clearance.to_json() if self.own_clearance else None,
            "zone_clearance": self.zone_clearance.to_json() if self.zone_clearance else None,
            "zone_speed": self.zone_speed.to_json() if self.zone_speed else None,
            "torque": self.torque.to_json() if self.torque else None,
            "carries": list(self.carries),
        }


@frozen
class Certificate:
    """What was proved for a whole program, command by command.

    `text` is what was judged; it has the very lines that a runtime sends. The proofs are about the motion that the controller is told to make: they can't
    know the servo loop's following error nor the controller's own rounding.
    """

    target: str
    commands: tuple[CommandCertificate, ...]
    tolerance: Tolerance
    text: ControllerText = field(repr=False, compare=False)

    @property
    def duration(self) -> float:
        """The known time of all motions and dwells [s], along the longest ways. `lasting` counts the waits as well."""
        return self.lasting.most

    @property
    def lasting(self) -> Lasting:
        """How long the text takes, by the judge's own reading."""
        return self.text.schedule.lasting

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
        if kind == "torque":
            torques = [command.torque or IDLE for command in self.commands]
            return max(torques, key=lambda load: load.share, default=IDLE)
        loads = [command.loads for command in self.commands]
        return max(loads, key=lambda one: one.share_of(kind)).of(kind) if loads else IDLE

    def to_json(self) -> dict[str, Any]:
        """Plain data, the unit in each name."""
        return {**self.whole_to_json(), "commands": [command.to_json() for command in self.commands]}

    def whole_to_json(self) -> dict[str, Any]:
        """Plain data of the program as a whole, without its commands."""
        kinds: tuple[Quantity, ...] = (
            "position",
            "velocity",
            "acceleration",
            "jerk",
            "motor_velocity",
            "hold",
        )
        if any(command.torque for command in self.commands):
            kinds = (*kinds, "torque")
        return {
            "target": self.target,
            **self.lasting.to_json(),
            "tolerance": {
                "position_mm": self.tolerance.position / MM,
                "angle_deg": self.tolerance.angle / DEG,
            },
            "deviation": {
                "position_mm": _number(most(self.position, MM)),
                "angle_deg": _number(most(self.angle, DEG)),
            },
            "loads": {kind: self.worst(kind).to_json() for kind in kinds},
        }

    def summary(self) -> str:
        """One line for the header of the controller's text, ASCII."""
        judged = [command.loads.share_of("jerk") for command in self.commands if command.jerk_judged]
        free = [command.loads.share_of("jerk") for command in self.commands if not command.jerk_judged]
        shares = {
            "velocity": self.worst("velocity").share,
            "acceleration": self.worst("acceleration").share,
            "jerk": max(judged, default=0.0),
            "motor speed": self.worst("motor_velocity").share,
        }
        if torque := [command.torque.share for command in self.commands if command.torque]:
            shares["torque"] = max(torque)
        loads = ", ".join(f"{name} {percent(share)} %" for name, share in shares.items())
        path = f"path within {bound_text(self.position, MM)} mm, {bound_text(self.angle, DEG)} deg"
        told = ""
        if free:
            kinds = {command.kind == "timed" for command in self.commands if not command.jerk_judged}
            whose = " and ".join(
                name
                for is_timed, name in (
                    (False, "motions whose profile has no limit of it"),
                    (True, "timetables"),
                )
                if is_timed in kinds
            )
            told = f"; jerk of {whose} up to {percent(max(free))} %, not judged"
        return f"{path}; {loads} of the limits{told}"


def bound_text(value: float, unit: float) -> str:
    """Return an upper bound in MM or DEG with four decimals, rounded up: what is printed is proved as well."""
    return up(most(value, unit), 4)


def _number(value: float) -> float | None:
    """JSON has no infinity: null says that nothing was proved."""
    return value if math.isfinite(value) else None
