"""A checked program to a plan: the paths of all motions, and then the curves on which the robot goes along them."""

from __future__ import annotations

from dataclasses import dataclass, replace

from yarclang.cell.model import Cell
from yarclang.diagnostics import Collector, Diagnostic, Result, has_errors
from yarclang.frozen import frozen
from yarclang.hir import ArcMove, Gap, LineMove, Motion, PoseSplineMove, Program, Stop
from yarclang.memory import NO_MEMORY, Memory, recall
from yarclang.motion import messages
from yarclang.motion.cartesian import CartesianPath
from yarclang.motion.chains.chain import linked
from yarclang.motion.chains.corners import chained
from yarclang.motion.chains.links import Link, Piece
from yarclang.motion.chains.messages import stops_at_corner, time_off_the_grid
from yarclang.motion.cruise import CruiseBroken, at_speed
from yarclang.motion.curve import Curve
from yarclang.motion.fit import NotHeld, TooFast, TooLong, fit
from yarclang.motion.leading.led import FrameWay
from yarclang.motion.limits import Bounds, Grid, bounds_of
from yarclang.motion.path import Path
from yarclang.motion.paths.joint import JointPath
from yarclang.motion.plan import MotionPlan, PlannedMotion
from yarclang.motion.profile import NoLaw, load_profile
from yarclang.motion.recalling import told_before
from yarclang.motion.routes import Router
from yarclang.motion.singular import nearest_singularity
from yarclang.motion.zones import SlowZones, slow_zones
from yarclang.progress import tell
from yarclang.robot.model import Robot, Tolerance


@frozen
class Settings:
    """How to plan: the segment times that the controller takes, the tolerance, and what was planned before."""

    grid: Grid
    tolerance: Tolerance
    memory: Memory = NO_MEMORY


def plan(program: Program, robot: Robot, settings: Settings) -> Result[MotionPlan]:
    """Plan all motions of a program.

    Returns:
        The plan, or None where a motion can't be done. After an error the planning goes on
        from where the robot would stand, as far as that is known, so that each fault is found.
    """
    made, is_whole, found = plan_in_part(program, robot, settings, ENOUGH_LINKED)
    return Result(made if is_whole else None, found)


def plan_in_part(
    program: Program, robot: Robot, settings: Settings, enough: int | None = None
) -> tuple[MotionPlan, bool, tuple[Diagnostic, ...]]:
    """Plan the motions of a program that can be planned, whether that is the whole program without an error, and the findings.

    In a plan in part, a motion need not begin where the one before it ends: it is for showing, never for a controller. Of a program with errors, chains
    of motions are planned up to `enough` motions in them (None: all).
    """
    steps = program.steps
    end = next((number for number, step in enumerate(steps) if isinstance(step, Stop)), len(steps))
    steps = steps[:end]
    router = Router(robot, steps, program.start, program.cell, settings.memory)
    planner = _Planner(robot, settings, bounds_of(robot), program.cell)
    for number in range(end):
        tell("planning", number // 2, end)
        router.advance()
    found: list[list[Diagnostic]] = [list(done.found) for done in router.done]
    links: dict[int, Link] = {}
    ways: dict[int, Path | FrameWay] = {}
    flows = False
    for number, (step, done) in enumerate(zip(steps, router.done, strict=True)):
        tell("planning", (end + number) // 2, end)
        if done.way is not None:
            ways[number] = done.way
        if isinstance(step, Motion) and done.route is not None:
            ways[number] = done.route.path
            findings = Collector(step.origin.source)
            findings.place = step.origin.place
            link = planner.link(step, done.route.path, flows or step.blend is not None, findings)
            found[number] += findings.found
            if link is not None:
                links[number] = link
        elif isinstance(step, Motion):
            found[number] += _known_without_a_way(step)
        if isinstance(step, Motion):
            flows = step.blend is not None
    motions: list[PlannedMotion] = []
    has_gaps = any(isinstance(step, Gap) for step in steps)
    if not (has_gaps or any(map(has_errors, found))):
        enough = None
    in_chains = 0
    for numbers, chain in chained(robot, steps, links, ways, found):
        if len(chain) > 1:
            in_chains += len(chain)
            if enough is not None and in_chains > enough:
                continue
        for number, piece in zip(numbers, planner.pieces(chain), strict=True):
            step, route = steps[number], router.done[number].route
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
                )
            )
            findings = Collector(step.origin.source)
            findings.place = step.origin.place
            planner.judge_piece(step, links[number], piece, number != numbers[-1], findings)
            found[number] += findings.found
    everything = tuple(one for findings_of_step in found for one in findings_of_step)
    complete = (
        len(motions) == sum(isinstance(step, Motion) for step in steps)
        and not has_gaps
        and not any(one.is_error for one in everything)
    )
    return MotionPlan(program, robot, tuple(motions)), complete, everything


def _known_without_a_way(step: Motion) -> list[Diagnostic]:
    """What is wrong with a motion whose start or end isn't known: told now, and not once that is mended."""
    findings = Collector(step.origin.source)
    findings.place = step.origin.place
    leads_frame = isinstance(step, LineMove | ArcMove | PoseSplineMove)
    if leads_frame and step.timing.speed is not None and not load_profile(step.profile).has_cruise:
        findings.add(*messages.no_cruise(step))
    return findings.found


@dataclass(slots=True)
class _Planner:
    robot: Robot
    settings: Settings
    bounds: Bounds
    cell: Cell | None

    def zones(self, step: Motion, path: Path, *, leaves: bool) -> SlowZones | None:
        """The slow zones that a motion may get into; `leaves` says that it may leave its path to flow into another one."""
        zones = slow_zones(self.robot, self.cell, step)
        return zones if zones is None or leaves else zones.beside(path.joints, path.slope)

    def link(self, step: Motion, path: Path, leaves: bool, findings: Collector) -> Link | None:
        """A motion by itself; None with a finding where it can't be done as the command says. `leaves`: as of `zones`."""
        told = self.settings
        # the path was recalled by all that the step does (motion/routes.py), and stands for it
        key = ("link", self.robot, self.cell, told.grid, told.tolerance, path, leaves)

        def make() -> tuple[Link | None]:
            return (self._link(step, path, self.zones(step, path, leaves=leaves), findings),)

        return told_before(told.memory, key, step.origin, findings, make)[0]

    def _link(self, step: Motion, path: Path, zones: SlowZones | None, findings: Collector) -> Link | None:
        timing, tolerance = step.timing, self.settings.tolerance
        if step.tolerance is not None:
            tolerance = Tolerance(step.tolerance, tolerance.angle)
        # inverse kinematics and sums come back to a place but for rounding: far below a count, nothing moves
        if isinstance(path, JointPath) and bool((path.slope <= NO_WAY * self.robot.axis_units).all()):
            findings.add(*messages.no_motion(step.origin))
        profile = load_profile(step.profile)
        bounds = replace(self.bounds, zones=zones).reduced(timing.share, timing.ramp)
        full: float | None = None
        grid = self.settings.grid
        fitted: Curve | TooFast | NotHeld | TooLong | NoLaw | CruiseBroken
        if timing.speed is not None and isinstance(path, CartesianPath):
            way, turns = path.extent
            speed = timing.speed.angle if turns else timing.speed.length
            if speed is None:
                findings.add(*messages.speed_without_unit(turns, step.origin))
                return None
            if not profile.has_cruise:
                findings.add(*messages.no_cruise(step))
                return None
            full = way / speed
            fitted = at_speed(path, full, bounds, grid, tolerance)
            if isinstance(fitted, CruiseBroken) and fitted.broken is None:
                # too short to start and stop; whether the speed is reached depends on what it flows into
                fitted = fit(path, load_profile("SCURVE"), None, bounds, grid, tolerance)
        else:
            fitted = fit(path, profile, timing.duration, bounds, grid, tolerance)
        near = nearest_singularity(path, bounds.velocity) if isinstance(path, CartesianPath) else None
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

    def pieces(self, chain: list[Link]) -> list[Piece]:
        """The curves of motions that flow into each other, or of one."""
        if len(chain) == 1:
            return [chain[0].as_alone]
        settings = self.settings
        # a curve is of one link, and stands for all that it was made of
        parts = [(link.alone, None if link.corner is None else link.corner.key) for link in chain]
        key = ("chain", self.robot, settings.grid, *parts)
        return recall(settings.memory, key, lambda: linked(self.robot.chain, chain, settings.grid))

    def judge_piece(self, step: Motion, link: Link, piece: Piece, flows: bool, findings: Collector) -> None:
        """Say where a chain can't do quite what its commands say."""
        if flows and not piece.overlap:
            findings.add(*stops_at_corner(step.origin))
        if link.duration is not None and abs(piece.curve.duration - link.duration) > _EXACT:
            findings.add(*time_off_the_grid(link.duration, piece.curve, step.origin))


ENOUGH_LINKED = 12
"""Motions without a stop between them that are planned of a program with errors. What is found there besides are stops at corners and times that
aren't kept, and a long chain takes seconds.
"""

NO_WAY = 1e-9
"""The longest way of a joint [axis units] that is rounding."""

_EXACT = 2e-4
"""A duration that is off by no more [s] is the one that was asked for: the controller's step times some hundred segments."""
