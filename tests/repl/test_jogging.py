"""Tests of jogging with held keys."""

import asyncio

import pytest
from coordinator.virtual import run
from repl.talking import talking

from yarclang.coordinator.messages.wants import MoveJoints, MoveTool
from yarclang.repl.jogging import HELD, Axis, Jogging, axis_of
from yarclang.robot.description import load_robot
from yarclang.runtime.actions import Trouble

ROBOT = load_robot("industrial6").value


def test_a_press_moves_for_a_moment_and_a_held_key_goes_on():
    jogging = Jogging(ROBOT, Axis("joint", 2))
    assert jogging.want(0.0).velocity == {"J3": 0.0}
    jogging.press("+", 1.0)
    assert jogging.want(1.0 + 0.9 * HELD).velocity["J3"] > 0.0
    assert jogging.want(1.0 + 1.1 * HELD).velocity == {"J3": 0.0}
    jogging.press("-", 2.0)
    jogging.press("-", 2.1)
    wanted = jogging.want(2.0 + HELD)
    assert isinstance(wanted, MoveJoints)
    assert wanted.velocity["J3"] < 0.0


@pytest.mark.parametrize("key", ["1", "x", "up", "down", "w", "t", "enter", "?"])
def test_every_other_key_brings_it_to_rest(key):
    jogging = Jogging(ROBOT, Axis("joint", 0))
    jogging.press("+", 1.0)
    jogging.press(key, 1.01)
    assert not jogging.moves(1.01)


def test_keys_choose_axes_and_speeds():
    jogging = Jogging(ROBOT, Axis("joint", 0))
    assert jogging.text.startswith("jog J1 at 6 deg/s")
    jogging.press("z", 0.0)
    assert jogging.text.startswith("jog {TCP} z of {B} at 25 mm/s")
    jogging.press("t", 0.0)
    assert "z of {TCP}" in jogging.text
    jogging.press("b", 0.0)
    assert "b of {TCP} at 3 deg/s" in jogging.text
    jogging.press("-", 0.0)
    wanted = jogging.want(0.0)
    assert isinstance(wanted, MoveTool)
    assert wanted.axes == "tool"
    assert wanted.twist[4] < 0.0
    jogging.press("6", 0.0)
    jogging.press("7", 0.0)  # the robot has no joint 7
    assert jogging.axis == Axis("joint", 5)
    for _ in range(50):
        jogging.press("up", 0.0)
    jogging.press("x", 0.0)
    jogging.press("+", 0.0)
    # the largest speed, however often the key is pressed
    assert jogging.want(0.0).twist[0] == pytest.approx(250.0)
    assert not jogging.ended
    jogging.press("enter", 0.0)
    assert jogging.ended


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("J3 +", (Axis("joint", 2), 1, "{TCP}")),
        ("j3 -", (Axis("joint", 2), -1, "{TCP}")),
        ("J3", (Axis("joint", 2), 1, "{TCP}")),
        ("{TCP} +x", (Axis("base", 0), 1, "{TCP}")),
        ("{tcp} -b tool", (Axis("tool", 4), -1, "{TCP}")),
        ("{TORCH}", (Axis("base", 0), 1, "{TORCH}")),
    ],
)
def test_what_may_stand_behind_jog(text, wanted):
    assert axis_of(ROBOT, text.split()) == wanted


@pytest.mark.parametrize("text", ["", "J9", "J3 up", "{TCP} w", "{TCP} +x sideways", "TCP", "J3 + -"])
def test_what_may_not(text):
    with pytest.raises(Trouble):
        axis_of(ROBOT, text.split())


async def hold(person, key, seconds):
    """Hold a key on a keyboard that repeats it 20 times a second."""
    loop = asyncio.get_running_loop()
    until = loop.time() + seconds
    while loop.time() < until:
        person.interpreter.jogging.press(key, loop.time())
        await asyncio.sleep(0.05)


def test_a_jog_in_virtual_time(tmp_path):
    async def session():
        async with talking(tmp_path, joints=[0, 0, 0, 0, 30, 0]) as person:
            assert "needs a terminal" in await person.type(".jog J1")
            person.interpreter.has_keys = True
            person.interpreter.typed(".jog J1 +")
            await asyncio.sleep(0.1)
            assert person.interpreter.prompt.startswith("jog J1")
            await hold(person, "+", 2.0)
            assert await person.world.until(lambda: not person.world.moving) < 0.6
            first = person.world.stands()
            assert 6.0 < first[0] < 15.0
            assert first[1:] == pytest.approx([0, 0, 0, 30, 0], abs=1e-3)
            person.interpreter.jogging.press("z", 0.0)
            await hold(person, "-", 1.0)
            person.interpreter.jogging.press("enter", 0.0)
            await person.settled()
            assert not person.world.moving
            assert abs(person.world.stands()[2] - first[2]) > 0.1
            assert "done" in await person.type("MOVEJ 0 0 0 0 30 0 [3] (deg,s)")

    run(session())


def test_ctrl_c_ends_a_jog(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            person.interpreter.has_keys = True
            person.interpreter.typed(".jog J1 +")
            await asyncio.sleep(0.1)
            await hold(person, "+", 1.0)
            person.interpreter.interrupt()
            assert await person.world.until(lambda: not person.world.moving) < 0.6
            await person.settled()
            assert person.interpreter.jogging is None

    run(session())
