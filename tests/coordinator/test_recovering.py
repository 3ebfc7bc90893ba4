"""Tests of recovery from any position to a program: to its start or to the nearest position at which it can
begin, slowly and proved. Also tests of start zones, from which programs begin without a confirmation.
"""

import asyncio
import contextlib

import numpy as np
import pytest
from coordinator.virtual import coordinating, run
from handling.carrying import CELL, GIVEN, HEAD, PICK, PUT
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from tests.collision.dense import Dense
from tests.floors import exercises
from yarclang.coordinator.attached import Here
from yarclang.coordinator.loading import Source, load
from yarclang.coordinator.messages import orders
from yarclang.coordinator.recovering import find_recovery
from yarclang.handling.walk import flange_pose
from yarclang.robot.description import load_robot
from yarclang.runtime.actions import Trouble

POST = """units = "mm,deg"
[[obstacles]]
name = "POST"
shape = "box"
frame = "B"
xyz = [0, 700, 900]
size = [120, 120, 1800]
"""
LEFT, RIGHT = [-60.0, 20, -20, 0, -30, 0], [60.0, 20, -20, 0, -30, 0]
PROGRAM = """ROBOT INDUSTRIAL6
CELL "cell.toml"
START -60 20 -20 0 -30 0 (deg)
P0010 MOVEJ -70 20 -20 0 -30 0 [2] (deg,s)
P0020 MOVEJ -70 10 -20 0 -30 0 [2] (deg,s)
WHEN DOOR ON
  P0040 MOVEJ -60 10 -20 0 -30 0 [2] (deg,s)
ELSE
  P0050 MOVEJ -65 10 -20 0 -30 0 [2] (deg,s)
  P0060 MOVEJ -60 10 -20 0 -30 0 [2] (deg,s)
END
P0070 MOVEJ -60 20 -20 0 -30 0 [2] (deg,s)
"""


RANGES = ((-150.0, 150.0), (-40.0, 40.0), (-60.0, 40.0), (-90.0, 90.0), (-80.0, 80.0), (-90.0, 90.0))
"""Ranges of the joints from which the tests draw [deg]."""


def project(folder, cell=POST, program=PROGRAM):
    (folder / "yarc.toml").write_text('robot = "INDUSTRIAL6"\ncell = "cell.toml"\n')
    (folder / "cell.toml").write_text(cell + '\n[inputs]\nDOOR = "M11"\n')
    (folder / "p.yarc").write_text(program)
    return folder


def messages(findings):
    return " ".join(one.message for one in findings)


@contextlib.asynccontextmanager
async def standing(folder, joints, **options):
    """Yield a coordinator whose robot stands at given joint positions, and its owner."""
    async with coordinating(folder=folder, joints=joints, **options) as (world, coordinator, client):
        client.session.release()
        robot = Here(coordinator, "run")
        await robot.ask(orders.Own())
        yield world, coordinator, robot


async def loaded(robot, folder, *, recover=True, **options):
    made = await robot.ask(orders.Load(file=str(folder / "p.yarc"), recover=recover, **options))
    assert made.program is not None, [one.message for one in made.findings]
    return made.program.number


async def asked(robot, number):
    return await robot.ask(orders.OfferRecovery(program=number))


def test_round_what_is_in_the_way_to_the_start_slowly(tmp_path):
    folder = project(tmp_path)

    async def recovered():
        async with standing(folder, RIGHT) as (world, _, robot):
            number = await loaded(robot, folder)
            way = await asked(robot, number)
            assert (way.place, way.title, way.refused, way.assumed) == ("", "the start", (), ())
            assert "SPLINE" in way.offer.motions[0].title
            assert way.offer.motions[0].peaks.velocity.share <= way.share * (1.0 + 1e-6)
            assert way.share == world.robot.controller.rapid_share
            assert world.stands() == pytest.approx(RIGHT, abs=1e-4)  # planning has moved nothing
            assert (await robot.ask(orders.Go(offer=way.offer.number))).well
            assert world.stands() == pytest.approx(LEFT, abs=1e-4)
            again = await asked(robot, number)
            assert (again.place, again.offer) == ("", None)
            # The motion wasn't entered by a user, so it isn't saved with the session. But it can be driven
            # back.
            assert "MOVEJ" not in (await robot.ask(orders.Save())).text
            assert (await robot.ask(orders.OfferBack())).offer is not None

    run(recovered())


def test_the_nearest_place_is_taken_where_the_start_cannot_be_reached(tmp_path):
    """The start lies in front of the wall. The robot stands behind the wall, like the starts of P0020 and
    P0060.
    """
    program = """ROBOT INDUSTRIAL6
CELL "cell.toml"
START 60 20 -20 0 -30 0 (deg)
P0010 MOVEJ 65 20 -20 0 -30 0 [2] (deg,s)
P0020 MOVEJ 60 20 -20 0 -30 0 [2] (deg,s)
"""
    cell = """units = "mm,deg"
[[zones]]
name = "NEVER"
rule = "forbidden"
shape = "joints"
joints = { J1 = [-10, 10] }
"""
    folder = project(tmp_path, cell, program)

    async def recovered():
        async with standing(folder, LEFT) as (world, _, robot):
            way = await asked(robot, await loaded(robot, folder))
            assert (way.place, way.offer) == (None, None)
            assert [one.code for one in way.findings] == ["Y1660", "Y0926"]
            assert "no motion from the robot's position to the start or to" in way.findings[0].message
            assert "NEVER" in way.findings[0].message
            assert world.stands() == pytest.approx(LEFT, abs=1e-4)

    run(recovered())


SKIPPING = """ROBOT INDUSTRIAL6
CELL "cell.toml"
START -60 20 -20 0 -30 0 (deg)
P0010 MOVEJ -110 20 -20 0 -30 0 [2] (deg,s)
P0020 MOVEJ -110 10 -20 0 -30 0 [2] (deg,s)
P0030 MOVEJ -60 20 -20 0 -30 0 [2] (deg,s)
"""


def test_a_start_in_something_gives_way_to_the_nearest_place(tmp_path):
    """After the proof, an obstacle appears at the program's start, so the nearest position is used. The
    obstacle is a part, because a changed cell would make the proof invalid.
    """
    cell = (
        POST
        + """
[[parts]]
name = "CRATE"
shape = "box"
frame = "B"
xyz = [3000, 0, 200]
size = [150, 150, 150]
"""
    )
    folder = project(tmp_path, cell, SKIPPING)

    async def recovered():
        async with standing(folder, [-110.0, -10, -20, 0, -30, 0]) as (world, _, robot):
            number = await loaded(robot, folder)
            way = await asked(robot, number)
            # nobody has confirmed the place of the part yet
            assert (way.place, way.assumed) == ("", ("CRATE",))
            at_start = world.robot
            pose = flange(at_start, LEFT)
            await robot.ask(
                orders.PlacePart(
                    part="CRATE", at="frame", frame="{B}", pose=(*(pose[:3, 3] * 1e3), 0.0, 0.0, 0.0)
                )
            )
            with pytest.raises(Trouble, match="CRATE isn't at the place for which this was proved"):
                await robot.ask(orders.Go(offer=way.offer.number))
            way = await asked(robot, number)
            assert way.place in ("P0020", "P0030")
            assert way.assumed == ()
            assert way.line == {"P0020": 5, "P0030": 6}[way.place]
            assert "CRATE" in messages(way.refused)
            assert (await robot.ask(orders.Go(offer=way.offer.number))).well
            # The robot is now at this position, and the start is still inside of the crate.
            again = await asked(robot, number)
            assert (again.place, again.offer) == (way.place, None)
            # If a command is given, only its beginning is tried.
            named = await asked(robot, await loaded(robot, folder, first="P0010"))
            assert named.place is None
            assert "to P0010 MOVEJ could be proved" in messages(named.findings)
            await robot.ask(orders.PlacePart(part="CRATE", at="gone"))
            assert (await asked(robot, number)).place == ""

    run(recovered())


def test_a_robot_in_something_is_refused_at_once(tmp_path):
    cell = (
        POST.replace("[0, 700, 900]", "[3000, 0, 900]")
        + """
[[parts]]
name = "CRATE"
shape = "box"
frame = "B"
xyz = [-3000, 0, 200]
size = [150, 150, 150]
"""
    )
    folder = project(tmp_path, cell, SKIPPING)

    async def refused():
        async with standing(folder, RIGHT) as (world, _, robot):
            number = await loaded(robot, folder)
            pose = flange(world.robot, RIGHT)
            await robot.ask(
                orders.PlacePart(
                    part="CRATE", at="frame", frame="{B}", pose=(*(pose[:3, 3] * 1e3), 0.0, 0.0, 0.0)
                )
            )
            way = await asked(robot, number)
            assert way.place is None
            assert "no path can begin at the robot's position" in way.findings[0].message
            assert "nearest" not in way.findings[0].message  # other positions weren't tried

    run(refused())


def test_a_part_in_the_gripper_goes_along_and_a_program_that_cannot_run_is_recovered(tmp_path):
    """The run was stopped with a part in the gripper. The program can't begin in this state, but recovery is
    possible.
    """
    (tmp_path / "yarc.toml").write_text('robot = "INDUSTRIAL6"\ncell = "cell.toml"\n')
    (tmp_path / "cell.toml").write_text(CELL.format(**GIVEN))
    (tmp_path / "p.yarc").write_text(HEAD + PICK + PUT)

    async def recovered():
        async with coordinating(folder=tmp_path) as (world, coordinator, client):
            program = (await client.files.load(Source(str(tmp_path / "p.yarc")))).value
            running = asyncio.create_task(client.motion.run(program, approach=True))
            await world.until(
                lambda: coordinator.progress is not None and coordinator.progress.command.startswith("P0050")
            )
            await asyncio.sleep(0.3)
            client.motion.stop()
            assert not (await running).well
            client.session.release()
            robot = Here(coordinator, "run")
            await robot.ask(orders.Own())
            assert (await robot.ask(orders.Load(file=str(tmp_path / "p.yarc")))).program is None
            way = await asked(robot, await loaded(robot, tmp_path))
            assert (way.place, way.assumed) == ("", ())
            assert way.offer is not None
            assert (await robot.ask(orders.Go(offer=way.offer.number))).well

    run(recovered())


def test_orders_that_do_not_belong_are_refused(tmp_path):
    folder = project(tmp_path)

    async def refused():
        async with standing(folder, RIGHT) as (world, coordinator, robot):
            with pytest.raises(Trouble, match="there is no program 77"):
                await asked(robot, 77)
            number = await loaded(robot, folder)
            way = await asked(robot, number)
            other = Here(coordinator, "other")
            assert (await asked(other, await loaded(other, folder))).offer is not None  # every client may ask
            with pytest.raises(Trouble, match="run owns the robot"):
                await other.ask(orders.Go(offer=way.offer.number))
            # If the robot is moved in the meantime, the motion no longer begins at its position, and is
            # refused.
            moved = await robot.ask(orders.Offer(text="MOVEJ 62 20 -20 0 -30 0 [1] (deg,s)"))
            assert (await robot.ask(orders.Go(offer=moved.offer.number))).well
            with pytest.raises(
                Trouble, match="isn't any more at the position from which this motion was planned"
            ):
                await robot.ask(orders.Go(offer=way.offer.number))
            # It is also refused if the cell changes.
            way = await asked(robot, number)
            (folder / "cell.toml").write_text(
                POST.replace("120, 120", "130, 120") + '\n[inputs]\nDOOR = "M11"\n'
            )
            with pytest.raises(Trouble, match="the cell has changed"):
                await robot.ask(orders.Go(offer=way.offer.number))
            with pytest.raises(Trouble, match="the cell has changed"):
                await asked(robot, number)
            assert world.stands() == pytest.approx([62.0, *RIGHT[1:]], abs=1e-4)

    run(refused())


def test_power_is_lost_on_the_way_and_it_is_recovered_again(tmp_path):
    folder = project(tmp_path)

    async def recovered():
        async with standing(folder, RIGHT) as (world, _, robot):
            number = await loaded(robot, folder)
            for _ in range(3):
                way = await asked(robot, number)
                going = asyncio.create_task(robot.ask(orders.Go(offer=way.offer.number)))
                await asyncio.sleep(1.5)
                await robot.ask(orders.Abort())
                assert not (await going).well
                await asyncio.sleep(1.0)
            way = await asked(robot, number)
            assert (await robot.ask(orders.Go(offer=way.offer.number))).well
            assert world.stands() == pytest.approx(LEFT, abs=1e-4)

    run(recovered())


@exercises(recovered=0.3)
@example(here=(-11.0, 0.0, 0.0, 0.0, 0.0, 0.0))  # this motion once was faster than the share by 0.2 %
@given(here=st.tuples(*(st.floats(low, high) for low, high in RANGES)))
@settings(max_examples=12, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_from_anywhere_it_is_clear_of_everything(tally, tmp_path, here):
    """From any position, the motion ends at a position of the program, slowly and without a collision by an
    independent check. Otherwise a reason is given.
    """
    folder = project(tmp_path)

    async def recovered():
        async with standing(folder, RIGHT) as (world, coordinator, robot):
            number = await loaded(robot, folder)
            asked_of = robot.desk.loaded_of(number)
            now = coordinator.carrying.kept.now
            return world.robot, find_recovery(world.robot, asked_of, np.radians(here), now), asked_of.around

    robot, made, cell = run(recovered())
    tally.count("recovered", made.value is not None)
    if made.value is None:
        assert next(one.code for one in made.diagnostics) == "Y1660"
        return
    plan = made.value.made.plan
    q = plan.sample(np.linspace(0.0, plan.duration, 400))[0]
    assert np.abs(q[0] - np.radians(here)).max() < 1e-9
    assert np.abs(q[-1] - made.value.place.there).max() < 1e-9
    assert Dense(robot, cell).distances(q).min() > 0.0
    speeds = np.abs(np.diff(q, axis=0) / (plan.duration / 399)).max(axis=0)
    assert (speeds / robot.limits.velocity).max() <= robot.controller.rapid_share * 1.001


def found_from(folder, text, degrees, cell=POST, **options):
    """Return the result for a robot at given joint positions, without a controller."""
    robot = load_robot("INDUSTRIAL6").value
    made = load(Source(str(project(folder, cell, text) / "p.yarc"), **options), robot)
    assert made.value is not None, made.diagnostics
    return find_recovery(robot, made.value, np.radians(degrees), lambda cell, start: None)


@pytest.mark.parametrize(("angle", "place"), [(80, "the start"), (50, None)])
def test_the_way_to_a_program_keeps_to_the_rules_of_the_cell(tmp_path, angle, place):
    """The motion respects a KEEP rule: at its beginning, the tool is tilted by 65 degrees."""
    rule = f'units = "mm,deg"\n[[keep]]\nframe = "TCP"\nrule = "upright"\nangle = {angle}\n'
    made = found_from(tmp_path, SKIPPING, [40.0, 0, 0, 0, 65.0, 0], rule)
    assert (made.value and made.value.place.title) == place
    if place is None:
        assert any("KEEP {TCP} UPRIGHT 50 (deg) {B}" in one.message for one in made.diagnostics)
    else:
        (command,) = made.value.made.certificate.commands
        assert command.kept[0].largest >= np.radians(64.9)


@pytest.mark.parametrize(("off", "place"), [(0.01, None), (1e-6, "the start"), (0.0, "the start")])
def test_a_joint_beyond_its_limit_is_named(tmp_path, off, place):
    """The limit of J1 is 170 deg. A deviation in the size of rounding counts as being at the limit; a larger
    one is reported.
    """
    made = found_from(tmp_path, SKIPPING, [170.0 + off, 0, 0, 0, 0, 0])
    assert (made.value and made.value.place.title) == place
    if place is None:
        (finding,) = made.diagnostics
        assert finding.message.startswith("J1 is at 170.0100 deg, 0.0100 deg beyond its limits -170 to 170")


def test_a_program_that_moves_nothing_has_only_its_start(tmp_path):
    text = 'ROBOT INDUSTRIAL6\nCELL "cell.toml"\nP0010 STOP\n'
    made = found_from(tmp_path, text, RIGHT)
    assert made.value is None
    assert (
        "to the start could be proved: no path can end at the program's start: there, link_4 is 96 mm deep"
        in made.diagnostics[0].message
    )
    free = found_from(tmp_path, text, RIGHT, 'units = "mm,deg"\n')
    assert free.value.place.title == "the start"


def test_a_command_behind_ways_is_named_and_those_inside_are_no_places(tmp_path):
    made = found_from(tmp_path, PROGRAM, RIGHT, first="P0070")
    assert (made.value.place.index, made.value.place.title) == ("P0070", "P0070 MOVEJ")
    plan = made.value.made.plan
    assert np.degrees(plan.motions[-1].waypoints[-1]) == pytest.approx([-60, 10, -20, 0, -30, 0])
    # The start is in the forbidden window; P0040, P0050 and P0060 are inside of the WHEN.
    cell = """units = "mm,deg"
[[zones]]
name = "NEVER"
rule = "forbidden"
shape = "joints"
joints = { J1 = [-10, 10] }
"""
    refused = found_from(tmp_path, PROGRAM, RIGHT, cell)
    assert refused.value is None
    assert "P0040" not in refused.diagnostics[0].message


def test_of_a_program_of_a_thousand_motions_few_places_are_tried(tmp_path):
    lines = [f"P{10 * at + 10:05d} MOVEJ {-60 - at % 7} 20 -20 0 -30 0 [1] (deg,s)" for at in range(1000)]
    text = "\n".join(['ROBOT INDUSTRIAL6\nCELL "cell.toml"\nSTART -60 20 -20 0 -30 0 (deg)', *lines, ""])
    cell = """units = "mm,deg"
[[zones]]
name = "NEVER"
rule = "forbidden"
shape = "joints"
joints = { J1 = [-10, 10] }
"""
    made = found_from(tmp_path, text, RIGHT, cell)
    assert made.value is None
    assert "to the start or to the 4 nearest places of the program" in made.diagnostics[0].message


def flange(robot, degrees):
    return flange_pose(robot, np.radians(degrees))


START_ZONE = """
[[starts]]
name = "HOME"
joints = { J1 = [-70, -50], J2 = [0, 40], J3 = [-40, 0], J4 = [-10, 10], J5 = [-40, -20], J6 = [-10, 10] }
"""


def test_from_a_start_zone_a_program_begins_by_itself(tmp_path):
    folder = project(tmp_path, POST + START_ZONE, SKIPPING)

    async def ran():
        async with standing(folder, [-52.0, 22, -22, 3, -30, 0]) as (world, _, robot):
            number = await loaded(robot, folder, recover=False)
            way = await robot.ask(orders.AskWay(program=number))
            assert way.zone == "HOME"
            heard = await robot.listen()
            ended = await robot.ask(orders.Run(program=number))
            assert ended.well, ended
            heard.close()
            told = [one.text async for one in heard if one.event == "message"]
            assert any("start zone HOME: it moves there without confirmation" in one for one in told)
            assert world.stands() == pytest.approx(LEFT, abs=1e-4)

    run(ran())


@pytest.mark.parametrize("off", [[-49.99, 20, -20, 0, -30, 0], [-60, 20, -20, 0, -30, 10.01], RIGHT])
def test_outside_of_it_nothing_begins_by_itself(tmp_path, off):
    folder = project(tmp_path, POST + START_ZONE, SKIPPING)

    async def refused():
        async with standing(folder, off) as (world, _, robot):
            number = await loaded(robot, folder, recover=False)
            assert (await robot.ask(orders.AskWay(program=number))).zone == ""
            with pytest.raises(Trouble, match="doesn't stand where"):
                await robot.ask(orders.Run(program=number))
            assert world.stands() == pytest.approx(off, abs=1e-4)

    run(refused())


def test_in_a_start_zone_a_way_that_is_not_proved_is_not_gone(tmp_path):
    """A start zone makes a confirmation unnecessary, but no proof: the motion is refused because a post is in
    its way.
    """
    wide = START_ZONE.replace("[-70, -50]", "[-70, 70]").replace("HOME", "WIDE")
    barrier = """
[[zones]]
name = "NEVER"
rule = "forbidden"
shape = "joints"
joints = { J1 = [-10, 10] }
"""
    folder = project(tmp_path, 'units = "mm,deg"\n' + barrier + wide, SKIPPING)

    async def refused():
        async with standing(folder, RIGHT) as (world, _, robot):
            number = await loaded(robot, folder, recover=False)
            way = await robot.ask(orders.AskWay(program=number))
            assert (way.zone, way.duration_s) == ("WIDE", None)
            with pytest.raises(Trouble, match="doesn't stand where") as trouble:
                await robot.ask(orders.Run(program=number))
            assert "no joint motion to the start is possible" in trouble.value.remedy
            assert world.stands() == pytest.approx(RIGHT, abs=1e-4)

    run(refused())
