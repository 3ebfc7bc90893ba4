"""Read numbers in attributes of URDFs."""

from __future__ import annotations

import re

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)


def numbers(text: str) -> tuple[float, ...]:
    """Return the numbers at the beginning of a text, which blanks separate, up to the first word that isn't a
    number.
    """
    values = []
    for part in text.split():
        if not _NUMBER.fullmatch(part):
            break
        values.append(float(part))
    return tuple(values)
