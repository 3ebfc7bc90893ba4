"""The values of a command to goals: the only place where mm and deg become m and rad."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from yarclang.commands.spec import Values
from yarclang.diagnostics import Collector, suggest
from yarclang.hir import Array, FrameLink, JointDelta, JointGoal, PoseDelta, PoseGoal, Reading, Timing
from yarclang.robot.model import Robot
from yarclang.semantics.amounts import Amount, AmountError
from yarclang.semantics.context import Defaults
from yarclang.semantics.frames import base_axes, known_frame, moving_frame
from yarclang.semantics.names import ResolvedName
from yarclang.semantics.poses import check_limits, rotation_of
from yarclang.semantics.scope import KINDS, Frame, JointPosition, Scope
from yarclang.semantics.times import acceleration_share
from yarclang.semantics.units import amount, missing_unit, number_fault
from yarclang.syntax.ast import Computed, Number, Option, Statement, Value, WayPoint, Word
from yarclang.transforms import constant
from yarclang.units import Kind, Unit

_WHAT = {"length": "the lengths", "angle": "the angles", "time": "the time"}


@dataclass(slots=True)
class Line:
    """A motion command that is being read: where it stands, and what it needs to be understood."""

    statement: Statement
    name: ResolvedName
    values: Values
    robot: Robot
    defaults: Defaults
    scope: Scope
    units: Mapping[Kind, Unit] | None
    findings: Collector
    links: tuple[FrameLink | None, FrameLink | None] = (None, None)
    """The frame that is moved and that of the values, once the goals were read."""
    tool: FrameLink | None = None
    """The frame that is moved, also by joint values, which it doesn't change."""
    _told: set[str] = field(default_factory=set)

    def goals(self) -> tuple[object, ...]:
        """The goals of all way-points, or what could be made of them beside the findings."""
        statement, name = self.statement, self.name
        frames = self._frames()
        near = self._near()
        least, most = name.spec.waypoints
        given = len(statement.waypoints)
        if given < least or (most is not None and given > most):
            if given == 0:
                labels = self.values.labels(self.robot.joint_names)
                message = f"{name.spec.name} wants {len(labels)} values ({' '.join(labels)}), 0 are given"
                self.findings.add("Y0401", message, statement.head_span, _example(name))
                return ()
            wanted = "one way-point" if most == 1 else f"{least} or more way-points"
            place = statement.waypoints[min(given, most or given) - 1 if given < least else least].place
            message = f"{name.spec.name} takes {wanted}, {given} {'is' if given == 1 else 'are'} given"
            self.findings.add("Y0405", message, statement.span(place), _example(name))
        goals: list[object] = []
        for number, waypoint in enumerate(statement.waypoints, 1):
            goal = self._named_goal(waypoint)
            if goal is None:
                values = self._values(number)
                numbers = self._numbers(waypoint, number, values)
                if numbers is None:
                    continue
                goal = self._goal(waypoint, numbers, values, frames)
            if isinstance(goal, PoseGoal) and near is not None:
                goal = replace(goal, near=near)
            if goal is not None:
                goals.append(goal)
        return tuple(goals)

    def limited(self, timing: Timing) -> tuple[Timing, float | None, Reading | None]:
        """The timing with what ACC says, the tolerance [m] of TOL, and the distance or angle of BLEND."""
        tolerance, blend = None, None
        seen: set[str] = set()
        for option in self.statement.options:
            word, span = option.word.name, self.statement.span(option.word.place)
            if word in seen:
                self.findings.add("Y0412", f"{word} stands twice", span, "leave one of them")
            seen.add(word)
            if word == "ACC":
                timing = replace(
                    timing, ramp=acceleration_share(option, self.statement, self.scope, self.findings)
                )
            elif word == "TOL":
                tolerance = self._tolerance(option)
            elif word == "BLEND":
                blend = self._blend(option)
        return timing, tolerance, blend

    def _blend(self, option: Option) -> Reading | None:
        """BLEND 5: how far from its end the path may be left, read as a length [m] and as an angle [rad]."""
        span = self.statement.span((option.argument or option.word).place)
        if not isinstance(option.argument, Number | Computed):
            self.findings.add("Y0412", "BLEND takes a distance or an angle", span, "for example BLEND 5")
            return None
        found = amount(option.argument, self.scope, self.statement, self.findings)
        if found is None:
            return None
        if found.value < 0.0:
            self.findings.add("Y0412", f"BLEND {found}: a distance from the corner is 0 or more", span)
            return None
        if found.unit is not None:
            length, angle = (
                found.value * found.unit.factor if found.unit.kind == kind else None
                for kind in ("length", "angle")
            )
            if length is None and angle is None:
                self.findings.add("Y0307", f"{found} is neither a length nor an angle", span)
            return Reading(length, angle)
        units = self.units or {}
        length, angle = (found.value * units[kind].factor if kind in units else None for kind in _OF_BLENDS)
        return Reading(length, angle)

    def _tolerance(self, option: Option) -> float | None:
        span = self.statement.span((option.argument or option.word).place)
        if not isinstance(option.argument, Number | Computed):
            self.findings.add("Y0412", "TOL takes a distance", span, "for example TOL 0.05")
            return None
        found = amount(option.argument, self.scope, self.statement, self.findings)
        unit = (self.units or {}).get("length")
        if found is None:
            return None
        if unit is None and found.unit is None:
            self._missing("length", span)
            return None
        try:
            metres = found.in_unit(unit) * unit.factor if unit else found.value * (found.unit or _NONE).factor
        except AmountError as error:
            self.findings.add(error.code, error.message, span, error.help)
            return None
        if metres <= 0.0:
            self.findings.add("Y0412", f"TOL {found}: a tolerance is above 0", span)
            return None
        return metres

    def _near(self) -> Array | None:
        """NEAR name: the joint position to which the solution shall be near."""
        for option in self.statement.options:
            if option.word.name != "NEAR":
                continue
            span = self.statement.span((option.argument or option.word).place)
            if self.values.of_joints or self.name.spec.targets.get("") is not Values.JOINTS:
                message = "NEAR chooses among joint positions of a pose: only MOVEJ and its kin with _RPY or _QUAT take it"
                self.findings.add("Y0412", message, span, "take it away")
            elif not isinstance(word := option.argument, Word):
                self.findings.add(
                    "Y0412", "NEAR takes the name of a joint position", span, "for example NEAR HOME"
                )
            else:
                found = self._joint_position(word)
                return None if found is None else found.q
        return None

    def _frames(self) -> tuple[Frame, Frame] | None:
        """The moving frame on the flange and the base axes; None for joint values or with errors."""
        statement, defaults = self.statement, self.defaults
        if self.values.of_joints or (_takes_names(self.name) and _all_named(statement)):
            # joint values need no frames; those given change nothing, but have to exist
            for frame in (statement.moving, statement.base):
                if frame is not None:
                    known_frame(statement, frame, self.scope, self.findings)
            self.tool = self._tool()
            return None
        moving = base = None
        if statement.moving is not None:
            moving = moving_frame(statement, statement.moving, self.scope, self.findings)
        elif defaults.moving is not None and defaults.statement is not None:
            moving = moving_frame(defaults.statement, defaults.moving, defaults.scope, self.findings)
        else:
            help_ = "write it behind the name, as {TCP}, or in DEFAULT"
            message = f"{self.name.full} doesn't say which frame it moves"
            self.findings.add("Y0302", message, statement.head_span, help_)
        may_move = self.name.spec.frames_may_move
        if statement.base is not None:
            base = base_axes(statement, statement.base, self.scope, may_move, self.findings)
        elif defaults.base is not None and defaults.statement is not None:
            base = base_axes(defaults.statement, defaults.base, defaults.scope, may_move, self.findings)
        else:
            help_ = "write the base frame behind the units, as {B}, or in DEFAULT"
            message = f"{self.name.full} doesn't say in which frame its values are given"
            self.findings.add("Y0302", message, statement.head_span, help_)
        if moving is None or base is None:
            return None
        self.links = moving.link, base.link
        self.tool = moving.link
        return moving, base

    def _tool(self) -> FrameLink | None:
        """The frame that the line or DEFAULT names, if it sits on the flange; what is wrong with it matters only where it is needed."""
        unheard = Collector(self.findings.source)
        moving, statement, scope = self.statement.moving, self.statement, self.scope
        if moving is None:
            defaults = self.defaults
            if defaults.moving is None or defaults.statement is None:
                return None
            moving, statement, scope = defaults.moving, defaults.statement, defaults.scope
        frame = moving_frame(statement, moving, scope, unheard)
        return None if frame is None else frame.link

    def _named_goal(self, waypoint: WayPoint) -> object | None:
        """A way-point that is one name of a joint position: for commands that take joint values, whatever the target."""
        if len(waypoint.values) != 1 or not isinstance(word := waypoint.values[0], Word):
            return None
        if not _takes_names(self.name) or word.name in {"NAN", "INF", "INFINITY"}:
            return None
        found = self._joint_position(word)
        # without one there is an error, and the goal is never used
        return JointGoal(self.robot.home if found is None else found.q)

    def _joint_position(self, word: Word) -> JointPosition | None:
        found = self.scope.name(word.name)
        if isinstance(found, JointPosition):
            return found
        span = self.statement.span(word.place)
        if found is not None:
            self.findings.add("Y0209", f"{word.text} is {KINDS[type(found)]}, not a joint position", span)
            return None
        known = sorted(set(self.scope.names(JointPosition)))
        meant = suggest(word.text, known)
        help_ = (meant + " " if meant else "") + f"there are {', '.join(known)}"
        self.findings.add("Y0205", f"no joint position is named {word.text}", span, help_)
        return None

    def _values(self, number: int) -> Values:
        """What the values of a way-point (from 1) mean."""
        leading = self.name.spec.leading
        return leading[number - 1] if number <= len(leading) else self.values

    def _numbers(self, waypoint: WayPoint, number: int, values: Values) -> Array | None:
        """The values of a way-point in SI."""
        labels = values.labels(self.robot.joint_names)
        faults = 0
        for value in waypoint.values:
            fault = number_fault(value)
            if fault is not None:
                code, message, help_ = fault
                if isinstance(value, Word) and isinstance(self.scope.name(value.name), JointPosition):
                    help_ = f"{value.name} is a joint position: MOVEJ goes there"
                elif isinstance(value, Word) and isinstance(self.scope.name(value.name), Amount):
                    help_ = f"write ${value.name} for its value"
                self.findings.add(code, message, self.statement.span(value.place), help_)
                faults += 1
        if faults:
            return None
        if len(waypoint.values) != len(labels):
            many = len(self.statement.waypoints) > 1
            which = f"way-point {number} of {self.name.spec.name}" if many else self.name.full
            given = len(waypoint.values)
            difference = len(labels) - given
            help_ = (
                f"{difference} missing: {' '.join(labels[given:])}"
                if difference > 0
                else f"{-difference} surplus"
            )
            verb = "is" if given == 1 else "are"
            message = f"{which} wants {len(labels)} values ({' '.join(labels)}), {given} {verb} given"
            self.findings.add("Y0401", message, self.statement.span(waypoint.place), help_)
            return None
        if self.units is None:
            return None
        joint_kinds: tuple[Kind, ...] = tuple(
            "length" if unit == "mm" else "angle" for unit in self.robot.axis_unit_names
        )
        return self._in_si(waypoint, values.kinds(joint_kinds))

    def _in_si(self, waypoint: WayPoint, kinds: tuple[Kind | None, ...]) -> Array | None:
        """Numbers in SI; a missing unit is told once a line."""
        numbers = np.empty(len(kinds))
        complete = True
        units = self.units or {}
        for place, (value, kind) in enumerate(zip(waypoint.values, kinds, strict=True)):
            unit = None if kind is None else units.get(kind)
            if isinstance(value, Number):
                if kind is None:
                    numbers[place] = value.value
                elif unit is not None:
                    numbers[place] = value.value * unit.factor
                else:
                    self._missing(kind, self.statement.span(self.statement.waypoints[0].place))
                    complete = False
                continue
            found = self._computed(value, kind, unit)
            if found is None:
                complete = False
            else:
                numbers[place] = found
        return numbers if complete else None

    def _computed(self, value: Value, kind: Kind | None, unit: Unit | None) -> float | None:
        """The value of an expression in SI."""
        found = amount(value, self.scope, self.statement, self.findings)
        if found is None:
            return None
        span = self.statement.span(value.place)
        try:
            if kind is None:
                return found.plain("a part of a quaternion")
            if unit is not None:
                return found.in_unit(unit) * unit.factor
            if found.unit is not None:
                if found.unit.kind != kind:
                    raise AmountError(
                        "Y0307", f"{found} is of the wrong kind: this place takes {_WHAT[kind]}"
                    )
                return found.value * found.unit.factor
        except AmountError as error:
            self.findings.add(error.code, error.message, span, error.help)
            return None
        self._missing(kind, span)
        return None

    def _missing(self, kind: Kind, span: object) -> None:
        if kind in self._told:
            return
        self._told.add(kind)
        message, help_ = missing_unit(kind, _WHAT[kind])
        self.findings.add("Y0304", message, span, help_)  # type: ignore[arg-type]

    def _goal(
        self, waypoint: WayPoint, numbers: Array, values: Values, frames: tuple[Frame, Frame] | None
    ) -> object | None:
        """One goal from values in SI."""
        span, findings = self.statement.span(waypoint.place), self.findings
        if values is Values.JOINTS:
            check_limits(self.robot, numbers, findings, span)
            return JointGoal(constant(numbers))
        if values is Values.JOINT_DELTAS:
            return JointDelta(constant(numbers))
        if values is Values.POSITION:
            return None if frames is None else constant((frames[1].transform @ np.append(numbers, 1.0))[:3])
        rotation = rotation_of(values, numbers[3:], findings, span)
        if rotation is None or frames is None:
            return None
        flange_from_moving, axes = frames[0].transform, frames[1]
        if values.is_delta:
            turned = np.abs(numbers[3:]).max() if not values.is_quaternion else 0.0
            cosine = (np.trace(rotation) - 1.0) / 2.0
            if turned >= np.pi - 1e-9 or cosine <= -1.0 + 1e-12:
                message = "an increment of half a turn or more has no short way"
                findings.add("Y0409", message, span, "make two commands of it")
                return None
            return PoseDelta(
                constant(numbers[:3]),
                constant(rotation),
                constant(axes.transform[:3, :3]),
                axes.on_flange,
                flange_from_moving,
            )
        pose = np.eye(4)
        pose[:3, :3] = rotation
        pose[:3, 3] = numbers[:3]
        return PoseGoal(constant(axes.transform @ pose), flange_from_moving)


_OF_BLENDS: tuple[Kind, ...] = ("length", "angle")

_NONE = Unit("", "length", 1.0)


def _example(name: ResolvedName) -> str:
    return f"for example: {name.spec.examples[0].splitlines()[0]}"


def _takes_names(name: ResolvedName) -> bool:
    """Whether names of joint positions may stand for way-points: where the command takes joint values at all."""
    return name.spec.targets.get("") is Values.JOINTS


def _all_named(statement: Statement) -> bool:
    """Whether every way-point is one word: the name of a joint position."""
    return bool(statement.waypoints) and all(
        len(waypoint.values) == 1 and isinstance(waypoint.values[0], Word) for waypoint in statement.waypoints
    )
