"""Axis definitions: motors as sums of axes (TSRM 269, PSRM 179-180)."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from yarclang.pmac.errors import DATA
from yarclang.simulator.language.statements import AXES
from yarclang.simulator.motion.pieces import Array
from yarclang.simulator.network.reply import Refusal
from yarclang.simulator.state.registers import printed

_TERM = re.compile(r"([+-]?)(\d+\.?\d*|\.\d+)?([A-CU-Z])?")
_GROUPS = ("XYZ", "UVW")


@dataclass(frozen=True, slots=True)
class AxisDefinition:
    """Axis definition of a motor: its position as a linear function of axis positions.

    Attributes:
        terms: for each term, the axis and the counts per axis unit.
        offset: constant term [counts].
    """

    terms: tuple[tuple[str, float], ...]
    offset: float

    @property
    def text(self) -> str:
        """The definition as the controller reports it."""
        parts = [f"{'' if scale == 1.0 else printed(scale)}{axis}" for axis, scale in self.terms]
        if self.offset:
            parts.append(printed(self.offset))
        return "+".join(parts).replace("+-", "-").replace("-1X", "-X")


def axis_definition(text: str) -> AxisDefinition | None:
    """Parse an axis definition, which is the text after `#1->`; None for 0, which removes a definition.

    Raises:
        Refusal: ERR003 for a text that isn't a definition, or for axes that may not be summed.
    """
    if text == "0":
        return None
    terms: list[tuple[str, float]] = []
    offset, at = 0.0, 0
    while at < len(text):
        match = _TERM.match(text, at)
        if not match or match.end() == at or (at and not match[1]):
            raise Refusal(DATA)
        sign, number, axis = match.groups()
        scale = (-1.0 if sign == "-" else 1.0) * float(number or 1.0)
        if axis:
            terms.append((axis, scale))
        elif number:
            offset += scale
        else:
            raise Refusal(DATA)
        at = match.end()
    letters = {axis for axis, _ in terms}
    summed = len(terms) < 2 or any(letters <= set(group) for group in _GROUPS)
    if not terms or len(letters) < len(terms) or not summed:
        raise Refusal(DATA)
    return AxisDefinition(tuple(terms), offset)


@dataclass(frozen=True, slots=True, eq=False)
class Axes:
    """All axis definitions of a coordinate system. Motor positions are `matrix` @ axis positions + `offset`.

    Attributes:
        motors: numbers of the n motors.
        matrix: (n, 9) coefficients of the axis positions [counts per axis unit].
        offset: (n,) constant terms [counts].
    """

    motors: tuple[int, ...]
    matrix: Array
    offset: Array

    def counts(self, axes: Array) -> Array:
        """Return the motor positions (n,) [counts] for axis positions (9,)."""
        counts: Array = self.matrix @ axes + self.offset
        return counts

    def matched(self, counts: Array, axes: Array) -> Array:
        """Return the axis positions (9,) that correspond to motor positions, as PMATCH does.

        Args:
            counts: (n,) motor positions [counts].
            axes: (9,) current axis positions, which axes without a motor keep.
        """
        used = np.flatnonzero(np.any(self.matrix != 0.0, axis=0))
        result = axes.copy()
        if len(used):
            matrix = self.matrix[:, used]
            if len(matrix) == len(used) and np.linalg.matrix_rank(matrix) == len(used):
                result[used] = np.linalg.solve(matrix, counts - self.offset)
            else:
                result[used] = np.linalg.lstsq(matrix, counts - self.offset, rcond=None)[0]
        return result


def axes_of(definitions: Sequence[tuple[int, AxisDefinition]]) -> Axes:
    """Combine the axis definitions of motors, given with the motors' numbers, in the given order."""
    matrix = np.zeros((len(definitions), len(AXES)))
    offset = np.zeros(len(definitions))
    for row, (_, item) in enumerate(definitions):
        for axis, scale in item.terms:
            matrix[row, AXES.index(axis)] = scale
        offset[row] = item.offset
    return Axes(tuple(motor for motor, _ in definitions), matrix, offset)
