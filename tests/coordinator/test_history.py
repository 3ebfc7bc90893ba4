"""Tests of motions back along the path, and of the session as a program that compiles to the same motions."""

import asyncio
from itertools import pairwise

import numpy as np
import pytest
from coordinator.virtual import codes, coordinating, done, run
from programs import compiled

from yarclang.coordinator.loading import Source

READY = "MOVEJ 0 10 10 0 40 0 [1.5] (deg,s)"

MOTIONS = {
    "joints": "MOVEJ 20 10 10 0 40 0 [1] (deg,s)",
    "pose": "MOVEJ_RPY {TCP} 100 1000 1300 0 0 0 [50%] (mm,deg,s) {B}",
    "increments": "DMOVEJ 5 5 5 5 5 5 [1] (deg,s)",
    "line": "DMOVE {TCP} 50 0 -50 0 5 0 [2] (mm,deg,s) {B}",
    "speed": "DMOVE {TCP} 80 0 0 0 0 0 [V 40] (mm,deg,s) {B}",
    "time-optimal": "MOVEJ_TOPP 20 10 10 0 40 0 [MIN] (deg,s)",
    "joint spline": "MOVEJ_SPLINE 10 10 10 0 40 0; 15 5 12 0 40 5; 20 10 10 0 30 0 [3] (deg,s)",
    "timetable": "MOVEJ_TIMED 10 10 10 0 40 0 [1]; 15 5 12 0 40 5 [1.7]; 20 10 10 0 30 0 [3] (deg,s)",
    "timetable with velocities": (
        "MOVEJ_TIMED 10 10 10 0 40 0 [1] VEL 12 0 0 0 3 0; 20 10 10 0 45 0 [2] VEL 0 0 0 0 0 0 (deg,s) "
        "STRETCH 1.3"
    ),
    "timetable with accelerations": "MOVEJ_TIMED 10 10 10 0 40 0 [1] VEL 12 0 0 0 3 0 ACC 5 0 0 0 0 0; "
    "20 10 10 0 45 0 [2] VEL 0 0 0 0 0 0 ACC -9 0 0 0 0 0 (deg,s)",
    "chain": (
        "DMOVE {TCP} 60 0 0 0 0 0 [1] (mm,deg,s) {B} BLEND 10\nDMOVE {TCP} 0 0 -60 0 0 0 [1] (mm,deg,s) {B}"
    ),
}


@pytest.mark.parametrize("name", MOTIONS)
def test_back_goes_along_the_same_path(name):
    async def session():
        async with coordinating(record=True) as (world, _, client):
            await done(client, READY)
            before = world.stands()
            since = world.machine.now
            await done(client, MOTIONS[name])
            there = _path(world, since)
            made = await client.motion.offer_back()
            assert made.value is not None, made.diagnostics
            since = world.machine.now
            assert (await client.motion.go(made.value)).well
            assert world.stands() == pytest.approx(before, abs=1e-4)
            assert _apart(there, _path(world, since)) < 0.01  # [deg]
            # The last motion has been taken back, so the motion before is offered next.
            assert (await client.motion.go((await client.motion.offer_back()).value)).well
            assert world.stands() == pytest.approx(np.zeros(6), abs=1e-4)
            assert codes(await client.motion.offer_back()) == ["Y1614"]

    run(session())


def _path(world, since):
    """Return the positions of the robot (N, n) [deg], every 2 ms."""
    from yarclang.robot.actuation import from_counts

    world.catch_up()
    times = np.arange(since, world.machine.now, 0.002)
    counts = world.machine.positions(times, world.robot.controller.motors)
    return from_counts(world.robot, counts) / world.robot.axis_units


def _apart(one, other):
    """Return the largest distance of a path's points from another path [deg], by the nearest sample on a fine
    grid.
    """
    from scipy.spatial import cKDTree

    fine = np.concatenate([np.linspace(a, b, 8) for a, b in pairwise(one)])
    return float(cKDTree(fine).query(other)[0].max())


def test_back_from_where_a_line_was_stopped():
    async def session():
        async with coordinating() as (world, _, client):
            await done(client, READY)
            before = world.stands()
            offer = (await client.motion.offer(MOTIONS["line"])).value
            going = asyncio.create_task(client.motion.go(offer))
            await world.until(lambda: world.moving)
            await asyncio.sleep(1.0)
            client.motion.stop()
            assert not (await going).well
            back = (await client.motion.offer_back()).value
            assert (await client.motion.go(back)).well
            assert world.stands() == pytest.approx(before, abs=1e-4)

    run(session())


BRANCHES = """ROBOT INDUSTRIAL6
DEFAULT [2] (deg,s)
INPUT PART M11
P0010 MOVEJ 5 0 0 0 0 0
WHEN PART ON
  P0030 MOVEJ 5 5 0 0 0 0 [1]
ELSE
  P0040 MOVEJ 5 9 0 0 0 0 [2]
  P0050 MOVEJ 5 5 0 0 0 0 [2]
END
P0070 MOVEJ 40 5 0 0 0 0 [4]
"""


@pytest.mark.parametrize(
    ("part", "places"), [(1, [(5, 5), (5, 0), (0, 0)]), (0, [(5, 5), (5, 9), (5, 0), (0, 0)])]
)
def test_back_from_where_a_program_was_stopped_takes_the_same_branch(part, places, tmp_path):
    (tmp_path / "branches.yarc").write_text(BRANCHES)

    async def session():
        async with coordinating(folder=tmp_path) as (world, coordinator, client):
            world.machine.command("M11->*", 9)
            world.machine.command(f"M11={part}", 9)
            program = (await client.files.load(Source(str(tmp_path / "branches.yarc")))).value
            running = asyncio.create_task(client.motion.run(program, approach=True))
            await world.until(
                lambda: coordinator.progress is not None and coordinator.progress.command.startswith("P0070")
            )
            await asyncio.sleep(0.5)
            client.motion.stop()
            assert not (await running).well
            for place in places:
                assert (await client.motion.go((await client.motion.offer_back()).value)).well
                assert world.stands()[:2] == pytest.approx(place, abs=1e-3)

    run(session())


def test_back_from_within_a_spline_is_refused():
    async def session():
        async with coordinating() as (world, _, client):
            await done(client, READY)
            offer = (await client.motion.offer(MOTIONS["joint spline"])).value
            going = asyncio.create_task(client.motion.go(offer))
            await world.until(lambda: world.moving)
            await asyncio.sleep(1.0)
            client.motion.stop()
            await going
            assert codes(await client.motion.offer_back()) == ["Y1614"]

    run(session())


def test_a_saved_session_compiles_to_the_same_motions(tmp_path):
    plans = []

    async def session():
        async with coordinating() as (_, _, client):
            await done(client, "DEFAULT {TCP} [50%] (mm,deg,s) {B}")
            await done(client, "JOINTS READY 0 10 10 0 40 0 (deg)\nOUTPUT GRIP M1 OFF")
            for line in ("P0010 MOVEJ READY", "DMOVE 50 0 -50 0 5 0 [2]", "SET GRIP ON", "P0010 MOVEJ HOME"):
                offer = await done(client, line)
                plans.extend(offer.plan.motions)
            await done(client, "REPEAT 2\n  DMOVEJ 5 0 0 0 0 0 [1]\nEND")
            undone = (await client.motion.offer_back()).value
            await client.motion.go(undone)
            client.files.save(tmp_path / "saved.yarc")

    run(session())
    text = (tmp_path / "saved.yarc").read_text()
    assert text.startswith("ROBOT INDUSTRIAL6\nSTART 0 0 0 0 0 0 (deg)\n")
    value, found = compiled(text, "INDUSTRIAL6")
    assert value is not None, found
    assert len(value.plan.motions) == 3  # the saved program doesn't contain motions that were taken back
    for mine, saved in zip(plans, value.plan.motions, strict=True):
        assert saved.curve.segment == pytest.approx(mine.curve.segment, rel=1e-12)
        assert np.abs(saved.curve.points - mine.curve.points).max() < 1e-9


def test_a_saved_session_bridges_what_no_command_did():
    async def session():
        async with coordinating() as (world, _, client):
            await done(client, READY)
            offer = (await client.motion.offer("MOVEJ 30 10 10 0 40 0 [2] (deg,s)")).value
            going = asyncio.create_task(client.motion.go(offer))
            await world.until(lambda: world.moving)
            await asyncio.sleep(0.9)
            client.motion.stop()
            await going
            line = await done(client, "DMOVEJ 1 0 0 0 0 0 [1] (deg,s)")
            return client.files.saved(), line.start, line.end

    text, start, end = run(session())
    assert "! to the position to which the robot was moved" in text
    value, found = compiled(text, "INDUSTRIAL6")
    assert value is not None, found
    assert value.plan.motions[1].waypoints[-1] == pytest.approx(start, abs=1e-9)
    assert value.plan.motions[2].waypoints[-1] == pytest.approx(end, abs=1e-7)


def test_what_cannot_be_saved_is_said(tmp_path):
    from yarclang.runtime.actions import Trouble

    async def session():
        async with coordinating() as (_, _, client):
            with pytest.raises(Trouble, match="can't be written: no such file"):
                client.files.save(tmp_path / "missing" / "saved.yarc")

    run(session())
