"""Read the options that follow the base frame of a motion: ACC, TOL and BLEND."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

from yarclang.hir import Reading, Timing
from yarclang.semantics.motions.line import Line
from yarclang.semantics.motions.times import acceleration_share
from yarclang.semantics.values.amounts import AmountError
from yarclang.semantics.values.units import amount
from yarclang.syntax.ast import Computed, Number, Option
from yarclang.units import Kind, Unit


def limited(line: Line, timing: Timing) -> tuple[Timing, float | None, Reading | None]:
    """Read the options of a motion.

    Args:
        line: the command.
        timing: its motion time.

    Returns:
        The timing, limited by ACC if the line has it; the tolerance of TOL [m]; and the distance or angle of
        BLEND. The tolerance and the blend are None if their options are missing.
    """
    tolerance, blend = None, None
    seen: set[str] = set()
    statement = line.statement
    for option in statement.options:
        word, span = option.word.name, line.statement.span(option.word.place)
        if word in seen and word != "ALLOW":
            line.findings.add("Y0412", f"{word} is given twice", span, "remove one of them")
        seen.add(word)
        if word != "BLEND":
            refuse_at_most(line, option)
        if word == "ACC":
            timing = replace(
                timing, ramp=acceleration_share(option, line.statement, line.scope, line.findings)
            )
        elif word == "TOL":
            tolerance = _tolerance(line, option)
        elif word == "STRETCH":
            message = "STRETCH is allowed only with MOVEJ_TIMED: it stretches the times of a timetable"
            line.findings.add("Y0412", message, span, "remove it, and change the motion time")
        elif word == "ELSE" and not statement.waits_else:
            message = "ELSE is allowed only after the time of a WAIT, or in a line of its own"
            line.findings.add("Y0412", message, span, "remove it")
        elif word == "BLEND":
            blend = _blend(line, option)
    return timing, tolerance, blend


def refuse_at_most(line: Line, option: Option) -> None:
    """Add a finding if an option other than BLEND has `<=`."""
    if option.at_most:
        message = f"`<=` is allowed only with BLEND, not with {option.word.name}"
        line.findings.add("Y0412", message, line.statement.span(option.word.place), "remove the `<=`")


def _blend(line: Line, option: Option) -> Reading | None:
    """Return the number of a BLEND, interpreted as a length [m] and as an angle [rad]; None with a finding if
    it is wrong.

    Within this distance of the end of its path, the motion may leave the path for the next motion.
    """
    span = line.statement.span((option.argument or option.word).place)
    if not isinstance(option.argument, Number | Computed):
        line.findings.add("Y0412", "BLEND needs a distance or an angle", span, "for example BLEND 5")
        return None
    found = amount(option.argument, line.scope, line.statement, line.findings)
    if found is None:
        return None
    if option.at_most and found.value == 0.0:
        message = f"BLEND <={found} allows only 0"
        line.findings.add("Y0412", message, span, "write BLEND 0, or a distance above 0")
        return None
    if found.value < 0.0:
        line.findings.add("Y0412", f"BLEND {found}: the distance from the corner must be 0 or more", span)
        return None
    if found.unit is not None:
        length, angle = (
            found.value * found.unit.factor if found.unit.kind == kind else None
            for kind in ("length", "angle")
        )
        if length is None and angle is None:
            line.findings.add("Y0307", f"{found} is neither a length nor an angle", span)
        return Reading(length, angle, option.at_most)
    units = line.units or {}
    metre, radian = (units[kind].factor if kind in units else None for kind in _OF_BLENDS)
    return _reading(found.value + 0.0, metre, radian, option.at_most)


_OF_BLENDS: tuple[Kind, ...] = ("length", "angle")


@lru_cache(maxsize=64)
def _reading(value: float, length: float | None, angle: float | None, or_less: bool) -> Reading:
    """Return a number interpreted both as a length and as an angle. Equal arguments give the same object.

    Args:
        value: the number.
        length: the unit of length [m]; None without one.
        angle: the unit of angle [rad]; None without one.
        or_less: True if a smaller number is allowed.
    """
    return Reading(
        None if length is None else value * length, None if angle is None else value * angle, or_less
    )


def _tolerance(line: Line, option: Option) -> float | None:
    span = line.statement.span((option.argument or option.word).place)
    if not isinstance(option.argument, Number | Computed):
        line.findings.add("Y0412", "TOL needs a distance", span, "for example TOL 0.05")
        return None
    found = amount(option.argument, line.scope, line.statement, line.findings)
    unit = (line.units or {}).get("length")
    if found is None:
        return None
    if unit is None and found.unit is None:
        line.missing("length", span)
        return None
    try:
        metres = found.in_unit(unit) * unit.factor if unit else found.value * (found.unit or _NONE).factor
    except AmountError as error:
        line.findings.add_error(error, span)
        return None
    if metres <= 0.0:
        line.findings.add("Y0412", f"TOL {found}: the tolerance must be above 0", span)
        return None
    return metres


_NONE = Unit("", "length", 1.0)
