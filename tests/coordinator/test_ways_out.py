"""Tests of ON CURTAIN OFF CALL AWAY. At whatever instant the input changes, the robot brakes on its path.
When a user resumes, it moves back along the path to the beginning of the motion, and then leaves by AWAY.
"""

import asyncio
import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from conftest import EXAMPLES
from coordinator.test_programs import loaded
from coordinator.virtual import SPY, coordinating, run
from hypothesis import Phase, example, given, settings
from hypothesis import strategies as st
from runtime.virtual import path_of

from tests.floors import exercises
from yarclang.cli.yarcc import main as yarcc
from yarclang.coordinator.loading import Source, load
from yarclang.coordinator.programs import load_program
from yarclang.pipeline.inputs import Options, open_source
from yarclang.robot.actuation import to_counts
from yarclang.runtime.state import State
from yarclang.source import SourceFile

HEAD = """ROBOT INDUSTRIAL6
DEFAULT {TCP} [2] (mm,deg,s) {B}
INPUT CURTAIN M11
INPUT DOOR M12
OUTPUT GLUE M1 OFF
OUTPUT LAMP M2 OFF
SUB AWAY
  P0001 SET LAMP ON
  P0002 MOVEJ 0 -10 0 0 30 0
  P0003 MOVEJ -30 -10 0 0 30 0
END
ON CURTAIN OFF CALL AWAY
"""
TEXT = (
    HEAD
    + """P0010 MOVEJ 0 0 0 0 30 0 [2]
P0020 MOVEL 0 1174.4 1100 0 0 0 [2]
P0025 SET GLUE ON
P0030 MOVEL 200 1174.4 1100 0 0 0 [2] BLEND 20
P0040 MOVEL 200 1174.4 900 0 0 0 [2]
P0050 MOVEJ_SPLINE 0 0 0 0 30 0; 10 0 0 0 30 0 [3]
"""
)
AWAY = [-30.0, -10.0, 0.0, 0.0, 30.0, 0.0]


class Leaving:
    """A running program whose light curtain is interrupted."""

    def __init__(self, world, coordinator, client, text, **options):
        self.world, self.coordinator, self.client = world, coordinator, client
        self.stream = client.session.events()
        self.loaded = loaded(text) if isinstance(text, str) else text
        self.say("M11->*", "M12->*", "M11=1", "M12=0")
        self.running = asyncio.create_task(client.motion.run(self.loaded, **options))
        self.words = []

    def say(self, *lines):
        self.world.catch_up()
        for line in lines:
            self.world.machine.command(line, SPY)

    def value(self, variable):
        self.world.catch_up()
        return float(self.world.machine.command(variable, SPY).items[0])

    async def state(self, state):
        await self.world.until(lambda: self.coordinator.state is state)

    async def opened(self, after):
        """Interrupt the curtain some time after the motion has begun, and wait until the robot rests."""
        await self.state(State.MOVE)
        await asyncio.sleep(after)
        self.say("M11=0")
        await self.state(State.HOLD)
        await self.world.until(lambda: not self.world.moving)
        return self.world.machine.now

    def resume(self):
        self.client.motion.resume()

    def told(self):
        self.words += [one.text for one in self.stream.waiting() if one.event == "message"]
        return self.words


def carried_out(work, text=TEXT, options=None, **world):
    async def whole():
        async with coordinating(**world) as (world_, coordinator, client):
            await work(Leaving(world_, coordinator, client, text, **(options or {})))
            assert not world_.moving

    run(whole())


def went_back(it, since, until):
    """Return the distances of the robot from its path between two times [counts]."""
    times = np.arange(since, until, 0.01)
    counts = it.world.machine.positions(times, it.world.robot.controller.motors)
    return path_of(it.loaded.plan).distance(counts)


def counts(it, angle):
    """Return the largest number of counts by which a motor moves if each joint moves by an angle [rad]."""
    each = to_counts(it.world.robot, angle * np.eye(6)) - to_counts(it.world.robot, np.zeros(6))
    return np.abs(each).sum(axis=0).max()


@exercises(left=0.6, back=0.5)
@settings(max_examples=12, phases=(Phase.explicit, Phase.generate))
@given(st.integers(0, 1000), st.floats(0.3, 3.0), st.integers(0, 2**32))
@example(359, 1.9, 1134)  # the robot passes a SET while it brakes
@example(362, 0.3, 0)  # it does, and rests before the runtime knows
def test_a_curtain_at_any_instant(tally, thousandths, opened, seed):
    async def work(it):
        after = thousandths / 1000 * it.loaded.program.duration
        await it.state(State.MOVE)
        await asyncio.sleep(after)
        it.say("M11=0")
        for _ in range(int(opened / 0.1)):
            await asyncio.sleep(0.1)
            it.resume()  # while the curtain is interrupted, resume has no effect
        if it.coordinator.state is State.HOLD:
            await it.world.until(lambda: not it.world.moving)
            since, stood = it.world.machine.now, it.world.stands()
            # The outputs get their safe values again as soon as the runtime knows that the robot rests.
            await it.world.until(lambda: it.value("M1") == 0.0, within=0.5)
            await asyncio.sleep(0.5)
            np.testing.assert_allclose(it.world.stands(), stood, atol=1e-6)
            it.say("M11=1")
            begun = any("the motion isn't started" in one for one in it.told()[-3:])
            it.resume()
            if not begun:
                await it.world.until(lambda: it.running.done() or it.value("M2") == 1.0)
                back = it.world.machine.now
                tally.count("back", back - since > 1.5)
                if back - since > 1.5:
                    assert went_back(it, since, back - 0.1) < counts(it, 1e-4) + 1.0
        ended = await it.running
        tally.count("left", bool(ended.what))
        if not ended.well:
            assert "abandoned by AWAY" in ended.what, ended
            assert it.world.stands() == pytest.approx(AWAY, abs=1e-3)
            assert it.coordinator.state is State.STOP
        assert (it.value("M1"), it.value("M2")) == (0.0, 0.0)

    carried_out(work, seed=seed, record=True)


def test_while_the_input_is_open_nothing_moves_and_a_stop_ends_it():
    async def work(it):
        await it.opened(1.0)
        stood = it.world.stands()
        it.resume()
        await asyncio.sleep(1.0)
        assert it.coordinator.state is State.HOLD
        it.client.motion.stop()
        ended = await it.running
        assert (ended.well, ended.what) == (False, "stopped on its path")
        np.testing.assert_allclose(it.world.stands(), stood, atol=1e-6)
        assert any("the hold continues: CURTAIN (M11) is OFF" in one for one in it.told())

    carried_out(work)


def test_a_way_that_is_held_again_and_goes_on():
    """During the retreat, the curtain holds the robot again, but leads to no other retreat."""

    async def work(it):
        await it.opened(1.0)
        it.say("M11=1")
        it.resume()
        for _ in range(2):  # once on the path back, and once on the way out
            await it.opened(0.4)
            it.say("M11=1")
            it.resume()
            await it.state(State.MOVE)
            await asyncio.sleep(2.0)
        ended = await it.running
        assert "abandoned by AWAY" in ended.what
        assert it.world.stands() == pytest.approx(AWAY, abs=1e-3)
        assert sum("retreat along the path" in one for one in it.told()) == 1

    carried_out(work)


@pytest.mark.parametrize("order", ["stop", "hold", "abort"])
@pytest.mark.parametrize("after", [0.0, 0.5, 3.0])
def test_an_order_on_the_way(order, after):
    async def work(it):
        await it.opened(1.0)
        it.say("M11=1")
        it.resume()
        await asyncio.sleep(after)
        getattr(it.client.motion, order)()
        await asyncio.sleep(2.0)
        if not it.running.done():
            assert it.coordinator.state is State.HOLD
            it.resume()
        ended = await it.running
        assert not ended.well
        assert ("abandoned by AWAY" in ended.what) == (order == "hold"), ended

    carried_out(work)


def test_a_lost_link_on_the_way_back():
    async def work(it):
        await it.opened(1.5)
        it.say("M11=1")
        it.resume()
        await asyncio.sleep(1.0)
        it.world.unplug()
        await asyncio.sleep(2.0)
        it.world.plug()
        ended = await it.running
        assert not ended.well
        assert "back, before AWAY: the connection was lost" in ended.what

    carried_out(work)


def test_steps_and_passes_end_with_the_way_out():
    async def work(it):
        await it.opened(1.0)
        it.say("M11=1")
        it.resume()
        ended = await it.running
        assert "abandoned by AWAY" in ended.what
        assert it.world.stands() == pytest.approx(AWAY, abs=1e-3)

    carried_out(work, options={"times": 3})


def test_a_way_back_that_fails_leaves_the_robot_where_it_stands(monkeypatch):
    async def work(it):
        stood = await it.opened(1.0), it.world.stands()
        it.say("M11=1")
        it.resume()
        ended = await it.running
        assert (ended.well, ended.code) == (False, "Y1638")
        assert (
            "can't retreat by AWAY: the robot can't move back to the start of P0010 MOVEJ: it breaks a limit"
            in ended.what
        )
        np.testing.assert_allclose(it.world.stands(), stood[1], atol=1e-6)
        assert it.coordinator.state is State.FAULT

    monkeypatch.setattr("yarclang.pipeline.leaving._back", lambda *_: "it breaks a limit")
    carried_out(work)


@pytest.mark.parametrize(("place", "after"), [("P0120", 0.3), ("P0150", 0.0), ("P0160", 1.0), ("P0190", 0.5)])
def test_the_example_leaves_from_anywhere(place, after):
    """Along the rim, all lines form one motion without a stop. So the robot goes back along all of them."""

    async def work(it):
        command = next(one for one in it.loaded.program.commands if one.index == place)
        since = it.world.machine.now
        await it.state(State.MOVE)
        await it.world.until(
            lambda: (
                it.coordinator.progress is not None and it.coordinator.progress.line == command.source_line
            )
        )
        before = it.value("M1")
        await it.opened(after)
        assert (before, it.value("M1")) == (float(place not in ("P0120", "P0190")), 0.0)
        stopped = it.world.machine.now
        it.say("M11=1")
        it.resume()
        await it.world.until(lambda: it.value("M2") == 1.0)
        assert went_back(it, stopped, it.world.machine.now - 0.1) < counts(it, 1e-4) + 1.0
        ended = await it.running
        assert "abandoned by LEAVE" in ended.what, ended
        assert it.world.stands() == pytest.approx([-60.0, 0.0, -30.0, 0.0, 60.0, 0.0], abs=1e-3)
        assert it.value("M1") == 0.0
        assert it.world.machine.now - since < 90.0

    text = (EXAMPLES / "28_curtain_with_return.yarc").read_text()
    carried_out(
        work, re.sub(r"^START .*\n", "", text, flags=re.MULTILINE), record=True
    )  # without START, because this robot stands at HOME


@pytest.mark.parametrize("known", [True, False])
def test_a_controller_text_leaves_only_if_its_program_is_there(tmp_path, known):
    program, made = tmp_path / "p.yarc", tmp_path / "p.pmc"
    program.write_text(TEXT)
    assert CliRunner().invoke(yarcc, [str(program), "-o", str(made)]).exit_code == 0
    if not known:
        program.unlink()
    judged = load(Source(str(made)))
    assert judged.value is not None, judged.diagnostics

    async def work(it):
        await it.opened(1.0)
        stood = it.world.stands()
        it.say("M11=1")
        it.resume()
        ended = await it.running
        if known:
            assert "abandoned by AWAY" in ended.what
            assert it.world.stands() == pytest.approx(AWAY, abs=1e-3)
        else:
            assert (ended.well, ended.code) == (False, "Y1638")
            np.testing.assert_allclose(it.world.stands(), stood, atol=1e-6)

    carried_out(work, judged.value)


VARIANTS = {
    "a loop at run time": (
        (
            "P0005 MOVEJ 0 0 0 0 30 0 [1]\n"
            "WHILE DOOR OFF\n"
            "  P0010 MOVEJ 10 0 0 0 30 0 [1]\n"
            "  P0020 MOVEJ 0 0 0 0 30 0 [1]\n"
            "END\n"
        ),
        3.6,
    ),
    "a way that is decided": (
        (
            "P0010 MOVEJ 0 0 0 0 30 0 [1]\n"
            "WHEN DOOR ON\n"
            "  P0020 MOVEJ 20 0 0 0 30 0 [2]\n"
            "ELSE\n"
            "  P0030 MOVEJ -20 0 0 0 30 0 [2]\n"
            "  P0040 MOVEJ 20 0 0 0 30 0 [2]\n"
            "END\n"
        ),
        2.5,
    ),
    "a search": (
        (
            "P0010 MOVEL 0 1174.4 1000 0 0 0 [2]\nP0020 MOVEL 0 1174.4 800 0 0 0 [V 50] UNTIL DOOR\n"
            "P0030 MOVEL 0 1174.4 1000 0 0 0 [2]\n"
        ),
        4.0,
    ),
    "a spline": ("P0010 MOVEJ_SPLINE 10 0 0 0 30 0; 0 0 5 0 30 0; 20 0 0 0 40 0 [4]\n", 2.2),
    "an arc": (
        "P0010 MOVEL 0 1174.4 1000 0 0 0 [2]\nP0020 MOVEC 50 1174.4 1050; 100 1174.4 1000 0 0 0 [3]\n",
        3.5,
    ),
    "the quickest law": ("P0010 MOVEJ_TOPP 60 20 10 30 30 0 [MIN]\n", 0.6),
    "a dwell within a leg": (
        "P0010 MOVEJ 10 0 0 0 30 0 [1]\nP0020 WAIT [2]\nP0030 MOVEJ 0 0 0 0 30 0 [1]\n",
        2.0,
    ),
}


@pytest.mark.parametrize("name", VARIANTS)
def test_it_leaves(name):
    lines, after = VARIANTS[name]

    async def work(it):
        await it.opened(after)
        stopped = it.world.machine.now
        it.say("M11=1")
        it.resume()
        await it.world.until(lambda: it.running.done() or it.value("M2") == 1.0)
        assert went_back(it, stopped, it.world.machine.now - 0.1) < counts(it, 1e-4) + 1.0
        ended = await it.running
        assert "abandoned by AWAY" in ended.what, ended
        assert it.world.stands() == pytest.approx(AWAY, abs=1e-3)

    carried_out(work, HEAD + lines, record=True)


def test_after_a_search_the_inputs_hold_until_the_end_of_the_motion_that_leads_on():
    made = loaded(HEAD + VARIANTS["a search"][0])
    here = made.plan.sample(np.array([4.0]))[0][0]
    (job,) = made.behind(1, here, None).jobs
    assert [(one.name, one.then) for one in job.watches] == [("CURTAIN", "")]
    assert "; watch M11=0 CURTAIN\n" in job.text
    assert [one.then for one in made.program.watches] == ["AWAY"]


def test_a_program_that_begins_within():
    async def work(it):
        await it.opened(1.0)
        it.say("M11=1")
        it.resume()
        ended = await it.running
        assert "abandoned by AWAY" in ended.what
        assert it.world.stands() == pytest.approx(AWAY, abs=1e-3)

    lines = "P0010 MOVEJ 10 0 0 0 30 0 [1]\nP0020 MOVEJ 0 0 0 0 0 0 [1]\nP0030 MOVEJ 30 0 0 0 30 0 [3]\n"
    carried_out(work, loaded(HEAD + lines, first="P0030"))


def test_the_commands_of_a_way_out_are_none_of_the_program():
    opened = open_source(SourceFile("p.yarc", TEXT), Path(), Options()).value
    made = load_program(opened, "p.yarc", "P0002")
    assert made.value is None
    assert [one.code for one in made.diagnostics if one.is_error] == ["Y1164"]
