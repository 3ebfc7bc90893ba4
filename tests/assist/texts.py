"""Texts with a mark where a person types, and the views of them that the assistant uses."""

from functools import cache
from pathlib import Path

from yarclang.assist.sketch import Sketch, sketch_of
from yarclang.assist.view import View
from yarclang.pipeline.checking import check_text
from yarclang.pipeline.inputs import Options
from yarclang.pipeline.modules import loader
from yarclang.robot.description import load_robot
from yarclang.source import SourceFile

MARK = "|"
HEAD = "ROBOT INDUSTRIAL6\nDEFAULT {TCP} [50%] (mm,deg,s) {B}\n"
EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def marked(text: str) -> tuple[str, int, int]:
    """Return the text without the mark, and the mark's line and column, both from 1."""
    before, mark, behind = text.partition(MARK)
    assert mark
    return before + behind, before.count("\n") + 1, len(before.rpartition("\n")[2]) + 1


@cache
def robot():
    return load_robot("INDUSTRIAL6").value


def modules(folder: Path):
    load = loader(folder)
    known: dict[str, Sketch | None] = {}

    def find(name: str) -> Sketch | None:
        if name not in known:
            module = load(name).value
            known[name] = sketch_of(module.source) if module else None
        return known[name]

    return find


LIBRARY = modules(EXAMPLES)


def looked_at(text: str, name: str = "test.yarc") -> View:
    """Return the view of a text that hasn't been checked."""
    return View(sketch_of(SourceFile(name, text)), None, robot(), LIBRARY)


def checked(text: str, folder: Path = EXAMPLES, *, plans: bool = False) -> View:
    """Return the view of a text with all findings of the pipeline."""
    source = SourceFile(str(folder / "test.yarc"), text)
    found = check_text(source, folder, Options(), plans=plans)
    return View(sketch_of(source), found, robot(), LIBRARY)
