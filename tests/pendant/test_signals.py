"""Tests of inputs and outputs through the API: their entries in the cell, the WAIT at which a program stands,
rights to switch them, and a thousand of them.
"""

import asyncio
import time

import pytest
from coordinator.virtual import run
from pendant.at_robot import pendant

from yarclang.coordinator.messages import events
from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.signals import Signals, comments_of
from yarclang.simulated_cell.playing import SimulatedCell
from yarclang.simulator.beside import Beside
from yarclang.source import SourceFile

CELL = """units = "mm,deg,s"
[frames.HAND]
parent = "FLANGE"
xyz = [0, 150, 0]
[inputs]
DOOR_OPEN = "M11"   # <img src=x onerror=alert(1)> of the # press
[inputs.PRESSURE]
# bar
variable = "M12"
[outputs.GRIP]  # the fingers
variable = "M1"
grips = "HAND"
[outputs.LAMP]
variable = "M2"
safe = "OFF"
[[parts]]
name = "BOX"
shape = "box"
frame = "HAND"
xyz = [0, 0, 0]
size = [10, 10, 10]
"""
PART = CELL.replace('frame = "HAND"\nxyz', 'frame = "B"\nxyz').replace(
    "xyz = [0, 0, 0]", "xyz = [0, 1224.4, 1764]"
)
WAITS = 'CELL "cell.toml"\nP0010 SET LAMP ON\nP0020 WAIT DOOR_OPEN ON\nP0030 SET LAMP OFF\n'

FREE = [at for at in range(4100, 7000) if at % 100 < 60]
"""Numbers of controller variables that yarclang doesn't use itself."""


def at(monkeypatch, tmp_path, work, cell=PART, **options):
    (tmp_path / "cell.toml").write_text(cell)
    (tmp_path / "wait.yarc").write_text(WAITS)

    async def whole():
        async with pendant(monkeypatch, tmp_path, **options) as place:
            bea = place.logged_in("bea", Role.PROGRAMMER)
            await bea.post("/api/control")
            made = (await bea.order("adopt", declarations=['CELL "cell.toml"'])).told
            assert made["holds"], made
            await work(place, bea)

    run(whole())


async def valued(browser):
    """Return for each signal its value, and True if a program reported this value."""
    shown, told = (await browser.get("/api/signals")).told, (await browser.get("/api/signals/values")).told
    assert shown["version"] == told["version"]
    names = [one["name"] for one in shown["signals"]]
    return {
        name: (value, at in told["heard"])
        for at, (name, value) in enumerate(zip(names, told["values"], strict=True))
    }, told


async def until(look):
    for _ in range(400):
        if found := await look():
            return found
        await asyncio.sleep(0.05)
    raise AssertionError("it never came")


def test_what_the_cell_says_and_who_may_switch(monkeypatch, tmp_path):
    async def work(place, bea):
        ada, otto = place.logged_in("ada", Role.VIEWER), place.logged_in("otto", Role.OPERATOR)
        shown = (await ada.get("/api/signals")).told
        found = {one["name"]: one for one in shown["signals"]}
        assert "real controller" in shown["fixed"]
        assert found["DOOR_OPEN"]["comment"] == "<img src=x onerror=alert(1)> of the # press"
        assert (found["PRESSURE"]["variable"], found["PRESSURE"]["kind"]) == ("M12", "input")
        assert (found["GRIP"]["comment"], found["GRIP"]["grips_at"], found["GRIP"]["safe"]) == (
            "the fingers",
            1,
            None,
        )
        assert (found["LAMP"]["safe"], found["LAMP"]["removes_at"], found["LAMP"]["declared"]) == (
            0,
            None,
            True,
        )
        assert (await valued(ada))[0]["LAMP"] == (0, False)
        # Refusals by role, and because another user controls the robot.
        for one in (ada, otto):
            assert (await one.order("set", name="LAMP", value=1)).status == 403
            assert (await one.order("input", name="DOOR_OPEN", value=1)).status == 403
        dora = place.logged_in("dora", Role.PROGRAMMER)
        refused = await dora.order("set", name="LAMP", value=1)
        assert refused.status == 409
        # Inputs of a real controller can't be set.
        assert (await bea.order("input", name="DOOR_OPEN", value=1)).told["code"] == "Y1619"
        made = (await bea.order("set", name="LAMP", value=1)).told
        assert made["value"] == 1
        await asyncio.sleep(2.0)
        assert (await valued(ada))[0]["LAMP"] == (1, False)
        # A gripper that closes at a part holds it, and all pages are told.
        assert (await bea.order("set", name="GRIP", value="ON")).told["value"] == 1
        await asyncio.sleep(2.0)
        assert (await valued(ada))[1]["held"] == [{"output": "GRIP", "parts": ["BOX"]}]
        for value in (1e308, "maybe", None, [1], {}):
            assert (await bea.order("set", name="LAMP", value=value)).status == 400, value
        assert (await bea.post("/api/orders/set", raw=b'{"name": "LAMP", "value": NaN}')).status == 400
        for name in ("M99", "LAMP=1", "", "DOOR_OPEN"):
            told = (await bea.order("set", name=name, value=1)).told
            assert told.get("value") is None, name
            assert told.get("error") or told["findings"], name
        assert [(user, action, outcome) for user, action, _, outcome in place.deeds() if action == "set"][-1][
            0
        ] == "bea"

    at(monkeypatch, tmp_path, work)


def test_the_wait_at_which_a_program_stands(monkeypatch, tmp_path):
    async def work(place, bea):
        number = (await bea.order("load", file="wait.yarc")).told["program"]["number"]
        running = asyncio.ensure_future(bea.order("run", program=number))

        async def waits():
            return (await valued(bea))[1]["waiting"]

        waiting = await until(waits)
        assert (waiting["place"], waiting["name"], waiting["wanted"], waiting["value"]) == (
            "P0020",
            "DOOR_OPEN",
            1,
            0,
        )
        await asyncio.sleep(12.0)
        values, told = await valued(bea)
        assert 11.0 < told["waiting"]["since_s"] < 15.0
        # The value that the program set last is known, and marked as reported. A value that nobody reported
        # isn't known.
        assert values["LAMP"] == (1, True)
        assert values["PRESSURE"] == (None, False)
        refused = await bea.order("set", name="LAMP", value=0)
        assert refused.status == 409
        assert refused.told["error"]
        await bea.order("stop")
        await running
        await asyncio.sleep(2.0)
        values, told = await valued(bea)
        assert told["waiting"] is None
        assert values["LAMP"] == (0, False)  # its safe value, as read from the controller

    at(monkeypatch, tmp_path, work)


def test_inputs_of_a_simulated_robot(monkeypatch, tmp_path):
    async def work(place, bea):
        place.coordinator.surroundings = around = SimulatedCell()
        around.attach(Beside(place.world.machine))
        dora = place.logged_in("dora", Role.PROGRAMMER)
        assert (await valued(bea))[0]["DOOR_OPEN"] == (0, False)
        assert (
            await dora.order("input", name="DOOR_OPEN", value="ON")
        ).status == 409  # bea controls the robot
        assert (await bea.order("input", name="DOOR_OPEN", value="ON")).told["value"] == 1
        assert (await bea.order("input", name="M12", value=2.5)).told["value"] == 2.5
        assert (await bea.order("input", name="NOBODY", value=1)).status == 409
        around.handle()
        await asyncio.sleep(1.0)
        assert (await bea.get("/api/signals")).told["fixed"] == ""
        values = (await valued(bea))[0]
        assert values["DOOR_OPEN"] == (1, False)
        assert values["PRESSURE"] == (2.5, False)

    at(monkeypatch, tmp_path, work)


def test_a_thousand_signals_and_many_pages(monkeypatch, tmp_path):
    """One request to the controller serves all pages, and the controller isn't asked all the time."""
    lines = "\n".join(f'IN_{at} = "M{at}"' for at in FREE[:500])
    more = "\n".join(f'OUT_{at} = "M{at}"' for at in FREE[500:1000])
    cell = f'units = "mm,deg,s"\n[inputs]\n{lines}\n[outputs]\n{more}\n'

    async def work(place, bea):
        shown = (await bea.get("/api/signals")).told
        assert len(shown["signals"]) == 1000
        before = len(place.world.lines)
        clock = asyncio.get_running_loop().time
        since, begun = clock(), time.perf_counter()
        for _ in range(20):
            await asyncio.gather(*[bea.get("/api/signals/values") for _ in range(8)])
            await asyncio.sleep(0.1)
        asked = sum(f"M{FREE[0]}" in text for _, _, text in place.world.lines[before:])
        assert asked <= (clock() - since) / 0.4 + 2
        assert time.perf_counter() - begun < 60.0
        content = (await bea.get("/api/signals/values")).content
        assert len(content) < 30_000

    at(monkeypatch, tmp_path, work, cell=cell)


def test_bad_days(monkeypatch, tmp_path):
    async def work(place, bea):
        cell = tmp_path / "cell.toml"
        assert (await bea.get("/api/signals")).told["trouble"] == ""
        for broken in ("= nothing", "[inputs]\nA = 1\n", "\x00"):
            cell.write_text(broken)
            await asyncio.sleep(2.0)
            told = (await bea.get("/api/signals")).told
            assert told["trouble"].startswith("cell.toml"), broken
        cell.unlink()
        await asyncio.sleep(2.0)
        assert "can't be read" in (await bea.get("/api/signals")).told["trouble"]
        assert place.browser().session is None
        assert (await place.browser().get("/api/signals")).status == 401
        # Without a connection to the coordinator, all requests are refused.
        place.service.watched._attached = None
        for path in ("/api/signals", "/api/signals/values", "/api/tools"):
            refused = await bea.get(path)
            assert (refused.status, refused.told["code"]) == (409, "Y1606")

    at(monkeypatch, tmp_path, work)


@pytest.mark.parametrize(
    ("text", "comment"),
    [
        ('[inputs]\nA = "M1" # one', "one"),
        ('[inputs]\r\n# above\r\nA = "M1"\r\n', "above"),
        ('[inputs]\nA = "M1"', ""),
        ('[inputs]\nA = "M1#2"', ""),
        ('[inputs.A]   # in the header\nvariable = "M1" # of the variable', "in the header"),
        ('inputs = { A = "M1" } # all', ""),
        ('[inputs]\nA = "M1" #  \u202eodd\x1b[0m\ttabs ', "odd [0m tabs"),
        ('[inputs]\nA = "M1" #' + "x" * 1000, "x" * 159 + "…"),
    ],
)
def test_comments(text, comment):
    assert comments_of(SourceFile("cell.toml", text)).get(("inputs", "A"), "") == comment


def test_waits_of_another_coordinator_are_forgotten():
    signals = Signals(None, lambda: 5.0)
    began = events.WaitBegan(time_s=1.0, place="P1", name="A", variable="M1", wanted=1.0, value=0.0)
    signals.hear(began)
    assert signals._wait is not None
    run(signals.watch(None))
    assert signals._wait is None
    signals.hear(began)
    signals.hear(events.Began(time_s=2.0, name="x", duration_s=1.0, waits=0, client="c"))
    assert signals._wait is None
