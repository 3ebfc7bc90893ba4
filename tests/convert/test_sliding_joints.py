"""Tests of positions of sliding joints: they become mm, from any unit of length."""

import json
import re
from dataclasses import replace

import pytest
from programs import codes

from tests.convert.conversions import NAMES, numbers, units
from yarclang.convert.convert import convert
from yarclang.convert.course import Wishes
from yarclang.source import SourceFile


@pytest.fixture(scope="module")
def slider(industrial6):
    """Return INDUSTRIAL6 with a first joint that slides upwards."""
    screws = industrial6.chain.screws.copy()
    screws[0] = 0, 0, 1, 0, 0, 0
    return replace(industrial6, chain=replace(industrial6.chain, screws=screws))


def program(robot, name, text, said=""):
    result = convert(SourceFile(name, text), robot, Wishes(units=units(said)))
    assert codes(result.diagnostics) == []
    return result.value.text


def test_a_table(slider):
    text = NAMES.replace("j1", "j1 [m]") + "\n0.25,10,0,0,0,0\n"
    assert numbers(program(slider, "a.csv", text, "deg")).tolist() == [[250, 10, 0, 0, 0, 0]]
    text = f"{NAMES}\n0.25,10,0,0,0,0\n"
    assert numbers(program(slider, "a.csv", text, "cm,deg")).tolist() == [[2.5, 10, 0, 0, 0, 0]]
    found = convert(SourceFile("a.csv", text), slider, Wishes(units=units("deg"))).diagnostics
    assert [(one.code, "unit of j1 is" in one.message) for one in found] == [("Y1506", True)]


def test_an_angle_for_a_length(slider):
    text = NAMES.replace("j1", "j1 [deg]") + "\n1,2,3,4,5,6\n"
    (found,) = convert(SourceFile("a.csv", text), slider, Wishes(units=units("deg"))).diagnostics
    assert (found.code, "deg isn't a unit of length" in found.message) == ("Y1506", True)


def test_a_trajectory(slider):
    points = [{"positions": [q, 0, 0, 0, 0, 0], "time_from_start": {"sec": q}} for q in (0, 1)]
    data = {"joint_names": list(slider.joint_names), "points": points}
    assert numbers(program(slider, "a.json", json.dumps(data)))[:, 0].tolist() == [0, 1000]


def test_a_timetable_is_in_metres(slider):
    points = [
        {"positions": [q / 10, q, 0, 0, 0, 0], "velocities": [v / 10, v, 0, 0, 0, 0], "time_from_start": q}
        for q, v in ((0, 0), (0.5, 1), (1, 0))
    ]
    data = {"joint_names": list(slider.joint_names), "points": points}
    source = SourceFile("a.json", json.dumps(data))
    lines = convert(source, slider, Wishes()).value.text
    assert re.search(r"MOVEJ_TIMED +50 .* VEL 100 ", lines)
    long = {**data, "points": [{**points[1], "time_from_start": 0.1 + 0.1 * n} for n in range(30)]}
    long["points"][-1] = {**points[2], "time_from_start": 9}
    ((_, text),) = convert(SourceFile("a.json", json.dumps(long)), slider, Wishes(beside="a")).value.files
    assert text.startswith("time [s],J1 [m],J2 [rad]")
    assert text.splitlines()[1].startswith("0.1,0.05,0.5")
