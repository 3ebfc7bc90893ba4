"""Write numbers and texts in a form that both YAML and JSON read."""

from __future__ import annotations

import json
from collections.abc import Iterable


def number(value: float) -> str:
    """Return the shortest text that reads back as an equal float64.

    YAML 1.1 needs a decimal point before an exponent.
    """
    text = repr(float(value))
    mantissa, e, exponent = text.partition("e")
    return f"{mantissa}.0e{exponent}" if e and "." not in mantissa else text


def row(values: Iterable[float]) -> str:
    """Return numbers as the text of a YAML or JSON list."""
    return f"[{', '.join(map(number, values))}]"


def text(value: str) -> str:
    """Return a text in quotes, in ASCII. Without quotes, YAML wouldn't read `yes` or `1` as texts."""
    return json.dumps(value)


def texts(values: Iterable[str]) -> str:
    """Return texts as the text of a YAML or JSON list."""
    return f"[{', '.join(map(text, values))}]"
