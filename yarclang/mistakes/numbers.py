"""Recognise numbers with units, commas or letters in them, and lists of numbers as in other languages."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise

from yarclang.mistakes.line import Guess, Line, is_number, is_thousand
from yarclang.units import UNITS

_TOKEN = re.compile(r"[^\s;{}\[\]()\"]+")
_WITH_UNIT = re.compile(r"(?P<number>[-+]?[0-9.]+)(?P<unit>[A-Za-z]+)")
_COMMA = re.compile(r"(?P<whole>[-+]?[0-9]+),(?P<part>[0-9]+)")
_LETTERS = re.compile(r"[-+]?[0-9OoIl]*[0-9][0-9OoIl.]*|[-+]?[OoIl]+[0-9.]+")
_MARKED = re.compile(r"[-+]?[0-9]{1,3}(?:['_][0-9]{3})+(?:\.[0-9]+)?")
_BLANK = re.compile(r"(?<=\s)-\s+(?=[0-9.])")
_PLUS = re.compile(r"(?<=\s)\+\s+(?P<number>[0-9.]+)")
_SUM = re.compile(
    r"[A-Za-z_][A-Za-z0-9_]*(?:\s*[-+*/]\s*(?:[A-Za-z_][A-Za-z0-9_]*|[0-9.]+))+|[0-9.]+"
    r"(?:[*/+][A-Za-z0-9_.]+)+"
)
_BRACED = re.compile(r"\$\{\s*(?P<name>[A-Za-z_][A-Za-z0-9_]*)\s*\}")
_NAMED = re.compile(
    r"(?P<name>[XYZABCUVWxyzabcuvw]|[Jj][1-9]|[RrPpYy][XYZxyz]?)\s*[=:]?\s*(?P<value>[-+]?[0-9][0-9.]*)"
)
_LIST = re.compile(
    r"(?P<open>[(\[{]\s*)?(?P<list>[-+]?[0-9.]+(?:\s*[,;]\s*[-+]?[0-9.]+){2,})(?P<close>\s*[)\]}])?"
    r"(?P<end>;)?"
)
_ORDERS = frozenset(
    (*"XYZ", *turns) for turns in ((), tuple("ABC"), tuple("RPY"), ("RX", "RY", "RZ"), tuple("UVW"))
)
_SEVERAL = 3
"""Smallest number of values with names of axes, as in X10 Y20 Z30, that counts as a list of values."""
_WAYS = re.compile(r"[0-9.]\s+[-+]?[0-9.]")


def value_list(line: Line) -> Guess | None:
    """Recognise a list of values with commas, semicolons, brackets or names of axes."""
    if not line.is_motion:
        return None
    begin = line.behind + len(line.values) - len(line.values.lstrip())
    rest = line.bare[begin:]
    found = _LIST.match(rest)
    if found is None:
        return _named(line, begin, rest)
    values = re.split(r"\s*[,;]\s*", found["list"])
    decimals = [one for one in re.split(r"\s+", found["list"]) if _COMMA.fullmatch(one)]
    if any(mark in found["list"] for mark in ",") and _are_decimals(found["list"], len(decimals)):
        return None
    gaps = {any(sign.isspace() for sign in gap) for gap in re.findall(r"\s*[,;]\s*", found["list"])}
    if len(gaps) > 1:
        help_ = "write blanks between the values, and a decimal point"
        return line.guess(
            begin, begin + found.end(), "the commas may separate values, or be decimal commas", None, help_
        )
    marks = "commas" if "," in found["list"] else "semicolons"
    put = " ".join(values)
    if begin == line.behind and line.behind > line.begin:
        put, begin_mark = f" {put}", begin
    else:
        begin_mark = begin
    end = begin + found.end()
    what = f"the values are separated by {marks}" + (" and brackets around them" if found["open"] else "")
    return line.guess(begin_mark, end, what, put, f"write blanks between the values: {' '.join(values)}")


def _are_decimals(text: str, count: int) -> bool:
    """Return True if the commas in a list of numbers are decimal signs: the numbers are separated by blanks.

    Args:
        text: the list.
        count: how many numbers of the list have a comma.
    """
    return count > 0 and text.count(",") == count and len(text.split()) > count - 1 and len(text.split()) > 1


def _named(line: Line, begin: int, rest: str) -> Guess | None:
    found = list(_NAMED.finditer(rest))
    if len(found) < _SEVERAL or found[0].start() != 0:
        return None
    gaps = [rest[one.end() : other.start()] for one, other in pairwise(found)]
    if any(gap.strip(" ,;") for gap in gaps):
        return None
    end = begin + found[-1].end()
    if end < len(line.bare) and not line.bare[end].isspace():
        return None
    names = [one["name"].upper() for one in found]
    put = " ".join(one["value"] for one in found)
    message = f"values are written without the names of their axes ({' '.join(names)})"
    if not _in_order(names):
        help_ = (
            "write the values alone, in the order of the command: X Y Z roll pitch yaw, or one for each joint"
        )
        return line.guess(begin, end, message, None, help_)
    turned = [one["value"] for one in found[3:] if one["name"].upper() in "ABC"]
    if any(float(value) != 0.0 for value in turned):
        help_ = (
            "write X Y Z roll pitch yaw: angles about x, y, z of the base; A of KRL is about z, B about y "
            "and C about x"
        )
        return line.guess(begin, end, message, None, help_)
    return line.guess(begin, end, message, put, f"write blanks between the values: {put}")


def _in_order(names: list[str]) -> bool:
    """Return True if axes are in the order in which a command expects their values."""
    if names[0].startswith("J"):
        return names == [f"J{number}" for number in range(1, len(names) + 1)]
    return tuple(names) in _ORDERS


def decimal_commas(line: Line) -> Guess | None:
    """Recognise decimal commas in one number, or in several numbers that are separated by blanks."""
    if not (line.is_command or line.is_declaration):
        return None
    tokens = [one for one in _tokens(line) if _COMMA.fullmatch(one[1])]
    if not tokens:
        return None
    at, text = tokens[0]
    if any(is_thousand(one) for _, one in tokens):
        at, text = next(token for token in tokens if is_thousand(token[1]))
        help_ = f"write {text.replace(',', '')}, or {text.replace(',', '.')}"
        return line.guess(
            at, at + len(text), f"`{text}` is not a number: digits are written without commas", None, help_
        )
    repaired = line.text
    for at, text in reversed(tokens):
        repaired = repaired[:at] + text.replace(",", ".") + repaired[at + len(text) :]
    at, text = tokens[0]
    if len(tokens) == 1:
        put = text.replace(",", ".")
        return Guess(
            at,
            at + len(text),
            f"`{text}` is not a number: write a decimal point",
            f"write {put}",
            repaired,
        )
    begin, end = _values_around(line, tokens)
    points = repaired[begin:end]
    return Guess(
        begin,
        end,
        f"{len(tokens)} numbers have a comma: write a decimal point",
        f"write {points}",
        repaired,
    )


def _values_around(line: Line, tokens: list[tuple[int, str]]) -> tuple[int, int]:
    """Return the start of the first number in a line and the end of the last one, including `tokens`.

    Args:
        line: the line.
        tokens: numbers with decimal commas, each with its place.
    """
    every = [(at, text) for at, text in _tokens(line) if is_number(text.replace(",", "."))]
    return min(every[0][0], tokens[0][0]), max(
        every[-1][0] + len(every[-1][1]), tokens[-1][0] + len(tokens[-1][1])
    )


def number(line: Line) -> Guess | None:
    """Recognise a number with a unit, a letter, a mark or a blank in it."""
    if not (line.is_command or line.is_declaration):
        return None
    if found := _BRACED.search(line.bare):
        return line.guess(
            found.start(), found.end(),
            f"the name of a number is written without braces: {{{found['name']}}} is a frame",
            f"${found['name']}"
        )  # fmt: skip
    if line.is_motion and (found := _BLANK.search(line.bare)):
        end = found.end() + len(_TOKEN.match(line.bare[found.end() :])[0])  # type: ignore[index]  # a digit follows
        put = f"-{line.bare[found.end() : end]}"
        return line.guess(found.start(), end, "the minus sign is separated from its number", put)
    if line.is_motion and (found := _PLUS.search(line.bare, line.behind)):
        number_ = found["number"]
        help_ = f"write {number_} for one value, or $(...) around a sum"
        return line.guess(
            found.start(), found.end(), "the plus sign is separated from its number", None, help_
        )
    for at, text in _tokens(line):
        if is_number(text):
            continue
        if guess := _one(line, at, text):
            return guess
    return None


def _one(line: Line, at: int, text: str) -> Guess | None:
    end = at + len(text)
    if _MARKED.fullmatch(text):
        put = re.sub("['_]", "", text)
        return line.guess(at, end, f"`{text}` is not a number: digits are written without separators", put)
    if (
        (found := _WITH_UNIT.fullmatch(text))
        and found["unit"].lower() in UNITS
        and is_number(found["number"])
    ):
        return _with_unit(line, at, text, found)
    if _LETTERS.fullmatch(text) and not is_number(text) and line.is_motion:
        put = text.translate(str.maketrans("OoIl", "0011"))
        if is_number(put):
            return line.guess(at, end, f"`{text}` is not a number: it has a letter in place of a digit", put)
    if line.is_motion and (found := re.fullmatch(r"(?P<signs>[-+]{2,})(?P<value>[0-9.]+)", text)):
        help_ = f"write {found['value']} or -{found['value']}: a number can have only one sign"
        return line.guess(at, end, f"`{text}` is not a number", None, help_)
    if line.is_motion and re.fullmatch(r"[-+]?[0-9]+(?:\.[0-9]+){2,}", text):
        first, _, rest = text.partition(".")
        help_ = (
            f"a number can have only one decimal point: write {first}.{rest.replace('.', '')}, or two "
            "numbers with a blank between them"
        )
        return line.guess(at, end, f"`{text}` is not a number", None, help_)
    if line.is_motion and text.upper() == "PI":
        return line.guess(
            at,
            end,
            "`pi` is not a number: write `$` before a name",
            None,
            _half_turn(line.units.get("angle")),
        )
    if line.is_motion and _SUM.fullmatch(text) and _knows(line, text):
        put = f"$({text})"
        return line.guess(at, end, f"`{text}` is not a number: a sum must be in $()", put)
    if line.is_motion and text.upper() in line.around.numbers:
        return line.guess(at, end, f"`{text}` is not a number", f"${text}", f"write ${text} for its value")
    return None


def _half_turn(unit: str | None) -> str:
    """Return the help for a rotation that was meant as half a turn."""
    if unit == "rad":
        return "write $PI"
    return f"write 180 for half a turn: the line's angles are in {unit or 'deg'}; the number is $PI"


def _knows(line: Line, text: str) -> bool:
    """Return True if all names of a sum are declared numbers."""
    known = line.around.numbers | {"PI"}
    names = re.findall(r"[A-Za-z_][A-Za-z0-9_]*", text)
    return bool(names) and all(name.upper() in known for name in names)


def _with_unit(line: Line, at: int, text: str, found: re.Match[str]) -> Guess | None:
    unit, value, end = found["unit"].lower(), found["number"], at + len(text)
    kind = UNITS[unit].kind
    here = line.units.get(kind)
    if line.bare[:at].rstrip().upper().endswith("BLEND"):
        if here == unit:
            return line.guess(
                at,
                end,
                f"`{text}` is no length of a BLEND: units are written in brackets after the command",
                value,
                f"write BLEND {value}; the line already has the unit {unit}",
            )
        return None
    message = f"`{text}` is not a number: units are written in brackets, one for all values of their kind"
    if here == unit:
        return line.guess(
            at,
            end,
            message,
            value,
            f"write {value}; the line already has the unit {unit}, as in ({_units(line)})",
        )
    if here is None:
        return line.guess(at, end, message, None, f"write {value}, and ({unit}) after the motion time")
    return line.guess(
        at,
        end,
        message,
        None,
        f"write {value} in {here}, or ({unit}) after the motion time instead of {here}",
    )


def _units(line: Line) -> str:
    return ",".join(line.units.values())


def _tokens(line: Line) -> Iterator[tuple[int, str]]:
    """Yield the texts between blanks after the line's first word, with their places. Texts in brackets are
    left out.
    """
    depth = 0
    for match in re.finditer(r"[\[({]|[\])}]|[^\s;\[\](){}\"]+", line.bare[line.behind :]):
        if match[0] in "[({":
            depth += 1
        elif match[0] in "])}":
            depth = max(0, depth - 1)
        elif depth == 0:
            yield line.behind + match.start(), match[0]
