"""Read KEEP: a rule that all motions of a block satisfy along their whole paths."""

from __future__ import annotations

from typing import get_args

import numpy as np

from yarclang.cell.keeping import LEAST_SIGHT, LEAST_TILT, MOST_TILT, Keep, KeepKind, region_of
from yarclang.diagnostics import Collector
from yarclang.semantics.context import Defaults
from yarclang.semantics.files import values_of
from yarclang.semantics.names.frames import known_frame, moving_frame
from yarclang.semantics.names.scope import Frame, Scope
from yarclang.semantics.parts import refuse_parts
from yarclang.semantics.values.amounts import AmountError, missing_unit
from yarclang.semantics.values.units import amount, number_fault, resolve_units
from yarclang.subjects import Name, unknown
from yarclang.syntax.ast import Statement, Value, Word
from yarclang.units import DEG, MM, Kind
from yarclang.words.registry import word_specs

_KINDS: tuple[KeepKind, ...] = get_args(KeepKind)
_RANGE: tuple[tuple[Kind, str], ...] = (("length", "the least distance"), ("length", "the largest distance"))
_VALUES: dict[KeepKind, tuple[tuple[Kind, str], ...]] = {
    "UPRIGHT": (("angle", "the angle"),),
    "ABOVE": (("length", "the distance"),),
    "FACING": (("angle", "the angle"), *_RANGE),
    "SEEN": (("angle", "the angle"), *_RANGE),
}
"""The kind and the description of each value of a KEEP rule. Only the first value of a rule is required."""
_REFUSED = ("a motion time", "options")


def keep_of(head: Statement, scope: Scope, defaults: Defaults, findings: Collector) -> Keep | None:
    """Read a line such as KEEP {CUP} UPRIGHT 10 (deg) {TABLE}.

    Args:
        head: the line.
        scope: the names in scope at this line.
        defaults: the values of the DEFAULT line of its file.
        findings: receives the findings.

    Returns:
        None with a finding if the line is wrong.
    """
    before = len(findings.found)
    refuse_parts(head, _REFUSED, findings)
    spec = word_specs()["KEEP"]
    help_ = f"for example {spec.example}"
    carried: Frame | None = None
    if head.moving is None:
        message = "KEEP has no moving frame"
        findings.add("Y0302", message, head.head_span, help_)
    else:
        carried = moving_frame(head, head.moving, scope, findings)
    standing = _standing(head, scope, findings)
    values = values_of(head)
    kind = _kind(head, values, findings)
    limits = None if kind is None else _limits(head, kind, values[1:], scope, defaults, findings)
    if any(one.is_error for one in findings.found[before:]):
        return None
    if kind is None or limits is None or carried is None or standing is None or head.moving is None:
        return None
    of = "B" if head.base is None else head.base.name
    region = region_of(kind, carried.transform, standing.transform, *limits)
    return Keep(kind, head.moving.name, of, region, carried.link, standing.link)


def _standing(head: Statement, scope: Scope, findings: Collector) -> Frame | None:
    """Return the fixed frame to which a KEEP rule refers: the frame in its line, or else {B}. None with a
    finding if the frame is wrong.
    """
    if head.base is None:
        return scope.frame("B")
    found = known_frame(head, head.base, scope, findings)
    if found is not None and found.on_flange:
        message = (
            f"{head.base.text} moves with the robot: the reference frame of KEEP must be fixed in the cell"
        )
        findings.add("Y0303", message, head.span(head.base.place), "write {B}", subject=Name(head.base.name))
        return None
    return found


def _kind(head: Statement, values: list[Value], findings: Collector) -> KeepKind | None:
    spec = word_specs()["KEEP"]
    help_ = f"for example {spec.example}"
    if len(values) < 2 or not isinstance(values[0], Word) or len(head.waypoints) > 1:
        findings.add("Y0401", f"KEEP needs {spec.wants}", head.whole_span, help_)
        return None
    word = values[0]
    for kind in _KINDS:
        if word.name == kind:
            return kind
    subject = unknown(word.text, _KINDS)
    findings.add(
        "Y0480",
        f"{word.text} is no rule of KEEP",
        head.span(word.place),
        f"{subject.question} the rules are {', '.join(_KINDS[:-1])} or {_KINDS[-1]}".lstrip(),
        subject=subject,
    )
    return None


def _limits(
    head: Statement,
    kind: KeepKind,
    values: list[Value],
    scope: Scope,
    defaults: Defaults,
    findings: Collector,
) -> tuple[float, ...] | None:
    """Return the limit of a KEEP rule [rad or m], followed by its range of distances [m] if the line has one;
    None with a finding if a value is wrong.
    """
    wanted = _VALUES[kind]
    if len(values) > len(wanted):
        *names, last = (name for _, name in wanted)
        names_ = f"{', '.join(names)} and {last}" if names else last
        message = (
            f"{kind} takes {f'{len(wanted)} values at most, {names_}' if names else names_}, but "
            f"{len(values)} are given"
        )
        span = head.span(values[len(wanted)].place)
        findings.add("Y0401", message, span, f"for example {word_specs()['KEEP'].example}")
        return None
    limits = [
        _value(head, one, each, scope, defaults, findings) for one, each in zip(values, wanted, strict=False)
    ]
    found = [one for one in limits if one is not None]
    if len(found) < len(limits):
        return None
    angle = found[0]
    if kind != "ABOVE" and not LEAST_TILT <= angle <= MOST_TILT:
        message = (
            f"{kind} takes an angle from {LEAST_TILT / DEG:g} to {MOST_TILT / DEG:g} deg, and this is "
            f"{angle / DEG:.6g}"
        )
        help_ = "no motion is exact to 0 deg: write 1 (deg)"
        if angle > MOST_TILT:
            help_ = "180 deg would forbid nothing: write a smaller angle, or remove the KEEP"
        findings.add("Y0480", message, head.span(values[0].place), help_)
        return None
    near, far = (*found[1:], *(LEAST_SIGHT, np.inf)[len(found) - 1 :])[:2]
    if not near >= LEAST_SIGHT:
        message = (
            f"{kind} takes a least distance of {LEAST_SIGHT / MM:g} mm or more, and this is {near / MM:.6g} "
            "mm"
        )
        help_ = "at the apex of the cone no direction is defined: write a larger distance, or none"
        findings.add("Y0482", message, head.span(values[1].place), help_)
        return None
    if not far >= near + LEAST_SIGHT:
        message = (
            f"{kind} keeps a distance from {near / MM:.6g} to {far / MM:.6g} mm: no motion could be proved "
            "to do so"
        )
        help_ = (
            f"write the smaller distance first; the larger one must be at least {LEAST_SIGHT / MM:g} mm more"
        )
        findings.add("Y0482", message, head.span(values[2].place), help_)
        return None
    return tuple(found)


def _value(
    head: Statement,
    value: Value,
    wanted: tuple[Kind, str],
    scope: Scope,
    defaults: Defaults,
    findings: Collector,
) -> float | None:
    """Return a value of a KEEP rule [rad or m]; None with a finding if it has an error."""
    span = head.span(value.place)
    if (fault := number_fault(value)) is not None:
        findings.add(*fault[:2], span, fault[2])
        return None
    units = resolve_units(head, head.units, findings)
    found = amount(value, scope, head, findings)
    if units is None or found is None:
        return None
    kind, name = wanted
    # If the line names units, the units of DEFAULT don't apply to it. An angle written as 10 (mm) thus lacks
    # its unit.
    unit = units.get(kind) or found.unit or (None if units else defaults.units.get(kind))
    try:
        if unit is None:
            raise missing_unit(kind, f"{name} of KEEP")
        if unit.kind != kind:
            raise AmountError(
                "Y0307", f"{found} is of the wrong kind: {name} of KEEP is a{'n' * (kind == 'angle')} {kind}"
            )
        return found.in_unit(unit) * unit.factor
    except AmountError as error:
        findings.add_error(error, span)
        return None
