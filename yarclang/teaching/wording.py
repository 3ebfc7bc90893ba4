"""Check of the texts that users type into fields of a command, so that a text can't change the meaning of the
rest of the line.
"""

from __future__ import annotations

import re
import unicodedata

from yarclang.runtime.actions import Trouble
from yarclang.teaching.fields import FieldKind

_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*(?:\.[A-Za-z_][A-Za-z0-9_]*)?")
_COMPUTED = re.compile(r"\$(?:[A-Za-z_][A-Za-z0-9_.]*|\([A-Za-z0-9_.+\-*/%<>=(), \[\]]*\))")
_EXPRESSION = re.compile(r"[A-Za-z0-9_.+\-*/%<>=(), \[\]]+")
_UNITS = re.compile(r"[A-Za-z]+(?:\s*,\s*[A-Za-z]+){0,2}")
_ARGUMENT = re.compile(rf"(?:{_NUMBER.pattern})\s*\([A-Za-z]+\)|\{{\s*(?:{_NAME.pattern})\s*\}}")
_LONGEST = 1000


def checked(name: str, kind: FieldKind, text: str) -> str:
    """Check a typed text, and return it in the form in which it is inserted into a line; empty if the user
    has left the field empty.

    Args:
        name: name of the field.
        kind: kind of the field.
        text: the typed text.

    Raises:
        Trouble: the text isn't allowed in this field.
    """
    text = text.strip()
    if len(text) > _LONGEST:
        raise Trouble(
            f"{name} has {len(text)} characters; at most {_LONGEST} are read", "shorten it", "field"
        )
    if not text:
        return ""
    if any(unicodedata.category(one) in ("Cc", "Cf", "Zl", "Zp", "Cs") for one in text):
        raise Trouble(f"{name} has an invisible character or a line break", "type it anew", "field")
    if name == "comment":
        return text.lstrip("! ")
    if name == "text":
        if '"' in text:
            raise Trouble("a text can't contain a quotation mark", "leave it out", "field")
        return text
    patterns = _patterns(name, kind)
    text = text.strip("{} ") if kind == "frame" else text.rstrip("% ") if kind == "percent" else text
    if not any(pattern.fullmatch(text) for pattern in patterns):
        raise Trouble(f"{name} can't be {text[:60]!r}", _help(kind), "field")
    return text


def _patterns(name: str, kind: FieldKind) -> tuple[re.Pattern[str], ...]:
    if name == "units":
        return (_UNITS,)
    if name in ("condition", "value") and kind == "text":
        return (_EXPRESSION,)
    if kind in ("frame", "joints", "pose", "signal"):
        return (_NAME,)
    if kind == "text":
        return (_NUMBER, _NAME, _COMPUTED, _ARGUMENT)
    if kind == "choice":
        return (_NUMBER, _NAME, _COMPUTED)
    if name == "time":
        return (_NUMBER, _COMPUTED, re.compile("min", re.IGNORECASE))
    return (_NUMBER, _COMPUTED)


def _help(kind: FieldKind) -> str:
    if kind in ("frame", "joints", "pose", "signal"):
        return "choose a name: letters, digits and _"
    if kind == "text":
        return "write a number, a name, or $(an expression)"
    return "write a number with a point, a name after $, or $(an expression)"
