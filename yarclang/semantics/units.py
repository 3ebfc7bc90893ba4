"""Units of a statement, and numbers in them."""

from __future__ import annotations

from collections.abc import Mapping

from yarclang.diagnostics import Collector, suggest
from yarclang.syntax.ast import Number, Other, Percent, Statement, Text, Units, Word
from yarclang.units import UNITS, Kind, Unit, units_of

LARGEST_NUMBER = 1e9


def resolve_units(
    statement: Statement, units: Units | None, findings: Collector
) -> Mapping[Kind, Unit] | None:
    """The units that a statement names, by kind.

    Returns:
        None where one of them isn't a unit or a kind stands twice.
    """
    found: dict[Kind, Unit] = {}
    if units is None:
        return found
    if not units.items:
        findings.add(
            "Y0305", "no unit stands between the brackets", statement.span(units.place), "write (mm,deg,s)"
        )
        return None
    for item in units.items:
        unit, span = UNITS.get(item.text.lower()), statement.span(item.place)
        if unit is None:
            help_ = suggest(item.text, UNITS) or f"units are {', '.join(UNITS)}"
            findings.add("Y0305", f"`{item.text}` is no unit", span, help_)
            return None
        if unit.kind in found:
            message = f"{found[unit.kind].name} and {unit.name} are both units of {unit.kind}"
            findings.add("Y0306", message, span, "leave one of them")
            return None
        found[unit.kind] = unit
    return found


def missing_unit(kind: Kind, what: str) -> tuple[str, str]:
    """The message and the help for a unit that a line needs and doesn't have."""
    names = " or ".join(units_of(kind)[:2])
    return (
        f"{what} need{'' if what.endswith('s') else 's'} a unit of {kind}",
        f"write one ({names}) in the line's units, or in DEFAULT",
    )


def number_fault(item: Number | Word | Percent | Text | Other) -> tuple[str, str, str] | None:
    """Why an item isn't a number to compute with: code, message, help; None if it is one."""
    if isinstance(item, Number):
        if abs(item.value) <= LARGEST_NUMBER:
            return None
        return "Y0403", f"{item.text} is beyond the largest value, {LARGEST_NUMBER:,.0f}", ""
    text = item.text if len(item.text) <= 40 else item.text[:40] + "…"
    if item.text.startswith("$"):
        return "Y0207", f"`{text}`: expressions are not carried out by this version", "write the number"
    help_ = "numbers look like 30, -0.5, 1e-3; blanks stand between them"
    if "," in item.text:
        help_ = "the decimal sign is a point; blanks stand between numbers"
    return "Y0402", f"`{text}` is not a number", help_
