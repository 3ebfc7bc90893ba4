"""Motor counts as a function of the joint positions q, counts = K J q + a0, in exact numbers; and groups of
coupled motors.

K has the gear ratios, J is the coupling of the joints to the motors, and a0 has the motors' offsets.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from yarclang.robot.model import Array, Robot

Row = list[Fraction]
ENDLESS = Fraction(36_000)
"""Assumed largest distance from zero of a joint without limits [deg or mm]; 100 turns of a revolute joint."""


@dataclass(frozen=True)
class Coupling:
    """Motor counts as an affine function of the joint positions in axis units (deg, mm).

    Attributes:
        matrix: K J, with one row for each motor [counts per axis unit].
        offset: a0 [counts].
        inverse: inverse of the matrix, with one row for each joint [axis units per count].
        lower: lower limits of the joints [axis units]; None for a joint without one.
        upper: upper limits of the joints [axis units]; None for a joint without one.
    """

    matrix: list[Row]
    offset: Row
    inverse: list[Row]
    lower: list[Fraction | None]
    upper: list[Fraction | None]

    @cached_property
    def reach(self) -> Row:
        """Largest distance of each joint from zero [axis units]."""
        return [
            max(ENDLESS if low is None else abs(low), ENDLESS if high is None else abs(high))
            for low, high in zip(self.lower, self.upper, strict=True)
        ]

    @cached_property
    def range(self) -> Row:
        """Bound of the absolute position of each motor [counts]."""
        return [
            sum(
                # In the worst case, the absolute values of all terms add up.
                (abs(share) * reach for share, reach in zip(row, self.reach, strict=True) if share),
                abs(offset),
            )
            for row, offset in zip(self.matrix, self.offset, strict=True)
        ]

    @cached_property
    def slack(self) -> Row:
        """Allowed rounding error of each motor [counts]: 1/1000 count, plus 1e-11 of its range."""
        return [Fraction(1, 1000) + range_ / 10**11 for range_ in self.range]

    @cached_property
    def joint_slack(self) -> Row:
        """Error of each joint's position that results from `slack` [axis units]."""
        return [
            sum(
                # In the worst case, the effects of the errors of all motors add up.
                (abs(share) * slack for share, slack in zip(row, self.slack, strict=True) if share),
                Fraction(0),
            )
            for row in self.inverse
        ]

    @cached_property
    def groups(self) -> list[tuple[list[int], list[int]]]:
        """Groups of coupled motors and joints: rows and columns connected by entries other than 0."""
        left = list(range(len(self.matrix)))
        found = []
        while left:
            # Find the connected components: motors are connected if they move a common joint.
            motors, joints = {left[0]}, set[int]()
            while True:
                joints |= {k for m in motors for k, share in enumerate(self.matrix[m]) if share}
                more = {m for m in left if any(self.matrix[m][k] for k in joints)} | motors
                if more == motors:
                    break
                motors = more
            left = [m for m in left if m not in motors]
            found.append((sorted(motors), sorted(joints)))
        return found


def coupling_of(robot: Robot) -> Coupling | None:
    """Return the coupling of a robot; None if its matrix is singular, so that motor counts determine no joint
    positions.
    """
    actuation, limits, units = robot.actuation, robot.limits, exact(robot.axis_units)
    matrix = [
        [gear * share for share in exact(row)]
        for gear, row in zip(exact(actuation.gear), actuation.coupling, strict=True)
    ]
    inverse = _inverse(matrix)
    if inverse is None:
        return None
    lower, upper = (
        [None if at is None else at / unit for at, unit in zip(_finite(ends), units, strict=True)]
        for ends in (limits.lower, limits.upper)
    )
    return Coupling(matrix, exact(actuation.offset), inverse, lower, upper)


def exact(values: Array) -> Row:
    """Return the numbers as exact fractions."""
    return [Fraction(float(value)) for value in values]


def _finite(values: Array) -> list[Fraction | None]:
    return [None if abs(value) == float("inf") else Fraction(float(value)) for value in values]


def _inverse(matrix: list[Row]) -> list[Row] | None:
    """Return the inverse of a matrix (Gauss-Jordan elimination); None if it is singular."""
    size = len(matrix)
    rows = [[*row, *(Fraction(int(at == other)) for other in range(size))] for at, row in enumerate(matrix)]
    for at in range(size):
        # In exact numbers, any pivot other than zero will do.
        pivot = next((row for row in range(at, size) if rows[row][at]), None)
        if pivot is None:
            return None
        rows[at], rows[pivot] = rows[pivot], rows[at]
        head = rows[at][at]
        rows[at] = [value / head if value else value for value in rows[at]]
        for other in range(size):
            # Clear the column in all other rows.
            factor = rows[other][at]
            if other != at and factor:
                rows[other] = [
                    value - factor * share if share else value
                    for value, share in zip(rows[other], rows[at], strict=True)
                ]
    return [row[size:] for row in rows]
