"""Random texts of statements, and trees without places, for the tests of this folder."""

import dataclasses

from hypothesis import strategies as st

from yarclang.source import SourceFile
from yarclang.syntax.ast import Computed, ComputedPercent, Statement
from yarclang.syntax.leaves import FrameName, Number
from yarclang.syntax.parse import parse
from yarclang.syntax.words import FUNCTIONS, RESERVED


def parsed(text):
    return parse(SourceFile("test.yarc", text))


def bare(value):
    """Return a tree without places and comments, and with names in the form in which they are compared."""
    if isinstance(value, tuple):
        return tuple(map(bare, value))
    if isinstance(value, Number):
        return value.text
    if isinstance(value, FrameName):
        return value.name
    if dataclasses.is_dataclass(value):
        left_out = {"place", "line", "rows", "comments"}
        if isinstance(value, Computed | ComputedPercent):
            left_out.add("text")  # this text contains the blanks as written
        kept = [field.name for field in dataclasses.fields(value) if field.name not in left_out]
        return (type(value).__name__, *(bare(getattr(value, name)) for name in kept))
    return value.upper() if isinstance(value, str) else value


def said(text):
    """Return the meaning of a text's statements, all of which must be readable."""
    result = parsed(text)
    assert result.diagnostics == ()
    return bare(result.value.statements)


def statements(text):
    return [one for one in parsed(text).value.statements if isinstance(one, Statement)]


number = st.one_of(
    st.integers(-999, 999).map(str),
    st.floats(-1e3, 1e3, allow_nan=False).map(lambda value: f"{value:.3f}"),
    st.sampled_from(["+.5", "5.", "1e-3", "-2E+2"]),
)
whole = st.integers(0, 999).map(str)
unsigned = number.map(lambda text: text.lstrip("+-"))
word = st.from_regex(r"[A-OQ-Za-oq-z][A-Za-z0-9_]{0,8}", fullmatch=True).filter(
    lambda text: text.upper() not in RESERVED
)
name = st.one_of(word, word, st.tuples(word, word).map(".".join))
frame = st.tuples(st.sampled_from(["", " "]), name, st.sampled_from(["", " "])).map(
    lambda parts: "{" + "".join(parts) + "}"
)
unit = st.sampled_from(["mm", "cm", "IN", "deg", "Rad", "s", "ms", "min"])
gap = st.sampled_from(["", "", " ", "  ", "\t"])
blank = st.sampled_from([" ", " ", "  ", "\t"])

LEVELS = (
    ("OR",),
    ("AND",),
    ("NOT",),
    ("=", "<>", "<", "<=", ">", ">="),
    ("+", "-"),
    ("*", "/", "%"),
    "sign",
    "power",
)
"""Operators, from those that bind weakest to those that bind strongest."""


PRIMARIES = ("number", "name", "name", "quantity", "PI", "bracket", "function", "element", "applied")
PYTHONIC = ("whole", "word", "word", "PI", "bracket", "function")
"""Kinds of operands that Python reads as well."""


@st.composite
def expression(draw, level=0, depth=4, primaries=PRIMARIES):
    """Draw an expression whose operators bind at least as strongly as those of a level."""
    if level == len(LEVELS) or depth == 0:
        return draw(primary(depth, primaries))

    def part(level, depth):
        return draw(expression(level, depth, primaries))

    kind = LEVELS[level]
    if draw(st.integers(0, 3)) or depth == 1:
        return part(level + 1, depth)
    if kind == ("NOT",):
        return draw(st.sampled_from(["NOT ", "not\t", "Not  "])) + part(level, depth - 1)
    if kind == "sign":
        return draw(st.sampled_from("+-")) + draw(gap) + part(level, depth - 1)
    if kind == "power":
        return f"{draw(primary(depth - 1, primaries))}{draw(gap)}**{draw(gap)}{part(level - 1, depth - 1)}"
    side = level + 1 if kind == LEVELS[3] else level  # comparisons don't follow each other
    operator = draw(st.sampled_from(kind))
    between = blank if operator.isalpha() else gap
    operator = operator.lower() if draw(st.booleans()) else operator
    return f"{part(side, depth - 1)}{draw(between)}{operator}{draw(between)}{part(level + 1, depth - 1)}"


@st.composite
def primary(draw, depth, primaries):
    kind = draw(st.sampled_from(primaries))
    if kind == "name":
        return draw(name)
    if kind == "word":
        return draw(word)
    if kind == "PI":
        return draw(st.sampled_from(["PI", "pi"]))
    if kind == "quantity":
        return f"{draw(unsigned)}{draw(gap)}({draw(gap)}{draw(unit)}{draw(gap)})"
    if kind == "bracket" and depth:
        return f"({draw(gap)}{draw(expression(0, depth - 1, primaries))}{draw(gap)})"
    if kind == "function" and depth:
        function = draw(st.sampled_from(sorted(FUNCTIONS)))
        least, most = FUNCTIONS[function]
        given = draw(st.integers(least, most or 4))
        arguments = [draw(expression(0, depth - 1, primaries)) for _ in range(given)]
        return f"{function.lower()}{draw(gap)}({f'{draw(gap)},{draw(gap)}'.join(arguments)})"
    if kind == "applied" and depth:
        arguments = [draw(expression(0, depth - 1, primaries)) for _ in range(draw(st.integers(1, 3)))]
        return f"{draw(name)}{draw(gap)}({f'{draw(gap)},{draw(gap)}'.join(arguments)}{draw(gap)})"
    if kind == "element" and depth:
        indices = [draw(expression(0, depth - 1, primaries)) for _ in range(draw(st.integers(1, 2)))]
        return f"{draw(name)}[{f'{draw(gap)},{draw(gap)}'.join(indices)}{draw(gap)}]"
    return draw(unsigned if kind != "whole" else whole)


computed = st.one_of(
    name.map(lambda text: "$" + text),
    st.tuples(gap, expression(), gap).map(lambda parts: f"$({''.join(parts)})"),
)
value = st.one_of(number, number, number, computed)
percent = st.tuples(st.one_of(unsigned, computed), st.sampled_from(["%", " %"])).map("".join)
time = st.one_of(
    number,
    st.just("MIN"),
    percent,
    computed,
    st.tuples(st.just("V"), st.one_of(number, computed)).map(" ".join),
    st.tuples(st.sampled_from(["V", "v"]), gap, st.just("<="), gap, st.one_of(number, computed)).map("".join),
).map(lambda text: f"[{text}]")
units = st.lists(unit, min_size=1, max_size=3).map(lambda items: f"({','.join(items)})")
option = st.one_of(
    st.tuples(st.sampled_from(["BLEND", "tol"]), st.one_of(number, computed)),
    st.tuples(st.sampled_from(["ACC"]), percent),
    st.tuples(st.sampled_from(["BLEND <=", "blend<=", "BLEND <= "]), st.one_of(number, computed)).map(
        lambda parts: ("".join(parts),)
    ),
    st.tuples(st.just("NEAR"), name),
).map(" ".join)
index = st.integers(0, 9999).map(lambda number: f"P{number:04d}")


@st.composite
def motion(draw):
    parts = [draw(index), draw(word)]
    if draw(st.booleans()):
        parts.append(draw(frame))
    waypoint = st.one_of(st.lists(value, min_size=1, max_size=7).map(" ".join), name)
    points = draw(st.lists(waypoint, max_size=3))
    if points:
        parts.append(draw(st.sampled_from(["; ", ";", " ;\n  ", "; ! to be continued\n"])).join(points))
        if draw(st.booleans()):
            parts.append(draw(time))
        if draw(st.booleans()):
            parts.append(draw(units))
        if draw(st.booleans()):
            parts.append(draw(frame))
            parts += draw(st.lists(option, max_size=2))
    return draw(blank).join(parts)


# after VEL, `ACC $A` means an acceleration and can't be the option ACC, which no command with VEL has
timed_option = st.one_of(
    option.filter(lambda text: not text.startswith("ACC $")),
    number.map(lambda factor: f"STRETCH {factor}"),
)


@st.composite
def timed_motion(draw):
    """Draw a motion whose waypoints have times, and some of them velocities and accelerations."""
    parts = [draw(index), draw(word)]
    points = []
    for _ in range(draw(st.integers(1, 3))):
        row = st.lists(value, min_size=1, max_size=6).map(" ".join)
        point = f"{draw(row)}{draw(gap)}{draw(time)}"
        if draw(st.booleans()):
            point += f"{draw(gap)}{draw(st.sampled_from(['VEL', 'vel']))} {draw(row)}"
            if draw(st.booleans()):
                point += f"{draw(blank)}{draw(st.sampled_from(['ACC', 'acc']))}{draw(blank)}{draw(row)}"
        points.append(point)
    parts.append(draw(st.sampled_from(["; ", ";", " ;\n  ", "; ! to be continued\n"])).join(points))
    if draw(st.booleans()):
        parts.append(draw(units))
    parts += draw(st.lists(timed_option, max_size=2))
    return draw(blank).join(parts)


equals = st.sampled_from(["=", " =", "= ", "  =  "])


@st.composite
def call(draw):
    quantity = st.tuples(number, gap, unit).map(lambda parts: f"{parts[0]}{parts[1]}({parts[2]})")
    value = st.one_of(number, computed, frame, name, quantity)
    argument = st.one_of(value, st.tuples(word, equals, value).map("".join))
    parts = [draw(index), draw(st.sampled_from(["CALL", "call"])), draw(name)]
    return draw(blank).join([*parts, *draw(st.lists(argument, max_size=5))])


@st.composite
def sub_head(draw):
    parameter = st.one_of(
        frame,
        word,
        st.tuples(word, gap, unit).map(lambda parts: f"{parts[0]}{parts[1]}({parts[2]})"),
        st.tuples(word, equals, st.one_of(number, computed, word)).map("".join),
        st.tuples(word, equals, number, gap, unit).map(lambda parts: "{}{}{}{}({})".format(*parts)),
    )
    return draw(blank).join(["SUB", draw(word), *draw(st.lists(parameter, max_size=4))])


def line(*parts):
    """Draw parts with spaces between them."""
    strategies = [st.just(part) if isinstance(part, str) else part for part in parts]
    return st.tuples(blank, st.tuples(*strategies)).map(lambda drawn: drawn[0].join(drawn[1]).strip())


state = st.sampled_from(["ON", "off"])
values = st.lists(value, min_size=1, max_size=7).map(" ".join)
let = st.tuples(st.sampled_from(["LET", "let"]), blank, word, gap, expression()).map(
    lambda parts: f"{parts[0]}{parts[1]}{parts[2]}{parts[3]}={parts[3]}{parts[4]}"
)
func = st.tuples(
    st.sampled_from(["FUNC", "func"]),
    blank,
    word,
    gap,
    st.lists(
        st.tuples(word, st.one_of(st.just(""), unit.map(lambda one: f" ({one})"))).map("".join),
        min_size=1,
        max_size=3,
    ),
    expression(),
).map(
    lambda parts: (
        f"{parts[0]}{parts[1]}{parts[2]}{parts[3]}({f'{parts[3]},'.join(parts[4])}{parts[3]})={parts[5]}"
    )
)
text = st.sampled_from(['"narrow plate"', '"! no comment"', '""'])
command = st.one_of(
    motion(),
    motion(),
    timed_motion(),
    call(),
    line(index, "STOP"),
    line(index, "HOLD", st.one_of(text, st.just(""))),
    line(index, "SET", name, st.one_of(state, value)),
    line(index, "WAIT", name, state, st.one_of(time, st.just("")), "(s)"),
    line(index, "WAIT", time, "(s)"),
)
held = st.one_of(
    command,
    command,
    let,
    line("FRAME", frame, values, st.one_of(units, st.just("")), frame),
    line("frame_quat", frame, values, frame),
    line("JOINTS", word, values, st.one_of(units, st.just(""))),
)
"""Statements in a block, except for blocks."""
declaration = st.one_of(
    func,
    line("ROBOT", st.one_of(word, st.just('"a/robot.toml"'))),
    line("CELL", '"cell.toml"'),
    line("USE", word),
    line("DEFAULT", frame, time, units, frame),
    line("START", st.one_of(name, values)),
    line("INPUT", word, "M11"),
    line("OUTPUT", word, "M1", st.one_of(state, st.just(""))),
)
block_head = st.one_of(
    line("REPEAT", st.one_of(word, st.just("")), value),
    line("IF", expression()),
    line("WHEN", name, state),
)


@st.composite
def block(draw, depth):
    """Draw the lines of a block."""
    head = draw(block_head)
    lines = [head, *draw(body(depth - 1))]
    if not head.upper().startswith("REPEAT") and draw(st.booleans()):
        lines += [draw(st.sampled_from(["ELSE", "else"])), *draw(body(depth - 1))]
    return [*lines, draw(st.sampled_from(["END", "end"]))]


@st.composite
def body(draw, depth):
    """Draw lines that may be in a block."""
    lines = []
    for _ in range(draw(st.integers(0, 3))):
        lines += draw(block(depth)) if depth > 0 and draw(st.booleans()) else [draw(held)]
    return lines


@st.composite
def module(draw):
    """Draw a whole file, with comments, empty lines and irregular indentation."""
    lines = []
    for _ in range(draw(st.integers(1, 4))):
        kind = draw(st.sampled_from(["declaration", "sub", "block", "line"]))
        if kind == "declaration":
            lines.append(draw(declaration))
        elif kind == "sub":
            lines += [draw(sub_head()), *draw(body(2)), "END"]
        elif kind == "block":
            lines += draw(block(3))
        else:
            lines.append(draw(held))
    ends = st.sampled_from(["", "", "", " ! a remark", "   ", "\n", "\n  ! a line of its own"])
    return "\n".join(draw(gap) + one + draw(ends) for one in lines)


statement = st.one_of(held, held, declaration, sub_head(), block_head, st.sampled_from(["END", "else"]))
"""Any single statement."""
