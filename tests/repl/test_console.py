"""Tests of the prompt with pressed keys, and of its toolbar, in real time."""

import asyncio

import pytest
from coordinator.virtual import run
from prompt_toolkit.input import create_pipe_input
from prompt_toolkit.output import DummyOutput
from repl.talking import talking

from yarclang.coordinator.messages.events import Position, ProgressMade
from yarclang.repl import console
from yarclang.repl.interpreter import Interpreter
from yarclang.repl.toolbar import Toolbar
from yarclang.runtime.state import State


class Recorder(Interpreter):
    """An interpreter that only records what is typed."""

    def __init__(self):
        self.got, self.interrupted = [], 0
        self._question = self.jogging = None

    def typed(self, text):
        self.got.append(text)

    def interrupt(self):
        self.interrupted += 1


@pytest.fixture
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    return tmp_path


def press(keys, count=1):
    """Return the texts that the prompt gives for pressed keys."""

    async def session():
        recorder = Recorder()
        with create_pipe_input() as source:
            prompt = console.prompt_session(recorder, None, source, DummyOutput())
            prompt.bottom_toolbar = None
            source.send_text(keys)
            for _ in range(count):
                recorder.typed(await asyncio.wait_for(prompt.prompt_async(), 10))
        return recorder

    return asyncio.run(session())


def test_a_line(home):
    assert press(".where\r").got == [".where"]


def test_a_block_goes_on_to_its_end(home):
    recorder = press("REPEAT 2\rDMOVEJ 1 0 0 0 0 0 [1] (deg,s)\rEND\r")
    assert recorder.got == ["REPEAT 2\nDMOVEJ 1 0 0 0 0 0 [1] (deg,s)\nEND"]


def test_ctrl_c_stops_the_robot_and_empties_the_line(home):
    recorder = press("MOVEJ 1 2\x03.where\r")
    assert recorder.interrupted == 1
    assert recorder.got == [".where"]


def test_ctrl_d_ends(home):
    with pytest.raises(EOFError):
        press("\x04")


def test_lines_are_kept_for_the_next_session(home):
    press(".where\r")
    assert (home / "yarc" / "history").read_text().rstrip().endswith("+.where")
    assert press("\x1b[A\r").got == [".where"]


def test_a_home_that_cannot_be_written_is_no_reason_not_to_work(home, monkeypatch):
    (home / "file").write_text("")
    monkeypatch.setenv("XDG_STATE_HOME", str(home / "file"))
    assert press(".where\r").got == [".where"]


def test_the_line_at_the_bottom(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            robot, picture = person.world.robot, person.interpreter.picture
            toolbar = Toolbar(robot, picture)
            await person.world.until(lambda: picture.joints is not None)
            first, second = toolbar.text(200).split("\n")
            assert first == " INDUSTRIAL6 stop | homed, enabled | 100 %"
            assert second.startswith(" {TCP} 0.00 1174.40 1764.00 mm | J1 0.00 | J2 0.00")
            assert all(len(line) <= 30 for line in toolbar.text(30).split("\n"))
            # seven columns are shown: all joints, and x
            assert toolbar.text(80).split("\n")[1].count(" 0.00") == 7
            await person.begin("MOVEJ 40 0 0 0 20 0 [5] (deg,s)")
            picture.hear(ProgressMade(time_s=0.0, done_s=1.25, left_s=3.75, command="P0010 MOVEJ", line=1))
            assert "move | P0010 MOVEJ 1.2 s, 3.8 s to go" in toolbar.text(200)
            joints = dict.fromkeys(robot.joint_names, 1.0)
            picture.hear(Position(time_s=0.0, joints=joints, done_s=0.0))
            assert "J6 1.00" in toolbar.text(200)
            for width in range(20, 200):
                assert all(len(line) <= width for line in toolbar.text(width).split("\n"))
            for state, place in ((s, -170.0 - 0.25 * n) for n, s in enumerate(robot.joint_names)):
                joints[state] = place
            picture.hear(Position(time_s=0.0, joints=joints, done_s=0.0))
            command = "P0010(I=2)>P0010 MOVEL_RPY_LSPB"
            picture.hear(ProgressMade(time_s=0.0, done_s=125.0, left_s=375.0, command=command, line=1))
            first, second = toolbar.text(80).split("\n")
            assert first.endswith(" s to go | 100 %")
            assert second.count("-17") == len(robot.joint_names)
            await person.settled()

    run(session())


def test_a_lost_connection_is_shown(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            person.world.unplug()
            await person.world.until(lambda: person.coordinator.state is State.DISCONNECTED)
            assert "disconnected | not ready" in Toolbar(person.world.robot, person.interpreter.picture).text(
                200
            )
            assert "disconnected" in person.taken()
            assert "no connection" in await person.type("MOVEJ 10 0 0 0 20 0 [1] (deg,s)")
            person.world.plug()
            await person.world.until(lambda: person.coordinator.state is State.STOP)
            assert "done" in await person.type("MOVEJ 10 0 0 0 20 0 [1] (deg,s)")

    run(session())
