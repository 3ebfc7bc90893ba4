"""Conversions of texts in tests, and readers of the resulting programs."""

from pathlib import Path

import numpy as np
from programs import checked, codes

from yarclang.convert.convert import convert
from yarclang.convert.course import Wishes
from yarclang.hir import TimedMove
from yarclang.pipeline.checking import check_text
from yarclang.pipeline.inputs import Options
from yarclang.robot.description import load_robot
from yarclang.source import SourceFile
from yarclang.units import UNITS

NAMES = "j1,j2,j3,j4,j5,j6"


def units(text):
    return {UNITS[word].kind: UNITS[word] for word in text.split(",")} if text else {}


def converted(text, name="points.csv", robot="INDUSTRIAL6", said="", **wishes):
    """Return the program's text, or None after an error, and the findings."""
    made, found = made_of(text, name, robot, said, **wishes)
    return None if made is None else made.text, found


def made_of(text, name="points.csv", robot="INDUSTRIAL6", said="", **wishes):
    """Return the program with the files beside it, or None after an error, and the findings."""
    result = convert(SourceFile(name, text), load_robot(robot).value, Wishes(units=units(said), **wishes))
    return result.value, result.diagnostics


def program_of(text, name="points.csv", robot="INDUSTRIAL6", said="", **wishes):
    """Return the text of a program that has no error."""
    program, found = converted(text, name, robot, said, **wishes)
    assert codes(found) == []
    assert [one for one in checked(program, robot=robot)[1] if one.is_error] == []
    return program


def refused(text, name="points.csv", robot="INDUSTRIAL6", said="", **wishes):
    """Return the only finding, which must be an error."""
    program, found = converted(text, name, robot, said, **wishes)
    assert program is None
    assert [one.is_error for one in found] == [True]
    return found[0]


def numbers(program):
    """Return all rows of numbers in a program's START and motions, without comments (w, n)."""
    rows = []
    for line in program.splitlines():
        if '"' in line:
            continue
        code = line.partition("!")[0].partition("[")[0].partition("VEL")[0]
        words = code.replace(";", " ").split()
        values = [float(word) for word in words if word.replace(".", "").replace("-", "").isdigit()]
        if values and not code.startswith("DEFAULT"):
            rows.append(values)
    return np.array(rows)


def commands(program):
    """Return the words of the commands, in order."""
    return [line.split()[1] for line in program.splitlines() if line[:1] == "P"]


def timetables(made, robot="INDUSTRIAL6"):
    """Return the timed motions of a program, with the files beside it.

    Each is (times, positions [rad], velocities, accelerations).
    """
    found = []
    folder = Path("/nowhere")
    texts = {folder / name: SourceFile(name, text) for name, text in made.files}
    options = Options(robot=robot, texts=texts)
    checked_ = check_text(SourceFile("made.yarc", made.text), folder, options, plans=False)
    assert [one for one in checked_.diagnostics if one.is_error] == []
    for step in checked_.program.steps:
        if isinstance(step, TimedMove):
            table = step.table
            found.append((table.times, table.positions, table.velocities, table.accelerations))
    return found
