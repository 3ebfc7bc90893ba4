"""Checks of the answers that `yarc check` gives to the mistakes of the table."""

from __future__ import annotations

from pathlib import Path

from mistakes.table import Mistake

from yarclang.pipeline.checking import check_text
from yarclang.pipeline.fixing import fixed, is_repair
from yarclang.pipeline.inputs import Options
from yarclang.source import SourceFile

_OPTIONS = Options(robot="INDUSTRIAL6")


def checked(text: str):
    """Return the result of checking a program."""
    return check_text(SourceFile("mistake.yarc", text), Path(__file__).parent, _OPTIONS)


def faults_of(mistake: Mistake) -> list[str]:
    """Return the faults of the answer to a mistake.

    A good answer is a single finding in the right place, with the required words and the right repair, if one
    is likely.
    """
    looked = checked(mistake.text)
    found = [one for one in looked.diagnostics if one.severity != "note"]
    if not found and not mistake.is_taken:
        found = list(looked.diagnostics)
    told = "; ".join(f"{one.code} {one.message} ({one.help})" for one in found)
    if mistake.is_taken:
        return [f"isn't taken: {told}"] if found else []
    faults = [] if len(found) == 1 else [f"{len(found)} findings: {told}"]
    if not found:
        return faults
    first = found[0]
    span = first.span
    where = None if span is None else (span.line, span.column, span.end_line, span.end_column)
    if where != mistake.place:
        faults.append(f"stands at {where}, not at {mistake.place}")
    said = f"{first.message} {first.help} {first.fix.title if first.fix else ''}".lower()
    faults += [
        f"doesn't say {' or '.join(words)}: {told}"
        for words in mistake.says
        if not any(word.lower() in said for word in words)
    ]
    repaired = fixed(looked, lambda source: checked(source.text), is_repair).text
    if mistake.repaired is None:
        if repaired != mistake.text:
            faults.append(f"becomes {repaired!r}, though more than one repair is likely")
    elif repaired != mistake.repaired:
        faults.append(f"becomes {repaired!r}" if repaired != mistake.text else f"has no fix: {told}")
    return faults
