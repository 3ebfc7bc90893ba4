"""Read and write the file of a timed trajectory: CSV with a row for each waypoint. Values are converted to
SI when read, and written without loss.

The header is `time,J1,...,Jn`, then `J1_velocity,...` and `J1_acceleration,...` if the file has them. Columns
are identified by their names and may have any order. A column may name its unit: `J1 [rad]`, `J1_velocity
[rad/s]`, `J1_acceleration [rad/s^2]`.
"""

from __future__ import annotations

import re
from collections.abc import Hashable, Iterable, Mapping, Sequence
from itertools import accumulate

import numpy as np

from yarclang.diagnostics import Collector, Result
from yarclang.frozen import frozen
from yarclang.hir import Array, Timetable
from yarclang.robot.joint_names import numbers_by_name
from yarclang.robot.model import Robot
from yarclang.semantics.values.evaluate import LARGEST_NUMBER
from yarclang.semantics.values.poses import check_limits
from yarclang.semantics.values.units import joint_kinds
from yarclang.source import SourceFile, Span
from yarclang.subjects import Name, unknown
from yarclang.transforms import constant
from yarclang.units import UNITS, Kind, Unit, units_of

SUFFIX = ".csv"
"""Suffix of trajectory files."""

TIME = "time"

RATES = ("", "velocity", "acceleration")
"""Endings of the names of a joint's columns, by the order of the time derivative."""

STANDS = 1e-6
"""Largest speed that counts as rest [deg/s or mm/s]."""

PER_SECOND = ("", "/s", "/s^2")
"""Endings of the units of a joint's columns, in the order of `RATES`."""

_WITH_UNIT = re.compile(r"(.*?)\s*[\[(]\s*([^\])]*?)\s*[\])]")
_PER_S = re.compile(r"(.*?)\s*/\s*s(?:(?:\^|\*\*)?\s*2|²|\s*/\s*s)?", re.I)
_SQUARED = re.compile(r".*(?:2|²|/\s*s\s*/\s*s)", re.I)
_RATE = re.compile(r"(.*?)[ _](vel|velocity|acc|acceleration)", re.I)
_RATE_ENDINGS = {"vel": 1, "velocity": 1, "acc": 2, "acceleration": 2}
_NUMBERED = re.compile(r"J([1-9][0-9]?)", re.I)
_NUMBERS = re.compile(r"[0-9eE+\-.,\n \t]*")
"""Characters of numbers and separators. Of the texts with only these characters, `float` accepts only plain
decimal numbers, never `nan` or `1_0`.
"""
_MOST_COLUMNS = 1_000
_SHOWN = 40


class TrajectoryFile:
    """The text of a trajectory file, with a cache of its timetable for each robot and set of units."""

    def __init__(self, source: SourceFile) -> None:
        self.source = source
        self._read: dict[Hashable, Result[Timetable]] = {}

    def table(
        self, robot: Robot, units: Mapping[Kind, Unit], own: frozenset[Kind] = frozenset()
    ) -> Result[Timetable]:
        """Read the timetable in the file.

        Args:
            robot: the robot to whose joints the columns belong.
            units: units by kind for columns that don't name their unit; may be empty.
            own: kinds of unit (length, angle, time) for which the program's line names the unit itself; the
                file must not name other units of these kinds.

        Returns:
            The timetable in SI; None if the file has errors, with findings at their places in the file.
        """
        key = (robot, tuple(sorted(unit.name for unit in units.values())), own)
        if key not in self._read:
            findings = Collector(self.source)
            self._read[key] = Result(
                _timetable(self.source, robot, units, own, findings), tuple(findings.found)
            )
        return self._read[key]


@frozen
class _Columns:
    """The columns of a trajectory file, from its header.

    Attributes:
        time: number of the column with the time.
        places: numbers of the joints' columns: one group for the positions, then one each for velocities and
            accelerations if the file has them.
        factors: for each of these groups, (n,) factors from the file's units to SI.
        second: factor from the file's unit of time to s.
    """

    time: int
    places: tuple[tuple[int, ...], ...]
    factors: tuple[tuple[float, ...], ...]
    second: float


@frozen
class _Cell:
    """A cell of a trajectory file's header.

    Attributes:
        number: number of its column.
        name: its text without the unit.
        unit: its unit; empty without one.
        span: its place in the file.
    """

    number: int
    name: str
    unit: str
    span: Span


def write_table(robot: Robot, table: Timetable) -> str:
    """Return a timetable as the text of a trajectory file, in SI. Reading this text gives exactly the same
    numbers.

    Args:
        robot: the robot of the timetable.
        table: the timetable.
    """
    units = ["m" if kind == "length" else "rad" for kind in joint_kinds(robot)]
    header, columns = [f"{TIME} [s]"], [table.times[:, None]]
    for order, some in enumerate((table.positions, table.velocities, table.accelerations)):
        if some is None:
            continue
        ending, per = (f"_{RATES[order]}" if order else ""), PER_SECOND[order]
        header += [
            f"{name}{ending} [{unit}{per}]" for name, unit in zip(robot.joint_names, units, strict=True)
        ]
        columns.append(some)
    lines = [",".join(map(_shortest, row)) for row in np.hstack(columns).tolist()]
    return "\n".join((",".join(header), *lines, ""))


def _shortest(value: float) -> str:
    """Return the shortest text that parses to exactly this number."""
    return repr(value).removesuffix(".0")


def joint_names(robot: Robot, others: Sequence[str] = ()) -> dict[str, int]:
    """Return the numbers of a robot's joints, by their names in lower case.

    Args:
        robot: the robot.
        others: additional names for the joints, in the robot's order.
    """
    known = {name.lower(): number for number, name in enumerate(robot.joint_names)}
    return known | {name.lower(): number for number, name in enumerate(others)}


def rate_of(name: str) -> tuple[str, int]:
    """Split a column's name into the joint and the order of the time derivative: 0 for `J1`, 1 for
    `J1_velocity`, 2 for `J1_acc`.
    """
    found = _RATE.fullmatch(name)
    return (name, 0) if found is None else (found[1], _RATE_ENDINGS[found[2].lower()])


def split_unit(cell: str) -> tuple[str, str]:
    """Split a cell of a header into the name and the unit in brackets; the unit is empty if there is none."""
    found = _WITH_UNIT.fullmatch(cell)
    return (cell, "") if found is None else (found[1], found[2])


def unit_of(text: str, kind: Kind, order: int) -> Unit | None:
    """Read the unit of a column with a joint's positions, velocities or accelerations.

    Args:
        text: text in the brackets, such as `deg` or `deg/s`.
        kind: kind of the unit of the joint's position: an angle or a length.
        order: 0 for a column of positions, 1 for velocities, 2 for accelerations.

    Returns:
        The unit of the position, without `/s` or `/s^2`: `deg` for `deg/s`. None if the text isn't a unit
        that fits `kind` and `order`.
    """
    if order:
        found = _PER_S.fullmatch(text)
        if found is None or bool(_SQUARED.fullmatch(text)) != (order == 2):
            return None
        text = found[1]
    unit = UNITS.get(text.lower())
    return unit if unit is not None and unit.kind == kind else None


def _timetable(
    source: SourceFile, robot: Robot, units: Mapping[Kind, Unit], own: frozenset[Kind], findings: Collector
) -> Timetable | None:
    lines = [
        (number, line)
        for number, line in enumerate(source.lines, 1)
        if line and not line.isspace() and not line.startswith("#")
    ]
    if not lines:
        findings.add("Y1384", "the file has no data", Span.on_line(1, 1, 1), _EXAMPLE)
        return None
    columns = _columns(source, lines[0][0], robot, units, own, findings)
    if columns is None:
        return None
    width = 1 + sum(map(len, columns.places))
    numbers = [number for number, _ in lines[1:]]
    table = _table([line for _, line in lines[1:]], numbers, width, findings)
    if table is None:
        return None
    if not len(table):
        at = lines[0][0]
        findings.add(
            "Y1384",
            "the file has a header and no row",
            source.whole_line(at),
            "write a row for each waypoint",
        )
        return None
    times = table[:, columns.time] * columns.second
    if not _increase(source, times, numbers, columns, findings):
        return None
    values = [
        table[:, places] * factors for places, factors in zip(columns.places, columns.factors, strict=True)
    ]
    before = len(findings.found)
    _check_positions(source, robot, values[0], numbers, columns.places[0], findings)
    if len(values) > 1:
        _check_rest(source, robot, values[1], times, numbers, columns.places[1], findings)
    if len(times) == 1 and times[0] == 0.0:
        message = "the only row is the start, at time 0"
        findings.add(
            "Y1384", message, source.whole_line(numbers[0]), "write a row for each waypoint, at its time"
        )
    if len(findings.found) > before:
        return None
    rates = [constant(some) for some in values[1:]]
    velocities, accelerations = (rates[at] if at < len(rates) else None for at in range(2))
    return Timetable(constant(times), constant(values[0]), velocities, accelerations)


_EXAMPLE = "it begins with time,J1,J2,... and has a row for each waypoint: 0.5,10,0,..."


def _columns(
    source: SourceFile,
    line: int,
    robot: Robot,
    units: Mapping[Kind, Unit],
    own: frozenset[Kind],
    findings: Collector,
) -> _Columns | None:
    text = source.line(line)
    separators = text.count(",")
    others = {";": "semicolons", "\t": "tabs"}
    if not separators and (found := max(others, key=text.count)) in text:
        at = text.index(found) + 1
        message = f"this file has {others[found]} between cells, not commas"
        help_ = "write commas between cells and decimal points; yarc import reads other tables"
        findings.add("Y1380", message, Span.on_line(line, at, at + 1), help_)
        return None
    if separators > _MOST_COLUMNS:
        message = f"the first line has {separators + 1:,} cells, but isn't the header of a trajectory"
        findings.add("Y1380", message, Span.on_line(line, 1, 2), _EXAMPLE)
        return None
    cells = _cells(text, line)
    known = joint_names(robot)
    numbered = {name.lower(): number for name, number in numbers_by_name(robot.joint_names).items()}
    found_: dict[tuple[int, int], _Cell] = {}
    for cell in cells:
        name, order = rate_of(cell.name)
        joint = {**numbered, **known}.get(name.lower(), -1)
        if cell.name.lower() == TIME:
            joint, order = -1, 0
        elif joint < 0:
            _unknown(cell, robot, findings)
            return None
        if (joint, order) in found_:
            first = found_[joint, order].span.column
            message = f"{cell.name} is a column twice: the other begins at column {first} of the line"
            findings.add("Y1380", message, cell.span, "remove one of them")
            return None
        found_[joint, order] = cell
    orders = 1 + max(order for _, order in found_)
    wanted = [(-1, 0), *((joint, order) for order in range(orders) for joint in range(robot.size))]
    if missing := [_title(robot, *one) for one in wanted if one not in found_]:
        message = (
            f"column{'s' * (len(missing) > 1)} {', '.join(missing)} {'are' if len(missing) > 1 else 'is'} "
            "missing"
        )
        help_ = (
            f"a file has {TIME} and all joints; velocities of all joints or of none, accelerations only "
            "with velocities"
        )
        findings.add("Y1380", message, source.whole_line(line), help_)
        return None
    return _with_units(found_, orders, robot, units, own, source.whole_line(line), findings)


def _cells(text: str, line: int) -> list[_Cell]:
    """Return the cells of a header, without surrounding blanks."""
    pieces = text.split(",")
    begins = [0, *accumulate(len(piece) + 1 for piece in pieces)]
    cells = []
    for number, (piece, begin) in enumerate(zip(pieces, begins, strict=False)):
        bare = piece.strip()
        at = begin + 1 + len(piece) - len(piece.lstrip())
        name, unit = split_unit(bare)
        cells.append(_Cell(number, name, unit, Span.on_line(line, at, at + max(1, len(bare)))))
    return cells


def _title(robot: Robot, joint: int, order: int) -> str:
    if joint < 0:
        return TIME
    return robot.joint_names[joint] + (f"_{RATES[order]}" if order else "")


def _unknown(cell: _Cell, robot: Robot, findings: Collector) -> None:
    """Add a finding about a column that a trajectory can't have."""
    titles = [TIME, *(_title(robot, joint, order) for order in range(3) for joint in range(robot.size))]
    shown = f"{cell.name[:_SHOWN]!r}" if cell.name else "a column without a name"
    message = f"{shown} is no column of a trajectory of {robot.name}"
    other = f"columns are {TIME}, {', '.join(robot.joint_names)}, and these with _velocity or _acceleration"
    subject: Name | None = unknown(cell.name, titles)
    help_ = (subject.question if subject else "") or other
    numbered = _NUMBERED.fullmatch(rate_of(cell.name)[0])
    if numbered and int(numbered[1]) > robot.size:
        help_ = f"{robot.name} has {robot.size} joints: {', '.join(robot.joint_names)}"
        subject = None
    findings.add("Y1380", message, cell.span, help_, subject=subject)


def _with_units(
    found: Mapping[tuple[int, int], _Cell],
    orders: int,
    robot: Robot,
    units: Mapping[Kind, Unit],
    own: frozenset[Kind],
    header: Span,
    findings: Collector,
) -> _Columns | None:
    """Add to the columns of a trajectory file the factors of their units; None with a finding if a unit is
    wrong or missing.

    All columns of a file must use one unit of each kind.

    Args:
        found: cells of the header by joint (-1: the time) and order of the derivative.
        orders: 1 for positions only, 2 with velocities, 3 with accelerations.
        robot: the robot.
        units: units by kind for columns that don't name their unit.
        own: kinds of unit that the program's line names itself.
        header: place of the header.
        findings: receives the finding.
    """
    said: dict[Kind, tuple[Unit, _Cell]] = {}
    silent: dict[Kind, _Cell] = {}
    kinds = joint_kinds(robot)
    for (joint, order), cell in found.items():
        kind: Kind = "time" if joint < 0 else kinds[joint]
        if not cell.unit:
            silent.setdefault(kind, cell)
            continue
        unit = unit_of(cell.unit, kind, order)
        if unit is None:
            per = PER_SECOND[order]
            message = f"{cell.unit[:_SHOWN]!r} is no unit for {cell.name}"
            findings.add(
                "Y1381", message, cell.span, f"units are {', '.join(one + per for one in units_of(kind))}"
            )
            return None
        before = said.setdefault(kind, (unit, cell))
        if before[0] is not unit:
            message = f"{before[1].name} is in {before[0].name} and {cell.name} in {unit.name}"
            findings.add("Y1381", message, cell.span, f"write all {_PLURALS[kind]} in one unit")
            return None
    for kind, (unit, cell) in said.items():
        if kind in silent:
            message = f"{cell.name} has a unit, {unit.name}, and {silent[kind].name} doesn't"
            findings.add("Y1381", message, silent[kind].span, "give all columns of a kind a unit, or none")
            return None
        if kind in own and units[kind] != unit:
            message = f"{cell.name} is in {unit.name} here, but the program's line has {units[kind].name}"
            findings.add(
                "Y1381",
                message,
                cell.span,
                f"remove {units[kind].name} from the line, or convert the file",
            )
            return None
    factors: dict[Kind, float] = {kind: unit.factor for kind, (unit, _) in said.items()}
    factors.setdefault("time", 1.0)
    for kind in dict.fromkeys(kinds):
        if kind not in factors and kind not in units:
            message = f"{silent[kind].name} has no unit"
            one = units_of(kind)[-1 if kind == "angle" else 0]
            help_ = (
                f"write the unit into the header, as in `{silent[kind].name} [{one}]`, or into the "
                "program's line or its DEFAULT"
            )
            findings.add("Y1381", message, header, help_)
            return None
        factors.setdefault(kind, units[kind].factor if kind in units else 1.0)
    of_joints = tuple(factors[kind] for kind in kinds)
    places = tuple(
        tuple(found[joint, order].number for joint in range(robot.size)) for order in range(orders)
    )
    return _Columns(found[-1, 0].number, places, (of_joints,) * orders, factors["time"])


_PLURALS: Mapping[Kind, str] = {"length": "lengths", "angle": "angles", "time": "times"}


def _table(lines: list[str], numbers: list[int], width: int, findings: Collector) -> Array | None:
    """Convert the cells of a trajectory file to numbers; None with a finding at the first wrong line or cell.

    Args:
        lines: the lines after the header.
        numbers: line numbers of these lines in the file.
        width: number of columns.
        findings: receives the finding.

    Returns:
        (rows, columns).
    """
    if not lines:
        return np.empty((0, width))
    counts = np.array([line.count(",") for line in lines])
    if (counts != width - 1).any():
        row = int(np.argmax(counts != width - 1))
        count = int(counts[row]) + 1
        message = f"this line has {count:,} cell{'s' * (count != 1)}, but the header has {width}"
        help_ = "give every row a cell for each column"
        if ";" in lines[row]:
            help_ = "write commas between the cells"
        findings.add("Y1382", message, Span.on_line(numbers[row], 1, len(lines[row]) + 1), help_)
        return None
    body = "\n".join(lines)
    fit = _NUMBERS.match(body)
    assert fit is not None  # the pattern matches an empty text, too
    if fit.end() == len(body):
        try:
            table = np.array(list(map(float, body.replace("\n", ",").split(",")))).reshape(-1, width)
        except ValueError:
            fit = None
    else:
        row = body.count("\n", 0, fit.end())
        column = body.count(",", body.rfind("\n", 0, fit.end()) + 1, fit.end())
        _refuse_cell(lines[row], numbers[row], column, findings)
        return None
    if fit is None:
        row, column = _first_bad(lines)
        _refuse_cell(lines[row], numbers[row], column, findings)
        return None
    large = ~(np.abs(table) <= LARGEST_NUMBER)
    if large.any():
        row, column = np.argwhere(large)[0].tolist()
        _refuse_cell(lines[row], numbers[row], column, findings)
        return None
    return table


def _first_bad(lines: Iterable[str]) -> tuple[int, int]:
    """Return the row and the column of the first cell that isn't a number."""
    for row, line in enumerate(lines):
        for column, cell in enumerate(line.split(",")):
            try:
                float(cell)
            except ValueError:
                return row, column
    raise AssertionError("all cells are numbers")


def _refuse_cell(line: str, number: int, column: int, findings: Collector) -> None:
    """Add a finding about a cell whose text isn't a valid number."""
    span = _cell_span(line, number, column)
    text = line.split(",")[column].strip()
    help_ = (
        f"write a finite number of at most {LARGEST_NUMBER:,.0f}, with a decimal point; its unit goes into "
        "the header"
    )
    if not text:
        message = "this cell is empty"
    elif text.lower().lstrip("+-") in {"nan", "inf", "infinity"}:
        message = f"{text} is too large for a joint position"
    elif _is_number(text):
        message = f"{text[:_SHOWN]} is beyond the largest value, {LARGEST_NUMBER:,.0f}"
    else:
        message = f"{text[:_SHOWN]!r} is not a number"
    findings.add("Y1382", message, span, help_)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return _NUMBERS.fullmatch(text) is not None


def _cell_span(line: str, number: int, column: int) -> Span:
    """Return the place of a cell, without surrounding blanks."""
    pieces = line.split(",")
    begin = sum(len(piece) + 1 for piece in pieces[:column])
    piece = pieces[column]
    at = begin + 1 + (len(piece) - len(piece.lstrip()) if piece.strip() else 0)
    return Span.on_line(number, at, at + max(1, len(piece.strip())))


def _increase(
    source: SourceFile, times: Array, numbers: list[int], columns: _Columns, findings: Collector
) -> bool:
    """Check that the first time is 0 or more, and that the times increase from row to row."""
    if times[0] < 0.0:
        span = _cell_span(source.line(numbers[0]), numbers[0], columns.time)
        message = f"the first time is {times[0]:.9g} s, before the motion begins at 0"
        findings.add("Y1383", message, span, "write times from the start of the motion")
        return False
    late = np.diff(times) <= 0.0
    if not late.any():
        return True
    row = int(np.argmax(late)) + 1
    more = int(np.count_nonzero(late)) - 1
    span = _cell_span(source.line(numbers[row]), numbers[row], columns.time)
    message = (
        f"the time {times[row]:.9g} s isn't later than the one before, {times[row - 1]:.9g} s in line "
        f"{numbers[row - 1]}"
    )
    if more:
        message += f" (and {more:,} more row{'s' * (more > 1)})"
    findings.add("Y1383", message, span, "times increase from row to row; leave out rows that repeat one")
    return False


def _check_positions(
    source: SourceFile,
    robot: Robot,
    q: Array,
    numbers: list[int],
    places: tuple[int, ...],
    findings: Collector,
) -> None:
    """Add a finding for the first row that takes a joint out of its limits."""
    excess = np.maximum(robot.limits.lower - q, q - robot.limits.upper) / robot.axis_units
    out = np.flatnonzero(excess.max(axis=1) > _OUT)
    if not len(out):
        return
    row = int(out[0])
    span = _cell_span(source.line(numbers[row]), numbers[row], places[int(np.argmax(excess[row]))])
    check_limits(robot, q[row], findings, span)


_OUT = 1e-9
"""Allowed excess of a position over its limits [deg or mm], for rounding."""


def _check_rest(
    source: SourceFile,
    robot: Robot,
    velocities: Array,
    times: Array,
    numbers: list[int],
    places: tuple[int, ...],
    findings: Collector,
) -> None:
    """Check that all joints are at rest at time 0 and in the last row, and set their velocities there to 0.

    Args:
        source: the file.
        robot: the robot.
        velocities: (k, n) in SI; receives the zeros.
        times: (k,) [s].
        numbers: line number of each row.
        places: numbers of the columns with the velocities.
        findings: receives a finding for each row with a moving joint.
    """
    ends = {0: "at time 0"} if times[0] == 0.0 else {}
    for row, when in {**ends, len(times) - 1: "in the last row"}.items():
        speeds = velocities[row] / robot.axis_units
        joint = int(np.argmax(np.abs(speeds)))
        if abs(speeds[joint]) <= STANDS:
            velocities[row] = 0.0
            continue
        message = (
            f"{robot.joint_names[joint]} moves at {speeds[joint]:.6g} {robot.axis_unit_names[joint]}/s "
            f"{when}: it must be at rest there"
        )
        span = _cell_span(source.line(numbers[row]), numbers[row], places[joint])
        findings.add(
            "Y1383",
            message,
            span,
            "write 0 there, or add rows until the robot is at rest",
        )
