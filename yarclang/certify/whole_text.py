"""Checks of a whole controller text (start, times, rests, limits, speeds), and certificate rows."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Set
from dataclasses import field
from types import MappingProxyType

import numpy as np

from yarclang import hir
from yarclang.certify.blends.flows import corners_of
from yarclang.certify.bodies.clearance import NOTHING_NEAR, Apart, find_clearances
from yarclang.certify.bodies.handled import Handled, follow
from yarclang.certify.bodies.torque import find_torques
from yarclang.certify.bodies.touching import may_touch
from yarclang.certify.bodies.zones import NO_ZONES, InZones, find_zones
from yarclang.certify.certificate import Blended, CommandCertificate, Deviation, Kind, Load, Loads, ToolSpeed
from yarclang.certify.flow import check_flow, check_rests
from yarclang.certify.judged import tolerance_of
from yarclang.certify.kinematics.pinocchio import disagreements
from yarclang.certify.motion.bounds import Cubics
from yarclang.certify.motion.joint import joint_weights
from yarclang.certify.motion.limits import NO_LOADS, POSITION_UNITS, RELATIVE, Excess, check_limits
from yarclang.certify.motion.lowered import above_lowered, find_lowered
from yarclang.certify.motion.speed import KEPT
from yarclang.certify.motion.timed import LATE, timed_tolerance
from yarclang.certify.read.layout import Layout, Place, chunks, moving_at_ends
from yarclang.certify.read.reader import reader_of
from yarclang.certify.read.text import ControllerText
from yarclang.diagnostics import Diagnostic
from yarclang.findings import CATALOGUE
from yarclang.frozen import frozen
from yarclang.robot.model import Array, Robot, Tolerance
from yarclang.source import Span
from yarclang.units import DEG, MM, MS

_REMEDIES = {
    "Y1159": "allow a larger tolerance (--tolerance), or use shorter segments (--tm)",
    "Y1160": "allow a larger tolerance (--tolerance): the controller's numbers have at most 9 decimals",
    "Y1163": "compile the program again",
}

KINDS: Mapping[type, Kind] = MappingProxyType(
    {
        hir.JointMove: "joint",
        hir.AvoidMove: "avoid",
        hir.LineMove: "line",
        hir.ArcMove: "arc",
        hir.SplineMove: "spline",
        hir.PoseSplineMove: "pose_spline",
        hir.TimedMove: "timed",
    }
)


_SAME_POSTURE = 1e-3
"""Largest difference of two joint positions in one posture [rad or m]. Two postures differ by much more, and
the pose at the end is compared closely.
"""


@frozen
class Judge:
    """The judgement of one controller text: its program, its robot, and the findings so far.

    Attributes:
        program: the program that the text was compiled from.
        robot: geometry, limits, actuation and controller.
        tolerance: the general tolerance, for motions without their own.
        findings: the findings so far.
        lines: for a text judged without its source, the line of the text shown in findings about each step.
        only: the steps about which findings are kept; None: all.
    """

    program: hir.Program
    robot: Robot
    tolerance: Tolerance
    findings: list[Diagnostic]
    lines: Mapping[int, int] = field(default_factory=dict)
    _handled: list[Handled] = field(default_factory=list)
    only: Set[int] | None = None

    def of_part(self, only: Set[int]) -> Judge:
        """Return a judge of a part of the text, which keeps only findings about the steps `only`."""
        return Judge(self.program, self.robot, self.tolerance, [], self.lines, self._handled, only)

    @property
    def handled(self) -> Handled:
        """The cell's state during each motion."""
        return self._handled[-1] if self._handled else Handled(self.program.cell, {}, {})

    def follow(self, layout: Layout) -> None:
        """Trace where the parts of the cell are during the whole text, since grippers move them."""
        handled, findings = follow(layout, self.program, self.robot)
        self._handled.append(handled)
        self.findings.extend(findings)

    def find(self, code: str, message: str, step: int | None) -> None:
        """Add a finding about a step of the program."""
        help_ = _REMEDIES.get(code, "")
        if self.only is not None and step not in self.only:
            return
        if step is None:
            self.findings.append(Diagnostic(code, message, self.program.source, help=help_))
            return
        command = self.program.steps[step]
        assert not isinstance(command, hir.Gap)  # programs with gaps are refused earlier
        origin = command.origin
        span = Span.on_line(self.lines[step], 1, 2) if step in self.lines else origin.span
        self.findings.append(Diagnostic(code, f"{_title(origin)}: {message}", origin.source, span, help_))

    @property
    def breaks_limits(self) -> bool:
        """True if a limit of joints or motors is broken.

        Distances, zones and torques are then not examined: this can take long for such a motion, and would
        add no information.
        """
        return any(CATALOGUE[one.code].sort == "limits" for one in self.findings)

    # Checks of the start, the times and the rests.

    def start(self, content: ControllerText) -> Array:
        """Return the joint positions at the text's start (n,) [rad or m], and report a difference from the
        program's start. Both must agree to the printed decimals.
        """
        robot = self.robot
        start = reader_of(robot.controller).start(content, robot)
        q, allowed = start.q, start.exact
        weights = joint_weights(robot, self.tolerance)
        off = np.abs(q - self.program.start)
        # The start may differ by the rounding of the printed decimals, but by no more than the tolerance.
        allowed = np.minimum(allowed * (1.0 + 1e-6) + 1e-12, 1.0 / weights)
        if (off > allowed).any():
            joint = int(np.argmax(off / allowed))
            unit = robot.axis_units[joint]
            self.find(
                "Y1154",
                f"the text starts with {robot.joint_names[joint]} at {q[joint] / unit:.9g}, the program at "
                f"{self.program.start[joint] / unit:.9g} {robot.axis_unit_names[joint]} (line "
                f"{content.start.line})",
                self._first,
            )
        return q

    @property
    def _first(self) -> int | None:
        """The step of the first motion, to which findings about the start refer."""
        return next((i for i, step in enumerate(self.program.steps) if isinstance(step, hir.Motion)), None)

    def robot_named(self, content: ControllerText) -> None:
        """Check that the header names this robot."""
        header, robot = content.header, self.robot
        if header.robot == robot.name and header.robot_fingerprint == robot.fingerprint:
            return
        reason = f"{robot.name} is another robot"
        if header.robot == robot.name:
            reason = f"another geometry, limits or settings than {robot.name} has now"
        self.find("Y1163", f"the text was made for {header.robot} as it was then: {reason}", None)

    def contradicted(self, error: Exception) -> None:
        """Report that the robot differs from the description in its files."""
        self.find("Y1194", f"{self.robot.name} isn't what its files describe: {error}", None)

    def witnessed(self, layout: Layout) -> None:
        """Compare the kinematics with Pinocchio's at a few points of each motion."""
        for step, reason in disagreements(layout, self.robot):
            self.find("Y1194", reason, step)

    def claims(self, content: ControllerText, start: Array) -> None:
        """Compare the start and the duration in the header, which people read, with the text itself."""
        header, units = content.header, self.robot.axis_units
        said = _numbers(header.start, self.robot.controller.axes)
        place = reader_of(self.robot.controller).start(content, self.robot)
        step = np.full(len(units), 1e-9)
        if not place.is_printed:
            step = 2.0 * place.exact / units + 10.0**-content.decimals
        if said is None or (np.abs(said - start / units) > step).any():
            stands = " ".join(f"{value:.9g}" for value in start / units)
            self.find(
                "Y1153",
                f"the header says that the text starts at {header.start}, but it starts at {stands}",
                None,
            )
        takes, claimed = content.schedule.lasting, header.lasting
        # If the shortest and the longest time are equal as printed, the header has only the longest.
        least = takes.least if takes.varies else takes.most
        off = max(abs(least - claimed.least), abs(takes.most - claimed.most))
        waits = (takes.fewest, takes.waits, takes.loops) != (claimed.fewest, claimed.waits, claimed.loops)
        # Times are printed in ms: allow half a unit of the last decimal, and rounding.
        if off > 0.5e-3 + 1e-9 * takes.most or waits:
            self.find(
                "Y1153",
                f"the header says that the program takes {claimed.text()}, but it takes {takes.text()}",
                None,
            )

    def flow(self, content: ControllerText) -> None:
        """Compare the actions between the motions with those of the program."""
        for step, reason in check_flow(content, self.program):
            self.find("Y1165", reason, step)

    def rests(self, content: ControllerText, start: Array, outputs: Set[str] | None) -> None:
        """Check the actions between the motions as far as possible without the program.

        These checks are about where the actions are, what they assign, and the guard of the buffer.

        Args:
            content: the controller text, as the judge has read it.
            start: (n,) joint positions at the start of the text [rad or m].
            outputs: variables of the program's outputs; None if the program is unknown.
        """
        units = self.robot.axis_units
        # Where branches meet, each printed end is off by at most half a unit of its last decimal, so two ends
        # differ by at most one unit.
        slack = np.minimum(10.0**-content.decimals, 1.0 / joint_weights(self.robot, self.tolerance) / units)
        for step, reason in check_rests(content, start / units, slack * (1.0 + 1e-6)):
            self.find("Y1165", reason, step)
        for fault in reader_of(self.robot.controller).faults(content, self.robot, outputs):
            self.find(fault.code, fault.reason, self._first if fault.at_start else None)

    def any_jerk(self, content: ControllerText, free: Set[int]) -> None:
        """Check that the map marks only the given motions as motions without a jerk limit.

        Args:
            content: the controller text, as the judge has read it.
            free: steps whose profile has no jerk limit.
        """
        for entry in content.entries:
            if entry.any_jerk and entry.step not in free:
                self.find(
                    "Y1153",
                    f"the map says that its jerk has no limit, and its profile has one (line {entry.at})",
                    entry.step,
                )

    def overlaps(self, content: ControllerText, layout: Layout, claimed: Mapping[int, float]) -> None:
        """Check that no blend at a corner without a ball is longer than the planner's.

        In such a blend no ball limits how far from the corner the robot is. A longer blend than necessary
        would move the middle of the blend, to which times and outputs refer, and would lift the jerk limit
        beside a motion without one.

        Args:
            content: the controller text, as the judge has read it.
            layout: the commands of the controller text.
            claimed: the planner's durations of blends [s], by the step of the motion before the blend.
        """
        longer: dict[int, tuple[float, float]] = {}
        for place in layout.places:
            if place.behind:
                duration = place.behind * float(layout.time[place.first])
                most = claimed.get(place.step, 0.0)
                # The controller rounds the time of each segment by at most half a quantum.
                if not duration <= most + place.behind * content.quantum / 2.0 + 1e-9:
                    longer[place.step] = duration, most
        for corner in corners_of(layout, self.robot) if longer else ():
            step = layout.places[corner.first].step
            if step in longer and not corner.rounded:
                duration, most = longer[step]
                self.find(
                    "Y1153",
                    f"the map says that its blend takes {duration:.6g} s ({corner.segments} segments); the "
                    f"corner has no ball, so its blend may take {most:.6g} s",
                    step,
                )

    def postures(self, layout: Layout, claimed: Mapping[int, Array]) -> None:
        """Check that joint motions to a pose come to rest in the posture that the planner has chosen.

        Args:
            layout: the commands of the controller text.
            claimed: (n,) joint positions [rad or m], by the motion's step.
        """
        robot = self.robot
        for row, place in enumerate(layout.places):
            planned = claimed.get(place.step)
            if planned is None or place.behind is not None:
                continue
            off = np.abs(layout.ends[row] - planned)
            joint = int(np.argmax(off))
            if not off[joint] <= _SAME_POSTURE:
                unit, factor = robot.axis_unit_names[joint], robot.axis_units[joint]
                self.find(
                    "Y1160",
                    f"the motion ends in another posture than the program's: {robot.joint_names[joint]} is "
                    f"{off[joint] / factor:.6g} {unit} away",
                    place.step,
                )

    def standing(self, start: Array) -> None:
        """Check that the start, to which a RAPID moves the robot, is within the limits of the joints."""
        limits, units = self.robot.limits, self.robot.axis_units
        past = np.maximum(start - limits.upper, limits.lower - start) / units
        if past.max() > POSITION_UNITS:
            joint = int(np.argmax(past))
            unit = self.robot.axis_unit_names[joint]
            self.find(
                "Y1157",
                f"the text starts with {self.robot.joint_names[joint]} {past[joint]:.6g} {unit} past its "
                "limit",
                None,
            )

    def segment_times(self, content: ControllerText, layout: Layout) -> None:
        """Check that each motion takes its programmed time."""
        drift = 0.0
        for place in layout.places:
            if place.before is None:
                drift = 0.0
            if (programmed := place.motion.timing.duration) is None:
                continue
            duration = _duration(layout, place)
            # Within a chain, compare the sums since its start, so that errors can't add up.
            drift += duration - programmed
            if isinstance(place.motion, hir.TimedMove):
                self._table_time(place, duration, programmed)
                continue
            # The controller rounds the time of each segment by at most half a quantum.
            allowed = place.size * content.quantum / 2.0 + 1e-9
            chained = place.before is not None or place.behind is not None
            if chained and place.size:
                # All segments of a chain have one duration, so its motions can only meet between segments.
                allowed += float(layout.time[place.first]) / 2.0
            if abs(drift if chained else duration - programmed) > allowed:
                self.find(
                    "Y1156",
                    f"the motion takes {duration:.9g} s ({place.size} segments) instead of the programmed "
                    f"{programmed:.9g} s",
                    place.step,
                )

    def _table_time(self, place: Place, duration: float, programmed: float) -> None:
        """Check that a motion takes the time of its timetable."""
        if abs(duration - programmed) > LATE * (1.0 + 1e-6):
            self.find(
                "Y1156",
                f"the motion takes {duration:.9g} s ({place.size} segments), its timetable "
                f"{programmed:.9g} s; a difference of {LATE / MS:g} ms is allowed",
                place.step,
            )

    def rest(self, layout: Layout) -> None:
        """Check that each command ends at rest."""
        for place in moving_at_ends(layout):
            self.find(
                "Y1155",
                f"the command doesn't end at rest: its last three points differ (line {place.last_line})",
                place.step,
            )

    # Checks of limits, speeds, distances, zones and torques.

    def limits(self, layout: Layout) -> dict[int, Loads]:
        """Return the loads of every step, and report each limit that a command breaks."""
        loads = {place.step: NO_LOADS for place in layout.places}
        lowered = find_lowered(layout)
        for places in chunks([place for place in layout.places if place.size]):
            segments = slice(places[0].first, places[-1].last)
            cubics = Cubics.of_spline(layout.control, layout.at[segments], layout.time[segments])
            found = check_limits(layout, places, cubics, self.robot)
            for place, (load, excesses) in zip(places, found, strict=True):
                loads[place.step] = load
                for excess in excesses:
                    if excess.quantity == "jerk" and not self._jerk_counts(layout, place):
                        continue
                    self._exceeds(place, excess)
            if lowered is not None:
                for place, excess in above_lowered(layout, places, cubics, self.robot, lowered):
                    if loads[place.step].share_of(excess.quantity) <= 1.0 + RELATIVE:
                        self._exceeds(place, excess)
        return loads

    def _exceeds(self, place: Place, excess: Excess) -> None:
        """Report a limit that a command exceeds."""
        code = "Y1158" if excess.quantity == "motor_velocity" else "Y1157"
        self.find(code, f"{excess.name} {excess.text}, {excess.time:.6g} s after its start", place.step)

    def _jerk_counts(self, layout: Layout, place: Place) -> bool:
        """Return True if a jerk beyond the limit is in a part of the motion that has a jerk limit.

        A motion without a jerk limit has no such part, and its blends with neighbours have none either.
        """
        if place.any_jerk:
            return False
        before, behind = _beside_any_jerk(place)
        peaks = layout.cubics(place.first + before, place.last - behind).jerk_peaks() / self.robot.limits.jerk
        return bool(peaks.max(initial=0.0) > 1.0 + RELATIVE)

    def speeds(self, layout: Layout, speeds: Mapping[int, ToolSpeed]) -> None:
        """Check that programmed speeds are held and never exceeded.

        A speed must be held from when it is first reached to when it is last left.

        Args:
            layout: the commands of the controller text.
            speeds: proved speeds by step.
        """
        for place in layout.places:
            speed = speeds.get(place.step)
            if speed is None or math.isnan(speed.programmed):
                continue
            unit, name = (DEG, "deg/s") if speed.turns else (MM, "mm/s")
            programmed = f"{speed.programmed / unit:.6g} {name} are programmed"
            if not speed.beyond <= 1.0 + KEPT:
                self.find(
                    "Y1167",
                    f"the moving frame reaches {speed.beyond:.3%} of its allowed speed; {programmed}",
                    place.step,
                )
            elif math.isnan(speed.least):
                self.find(
                    "Y1167",
                    f"the moving frame never reaches its speed, but at most {speed.largest / unit:.6g} "
                    f"{name}; {programmed}",
                    place.step,
                )
            elif speed.least < speed.programmed * (1.0 - KEPT):
                self.find(
                    "Y1167",
                    f"the moving frame slows down to {speed.least / unit:.6g} {name} between its ramps; "
                    f"{programmed}",
                    place.step,
                )

    def clearances(self, layout: Layout) -> dict[int, Apart]:
        """Check that the robot, its load and the cell stay apart."""
        apart, findings = find_clearances(layout, self.program, self.robot, self.handled)
        self.findings.extend(findings)
        return apart

    def zones(self, layout: Layout, blends: Mapping[int, Blended]) -> dict[int, InZones]:
        """Check that every watched body respects its zones, and every motion its ceiling.

        `blends` are the proved blends, by the step of the motion before the blend.
        """
        told, findings = find_zones(layout, self.robot, self.handled, blends)
        self.findings.extend(findings)
        return told

    def torques(self, layout: Layout) -> dict[int, Load]:
        """Check joint torques, if masses and effort limits are known."""
        loads, findings = find_torques(layout, self.robot, self.handled)
        self.findings.extend(findings)
        return loads

    # Rows of the certificate.

    def _own_tolerance(self, step: hir.Motion) -> Tolerance | None:
        """Return the tolerance of a motion that has its own; None otherwise."""
        if isinstance(step, hir.TimedMove):
            return timed_tolerance(step, self.robot)
        return None if step.tolerance is None else tolerance_of(step, self.tolerance)

    def command(
        self,
        layout: Layout,
        place: Place,
        loads: Loads,
        deviation: Deviation,
        speed: ToolSpeed | None = None,
        blended: Blended | None = None,
        apart: Apart = NOTHING_NEAR,
        zones: InZones = NO_ZONES,
        torque: Load | None = None,
    ) -> CommandCertificate:
        """Build one command's row of the certificate."""
        step = place.motion
        return CommandCertificate(
            step=place.step,
            index=step.origin.label,
            name=step.origin.name,
            kind=KINDS[type(step)],
            source_line=step.origin.span.line,
            lines=place.lines,
            segments=place.size,
            segment_time=float(layout.time[place.first]) if place.size else 0.0,
            duration=_duration(layout, place),
            programmed_duration=step.timing.duration,
            loads=loads,
            deviation=deviation,
            tool_speed=speed,
            blended=blended,
            jerk_judged=not place.any_jerk and not any(_beside_any_jerk(place)),
            clearance=apart.cell,
            own_clearance=apart.own,
            zone_clearance=zones.clearance,
            zone_speed=zones.speed,
            torque=torque,
            carries=self.handled.carried.get(place.step, ()),
            may_touch=tuple(may_touch(self.handled, place.step, apart.touching)),
            kept=zones.kept,
            module=step.origin.source.module,
            tolerance=self._own_tolerance(step),
        )


def _title(origin: hir.Origin) -> str:
    return f"{origin.label} {origin.name}".strip()


def _beside_any_jerk(place: Place) -> tuple[int, int]:
    """Return, for the start and the end of a motion, the number of its segments that belong to a blend with a
    motion without a jerk limit.
    """
    before, behind = place.beside_any_jerk
    return (place.before or 0) // 2 * before, (place.behind or 0) // 2 * behind


def _numbers(line: str, axes: tuple[str, ...]) -> Array | None:
    """Return the numbers of a move line (n,); None if it is no move line of these axes."""
    form = re.compile("".join(rf"{axis}(-?[0-9]{{1,7}}(?:\.[0-9]{{1,12}})?)" for axis in axes))
    found = form.fullmatch(line)
    return None if found is None else np.array([float(number) for number in found.groups()])


def _duration(layout: Layout, place: Place) -> float:
    """Return the duration of a command [s], whose segments all have one duration."""
    return place.size * float(layout.time[place.first]) if place.size else 0.0
