"""Read motion times, in square brackets."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

from yarclang.diagnostics import Collector
from yarclang.hir import Reading, Timing
from yarclang.semantics.context import Defaults
from yarclang.semantics.names.scope import Scope
from yarclang.semantics.values.amounts import AmountError, missing_unit
from yarclang.semantics.values.evaluate import EvaluationError, evaluate
from yarclang.semantics.values.units import amount, number_fault
from yarclang.source import Span
from yarclang.subjects import LeftOut
from yarclang.syntax.ast import (
    Computed,
    ComputedPercent,
    Number,
    Option,
    Other,
    Percent,
    Statement,
    Time,
    Word,
)
from yarclang.units import Kind, Unit

_HELP = "a motion time is [20], [MIN], [50%] or, for the speed of the moving frame, [V 250] or [V<=250]"


def time_is_sound(statement: Statement, time: Time, findings: Collector) -> bool:
    """Return True if a motion time is well-formed, whatever its unit is; otherwise add a finding."""
    span = statement.span(time.place)
    text = " ".join(item.text for item in time.items)
    if len(time.items) == 1:
        match time.items[0]:
            case Word(name="MIN") | Computed() | ComputedPercent():
                return True
            case Percent(value=value):
                return _share_is_sound(value, text, span_of=statement, time=time, findings=findings)
            case Number() as number:
                if (fault := number_fault(number)) is not None:
                    findings.add(fault[0], fault[1], span)
                    return False
                if number.value <= 0:
                    message = f"a motion can't take {number.text}: the time must be positive"
                    findings.add("Y0407", message, span, _HELP)
                    return False
                return True
    match time.items:
        case (Word(name="V"), Computed()):
            return True
        case (Word(name="V"), Other(text="<="), Computed()):
            return True
        case (Word(name="V"), Number() as number) | (Word(name="V"), Other(text="<="), Number() as number):
            if (fault := number_fault(number)) is not None:
                findings.add(fault[0], fault[1], span)
                return False
            return _speed_is_sound(number.value, number.text, span, findings)
        case (Word(name="V"), Word() as name) | (Word(name="V"), Other(text="<="), Word() as name):
            help_ = f"write [{text.replace(name.text, f'${name.text}')}] for the number {name.name} of a LET"
            findings.add("Y0407", f"[{text}] is no motion time", span, help_)
            return False
    findings.add("Y0407", f"[{text}] is no motion time", span, _HELP)
    return False


def _share_is_sound(value: float, text: str, *, span_of: Statement, time: Time, findings: Collector) -> bool:
    if 0.0 < value <= 100.0:
        return True
    message = f"[{text}]: the share of the limits must be above 0 and at most 100 %"
    findings.add("Y0407", message, span_of.span(time.place), _HELP)
    return False


def _speed_is_sound(value: float, text: str, span: Span, findings: Collector) -> bool:
    if value > 0.0:
        return True
    findings.add("Y0407", f"a motion can't go at {text}: the speed must be positive", span, _HELP)
    return False


def resolve_time(
    statement: Statement,
    units: Mapping[Kind, Unit],
    defaults: Defaults,
    scope: Scope,
    findings: Collector,
    has_speed: bool,
) -> Timing:
    """Return the timing of a command. [20] sets the duration [s], [50%] sets the share of the limits that the
    motion may use, and [MIN] sets neither.

    A time from DEFAULT has the unit that DEFAULT names. If DEFAULT names no unit, the units of the line apply
    to this time.

    Args:
        statement: the command.
        units: units of the line and of DEFAULT.
        defaults: the values of the DEFAULT line of its file.
        scope: the names in scope at this line.
        findings: receives the findings.
        has_speed: True if the command moves a frame: a speed is then allowed instead of a time.
    """
    time = statement.time or defaults.time
    if time is None:
        if not defaults.has_bad_time:
            help_ = "write [20] for 20 time units, [MIN] for the shortest, or give one in DEFAULT"
            subject = LeftOut("the motion time")
            findings.add("Y0406", "the motion time is missing", statement.head_span, help_, subject=subject)
        return Timing(None)
    own = time is statement.time
    if own and not time_is_sound(statement, time, findings):
        return Timing(None)
    line = statement if own else (defaults.statement or statement)
    where = scope if own else defaults.scope
    match time.items[0]:
        case Word(name="V") if len(time.items) == 3:
            chosen = units if own or statement.units is None else {**units, **defaults.units}
            return _below(
                _speed(time, line, statement, own, chosen, where, findings), statement, time, own, findings
            )
        case Word(name="V"):
            if not has_speed:
                said = "the motion time is a speed" if own else "DEFAULT's motion time is a speed"
                message = f"{said}, which is allowed only with Cartesian motions such as MOVEL and DMOVE"
                span = statement.span(time.place) if own else statement.head_span
                findings.add("Y0407", message, span, "write [20], [MIN], [50%] or [V<=250]")
                return Timing(None)
            chosen = units if own or statement.units is None else {**units, **defaults.units}
            return _at(_speed(time, line, statement, own, chosen, where, findings))
        case Percent(value=value):
            return Timing(None, share=value / 100.0)
        case ComputedPercent() as item:
            share = _percentage(item, line, where, findings)
            if share is None or not _share_is_sound(
                share, item.text, span_of=line, time=time, findings=findings
            ):
                return Timing(None)
            return Timing(None, share=share / 100.0)
        case Number() | Computed() as item:
            return Timing(_seconds(item, line, statement, own, units, defaults, where, findings))
    return Timing(None)


@lru_cache(maxsize=64)
def _at(speed: Reading | None) -> Timing:
    """Return the timing of a motion at a given speed; equal speeds share one object."""
    return Timing(None, speed=speed)


def _below(speed: Reading | None, statement: Statement, time: Time, own: bool, findings: Collector) -> Timing:
    """Return the timing of a command that limits its speed, as [V<=250] does.

    Args:
        speed: the limit; None if it is wrong.
        statement: the command.
        time: its motion time, or that of DEFAULT.
        own: True if the time is written in the command.
        findings: receives the finding if the unit of length is missing.
    """
    if speed is not None and speed.length is None:
        span = statement.span(time.place) if own else statement.head_span
        findings.add_error(missing_unit("length", "the speed"), span)
    return Timing(None, ceiling=None if speed is None else speed.length)


def _speed(
    time: Time,
    line: Statement,
    statement: Statement,
    own: bool,
    units: Mapping[Kind, Unit],
    scope: Scope,
    findings: Collector,
) -> Reading | None:
    """Return a speed, interpreted both in m/s and in rad/s; None with a finding if it is wrong.

    Args:
        time: the motion time with the speed.
        line: the line that has the time: the command or DEFAULT.
        statement: the command.
        own: True if the time is written in the command.
        units: units by kind.
        scope: the names that are known in `line`.
        findings: receives the finding.
    """
    item = time.items[-1]
    span = statement.span(item.place) if own else statement.head_span
    if isinstance(item, Number):  # nearly always
        value = item.value
    else:
        if not isinstance(item, Computed) or (found := amount(item, scope, line, findings)) is None:
            return None
        try:
            value = found.plain("a speed")
        except AmountError as error:
            findings.add_error(error, span)
            return None
    if not _speed_is_sound(value, f"{value:.10g}", span, findings):
        return None
    if (second := units.get("time")) is None:
        findings.add_error(missing_unit("time", "the speed"), span)
        return None
    length, angle = units.get("length"), units.get("angle")
    return Reading(
        value * length.factor / second.factor if length else None,
        value * angle.factor / second.factor if angle else None,
    )


def _seconds(
    item: Number | Computed,
    line: Statement,
    statement: Statement,
    own: bool,
    units: Mapping[Kind, Unit],
    defaults: Defaults,
    scope: Scope,
    findings: Collector,
) -> float | None:
    """Return a motion time [s]; None with a finding if it is wrong.

    Args:
        item: the number.
        line: the line that has the time: the command or DEFAULT.
        statement: the command.
        own: True if the time is written in the command.
        units: units of the command and of DEFAULT.
        defaults: the values of the DEFAULT line.
        scope: the names that are known in `line`.
        findings: receives the finding.
    """
    found = amount(item, scope, line, findings)
    if found is None:
        return None
    unit = defaults.units.get("time") if not own and "time" in defaults.units else units.get("time")
    span = statement.span(item.place) if own else statement.head_span
    if found.unit is None and unit is None:
        findings.add_error(missing_unit("time", "the motion time"), span)
        return None
    try:
        value = (
            found.in_unit(unit) * unit.factor
            if unit
            else found.value * (found.unit.factor if found.unit else 1.0)
        )
        if unit is None and found.unit is not None and found.unit.kind != "time":
            raise AmountError("Y0307", f"{found} isn't a time")
    except AmountError as error:
        findings.add_error(error, span)
        return None
    if value <= 0.0:
        findings.add("Y0407", f"a motion can't take {found}: the time must be positive", span, _HELP)
        return None
    return value


def _percentage(
    item: Percent | ComputedPercent, statement: Statement, scope: Scope, findings: Collector
) -> float | None:
    if isinstance(item, Percent):
        return item.value
    try:
        return evaluate(item.expression, scope).plain("a percentage")
    except EvaluationError as error:
        findings.add_error(error, statement.span(error.place))
    except AmountError as error:
        findings.add_error(error, statement.span(item.place))
    return None


def acceleration_share(option: Option, statement: Statement, scope: Scope, findings: Collector) -> float:
    """Return the share that an option such as ACC 30% gives (0.3): the part of the acceleration and jerk
    limits that a motion may use.
    """
    span = statement.span((option.argument or option.word).place)
    if isinstance(option.argument, Percent | ComputedPercent):
        share = _percentage(option.argument, statement, scope, findings)
        if share is None:
            return 1.0
        if 0.0 < share <= 100.0:
            return share / 100.0
        findings.add(
            "Y0412", f"ACC {share:g}%: the share of the limits must be above 0 and at most 100 %", span
        )
        return 1.0
    findings.add("Y0412", "ACC needs a percentage", span, "for example ACC 30%")
    return 1.0
