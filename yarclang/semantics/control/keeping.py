"""KEEP: read the rule that all motions of a block keep on their whole path."""

from __future__ import annotations

from dataclasses import replace
from typing import get_args

from yarclang.cell.keeping import LEAST_TILT, MOST_TILT, Keep, KeepKind, keep
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
from yarclang.units import DEG, Kind
from yarclang.words.registry import word_specs

_KINDS: tuple[KeepKind, ...] = get_args(KeepKind)
_UNITS: dict[KeepKind, Kind] = {"UPRIGHT": "angle", "ABOVE": "length"}
_REFUSED = ("a motion time", "options")


def keep_of(head: Statement, scope: Scope, defaults: Defaults, findings: Collector) -> Keep | None:
    """Read a line such as KEEP {CUP} UPRIGHT 10 (deg) {TABLE}.

    Args:
        head: the line.
        scope: the names that are known there.
        defaults: gives units to a line without them.
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
        message = "KEEP doesn't say which frame of the robot it keeps"
        findings.add("Y0302", message, head.head_span, help_)
    else:
        carried = moving_frame(head, head.moving, scope, findings)
    standing = _standing(head, scope, findings)
    values = values_of(head)
    kind = _kind(head, values, findings)
    limit = None if kind is None else _limit(head, kind, values, scope, defaults, findings)
    if any(one.is_error for one in findings.found[before:]):
        return None
    if kind is None or limit is None or carried is None or standing is None or head.moving is None:
        return None
    of = "B" if head.base is None else head.base.name
    made = keep(kind, (head.moving.name, of), carried.transform, standing.transform, limit)
    link, among = standing.link, [of]
    while link is not None:
        among.append(link.name)
        link = link.parent
    return replace(made, among=tuple(among))


def _standing(head: Statement, scope: Scope, findings: Collector) -> Frame | None:
    """Return the fixed frame of the rule, which is {B} if the line names none; None with a finding."""
    if head.base is None:
        return scope.frame("B")
    found = known_frame(head, head.base, scope, findings)
    if found is not None and found.on_flange:
        message = f"{head.base.text} moves with the robot: what a frame is kept to stands still"
        findings.add("Y0303", message, head.span(head.base.place), "write {B}", subject=Name(head.base.name))
        return None
    return found


def _kind(head: Statement, values: list[Value], findings: Collector) -> KeepKind | None:
    spec = word_specs()["KEEP"]
    help_ = f"for example {spec.example}"
    if len(values) != 2 or not isinstance(values[0], Word):
        findings.add("Y0401", f"KEEP wants {spec.wants}", head.whole_span, help_)
        return None
    word = values[0]
    for kind in _KINDS:
        if word.name == kind:
            return kind
    subject = unknown(word.text, _KINDS)
    findings.add(
        "Y0480",
        f"KEEP doesn't know {word.text}",
        head.span(word.place),
        f"{subject.question} it takes {' or '.join(_KINDS)}".lstrip(),
        subject=subject,
    )
    return None


def _limit(
    head: Statement,
    kind: KeepKind,
    values: list[Value],
    scope: Scope,
    defaults: Defaults,
    findings: Collector,
) -> float | None:
    """Return the limit of a rule [rad or m]; None with a finding."""
    value, span = values[1], head.span(values[1].place)
    if (fault := number_fault(value)) is not None:
        findings.add(*fault[:2], span, fault[2])
        return None
    units = resolve_units(head, head.units, findings)
    found = amount(value, scope, head, findings)
    if units is None or found is None:
        return None
    wanted = _UNITS[kind]
    # if the line has units, those of DEFAULT don't apply: 10 (mm) is no angle
    unit = units.get(wanted) or found.unit or (None if units else defaults.units.get(wanted))
    try:
        if unit is None:
            raise missing_unit(
                wanted, "the angle of UPRIGHT" if kind == "UPRIGHT" else "the distance of ABOVE"
            )
        if unit.kind != wanted:
            raise AmountError(
                "Y0307", f"{found} is of the wrong kind: {kind} takes a{'n' * (wanted == 'angle')} {wanted}"
            )
        limit = found.in_unit(unit) * unit.factor
    except AmountError as error:
        findings.add_error(error, span)
        return None
    if kind == "UPRIGHT" and not LEAST_TILT <= limit <= MOST_TILT:
        message = f"UPRIGHT takes an angle from {LEAST_TILT / DEG:g} to {MOST_TILT / DEG:g} deg, and this is {limit / DEG:.6g}"
        findings.add("Y0480", message, span, "0 would be a motion without any deviation: write 1 (deg)")
        return None
    return limit
