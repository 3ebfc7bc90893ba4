"""The controller text of a live motion: control points towards the present target. They are streamed only
after they were proved, together with a motion to rest that would follow them.

At each instant, the judge (`proof.py`) has accepted a motion to rest that begins at the end of the streamed
lines. If a motion towards the target can't be proved, the control points of this motion to rest are streamed
instead. So the robot comes to rest before a limit, an obstacle or a zone. From there it can move again if the
target leads away.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from yarclang.coordinator.live.grid import Rates, State, advance, to_rest
from yarclang.coordinator.live.proof import Judge
from yarclang.coordinator.live.steering import Steering, Target
from yarclang.robot.model import Array, Robot

WATCHDOG = 0.2
"""Time without a message after which the robot comes to rest [s]."""

STRIDE = 3
"""Number of control points that are proved together while the robot moves. The target is read once for each
such group.
"""

_FIRST_STRIDE = 36
"""Largest number of control points that are proved together. Larger groups than `STRIDE` are needed before
the motion begins, to fill the controller's buffer.
"""

_SAME_WAY = 0.7
"""Least cosine of the angle between two velocities that count as having the same direction."""

_USED = {"velocity": 0.98, "acceleration": 0.9, "jerk": 0.85}
"""Share of each limit that a live motion uses. The rest allows for the rounding of the printed numbers."""


def rates_of(robot: Robot, share: float = 1.0) -> Rates:
    """Return the limits of joint velocity, acceleration and jerk for live motions of a robot.

    Args:
        robot: the robot.
        share: share of the joints' velocity limits that live motions may use.
    """
    limits = robot.limits
    # A motor that drives several joints may reach its speed limit before the joints reach theirs.
    gear = np.abs(robot.actuation.coupling * robot.actuation.gear[:, None]) / robot.axis_units
    together = gear @ limits.velocity
    slower = np.where(gear > 0.0, (robot.actuation.velocity / together)[:, None], np.inf).min(axis=0)
    return Rates(
        limits.velocity * np.minimum(slower, 1.0) * _USED["velocity"] * share,
        limits.acceleration * _USED["acceleration"],
        limits.jerk * _USED["jerk"],
    )


class Generator:
    """Generates the controller text of one live motion, from rest to rest.

    Args:
        robot: the robot.
        start: (n,) commanded position of the robot [rad or m].
        printed: converts control points (k, n) [rad or m] to lines of text.
        segment: segment time [s].
        steering: computes joint velocities from targets.
        judge: proves the text.
        rates: limits of the motion.

    Attributes:
        ended: True if the text ends at rest and no more lines follow.
        why: reason why the target isn't followed; empty: it is followed.
        stopped_by: bodies and zones that prevent the motion to the target; empty: none.
    """

    def __init__(
        self,
        robot: Robot,
        start: Array,
        printed: Callable[[Array], tuple[str, ...]],
        segment: float,
        steering: Steering,
        judge: Judge,
        rates: Rates,
    ) -> None:
        self.ended = False
        self.why = ""
        self.stopped_by: tuple[str, ...] = ()
        self._robot = robot
        self._lines = printed
        self._segment = segment
        self._steering = steering
        self._judge = judge
        self._rates = rates
        self._state = State.at_rest(start)
        self._rest: tuple[State, ...] = ()
        self._target: Target | None = None
        self._refused: Array | None = None
        self._heard = -np.inf
        self._ending = False

    @property
    def end(self) -> Array:
        """Return the position (n,) at the end of the text so far [rad or m]."""
        return self._state.c

    @property
    def rests(self) -> bool:
        """Return True if the text ends at rest."""
        return self._state.rests

    def want(self, target: Target, now: float) -> None:
        """Set the target. It is valid for `WATCHDOG` seconds."""
        self._target, self._heard = target, now

    def finish(self) -> None:
        """Drop the target: the text ends as soon as the robot is at rest."""
        self._ending = True

    def expired(self, now: float) -> bool:
        """Return True if the last target is older than the watchdog allows."""
        return now - self._heard > WATCHDOG

    def more(self, now: float, count: int) -> tuple[str, ...]:
        """Return the next lines of the text: at least `count`, or fewer if the text ends.

        Args:
            now: the host's clock [s].
            count: number of lines wanted.
        """
        lines: list[str] = []
        target = None if self._ending or self.expired(now) else self._target
        while len(lines) < count and not self.ended:
            strides = -(-(count - len(lines)) // STRIDE)
            lines += self._stride(target, min(strides * STRIDE, _FIRST_STRIDE))
            if self._ending and self._state.rests:
                self.ended = True
        return tuple(lines)

    def _stride(self, target: Target | None, size: int) -> tuple[str, ...]:
        """Return the lines of the next control points, at most `size`: towards the target if that can be
        proved, otherwise towards rest.
        """
        h, rates = self._segment, self._rates
        states: list[State] = []
        state = self._state
        middle = STRIDE * h / 2.0
        steered = self._steering.velocity(target, state, middle)
        if self._refused is not None and _along(steered.velocity, self._refused):
            return self._towards_rest()
        self._refused = None
        for number in range(size):
            if number and number % STRIDE == 0:
                steered = self._steering.velocity(target, state, middle)
            state = advance(state, steered.velocity, rates, h)
            states.append(state)
        rest = to_rest(state, rates, h)
        lines = self._printed(states)
        objection = self._judge.objection(lines, self._tail(rest, state))
        if not objection:
            self.why, self.stopped_by = steered.held_back, ()
            return self._taken(lines, state, rest)
        if size > STRIDE:
            # A shorter group may be provable.
            return self._stride(target, size // 2 // STRIDE * STRIDE or STRIDE)
        # Remember the refused velocity. Otherwise, while the target is repeated, the robot would creep up to
        # the border of a zone in many tiny motions.
        self.why, self._refused = objection, steered.velocity
        self.stopped_by = self._judge.stopped_by
        return self._towards_rest()

    def _towards_rest(self) -> tuple[str, ...]:
        """Return the next lines of the motion to rest that was proved together with the streamed lines."""
        known = self._rest or (State.at_rest(self._state.c),)
        states = [known[min(number, len(known) - 1)] for number in range(STRIDE)]
        return self._taken(self._printed(states), states[-1], known[STRIDE:])

    def _taken(self, lines: tuple[str, ...], state: State, rest: tuple[State, ...]) -> tuple[str, ...]:
        self._judge.admit(lines)
        self._state, self._rest = state, rest
        return lines

    def _tail(self, rest: tuple[State, ...], state: State) -> tuple[str, ...]:
        last = rest[-1] if rest else state
        return self._printed([*rest, last, last])

    def _printed(self, states: list[State]) -> tuple[str, ...]:
        return self._lines(np.array([one.c for one in states]).reshape(-1, self._robot.size))


def _along(velocity: Array, other: Array) -> bool:
    """Return True if two joint velocities have about the same direction."""
    return bool(velocity @ other > _SAME_WAY * np.linalg.norm(velocity) * np.linalg.norm(other))
