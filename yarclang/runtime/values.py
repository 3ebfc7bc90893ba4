"""Checks of a message with values for registers from other programs, before any of its values is put into a
register. No I/O.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from yarclang.runtime.actions import Trouble
from yarclang.runtime.notices import Wanted

NOT_WANTED, OUT_OF_RANGE, NOT_UNDERSTOOD = "Y1661", "Y1662", "Y1663"
"""Codes of the reasons to refuse a message. `NOT_WANTED`: its values come before or after they are wanted, or
a second time. `OUT_OF_RANGE`: a value is out of its register's range. `NOT_UNDERSTOOD`: an entry isn't a
register's value, or a needed register is missing.
"""

_SHOWN = 60
"""Largest number of characters of a faulty value that a message shows."""


def values_text(values: tuple[tuple[str, int], ...]) -> str:
    """Return values for people: `X = 12, Y = 5`."""
    return ", ".join(f"{name} = {value}" for name, value in values)


def range_text(wanted: Wanted) -> str:
    """Return the registers that may be filled and their ranges: `X 0..500, Y 0..300`."""
    return ", ".join(f"{name} {low}..{high}" for name, low, high in wanted.registers)


def checked_values(
    wanted: Wanted | None, number: int | None, values: Mapping[str, Any]
) -> tuple[tuple[str, int], ...]:
    """Check a message with values for registers, and return its values by their registers, in the order of
    the message.

    Args:
        wanted: values that the program accepts; None: none.
        number: number of the question that is answered; None: the current one.
        values: values by the names of registers, as they were sent.

    Raises:
        Trouble: the message is refused as a whole.
    """
    if wanted is None:
        raise Trouble(
            "no WAIT or HOLD of the program accepts values now: they came too early, too late or twice",
            "answer each event values_wanted exactly once",
            NOT_WANTED,
        )
    if number is not None and number != wanted.number:
        raise Trouble(
            f"question {number} isn't open any more: {wanted.place} asks question {wanted.number}",
            f"answer question {wanted.number} with new values",
            NOT_WANTED,
        )
    ranges = {name: (low, high) for name, low, high in wanted.registers}
    accepted = {}
    for written_name, value in values.items():
        name = written_name.upper()
        if name not in ranges or name in accepted:
            what = "stands twice" if name in accepted else "isn't filled from outside"
            raise Trouble(
                f"{_one_line(written_name)} {what}",
                f"{wanted.place} takes {range_text(wanted)}",
                NOT_UNDERSTOOD,
            )
        accepted[name] = _integer(name, value, *ranges[name])
    if missing := [name for name in wanted.needed if name not in accepted]:
        raise Trouble(
            f"{', '.join(missing)} {'is' if len(missing) == 1 else 'are'} missing",
            f"{wanted.place} waits for {', '.join(wanted.needed)}: send all of them in one message",
            NOT_UNDERSTOOD,
        )
    if not accepted:
        raise Trouble(
            "the message contains no values", f"{wanted.place} takes {range_text(wanted)}", NOT_UNDERSTOOD
        )
    return tuple(accepted.items())


def _integer(name: str, value: Any, low: int, high: int) -> int:
    is_nan = isinstance(value, float) and math.isnan(value)
    is_number = isinstance(value, int | float) and not isinstance(value, bool) and not is_nan
    if is_number and low <= value <= high and value == int(value):
        return int(value)
    is_far = is_number and not low <= value <= high
    raise Trouble(
        f"{name} can't be {_one_line(value)}: it is an integer from {low} to {high}",
        "check the sender",
        OUT_OF_RANGE if is_far else NOT_UNDERSTOOD,
    )


def _one_line(value: object) -> str:
    """Return a faulty value as one short line of ASCII."""
    try:
        text = ascii(value)
    except (ValueError, RecursionError):  # an integer of thousands of digits, or deeply nested lists
        text = f"such a {type(value).__name__}"
    return text if len(text) <= _SHOWN else text[:_SHOWN] + "..."
