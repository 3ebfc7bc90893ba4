"""Tests of expressions: their trees are those of Python, and survive printing and parsing."""

import ast
import keyword
import re
from itertools import product

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from syntax.writing import PYTHONIC, bare, expression, parsed

from yarclang.source import SourceFile
from yarclang.syntax.ast import Computed, ComputedPercent, Place, Quantity
from yarclang.syntax.expressions import (
    DEEPEST_EXPRESSION,
    Binary,
    Bracket,
    Function,
    Name,
    Unary,
    is_too_deep,
    parts_of,
)
from yarclang.syntax.leaves import Number, Word
from yarclang.syntax.parse import parse
from yarclang.syntax.print import print_expression
from yarclang.syntax.words import OPERATORS

COMPARISONS = ("=", "<>", "<", "<=", ">", ">=")
BINARY = ("OR", "AND", *COMPARISONS, "+", "-", "*", "/", "%", "**")
UNARY = ("NOT", "+", "-")
PYTHON = {
    ast.Or: "OR",
    ast.And: "AND",
    ast.Not: "NOT",
    ast.Eq: "=",
    ast.NotEq: "<>",
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.Mod: "%",
    ast.Pow: "**",
    ast.UAdd: "+",
    ast.USub: "-",
}


def read(text):
    """Return the tree of an expression, or None if it can't be read."""
    result = parsed(f"LET X = {text}")
    return result.value.statements[0].expression if result.value.statements else None


def ours(node):
    """Return a tree as nested tuples. Brackets are left out, because they only group."""
    match node:
        case Bracket(inner):
            return ours(inner)
        case Unary(operator, operand):
            return operator, ours(operand)
        case Binary(operator, left, right):
            return operator, ours(left), ours(right)
        case Function():
            return (node.name, *map(ours, node.arguments))
        case Name():
            return node.name
        case Number():
            return node.value
    raise AssertionError(node)


def pythons(text):
    """Return Python's tree of the same expression as nested tuples, or None if Python can't read it."""
    text = re.sub(r"(?<![<>])=", "==", text).replace("<>", "!=")
    text = re.sub(r"\b(OR|AND|NOT)\b", lambda match: match[0].lower(), text, flags=re.IGNORECASE)
    try:
        return _tuples(ast.parse(text.strip(), mode="eval").body)
    except SyntaxError:
        return None


def _tuples(node):
    match node:
        case ast.BoolOp(op=operator, values=[first, *others]):
            result = _tuples(first)
            for other in others:
                result = PYTHON[type(operator)], result, _tuples(other)
            return result
        case (
            ast.Compare(left=left, ops=[operator], comparators=[right])
            | ast.BinOp(left=left, op=operator, right=right)
        ):
            return PYTHON[type(operator)], _tuples(left), _tuples(right)
        case ast.UnaryOp(op=operator, operand=operand):
            return PYTHON[type(operator)], _tuples(operand)
        case ast.Call(func=ast.Name(id=name), args=arguments):
            return (name.upper(), *map(_tuples, arguments))
        case ast.Name(id=name):
            return name.upper()
        case ast.Constant(value=value):
            return float(value)
    raise AssertionError(ast.dump(node))


@pytest.mark.parametrize("first", BINARY)
@pytest.mark.parametrize("second", BINARY)
def test_every_pair_of_operators_binds_as_in_python(first, second):
    text = f"A {first} B {second} C"
    tree = read(text)
    if first in COMPARISONS and second in COMPARISONS:
        assert tree is None, "Python's chain of comparisons means something else elsewhere"
    else:
        assert ours(tree) == pythons(text)


@pytest.mark.parametrize(("sign", "operator"), [*product(UNARY, BINARY)])
def test_every_sign_and_operator_bind_as_in_python(sign, operator):
    for text in (f"{sign} A {operator} B", f"A {operator} {sign} B", f"A {operator} {sign} B {operator} C"):
        tree = read(text)
        if tree is None and operator in COMPARISONS and sign != "NOT":
            continue  # Python reads this as a chain of comparisons
        assert (ours(tree) if tree else None) == pythons(text), text


@pytest.mark.parametrize(("first", "second"), [*product(UNARY, UNARY)])
def test_signs_follow_each_other_as_in_python(first, second):
    tree = read(f"{first} {second} A")
    assert (ours(tree) if tree else None) == pythons(f"{first} {second} A")


@given(expression(primaries=PYTHONIC))
def test_any_expression_is_read_as_python_reads_it(text):
    # some names, such as `as`, are keywords in Python
    assume(
        not any(
            keyword.iskeyword(word) for word in re.findall(r"[a-z]+", text) if word.upper() not in OPERATORS
        )
    )
    assert ours(read(text)) == pythons(text)


@given(expression())
def test_print_then_parse_gives_the_same_tree(text):
    tree = read(text)
    printed = print_expression(tree)
    again = read(printed)
    assert bare(again) == bare(tree)
    assert print_expression(again) == printed


@pytest.mark.parametrize(
    ("text", "printed"),
    [
        ("i*pitch", "I*PITCH"),
        ("I  *  PITCH+5", "I*PITCH + 5"),
        ("-depth", "-DEPTH"),
        ("60(MM)", "60 (mm)"),
        ("2 * 60 ( mm )/3", "2*60 (mm)/3"),
        ("a>5 and not b<>3", "A > 5 AND NOT B <> 3"),
        ("2**-1 %3", "2**-1%3"),
        ("max( a,b , 3 )", "MAX(A, B, 3)"),
        ("((a))-(b - c)", "((A)) - (B - C)"),
        ("a- -b", "A - -B"),
        ("sin (30)", "SIN(30)"),
        ("pallet.pitch*pi", "PALLET.PITCH*PI"),
        ("1.50e3", "1.50e3"),
    ],
)
def test_how_expressions_are_printed(text, printed):
    assert print_expression(read(text)) == printed


def test_places_and_texts():
    (one,) = parsed("P1 MOVEL $( A*b ) 5 $C [$T%] BLEND $(R)").value.statements
    first, number, second = one.waypoints[0].values
    assert first == Computed(
        "$( A*b )",
        Binary("*", Name("A", Place(0, 13, 14)), Name("b", Place(0, 15, 16)), Place(0, 13, 16)),
        Place(0, 10, 18),
    )
    assert number == Number("5", 5.0, Place(0, 19, 20))
    assert second == Computed("$C", Name("C", Place(0, 22, 23)), Place(0, 21, 23))
    assert one.time.items == (ComputedPercent("$T%", Name("T", Place(0, 26, 27)), Place(0, 25, 28)),)
    assert one.time.place == Place(0, 24, 29)
    assert one.options[0].argument == Computed("$(R)", Name("R", Place(0, 38, 39)), Place(0, 36, 40))


def test_places_inside():
    tree = read("max(1, -2) + (60 (mm))")
    assert tree.place == Place(0, 9, 31)
    function, bracket = parts_of(tree)
    assert (function.word, function.place) == (Word("max", Place(0, 9, 12)), Place(0, 9, 19))
    assert [one.place for one in function.arguments] == [Place(0, 13, 14), Place(0, 16, 18)]
    assert bracket.place == Place(0, 22, 31)
    assert bracket.inner == Quantity(
        Number("60", 60.0, Place(0, 23, 25)), Word("mm", Place(0, 27, 29)), Place(0, 23, 30)
    )


def test_places_in_a_later_row():
    (one,) = parsed("P1 MOVEJ_SPLINE 1 2;\n $(A) $B [$T] (s)").value.statements
    assert [value.place for value in one.waypoints[1].values] == [Place(1, 2, 6), Place(1, 7, 9)]
    assert one.time.place == Place(1, 10, 14)
    assert one.units.place == Place(1, 15, 18)


DEEP = {
    "brackets": lambda depth: "(" * (depth - 1) + "1" + ")" * (depth - 1),
    "signs": lambda depth: "-" * (depth - 1) + "1",
    "a sum": lambda depth: "1" + " + 1" * (depth - 1),
    "powers": lambda depth: "1" + "**1" * (depth - 1),
    "functions": lambda depth: "SIN(" * (depth - 1) + "1" + ")" * (depth - 1),
}


@pytest.mark.parametrize("deep", DEEP.values(), ids=DEEP.keys())
def test_an_expression_is_at_most_so_deep(deep):
    assert not is_too_deep(read(deep(DEEPEST_EXPRESSION)))
    for depth in (DEEPEST_EXPRESSION + 1, 9_000):
        for line in (f"LET X = {deep(depth)}", f"P1 MOVEJ 5 $({deep(depth)})", f"IF {deep(depth)}"):
            assert [one.code for one in parsed(line).diagnostics] == ["Y0112"]


def test_a_long_function_is_not_deep():
    assert read(f"MAX({', '.join(['1'] * 5_000)})") is not None


@given(st.text(alphabet='LETXIF$()[]+-*/%<>=,.;&|!^ 1aS{}"≤\n', max_size=60))
def test_no_text_makes_the_parser_raise(text):
    for line in (
        f"LET X = {text}",
        f"IF {text}",
        f"P1 MOVEJ $({text}) 5",
        f"P1 MOVEJ 1 [{text}] BLEND {text}",
    ):
        result = parsed(line)
        lines = {one.span.line for one in result.diagnostics}
        assert len(lines) == len(result.diagnostics), "one line, one finding"


@pytest.mark.parametrize(
    ("line", "start", "end"),
    [
        ("LET X = 3 + * 4", 13, 14),
        ("LET X = 3 +   ! more", 12, 13),
        ("LET X = A == B", 11, 13),
        ("IF A != B", 6, 8),
        ("IF A > !B", 8, 9),
        ("IF (A != B", 7, 9),
        ("LET X = 3 + PI(4)", 13, 15),
        ("LET X = 2*(ABS(0,5))", 12, 20),
        ("LET X = 1_000", 9, 14),
        ("LET X = (3*(4 + 5)", 9, 10),
        ("LET X = A < B < C", 15, 16),
        ("LET X = 5 (mm/s)", 12, 14),
        ("P1 MOVEJ 1 $(A + 2 3 4 [5] (deg,s) {B}", 12, 14),
        ("P1 MOVEJ 1 2*$A 3", 12, 16),
        ("P1 MOVEJ 1 2;\n $(A)$B", 6, 8),
        ("P1 MOVEJ 1 [$(SIN(2)]", 13, 15),
        ("P1 MOVEJ $(MAX(1, 2) 3) 0", 22, 23),
    ],
)
def test_the_place_of_a_fault(line, start, end):
    (one,) = parsed(line).diagnostics
    assert (one.span.column, one.span.end_column) == (start, end)
    assert one.span.line == line.count("\n") + 1


@pytest.mark.parametrize("condition", ["DOOR OFF AND N < 5", "N < 5 AND DOOR OFF"])
def test_a_short_condition_beside_another_one_is_answered_with_a_comparison(condition):
    (found,) = parse(SourceFile("a.yarc", f"WHEN {condition}\nEND\n")).diagnostics
    assert found.code == "Y0101"
    assert found.help == "write `DOOR = OFF`"
