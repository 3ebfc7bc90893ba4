"""Values and conditions that a running program computes at rest from registers (integer variables), inputs
and constants.

A value is a number; a condition is a value that is 0 or 1. Each value has one canonical text, which the
comments of a controller text contain (the map). In this canonical text, every nested operation is in
brackets, registers have a `$`, and inputs are named by their variables, as in `($N<3)&(M11=1)`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import field

from yarclang.frozen import frozen

AGAIN = "again:"
"""Prefix of a condition in the map. It means that the inputs aren't read again: the condition is evaluated
with the values that were read for an earlier condition.
"""

CONNECTIVES = ("OR", "AND")
COMPARISONS = ("=", "<>", "<", "<=", ">", ">=")
ARITHMETIC = ("+", "-", "*", "DIV", "MOD")
"""Arithmetic operators. The language writes DIV as `FLOOR(a / b)` and MOD as `a % b`."""

SIGNS = {
    "OR": "|",
    "AND": "&",
    "DIV": "/",
    "MOD": "%",
    **{one: one for one in (*COMPARISONS, "+", "-", "*")},
}
"""Binary operators in canonical text."""

UNARY_SIGNS = {"NOT": "!", "-": "-"}
"""Unary operators in canonical text."""

DECIMALS = 9
"""Number of decimals of numbers in canonical text."""
LARGEST = 1_000_000_000
"""Largest absolute value of a register and of every intermediate result."""

MOST_LEAVES = 24
"""Largest number of registers, inputs and numbers in one value."""

MOST_BITS = 16
"""Largest number of bits in a group of inputs or outputs."""

LONGEST_NAME = 40
"""Largest number of characters in the name of a register."""

DEEPEST = 24
"""Largest depth of nested operations in one value."""


@frozen
class Constant:
    """A constant number."""

    number: float


@frozen
class InputValue:
    """An input as an operand of an expression.

    Attributes:
        variable: the controller's variable. For a group, the variables of all its bits, lowest bit first:
            `M70,M71,M72`.
        name: the input's name in the program.
    """

    variable: str
    name: str = field(default="", compare=False)


@frozen
class RegisterValue:
    """The value that a register holds."""

    name: str


@frozen
class Before:
    """A unary operator, NOT or the minus sign, with its operand."""

    operator: str
    inner: Value


@frozen
class Between:
    """A binary operator with its operands."""

    operator: str
    left: Value
    right: Value


Value = Constant | InputValue | RegisterValue | Before | Between


@frozen
class Register:
    """A declared register, which holds an integer.

    Attributes:
        name: the register's name, in capitals.
        low: smallest allowed value.
        high: largest allowed value.
        first: value at the start of a run.
        kept: True if the register starts with its value at the end of the previous run instead of `first`.
        outside: True if other programs supply values. The register gets them at a WAIT or a HOLD.
    """

    name: str
    low: int
    high: int
    first: int
    kept: bool = False
    outside: bool = False


@frozen
class Watch:
    """An input that is monitored while the robot moves. If it gets a certain value, the robot stops on its
    path.

    Attributes:
        variable: the controller's variable.
        value: the input's value at which the robot stops.
        name: the input's name in the program.
        then: name of the SUB with the motions by which the robot withdraws; empty: the robot only holds, and
            can resume its motion.
        way: hash of this SUB's steps, 16 hex digits.
    """

    variable: str
    value: float
    name: str
    then: str = ""
    way: str = ""

    @property
    def reaction(self) -> str:
        """The robot's reaction to the input, in words."""
        return f"hold, then leave by {self.then}" if self.then else "hold"


def only_holding(watches: Iterable[Watch]) -> tuple[Watch, ...]:
    """Return copies of watched inputs that only stop the robot on its path, without the SUBs by which it
    withdraws. They are used for motions that aren't part of the program, such as an approach.
    """
    return tuple(Watch(one.variable, one.value, one.name) for one in watches)


MOST_WATCHES = 8
"""Largest number of inputs that a program may watch: each progress query to the controller contains all of
them.
"""


@frozen
class Searched:
    """A motion that ends early when an input has a certain value.

    Attributes:
        step: index of the motion in the program's steps.
        variable: the controller's variable of the input.
        value: the input's value that ends the motion.
        name: the input's name in the program.
        flag: register that becomes 1 when the input ends the motion.
        depth: register that then gets the distance covered by the frame [0.01 mm]; empty for none.
    """

    step: int
    variable: str
    value: float
    name: str
    flag: str
    depth: str = ""


SHIFTS = ("X", "Y", "Z", "RZ")
"""Directions in which a frame is shifted at run time, and the axis about which it is rotated."""


def shift_in_words(values: Sequence[int], registers: Sequence[str]) -> str:
    """Return the shift of a frame in words: `X 12.50 mm, RZ -3.00 deg`.

    Args:
        values: value of the register for each of `SHIFTS` [0.01 mm or 0.01 deg].
        registers: names of these registers; empty for a direction without a register.
    """
    return ", ".join(
        f"{axis} {value / 100:.2f} {'deg' if axis == 'RZ' else 'mm'}"
        for axis, value, register in zip(SHIFTS, values, registers, strict=True)
        if register
    )


@frozen
class Shifted:
    """An OFFSET: motions that are planned and proved at run time, in a frame that registers shift.

    Attributes:
        step: index of the OFFSET in the program's steps.
        flag: register that becomes 1 if the motions can be carried out, else 0.
        frame: name of the frame.
        registers: register with the value for each of `SHIFTS` [0.01 mm or 0.01 deg]; empty for none.
    """

    step: int
    flag: str
    frame: str
    registers: tuple[str, ...]


@frozen
class KeptTo:
    """A path constraint (KEEP rule) that a motion must satisfy along its whole path.

    Attributes:
        step: index of the motion in the program's steps.
        rule: the rule in words, with all its numbers.
    """

    step: int
    rule: str

    @property
    def words(self) -> str:
        """The rule as a program writes it, without the numbers after its reference frame: {CUP} UPRIGHT 10
        (deg) {B}.
        """
        end = self.rule.rfind("}") + 1
        return self.rule[:end] or self.rule


@frozen
class Permitted:
    """Two bodies that are allowed to touch during a motion.

    Attributes:
        step: index of the motion in the program's steps.
        first: name of one body, in upper case.
        second: name of the other body, in alphabetical order after the first.
    """

    step: int
    first: str
    second: str


class DecisionError(Exception):
    """A value can't be computed: a division by zero, or a result larger than `LARGEST`."""


def is_condition(value: Value) -> bool:
    """Return True if the outermost operator of a value returns true or false."""
    match value:
        case Before(operator=operator) | Between(operator=operator):
            return operator == "NOT" or operator in CONNECTIVES or operator in COMPARISONS
    return False


def evaluated(value: Value, registers: Mapping[str, int], inputs: Mapping[str, float]) -> float:
    """Compute the value of an expression from registers and inputs.

    Args:
        value: the expression.
        registers: register values by name.
        inputs: input values by variable.

    Raises:
        DecisionError: a divisor is zero, or a result is larger than `LARGEST`.
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
    """Return the variables of a group, lowest bit first; for a single variable, only itself."""
    return tuple(variable.split(","))


def group_of(variables: Iterable[str]) -> str:
    """Return the text of a group of variables."""
    return ",".join(variables)


def is_group(variable: str) -> bool:
    """Return True if a variable is a group, whose bits are read or set as one number."""
    return "," in variable


def shown_variable(variable: str) -> str:
    """Return a variable as messages show it; for a group, its first and last bit: `M70..M77`."""
    bits = bits_of(variable)
    return variable if len(bits) == 1 else f"{bits[0]}..{bits[-1]}"


def largest_of(variable: str) -> int:
    """Return the largest number that a group can hold."""
    return (1 << len(bits_of(variable))) - 1


def inputs_of(value: Value) -> tuple[InputValue, ...]:
    """Return the inputs that a value reads, each once, in order of appearance."""
    return tuple({one.variable: one for one in leaves(value) if isinstance(one, InputValue)}.values())


def registers_of(value: Value) -> tuple[str, ...]:
    """Return the registers that a value reads, each once, in order of appearance."""
    return tuple(dict.fromkeys(one.name for one in leaves(value) if isinstance(one, RegisterValue)))


def leaves(value: Value) -> Iterator[Value]:
    """Yield the registers, inputs and numbers of a value from left to right."""
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
    """Return the contents of all braces in a text, in capitals: register names, if the text is correct."""
    return tuple(one.strip().upper() for one in _IN_BRACES.findall(text))


def filled(text: str, registers: Mapping[str, int]) -> str:
    """Return a text with each register name in braces replaced by its value; other braces stay unchanged."""

    def value(found: re.Match[str]) -> str:
        held = registers.get(found[1].strip().upper())
        return found[0] if held is None else str(held)

    return _IN_BRACES.sub(value, text)


def in_words(value: Value) -> str:
    """Return a value as messages show it, with the program's names: `N < 3 AND DOOR = ON`."""
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
    """Return an operand in words. A binary operation is put in brackets, except FLOOR, and except a
    comparison that AND or OR joins to another condition.
    """
    said = in_words(value)
    is_clear = around in CONNECTIVES and isinstance(value, Between) and value.operator in COMPARISONS
    if isinstance(value, Between) and value.operator != "DIV" and not is_clear:
        return f"({said})"
    return said


def simple(condition: Value) -> tuple[InputValue, float] | None:
    """Return the input and the number of a condition of the form `input = number`; None for any other
    condition, and for a group of inputs.
    """
    match condition:
        case Between(operator="=", left=InputValue() as one, right=Constant(number=number)):
            return None if is_group(one.variable) else (one, number)
    return None


def called(condition: Value) -> str:
    """Return a short name for a condition in the map of a controller text (its list of commands and
    decisions).

    This is the name of the input for a condition `input = number`, else the condition in words.
    """
    compared = simple(condition)
    return compared[0].name if compared is not None else in_words(condition)


def equals(variable: str, name: str, number: float) -> Value:
    """Return the condition that an input equals a number."""
    return Between("=", InputValue(variable, name), Constant(round(number, DECIMALS) + 0.0))


def is_printed(number: float) -> bool:
    """Return True if a text can print a number with `DECIMALS` decimals. Binary rounding errors, as in
    0.1 + 0.2, are ignored.
    """
    return abs(round(number, DECIMALS) - number) <= 1e-12 * max(1.0, abs(number))
