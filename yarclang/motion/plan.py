"""Define the motion plan: the joint positions of the robot as functions of time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import (
    Array,
    Dwell,
    Else,
    EndLoop,
    EndWhen,
    Exit,
    Finish,
    Gap,
    Hold,
    Loop,
    NextPass,
    Origin,
    Program,
    WaitInput,
    WaitUntil,
    When,
)
from yarclang.lasting import Lasting, Mark, Part, Schedule, schedule_of
from yarclang.motion.curve import Curve, Sampler
from yarclang.motion.path import Path
from yarclang.motion.profile import load_profile
from yarclang.robot.model import Robot

_MARKS: Mapping[type, Mark] = MappingProxyType(
    {
        WaitInput: "wait",
        WaitUntil: "wait",
        Hold: "hold",
        When: "when",
        Else: "else",
        EndWhen: "end",
        Finish: "finish",
        Loop: "loop",
        NextPass: "next",
        Exit: "exit",
        EndLoop: "endloop",
    }
)


@frozen(eq=False)
class PlannedMotion:
    """A planned motion: the curve for step number `step` of the program.

    `profile` is empty for a motion along a timetable. `waypoints` (k, n) [rad or m] are the joint positions
    chosen for its waypoints, without the start. `curve` goes from rest to rest, unless the motion flows into
    its neighbours: then it goes from the middle of one overlap to the middle of the next. `overlap` is the
    number of segments of the overlap at its end, 0 if both paths are kept, None if the motion ends at rest.

    `law` has control values of the completed share of the path over time. They describe the whole motion from
    rest to rest, so they extend beyond `curve` by half an overlap on either side. `kept` is the share of the
    requested speed that is reached. `least` is the share that is kept after it has been reached; see `Piece`.
    """

    step: int
    path: Path
    profile: str
    curve: Curve
    waypoints: Array
    law: Array
    overlap: int | None = None
    kept: float = 1.0
    least: float = 1.0

    @property
    def flows(self) -> bool:
        """True if the next motion begins without a stop."""
        return self.overlap is not None

    @property
    def half(self) -> float:
        """The duration of half the overlap at the end of the motion [s]."""
        return (self.overlap or 0) * self.curve.segment / 2.0


@dataclass(frozen=True)
class MotionPlan:
    """All motions of a program, one after the other, each as a curve that the controller can execute exactly.

    On the time axis of the plan, all motions and dwells follow each other. Of a WHEN, all branches are
    included, one after the other, although only one of them is executed. Waiting for an input or the operator
    takes no time.

    In `program`, a line that was replaced by a polyline around obstacles is several steps, one for each leg.
    `asked` is the program without this replacement, None if nothing was replaced.
    """

    program: Program
    robot: Robot
    motions: tuple[PlannedMotion, ...]
    asked: Program | None = None

    @property
    def source_program(self) -> Program:
        """The program before any line was replaced by a polyline around obstacles."""
        return self.program if self.asked is None else self.asked

    @cached_property
    def schedule(self) -> Schedule:
        """The time at which each step of the program begins."""
        return schedule_of(self.parts)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """The duration of each step of the program. A motion that isn't planned takes no time."""
        durations = {motion.step: motion.curve.duration for motion in self.motions}
        parts: list[Part] = []
        for number, step in enumerate(self.program.steps):
            match step:
                case Dwell(duration=duration):
                    parts.append(float(duration))
                case When(within=float()):
                    parts.append("ask")
                case _ if (mark := _MARKS.get(type(step))) is not None:
                    parts.append(mark)
                case _:
                    parts.append(float(durations.get(number, 0.0)))
        return tuple(parts)

    def origin_of(self, motion: int) -> Origin:
        """Return the command of a motion, counted from 0."""
        step = self.program.steps[self.motions[motion].step]
        assert not isinstance(step, Gap)  # a gap is never planned
        return step.origin

    @property
    def lasting(self) -> Lasting:
        """The duration of the program."""
        return self.schedule.lasting

    @cached_property
    def begins(self) -> Array:
        """The time at which each motion begins (m,) [s]."""
        return np.array([self.schedule.places[motion.step] for motion in self.motions], dtype=np.float64)

    @cached_property
    def ends(self) -> Array:
        """The time at which each motion ends (m,) [s]."""
        return self.begins + np.array([motion.curve.duration for motion in self.motions], dtype=np.float64)

    @cached_property
    def any_jerk(self) -> frozenset[int]:
        """The steps of the motions whose jerk isn't limited: their motion profile has no jerk limit, or they
        follow a timetable.
        """
        return frozenset(
            motion.step for motion in self.motions if not load_profile(motion.profile).has_jerk_limit
        )

    @property
    def duration(self) -> float:
        """The time at which the plan ends [s]. All motions and dwells are counted, and all branches of a
        WHEN.

        The duration of one execution of the program is `lasting`.
        """
        return self.schedule.places[-1]

    def sample(self, times: Array) -> tuple[Array, Array, Array]:
        """Return position, velocity and acceleration of the joints, (N, n) each, at `times` (N,) [s] of the
        plan, in SI units.
        """
        q = np.tile(self.program.start, (len(times), 1))
        v, a = np.zeros_like(q), np.zeros_like(q)
        if not self.motions:
            return q, v, a
        # Take the last motion that has begun at each time. Before and after motions, the robot rests at their
        # ends.
        number = np.searchsorted(self.begins, times, side="right") - 1
        number = np.clip(number, 0, len(self.motions) - 1)
        return self.sampler.sample(number, times - self.begins[number])

    @cached_property
    def sampler(self) -> Sampler:
        """The sampler of all motions' curves; there must be at least one motion."""
        return Sampler([motion.curve for motion in self.motions])
