"""The certificate: the proved properties of a controller text, for each command and for the whole program."""

from __future__ import annotations

import math
from array import array
from dataclasses import field
from typing import Any, Literal

from yarclang.certify.outward import least, most, percent, up, up_to
from yarclang.certify.read.text import ControllerText
from yarclang.frozen import frozen
from yarclang.lasting import Lasting
from yarclang.robot.model import Tolerance
from yarclang.units import DEG, MM, MS

Kind = Literal["joint", "avoid", "line", "arc", "spline", "pose_spline", "timed"]
Quantity = Literal["position", "velocity", "acceleration", "jerk", "motor_velocity", "hold", "torque"]


@frozen
class Load:
    """The joint or motor that comes nearest to its limit, and the fraction of the limit that it uses.

    For positions, the fraction is the distance from the middle of the range, divided by half of the range.

    Attributes:
        name: name of the joint or motor; empty if there is no motion or no limit.
        share: used fraction of the limit (1.0 is at the limit).
    """

    name: str
    share: float

    def to_json(self) -> dict[str, Any]:
        """Return the name and the share for JSON."""
        return {"name": self.name, "share": _number(self.share)}


IDLE = Load("", 0.0)

QUANTITIES: tuple[Quantity, ...] = ("position", "velocity", "acceleration", "jerk", "motor_velocity", "hold")


@frozen(eq=False)
class Peaks:
    """The largest loads of N commands: by command and quantity, the joint or motor nearest to its limit.

    The loads are in flat arrays, which need little memory, since a long text has many commands. Entry
    `row` * len(QUANTITIES) + k of `joints` and `shares` belongs to command `row` and quantity k.

    Attributes:
        names: for each quantity, the names of all joints or motors.
        joints: index of the most used joint or motor in the `names` of its quantity.
        shares: fraction of the limit that this joint or motor uses.
    """

    names: tuple[tuple[str, ...], ...]
    joints: array[int]
    shares: array[float]


@frozen(eq=False)
class Loads:
    """The loads of one command, stored in the arrays of many commands.

    Attributes:
        peaks: the loads of many commands; None if all loads are zero.
        row: the number of the command in `peaks`.
    """

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
        """Return the used fraction of the limit of one of `QUANTITIES` (1.0 is at the limit)."""
        if self.peaks is None:
            return 0.0
        share = self.peaks.shares[self.row * len(QUANTITIES) + _NUMBERS[quantity]]
        return share if share > 0.0 else 0.0

    def __eq__(self, other: object) -> bool:
        """Return True if all loads are equal."""
        return isinstance(other, Loads) and self._all == other._all

    def __hash__(self) -> int:
        """Return the hash of all loads."""
        return hash(self._all)

    def __repr__(self) -> str:
        """Return a text with the loads of this command only."""
        return f"Loads{self._all}"

    @property
    def _all(self) -> tuple[Load, ...]:
        return tuple(map(self.of, QUANTITIES))


_NUMBERS = {quantity: number for number, quantity in enumerate(QUANTITIES)}


@frozen
class Deviation:
    """Upper bounds of the distance between the executed path and the programmed one.

    For lines, arcs and splines of poses, this is the distance of the moving frame from its programmed path.
    For joint motions, it is the larger of two distances: that of a joint from its programmed position, and
    that of the moving frame from a pose that is programmed as a goal. Next to blends, only the part of the
    path outside of the blends counts. A bound is infinite if nothing could be proved.

    Attributes:
        position: distance [m].
        angle: angle [rad].
        end_position: distance of the end from the goal [m]; zero if the motion flows into the next one.
        end_angle: angle between the end and the goal [rad]; zero if the motion flows into the next one.
        remainder_position: part of `position` that bounds the error between sampled points [m].
        remainder_angle: part of `angle` that bounds the error between sampled points [rad].
    """

    position: float
    angle: float
    end_position: float
    end_angle: float
    remainder_position: float = 0.0
    remainder_angle: float = 0.0

    def to_json(self) -> dict[str, Any]:
        """Return the bounds for JSON, in mm and deg."""
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
    """Proved bounds of a blend, in which one motion flows into the next.

    The bounds also cover the parts of both programmed paths that the blend cuts off.

    Attributes:
        segments: number of segments of the blend. Half of them belong to the first motion.
        radius: allowed distance from the programmed corner [m]. If it is 0, both paths are followed up to the
            corner.
        turn: allowed angle from the programmed corner [rad].
        position: largest distance of the moving frame from the corner [m]; between two joint motions, of the
            prismatic joints.
        angle: largest angle of the moving frame from the corner [rad]; between two joint motions, of the
            revolute joints.
        passed: segment in which a corner without a ball is passed, counted from the middle of the blend; None
            for a corner with a ball.
    """

    segments: int
    radius: float
    turn: float
    position: float
    angle: float
    passed: int | None = None

    def to_json(self) -> dict[str, Any]:
        """Return the bounds for JSON, in mm and deg."""
        bounds = {
            "segments": self.segments,
            "radius_mm": _number(self.radius / MM),
            "turn_deg": _number(self.turn / DEG),
            "position_mm": _number(most(self.position, MM)),
            "angle_deg": _number(most(self.angle, DEG)),
        }
        return bounds if self.passed is None else {**bounds, "corner_segment": self.passed}


@frozen
class ToolSpeed:
    """Proved bounds of the speed of the moving frame.

    The speed is that of the frame's origin [m/s], or, with `turns`, the angular speed [rad/s]. `least` and
    `most` cover the time from when the programmed speed is first reached to when it is last left, without
    blends. They are NaN if the programmed speed is never reached.

    Attributes:
        turns: True if the path only turns the frame.
        largest: largest speed during the whole command.
        programmed: the programmed speed; NaN without one.
        least: least speed during the time described above.
        most: largest speed during the time described above.
        beyond: largest ratio of the speed to the allowed speed.
    """

    turns: bool
    largest: float
    programmed: float
    least: float
    most: float
    beyond: float

    def to_json(self) -> dict[str, Any]:
        """Return the bounds for JSON, in mm/s or deg/s."""
        unit, name = (DEG, "deg_s") if self.turns else (MM, "mm_s")
        values = {"largest": most(self.largest, unit)}
        if not math.isnan(self.programmed):
            values["programmed"] = self.programmed / unit
            values["cruise_least"], values["cruise_most"] = least(self.least, unit), most(self.most, unit)
        return {f"{key}_{name}": _number(value) for key, value in values.items()}


@frozen
class Clearance:
    """Proved lower bound of the distance between two groups of bodies.

    Attributes:
        distance: lower bound of the distance [m].
        first: name of one of the two nearest bodies; empty if only the bound is known.
        second: name of the other body.
        at: time after the command's start at which the two bodies are nearest [s]; None if unknown.
    """

    distance: float
    first: str = ""
    second: str = ""
    at: float | None = None

    def to_json(self) -> dict[str, Any]:
        """Return the distance and the names of the bodies for JSON, in mm."""
        return {
            "at_least_mm": _number(least(self.distance, MM)),
            "bodies": [self.first, self.second] if self.first else None,
            **({} if self.at is None else {"at_s": self.at}),
        }


@frozen
class MayTouch:
    """Two bodies that are allowed to touch during a command, so that the distance between them isn't checked.

    Attributes:
        first: name of one body, in upper case.
        second: name of the other body, after `first` in alphabetical order.
        giver: the line of the program or cell that allows the bodies to touch, in words.
        needed: True if the bodies come closer to each other than their margin, or touch.
    """

    first: str
    second: str
    giver: str
    needed: bool

    @property
    def pair(self) -> str:
        """The names of both bodies."""
        return f"{self.first} and {self.second}"

    def to_json(self) -> dict[str, Any]:
        """Return the names of the bodies and the allowance for JSON."""
        return {"bodies": [self.first, self.second], "allowed_by": self.giver, "needed": self.needed}


@frozen
class KeptRule:
    """A rule of KEEP that a command respects, such as an upright cup, with the proved bounds.

    Attributes:
        rule: the rule in words, such as "{CUP} UPRIGHT 10 (deg) {B}".
        limit: largest allowed angle [rad]; for ABOVE, least allowed height over the plane [m].
        largest: upper bound of the angle [rad]; None for ABOVE, whose plane is treated as a zone's border.
        nearest: for FACING and SEEN, lower bound of the point's distance from the cone's apex [m]; otherwise
            None.
        farthest: for FACING and SEEN, upper bound of the same distance [m]; otherwise None.
    """

    rule: str
    limit: float
    largest: float | None
    nearest: float | None = None
    farthest: float | None = None

    def to_json(self) -> dict[str, Any]:
        """Return the rule and its bounds for JSON, with the angle in deg and distances in mm."""
        values: dict[str, Any] = {"rule": self.rule}
        if self.largest is not None:
            values["largest_deg"] = _number(most(self.largest, DEG))
        if self.nearest is not None and self.farthest is not None:
            values["nearest_mm"] = _number(least(self.nearest, MM))
            values["farthest_mm"] = _number(most(self.farthest, MM))
        return values


@frozen
class ZoneSpeed:
    """Proved upper bound of the speed of a body in a slow zone, or in a motion with its own speed limit.

    Attributes:
        largest: upper bound of the speed [m/s].
        limit: allowed speed [m/s].
        part: name of the body.
        zone: name of the zone; empty with `of_motion`.
        of_motion: True if the limit is the motion's own (`[V<=250]`).
    """

    largest: float
    limit: float
    part: str
    zone: str
    of_motion: bool = False

    @property
    def share(self) -> float:
        """Ratio of the speed to the allowed speed."""
        return self.largest / self.limit

    def to_json(self) -> dict[str, Any]:
        """Return the bound and the limit for JSON, in mm/s."""
        return {
            "largest_mm_s": _number(most(self.largest, MM)),
            "limit_mm_s": _number(self.limit / MM),
            "part": self.part,
            "zone": self.zone,
        }


@frozen
class CommandCertificate:
    """Proved properties of one motion command.

    Attributes:
        step: index of the step in the program.
        index: the command's label, such as P0010.
        name: the command's name.
        kind: kind of motion.
        source_line: line in the source.
        lines: first and last move line in the controller text; None without moves.
        segments: number of segments.
        segment_time: duration of each segment [s].
        duration: duration of the motion [s].
        programmed_duration: programmed duration [s]; None if the motion is to be as fast as the limits allow.
        loads: the loads of joints and motors. The load `hold` is that of braking on the path at the worst
            moment, |a| + |v| / hold time, relative to the acceleration of an emergency stop. It is stated,
            not judged.
        deviation: distance from the programmed path.
        tool_speed: speed of the moving frame; Cartesian motions only.
        blended: the blend after the command.
        jerk_judged: False if the jerk is stated, not judged: in a timetable, in a motion whose profile lets
            the acceleration jump, and in blends with such a motion.
        clearance: distance of the robot and its load from the cell.
        own_clearance: distance of the bodies of the robot and its load from each other.
        zone_clearance: distance of the watched bodies from borders that they must not cross. It names the
            watched body and the zone.
        zone_speed: speed in the slow zone in which the command comes nearest to the zone's speed limit.
        torque: the joint that comes nearest to its effort limit; None if the robot's masses or effort limits
            are unknown.
        carries: parts that grippers carry during the motion.
        may_touch: bodies that are allowed to touch, so that the distance between them isn't checked.
        kept: rules of KEEP that the command respects.
        module: module that contains `source_line`; empty for the program itself.
        tolerance: the command's own tolerance; None if the general one applies.
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
    may_touch: tuple[MayTouch, ...] = ()
    kept: tuple[KeptRule, ...] = ()
    module: str = ""
    tolerance: Tolerance | None = None

    @property
    def position(self) -> Load:
        """The load of the joint nearest to an end of its range."""
        return self.loads.of("position")

    @property
    def velocity(self) -> Load:
        """The largest load of a joint's velocity."""
        return self.loads.of("velocity")

    @property
    def acceleration(self) -> Load:
        """The largest load of a joint's acceleration."""
        return self.loads.of("acceleration")

    @property
    def jerk(self) -> Load:
        """The largest load of a joint's jerk."""
        return self.loads.of("jerk")

    @property
    def motor_velocity(self) -> Load:
        """The largest load of a motor's velocity."""
        return self.loads.of("motor_velocity")

    @property
    def hold(self) -> Load:
        """The largest load of a joint in a hold at the worst moment."""
        return self.loads.of("hold")

    def to_json(self) -> dict[str, Any]:
        """Return the properties for JSON, with the unit in each name."""
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
            **({"keeps": [one.to_json() for one in self.kept]} if self.kept else {}),
            **({"not_checked": [one.to_json() for one in self.may_touch]} if self.may_touch else {}),
        }


@frozen
class Certificate:
    """Proved properties of a whole program, command by command.

    The proofs are about the motion that the controller is commanded to make. They don't cover the following
    error of the servo loop, or the controller's own rounding.

    Attributes:
        target: name of the target controller.
        commands: the certificates of all motion commands.
        tolerance: the general tolerance, for commands without their own.
        text: the judged text; a runtime sends exactly its lines.
    """

    target: str
    commands: tuple[CommandCertificate, ...]
    tolerance: Tolerance
    text: ControllerText = field(repr=False, compare=False)

    @property
    def duration(self) -> float:
        """Duration of all motions and dwells [s], along the branches that take longest, without waits."""
        return self.lasting.most

    @property
    def lasting(self) -> Lasting:
        """Duration of the text, as read by the judge."""
        return self.text.schedule.lasting

    @property
    def position(self) -> float:
        """Largest deviation in position of all commands [m]."""
        return max((command.deviation.position for command in self.commands), default=0.0)

    @property
    def angle(self) -> float:
        """Largest deviation in angle of all commands [rad]."""
        return max((command.deviation.angle for command in self.commands), default=0.0)

    def worst(self, kind: Quantity) -> Load:
        """Return the largest load of a quantity among all commands."""
        if kind == "torque":
            torques = [command.torque or IDLE for command in self.commands]
            return max(torques, key=lambda load: load.share, default=IDLE)
        loads = [command.loads for command in self.commands]
        return max(loads, key=lambda one: one.share_of(kind)).of(kind) if loads else IDLE

    def to_json(self) -> dict[str, Any]:
        """Return the whole certificate for JSON, with the unit in each name."""
        return {**self.whole_to_json(), "commands": [command.to_json() for command in self.commands]}

    def whole_to_json(self) -> dict[str, Any]:
        """Return the properties of the whole program for JSON, without those of single commands."""
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
        """Return a summary of the certificate in one line of ASCII, for the header of the controller text."""
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
        notes = ""
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
            notes = f"; jerk of {whose} up to {percent(max(free))} %, not judged"
        may = [len(command.may_touch) for command in self.commands if command.may_touch]
        if may:
            notes += f"; {sum(may)} pair{'s' * (sum(may) > 1)} of bodies may touch, unchecked"
        kept = [(one.nearest is None, one.largest) for each in self.commands for one in each.kept]
        if tilts := [most_ for is_tilt, most_ in kept if is_tilt and most_ is not None]:
            notes += f"; what is kept upright tilts by at most {up_to(most(max(tilts), DEG), 3)} deg"
        if angles := [most_ for is_tilt, most_ in kept if not is_tilt and most_ is not None]:
            notes += (
                f"; what is kept in a cone is at most {up_to(most(max(angles), DEG), 3)} deg off its axis"
            )
        return f"{path}; {loads} of the limits{notes}"


def bound_text(value: float, unit: float) -> str:
    """Return an upper bound in MM or DEG with four decimals.

    The number is rounded up, so that the printed bound is proved too.
    """
    return up(most(value, unit), 4)


def _number(value: float) -> float | None:
    """Return a number for JSON; None for infinity, which means that nothing was proved."""
    return value if math.isfinite(value) else None
