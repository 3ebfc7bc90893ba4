"""Proved bounds in other units and with few digits, rounded outwards.

A printed bound is never sharper than the proved one.
"""

from __future__ import annotations

import math
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal

from yarclang.units import MM

_WIDE = 40
"""Number of significant digits of intermediate decimal values. No printed number has so many digits."""
_DIGITS_OVER = 6
"""Number of printed digits of a percentage slightly above 100."""
_SLIGHTLY = 1.01


def most(value: float, unit: float) -> float:
    """Return an upper bound (m, m/s, rad or rad/s) in `unit`, MM or DEG, rounded up; 0 stays 0."""
    return _moved(value, unit, math.inf)


def least(value: float, unit: float) -> float:
    """Return a lower bound in `unit`, MM or DEG, rounded down; 0 stays 0."""
    return _moved(value, unit, -math.inf)


def _moved(value: float, unit: float, towards: float) -> float:
    if value == 0.0 or not math.isfinite(value):
        return value
    if unit == MM:
        # MM is 1e-3. The factor 1000 is exact, so the product is rounded only once.
        found = value * 1000.0
        missing = _product_error(value, 1000.0, found)
        # The exact product is `found` + `missing`: move to the next number if `found` is on the wrong side of
        # it.
        is_outside = missing <= 0.0 if towards > 0.0 else missing >= 0.0
        return found if is_outside else math.nextafter(found, towards)
    # The unit and the quotient are each rounded by at most half a unit in the last place: move on by two
    # numbers.
    return math.nextafter(math.nextafter(value / unit, towards), towards)


def _product_error(one: float, small: float, product: float) -> float:
    """Return the rounding error one * small - product exactly; `small` is an integer of at most 26 bits.

    The method is Veltkamp's splitting of `one` (the constant is 2^27 + 1), then Dekker's product.
    """
    # `high` has at most 26 bits, and so has the rest of `one`: both products with `small` are exact.
    split = 134217729.0 * one
    high = split - (split - one)
    return (high * small - product) + (one - high) * small


def up(value: float, decimals: int) -> str:
    """Return an upper bound with the given number of decimals."""
    return _decimals(value, decimals, ROUND_CEILING)


def down(value: float, decimals: int) -> str:
    """Return a lower bound with the given number of decimals."""
    return _decimals(value, decimals, ROUND_FLOOR)


def _decimals(value: float, decimals: int, rounding: str) -> str:
    if not math.isfinite(value):
        return "unproved"
    # A Decimal represents every float exactly. Only the rounding below drops digits.
    exact = Decimal(value)
    step = Decimal(1).scaleb(-decimals)
    context = Context(prec=max(_WIDE, exact.adjusted() + decimals + 2), rounding=rounding)
    made = exact.quantize(step, context=context)
    return f"{abs(made) if made == 0 else made:.{decimals}f}"


def up_to(value: float, digits: int) -> str:
    """Return an upper bound with the given number of digits, without trailing zeros, like the format `g`."""
    return _digits(value, digits, ROUND_CEILING)


def down_to(value: float, digits: int) -> str:
    """Return a lower bound with the given number of digits, like `up_to`."""
    return _digits(value, digits, ROUND_FLOOR)


def _digits(value: float, digits: int, rounding: str) -> str:
    if not math.isfinite(value):
        return "unproved"
    return f"{float(Context(prec=digits, rounding=rounding).create_decimal(Decimal(value))):.{digits}g}"


def percent(share: float, decimals: int = 0) -> str:
    """Return a fraction of a limit in percent, rounded up, without the percent sign.

    A fraction slightly above 1 is printed with more digits, such as 100.001.
    """
    if not math.isfinite(share):
        return "unproved"
    exact = Context(prec=_WIDE, rounding=ROUND_CEILING).multiply(Decimal(share), Decimal(100))
    if 1.0 < share < _SLIGHTLY:
        return f"{Context(prec=_DIGITS_OVER, rounding=ROUND_CEILING).create_decimal(exact):f}"
    context = Context(prec=max(_WIDE, exact.adjusted() + decimals + 2), rounding=ROUND_CEILING)
    return f"{exact.quantize(Decimal(1).scaleb(-decimals), context=context):.{decimals}f}"
