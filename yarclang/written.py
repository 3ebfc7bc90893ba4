"""Texts of values such as speeds in the form in which a program writes them, and fixes that replace them."""

from __future__ import annotations

import math
import re

from yarclang.diagnostics import Edit, Fix
from yarclang.hir import Origin, TimedMove


def slower(share: float, origin: Origin) -> tuple[str, Fix | None]:
    """Return a reduced speed as text, and a fix that writes the speed into the program.

    Args:
        share: share of the speed in the line, above 0.
        origin: the command.

    Returns:
        A text such as `[V 20]`, and its fix. If the line has no speed that is a plain number: a text such as
        `50 % of this speed`, and None.
    """
    if (written := written_speed(origin)) is None or origin.time_span is None:
        return f"{share * 100:.3g} % of this speed", None
    value = written * share
    digits = 2 - math.floor(math.log10(value))
    text = f"[V {math.floor(value * 10.0**digits) / 10.0**digits:.10g}]"
    return text, Fix(f"write {text}", (Edit(origin.time_span, text),))


def stretch_fix(motion: TimedMove, stretch: float) -> Fix | None:
    """Return a fix that replaces the STRETCH of a line; None if its value is computed."""
    origin, text = motion.origin, f"{stretch:.10g}"
    if origin.stretch_span is not None:
        edit = Edit(origin.stretch_span, text)
    elif origin.end_span is not None and motion.stretch == 1.0:
        edit = Edit(origin.end_span, f" STRETCH {text}")
    else:
        return None
    return Fix(f"write STRETCH {text}", (edit,))


def written_speed(origin: Origin) -> float | None:
    """Return the speed that a line gives as a plain number; None if there is none."""
    span = origin.time_span
    if span is None:
        return None
    text = origin.source.line(span.line)[span.column - 1 : span.end_column - 1]
    found = re.fullmatch(r"\[\s*V\s+([0-9.eE+-]+)\s*\]", text, re.IGNORECASE)
    return float(found[1]) if found else None
