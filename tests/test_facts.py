"""Tests that no code extracts facts from sentences: no code searches in a message, and the catalogue says
which findings belong together.
"""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1] / "yarclang"

PROSE = {"message", "help", "remedy", "why_not"}
"""Attributes that hold sentences for people."""

READING = {
    *("capitalize", "casefold", "count", "endswith", "find", "index", "lower", "lstrip", "partition"),
    *("removeprefix", "removesuffix", "replace", "rfind", "rindex", "rpartition", "rsplit", "rstrip"),
    *("split", "splitlines", "startswith", "strip", "title", "translate", "upper"),
}
"""Methods of strings that search or change a text."""

MATCHING = {"findall", "finditer", "fullmatch", "match", "search", "split", "sub", "subn"}
"""Functions of `re`, and methods of its patterns."""

ALLOWED = {
    "diagnostics.py": "a sentence within a longer one loses its full stop",
    "robot/checklist/whole.py": "a remedy within brackets loses its full stop",
    "simulated_cell/script.py": "a remedy becomes a sentence of its own: its first letter",
    "cell/description.py": "a remedy becomes a sentence of its own: its first letter",
}
"""Modules and folders that change sentences, each with the reason why they extract no facts."""

CODE, LENGTH = re.compile(r"Y\d{4}"), 5


def is_prose(node: ast.AST, names: frozenset[str] = frozenset()) -> bool:
    match node:
        case ast.Attribute(attr=attr):
            return attr in PROSE
        case ast.Name(id=name):
            return name in names
    return False


def is_code(node: ast.AST) -> bool:
    return isinstance(node, ast.Attribute) and node.attr == "code"


def named(tree: ast.AST) -> frozenset[str]:
    """Return the names to which only sentences are assigned, such as `text` in `text = one.message`."""
    given: dict[str, bool] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign) and len(node.targets) == 1 and isinstance(node.targets[0], ast.Name):
            name = node.targets[0].id
            given[name] = given.get(name, True) and is_prose(node.value)
    return frozenset(name for name, prose in given.items() if prose)


def read_back(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Yield the line and a description of each expression that looks into a sentence or a code."""
    apart = {
        id(node.value)
        for node in ast.walk(tree)
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Tuple)
    }
    """Nodes that are unpacked into several names, for example the parts of a code."""
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)]
    seen: set[tuple[int, str]] = set()
    for scope in (tree, *functions):
        names = named(scope) if scope is not tree else frozenset()
        for node in ast.walk(scope):
            way = way_of(node, names) if id(node) not in apart else ""
            if way and (node.lineno, way) not in seen:
                seen.add((node.lineno, way))
                yield node.lineno, way


def way_of(node: ast.AST, names: frozenset[str]) -> str:
    """Return a description if a node looks into a sentence or a code, else ""."""
    match node:
        case ast.Call(func=ast.Attribute(value=value, attr=attr)) if attr in READING:
            if is_prose(value, names):
                return f".{attr}() of a sentence"
            if is_code(value):
                return f".{attr}() of a code"
    match node:
        case ast.Call(func=ast.Attribute(attr=attr), args=args) if attr in MATCHING:
            if any(is_prose(one, names) for one in args):
                return f"{attr}() on a sentence"
        case ast.Subscript(value=value, slice=ast.Slice(lower=lower)) if lower is not None:
            if is_prose(value, names) or is_code(value):
                return "a part of a sentence or a code"
        case ast.Subscript(value=value, slice=ast.Slice(upper=ast.Constant(value=int(end)))):
            if is_code(value) and end < LENGTH:
                return "a part of a code"
        case ast.Compare(ops=ops, comparators=right):
            inside = zip(ops, right, strict=True)
            if any(isinstance(op, ast.In | ast.NotIn) and is_prose(one, names) for op, one in inside):
                return "a search in a sentence"
        case ast.BinOp(left=left, op=ast.Add(), right=right) if is_code(left) or is_code(right):
            return "a code in front of something"
        case ast.Tuple(elts=parts) | ast.Set(elts=parts) | ast.List(elts=parts):
            codes = [
                one.value for one in parts if isinstance(one, ast.Constant) and isinstance(one.value, str)
            ]
            if len(codes) == len(parts) > 1 and all(map(CODE.fullmatch, codes)):
                return "a set of codes outside of the catalogue"
    return ""


def allowed(path: str) -> bool:
    return path in ALLOWED or path.split("/", maxsplit=1)[0] in ALLOWED or path.startswith("findings/")


def test_nobody_reads_a_message_back():
    """Programs read `Diagnostic.subject` instead of messages, and `findings/` says which findings belong
    together.
    """
    found = [
        f"{name}:{line}: {way}"
        for path in sorted(PACKAGE.rglob("*.py"))
        if not allowed(name := path.relative_to(PACKAGE).as_posix())
        for line, way in read_back(ast.parse(path.read_bytes()))
    ]
    assert found == []


@pytest.mark.parametrize("name", ALLOWED)
def test_no_exception_is_needless(name: str):
    path = PACKAGE / name
    files = [path] if path.is_file() else sorted(path.rglob("*.py"))
    assert any(list(read_back(ast.parse(file.read_bytes()))) for file in files)


@pytest.mark.parametrize(
    "source",
    [
        'one.message.partition(" ")[2]',
        "_KIND.search(finding.message)",
        "re.match('a', finding.help)",
        "def f(one):\n  said = one.message\n  return said.split()[3]",
        "'a unit' in one.message",
        "one.message[3:at]",
        "one.code[1:3]",
        "one.code + one.message",
        "one.code.startswith(_PLANNED)",
        "one.code[:3] == 'Y01'",
        "_UNKNOWN = frozenset(['Y0205', 'Y0210'])",
        "one.code in ('Y1157', 'Y1158')",
        "trouble.remedy.replace('a', 'b')",
        "file.why_not.split(': ', 1)",
    ],
)
def test_the_rule_sees(source: str):
    assert list(read_back(ast.parse(source)))


@pytest.mark.parametrize(
    "source",
    [
        "one.message == other.message",
        "one.message not in known",
        "f'{one.message}; {more}'",
        "one.message[:400]",
        "one.code[:10]",
        "LOST, MOTOR = 'Y1606', 'Y1602'",
        "one.code == 'Y0104'",
        "text.split()",
        "def f(one):\n  said = one.message\n  said = 'a b'\n  return said.split()",
        "show(one.message)",
        "('Y0101', 'a message')",
    ],
)
def test_the_rule_spares(source: str):
    assert not list(read_back(ast.parse(source)))
