"""A live motion as text: control points of what is wanted now, proved before they are streamed, with a proved way to rest behind them.

At each instant there is a way to rest that the judge has had no objection to. If what is wanted can't be proved, that way is taken instead, point by point: so the robot
comes to rest in front of a limit, an obstacle or a zone, and goes away from it when that is wanted.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from yarclang.coordinator.live.grid import Rates, State, advance, to_rest
from yarclang.coordinator.live.proof import Judge
from yarclang.coordinator.live.steering import Steering, Target
from yarclang.robot.model import Array, Robot

WATCHDOG = 0.2
"""Without a message for so long, the robot comes to rest [s]."""

STRIDE = 3
"""Points that are proved together while the robot moves: what is wanted is looked at as often."""

_FIRST_STRIDE = 36
"""The same at most where many are wanted at once, before the motion begins: what is wanted is looked at as often all the same."""

_SAME_WAY = 0.7
"""The cosine between two ways that are about the same."""

_USED = {"velocity": 0.98, "acceleration": 0.9, "jerk": 0.85}
"""What of the limits is used: printing takes the rest."""


def rates_of(robot: Robot, share: float = 1.0) -> Rates:
    """The rates that a robot is moved with; `share` of its largest velocities."""
    limits = robot.limits
    # a motor that drives several joints may be the slower one
    gear = np.abs(robot.actuation.coupling * robot.actuation.gear[:, None]) / robot.axis_units
    together = gear @ limits.velocity
    slower = np.where(gear > 0.0, (robot.actuation.velocity / together)[:, None], np.inf).min(axis=0)
    return Rates(
        limits.velocity * np.minimum(slower, 1.0) * _USED["velocity"] * share,
        limits.acceleration * _USED["acceleration"],
        limits.jerk * _USED["jerk"],
    )


class Generator:
    """One live motion, from rest to rest.

    Args:
        robot: that moves.
        start: (n,) where it is commanded to stand [rad or m].
        printed: prints positions (k, n) [rad or m] as lines.
        segment: TM [s].
        steering: makes velocities of what is wanted.
        judge: admits the text.
        rates: the limits that it is made with.

    Attributes:
        ended: whether the text ends at rest for good: no more lines come.
        why: why it doesn't do what is wanted; empty: it does.
        stopped_by: the bodies and zones that `why` is about; empty: it is about none.
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
        """(n,) where the text ends so far [rad or m]."""
        return self._state.c

    @property
    def rests(self) -> bool:
        """Whether it ends at rest."""
        return self._state.rests

    def want(self, target: Target, now: float) -> None:
        """This is wanted from now on, for the watchdog's time."""
        self._target, self._heard = target, now

    def finish(self) -> None:
        """Nothing is wanted any more: come to rest, and end the text there."""
        self._ending = True

    def expired(self, now: float) -> bool:
        """Whether nobody has said anything for too long."""
        return now - self._heard > WATCHDOG

    def more(self, now: float, count: int) -> tuple[str, ...]:
        """Lines behind all that came before: `count` or one more of them, or fewer where the text ends.

        Args:
            now: the host's clock [s].
            count: how many are wanted.
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
        """The next points, as wanted if that can be proved, else towards rest."""
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
            return self._stride(target, size // 2 // STRIDE * STRIDE or STRIDE)  # some of it can be done
        # whoever goes on wanting it would creep up to a border
        self.why, self._refused = objection, steered.velocity
        self.stopped_by = self._judge.stopped_by
        return self._towards_rest()

    def _towards_rest(self) -> tuple[str, ...]:
        """The next points of the way to rest that was proved as the one behind what is streamed already."""
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


def _along(one: Array, other: Array) -> bool:
    """Whether two joint velocities lead about the same way."""
    return bool(one @ other > _SAME_WAY * np.linalg.norm(one) * np.linalg.norm(other))
