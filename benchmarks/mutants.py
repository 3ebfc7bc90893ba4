"""Put errors into the code, one at a time, and find out what detects them: `python benchmarks/mutants.py
[--count 200] [--seed 0]`, in an environment with yarclang and its tests.

Each mutant changes one expression: a sign, an offset by one, a dropped term, exchanged limits, another axis,
another unit. A forked process imports the package again, with the changed module in place of its file, and
compiles the programs of `mutant_corpus.py`. Some of these must be written; others, which are one step beyond
these, must be refused. If a mutant certifies a text that differs in any byte from the text without the
change, the unchanged code judges this text, with the claims computed again. Then the tests that import the
changed module are run, or those of its package if there are none. Each mutant gets a verdict:

- `certificate`: no wrong text was written, because a program was refused or the compiler stopped;
- `wrong`: the mutant certified a text that the unchanged code refuses, so a wrong text is written;
- `tests`: the certificate didn't detect the mutant, but the tests did;
- `same`: all texts are the same to the byte, and no test fails;
- `survives`: other texts are certified, the unchanged judge accepts them too, and no test fails;
- `open`: the tests weren't run, or took too long.

Results are added to a file, line by line, and aren't computed again. So a run may be stopped, and a later run
may try the tests of mutants that are `open`. REASONS of `mutant_knowledge.py` gives the reasons for the
verdicts `wrong`, `same` and `survives`.
"""

from __future__ import annotations

import argparse
import ast
import contextlib
import importlib.abc
import importlib.util
import json
import os
import pickle
import random
import re
import select
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.machinery import ModuleSpec
from pathlib import Path
from types import ModuleType
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

from mutant_corpus import Case, cases, write  # after the threads are set: numpy comes with it
from mutant_knowledge import ALSO, REASONS, TESTS

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "yarclang"
PLACES = (
    "motion",
    "backend_pmac",
    "robot/kinematics",
    "robot/actuation.py",
    "robot/chain.py",
    "robot/dynamics.py",
    "robot/masses.py",
    "robot/placements.py",
    "transforms.py",
    "certify",
    "collision",
    "runtime/pmac",
)
LONGEST = 60.0
"""Time after which a mutant that compiles, or whose texts are judged, is stopped and counts as detected
[s].
"""
LONGEST_TESTS = 240.0
"""Time after which tests are stopped without a result [s]."""


@dataclass(frozen=True, slots=True)
class Mutation:
    """A change: the file of the package, the node's number in the tree's walk, the kind, the line, the
    expression before and after, and its index among equal ones.
    """

    file: str
    node: int
    kind: str
    line: int
    was: str
    becomes: str
    which: int

    @property
    def key(self) -> str:
        """Return the name in results. It doesn't contain the line number, because edits above the line change
        this number.
        """
        return f"{self.file} {self.kind}: {self.was[:60]} -> {self.becomes[:60]} ({self.which})"


def changed(node: ast.AST, kind: str) -> ast.AST | None:
    """Return the changed node, or None if a change of this kind doesn't apply to it."""
    match kind, node:
        case "sign", ast.BinOp(op=ast.Add()):
            return ast.BinOp(node.left, ast.Sub(), node.right)
        case "sign", ast.BinOp(op=ast.Sub()):
            return ast.BinOp(node.left, ast.Add(), node.right)
        case "sign", ast.UnaryOp(op=ast.USub()):
            return node.operand
        case "off by one", ast.Constant(value=int() as value) if not isinstance(value, bool):
            return ast.Constant(value + 1)
        case "dropped term", ast.BinOp(op=ast.Add() | ast.Sub()):
            return node.left
        case "dropped term", ast.BinOp(op=ast.Mult()):
            return node.left
        case "exchanged limits", ast.Attribute(attr="lower" | "upper"):
            return ast.Attribute(node.value, "upper" if node.attr == "lower" else "lower", node.ctx)
        case "exchanged limits", ast.Attribute(value=ast.Name(id="np"), attr="minimum" | "maximum"):
            return ast.Attribute(node.value, "maximum" if node.attr == "minimum" else "minimum", node.ctx)
        case "exchanged limits", ast.Compare(ops=[ast.Lt() | ast.Gt() | ast.LtE() | ast.GtE() as one]):
            other = {ast.Lt: ast.GtE, ast.Gt: ast.LtE, ast.LtE: ast.Gt, ast.GtE: ast.Lt}[type(one)]
            return ast.Compare(node.left, [other()], node.comparators)
        case "wrong axis", ast.Subscript(slice=ast.Constant(value=int() as axis)) if axis in range(3):
            return ast.Subscript(node.value, ast.Constant((axis + 1) % 3), node.ctx)
        case "wrong unit", ast.Name(id="MM" | "DEG" | "MS"):
            return ast.Constant(1.0)
        case "wrong unit", ast.Constant(value=float() as value) if value not in (0.0, 1.0):
            return ast.Constant(value * 1.001)
    return None


KINDS = ("sign", "off by one", "dropped term", "exchanged limits", "wrong axis", "wrong unit")


def mutations() -> Iterator[Mutation]:
    """Yield all possible changes."""
    for place in PLACES:
        path = PACKAGE / place
        for file in [path] if path.is_file() else sorted(path.rglob("*.py")):
            text = file.read_text()
            alike: Counter[tuple[str, str, str]] = Counter()
            in_annotations = set(_idle(ast.parse(text)))
            for number, node in enumerate(ast.walk(ast.parse(text))):
                if number in in_annotations:
                    continue
                for kind in KINDS:
                    new = changed(node, kind)
                    if new is not None and ast.unparse(new) != ast.unparse(node):
                        line = node.lineno  # type: ignore[attr-defined]  # an expression
                        name = str(file.relative_to(PACKAGE))
                        was, becomes = ast.unparse(node), ast.unparse(new)
                        alike[kind, was, becomes] += 1
                        yield Mutation(name, number, kind, line, was, becomes, alike[kind, was, becomes])


def _idle(tree: ast.Module) -> Iterator[int]:
    """Yield the numbers of nodes whose values aren't computed: those in annotations, and targets of
    assignments.
    """
    numbers = {id(node): number for number, node in enumerate(ast.walk(tree))}
    for node in ast.walk(tree):
        parts = [getattr(node, name, None) for name in ("annotation", "returns")]
        if isinstance(node, ast.Assign):
            parts += node.targets
        for part in parts:
            if isinstance(part, ast.AST):
                yield from (numbers[id(inner)] for inner in ast.walk(part))


def applied(mutation: Mutation, text: str) -> str:
    """Return a module's text with the change."""
    tree = ast.parse(text)
    target = list(ast.walk(tree))[mutation.node]

    class _Change(ast.NodeTransformer):
        def visit(self, node: ast.AST) -> ast.AST:
            if node is target:
                new = changed(node, mutation.kind)
                assert new is not None
                return ast.copy_location(new, node)
            return self.generic_visit(node)

    return ast.unparse(ast.fix_missing_locations(_Change().visit(tree))) + "\n"


class Changed(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Importer that gives one module of the package another text. All other modules are imported as usual."""

    def __init__(self, mutation: Mutation) -> None:
        self._path = PACKAGE / mutation.file
        parts = ("yarclang", *Path(mutation.file).with_suffix("").parts)
        self._module = ".".join(part for part in parts if part != "__init__")
        self._text = applied(mutation, self._path.read_text())

    def find_spec(self, name: str, _path: object, _target: object = None) -> ModuleSpec | None:
        """Return a spec for the changed module only."""
        if name != self._module:
            return None
        package = self._path.name == "__init__.py"
        return importlib.util.spec_from_file_location(
            name,
            self._path,
            loader=self,
            submodule_search_locations=[str(self._path.parent)] if package else None,
        )

    def exec_module(self, module: ModuleType) -> None:
        """Execute the changed text."""
        exec(compile(self._text, str(self._path), "exec"), module.__dict__)


def apart(work: Callable[[], Any], longest: float) -> tuple[bool, Any]:
    """Run a function in a forked process. Return True if it has finished, and its result."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.setsid()
        os.close(reading)
        status = 1
        try:
            nothing = os.open(os.devnull, os.O_RDWR)
            for stream in (0, 1, 2):
                os.dup2(nothing, stream)
            made = pickle.dumps(work())
            with os.fdopen(writing, "wb") as out:
                out.write(made)
            status = 0
        finally:
            os._exit(status)
    os.close(writing)
    got = b""
    ends = time.monotonic() + longest
    with os.fdopen(reading, "rb", buffering=0) as told:
        while (left := ends - time.monotonic()) > 0.0:
            if not select.select([told], [], [], left)[0]:
                break
            part = told.read(1 << 16)
            if not part:
                break
            got += part
    with contextlib.suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)  # with the processes that it has started
    os.waitpid(child, 0)
    return (True, pickle.loads(got)) if got else (False, None)


def with_change(mutation: Mutation) -> None:
    """Remove the package from memory, so that the next import uses the changed module."""
    for name in [name for name in sys.modules if name.split(".")[0] == "yarclang"]:
        del sys.modules[name]
    sys.meta_path.insert(0, Changed(mutation))


def compiled(folder: Path) -> dict[str, str | None]:
    """Return the texts of all programs by name; None for refused ones."""
    import yarclang

    found: dict[str, str | None] = {}
    for case in cases():
        try:
            made = yarclang.compile(case.text, **place_of(case, folder))
            found[case.name] = made.value.text if made.ok and made.value is not None else None
        except Exception:
            found[case.name] = None
    return found


def refused(texts: dict[str, str], folder: Path) -> list[str]:
    """Return the texts that the judge refuses, with the findings' codes."""
    import yarclang

    seen = []
    for case in cases():
        if case.name in texts:
            judged = yarclang.prove(texts[case.name], case.text, **place_of(case, folder))
            codes = sorted({one.code for one in judged.diagnostics if one.severity == "error"})
            if codes or not judged.ok:
                seen.append(f"{case.name} ({' '.join(codes)})")
    return seen


def place_of(case: Case, folder: Path) -> dict[str, Any]:
    """Return the robot, cell and folder with which a program is compiled."""
    robot = str(folder / case.robot) if "/" in case.robot else case.robot
    cell = str(folder / case.cell) if case.cell else None
    return {"robot": robot, "name": case.name, "folder": folder, "cell": cell}


def by_certificate(mutation: Mutation, plain: dict[str, str | None], folder: Path) -> tuple[str, str]:
    """Return the verdict on a mutant before any test, and its reason."""

    def work() -> dict[str, str | None]:
        with_change(mutation)
        return compiled(folder)

    ended, texts = apart(work, LONGEST)
    if not ended:
        return "certificate", "nothing is written: the compiler stops"
    other = {name: text for name, text in texts.items() if text is not None and text != plain[name]}
    if other:
        ended, wrong = apart(lambda: refused(other, folder), LONGEST)
        if not ended or wrong:
            return "wrong", f"written and wrong: {', '.join(wrong or other)}"
    lost = [name for name, text in plain.items() if text is not None and texts[name] is None]
    if lost:
        return "certificate", f"not written: {', '.join(lost)}"
    return "open", f"other texts, which hold: {', '.join(other)}" if other else ""


def by_tests(mutation: Mutation, files: list[str]) -> tuple[str, str]:
    """Return the verdict of the tests on a mutant, and its reason."""

    def work() -> int:
        import pytest

        os.chdir(ROOT)
        sys.path.insert(0, str(ROOT / "tests"))
        with_change(mutation)
        return int(pytest.main(["-q", "-x", "-p", "no:cacheprovider", "-p", "no:xdist", *files]))

    ended, status = apart(work, LONGEST_TESTS)
    if not ended:
        return "open", "its tests take too long"
    return ("tests", " ".join(files)) if status else ("", "")


def tests_of(file: str) -> list[str]:
    """Return the tests that import a module, or else those of its package; and those in ALSO."""
    module = ".".join(Path(file).with_suffix("").parts)
    inside, name = module.rpartition(".")[::2]
    pattern = re.compile(
        rf"^(from yarclang\.{re.escape(module)} import|import yarclang\.{re.escape(module)}\b"
        rf"|from yarclang\.{re.escape(inside)} import [^\n]*\b{name}\b)",
        re.MULTILINE,
    )
    found = [
        str(path.relative_to(ROOT))
        for path in sorted((ROOT / "tests").rglob("test_*.py"))
        if pattern.search(path.read_text())
    ]
    also = [name for start, names in ALSO.items() if file.startswith(start) for name in names]
    return [*dict.fromkeys((*also, *(found or TESTS[file.split("/", maxsplit=1)[0]])))]


def chosen(count: int, seed: int) -> list[Mutation]:
    """Draw mutations: the same number from each package, and there from each kind."""
    groups: dict[tuple[str, str], list[Mutation]] = {}
    for one in mutations():
        groups.setdefault((one.file.split("/")[0], one.kind), []).append(one)
    rng = random.Random(seed)
    for group in groups.values():
        rng.shuffle(group)
    drawn: list[Mutation] = []
    while len(drawn) < count and any(groups.values()):
        drawn += [group.pop() for group in groups.values() if group][: count - len(drawn)]
    return drawn


def main() -> None:
    """Judge the mutants, add a line for each to the results, and count the verdicts."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--no-tests", action="store_true", help="ask only the certificate")
    parser.add_argument("--only", default="", help="files that begin so")
    parser.add_argument("--results", type=Path, default=Path("mutants.jsonl"), help="file of results")
    parser.add_argument("--again", action="store_true", help="ask the certificate again of what it has seen")
    given = parser.parse_args()
    drawn = [one for one in chosen(given.count, given.seed) if one.file.startswith(given.only)]
    known: dict[str, dict[str, str]] = {}
    if given.results.exists() and not given.again:
        known = {one["key"]: one for one in map(json.loads, given.results.read_text().splitlines())}
    with tempfile.TemporaryDirectory(prefix="mutant-") as made, given.results.open("a") as out:
        folder = Path(made)
        write(folder)
        os.environ["YARCLANG_LOCKS"] = folder.name
        plain = compiled(folder)
        for case in cases():
            if (plain[case.name] is None) != (case.refused is not None):
                raise SystemExit(f"{case.name} isn't what it must be without a change")
        for one in drawn:
            row = known.get(one.key)
            if row is not None and (row["seen"] != "open" or given.no_tests):
                continue
            if row is None:
                seen, what = by_certificate(one, plain, folder)
                row = {"key": one.key, "seen": seen, "what": what}
            if row["seen"] == "open" and not given.no_tests:
                seen, what = by_tests(one, tests_of(one.file))
                row = {
                    "key": one.key,
                    "seen": seen or ("survives" if row["what"] else "same"),
                    "what": what or row["what"],
                }
            known[one.key] = row
            out.write(json.dumps(row) + "\n")
            out.flush()
            print(f"{row['seen']:11}  {one.key}  {row['what']}".rstrip(), flush=True)
    rows = [known[one.key] for one in drawn if one.key in known]
    counted = Counter(row["seen"] for row in rows)
    print(f"{len(rows)} mutants: {', '.join(f'{seen} {count}' for seen, count in sorted(counted.items()))}")
    for row in rows:
        if row["seen"] in {"wrong", "same", "survives"}:
            print(f"{row['seen']:9} {row['key']}: {REASONS.get(row['key'], 'NO REASON')}")


if __name__ == "__main__":
    main()
