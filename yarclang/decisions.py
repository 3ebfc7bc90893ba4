"""Values that a program computes while it is carried out, at rest: of registers, inputs and constants.

A value is a number; a condition is a value that is 0 or 1. Each has one canonical text, as it stands in the map of a controller text:
every operation inside another one in brackets, registers with a `$`, inputs by their variables: `($N<3)&(M11=1)`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import field

from yarclang.frozen import frozen

AGAIN = "again:"
"""Stands in the map before a condition that is decided with what was read before."""

CONNECTIVES = ("OR", "AND")
COMPARISONS = ("=", "<>", "<", "<=", ">", ">=")
ARITHMETIC = ("+", "-", "*", "DIV", "MOD")
"""DIV is what the language writes as `FLOOR(a / b)`, MOD as `a % b`."""

SIGNS = {
    "OR": "|",
    "AND": "&",
    "DIV": "/",
    "MOD": "%",
    **{one: one for one in (*COMPARISONS, "+", "-", "*")},
}
"""How canonical text writes the operators between two values."""

UNARY_SIGNS = {"NOT": "!", "-": "-"}
"""How canonical text writes the operators before a value."""

DECIMALS = 9
"""Decimals of numbers in a text."""
LARGEST = 1_000_000_000
"""No value of a register, and no result on the way to one, lies farther from 0."""

MOST_LEAVES = 24
"""Registers, inputs and numbers in one value."""

MOST_BITS = 16
"""Single bits in a group of inputs or outputs."""

LONGEST_NAME = 40
"""Characters of the name of a register."""

DEEPEST = 24
"""Operations inside each other."""


@frozen
class Constant:
    """A number."""

    number: float


@frozen
class InputValue:
    """What an input reads: the controller's `variable`; the program calls it `name`.

    Of a group all variables stand there, the lowest bit first: `M70,M71,M72`.
    """

    variable: str
    name: str = field(default="", compare=False)


@frozen
class RegisterValue:
    """What a register holds."""

    name: str


@frozen
class Before:
    """An operator before a value: NOT, or the minus sign."""

    operator: str
    inner: Value


@frozen
class Between:
    """An operator between two values."""

    operator: str
    left: Value
    right: Value


Value = Constant | InputValue | RegisterValue | Before | Between


@frozen
class Register:
    """A declared register: an integer from `low` to `high` that is `first` when a run begins, or what it was last if it is `kept`.

    An `outside` one gets values from other programs while a WAIT or a HOLD takes them.
    """

    name: str
    low: int
    high: int
    first: int
    kept: bool = False
    outside: bool = False


@frozen
class Watch:
    """An input that is looked at while the robot moves: while it is `value`, the motion is held on its path.

    `variable` is the controller's, and `name` what the program calls the input.
    """

    variable: str
    value: float
    name: str


MOST_WATCHES = 8
"""Inputs that a program may watch: they are part of each question how far the controller is."""


@frozen
class Searched:
    """A motion, of step `step`, that ends where an input is `value`: the controller's `variable`, which the program calls `name`.

    Then the register `flag` becomes 1, and `depth`, if it isn't empty, how far the frame has come [0.01 mm].
    """

    step: int
    variable: str
    value: float
    name: str
    flag: str
    depth: str = ""


class DecisionError(Exception):
    """A value can't be computed: a division by zero, or a result that no register can hold."""


def is_condition(value: Value) -> bool:
    """Return True if a value is true or false by its outermost operator."""
    match value:
        case Before(operator=operator) | Between(operator=operator):
            return operator == "NOT" or operator in CONNECTIVES or operator in COMPARISONS
    return False


def evaluated(value: Value, registers: Mapping[str, int], inputs: Mapping[str, float]) -> float:
    """Compute a value.

    Args:
        value: what is computed.
        registers: what each register holds, by its name.
        inputs: what each input reads, by its variable.

    Raises:
        DecisionError: there is no such number.
    """
    match value:
        case Constant(number=number):
            return number
        case InputValue(variable=variable):
            return inputs[variable]
        case RegisterValue(name=name):
            return float(registers[name])
        case Before(operator=operator, inner=inner):
            of = evaluated(inner, registers, inputs)
            return float(of == 0.0) if operator == "NOT" else -of
        case Between(operator=operator, left=left, right=right):
            return _between(operator, evaluated(left, registers, inputs), evaluated(right, registers, inputs))


def _between(operator: str, one: float, other: float) -> float:
    match operator:
        case "OR":
            return float(one != 0.0 or other != 0.0)
        case "AND":
            return float(one != 0.0 and other != 0.0)
        case "=":
            return float(one == other)
        case "<>":
            return float(one != other)
        case "<":
            return float(one < other)
        case "<=":
            return float(one <= other)
        case ">":
            return float(one > other)
        case ">=":
            return float(one >= other)
        case "+":
            found = one + other
        case "-":
            found = one - other
        case "*":
            found = one * other
        case _:
            if other == 0.0:
                raise DecisionError(f"{one:.15g} {'/' if operator == 'DIV' else '%'} 0 is a division by zero")
            found = one // other if operator == "DIV" else math.fmod(one, other)
    if not abs(found) <= LARGEST:
        raise DecisionError(f"{one:.15g} {operator} {other:.15g} is beyond {LARGEST:,}")
    return found


def bits_of(variable: str) -> tuple[str, ...]:
    """Return the variables of a group, the lowest bit first; of a single one itself."""
    return tuple(variable.split(","))


def group_of(variables: Iterable[str]) -> str:
    """Return how a group of variables is written."""
    return ",".join(variables)


def is_group(variable: str) -> bool:
    """Return True if several bits are read or set as one number."""
    return "," in variable


def shown_variable(variable: str) -> str:
    """Return a variable as people read it; of a group the first and the last: `M70..M77`."""
    bits = bits_of(variable)
    return variable if len(bits) == 1 else f"{bits[0]}..{bits[-1]}"


def largest_of(variable: str) -> int:
    """Return the largest number that a group can be."""
    return (1 << len(bits_of(variable))) - 1


def inputs_of(value: Value) -> tuple[InputValue, ...]:
    """Return the inputs that are read for a value, each once, in the order in which they stand there."""
    return tuple({one.variable: one for one in leaves(value) if isinstance(one, InputValue)}.values())


def registers_of(value: Value) -> tuple[str, ...]:
    """Return the registers that a value is computed from, each once."""
    return tuple(dict.fromkeys(one.name for one in leaves(value) if isinstance(one, RegisterValue)))


def leaves(value: Value) -> Iterator[Value]:
    """Yield the registers, inputs and numbers of a value, from left to right."""
    match value:
        case Before(inner=inner):
            yield from leaves(inner)
        case Between(left=left, right=right):
            yield from leaves(left)
            yield from leaves(right)
        case _:
            yield value


_IN_BRACES = re.compile(r"\{([^{}]*)\}")


def names_in(text: str) -> tuple[str, ...]:
    """Return what stands in braces in a text, each in capitals: names of registers, if the text is right."""
    return tuple(one.strip().upper() for one in _IN_BRACES.findall(text))


def filled(text: str, registers: Mapping[str, int]) -> str:
    """Return a text with the values of registers for their names in braces; what is no register stays as it is."""

    def value(found: re.Match[str]) -> str:
        held = registers.get(found[1].strip().upper())
        return found[0] if held is None else str(held)

    return _IN_BRACES.sub(value, text)


def in_words(value: Value) -> str:
    """Return a value as people read it, with the names of the program: `N < 3 AND DOOR = ON`."""
    match value:
        case Constant(number=number):
            return f"{number:.15g}"
        case InputValue(name=name, variable=variable):
            return name or shown_variable(variable)
        case RegisterValue(name=name):
            return name
        case Before(operator="NOT", inner=inner):
            return f"NOT {_inside(inner)}"
        case Before(inner=inner):
            return f"-{_inside(inner)}"
        case Between(operator="DIV", left=left, right=right):
            return f"FLOOR({_inside(left)} / {_inside(right)})"
        case Between(operator="MOD", left=left, right=right):
            return f"{_inside(left)} % {_inside(right)}"
        case Between(operator=operator, left=left, right=right):
            return f"{_inside(left, operator)} {operator} {_inside(right, operator)}"


def _inside(value: Value, around: str = "") -> str:
    """A value inside an operation: in brackets, unless a comparison stands between AND and OR."""
    said = in_words(value)
    is_clear = around in CONNECTIVES and isinstance(value, Between) and value.operator in COMPARISONS
    if isinstance(value, Between) and value.operator != "DIV" and not is_clear:
        return f"({said})"
    return said


def simple(condition: Value) -> tuple[InputValue, float] | None:
    """Return the input and the number of a condition that compares nothing else; None of any other, and of a group."""
    match condition:
        case Between(operator="=", left=InputValue() as one, right=Constant(number=number)):
            return None if is_group(one.variable) else (one, number)
    return None


def called(condition: Value) -> str:
    """Return what the map of a controller text calls a condition: the name of the input, if it compares nothing else."""
    compared = simple(condition)
    return compared[0].name if compared is not None else in_words(condition)


def equals(variable: str, name: str, number: float) -> Value:
    """Return the condition that an input is a number."""
    return Between("=", InputValue(variable, name), Constant(round(number, DECIMALS) + 0.0))


def is_printed(number: float) -> bool:
    """Return True if a text has a number as it is, but for what binary fractions are off (0.1 + 0.2)."""
    return abs(round(number, DECIMALS) - number) <= 1e-12 * max(1.0, abs(number))
