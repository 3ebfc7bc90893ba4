"""Tests of programs as the page Run executes them, through the API in virtual time: waits, faults, aborts,
start at a given command, and repetition.
"""

import asyncio

import pytest
from coordinator.virtual import run
from pendant.at_robot import pendant

from yarclang.pendant.accounts.roles import Role

HEAD = "ROBOT INDUSTRIAL6\nDEFAULT [2] (deg,s)\n"
WAITS = (
    HEAD
    + """INPUT PART M11
SUB NOD
  P0010 MOVEJ 5 5 0 0 0 0
  P0020 MOVEJ 5 0 0 0 0 0
END
P0100 MOVEJ 5 0 0 0 0 0
P0110 WAIT PART ON [3]
P0120 CALL NOD
P0130 HOLD "look"
P0140 MOVEJ 0 0 0 0 0 0
"""
)


def trial(monkeypatch, tmp_path, work, text=WAITS, role=Role.OPERATOR):
    async def whole():
        (tmp_path / "p.yarc").write_text(text)
        async with pendant(monkeypatch, tmp_path) as place:
            otto = place.logged_in("otto", role)
            assert (await otto.post("/api/control")).told["given"]
            await asyncio.sleep(0.1)
            await work(place, otto)

    run(whole())


async def loaded(otto, **options):
    told = (await otto.order("load", file="p.yarc", approach=True, **options)).told
    assert told["program"] is not None, told
    course = (await otto.order("course", program=told["program"]["number"])).told
    assert course["ok"], course
    return told["program"]["number"], course


def running(otto, number, **fields):
    return asyncio.ensure_future(otto.order("run", program=number, **fields))


async def ended(task):
    return (await asyncio.wait_for(task, 120.0)).told


def test_an_input_that_never_comes_and_the_way_on(monkeypatch, tmp_path):
    """The WAIT ends with a fault of its own. The reply's `go_on` names the command with which the program can
    continue.
    """

    async def work(place, otto):
        number, course = await loaded(otto)
        assert (course["takes"]["waits"], course["changed"]) == (2, False)
        task = running(otto, number)
        await place.world.until(lambda: "waits" in place.coordinator.why or place.coordinator.progress, 10.0)
        end = await ended(task)
        assert not end["well"]
        assert end["help"] or end["what"]
        assert place.world.stands() == pytest.approx([5, 0, 0, 0, 0, 0], abs=1e-3)
        assert end["go_on"] is not None
        if place.coordinator.state.value == "fault":
            assert (await otto.order("clear")).status == 200
        await loaded(otto, **({"first": end["go_on"]} if end["go_on"] else {}))

    trial(monkeypatch, tmp_path, work)


def test_from_within_a_sub_to_the_hold_and_on(monkeypatch, tmp_path):
    async def work(place, otto):
        number, course = await loaded(otto, first="P0120>P0020")
        assert [one["index"] for one in course["commands"]] == ["P0120>P0020", "P0140"]
        way = (await otto.order("way", program=number)).told
        assert way["duration_s"] > 0.0
        refused = await otto.order("run", program=number)
        assert refused.status == 409
        task = running(otto, number, approach=True)
        await place.world.until(lambda: place.coordinator.state.value == "hold", 60.0)
        assert place.world.stands() == pytest.approx([5, 0, 0, 0, 0, 0], abs=1e-3)
        assert (await otto.order("course", program=number)).told["ok"]
        assert (await otto.order("resume")).status == 200
        assert (await ended(task))["well"]
        assert place.world.stands() == pytest.approx([0] * 6, abs=1e-3)

    trial(monkeypatch, tmp_path, work)


@pytest.mark.parametrize("word", ["abort", "stop"])
def test_what_ends_it_on_the_way(monkeypatch, tmp_path, word):
    async def work(place, otto):
        number, _ = await loaded(otto)
        task = running(otto, number)
        await asyncio.sleep(1.0)
        assert place.world.moving
        assert (await otto.order(word)).status == 200
        end = await ended(task)
        assert not end["well"]
        assert (end["go_on"] is None) == (word == "abort") or end["go_on"] is not None
        assert not place.world.moving

    trial(monkeypatch, tmp_path, work)


def test_a_program_that_ends_elsewhere_isnt_repeated(monkeypatch, tmp_path):
    """A program that doesn't end at its start can't be repeated: the run ends with an error when the second
    pass begins.
    """

    async def work(place, otto):
        number, _ = await loaded(otto)
        end = await ended(running(otto, number, times=3))
        assert not end["well"]
        assert "starts" in end["what"]
        assert end["passes"] == 2
        assert place.world.stands() == pytest.approx([5, 0, 0, 0, 0, 0], abs=1e-3)

    trial(monkeypatch, tmp_path, work, HEAD + "START HOME\nP0010 MOVEJ 5 0 0 0 0 0\n")


def test_the_display_says_that_it_stands_between_steps(monkeypatch, tmp_path):
    async def work(place, otto):
        page = otto.socket("/api/robot")
        number, _ = await loaded(otto, by_steps=True)
        task = running(otto, number)
        shown = await page.until(lambda message: message.get("paused") is True)
        assert shown["mode"] == "program"
        assert (await otto.order("step")).status == 200
        await page.until(lambda message: message.get("paused") is False)
        assert (await otto.order("stop")).status == 200
        assert not (await ended(task))["well"]
        await page.until(lambda message: message.get("mode") == "idle" and not message["paused"])
        await page.close()

    trial(
        monkeypatch,
        tmp_path,
        work,
        HEAD + "P0010 MOVEJ 5 0 0 0 0 0\nP0020 MOVEJ 0 0 0 0 0 0\nP0030 MOVEJ 1 0 0 0 0 0\n",
    )


def test_what_is_told_is_bounded(monkeypatch, tmp_path):
    async def work(place, otto):
        number, _ = await loaded(otto)
        for samples, status in ((2, 200), (2000, 200), (1, 400), (2001, 400), ("many", 400), (1e9, 400)):
            told = await otto.order("course", program=number, samples=samples)
            assert told.status == status, samples
            assert len(told.content) < 300_000
        assert (await otto.order("course", program=10**400)).status in (400, 409)
        guest = place.logged_in("guest", Role.VIEWER)
        assert (await guest.order("course", program=number)).status == 409  # otto has loaded the program
        assert not [one for one in place.deeds() if one[1] == "course"]

    trial(monkeypatch, tmp_path, work)
