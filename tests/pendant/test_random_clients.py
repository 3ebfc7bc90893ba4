"""Random test of two users at their pendants, in virtual time. Whatever they order, only proved lines are
streamed, and the robot rests after a stop.
"""

import asyncio
import contextlib

import numpy as np
import pytest
from coordinator.test_sessions import REPLY, START, certified_lines
from coordinator.virtual import run
from floors import exercises
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pendant.at_robot import pendant

from yarclang.pendant.accounts.roles import Role
from yarclang.pmac.requests import Code
from yarclang.pmac.variables import DISARMS
from yarclang.robot.actuation import from_counts

PROGRAM = "P0010 MOVEJ 20 20 15 0 50 10 [20%] (deg,s)\nP0020 MOVEJ 0 10 10 0 40 0 [20%] (deg,s)\n"
WHO = st.sampled_from([0, 1])
VELOCITY = st.dictionaries(st.sampled_from(["J1", "J2", "J3", "J5"]), st.floats(-300.0, 300.0), min_size=1)
TWIST = st.lists(st.floats(-500.0, 500.0), min_size=6, max_size=6)
WANT = st.one_of(
    VELOCITY.map(lambda one: {"velocity": one}),
    TWIST.map(lambda one: {"twist": one}),
    TWIST.map(lambda one: {"twist": one, "axes": "{TCP}"}),
    st.tuples(st.sampled_from(["J1", "J6", "x", "c", "nothing"]), st.floats(-10.0, 10.0)).map(
        lambda one: {"step": {"axis": one[0], "by": one[1]}, "share": 0.5}
    ),
)
DEEDS = st.one_of(
    st.tuples(st.just("control"), WHO),
    st.tuples(st.just("control"), st.just(0)),
    st.tuples(st.just("give"), WHO),
    st.tuples(st.just("run"), WHO, st.sampled_from([0.0, 0.4, 2.0])),
    st.tuples(st.just("order"), WHO,
        st.sampled_from(["hold", "resume", "abort", "clear", "release", "step", "status", "enable", "disable",
            "connect", "homing", "settings"])),
    st.tuples(st.just("stop"), WHO),
    st.tuples(st.just("jog"), WHO, WANT, st.sampled_from([0.1, 0.5, 1.0]),
        st.sampled_from(["let go", "silence", "stop", "late"])),
    st.tuples(st.just("wait"), WHO, st.sampled_from([0.05, 0.5, 3.0])),
)  # fmt: skip


class People:
    """Two users, each with a browser and a socket for jogs."""

    def __init__(self, place, tally):
        self.place, self.tally = place, tally
        self.browsers = [place.logged_in(name, Role.PROGRAMMER) for name in ("anna", "bea")]
        self.lines = [one.socket("/api/jog") for one in self.browsers]
        self.presses = [0, 0]
        self.running = []

    @property
    def rests_within(self):
        return self.place.world.robot.controller.hold_time + REPLY + 0.3

    async def rests(self):
        await self.place.world.until(lambda: not self.place.world.moving, self.rests_within, each=0.002)

    async def control(self, who):
        await self.browsers[who].post("/api/control")

    async def give(self, who):
        await self.browsers[who].post("/api/control/give", {"to": self.browsers[1 - who].session.id})

    async def order(self, who, word):
        await self.browsers[who].order(word)

    async def wait(self, _, seconds):
        await asyncio.sleep(seconds)

    async def run(self, who, seconds):
        told = (await self.browsers[who].order("load", file="there.yarc", approach=True)).told
        if told.get("program") is None:
            return
        going = self.browsers[who].order("run", program=told["program"]["number"], approach=True)
        self.running.append(asyncio.ensure_future(going))
        await asyncio.sleep(seconds)

    async def stop(self, who):
        self.tally.count("stops of what moves", self.place.world.moving)
        assert (await self.browsers[who].order("stop")).status == 200
        await self.rests()

    async def jog(self, who, want, seconds, end):
        line = self.lines[who]
        line.waiting()
        self.presses[who] += 1
        number, until = self.presses[who], asyncio.get_running_loop().time() + seconds
        own = self.place.coordinator.owner == self.browsers[who].session.user
        beat, moved = 0, False
        while asyncio.get_running_loop().time() < until:
            message = await line.hear()
            if "beat" in message:
                beat = message["beat"] - (20 if end == "late" else 0)
                line.say({"press": number, "beat": beat, **want})
            moved |= own and self.place.world.moving
        if own and not self.running and end != "late":
            self.tally.count("jogs that move", moved)
        if end == "stop":
            await self.stop(1 - who)
        elif end == "let go":
            line.say({"release": number})
        if end != "stop" and not any(not one.done() for one in self.running):
            await asyncio.sleep(0.25)
            await self.rests()


@exercises(**{"jogs that move": 0.1, "stops of what moves": 0.02, "streams": 0.3})
@settings(max_examples=30, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(deeds=st.lists(DEEDS, min_size=4, max_size=14))
def test_nothing_moves_that_wasnt_proved(tmp_path_factory, tally, deeds):
    folder = tmp_path_factory.mktemp("pendant")
    (folder / "there.yarc").write_text(PROGRAM)

    async def whole():
        with pytest.MonkeyPatch.context() as patch:
            async with pendant(patch, folder, joints=START, record=True) as place:
                people = People(place, tally)
                await people.control(0)
                await asyncio.sleep(0.1)
                for deed, *arguments in deeds:
                    await getattr(people, deed)(*arguments)
                await people.stop(0)
                await asyncio.gather(*people.running)
                for line in people.lines:
                    await line.close()
                await asyncio.sleep(1.0)
                assert not place.world.moving
                return place.world

    with certified_lines() as known, contextlib.suppress(asyncio.CancelledError):
        world = run(whole())
    streamed = False
    for _, code, text in world.lines:
        if code == Code.WRITEBUFFER:
            for line in text.strip("\0").split("\0"):
                assert line in known or line in (DISARMS, "OPEN ROT", "CLOSE"), line
                streamed |= line in known
    tally.count("streams", streamed)
    robot, machine = world.robot, world.machine
    q = from_counts(robot, machine.positions(np.arange(0.0, machine.now, 0.01), robot.controller.motors))
    assert (q >= robot.limits.lower - 1e-6).all()
    assert (q <= robot.limits.upper + 1e-6).all()
    assert (np.abs(np.diff(q, axis=0)) / 0.01 <= robot.limits.velocity * 1.001).all()
