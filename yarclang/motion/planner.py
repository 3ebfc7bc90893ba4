"""A checked program to a plan: the paths of all motions, and then the curves on which the robot goes along them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from yarclang.diagnostics import Collector, Diagnostic, Result
from yarclang.hir import Gap, Motion, Program, Stop
from yarclang.motion import messages
from yarclang.motion.cartesian import CartesianPath
from yarclang.motion.cruise import CruiseBroken, at_speed
from yarclang.motion.curve import Curve
from yarclang.motion.fit import NotHeld, TooFast, TooLong, fit
from yarclang.motion.limits import Bounds, Grid, bounds_of
from yarclang.motion.path import Path
from yarclang.motion.paths.joint import JointPath
from yarclang.motion.plan import MotionPlan, PlannedMotion
from yarclang.motion.profile import load_profile
from yarclang.motion.routes import Router
from yarclang.robot.model import Robot, Tolerance


@dataclass(frozen=True, slots=True)
class Settings:
    """How to plan: the segment times that the controller takes, the tolerance, and who wants to hear of progress.

    `progress` is called with the number of steps done.
    """

    grid: Grid
    tolerance: Tolerance
    progress: Callable[[int], None] | None = None


def plan(program: Program, robot: Robot, settings: Settings) -> Result[MotionPlan]:
    """Plan all motions of a program.

    Returns:
        The plan, or None where a motion can't be done. After an error the planning goes on
        from where the robot would stand, as far as that is known, so that each fault is found.
    """
    steps = program.steps
    end = next((number for number, step in enumerate(steps) if isinstance(step, Stop)), len(steps))
    router = Router(robot, steps[:end], program.start)
    for number in range(end):
        if settings.progress is not None:
            settings.progress(number // 2)
        router.advance()
    planner = _Planner(robot, settings, bounds_of(robot))
    motions: list[PlannedMotion] = []
    diagnostics: list[Diagnostic] = []
    complete = True
    for number, (step, done) in enumerate(zip(steps[:end], router.done, strict=True)):
        if settings.progress is not None:
            settings.progress((end + number) // 2)
        diagnostics += done.found
        if isinstance(step, Gap):
            complete = False
            continue
        complete &= not any(found.is_error for found in done.found)
        if not isinstance(step, Motion):
            continue
        if done.route is None:
            complete = False
            continue
        findings = Collector(step.origin.source)
        findings.place = step.origin.place
        curve = planner.curve(step, done.route.path, findings)
        diagnostics += findings.found
        if curve is None:
            complete = False
            continue
        motions.append(PlannedMotion(number, done.route.path, step.profile, curve, done.route.waypoints))
    return Result(MotionPlan(program, robot, tuple(motions)) if complete else None, tuple(diagnostics))


NO_WAY = 1e-9
"""The longest way of a joint [axis units] that is rounding."""


@dataclass(slots=True)
class _Planner:
    robot: Robot
    settings: Settings
    bounds: Bounds

    def curve(self, step: Motion, path: Path, findings: Collector) -> Curve | None:
        """The path in the time, or at the speed, that the command asks for."""
        # inverse kinematics and sums come back to a place but for rounding: far below a count, nothing moves
        if isinstance(path, JointPath) and bool((path.slope <= NO_WAY * self.robot.axis_units).all()):
            findings.add(*messages.no_motion(step.origin))
        timing, tolerance, grid = step.timing, self.settings.tolerance, self.settings.grid
        if step.tolerance is not None:
            tolerance = Tolerance(step.tolerance, tolerance.angle)
        bounds = self.bounds.reduced(timing.share, timing.ramp)
        fitted: Curve | TooFast | NotHeld | TooLong | CruiseBroken
        if timing.speed is not None and isinstance(path, CartesianPath):
            way, turns = path.extent
            speed = timing.speed.angle if turns else timing.speed.length
            if speed is None:
                findings.add(*messages.speed_without_unit(turns, step.origin))
                return None
            fitted = at_speed(path, way, speed, bounds, grid, tolerance)
        else:
            fitted = fit(path, load_profile(step.profile), timing.duration, bounds, grid, tolerance)
        match fitted:
            case Curve():
                return fitted
            case TooFast():
                findings.add(*messages.too_fast(self.robot, fitted, grid, step))
            case CruiseBroken():
                findings.add(*messages.too_fast_a_cruise(self.robot, fitted, step))
            case TooLong():
                findings.add(*messages.too_long(fitted, step.origin))
            case NotHeld():
                findings.add(*messages.not_held(fitted, grid.smallest, step.origin))
        return None
