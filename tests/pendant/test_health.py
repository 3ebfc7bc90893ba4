"""Tests of the page Health: measurements, ratings, and the data that viewers see."""

import asyncio
import os
from types import SimpleNamespace

import pytest
from coordinator.virtual import run
from pendant.at_robot import pendant

from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.health import judging, measuring
from yarclang.pendant.health.judging import of_disks, of_link, of_memory, of_speed, of_stored
from yarclang.pendant.health.measuring import Disk, Machine


def machine(**fields):
    known = {"disks": (), "own": 2e8, "peak": 3e8, "available": 8e9, "memory": 16e9, "load": 0.1, "cpu": 1.0}
    return Machine(**known | fields)


@pytest.mark.parametrize(
    ("found", "level"),
    [
        (of_disks([Disk("the project", 50e9, 99e9)], 0.0), "good"),
        (of_disks([Disk("the project", 50e9, 99e9)], 5e9), "warning"),
        (of_disks([Disk("the run logs", 50e9, 99e9)], 40e9), "bad"),
        (of_disks([Disk("the pendant's data", 50e9, 99e9)], 40e9), "good"),
        (of_disks([Disk("the project", 1.9e9, 99e9)], 0.0), "warning"),
        (of_disks([Disk("the project", 0.4e9, 99e9)], 0.0), "bad"),
        (of_disks([], 1.0), "unknown"),
        (of_memory(machine(), 1e8), "good"),
        (of_memory(machine(own=2e9), None), "warning"),
        (of_memory(machine(available=0.5e9), None), "bad"),
        (of_memory(machine(own=None, available=None, memory=None), None), "unknown"),
        (of_speed(machine(), 0.2, 0.01), "good"),
        (of_speed(machine(load=None), 0.2, 0.06), "warning"),
        (of_speed(machine(load=1.6), 0.2, 0.0), "bad"),
        (of_link(SimpleNamespace(reply_s=0.001, slowest_s=0.05, silence_s=0.4), connected=True), "good"),
        (of_link(SimpleNamespace(reply_s=0.001, slowest_s=0.3, silence_s=0.4), connected=True), "bad"),
        (of_link(None, connected=True), "unknown"),
        (of_stored(1, 1e6, 0.0, None, 1, 1, 1), "good"),
        (of_stored(1, 11e9, 1e9, 1, 1, 3e9, 1), "bad"),
    ],
)
def test_levels(found, level):
    assert judging.worst_of(found) == level
    for one in found:
        if one.level in ("good", "warning", "bad"):
            assert all((one.limits, one.why, one.remedy))


def test_how_little_room_is_left():
    disks = [Disk("the project", 50_000_000_000, 99), Disk("the run logs", 20_000_000, 99)]
    assert judging.low_of(disks) == "20.0 MB are free on the disk of the run logs, but 500.0 MB are needed"
    assert judging.low_of(disks[:1]) == judging.low_of([]) == ""


def test_a_system_without_proc(monkeypatch, tmp_path):
    monkeypatch.setattr(measuring, "_PROC", tmp_path / "none")

    def none():
        raise OSError

    monkeypatch.setattr(os, "getloadavg", none)
    found = measuring.machine([("the project", tmp_path), ("nothing", tmp_path / "none")])
    assert (found.own, found.available, found.load) == (None, None, None)
    assert [one.holds for one in found.disks] == ["the project"]
    (tmp_path / "a").write_bytes(b"x" * 100)
    (tmp_path / "loop").symlink_to(tmp_path)
    assert 100 <= measuring.size_of(tmp_path) < 400


def test_what_a_viewer_sees(monkeypatch, tmp_path):
    project = tmp_path / "project of somebody"
    project.mkdir()

    async def whole():
        async with pendant(monkeypatch, tmp_path, project=project) as place:
            (project / "a.mcap").write_bytes(b"x" * 7_000)
            vic = place.logged_in("viktoria", Role.VIEWER)
            place.logged_in("annabella")
            assert (await place.browser().get("/api/system/health")).status == 401
            told = (await vic.get("/api/system/health")).told
            found = {one["name"]: one for one in told["watched"]}
            assert found["Run logs"]["value"] == "1 with 7.0 kB; 7.0 kB a day"
            assert found["Replies of the controller"]["level"] == "good"
            assert (told["sessions"], told["pages"]) == (2, 0)
            assert {"yarclang", "numpy", "Python", "Fingerprint of the robot", "Controller"} <= {
                one["name"] for one in told["versions"]
            }
            for secret in (
                "viktoria",
                "annabella",
                "somebody",
                str(tmp_path),
                "localhost",
                os.uname().nodename,
            ):
                assert secret not in told["text"], secret
            # When the disk fills up, the next check raises an alarm.
            monkeypatch.setattr(
                measuring.shutil, "disk_usage", lambda _: SimpleNamespace(total=10**9, free=10**6)
            )
            await asyncio.sleep(1.0)
            await place.service.sampler.look()
            await asyncio.sleep(1.0)
            alarms = (await vic.get("/api/alarms")).told
            assert "1.0 MB are free" in str(alarms)
            assert (await vic.get("/api/system/health")).told["level"] == "bad"

    run(whole())


def test_one_look_for_all_pages(monkeypatch, tmp_path):
    async def whole():
        async with pendant(monkeypatch, tmp_path) as place:
            looked = []
            real = measuring.machine
            monkeypatch.setattr(
                "yarclang.pendant.health.sampling.machine", lambda places: looked.append(1) or real(places)
            )
            sampler = place.service.sampler
            running = asyncio.ensure_future(sampler.run())
            vics = [place.logged_in(f"vic{number}", Role.VIEWER) for number in range(5)]
            pages = [one.socket("/api/robot") for one in vics]
            for _ in range(15):
                await asyncio.sleep(1.0)
                for one in vics:
                    assert (await one.get("/api/system/health")).status == 200
            assert 5 <= len(looked) <= 17
            # A long delay of the event loop counts as the worst of the last minute, and is forgotten after a
            # minute.
            sampler.lag.note(0.3)
            levels = {
                one["name"]: one["level"] for one in (await vics[0].get("/api/system/health")).told["watched"]
            }
            assert levels["Event loop, worst of the last minute"] == "bad"
            await asyncio.sleep(62.0)
            assert sampler.lag.all < 0.01
            monkeypatch.setattr("yarclang.pendant.health.sampling._SLOW_EACH", 0.5)
            await asyncio.sleep(65.0)
            assert {len(one) for one in sampler.history.values()} == {60}
            for one in pages:
                await one.close()
            running.cancel()

    run(whole())
