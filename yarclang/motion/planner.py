"""Plan a checked program: first find the paths of all motions, then the curves on which the robot follows
them.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

from yarclang.cell.model import Cell
from yarclang.diagnostics import Collector, Diagnostic, Result, has_errors
from yarclang.frozen import frozen
from yarclang.hir import Gap, LineMove, Motion, Program, Step, Stop, TimedMove
from yarclang.memory import NO_MEMORY, Forgetful, Memory, recall
from yarclang.motion import messages
from yarclang.motion.cartesian import CartesianPath
from yarclang.motion.chains.chain import linked
from yarclang.motion.chains.corners import chained, long_chains
from yarclang.motion.chains.flowing.flow import Known, flowing
from yarclang.motion.chains.links import Link, Piece
from yarclang.motion.chains.messages import stops_at_corner, time_off_the_grid
from yarclang.motion.cruise import CruiseBroken, at_speed, full_time
from yarclang.motion.curve import Curve
from yarclang.motion.fit import NotHeld, TooFast, TooLong, fit
from yarclang.motion.leading.led import FrameWay
from yarclang.motion.limits import Bounds, Grid, bounds_of
from yarclang.motion.path import Path
from yarclang.motion.paths.joint import JointPath
from yarclang.motion.paths.timed import TimedPath, along
from yarclang.motion.plan import MotionPlan, PlannedMotion
from yarclang.motion.profile import FOR_SHORT, NoLaw, load_profile
from yarclang.motion.recalling import told_before
from yarclang.motion.routes import Done, Router
from yarclang.motion.singular import nearest_singularity
from yarclang.motion.timed import Broken, Missed, TooShort, fit_timed, shortest_stretch
from yarclang.motion.together import Tried, TriedAhead
from yarclang.motion.zones import BELOW_CEILING, SlowZones, moving_of, slow_zones
from yarclang.progress import tell
from yarclang.robot.model import Robot, Tolerance


@frozen
class Settings:
    """The settings of the planner.

    `grid` are the segment times that the controller accepts, and `memory` has results of earlier plans.
    `searches` is the number of paths around obstacles that are searched for, of which the fastest is used.
    """

    grid: Grid
    tolerance: Tolerance
    memory: Memory = NO_MEMORY
    searches: int = 1


def plan(program: Program, robot: Robot, settings: Settings) -> Result[MotionPlan]:
    """Plan all motions of a program.

    Args:
        program: the program.
        robot: the robot.
        settings: settings of the planner.

    Returns:
        The plan, or None if a motion can't be executed. After an error, planning continues from the robot's
        intended position, as far as this is known, so that all faults are reported at once.
    """
    made, is_whole, found = plan_in_part(program, robot, settings, ENOUGH_LINKED)
    return Result(made if is_whole else None, found)


def plan_in_part(
    program: Program, robot: Robot, settings: Settings, enough: int | None = None
) -> tuple[MotionPlan, bool, tuple[Diagnostic, ...]]:
    """Plan those motions of a program that can be planned.

    In a partial plan, a motion need not begin at the end of the motion before it. Such a plan is for display,
    never for a controller.

    Args:
        program: the program.
        robot: the robot.
        settings: settings of the planner.
        enough: number of motions in chains after which no more chains are planned if the program has
            errors; None to plan all chains.

    Returns:
        The plan; True if it contains the whole program without an error; and the findings.
    """
    steps = program.steps
    end = next((number for number, step in enumerate(steps) if isinstance(step, Stop)), len(steps))
    steps = steps[:end]
    router = Router(
        robot, steps, program.start, program.cell, settings.memory, program.cells, settings.searches
    )
    planner = _Planner(robot, settings, bounds_of(robot))
    # First pass: the paths of all motions.
    for number in range(end):
        tell("planning", number // 2, end)
        router.advance()
    planned, all_done = program, router.done
    if any(isinstance(step, LineMove) and step.avoids for step in steps):
        steps, all_done = router.in_legs()
        planned = replace(program, steps=(*steps, *program.steps[end:]))
        end = len(steps)
    findings_of: list[list[Diagnostic]] = [list(done.found) for done in all_done]
    links: dict[int, Link] = {}
    ways: dict[int, Path | FrameWay] = {}
    flows = False
    # Second pass: the curve of each motion alone. Long chains are left out if they can be planned as one
    # path.
    motions_of = [
        (step, done.route.path) if isinstance(step, Motion) and done.route is not None else None
        for step, done in zip(steps, all_done, strict=True)
        if isinstance(step, Motion)
    ]
    tried = TriedAhead(motions_of, settings.grid, planner.asked)
    in_long_chains = long_chains(steps)
    place = -1
    for number, (step, done) in enumerate(zip(steps, all_done, strict=True)):
        tell("planning", (end + number) // 2, end)
        place += isinstance(step, Motion)
        if done.way is not None:
            ways[number] = done.way
        if isinstance(step, Motion) and done.route is not None:
            ways[number] = done.route.path
            findings = Collector(step.origin.source)
            findings.place = step.origin.place
            link = None
            if number in in_long_chains:
                link = planner.bare_link(step, done.route.path, done.cell)
            if link is None:
                leaves = flows or step.blend is not None
                ahead = partial(tried.of, place)
                link = planner.link(step, done.route.path, done.cell, findings, ahead, leaves=leaves)
            findings_of[number] += findings.found
            if link is not None:
                links[number] = link
        elif isinstance(step, Motion):
            findings_of[number] += _known_without_a_way(step)
        if isinstance(step, Motion):
            flows = step.blend is not None
    # Third pass: the chains.
    motions: list[PlannedMotion] = []
    has_gaps = any(isinstance(step, Gap) for step in steps)
    if not (has_gaps or any(map(has_errors, findings_of))):
        enough = None
    in_chains = 0
    for numbers, chain in chained(robot, steps, links, ways, findings_of):
        if len(chain) > 1:
            in_chains += len(chain)
            if enough is not None and in_chains > enough:
                continue
        # Replace each motion by the same motion with its corner.
        links.update(zip(numbers, chain, strict=True))
        as_one = planner.pieces(chain)
        pieces: Sequence[Piece | None] = as_one or ()
        if as_one is None:
            # The chain can't be planned as one path: first plan each motion alone.
            pieces = planner.pieces_of_known(numbers, chain, steps, all_done, findings_of, links)
        for number, piece in zip(numbers, pieces, strict=True):
            if piece is None:
                continue
            step, route = steps[number], all_done[number].route
            assert isinstance(step, Motion)
            assert route is not None
            motions.append(
                PlannedMotion(
                    number,
                    route.path,
                    step.profile,
                    piece.curve,
                    route.waypoints,
                    piece.law,
                    piece.overlap,
                    piece.kept,
                    piece.least,
                )
            )
            findings = Collector(step.origin.source)
            findings.place = step.origin.place
            planner.judge_piece(step, links[number], piece, number != numbers[-1], findings)
            findings_of[number] += findings.found
    everything = tuple(one for findings_of_step in findings_of for one in findings_of_step)
    complete = (
        len(motions) == sum(isinstance(step, Motion) for step in steps)
        and not has_gaps
        and not any(one.is_error for one in everything)
    )
    asked = None if planned is program else program
    return MotionPlan(planned, robot, tuple(motions), asked), complete, everything


def _known_without_a_way(step: Motion) -> list[Diagnostic]:
    """Return the findings about a motion that don't depend on its path. The path isn't known, because the
    motion's start or end isn't known.

    Otherwise these findings would be reported only after the user has corrected the fault that makes the
    position unknown.
    """
    findings = Collector(step.origin.source)
    findings.place = step.origin.place
    if step.leads_frame and step.timing.speed is not None and not load_profile(step.profile).has_cruise:
        findings.add(*messages.no_cruise(step))
    return findings.found


@dataclass(slots=True)
class _Planner:
    robot: Robot
    settings: Settings
    bounds: Bounds
    _slow: dict[Hashable, SlowZones | None] = field(default_factory=dict)

    def zones(self, step: Motion, path: Path, cell: Cell | None, *, leaves: bool) -> SlowZones | None:
        """Return the slow zones that a motion may enter.

        With `leaves`, the motion may leave its path to flow into another motion, so all zones are returned.
        """
        zones = slow_zones(self.robot, cell, step)
        return zones if zones is None or leaves else zones.beside(path.joints, path.slope)

    def asked(self, step: Motion) -> tuple[Bounds, Tolerance]:
        """Return the limits and the tolerance that a motion requests, without slow zones."""
        timing, tolerance = step.timing, self.settings.tolerance
        if step.tolerance is not None:
            tolerance = tolerance.of_motion(step.tolerance, leads_frame=step.leads_frame)
        return self.bounds.reduced(timing.share, timing.ramp), tolerance

    def link(
        self,
        step: Motion,
        path: Path,
        cell: Cell | None,
        findings: Collector,
        ahead: Callable[[], Tried | None],
        *,
        leaves: bool,
    ) -> Link | None:
        """Plan a motion alone, from rest to rest.

        Args:
            step: the motion.
            path: its path.
            cell: the cell during the motion.
            findings: receives the findings about the motion.
            ahead: function that returns trials of this motion that were already computed, together with
                those of other motions; or None.
            leaves: as for `zones`.

        Returns:
            The motion as a possible member of a chain. If the motion can't be executed as its command
            requests, a finding is added, and the result is None.
        """
        told = self.settings
        # The path was cached under a key with all relevant properties of the step (motion/routes.py). In this
        # key, the path can therefore stand for the step.
        key = ("link", self.robot, cell, told.grid, told.tolerance, path, leaves)

        def make() -> tuple[Link | None]:
            zones = self.zones(step, path, cell, leaves=leaves)
            return (self._link(step, path, zones, findings, ahead() if zones is None else None),)

        return told_before(told.memory, key, step.origin, findings, make)[0]

    def _link(
        self, step: Motion, path: Path, zones: SlowZones | None, findings: Collector, tried: Tried | None
    ) -> Link | None:
        timing = step.timing
        bounds, tolerance = self.asked(step)
        if zones is not None:
            bounds = replace(bounds, zones=zones)
        # A joint position that is computed again differs by rounding. A motion of far less than an encoder
        # count therefore counts as no motion.
        is_still = isinstance(path, JointPath | TimedPath) and bool(
            (path.slope <= NO_WAY * self.robot.axis_units).all()
        )
        if is_still:
            findings.add(*messages.no_motion(step.origin))
        if isinstance(step, TimedMove) and isinstance(path, TimedPath):
            return self._timed(step, path, bounds, tolerance, findings)
        profile = load_profile(step.profile)
        full: float | None = None
        grid = self.settings.grid
        fitted: Curve | TooFast | NotHeld | TooLong | NoLaw | CruiseBroken
        # Try in this order: a cruise just below the speed limit that the command sets, a requested speed, and
        # a given or the shortest duration.
        cruise = self._below_ceiling(step, path, bounds, tolerance)
        if cruise is not None:
            full, fitted = cruise
        elif timing.speed is not None and isinstance(path, CartesianPath):
            full = full_time(path, timing.speed)
            if full is None:
                findings.add(*messages.speed_without_unit(path.extent[1], step.origin))
                return None
            if not profile.has_cruise:
                findings.add(*messages.no_cruise(step))
                return None
            fitted = at_speed(path, full, bounds, grid, tolerance)
            if isinstance(fitted, CruiseBroken) and fitted.broken is None:
                # The path is too short to start and stop at this speed. If the motion flows into another one,
                # it may still reach the speed.
                gentle = load_profile(FOR_SHORT)
                trials = None if tried is None else tried.trials_of(gentle)
                fitted = fit(path, gentle, None, bounds, grid, tolerance, trials)
        else:
            trials = None if tried is None else tried.trials_of(profile)
            fitted = fit(path, profile, timing.duration, bounds, grid, tolerance, trials)
        near = None
        if isinstance(path, CartesianPath) and not (tried is not None and tried.keeps_away):
            near = nearest_singularity(path, bounds.velocity)
        match fitted:
            case Curve():
                if near is not None:
                    findings.add(*messages.near_singularity(self.robot, near, fitted, step))
                return Link(path, profile, timing.duration, full, bounds, tolerance, None, fitted)
            case TooFast():
                findings.add(*messages.too_fast(self.robot, fitted, grid, step, near))
            case CruiseBroken():
                findings.add(*messages.too_fast_a_cruise(self.robot, fitted, step, near))
            case TooLong():
                findings.add(*messages.too_long(self.robot, fitted, step.origin, near))
            case NoLaw():
                findings.add(*messages.no_law(self.robot, fitted, step, near))
            case NotHeld():
                findings.add(*messages.not_held(fitted, grid.smallest, step.origin))
        return None

    def _below_ceiling(
        self, step: Motion, path: Path, bounds: Bounds, tolerance: Tolerance
    ) -> tuple[float, Curve] | None:
        """If the command of a motion sets a speed limit, plan the motion with a cruise just below it.

        Returns:
            The duration of the whole path at that speed [s], and the curve. None if the command sets no
            limit, or no cruise at that speed is possible.
        """
        full = _full_below(step, path)
        if full is None or not load_profile(step.profile).has_cruise:
            return None
        fitted = at_speed(path, full, bounds, self.settings.grid, tolerance)
        return (full, fitted) if isinstance(fitted, Curve) else None

    def _timed(
        self, step: TimedMove, path: TimedPath, bounds: Bounds, tolerance: Tolerance, findings: Collector
    ) -> Link | None:
        """Plan a motion along a timetable. If the robot can't follow it, add a finding and return None."""
        grid = self.settings.grid
        fitted = fit_timed(path, step.within, bounds, grid)
        match fitted:
            case Curve():
                return Link(path, load_profile(step.profile), None, None, bounds, tolerance, None, fitted)
            case Broken() | Missed() | TooShort():

                def path_at(stretch: float) -> TimedPath:
                    return along(step.table.stretched(stretch), path.start)

                stretch = shortest_stretch(path_at, fitted, step.within, bounds, grid, step.stretch)
                findings.add(*messages.timetable_refused(self.robot, fitted, step, stretch))
            case TooLong():
                findings.add(*messages.too_long_a_table(fitted, step.origin))
        return None

    def bare_link(self, step: Motion, path: Path, cell: Cell | None) -> Link | None:
        """Return a motion of a long chain with only its path and limits. Its curve is planned with the whole
        chain.

        The result is None if the motion must first be planned alone: its path is in joint space, its profile
        has no cruise, its duration is given, or its speed has no suitable unit.
        """
        if not isinstance(path, CartesianPath):
            return None
        timing, profile = step.timing, load_profile(step.profile)
        if not profile.has_cruise or timing.duration is not None:
            return None
        full = None
        if timing.speed is not None:
            way, turns = path.extent
            speed = timing.speed.angle if turns else timing.speed.length
            if speed is None:
                return None
            full = way / speed
        else:
            full = _full_below(step, path)
        bounds, tolerance = self.asked(step)
        frame = moving_of(self.robot, step)
        key = (cell, frame.name, frame.flange_from_moving.tobytes(), timing.ceiling)
        if key not in self._slow:
            self._slow[key] = slow_zones(self.robot, cell, step)
        if self._slow[key] is not None:
            bounds = replace(bounds, zones=self._slow[key])
        return Link(path, profile, None, full, bounds, tolerance, None, None)

    def pieces(self, chain: list[Link]) -> list[Piece] | None:
        """Return the curves of the motions of a chain, or of a single motion.

        The result is None if each motion must first be planned alone.
        """
        settings = self.settings
        if all(link.by_itself is not None for link in chain):
            if len(chain) == 1:
                return [chain[0].as_alone]
            # A curve belongs to one link and never changes. Its identity can therefore stand for everything
            # from which it was computed.
            parts = [(link.alone, None if link.corner is None else link.corner.key) for link in chain]
            key = ("chain", self.robot, settings.grid, *parts)
            return recall(settings.memory, key, lambda: linked(self.robot.chain, chain, settings.grid))
        if len(chain) == 1:
            return None
        if isinstance(settings.memory, Forgetful):
            return flowing(chain, settings.grid)
        asked = [
            (
                self.robot,
                link.path,
                link.full,
                link.profile,
                link.tolerance,
                link.bounds.key,
                None if link.corner is None else link.corner.key,
            )
            for link in chain
        ]
        return recall(
            settings.memory,
            ("path", settings.grid, *asked),
            lambda: flowing(chain, settings.grid, Known(settings.memory, asked)),
        )

    def pieces_of_known(
        self,
        numbers: list[int],
        chain: list[Link],
        steps: Sequence[Step],
        all_done: Sequence[Done],
        found: list[list[Diagnostic]],
        links: dict[int, Link],
    ) -> list[Piece | None]:
        """Plan each motion of a chain alone, since the chain can't be planned as one path, and return the
        curves.

        An item is None for a motion that can't be executed from rest to rest.

        Args:
            numbers: the step indices of the motions.
            chain: the motions.
            steps: the steps of the program.
            all_done: the result of each step's path search.
            found: the findings of each step; those of these motions are added.
            links: all motions by their step indices; those of this chain are replaced by the planned ones.
        """
        known: list[Link | None] = []
        for number, bare in zip(numbers, chain, strict=True):
            step, done = steps[number], all_done[number]
            assert isinstance(step, Motion)
            findings = Collector(step.origin.source)
            findings.place = step.origin.place
            link = self.link(step, bare.path, done.cell, findings, lambda: None, leaves=True)
            found[number] += findings.found
            known.append(None if link is None else replace(link, corner=bare.corner))
            if link is not None:
                links[number] = link
        done_all = [link for link in known if link is not None]
        pieces = self.pieces(done_all) if len(done_all) == len(known) else None
        return (
            list(pieces)
            if pieces is not None
            else [None if link is None else link.as_alone for link in known]
        )

    def judge_piece(self, step: Motion, link: Link, piece: Piece, flows: bool, findings: Collector) -> None:
        """Report a motion in a chain that isn't executed exactly as its command requests: with a stop at a
        corner, or in another duration.
        """
        if flows and piece.overlap is None:
            findings.add(*stops_at_corner(step.origin))
        if link.duration is not None and abs(piece.curve.duration - link.duration) > _EXACT:
            findings.add(*time_off_the_grid(link.duration, piece.curve, step.origin))


def _full_below(step: Motion, path: Path) -> float | None:
    """Return the duration of a path just below the speed limit that its command sets [s]. The result is None
    if the command sets none, or if the path is a pure rotation.
    """
    ceiling = step.timing.ceiling
    if ceiling is None or not isinstance(path, CartesianPath):
        return None
    way, turns = path.extent
    return None if turns else way / (BELOW_CEILING * ceiling)


ENOUGH_LINKED = 12
"""Number of motions in chains after which no more chains are planned, if the program has errors.

Planning a long chain takes seconds. Without it, only findings about stops at corners and about missed
durations are lost.
"""

NO_WAY = 1e-9
"""Motion of a joint up to which it counts as a rounding error [axis units]."""

_EXACT = 2e-4
"""Difference up to which a duration counts as the requested one [s]. Segment times are rounded to the
controller's step, and the rounding errors of some hundred segments may add up to this difference.
"""
