"""Show a certificate as a table: one row for each command or, for a long program, for each line of the
source.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from yarclang.certify.certificate import IDLE, Certificate, Clearance, CommandCertificate, Load, bound_text
from yarclang.certify.outward import percent
from yarclang.cli.columns import (
    LEAST_PLACE,
    LONGEST_PLACE,
    SHORTEST_PLACE,
    Column,
    cut,
    numbers_of,
    renamed,
    whole_width,
)
from yarclang.cli.screen import wrapped
from yarclang.diagnostics import static_place
from yarclang.report.distances import when_text, whole_tenths
from yarclang.report.nearest import Nearest, nearest_places, source_command
from yarclang.units import DEG, MM

if TYPE_CHECKING:
    from yarclang.cell.model import Cell
    from yarclang.robot.model import Robot
    from yarclang.runtime.inspection import Checked

SHORT = 10
"""Largest number of commands for which a table has one row for each command."""

MANY = 40
"""If a chain has more than this number of blended motions, a table shows the whole chain as one row."""

_CLEAR = "clear mm"
"""Heading of the column with the smallest proved distance between two bodies, and the names of these bodies.
The column exists only for programs in a cell with obstacles.
"""
_ZONES = "zones mm"
"""Heading of the column with the smallest proved distance from the border of a zone, the names of the body
and the zone, and the time. The column exists only for programs in a cell with zones.
"""
_NAMES = "names"
_LEAST_WANTED = (
    "hold",
    "TM ms",
    "path deg",
    "jerk",
    "motor",
    "position",
    "path mm",
    _NAMES,
    "accel.",
    _ZONES,
    _CLEAR,
    "torque",
)
"""Columns in the order in which they are left out on a narrow terminal. `_NAMES` stands for the names of
bodies in the columns of distances.
"""

_COLUMN_OF = {
    "clearance": _CLEAR,
    "zone border": _ZONES,
    "speed": "velocity",
    "acceleration": "accel.",
    "motor speed": "motor",
}
"""Headings of the columns whose heading isn't the name of the measured quantity, by the name of the
quantity.
"""

_LOADED = "*"
"""Mark of a motion during which the robot carries a part."""


def certificate_table(
    certificate: Certificate,
    *,
    full: bool = True,
    width: int | None = None,
    robot: Robot | None = None,
    cell: Cell | None = None,
) -> str:
    """Format a certificate as a table.

    Columns are the duration, the joint with the largest share of each limit and this share, the proved
    deviation, and in a cell the clearance and the distance from zones. A motion during which the robot
    carries a part is marked.

    Args:
        certificate: certificate to show.
        full: True for one row for each command, with all columns. If False, a program of more than `SHORT`
            commands gets one row for each line of its source, with the longest time and the worst value of
            each column over all executions of the line; a chain of more than `MANY` motions gets one row.
        width: width of the terminal in characters; None for no limit. Unless `full`, a table that is too wide
            has numbers instead of long joint names, and then fewer columns.
        robot: robot with the names of the joints and the limits. The column with the value nearest to its
            limit is kept as long as possible. None to prefer no column.
        cell: cell with the margins of obstacles and zones.
    """
    groups = [[command] for command in certificate.commands]
    is_folded = not full and len(groups) > SHORT
    if is_folded:
        groups = _folded(certificate.commands)
    columns = _columns(certificate, groups, is_folded=is_folded and len(groups) < len(certificate.commands))
    left_out: list[str] = []
    numbers: dict[str, str] = {}
    if width is not None and not full:
        if robot is not None and whole_width(columns) > width:
            numbers = numbers_of(robot.joint_names)
            columns = [renamed(column, numbers) for column in columns]
        nearest = () if robot is None else nearest_places(certificate, robot, cell)
        worst = next((_COLUMN_OF.get(one.what, one.what) for one in nearest if one.is_judged), "")
        columns, left_out = _fitted(columns, width, worst)
    lines = ["  ".join(cells).rstrip() for cells in zip(*(column.lines() for column in columns), strict=True)]
    lines[1] = "-" * max(len(line) for index, line in enumerate(lines) if index != 1)
    if any(command.carries for command in certificate.commands):
        lines += wrapped(f"{_LOADED} marks commands during which the robot carries a part.", width)
    for told in _not_checked(certificate):
        lines += wrapped(told, width)
    shown = " ".join(cell for column in columns for cell in column.cells)
    if used := [f"{number}\xa0{name}" for name, number in numbers.items() if f"{number} " in shown]:
        lines += wrapped(", ".join(used) + ".", width)
    said = []
    if len(groups) < len(certificate.commands):
        of, times = f"{len(groups)} lines of the source", f"{len(certificate.commands):,} times"
        if any(map(_is_chain, groups)):
            of = f"{of}, or chains of more than {MANY}"
        said.append(f"{of}, executed {times}: the longest time and the worst value of each column.")
    if left_out:
        said.append(f"No room for {', '.join(left_out)}.")
    if said:
        said.append("--full shows all.")
        lines += wrapped(" ".join(said), width)
    return "\n".join(lines)


def _folded(commands: Sequence[CommandCertificate]) -> list[list[CommandCertificate]]:
    """Group the commands of a certificate into the rows of its table: each long chain of motions becomes one
    row, and all other commands one row for each line of the source.
    """
    rows: dict[tuple[str, int, str], list[CommandCertificate]] = {}
    found: list[list[CommandCertificate]] = []
    for chain in _chains(commands):
        if len(chain) > MANY:
            found.append(chain)
            continue
        for command in chain:
            row = rows.get(key := source_command(command))
            if row is None:
                row = rows[key] = []
                found.append(row)
            row.append(command)
    return found


def _chains(commands: Sequence[CommandCertificate]) -> Iterator[list[CommandCertificate]]:
    """Yield groups of commands that are joined by blends."""
    chain: list[CommandCertificate] = []
    for command in commands:
        chain.append(command)
        if command.blended is None:
            yield chain
            chain = []
    if chain:
        yield chain


def _is_chain(group: Sequence[CommandCertificate]) -> bool:
    """Return True for the row of a long chain: its commands are on different lines."""
    return len(group) > MANY and source_command(group[0]) != source_command(group[1])


def nearest_table(certificate: Certificate, robot: Robot, cell: Cell | None, width: int | None = None) -> str:
    """Return a table of the commands nearest to a limit, nearest first; empty for a program of at most
    `SHORT` commands.

    Args:
        certificate: certificate to show.
        robot: robot with the limits.
        cell: cell with the margins of obstacles and zones.
        width: width of the terminal in characters; None for no limit.
    """
    if len(certificate.commands) <= SHORT:
        return ""
    places = nearest_places(certificate, robot, cell)
    columns = (
        Column("share", tuple(_share(one) for one in places)),
        Column("nearest to a limit", tuple(one.what for one in places), "left"),
        Column("figure", tuple(one.figure for one in places), "left"),
        Column("at", tuple(_full_place(one.command) for one in places), "left"),
    )
    whole = sum(column.width for column in columns) + 2 * (len(columns) - 1)
    if width is None or whole <= width:
        rows = ["  ".join(cells).rstrip() for cells in zip(*(one.lines() for one in columns), strict=True)]
        rows[1] = "-" * max(len(row) for index, row in enumerate(rows) if index != 1)
        return "\n".join(rows)
    lines = [*wrapped("share  nearest to a limit, and its command", width), "-" * min(width, 47)]
    for share, what, figure, place in zip(*(one.cells for one in columns), strict=True):
        lines += wrapped(f"{share:>5}  {what}: {figure}", width, 7)
        lines += wrapped(f"{' ' * 7}at {place}", width, 10)
    return "\n".join(lines)


def _share(one: Nearest) -> str:
    return "-" if one.share is None else f"{percent(one.share)}%"


def _full_place(command: CommandCertificate) -> str:
    """Return place and name of a command. For a command in a module, this is the program's line that calls
    the module, followed by the module's own line.
    """
    if not command.module:
        return f"{command.index or f'line {command.source_line}'} {command.name}"
    return f"{command.index.partition('>')[0]}, {command.module} line {command.source_line}: {command.name}"


def _columns(
    certificate: Certificate, groups: Sequence[Sequence[CommandCertificate]], *, is_folded: bool
) -> list[Column]:
    """Return the columns of a table, with a row for each group of commands."""

    def loads(name: str, key: str) -> Column:
        worst = [
            max((getattr(one, key) or IDLE for one in group), key=lambda load: load.share) for group in groups
        ]
        return Column(name, tuple(map(_load, worst)))

    def column(name: str, cells: list[str]) -> Column:
        return Column(name, tuple(cells))

    columns = [
        Column("command", tuple(map(_place, groups)), "left"),
        Column("", tuple(map(_name, groups)), "left"),
    ]
    if is_folded:
        columns.append(column("times", [f"{len(group):,}" for group in groups]))
    columns += [
        column("time s", [f"{_time(group):.3f}" for group in groups]),
        column("TM ms", [_segment(group) for group in groups]),
        loads("position", "position"),
        loads("velocity", "velocity"),
        loads("accel.", "acceleration"),
        column("jerk", [_jerk(group) for group in groups]),
        loads("motor", "motor_velocity"),
        loads("hold", "hold"),
        column("path mm", [bound_text(max(one.deviation.position for one in group), MM) for group in groups]),
        column("path deg", [bound_text(max(one.deviation.angle for one in group), DEG) for group in groups]),
    ]  # fmt: skip
    if any(command.torque for command in certificate.commands):
        columns.append(loads("torque", "torque"))
    if any(command.clearance for command in certificate.commands):
        columns.append(column(_CLEAR, [_least([one.clearance for one in group]) for group in groups]))
    if any(command.zone_clearance for command in certificate.commands):
        columns.append(column(_ZONES, [_least([one.zone_clearance for one in group]) for group in groups]))
    return columns


def _time(group: Sequence[CommandCertificate]) -> float:
    """Return the duration in a row [s]: the total of a chain, or the longest execution of a line."""
    times = [one.duration for one in group]
    return sum(times) if _is_chain(group) else max(times)


def _name(group: Sequence[CommandCertificate]) -> str:
    """Return the name of the command in a row of the table, with a mark if the robot carries a part during
    any execution of this command.
    """
    return f"{group[0].name} {_LOADED}" if any(one.carries for one in group) else group[0].name


def _place(group: Sequence[CommandCertificate]) -> str:
    """Return the place for a row of the table.

    A single command has its own place. A chain has the indices of its first and last command. Several
    executions of one line have their common place, without the passes of loops, or else the number of the
    line.
    """
    first = group[0]
    if _is_chain(group):
        begin, end = (one.index.partition(">")[0] or f"line {one.source_line}" for one in (first, group[-1]))
        return f"{begin} to {end}"
    line = f"{first.module} line {first.source_line}".strip()
    if len(group) == 1:
        return first.index or line
    places = {static_place(one.index) for one in group}
    place = places.pop() if len(places) == 1 else ""
    return place if place and not first.module else line


MANY_PAIRS = 10
"""Largest number of lines about pairs of bodies that may touch. Of further lines only the number is given."""


def _not_checked(certificate: Certificate) -> Iterator[str]:
    """Yield a line of text for each pair of bodies that may touch, with the commands concerned and the line
    that allows the contact.
    """
    found: dict[tuple[str, str, str], list[str]] = {}
    for command in certificate.commands:
        for one in command.may_touch:
            given = f"{command.module} {one.giver}" if command.module else one.giver
            names = found.setdefault((one.first, one.second, given), [])
            names.append(command.index or command.name)
    for first, second, giver in [*found][:MANY_PAIRS]:
        names = found[first, second, giver]
        places = ", ".join(dict.fromkeys(names[:4])) + (
            f" and {len(names) - 4} more" if len(names) > 4 else ""
        )
        yield f"Not checked: {first} and {second} on {places}, allowed by {giver}."
    if len(found) > MANY_PAIRS:
        yield (
            f"Not checked: {len(found) - MANY_PAIRS} more pairs of bodies that may touch "
            "(--certificate FILE lists them)."
        )


def _fitted(columns: list[Column], width: int, worst: str) -> tuple[list[Column], list[str]]:
    """Choose the columns of a table that fit on a terminal.

    Args:
        columns: all columns; the first one has the places of the commands.
        width: width of the terminal in characters.
        worst: name of the column that is kept as long as there is room for any; empty for none.

    Returns:
        The columns, with shortened places if necessary, and the names of the columns that are left out.
    """
    place, *others = columns
    longest = min(place.width, LONGEST_PLACE)
    left_out: list[str] = []

    def room() -> int:
        return width - sum(column.width + 2 for column in others)

    order = [name for name in _LEAST_WANTED if name != worst]
    if worst:
        order += [name for name in ("velocity", worst) if name not in order]
    for name in order:
        if name == worst and room() >= LEAST_PLACE:
            break
        if room() >= min(longest, SHORTEST_PLACE):
            break
        if name == _NAMES:
            others = [_without_names(column) for column in others]
        elif any(column.name == name for column in others):
            others = [column for column in others if column.name != name]
            left_out.append(name)
    most = max(min(longest, room()), LEAST_PLACE)
    return [Column(place.name, tuple(cut(cell, most) for cell in place.cells), "left"), *others], left_out


def _without_names(column: Column) -> Column:
    """Return a column of distances without the names of bodies; any other column unchanged."""
    if column.name not in (_CLEAR, _ZONES):
        return column
    cells = (cell if cell.startswith("over") else cell.partition(" ")[0] for cell in column.cells)
    return Column(column.name, tuple(cells), column.side)


def _segment(group: Sequence[CommandCertificate]) -> str:
    """Return the longest segment time of the commands in a row of the table; `-` if none has segments."""
    times = [one.segment_time for one in group if one.segments]
    return f"{max(times) * 1e3:.4g}" if times else "-"


def _jerk(group: Sequence[CommandCertificate]) -> str:
    """Return the largest jerk of the commands in a row of the table. It is in parentheses if it isn't
    checked, since a time-optimal motion has no jerk limit.
    """
    worst = max(group, key=lambda one: one.jerk.share)
    return _load(worst.jerk) if worst.jerk_judged else f"({_load(worst.jerk)})"


def _least(found: Sequence[Clearance | None]) -> str:
    """Return the smallest of several proved distances."""
    told = [one for one in found if one is not None]
    return _clearance(min(told, key=lambda one: one.distance) if told else None, with_time=len(found) == 1)


def _clearance(clearance: Clearance | None, *, with_time: bool) -> str:
    if clearance is None:
        return "-"
    if not clearance.first:
        return f"over {clearance.distance / MM:g}"
    when = when_text(clearance) if with_time else ""
    return f"{whole_tenths(clearance.distance)} {clearance.first}, {clearance.second}{when}"


def _load(load: Load) -> str:
    return f"{load.name} {percent(load.share)}%" if load.name else "-"


_VERDICTS = {"ok": "ok", "warning": "warning", "error": "ERROR"}


def checked_table(checked: Sequence[Checked]) -> str:
    """Return the checks of a controller as a table: item, actual value, expected value, and the remedy if the
    two values differ.
    """
    lines = []
    for verdict, one in ((_VERDICTS[one.verdict], one) for one in checked):
        lines.append(f"{verdict:<8} {one.subject}: {one.found}")
        if verdict != "ok":
            lines.append(f"         wanted: {one.wanted}")
            if one.remedy:
                lines.append(f"         help: {one.remedy}")
    return "\n".join(lines)
