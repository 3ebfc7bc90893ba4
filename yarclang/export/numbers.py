"""Numbers and texts as YAML and JSON both read them."""

from __future__ import annotations

import json
from collections.abc import Iterable


def number(value: float) -> str:
    """Return the shortest text that reads back as the same float64. YAML 1.1 takes an exponent only after a decimal point."""
    text = repr(float(value))
    mantissa, e, exponent = text.partition("e")
    return f"{mantissa}.0e{exponent}" if e and "." not in mantissa else text


def row(values: Iterable[float]) -> str:
    """Return numbers as a list."""
    return f"[{', '.join(map(number, values))}]"


def text(value: str) -> str:
    """Return a text in quotes, in ASCII: in YAML, a joint called `yes` or `1` would be something else."""
    return json.dumps(value)


def texts(values: Iterable[str]) -> str:
    """Return texts as a list."""
    return f"[{', '.join(map(text, values))}]"
