"""Tests of the places of parts between lines, programs and jogs: after complete, stopped and continued runs,
and for several clients.
"""

import asyncio
import contextlib

import numpy as np
import pytest
from coordinator.virtual import codes, coordinating, done, run
from handling.carrying import CELL, GIVEN, HEAD, PICK, PUT

from yarclang.coordinator.engine import NO_LOG
from yarclang.coordinator.live.steering import Twist
from yarclang.coordinator.loading import Source
from yarclang.pipeline.cells import cell_loader
from yarclang.pipeline.checking import check_program_file
from yarclang.pipeline.inputs import Options
from yarclang.runtime.actions import Trouble
from yarclang.simulator.beside import Beside

SET_UP = "DEFAULT {GRIPPER} [50%] (mm,deg,s) {B}"
FEEDER, PUT_AT = [0.3, 0.85, 0.65], [-0.25, 0.9, 0.7]


@pytest.fixture
def project(tmp_path):
    (tmp_path / "yarc.toml").write_text('robot = "INDUSTRIAL6"\ncell = "cell.toml"\n')
    (tmp_path / "cell.toml").write_text(CELL.format(**GIVEN))
    (tmp_path / "all.yarc").write_text(HEAD + PICK + PUT)
    return tmp_path


@contextlib.asynccontextmanager
async def session(folder):
    async with coordinating(folder=folder, log=NO_LOG) as (world, coordinator, client):
        await done(client, SET_UP)
        yield world, coordinator, client


async def loaded(client, folder, name="all.yarc", **options):
    made = await client.files.load(Source(str(folder / name), **options))
    assert made.value is not None, [one.message for one in made.diagnostics]
    return made.value


async def lines(client, text):
    for line in text.splitlines():
        await done(client, line.split(" ", 1)[1])


def along_z(speed):
    return Twist(np.array([0.0, 0.0, speed]), np.zeros(3), "base")


def where(client):
    """Return for each part, by name, the gripper that holds it, or the place or places where it may lie."""
    found = {}
    for one in client.parts.where().value.present.parts.items:
        place = one.gripper or tuple(one.transform[:3, 3].round(4).tolist())
        found.setdefault(one.name, []).append(place if one.is_sure else ("perhaps", place))
    return {name: places[0] if len(places) == 1 else places for name, places in found.items()}


def test_lines_end_as_the_program(project):
    async def typed():
        async with session(project) as (_, _, client):
            assert where(client) == {"BOX": tuple(FEEDER)}
            await done(client, "MOVEJ READY")
            await lines(client, PICK)
            assert where(client) == {"BOX": "M1"}
            made = await client.motion.offer("MOVEJ_RPY 0 0 120 0 0 0 {PUT}")
            assert made.value.certificate.commands[0].carries == ("BOX",)
            await lines(client, PUT)
            assert where(client) == {"BOX": tuple(PUT_AT)}
            assert "Y0940" in codes(await client.motion.offer("SET GRIP ON"))

    run(typed())


def test_a_part_in_the_gripper_meets_what_the_empty_gripper_passes(project):
    async def typed():
        async with session(project) as (_, _, client):
            await done(client, "MOVEJ READY")
            await done(client, "MOVEJ_RPY 0 0 60 0 0 0 {PUT}")
            below = "MOVEL 0 0 -15 0 0 0 [2] {PUT}"
            empty = await client.motion.offer(below)
            assert empty.value is not None
            assert (await client.parts.put("BOX", "{GRIPPER}", np.eye(4))).value is not None
            held = await client.motion.offer(below)
            assert held.value is None
            assert "BOX penetrates" in " ".join(one.message for one in held.diagnostics)

    run(typed())


def test_a_jog_stops_in_front_of_what_the_part_would_meet(project):
    async def jogged(held):
        async with session(project) as (world, _, client):
            await done(client, "MOVEJ READY")
            await done(client, "MOVEJ_RPY 0 0 60 0 0 0 {PUT}")
            if held:
                await client.parts.put("BOX", "{GRIPPER}", np.eye(4))
            else:
                await client.parts.gone("BOX")
            down = along_z(-0.03)
            drive = (await client.live.drive(down, moving="{GRIPPER}")).value
            while drive.alive and not drive.why:
                drive.want(down)
                await asyncio.sleep(0.05)
            why = drive.why
            drive.finish()
            await drive.ended()
            return why, world.stands()

    empty, far = run(jogged(held=False))
    why, near = run(jogged(held=True))
    assert "BOX" in why
    assert "BOX" not in empty
    assert not np.allclose(near, far, atol=0.1)


def test_a_jog_leaves_a_part_and_does_not_come_back_into_it(project):
    async def jogged():
        async with session(project) as (_, coordinator, client):
            await done(client, "MOVEJ READY")
            await lines(client, PICK[: PICK.index("P0040")] + "P0035 SET GRIP OFF\n")
            known = client.parts.where().value
            assert known.present.leaving
            up, down = along_z(0.05), along_z(-0.05)
            drive = (await client.live.drive(up, moving="{GRIPPER}")).value
            for _ in range(80):
                drive.want(up)
                await asyncio.sleep(0.05)
            assert not drive.why
            while drive.alive and not drive.why:
                drive.want(down)
                await asyncio.sleep(0.05)
            assert "BOX" in drive.why
            drive.finish()
            await drive.ended()
            assert not client.parts.where().value.present.leaving
            assert coordinator.carrying.kept

    run(jogged())


def test_a_program_leaves_its_parts_to_the_next(project):
    async def ran():
        async with session(project) as (_, _, client):
            ended = await client.motion.run(await loaded(client, project), approach=True)
            assert ended.well, ended
            assert where(client) == {"BOX": tuple(PUT_AT)}
            # The box isn't at the feeder any more, so a program that moves to the feeder to grip it gets a
            # finding.
            made = await client.files.load(Source(str(project / "all.yarc")))
            assert "Y0940" in codes(made) or made.value is None

    run(ran())


@pytest.mark.parametrize(
    ("at", "expected"),
    [("P0020", tuple(FEEDER)), ("P0040", "M1"), ("P0050", "M1"), ("P0080", tuple(PUT_AT))],
)
def test_a_run_that_is_stopped_leaves_them_as_it_came(project, at, expected):
    async def ran():
        async with session(project) as (world, coordinator, client):
            program = await loaded(client, project)
            running = asyncio.create_task(client.motion.run(program, approach=True))
            await world.until(
                lambda: coordinator.progress is not None and coordinator.progress.command.startswith(at)
            )
            await asyncio.sleep(0.4)
            client.motion.stop()
            ended = await running
            assert not ended.well
            assert ended.command_index == at
            assert where(client) == {"BOX": expected}
            # Continue with the rest of the program. If the robot is at a part, it returns along the path of
            # the stopped motion.
            rest = await loaded(client, project, first=at)
            assert (await client.motion.run(rest, approach=True)).well
            assert where(client)["BOX"] == tuple(PUT_AT)

    run(ran())


def test_a_run_from_a_set_on_begins_where_the_robot_stands(project):
    async def ran():
        async with session(project) as (_, _, client):
            await done(client, "MOVEJ READY")
            await lines(client, "\n".join(PICK.splitlines()[:2]))
            rest = await loaded(client, project, first="P0030")
            assert (await client.motion.run(rest, approach=True)).well
            assert where(client) == {"BOX": tuple(PUT_AT)}

    run(ran())


def test_a_run_that_is_killed_at_any_instant_agrees_with_the_gripper(project):
    """At whatever instant a run is killed, the coordinator's places agree with the output of the controller:
    the part is where the output was switched.
    """

    async def ran(after):
        async with session(project) as (world, coordinator, client):
            program = await loaded(client, project)
            heard = []
            world.machine.variables.watch("M", 1, heard.append)
            running = asyncio.create_task(client.motion.run(program, approach=True))
            await world.until(
                lambda: coordinator.progress is not None and coordinator.progress.command.startswith("P0020")
            )
            await asyncio.sleep(after)
            client.motion.abort()
            ended = await running
            assert not ended.well
            known = where(client)["BOX"]
            if not heard:
                assert known == tuple(FEEDER)
            elif heard[-1] == 1.0:
                assert known == "M1"
            else:
                assert known == tuple(PUT_AT)
            return len(heard)

    counts = [run(ran(after)) for after in np.linspace(0.6, 1.6, 6)]
    assert min(counts) == 0
    assert max(counts) >= 1


def test_a_line_that_was_offered_before_the_parts_changed_is_not_carried_out(project):
    async def typed():
        async with session(project) as (_, coordinator, client):
            await done(client, "MOVEJ READY")
            offer = (await client.motion.offer("MOVEJ_RPY 0 0 120 0 0 0 {PUT}")).value
            program = await loaded(client, project)
            other = coordinator.attach("other")
            with pytest.raises(Trouble, match=r"watches|owns"):
                await other.parts.gone("BOX")
            await client.parts.put("BOX", "{PUT}", np.eye(4))
            for moving in (
                lambda: client.motion.go(offer),
                lambda: client.motion.run(program, approach=True),
            ):
                with pytest.raises(Trouble, match="BOX isn't at the place for which this was proved") as told:
                    await moving()
                assert told.value.code == "Y1620"
            # Both clients see the same places.
            assert where(other) == {"BOX": tuple(PUT_AT)}
            await client.parts.as_filed()
            assert (await client.motion.go(offer)).well

    run(typed())


def test_a_second_pass_is_proved_with_the_parts_where_the_first_has_left_them(project):
    (project / "two.yarc").write_text(
        HEAD + PICK + PUT + PICK.replace("{FEEDER}", "{PUT}").replace("P00", "P01")
        + PUT.replace("{PUT}", "{FEEDER}").replace("P00", "P01")
    )  # fmt: skip
    post = PUT.replace("P0070 SET GRIP OFF\n", "").replace("P0080", "P0081")
    (project / "never.yarc").write_text(HEAD + PICK + post)

    async def ran():
        async with session(project) as (_, _, client):
            program = await loaded(client, project, "two.yarc")
            assert (await client.motion.run(program, approach=True, times=2)).well
            assert where(client) == {"BOX": tuple(FEEDER)}

    run(ran())


def test_setting_an_output_by_hand_takes_and_puts(project):
    async def typed():
        async with session(project) as (_, _, client):
            await done(client, "MOVEJ READY")
            await done(client, "MOVEJ_RPY 0 0 120 0 0 0 {FEEDER}")
            await client.signals.set("GRIP", "ON")
            assert where(client) == {"BOX": tuple(FEEDER)}
            await client.signals.set("GRIP", "OFF")
            await done(client, "MOVEL 0 0 0 0 0 0 [1] {FEEDER}")
            await client.signals.set("GRIP", "ON")
            assert where(client) == {"BOX": "M1"}
            await done(client, "MOVEL 0 0 120 0 0 0 [1] {FEEDER}")

    run(typed())


def test_a_way_back_carries_the_part(project):
    async def typed():
        async with session(project) as (_, _, client):
            await done(client, "MOVEJ READY")
            await lines(client, PICK)
            made = await client.motion.offer_back()
            assert made.value is not None, made.diagnostics
            assert made.value.certificate.commands[0].carries == ("BOX",)
            assert (await client.motion.go(made.value)).well

    run(typed())


def test_a_when_leaves_the_way_that_was_taken(project):
    over, rest = PICK.splitlines()[0], "\n".join(PICK.splitlines()[1:])
    (project / "when.yarc").write_text(f"{HEAD}{over}\nWHEN GOOD ON\n{rest}\nEND\nP0090 MOVEJ READY\n")

    async def ran(good):
        async with session(project) as (world, _, client):
            world.machine.command("M11->*", 9)
            world.machine.command(f"M11={good}", 9)
            program = await loaded(client, project, "when.yarc")
            ended = await client.motion.run(program, approach=True)
            assert ended.well, ended
            return where(client)

    assert run(ran(1)) == {"BOX": "M1"}
    assert run(ran(0)) == {"BOX": tuple(FEEDER)}


def test_a_cell_without_parts_has_none(tmp_path):
    async def typed():
        async with coordinating(folder=tmp_path) as (_, _, client):
            with pytest.raises(Trouble, match="has no parts"):
                client.parts.where()

    run(typed())


def compiled(folder, name):
    checked = check_program_file(str(folder / f"{name}.yarc"), Options(robot="INDUSTRIAL6"))
    (folder / f"{name}.pmc").write_text(checked.compiled.text)


def test_a_controller_text_is_followed_by_its_program(project):
    compiled(project, "all")

    async def ran():
        async with session(project) as (_, _, client):
            text = await loaded(client, project, "all.pmc")
            assert (await client.motion.run(text, approach=True)).well
            assert where(client) == {"BOX": tuple(PUT_AT)}
            # The text was proved with the part at the feeder.
            with pytest.raises(Trouble, match="BOX isn't at the place for which this was proved"):
                await client.motion.run(text, approach=True)

    run(ran())


def test_a_text_whose_program_is_not_known_leaves_doubt(project):
    compiled(project, "all")
    (project / "all.yarc").unlink()

    async def ran():
        async with session(project) as (_, _, client):
            made = await client.files.load(
                Source(str(project / "all.pmc"), options=Options(cell=str(project / "cell.toml")))
            )
            assert made.value is not None, made.diagnostics
            assert (await client.motion.run(made.value, approach=True)).well
            assert "controller text" in client.parts.where().value.doubt
            for ask in (lambda: client.motion.offer("MOVEJ HOME"), lambda: client.live.drive(along_z(0.01))):
                with pytest.raises(Trouble, match="the places of the cell's parts") as told:
                    await ask()
                assert told.value.code == "Y1620"
            await client.parts.put("BOX", "{PUT}", np.eye(4))
            assert not client.parts.where().value.doubt
            await done(client, "MOVEJ HOME")

    run(ran())


def test_sensors_see_the_parts_where_the_coordinator_has_them(project):
    from yarclang.robot.description import load_robot
    from yarclang.simulated_cell.playing import SimulatedCell

    vacuum = '\n[[sensors]]\nkind = "vacuum"\ninput = "GOOD"\ngripper = "GRIP"\n'
    (project / "cell.toml").write_text(CELL.format(**GIVEN) + vacuum)
    robot = load_robot("INDUSTRIAL6").value
    cell = cell_loader(project, robot)("cell.toml", None).value

    async def typed():
        async with session(project) as (world, coordinator, client):
            coordinator.surroundings = around = SimulatedCell(cell=cell, robot=robot)
            around.attach(Beside(world.machine))

            def agree():
                world.catch_up()
                kept = {
                    one.name: (one.gripper, one.transform)
                    for one in client.parts.where().value.present.parts.items
                }
                seen = {one.name: (one.gripper, one.transform) for one in around._sensing.parts.items}
                assert kept.keys() == seen.keys()
                for name, (gripper, pose) in kept.items():
                    assert gripper == seen[name][0]
                    assert np.allclose(pose, seen[name][1], atol=1e-4)
                return seen

            await done(client, "MOVEJ READY")
            for line in (PICK + PUT).splitlines():
                await done(client, line.split(" ", 1)[1])
                await asyncio.sleep(0.1)
                agree()
            await client.parts.as_filed()
            await asyncio.sleep(0.1)
            assert agree()["BOX"][1][:3, 3] == pytest.approx(FEEDER)
            await client.parts.put("BOX", "{GRIPPER}", np.eye(4))
            await asyncio.sleep(0.1)
            assert agree()["BOX"][0] == "M1"
            assert (await client.signals.read("GOOD")).value == 1.0
            await client.parts.gone("BOX")
            await asyncio.sleep(0.1)
            assert not agree()
            assert (await client.signals.read("GOOD")).value == 0.0

    run(typed())


def test_two_grippers_hold_a_part_each(project):
    second = '[frames.SECOND]\nparent = "FLANGE"\nxyz = [150, 150, 0]\nrpy = [90, 0, 0]\n[joints]'
    can = (
        '\n[[parts]]\nname = "CAN"\nshape = "cylinder"\nframe = "PUT"\nradius = 20\nlength = 60\nmargin = 0\n'
    )
    cell = CELL.format(**GIVEN).replace("[joints]", second) + can
    output = 'GRIP2 = { variable = "M3", grips = "SECOND", reach = 15 }\nTAKEN = {'
    (project / "cell.toml").write_text(cell.replace("TAKEN = {", output))

    async def typed():
        async with session(project) as (_, _, client):
            await done(client, "MOVEJ READY")
            await lines(client, PICK)
            await done(client, "MOVEJ_RPY {SECOND} 0 0 120 0 0 0 {PUT}")
            await done(client, "MOVEL {SECOND} 0 0 0 0 0 0 [2] {PUT}")
            await done(client, "SET GRIP2 ON")
            assert where(client) == {"BOX": "M1", "CAN": "M3"}
            # Put the part down beside the other one.
            await done(client, "SET GRIP OFF")
            await done(client, "SET GRIP ON")
            made = await client.motion.offer("MOVEL {SECOND} 0 0 120 0 0 0 [2] {PUT}")
            assert set(made.value.certificate.commands[0].carries) == {"BOX", "CAN"}
            assert (await client.motion.go(made.value)).well
            with pytest.raises(Trouble, match="the gripper holds BOX"):
                await client.parts.put("CAN", "{GRIPPER}", np.eye(4))

    run(typed())


def test_a_program_that_is_run_step_by_step_carries_its_part(project):
    async def ran():
        async with session(project) as (world, coordinator, client):
            program = await loaded(client, project, by_steps=True)
            running = asyncio.create_task(client.motion.run(program, approach=True))
            seen = []
            while not running.done():
                await world.until(lambda: coordinator.engine.session.paused or running.done(), 200.0)
                seen.append(where(client)["BOX"])
                client.motion.resume()
                await asyncio.sleep(0.05)
            assert (await running).well
            assert [place for at, place in enumerate(seen) if place != seen[at - 1] or not at] == [
                tuple(FEEDER),
                "M1",
                tuple(PUT_AT),
            ]

    run(ran())
