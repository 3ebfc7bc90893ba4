"""Tests of values from outside: they are accepted while the program waits for them, all values of a message
or none. Late, repeated, too large or malformed values are refused and logged.
"""

import asyncio
import math
import random

import pytest
from coordinator.test_programs import loaded
from coordinator.virtual import coordinating, run
from hypothesis import given
from hypothesis import strategies as st

from tests.floors import exercises
from yarclang.coordinator.attached import Here
from yarclang.coordinator.messages import orders
from yarclang.coordinator.messages.lines import read_order
from yarclang.coordinator.messages.replies import Denied
from yarclang.runtime.actions import Trouble
from yarclang.runtime.notices import Wanted
from yarclang.runtime.state import State
from yarclang.runtime.values import checked_values

HEAD = """ROBOT INDUSTRIAL6
REGISTER SEEN 0..2 OUTSIDE
REGISTER X -100..100 OUTSIDE
REGISTER TRIES 0..9
INPUT DOOR M11
"""
ASKS = """P0010 MOVEJ 5 0 0 0 0 0 [0.5] (deg,s)
P0020 WAIT SEEN > 0 AND X > -100 [5] (s) ELSE
  P0030 SAY "no camera"
END
P0040 SAY "seen {SEEN} at {X}"
P0050 MOVEJ 0 0 0 0 0 0 [0.5] (deg,s)
"""


class Session:
    """A running program, and a camera that sends values to it."""

    def __init__(self, world, coordinator, client, text):
        self.world, self.coordinator, self.client = world, coordinator, client
        self.camera = Here(coordinator, "camera")
        self.stream = client.session.events()
        self.running = asyncio.create_task(client.motion.run(loaded(text)))

    async def asked(self):
        await self.world.until(lambda: self.coordinator.values.wanted is not None)
        return self.coordinator.values.wanted

    async def fill(self, number=None, **values):
        return (await self.camera.ask(orders.Fill(values=values, number=number))).values

    async def refused(self, code, said, number=None, **values):
        with pytest.raises(Trouble, match=said) as trouble:
            await self.fill(number, **values)
        assert trouble.value.code == code

    async def ended(self):
        return await self.running

    def told(self):
        return [one.text for one in self.stream.waiting() if one.event == "message"]


def carried_out(text, work):
    async def whole():
        async with coordinating() as (world, coordinator, client):
            await work(Session(world, coordinator, client, HEAD + text))

    run(whole())


def test_a_camera_answers_and_the_program_goes_on():
    async def work(it):
        wanted = await it.asked()
        assert (wanted.number, wanted.place, wanted.needed) == (1, "P0020 WAIT", ("SEEN", "X"))
        assert [(one.name, one.low, one.high) for one in wanted.registers] == [
            ("SEEN", 0, 2),
            ("X", -100, 100),
        ]
        status = await it.camera.ask(orders.AskStatus())
        assert status.wants == wanted
        assert await it.fill(1, seen=1, x=12.0) == {"SEEN": 1, "X": 12}
        ended = await it.ended()
        assert ended.well
        assert dict(ended.registers) == {"SEEN": 1, "X": 12, "TRIES": 0}
        told = it.told()
        assert "P0020 WAIT: camera gives SEEN = 1, X = 12" in told
        assert "P0040 SAY: seen 1 at 12" in told
        assert (await it.camera.ask(orders.AskStatus())).wants is None

    carried_out(ASKS, work)


def test_what_is_wrong_is_refused_with_its_reason_and_logged():
    async def work(it):
        await it.refused("Y1661", "no WAIT or HOLD of the program accepts values now", seen=1, x=1)
        await it.asked()
        await it.refused("Y1662", "X can't be 101: it is an integer from -100 to 100", seen=1, x=101)
        await it.refused("Y1662", "SEEN can't be -1", seen=-1, x=1)
        await it.refused("Y1663", "X can't be 'left'", seen=1, x="left")
        await it.refused("Y1663", "X can't be 0.5", seen=1, x=0.5)
        await it.refused("Y1663", "SEEN can't be True", seen=True, x=1)
        await it.refused("Y1663", "X can't be None", seen=1, x=None)
        await it.refused("Y1663", r"X can't be \[1\]", seen=1, x=[1])
        await it.refused("Y1663", "'TRIES' isn't filled from outside", seen=1, x=1, TRIES=3)
        await it.refused("Y1663", "stands twice", seen=1, x=1, X=2)
        await it.refused("Y1663", "X is missing", seen=1)
        await it.refused("Y1663", "SEEN, X are missing")
        await it.refused("Y1661", "question 7 isn't open any more", 7, seen=1, x=1)
        assert it.coordinator.state is State.HOLD
        await it.fill(1, seen=2, x=-99)
        await it.refused("Y1661", "too early, too late or twice", 1, seen=2, x=-99)
        assert (await it.ended()).well
        await it.refused("Y1661", "too early, too late or twice", 1, seen=2, x=-99)
        told = it.told()
        assert "values of camera are refused: X can't be 101: it is an integer from -100 to 100" in told
        assert "P0040 SAY: seen 2 at -99" in told

    carried_out(ASKS, work)


def test_without_an_answer_the_other_way_is_taken_and_late_values_are_refused():
    async def work(it):
        since = it.world.machine.now
        await it.asked()
        await it.world.until(lambda: it.coordinator.values.wanted is None)
        assert it.world.machine.now - since > 5.0
        await it.refused("Y1661", "no WAIT or HOLD", 1, seen=1, x=1)
        ended = await it.ended()
        assert ended.well
        assert ended.ways == (False,)
        told = it.told()
        assert "P0030 SAY: no camera" in told
        assert any("seen 0 at -100" in one for one in told)

    carried_out(ASKS, work)


def test_values_that_do_not_end_the_wait_are_asked_for_again_and_do_not_lengthen_it():
    async def work(it):
        since, numbers, heard = None, [], []
        it.coordinator.engine.session.listen(heard.append)
        while not it.running.done():
            wanted = it.coordinator.values.wanted
            if wanted is not None:
                since = it.world.machine.now if since is None else since
                numbers.append(wanted.number)
                await it.fill(wanted.number, seen=0, x=3)
            await asyncio.sleep(0.004)
            if since is not None and it.coordinator.state is State.MOVE:
                break
        assert it.world.machine.now - since < 5.2
        assert len([one for one in heard if "takes values from outside" in getattr(one, "text", "")]) == 1
        assert len(set(numbers)) == len(numbers) > 100
        assert (await it.ended()).ways == (False,)

    carried_out(ASKS, work)


def test_registers_begin_anew_at_each_wait():
    """Values that were sent for the first pass don't end the wait of the second pass."""
    text = """REPEAT 2
  P0020 WAIT SEEN > 0 [2] (s) ELSE
    P0030 SAY "nobody"
  END
END
"""

    async def work(it):
        wanted = await it.asked()
        assert wanted.needed == ("SEEN",)
        await it.fill(wanted.number, seen=1)
        ended = await it.ended()
        assert ended.ways == (True, False)

    carried_out(text, work)


def test_an_input_ends_the_wait_as_well():
    text = "P0020 WAIT SEEN > 0 OR DOOR = ON [9] (s)\n"

    async def work(it):
        await it.asked()
        it.world.machine.command("M11->*", 7)
        it.world.machine.command("M11=1", 7)
        assert (await it.ended()).well
        await it.refused("Y1661", "no WAIT", 1, seen=1)

    carried_out(text, work)


def test_a_wait_without_an_else_ends_the_run():
    async def work(it):
        await it.asked()
        ended = await it.ended()
        assert (ended.well, ended.code) == (False, "Y1604")
        assert "SEEN is 0" in ended.what

    carried_out("P0020 WAIT SEEN > 0 [1] (s)\n", work)


def test_at_a_hold_values_are_taken_and_only_a_person_goes_on():
    text = (
        'P0020 HOLD "look"\nP0030 SAY "{SEEN} {X}"\nP0040 HOLD "how many?" TRIES\nP0050 SAY "{TRIES} {X}"\n'
    )

    async def work(it):
        wanted = await it.asked()
        assert wanted.needed == ()
        await it.refused("Y1663", "the message contains no values")
        assert await it.fill(wanted.number, x=7) == {"X": 7}
        assert await it.fill((await it.asked()).number, seen=2) == {"SEEN": 2}
        await asyncio.sleep(3.0)
        assert it.coordinator.state is State.HOLD
        it.client.motion.resume()
        await it.world.until(lambda: it.coordinator.asks is not None)
        await it.refused("Y1663", "'TRIES' isn't filled from outside", TRIES=3)
        await it.fill((await it.asked()).number, x=-7)
        it.client.motion.resume(99)  # TRIES can't have this value, so the answer is refused
        await asyncio.sleep(0.5)
        await it.fill((await it.asked()).number, seen=1)
        it.client.motion.resume(4)
        ended = await it.ended()
        assert dict(ended.registers) == {"SEEN": 1, "X": -7, "TRIES": 4}
        told = it.told()
        assert "P0030 SAY: 2 7" in told
        assert "P0050 SAY: 4 -7" in told

    carried_out(text, work)


@pytest.mark.parametrize("order", ["stop", "abort"])
def test_a_stop_ends_the_wait_and_what_comes_then_is_refused(order):
    async def work(it):
        await it.asked()
        getattr(it.client.motion, order)()
        ended = await it.ended()
        assert not ended.well
        assert it.coordinator.values.wanted is None
        await it.refused("Y1661", "no WAIT", 1, seen=1, x=1)

    carried_out(ASKS, work)


def test_values_in_the_instant_of_a_stop_move_nothing():
    async def work(it):
        await it.asked()
        await it.fill(1, seen=1, x=1)
        it.client.motion.stop()
        ended = await it.ended()
        assert not ended.well
        assert dict(ended.registers)["X"] in (1, -100)
        assert abs(it.world.stands()[0] - 5.0) < 1e-3

    carried_out(ASKS, work)


def test_the_link_is_lost_while_the_program_waits():
    async def work(it):
        await it.asked()
        it.world.unplugged = True
        for wire in it.world.wires:
            wire.close()
        ended = await it.ended()
        assert (ended.well, ended.code) == (False, "Y1606")
        await it.refused("Y1661", "no WAIT", 1, seen=1, x=1)
        it.world.unplugged = False
        await it.world.until(lambda: not it.coordinator.engine.lost)
        it.world.machine.command("", 7)

    carried_out("P0015 WAIT SEEN > 0 OR DOOR = ON [60] (s)\n" + ASKS, work)


def test_a_flood_of_nonsense_does_not_fill_the_log():
    async def work(it):
        await it.asked()
        for _ in range(2000):
            await it.refused("Y1663", "can't be", seen=1, x="#" * 1000)
        await asyncio.sleep(1.5)
        await it.refused("Y1662", "can't be", seen=1, x=1000)
        await it.fill(1, seen=1, x=1)
        assert (await it.ended()).well
        lines = [one for one in it.told() if "are refused" in one]
        assert len(lines) <= 7
        assert any("(1995 earlier refusals weren't logged)" in one for one in lines)
        assert max(map(len, lines)) < 300

    carried_out(ASKS, work)


def test_random_cameras_never_get_anything_else_in():
    """Whatever is sent at whatever time, registers contain only accepted values within their ranges, and the
    executed branches follow from these values.
    """
    seen, codes = [], set()

    def camera(seed):
        choose = random.Random(seed)
        values = [-101, -100, -99, 0, 1, 2, 3, 100, 101, 0.5, 1e300, -1e300, "1", None, True, [], {}]

        async def work(it):
            taken = {"SEEN": 0, "X": -100}
            while not it.running.done():
                names = choose.sample(["SEEN", "X", "TRIES", "x"], 2)
                given = {name: choose.choice(values) for name in names}
                try:
                    taken |= await it.fill(choose.choice([None, 1, 2, 3]), **given)
                except Trouble as trouble:
                    codes.add(trouble.code)
                await asyncio.sleep(choose.uniform(0.0, 0.1))
            ended = await it.ended()
            held = dict(ended.registers)
            assert ended.well
            assert {name: held[name] for name in taken} == taken
            assert ended.ways == (held["SEEN"] > 0 and held["X"] > -100,)
            seen.append(held["SEEN"])

        carried_out(ASKS, work)

    for seed in range(12):
        camera(seed)
    assert {one > 0 for one in seen} == {True, False}  # some values came in time, others didn't
    assert codes == {"Y1661", "Y1662", "Y1663"}


VALUES = st.one_of(
    st.integers(),
    st.floats(),
    st.booleans(),
    st.none(),
    st.text(max_size=5),
    st.lists(st.integers(), max_size=2),
)
WANTED = Wanted(3, "P0010 WAIT", (("A", -5, 5), ("B", 0, 1)), ("A",))


@exercises(taken=0.02, refused=0.2)
@given(
    values=st.dictionaries(
        st.sampled_from(["A", "a", "B", "C"]), st.one_of(st.integers(-7, 7), VALUES), max_size=3
    ),
    number=st.sampled_from([None, 2, 3]),
)
def test_a_message_is_taken_whole_or_not_at_all(tally, values, number):
    found, why = None, None
    try:
        found = dict(checked_values(WANTED, number, values))
    except Trouble as trouble:
        why = trouble
    tally.count("taken", reached=why is None)
    tally.count("refused", reached=why is not None)
    if why is not None:
        assert why.code in ("Y1661", "Y1662", "Y1663")
        assert len(why.what) < 200
        return
    assert number in (None, 3)
    assert {name.upper() for name in values} == set(found) >= {"A"}
    for name, value in values.items():
        assert type(found[name.upper()]) is int
        assert math.isclose(found[name.upper()], value)
    assert -5 <= found["A"] <= 5
    assert found.get("B", 0) in (0, 1)


@pytest.mark.parametrize("number", ["9" * 5000, "9" * 500, "1e999", "-1e999", "NaN", "1e-300"])
def test_numbers_that_no_register_holds_are_refused(number):
    """Such a number makes the line invalid, or its value is refused by the register."""
    asked = read_order(f'{{"order": "fill", "values": {{"A": {number}}}}}\n'.encode())
    if isinstance(asked.what, Denied):
        assert asked.what.error
        return
    with pytest.raises(Trouble, match="A can't be"):
        checked_values(WANTED, None, asked.what.values)
