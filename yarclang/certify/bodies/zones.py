"""Proof that the watched bodies respect the cell's zones while the text runs."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence

import numpy as np

from yarclang import hir
from yarclang.cell.keeping import Keep, Pointed, Sight, Tilt
from yarclang.cell.model import JointWindow
from yarclang.certify.bodies.ceilings import find_ceilings
from yarclang.certify.bodies.fastest import Motions, fastest_in
from yarclang.certify.bodies.handled import Handled
from yarclang.certify.bodies.remedy import remedy
from yarclang.certify.bodies.sights import seen_at, sighted
from yarclang.certify.bodies.sweep import Sweep, moving_chunks, sweep_of
from yarclang.certify.bodies.tilts import tilted
from yarclang.certify.bodies.witness import seen_beyond
from yarclang.certify.certificate import Blended, Clearance, KeptRule, ZoneSpeed
from yarclang.certify.moments import pose_text, span_text
from yarclang.certify.motion.frames import moving_frame
from yarclang.certify.motion.speed import KEPT
from yarclang.certify.outward import most, up_to
from yarclang.certify.read.layout import Layout, Place
from yarclang.collision.proof import KNOWN
from yarclang.collision.scene import Scene, scene_of
from yarclang.collision.zones.breach import Beyond, beyond
from yarclang.collision.zones.proof import kept
from yarclang.collision.zones.watched import Moving, tool_frame
from yarclang.collision.zones.windows import room
from yarclang.collision.zones.workspace import Watch, watches_of
from yarclang.diagnostics import Diagnostic, Fix, grouped
from yarclang.frozen import frozen
from yarclang.robot.model import Array, Robot
from yarclang.units import DEG, MM


@frozen
class InZones:
    """Proved distances, speeds and rules of a command in relation to zones.

    Attributes:
        clearance: distance of the watched bodies from borders that they must not cross; None without such
            zones.
        speed: speed in the slow zone in which the command comes nearest to the zone's speed limit; None if it
            enters no slow zone.
        kept: the rules of KEEP that the command respects, with the proved bounds.
    """

    clearance: Clearance | None
    speed: ZoneSpeed | None
    kept: tuple[KeptRule, ...] = ()


NO_ZONES = InZones(None, None)


def find_zones(
    layout: Layout, robot: Robot, handled: Handled, blends: Mapping[int, Blended]
) -> tuple[dict[int, InZones], list[Diagnostic]]:
    """Prove that zones are respected, and that motions respect their own speed limits (`[V<=250]`).

    Args:
        layout: the segments of the controller text.
        robot: the robot, with its bodies and kinematics.
        handled: the cell's state during each command, with its zones.
        blends: the proved blends, by the step of the motion before the blend.

    Returns:
        The proved bounds of every command by its step, and findings about broken zones and speed limits.
    """
    bounds: dict[int, InZones] = {}
    findings: list[Diagnostic] = []
    moving_places = [place for place in layout.places if place.size]
    if any(place.motion.timing.ceiling is not None for place in moving_places):
        moved = {place.step: moving_of(place.motion, robot) for place in moving_places}
        ceilings, too_fast = find_ceilings(layout, robot, moved, blends)
        bounds = {step: InZones(None, speed) for step, speed in ceilings.items()}
        findings += grouped(too_fast)
    cells = (handled.at(place.step) for place in moving_places)
    if not any(one is not None and one.zones for one in cells):
        return bounds, findings
    in_zones: dict[int, InZones] = {}
    for cell, places in moving_chunks(layout, handled):
        result = scene_of(robot, cell)
        if cell is None:
            continue  # motions without a cell have no zones
        if result.value is None:
            return bounds, findings  # the collision check reports unreadable bodies
        for moving, run in _runs(places, robot):
            judge = _Judge(result.value, robot, sweep_of(layout, run), watches_of(robot, cell, moving))
            in_zones |= judge.judged()
            findings += judge.findings
    for step, zones in in_zones.items():
        own, speed = bounds.get(step, NO_ZONES).speed, zones.speed
        if own is not None and (speed is None or own.share > speed.share):
            speed = own
        bounds[step] = InZones(zones.clearance, speed, zones.kept)
    return bounds, list(grouped(findings))


def _runs(places: list[Place], robot: Robot) -> Iterator[tuple[Moving, list[Place]]]:
    """Yield runs of consecutive commands that move the same frame, each run with this frame. Zones that watch
    the tool watch this frame.
    """
    run: list[Place] = []
    before: Moving | None = None
    for place in places:
        moving = moving_of(place.motion, robot)
        is_same = (
            before is not None
            and before.name == moving.name
            and np.array_equal(before.flange_from_moving, moving.flange_from_moving)
        )
        if before is not None and not is_same:
            yield before, run
            run = []
        run.append(place)
        before = moving
    if before is not None:
        yield before, run


def moving_of(motion: hir.Motion, robot: Robot) -> Moving:
    """Return the moving frame of a Cartesian goal, or the tool frame that a joint motion names; {TCP} if it
    names none.
    """
    link = motion.origin.tool
    if link is None:
        return tool_frame(robot)
    if motion.origin.moving is not None:
        return Moving(link.name, moving_frame(motion))
    name, placed = link.name, np.eye(4)
    while link is not None and link.parent is not None:
        placed = link.parent_from_frame @ placed
        link = link.parent
    return Moving(name, placed)


class _Judge:
    """Judgement of commands that all move the same frame."""

    def __init__(self, scene: Scene, robot: Robot, sweep: Sweep, watches: Sequence[Watch]) -> None:
        self.scene, self.robot, self.sweep, self.watches = scene, robot, sweep, watches
        self.places, self.course, self.spans = sweep.places, sweep.course, sweep.spans
        self.motions = Motions(scene.chain, sweep.cubics, sweep.spans)
        self.findings: list[Diagnostic] = []

    def judged(self) -> dict[int, InZones]:
        """Return the proved bounds of each command by its step."""
        speeds = self._speeds()
        borders, kept_to = self._borders(), self._kept()
        return {
            place.step: InZones(borders[row], speeds[row], kept_to[row])
            for row, place in enumerate(self.places)
        }

    def _kept(self) -> list[tuple[KeptRule, ...]]:
        """Return the rules of KEEP with their proved bounds for each command, and report broken rules."""
        rules: list[list[KeptRule]] = [[] for _ in self.places]
        for zone in dict.fromkeys(one.zone for one in self.watches if one.zone.keep is not None):
            rule = zone.keep
            assert rule is not None
            region = rule.region
            if isinstance(region, Sight):
                self._keep_in_sight(rule, region, rules)
                continue
            found = tilted(self.motions, region) if isinstance(region, Tilt) else None
            for row in range(len(self.places)):
                most_ = None if found is None else float(found.most[row])
                rules[row].append(KeptRule(rule.words, rule.limit, most_))
                if isinstance(region, Tilt) and found is not None and found.exceeds[row]:
                    self._too_tilted(row, rule, region, float(found.when[row]))
        return [tuple(one) for one in rules]

    def _keep_in_sight(self, rule: Keep, sight: Sight, told: list[list[KeptRule]]) -> None:
        """Add the proved bounds of a rule about a cone to `told`, and report commands that break the rule."""
        found = sighted(self.motions, sight)
        for row in range(len(self.places)):
            least, farthest = float(found.least[row]), float(found.farthest[row])
            told[row].append(KeptRule(rule.words, rule.limit, float(found.most[row]), least, farthest))
            if found.exceeds[row]:
                self._out_of_sight(row, rule, sight, float(found.when[row]))

    def _out_of_sight(self, row: int, rule: Keep, sight: Sight, when: float) -> None:
        """Report a command during which a point leaves a cone, with the interval and the worst instant."""
        place, watch = self.places[row], next(one for one in self.watches if one.zone.keep is rule)
        stay = beyond(self.scene, self.course, self.sweep.span(row), watch, when)
        q = self._at(self.sweep.starts(row) + stay.worst)
        angle, distance = seen_at(self.scene.chain, sight, q)
        cone, point = (rule.frame, rule.of) if sight.is_carried else (rule.of, rule.frame)
        if angle - sight.limit >= max(sight.near - distance, distance - sight.far):
            code, told = "Y0957", f"{sight.limit / DEG:.10g} deg of KEEP"
            over = up_to(max(angle - sight.limit, 1e-7) / DEG, 3)
            how = (
                f"{{{point}}} is {up_to(angle / DEG, 4)} deg off the z axis of {{{cone}}}, {over} deg more "
                f"than the {told}"
            )
        else:
            is_near = sight.near > distance
            code, limit = "Y0958", sight.near if is_near else sight.far
            by = _mm(max(abs(distance - limit), 1e-5))
            how = (
                f"{{{point}}} is {distance / MM:,.6g} mm from {{{cone}}}, {by} "
                f"{'less' if is_near else 'more'} than the {limit / MM:.6g} mm of KEEP"
            )
        message = (
            f"{how}, {span_text(stay.begin, stay.end, self.sweep.lasts(row))}; worst at {stay.worst:.3f} s, "
            f"{pose_text(self.robot, place.motion.origin, q)}"
        )
        interval = (stay.begin, stay.end)
        self._find(
            code, message, place, *remedy(place.motion, _remedy(code, rule), interval, self.sweep.lasts(row))
        )

    def _too_tilted(self, row: int, rule: Keep, tilt: Tilt, when: float) -> None:
        """Report a command during which an axis tilts too far, with the interval and the worst instant."""
        place, watch = self.places[row], next(one for one in self.watches if one.zone.keep is rule)
        stay = beyond(self.scene, self.course, self.sweep.span(row), watch, when)
        q = self._at(self.sweep.starts(row) + stay.worst)
        angle = tilt.limit - stay.slack
        message = (
            f"{{{rule.frame}}} tilts {up_to(angle / DEG, 4)} deg from the z axis of {{{rule.of}}}, "
            f"{up_to(-stay.slack / DEG, 3)} deg more than the "
            f"{rule.amount.replace('(', '').replace(')', '')} of KEEP, "
            f"{span_text(stay.begin, stay.end, self.sweep.lasts(row))}; worst at {stay.worst:.3f} s, "
            f"{pose_text(self.robot, place.motion.origin, q)}"
        )
        when_ = (stay.begin, stay.end)
        self._find(
            "Y0955",
            message,
            place,
            *remedy(place.motion, _remedy("Y0955", rule), when_, self.sweep.lasts(row)),
        )

    def _borders(self) -> list[Clearance | None]:
        if not any(one.zone.rule != "slow" for one in self.watches):
            return [None] * len(self.places)
        # Rules about directions (`Pointed`) are proved in `_kept`.
        watches = [one for one in self.watches if not isinstance(one.zone.region, Pointed)]
        proved = kept(self.scene, self.course, self.spans, watches)
        broken: dict[tuple[int, str], list[tuple[Watch, Beyond]]] = {}
        for one in proved.breaches:
            watch, span = watches[one.watch], self.sweep.span(one.motion)
            stay = beyond(self.scene, self.course, span, watch, one.time)
            broken.setdefault((one.motion, watch.zone.name), []).append((watch, stay))
        for (row, _), stays in sorted(broken.items(), key=lambda one: one[0][0]):
            self._break(row, stays)
        self._look_again(watches, broken)
        clearances: list[Clearance | None] = []
        for row in range(len(self.places)):
            near, least = int(proved.nearest[row]), float(proved.least[row])
            if not np.isfinite(least):
                clearances.append(None)  # only joints are watched
            elif near < 0 or least >= KNOWN:
                clearances.append(Clearance(KNOWN))
            else:
                watch, at = watches[near], float(proved.when[row]) - self.sweep.starts(row)
                clearances.append(Clearance(least, _called(watch), watch.zone.name, at))
        return clearances

    def _look_again(self, watches: Sequence[Watch], broken: Container[tuple[int, str]]) -> None:
        """Check zone borders again by arithmetic that the proof does not use.

        A violation that only this check finds is a bug of yarclang.
        """
        for watch in watches:
            if watch.zone.rule == "slow":
                continue
            for row, seen in enumerate(seen_beyond(self.motions, watch)):
                if seen is None or (row, watch.zone.name) in broken:
                    continue
                time = float(self.motions.starts[seen.segment])
                if seen.at_end:
                    time += float(self.sweep.cubics.h[seen.segment])
                message = (
                    f"{_called(watch)} is beyond a border of the zone {watch.zone.name}, "
                    f"{time - self.sweep.starts(row):.3f} s after its start, "
                    f"{pose_text(self.robot, self.places[row].motion.origin, self._at(time))}, which the "
                    "proof missed"
                )
                self._find(
                    "Y1181",
                    message,
                    self.places[row],
                    "this is a fault of yarclang: report it, with the program and the cell",
                )

    def _speeds(self) -> list[ZoneSpeed | None]:
        worst: list[ZoneSpeed | None] = [None] * len(self.places)
        for watch in self.watches:
            limit = watch.zone.speed
            if watch.zone.rule != "slow" or limit is None:
                continue
            assert watch.item is not None  # only joint windows have no body, and they are never slow zones
            assert not isinstance(watch.zone.region, Pointed)
            fastest = fastest_in(self.motions, watch.zone.region, watch.zone.margin, watch.item)
            for row in np.flatnonzero(fastest.segment >= 0).tolist():
                speed = ZoneSpeed(float(fastest.speed[row]), limit, _called(watch), watch.zone.name)
                had = worst[row]
                if had is None or speed.share > had.share:
                    worst[row] = speed
                if not speed.share <= 1.0 + KEPT:
                    self._too_fast(row, speed, float(fastest.time[row]))
        return worst

    def _too_fast(self, row: int, speed: ZoneSpeed, time: float) -> None:
        place = self.places[row]
        after = time - self.sweep.starts(row)
        message = (
            f"{speed.part} moves at {up_to(most(speed.largest, MM), 5)} mm/s in the zone {speed.zone}, "
            f"where {speed.limit / MM:.4g} mm/s are allowed, {after:.3f} s after its start, "
            f"{pose_text(self.robot, place.motion.origin, self._at(time))}"
        )
        self._find(
            "Y0911",
            message,
            place,
            "give the motion more time, or [MIN]; or change the zone in the cell.toml",
        )

    def _break(self, row: int, stays: list[tuple[Watch, Beyond]]) -> None:
        """Report a zone that a command violates, with the body that is farthest beyond the zone's border, the
        worst instant, and the names of all other bodies beyond the border.
        """
        place = self.places[row]
        watch, worst = min(stays, key=lambda one: one[1].slack)
        q = self._at(self.sweep.starts(row) + worst.worst)
        code, how = self._how(watch, worst, q)
        others = dict.fromkeys(_called(one) for one, _ in stays if _called(one) != _called(watch))
        more = f"; also: {', '.join(others)}" if others else ""
        message = (
            f"{how}, {span_text(worst.begin, worst.end, self.sweep.lasts(row))}; worst at {worst.worst:.3f} "
            f"s, {pose_text(self.robot, place.motion.origin, q)}{more}"
        )
        when = (min(one.begin for _, one in stays), max(one.end for _, one in stays))
        self._find(
            code,
            message,
            place,
            *remedy(place.motion, _remedy(code, watch.zone.keep), when, self.sweep.lasts(row)),
        )

    def _how(self, watch: Watch, found: Beyond, q: Array) -> tuple[str, str]:
        """Return the code of a violation, and a description of its worst place."""
        zone = watch.zone
        if isinstance(zone.region, JointWindow):
            if zone.rule == "allowed":
                return "Y0909", f"{self._joint(zone.region, q)} of the zone {zone.name}"
            (joints,) = np.nonzero(np.isfinite(zone.region.lower) | np.isfinite(zone.region.upper))
            names = " and ".join(self.robot.joint_names[joint] for joint in joints)
            return (
                "Y0909",
                (
                    f"{names} {'is' if len(joints) == 1 else 'are'} in the forbidden window of the zone "
                    f"{zone.name}"
                ),
            )
        part = _called(watch)
        if zone.posture is not None:
            return "Y0910", f"{self._joint(zone.posture, q)} of the zone {zone.name} while {part} is in it"
        if zone.keep is not None:
            below = f"{_mm(max(-found.slack, 1e-5))} too low: KEEP requires {zone.keep.limit / MM:.6g} mm"
            return "Y0956", f"{part} is {below} above {{{zone.keep.of}}}"
        code = "Y0907" if zone.rule == "allowed" else "Y0908"
        apart = found.slack + zone.margin
        if apart > 0.0:
            kept_off = f"whose margin is {zone.margin / MM:.4g} mm"
            return (
                code,
                f"{part} comes within {_mm(apart)} of the border of the zone {zone.name}, {kept_off}",
            )
        way = "outside of" if zone.rule == "allowed" else "inside of"
        return code, f"{part} is {_mm(max(-apart, 1e-5))} {way} the zone {zone.name}"

    def _joint(self, window: JointWindow, q: Array) -> str:
        """Return in words the joint that is farthest out of a window, and its distance."""
        out = -room(window, q[None])[0] / self.robot.axis_units
        joint = int(np.argmax(out))
        unit, scale = self.robot.axis_unit_names[joint], self.robot.axis_units[joint]
        return (
            f"{self.robot.joint_names[joint]} is at {q[joint] / scale:.4g} {unit}, "
            f"{max(out[joint], 1e-4):.3g} {unit} outside of the window"
        )

    def _at(self, time: float) -> Array:
        q: Array = self.course.at(np.array([time]))[0]
        return q

    def _find(self, code: str, message: str, place: Place, help_: str, fix: Fix | None = None) -> None:
        origin = place.motion.origin
        self.findings.append(
            Diagnostic(code, message, origin.source, origin.span, help_, fix, place=origin.place)
        )


def _mm(length: float) -> str:
    """Return a length [m] in mm, in words."""
    return f"{length / MM:.3g} mm" if length < 1.0 else f"{length / MM:,.0f} mm"


def _called(watch: Watch) -> str:
    return watch.item.name if watch.item is not None else "the arm"


def _remedy(code: str, rule: Keep | None) -> str:
    """Return the remedy for a finding; for a rule of the cell, it points to cell.toml."""
    told = _REMEDIES[code]
    return told.replace("in the KEEP", "in [[keep]] of the cell.toml") if rule and rule.of_cell else told


_REMEDIES = {
    "Y0955": (
        "keep the tool upright with a pose in between, MOVEL or MOVEJ_AVOID; or allow a larger angle in "
        "the KEEP"
    ),
    "Y0957": (
        "turn the tool along the path with a pose in between, MOVEL or MOVEJ_AVOID; or allow a larger "
        "angle in the KEEP"
    ),
    "Y0958": (
        "keep the distance with a pose in between, another order or MOVEJ_AVOID; or allow another range "
        "in the KEEP"
    ),
    "Y0956": (
        "stay above it with a pose in between, another order or MOVEJ_AVOID; or allow a smaller distance "
        "in the KEEP"
    ),
    "Y0907": (
        "stay inside with a via pose, another order, or another configuration (NEAR); or correct the zone "
        "in the cell.toml"
    ),
    "Y0908": (
        "avoid it by a via pose, another order, or another configuration (NEAR); or correct the zone in "
        "the cell.toml"
    ),
    "Y0909": "choose another configuration (NEAR) or a via pose; or correct the window in the cell.toml",
    "Y0910": (
        "take the posture before entering, with NEAR or a MOVEJ before; or correct the zone in the cell.toml"
    ),
}
