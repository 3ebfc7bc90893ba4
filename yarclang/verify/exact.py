"""Exact numbers for controller text and proof, and fixed-point numbers for roots, sines and long products.

A fixed-point integer x stands for x / 2**128. Each product and quotient of fixed-point numbers is off by less
than one unit, a sine or cosine by less than 2**10 units. Consider a chain of at most 16 joints, with steps no
longer than 64 m, angles below 1024 rad and rates below 1024 per s (`arm.py` refuses others). Its kinematics
multiply errors by at most 4 per joint, add them up over at most 32 steps, and multiply them once by a length
and once by a rate. This gives 2**(10 + 32 + 5 + 6 + 10) units, with the exponents of the sine, of 4 per
joint, of the steps, of the length and of the rate: less than 2**-60 for any computed pose or velocity. Bodies
and zones that no joint moves may be up to 1024 m away or large, which gives less than 2**-100.
`SLACK`, 2**-44 or 6e-14 (m, rad), is added to every bound that is compared.
"""

from fractions import Fraction
from math import isqrt
from typing import Any

BITS = 128
ONE = 1 << BITS
SLACK = ONE >> 44


class RefusedError(Exception):
    """The controller text or its proof is wrong; the message says what, where, and by how much."""


def need(holds: bool, reason: str) -> None:
    """Refuse the controller text or the proof with a reason, unless a condition is true."""
    if not holds:
        raise RefusedError(reason)


def unknown(told: dict[str, Any], names: str) -> str:
    """Return the keys in a table of the proof that this checker doesn't know; empty if it knows all.

    An unknown key might change the meaning of the whole table.
    """
    return ", ".join(sorted(set(told) - set(names.split())))


def whole(number: Any, most: int = 1 << 62) -> int:
    """Return a number of the proof as int. It must be an integer from -`most` to `most`."""
    need(isinstance(number, Fraction) and number.denominator == 1 and abs(number) <= most, "no integer")
    return int(number)


def fixed(number: Fraction | int) -> int:
    """Return a number in fixed-point, rounded down by less than one unit."""
    return (number.numerator << BITS) // number.denominator


def above(number: Fraction | int) -> int:
    """Return an upper bound of a number in fixed-point."""
    return fixed(number) + 1


def times(*numbers: int) -> int:
    """Return an upper bound of the product of non-negative fixed-point numbers."""
    product = ONE
    for number in numbers:
        product = (product * number >> BITS) + 1
    return product


def root(square: int) -> int:
    """Return an upper bound of the square root of a non-negative fixed-point number."""
    return isqrt(square << BITS) + 1


def length(*numbers: int) -> int:
    """Return an upper bound of the length of a vector of fixed-point numbers."""
    return isqrt(sum(number * number for number in numbers)) + 1


def _arctan_of_one_over(number: int, bits: int) -> int:
    """Return arctan(1 / number) in units of 2**-bits, by its series: 1/x - 1/3x^3 + 1/5x^5 - ..."""
    power, total, odd = (1 << bits) // number, 0, 1
    while power:
        total += power // odd if odd % 4 == 1 else -(power // odd)
        power, odd = power // (number * number), odd + 2
    return total


PI = (16 * _arctan_of_one_over(5, 256) - 4 * _arctan_of_one_over(239, 256)) >> (256 - BITS)
"""Pi in fixed-point, by Machin's formula with 256 bits. The error is below 16 fixed-point units."""


def sine_and_cosine(angle: int) -> tuple[int, int]:
    """Return sine and cosine of an angle below 1024 rad, all in fixed-point."""
    quarters = (2 * angle + PI // 2) // PI
    rest = angle - quarters * PI // 2
    square = rest * rest >> BITS
    sine = cosine = 0
    even, odd = ONE, rest
    for k in range(0, 36, 2):  # the omitted terms are below 0.786**36 / 36!, less than one unit
        cosine, sine = cosine + even, sine + odd
        even = -(even * square >> BITS) // ((k + 1) * (k + 2))
        odd = -(odd * square >> BITS) // ((k + 2) * (k + 3))
    turned = ((sine, cosine), (cosine, -sine), (-sine, -cosine), (-cosine, sine))
    return turned[quarters % 4]
