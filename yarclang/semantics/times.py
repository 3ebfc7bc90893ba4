"""Motion times: what stands in square brackets."""

from __future__ import annotations

from collections.abc import Mapping

from yarclang.diagnostics import Collector
from yarclang.hir import Timing
from yarclang.semantics.context import Defaults
from yarclang.semantics.units import missing_unit, number_fault
from yarclang.syntax.ast import Number, Statement, Time, Word
from yarclang.units import Kind, Unit

_HELP = "a motion time is [20] or [MIN]"


def time_is_sound(statement: Statement, time: Time, findings: Collector) -> bool:
    """Whether a motion time is one, whatever its unit; a finding says why it isn't."""
    span = statement.span(time.place)
    text = " ".join(item.text for item in time.items)
    if _is_shortest(time):
        return True
    if len(time.items) == 1 and isinstance(number := time.items[0], Number):
        if number_fault(number) is not None:
            findings.add("Y0403", f"{number.text} is beyond the largest value", span)
        elif number.value <= 0:
            findings.add(
                "Y0407", f"a motion can't take {number.text}: the time has to be positive", span, _HELP
            )
        else:
            return True
    elif time.items and (text.endswith("%") or text.upper().startswith("V ") or text.startswith("$")):
        findings.add("Y0207", f"the motion time [{text}] is not carried out by this version", span, _HELP)
    else:
        findings.add("Y0407", f"[{text}] is no motion time", span, _HELP)
    return False


def resolve_time(
    statement: Statement, units: Mapping[Kind, Unit], defaults: Defaults, findings: Collector
) -> Timing:
    """The motion time of a command in s; [MIN] is None.

    A time from DEFAULT has DEFAULT's unit, whatever the line's units are; only where DEFAULT names none, the line's.
    """
    time = statement.time or defaults.time
    if time is None:
        if not defaults.has_bad_time:
            help_ = "write [20] for 20 time units, [MIN] for the shortest, or give one in DEFAULT"
            findings.add("Y0406", "the motion time is missing", statement.head_span, help_)
        return Timing(None)
    if time is statement.time and not time_is_sound(statement, time, findings):
        return Timing(None)
    number = time.items[0]
    if _is_shortest(time) or not isinstance(number, Number):
        return Timing(None)
    if time is defaults.time and "time" in defaults.units:
        unit: Unit | None = defaults.units["time"]
    else:
        unit = units.get("time")
    if unit is None:
        span = statement.span(time.place) if time is statement.time else statement.head_span
        message, help_ = missing_unit("time", "the motion time")
        findings.add("Y0304", message, span, help_)
        return Timing(None)
    return Timing(number.value * unit.factor)


def _is_shortest(time: Time) -> bool:
    return len(time.items) == 1 and isinstance(word := time.items[0], Word) and word.name == "MIN"
