"""Tests of the stage and the figures of a running robot, made from the messages of its coordinator."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from view.stages import EXAMPLES

from yarclang.coordinator.describing import joints_by_name
from yarclang.coordinator.messages import events, replies
from yarclang.pipeline.cells import cell_loader
from yarclang.robot.description import load_robot
from yarclang.runtime.state import State
from yarclang.view.of_live import Live, stage_of_live

Q = np.deg2rad([10.0, -20.0, 5.0, 0.0, 30.0, 0.0])


@cache
def robot_of(name="INDUSTRIAL6"):
    return load_robot(name).value


@cache
def cell_of(name):
    return cell_loader(EXAMPLES, robot_of()).at(Path(EXAMPLES / name)).value


def status(robot, q=None, **fields):
    places = [None] * robot.size if q is None else (q / robot.axis_units).tolist()
    joints = tuple(
        replies.Joint(name=name, position=place, unit=unit)
        for name, place, unit in zip(robot.joint_names, places, robot.axis_unit_names, strict=True)
    )
    known = {
        "program": "serve",
        "robot": robot.name,
        "controller": "127.0.0.1:1025",
        "state": State.STOP,
        "why": "",
        "command": None,
        "done": 0.0,
        "left": 0.0,
        "override": 100.0,
        "joints": joints,
        "waiting": 0,
        "pid": 1,
        "since": "",
    }
    return replies.Status(**{**known, **fields})


def test_robot_cell_and_parts_stand_where_they_are():
    stage = stage_of_live(robot_of(), cell_of("05_pick_and_place.toml"), Q, subtitle="simulated")
    kinds = {item.kind for item in stage.items}
    assert {"robot", "obstacle", "part"} <= kinds
    assert stage.track.at(np.zeros(2))[0][1] == pytest.approx(Q)
    assert not [note for note in stage.notes if "without the program" in note]
    (part,) = [item for item in stage.items if item.kind == "part"]
    placed = cell_of("05_pick_and_place.toml").parts[0].body.mount.transform
    assert part.base_from_item == pytest.approx(placed)


def test_a_robot_without_a_cell():
    stage = stage_of_live(robot_of("TRACKED_MANIPULATOR"), None, robot_of("TRACKED_MANIPULATOR").home)
    assert {item.kind for item in stage.items} <= {"robot", "tool"}
    assert stage.notes == ()


def test_what_is_told_becomes_figures():
    robot = robot_of()
    live = Live(robot, status(robot, Q))
    stage = stage_of_live(robot, None, Q)
    assert live.joints == pytest.approx(Q)
    assert "runs" not in live.html(stage, Q)
    live.hear(events.Began(time_s=0.0, name="<b>a</b>.yarc", duration_s=9.0, waits=0, client="run"))
    live.hear(events.StateChanged(time_s=0.1, state=State.MOVE, why=""))
    live.hear(events.OwnerChanged(time_s=0.1, owner="run"))
    live.hear(events.OverrideChanged(time_s=0.1, percent=25.0))
    live.hear(events.ProgressMade(time_s=0.2, done_s=1.25, left_s=7.75, command="P0010 MOVEL", line=7))
    live.hear(events.Position(time_s=0.2, joints=joints_by_name(robot, 2.0 * Q), done_s=0.2))
    html = live.html(stage, live.joints)
    for text in (
        "move",
        "&lt;b&gt;a&lt;/b&gt;.yarc",
        "P0010 MOVEL, line 7",
        "1.2 s done, 7.8 s left",
        "25 %",
        "20.00 -40.00",
    ):
        assert text in html
    assert "<b>a" not in html
    ended = events.Finished(
        time_s=1.0,
        name="a",
        well=False,
        what="held",
        help=None,
        code=None,
        command=None,
        done_s=1.0,
        joints=None,
    )
    live.hear(ended)
    assert live.said == "a: held"
    assert "runs" not in live.html(stage, Q)


def test_who_comes_in_the_middle_knows_what_runs():
    robot = robot_of()
    told = status(
        robot,
        Q,
        program="a.yarc",
        state=State.MOVE,
        command=replies.Command(title="P0020 MOVEJ", line=9),
        done=2.0,
        left=3.0,
    )
    html = Live(robot, told).html(stage_of_live(robot, None, Q), Q)
    assert "P0020 MOVEJ, line 9" in html
    assert "2.0 s done, 3.0 s left" in html


def test_who_comes_while_it_waits_knows_what_runs():
    robot = robot_of()
    told = status(robot, Q, program="a.yarc", state=State.HOLD, why="P0050 WAIT waits", done=2.0, left=3.0)
    html = Live(robot, told).html(stage_of_live(robot, None, Q), Q)
    assert "a.yarc" in html
    assert "2.0 s done, 3.0 s left" in html
    assert "command" not in html


def test_positions_that_are_not_of_now():
    robot = robot_of()
    live = Live(robot, status(robot))
    assert live.joints is None  # no message with a position has come yet
    live.hear(events.Position(time_s=0.0, joints={"A": 1.0}, done_s=0.0))
    assert live.joints is None  # positions of other joints than the robot's are ignored
    assert live.stale == ""
    live.hear(events.StateChanged(time_s=0.0, state=State.DISCONNECTED, why="the cable is out"))
    assert live.stale == "the cable is out"
