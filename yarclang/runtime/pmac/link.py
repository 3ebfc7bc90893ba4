"""Measurement of the speed of the connection and of the controller, and of how the controller numbers refused
lines.
"""

from __future__ import annotations

from dataclasses import dataclass

from yarclang.runtime.actions import Script, Trouble
from yarclang.runtime.pmac.operation import Operation
from yarclang.runtime.pmac.packets import fitting
from yarclang.runtime.scripts import Measured

_SCRATCH = "P8180"
"""A variable that no one uses: values written to it have no effect."""

_SHARE = 0.7
"""Largest share of the connection's speed that a program may need."""

_ASKED = 20
_PACKETS = 5


@dataclass(frozen=True, slots=True)
class Link:
    """Results of the measurement of the connection.

    Attributes:
        round_trips: times of single questions [s], in ascending order.
        lines_per_second: rate of WRITEBUFFER for lines as long as a move line.
        lines_per_packet: number of such lines in a packet.
        first_line: number that the controller gives the first line of a packet; None if it is neither 0 nor
            1.
        stops_at_error: True if the controller skips the lines after a refused one.
    """

    round_trips: tuple[float, ...]
    lines_per_second: float
    lines_per_packet: int
    first_line: int | None
    stops_at_error: bool

    @property
    def median(self) -> float:
        """Return the median round trip [s]."""
        return self.round_trips[len(self.round_trips) // 2]

    @property
    def worst(self) -> float:
        """Return the slowest round trip [s]."""
        return self.round_trips[-1]


def measure(operation: Operation, axes: int) -> Script[Link]:
    """Measure the connection, with no buffer open on our port of the controller. Writes only to unused
    variables from P8180 on.

    Args:
        operation: state of the run, and access to the controller.
        axes: number of values in a move line.
    """
    yield from operation.ask("CLOSE")
    times = []
    for _ in range(_ASKED):
        begun = operation.now
        yield from operation.ask(_SCRATCH)
        times.append(operation.now - begun)
    line = "".join(f"{_SCRATCH[:-1]}{number}=12.345678" for number in range(axes))[:120]
    line = line[: line.rfind("P")] if len(line) == 120 else line
    count = fitting((line,) * 200)
    begun = operation.now
    for _ in range(_PACKETS):
        written = yield from operation.write((line,) * count)
        if written.error is not None:
            raise Trouble(f"the controller refuses {line!r}: ERR{written.error:03d}")
    spent = max(operation.now - begun, 1e-6)
    yield from operation.ask(f"{_SCRATCH}=0")
    refused = yield from operation.write((f"{_SCRATCH}=1", "ENDIF", f"{_SCRATCH}=2"))
    (value,) = yield from operation.numbers(_SCRATCH, 1)
    first = refused.line - 1 if refused.error is not None and refused.line in (1, 2) else None
    return Link(tuple(sorted(times)), _PACKETS * count / spent, count, first, value == 1.0)


def figures(link: Link) -> Measured:
    """Return the measurements in sentences, and as numbers."""
    segment = 1e3 / (link.lines_per_second * _SHARE)
    lines = [
        (
            f"link: a reply takes {link.median * 1e3:.2f} ms (median), {link.worst * 1e3:.2f} ms at "
            f"worst; "
            f"{link.lines_per_second:.0f} program lines/s, enough for segments of {segment:.2g} ms and more"
        )
    ]
    first = "it doesn't say" if link.first_line is None else f"from {link.first_line}"
    behind = "aren't executed" if link.stops_at_error else "ARE executed: a refused line would end the run"
    lines.append(
        f"link: the controller counts the lines of a packet {first}; lines after a refused one {behind}"
    )
    values = {
        "round_trip_median_ms": link.median * 1e3,
        "round_trip_worst_ms": link.worst * 1e3,
        "lines_per_s": link.lines_per_second,
        "first_line": link.first_line,
        "stops_at_error": link.stops_at_error,
    }
    return Measured(tuple(lines), values)
