"""Errors put into the code, one at a time: `python benchmarks/mutants.py [--count 200] [--seed 0]`, in an environment with yarclang and its tests.

Each mutant is a copy of the package with one change of one expression: a sign, an off by one, a dropped term, exchanged limits, another axis, another unit. In a
process of its own the mutant compiles a few programs; each text that it certifies is judged again by the code without the change, with the claims made anew.
Then the tests that belong to the changed module are run. The table says of each mutant who saw it:

- `certificate`: the mutant wrote none of the programs that are written without it, or stopped, so that nothing reaches a robot;
- `judge`: a text that the mutant certified is refused by the judge without the change;
- `tests`: the certificate saw nothing, the tests did;
- `same`: what is written is the same to the byte, and no test fails;
- `survives`: other texts are certified, hold before the judge without the change too, and no test fails.

A mutant that is certified and refused by the unchanged judge is written and wrong: of these there may be none unless the change is in the judge itself. REASONS says of
known survivors why they stand.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

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
TESTS = {
    "motion": ["tests/motion"],
    "backend_pmac": ["tests/backend_pmac"],
    "robot": ["tests/robot/kinematics", "tests/certify/test_own_kinematics.py"],
    "transforms.py": ["tests/certify/test_own_kinematics.py"],
    "certify": [
        "tests/certify/test_sharp_edges.py",
        "tests/certify/test_exact_bounds.py",
        "tests/certify/test_own_kinematics.py",
        "tests/certify/test_certify_bounds.py",
        "tests/certify/test_certify_violations.py",
        "tests/certify/test_certify_proofs.py",
        "tests/certify/test_certify_torques.py",
        "tests/certify/test_forged.py",
    ],
    "collision": ["tests/collision"],
    "runtime": ["tests/runtime"],
}
LONGEST = 900.0
"""A mutant that takes longer than this [s] is stopped, and counts as seen."""
REASONS: dict[str, str] = {}
"""Of survivors, by `file:line kind`, why they stand."""

PROGRAM = """DEFAULT {TCP} (mm,deg,s) {B}
P0010 MOVEJ_RPY 0 1174.4 1276 0 0 0 [9]
P0020 MOVEL 200 1074.4 1326 10 -5 20 [4] BLEND 10
P0030 DMOVE 0 0 -50 0 0 15 [2]
P0040 DMOVE 0 60 0 0 0 0 [2] {TCP}
P0050 MOVEJ_SPLINE 10 -5 -20 10 20 30; 0 0 -30 0 20 0; HOME [12]
P0060 MOVEJ_LSPB 20 10 -20 0 10 0 [MIN]
"""
CHILD = r"""
import json, sys
from pathlib import Path
import yarclang
folder = Path(sys.argv[1])
found = {}
for name, text, cell in json.loads(Path(sys.argv[2]).read_text()):
    try:
        made = yarclang.compile(text, robot="INDUSTRIAL6", name=name, folder=folder, cell=cell)
        found[name] = made.value.text if made.ok else None
    except BaseException as error:
        found[name] = None
(folder / "found.json").write_text(json.dumps(found))
"""
JUDGE = r"""
import json, sys
from pathlib import Path
import yarclang
folder = Path(sys.argv[1])
texts = json.loads((folder / "found.json").read_text())
seen = []
for name, text, cell in json.loads(Path(sys.argv[2]).read_text()):
    if texts.get(name) is not None:
        judged = yarclang.prove(texts[name], text, robot="INDUSTRIAL6", name=name, folder=folder, cell=cell)
        if not judged.ok:
            seen.append([name, *sorted({one.code for one in judged.diagnostics if one.severity == "error"})])
(folder / "judged.json").write_text(json.dumps(seen))
"""
CELL = """units = "mm,deg,s"
[[obstacles]]
name = "POST"
shape = "box"
frame = "B"
xyz = [-800, 680, 1764]
size = [200, 200, 200]
rpy = [0, 0, 10]
margin = 5

[[zones]]
name = "FLOOR"
rule = "allowed"
shape = "half-space"
frame = "B"
normal = [0, 0, 1]
xyz = [0, 0, 50]

[[zones]]
name = "NEAR"
rule = "slow"
shape = "box"
frame = "B"
xyz = [0, 1100, 1250]
size = [700, 400, 300]
speed = 500
"""


@dataclass(frozen=True, slots=True)
class Mutation:
    """One change: in a file of the package, the place in the tree's walk, what kind, and how the line reads then."""

    file: str
    node: int
    kind: str
    line: int
    was: str
    becomes: str

    @property
    def name(self) -> str:
        """How tables and REASONS call it."""
        return f"{self.file}:{self.line} {self.kind}"


def changed(node: ast.AST, kind: str) -> ast.AST | None:
    """Return what becomes of a node, or None if a change of this kind isn't one of the node's."""
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
        case "wrong axis", ast.Subscript(slice=ast.Constant(value=0 | 1 | 2 as axis)):
            return ast.Subscript(node.value, ast.Constant((axis + 1) % 3), node.ctx)
        case "wrong unit", ast.Name(id="MM" | "DEG" | "MS"):
            return ast.Constant(1.0)
        case "wrong unit", ast.Constant(value=float() as value) if value not in (0.0, 1.0):
            return ast.Constant(value * 1.001)
    return None


KINDS = ("sign", "off by one", "dropped term", "exchanged limits", "wrong axis", "wrong unit")


def mutations() -> Iterator[Mutation]:
    """Yield all changes that could be made."""
    for place in PLACES:
        path = PACKAGE / place
        for file in [path] if path.is_file() else sorted(path.rglob("*.py")):
            text = file.read_text()
            in_annotations = set(_idle(ast.parse(text)))
            for number, node in enumerate(ast.walk(ast.parse(text))):
                if number in in_annotations:
                    continue
                for kind in KINDS:
                    new = changed(node, kind)
                    if new is not None and ast.unparse(new) != ast.unparse(node):
                        line = node.lineno  # type: ignore[attr-defined]  # an expression
                        name = str(file.relative_to(PACKAGE))
                        yield Mutation(name, number, kind, line, ast.unparse(node), ast.unparse(new))


def _idle(tree: ast.Module) -> Iterator[int]:
    """Yield the numbers of nodes in annotations, and of targets: nothing is computed there."""
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


def run(code: str | list[str], root: Path, folder: Path, *, tests: bool = False) -> int:
    """Run a child with a tree's package, and return its exit status; -1 if it took too long."""
    command = (
        [sys.executable, *code]
        if isinstance(code, list)
        else [sys.executable, "-c", code, str(folder), str(folder / "programs.json")]
    )
    environment = dict(os.environ, PYTHONPATH=str(root), YARCLANG_LOCKS=str(folder), OMP_NUM_THREADS="1")
    try:
        done = subprocess.run(
            command,
            check=False,
            cwd=root if tests else folder,
            env=environment,
            capture_output=True,
            timeout=LONGEST,
        )
    except subprocess.TimeoutExpired:
        return -1
    return done.returncode


def judged(mutation: Mutation, plain: dict[str, str | None], *, tests: bool) -> tuple[str, str]:
    """Return who saw a mutant, and what was seen."""
    with tempfile.TemporaryDirectory(prefix="mutant-") as made:
        folder = Path(made)
        root = folder / "tree"
        root.mkdir()
        shutil.copytree(PACKAGE, root / "yarclang", ignore=shutil.ignore_patterns("__pycache__"))
        for name in ("tests", "stdlib", "examples", "pyproject.toml", "README.md", "docs"):
            (root / name).symlink_to(ROOT / name)
        file = root / "yarclang" / mutation.file
        file.write_text(applied(mutation, file.read_text()))
        write_programs(folder)
        status = run(CHILD, root, folder)
        if status != 0 or not (folder / "found.json").exists():
            return "certificate", "nothing was written: the compiler stops"
        texts = json.loads((folder / "found.json").read_text())
        lost = [name for name, text in plain.items() if text is not None and texts.get(name) is None]
        run(JUDGE, ROOT, folder)
        refused = json.loads((folder / "judged.json").read_text())
        if refused:
            return "judge", f"written and wrong: {refused}"
        if lost:
            return "certificate", f"not written: {', '.join(lost)}"
        if tests:
            own = TESTS[mutation.file.split("/")[0]]
            if (
                run(
                    ["-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", "-p", "no:xdist", *own],
                    root,
                    folder,
                    tests=True,
                )
                != 0
            ):
                return "tests", " ".join(own)
        return ("same", "") if texts == plain else ("survives", "other texts, which hold")


def write_programs(folder: Path) -> None:
    """Write the programs, and the cell, that every mutant compiles."""
    cell = folder / "cell.toml"
    cell.write_text(CELL)
    listing = (ROOT / "examples" / "01_listing4.yarc").read_text()
    programs = [("listing4", listing, None), ("all", PROGRAM, None), ("in a cell", PROGRAM, str(cell))]
    # and one that must not be written
    into = "P0010 MOVEJ 40 0 0 0 0 0 [6] (deg,s)\nP0020 MOVEJ 60 0 0 0 0 0 [6] (deg,s)\n"
    programs.append(("into the post", into, str(cell)))
    (folder / "programs.json").write_text(json.dumps(programs))


def chosen(count: int, seed: int) -> list[Mutation]:
    """Draw mutations: of each room as many as of any other, and there of each kind."""
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
    """Judge the mutants and print a line for each, and how many were seen by whom."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--first", type=int, default=0, help="leave out so many of them")
    parser.add_argument("--no-tests", action="store_true", help="ask only the certificate")
    parser.add_argument("--only", default="", help="files that begin so")
    given = parser.parse_args()
    drawn = [one for one in chosen(given.count, given.seed) if one.file.startswith(given.only)][given.first :]
    with tempfile.TemporaryDirectory(prefix="mutant-") as made:
        write_programs(Path(made))
        run(CHILD, ROOT, Path(made))
        plain = json.loads((Path(made) / "found.json").read_text())
    print(
        f"without a change: {', '.join(name for name, text in plain.items() if text)} are written", flush=True
    )
    counted: dict[str, int] = {}
    for one in drawn:
        seen, what = judged(one, plain, tests=not given.no_tests)
        counted[seen] = counted.get(seen, 0) + 1
        reason = REASONS.get(one.name, "")
        print(
            f"{seen:11}  {one.name}: {one.was[:50]} -> {one.becomes[:50]}  {what} {reason}".rstrip(),
            flush=True,
        )
    print(", ".join(f"{seen} {count}" for seen, count in sorted(counted.items())))


if __name__ == "__main__":
    main()
