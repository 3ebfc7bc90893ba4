"""Converting texts in tests, and what the program that comes out of it says."""

import numpy as np
from programs import checked, codes

from yarclang.convert.convert import convert
from yarclang.convert.course import Wishes
from yarclang.robot.description import load_robot
from yarclang.source import SourceFile
from yarclang.units import UNITS

NAMES = "j1,j2,j3,j4,j5,j6"


def units(text):
    return {UNITS[word].kind: UNITS[word] for word in text.split(",")} if text else {}


def converted(text, name="points.csv", robot="INDUSTRIAL6", said="", **wishes):
    """The program's text (None where an error forbids one) and the findings."""
    result = convert(SourceFile(name, text), load_robot(robot).value, Wishes(units=units(said), **wishes))
    return result.value, result.diagnostics


def program_of(text, name="points.csv", robot="INDUSTRIAL6", said="", **wishes):
    """The program's text, which has no error."""
    program, found = converted(text, name, robot, said, **wishes)
    assert codes(found) == []
    assert [one for one in checked(program, robot=robot)[1] if one.is_error] == []
    return program


def refused(text, name="points.csv", robot="INDUSTRIAL6", said="", **wishes):
    """The only finding, an error."""
    program, found = converted(text, name, robot, said, **wishes)
    assert program is None
    assert [one.is_error for one in found] == [True]
    return found[0]


def numbers(program):
    """All rows of numbers in a program's START and motions, without comments: (w, n)."""
    rows = []
    for line in program.splitlines():
        code = line.partition("!")[0].partition("[")[0]
        words = code.replace(";", " ").split()
        values = [float(word) for word in words if word.replace(".", "").replace("-", "").isdigit()]
        if values and not code.startswith("DEFAULT"):
            rows.append(values)
    return np.array(rows)


def commands(program):
    """The words of the commands, in their order."""
    return [line.split()[1] for line in program.splitlines() if line[:1] == "P"]
