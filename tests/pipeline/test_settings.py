"""Tests of the settings that the runtime compares with a controller's: they are the proved ones, and a wrong
generator's are refused.
"""

import re
from dataclasses import replace

import pytest

from yarclang.backend_pmac import settings as writer
from yarclang.pipeline.settings import check_settings, items_of, proved_settings, settings_of
from yarclang.runtime.actions import Trouble
from yarclang.source import SourceFile


@pytest.fixture(params=["industrial6", "tracked"])
def robot(request):
    return request.getfixturevalue(request.param)


@pytest.fixture
def wrong_abort(monkeypatch):
    """Make the writer's abort deceleration twice what the joints allow."""
    rate = writer._motor_rate
    monkeypatch.setattr(writer, "_motor_rate", lambda robot, joint_rate: 2.0 * rate(robot, joint_rate))


def test_the_items_are_the_lines_of_the_text(robot):
    """There is one item for each setting that the controller keeps, in the order of the text, except for
    those that programs set.
    """
    text, items = proved_settings(robot), items_of(robot)
    lines = [line.partition(" ;")[0] for line in text.splitlines()]
    asked = [
        f"{item.question}{'' if item.question.endswith('->') else '='}{item.wanted}"
        for item in items
        if item.kind != "listing"
    ]
    kept = [line for line in lines if re.match(r"(#\d+|M\d+)->|I\d+=", line)]
    assert asked == [line for line in kept if not line.startswith(("I16=", "I17="))]
    for item in items:
        if item.kind == "listing":
            assert f"OPEN {item.subject} CLEAR\n{item.wanted}\nCLOSE\n" in text
    assert [item.subject for item in items if item.kind == "listing"] == ["PLC 0", "PLC 29"]
    assert [item.question for item in items if item.kind == "bits"] == ["I5"]
    assert len(items) == 14 * robot.size + 11
    assert "I115, abort deceleration, counts/ms^2, of the joints' stop acceleration" in [
        one.subject for one in items
    ]


def test_a_wrong_generator_is_refused(industrial6, wrong_abort):
    judged = settings_of(industrial6)
    assert judged.value is None
    assert all(one.code == "Y1174" and "robot.toml" in one.help for one in judged.diagnostics)
    with pytest.raises(
        Trouble, match=r"the settings of INDUSTRIAL6 aren't proved: I115=12\.2558: an abort brakes J1"
    ) as found:
        items_of(industrial6)
    assert found.value.code == "Y1174"
    assert "yarc settings INDUSTRIAL6" in found.value.remedy


def test_the_own_text_differs_in_nothing(robot):
    judged = check_settings(SourceFile("mine.txt", proved_settings(robot)), robot)
    assert judged.value is not None
    assert judged.diagnostics == ()


def test_differences_are_told_line_by_line(industrial6):
    own = proved_settings(industrial6)
    edited = own.replace("I113=4340581", "I113=4340582").replace("I16=5 ", "I16=9 ")
    edited = edited.replace("P1=M162/(I108*32)/25532.8278", "P1=M162/25532.8278/(32*I108)")
    edited = edited.replace("#1->25532.8278X", "#1->25532.82780X")
    judged = check_settings(SourceFile("mine.txt", edited), industrial6)
    assert judged.value is not None
    assert {one.code for one in judged.diagnostics} == {"Y1176"}
    assert not any(one.is_error for one in judged.diagnostics)
    assert [one.help for one in judged.diagnostics if "each run refuse" not in one.help] == [
        "this is for other programs: each program of yarcc sets its own"
    ]
    lines = edited.splitlines()
    told = [
        (lines[one.span.line - 1].partition(" ;")[0], one.message.rpartition("prints ")[2])
        for one in judged.diagnostics
    ]
    assert told == [
        ("#1->25532.82780X", "#1->25532.8278X"),
        ("I113=4340582", "I113=4340581"),
        ("I16=9", "I16=5"),
        ("P1=M162/25532.8278/(32*I108)", "P1=M162/(I108*32)/25532.8278"),
    ]


def test_errors_come_alone(industrial6):
    """If there are errors, mere differences aren't reported."""
    edited = proved_settings(industrial6).replace("I113=4340581", "I113=4340582").replace("I42=0", "I42=1")
    judged = check_settings(SourceFile("mine.txt", edited), industrial6)
    assert judged.value is None
    assert [one.code for one in judged.diagnostics] == ["Y1174"]


def test_a_robot_that_no_settings_fit(industrial6):
    """If no settings fit a robot, the generator's findings are reported, even if its file has none."""
    slow = replace(industrial6, controller=replace(industrial6.controller, hold_time=8000.0))
    assert [one.code for one in settings_of(slow).diagnostics] == ["Y1174", "Y1174"]
    with pytest.raises(Trouble, match="a change of the override takes"):
        proved_settings(slow)
