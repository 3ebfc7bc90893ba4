"""Build the reference of a module of the robot language from its comments.

The comment at the top of the file describes the module. The comment directly above a SUB describes the SUB.
In the comment of a SUB, each indented line describes one parameter. It begins with the parameter's name and
unit as in the SUB's head, followed by two blanks. An indented line that begins with CALL is an example:

    ! Retracts straight along the tool's z axis.
    !   {TOOL}  tool that is moved
    !   DISTANCE (mm)  length of the straight line
    !   CALL APPROACH.OUT {GRIPPER} 100
    SUB OUT {TOOL} DISTANCE (mm)
"""

from __future__ import annotations

import re
from pathlib import PurePath
from textwrap import wrap

from yarclang.frozen import frozen
from yarclang.syntax.ast import FrameName, Module, Parameter, Statement, Value

WIDTH = 96
"""Width of the text in columns."""


@frozen
class ParameterText:
    """Description of a parameter of a SUB.

    Attributes:
        name: name as in the SUB's first line, such as `{AT}` or `T (s)`.
        meaning: description from the comment.
        default: its value if a CALL gives none; empty without a default.
    """

    name: str
    meaning: str
    default: str = ""

    @property
    def word(self) -> str:
        """Return the name without braces and unit, as a CALL writes it before the argument."""
        return self.name.partition(" (")[0].strip("{}")

    @property
    def written(self) -> str:
        """Return the parameter as it is written in the head, with its default."""
        word, bracket, unit = self.name.partition(" (")
        return f"{word}={self.default}{bracket}{unit}" if self.default else self.name


@frozen
class SubText:
    """Description of a SUB.

    Attributes:
        name: name of the SUB.
        purpose: text of its comment.
        parameters: parameters in its first line, in order.
        strangers: names that the comment describes as parameters, but that aren't parameters of the SUB.
        example: a call.
    """

    name: str
    purpose: str
    parameters: tuple[ParameterText, ...]
    strangers: tuple[str, ...]
    example: str

    @property
    def head(self) -> str:
        """Name and parameters, as in the SUB's first line."""
        return " ".join((self.name, *(one.written for one in self.parameters)))


@frozen
class FunctionText:
    """Description of a FUNC.

    Attributes:
        name: name of the FUNC.
        purpose: text of its comment.
        parameters: parameters as in its first line, such as `A` or `H (mm)`.
    """

    name: str
    purpose: str
    parameters: tuple[str, ...]

    @property
    def head(self) -> str:
        """Name and parameters as they are written in a use."""
        return f"{self.name}({', '.join(self.parameters)})"


@frozen
class ModuleText:
    """Description of a module of the robot language.

    Attributes:
        name: name of the module.
        paragraphs: text of the comment at the top of its file.
        subs: its SUBs.
        functions: its FUNCs.
    """

    name: str
    paragraphs: tuple[str, ...]
    subs: tuple[SubText, ...]
    functions: tuple[FunctionText, ...] = ()

    @property
    def title(self) -> str:
        """First sentence of the module's description; empty without one."""
        return re.split(r"(?<=\.)\s", self.paragraphs[0], maxsplit=1)[0] if self.paragraphs else ""


def describe_module(module: Module) -> ModuleText:
    """Return the description of a module from its comments and the heads of its SUBs."""
    name = PurePath(module.source.name).stem.upper()
    comments = {line: re.sub(r"^!+ ?", "", text).rstrip() for line, text in module.comment_lines}
    subs, functions = (
        [
            statement
            for statement in module.statements
            if statement.index is None and statement.name.name == word
        ]
        for word in ("SUB", "FUNC")
    )
    first = min(comments, default=0)
    above_all = min((statement.line for statement in module.statements), default=first + 1)
    top: list[str] = []
    if first and first < above_all:
        top = _downwards(comments, first)
        # a comment directly above the first SUB or FUNC describes this SUB or FUNC, not the module
        if first + len(top) in {statement.line for statement in (*subs, *functions)}:
            top = []
    return ModuleText(
        name,
        _paragraphs(top),
        tuple(_sub(statement, comments, name) for statement in subs),
        tuple(_function(statement, comments) for statement in functions),
    )


def module_listing(modules: list[ModuleText]) -> str:
    """Return one line for each module."""
    width = max((len(one.name) for one in modules), default=0) + 2
    return "\n".join(
        f"{one.name:{width}}{one.title or '(no comment says what it is for)'}" for one in modules
    )


def module_plain(module: ModuleText) -> str:
    """Return the reference of a module as plain text for a terminal."""
    lines = [module.name, ""]
    for paragraph in module.paragraphs:
        lines += [*_wrapped(paragraph, "  "), ""]
    lines += [f"  USE {module.name}", ""]
    for sub in module.subs:
        lines += [*_wrapped(f"{module.name}.{sub.head}", "", "    ")]
        lines += _wrapped(sub.purpose, "  ")
        width = max((len(one.name) for one in sub.parameters), default=0) + 2
        for one in sub.parameters:
            lines += _wrapped(one.meaning, f"    {one.name:{width}}", " " * (4 + width))
        lines += [*_wrapped(f"for example: {sub.example}", "  "), ""]
    for function in module.functions:
        lines += _wrapped(f"{module.name}.{function.head}", "", "    ")
        lines += [*_wrapped(function.purpose, "  "), ""]
    return "\n".join(lines).rstrip()


def module_markdown(module: ModuleText) -> str:
    """Return the reference of a module as Markdown."""
    lines = [f"# {module.name}", ""]
    for paragraph in module.paragraphs:
        lines += [_marked(paragraph), ""]
    lines += ["```", f"USE {module.name}", "```", ""]
    for sub in module.subs:
        lines += [f"## {module.name}.{sub.name}", ""]
        if sub.purpose:
            lines += [_marked(sub.purpose), ""]
        if sub.parameters:
            lines += ["| parameter | meaning |", "|---|---|"]
            lines += [f"| `{one.name}` | {_marked(one.meaning)} |" for one in sub.parameters]
            lines.append("")
        lines += ["```", sub.example, "```", ""]
    for function in module.functions:
        lines += [f"## {module.name}.{function.head}", ""]
        lines += [_marked(function.purpose), ""] if function.purpose else []
    return "\n".join(lines).rstrip()


def _sub(statement: Statement, comments: dict[int, str], module: str) -> SubText:
    values = [value for waypoint in statement.waypoints for value in waypoint.values]
    head = [_head_name(value) for value in values]
    name, operands = (head[0], head[1:]) if head else ("", [])
    purpose, meanings, example = _parts(_upwards(comments, statement.line - 1))
    parameters = tuple(
        ParameterText(one, meanings.get(_plain(one), ""), _default(value))
        for one, value in zip(operands, values[1:], strict=True)
    )
    known = {_plain(one) for one in operands}
    strangers = tuple(one for one in meanings if one not in known)
    # if the comment has no example of a call, use the parameters' names as arguments
    example = example or " ".join(("CALL", f"{module}.{name}", *(one.split(" (")[0] for one in operands)))
    return SubText(name, purpose, parameters, strangers, example)


def _function(statement: Statement, comments: dict[int, str]) -> FunctionText:
    values = [value for waypoint in statement.waypoints for value in waypoint.values]
    head = [_head_name(value) for value in values]
    name, parameters = (head[0], head[1:]) if head else ("", [])
    return FunctionText(name, _parts(_upwards(comments, statement.line - 1))[0], tuple(parameters))


def _head_name(value: Value) -> str:
    """Return a name or parameter in a SUB's first line in standard form: names in upper case, units in
    lower case.
    """
    if isinstance(value, FrameName):
        return f"{{{value.name}}}"
    if isinstance(value, Parameter):
        return f"{value.word.name} ({value.unit.text.lower()})" if value.unit else value.word.name
    return value.text.upper()


def _default(value: Value) -> str:
    """Return the default of a parameter; empty without one."""
    if not isinstance(value, Parameter) or value.default is None:
        return ""
    return value.default.text.upper()


def _parts(lines: list[str]) -> tuple[str, dict[str, str], str]:
    """Return the parts of a SUB's comment: the description, the parameters, the call."""
    purpose: list[str] = []
    meanings: dict[str, str] = {}
    example, last, margin = "", "", 0
    for line in lines:
        text = line.strip()
        indent = len(line) - len(line.lstrip())
        if indent < 2:
            purpose.append(text)
            last = ""
        elif re.match(r"CALL\s", text, re.IGNORECASE):
            example, last = text, ""
        elif last and indent > margin:
            meanings[last] = f"{meanings[last]} {text}"
        else:
            word, _, meaning = text.partition("  ")
            last, margin = _plain(word), indent
            meanings[last] = meaning.strip()
    return " ".join(purpose).strip(), meanings, example


def _plain(parameter: str) -> str:
    """Return a parameter in a form in which different spellings are equal, such as `t(S)` and `T (s)`."""
    word, bracket, unit = parameter.partition("(")
    return f"{word.strip().upper()} ({unit.rstrip(') ').lower()})" if bracket else word.strip().upper()


def _downwards(comments: dict[int, str], line: int) -> list[str]:
    """Return the comment that begins in a line."""
    found = []
    while line in comments:
        found.append(comments[line])
        line += 1
    return found


def _upwards(comments: dict[int, str], line: int) -> list[str]:
    """Return the comment that ends in a line."""
    found = []
    while line in comments:
        found.append(comments[line])
        line -= 1
    return found[::-1]


def _paragraphs(lines: list[str]) -> tuple[str, ...]:
    """Join lines to paragraphs, which are separated by empty lines."""
    blocks = "\n".join(line.strip() for line in lines).split("\n\n")
    return tuple(" ".join(block.split()) for block in blocks if block.strip())


def _marked(text: str) -> str:
    """Escape a text for Markdown."""
    return re.sub(r"([*_|<>`\\])", r"\\\1", text)


def _wrapped(text: str, first: str, following: str | None = None) -> list[str]:
    return wrap(
        text,
        WIDTH,
        initial_indent=first,
        subsequent_indent=first if following is None else following,
        break_long_words=False,
        break_on_hyphens=False,
    ) or ([first.rstrip()] if first.strip() else [])
