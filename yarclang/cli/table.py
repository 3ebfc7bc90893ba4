"""The certificate as a table, a command a row."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from yarclang.certify.certificate import IDLE, Certificate, Clearance, CommandCertificate, Load, bound_text
from yarclang.report.distances import when_text, whole_tenths
from yarclang.units import DEG, MM

if TYPE_CHECKING:
    from yarclang.runtime.inspection import Checked

_HEAD = (
    "command",
    "",
    "time s",
    "TM ms",
    "position",
    "velocity",
    "accel.",
    "jerk",
    "motor",
    "hold",
    "path mm",
    "path deg",
)
_CLEAR = "clear mm"
"""Of programs in a cell with obstacles: the smallest distance, proved, and the two that come so near."""
_ZONES = "zones mm"
"""Of programs in a cell with zones that may not be left or entered: the smallest distance from such a border, proved, what comes so near, to which zone, and when."""


def certificate_table(certificate: Certificate) -> str:
    """Duration, the worst joint and its share of each limit, the proved deviation, and in a cell the clearance and the distance from zones, for each command."""
    rows = [_HEAD, *(tuple(_row(command)) for command in certificate.commands)]
    if any(command.torque for command in certificate.commands):
        torques = ["torque", *(_load(command.torque or IDLE) for command in certificate.commands)]
        rows = [(*row, cell) for row, cell in zip(rows, torques, strict=True)]
    for name, found in (
        (_CLEAR, [command.clearance for command in certificate.commands]),
        (_ZONES, [command.zone_clearance for command in certificate.commands]),
    ):
        if any(found):
            clear = [name, *(_clearance(one) for one in found)]
            rows = [(*row, cell) for row, cell in zip(rows, clear, strict=True)]
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = [
        "  ".join(
            cell.ljust(width) if column < 2 else cell.rjust(width)
            for column, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]
    lines.insert(1, "-" * max(len(line) for line in lines))
    return "\n".join(lines)


def _row(command: CommandCertificate) -> Iterator[str]:
    yield command.index or f"line {command.source_line}"
    yield command.name
    yield f"{command.duration:.3f}"
    yield f"{command.segment_time * 1e3:.4g}" if command.segments else "-"
    for load in (command.position, command.velocity, command.acceleration):
        yield _load(load)
    # in parentheses where it isn't judged: a time-optimal law has no limit of the jerk
    yield _load(command.jerk) if command.jerk_judged else f"({_load(command.jerk)})"
    yield _load(command.motor_velocity)
    yield _load(command.hold)
    yield bound_text(command.deviation.position / MM)
    yield bound_text(command.deviation.angle / DEG)


def _clearance(clearance: Clearance | None) -> str:
    if clearance is None:
        return "-"
    if not clearance.first:
        return f"over {clearance.distance / MM:g}"
    return (
        f"{whole_tenths(clearance.distance / MM)} {clearance.first}, {clearance.second}{when_text(clearance)}"
    )


def _load(load: Load) -> str:
    return f"{load.name} {load.share * 100:.0f}%" if load.name else "-"


_VERDICTS = {"ok": "ok", "warning": "warning", "error": "ERROR"}


def checked_table(checked: Sequence[Checked]) -> str:
    """What was looked at on a controller: what, found, wanted, and the remedy where they differ."""
    lines = []
    for verdict, one in ((_VERDICTS[one.verdict], one) for one in checked):
        lines.append(f"{verdict:<8} {one.subject}: {one.found}")
        if verdict != "ok":
            lines.append(f"         wanted: {one.wanted}")
            if one.remedy:
                lines.append(f"         help: {one.remedy}")
    return "\n".join(lines)
