"""Tests of the effects of typed texts, in virtual time."""

import asyncio

import pytest
from coordinator.virtual import run
from repl.talking import talking

from yarclang.repl.dot import dot_commands
from yarclang.simulated_cell.playing import SimulatedCell
from yarclang.simulator.beside import Beside

MOVE = "MOVEJ 10 0 0 0 20 0 [1] (deg,s)"


def test_a_motion_is_shown_and_asked_for_before_anything_moves(tmp_path):
    async def session():
        async with talking(tmp_path, asks=True) as person:
            told = await person.type(MOVE)
            assert "MOVEJ  1.00 s  J5 at" in told
            assert person.asked == "go? [y/N] "
            assert person.world.stands() == pytest.approx([0] * 6, abs=1e-4)
            assert await person.type("n") == "nothing moved"
            assert person.world.stands() == pytest.approx([0] * 6, abs=1e-4)
            await person.type(MOVE)
            assert await person.type("y") == "done"
            assert person.world.stands() == pytest.approx([10, 0, 0, 0, 20, 0], abs=1e-4)
            assert not person.interpreter.failed

    run(session())


@pytest.mark.parametrize("answer", ["", "yess", "MOVEJ 0 0 0 0 0 0 [1] (deg,s)", "no"])
def test_only_yes_is_yes(tmp_path, answer):
    async def session():
        async with talking(tmp_path, asks=True) as person:
            assert "nothing moved" in await person.type(MOVE, answer)
            assert person.world.stands() == pytest.approx([0] * 6, abs=1e-4)

    run(session())


def test_go_moves_at_once_and_ask_asks_again(tmp_path):
    async def session():
        async with talking(tmp_path, asks=True) as person:
            assert "done" in await person.type(".go", MOVE)
            await person.type(".ask", "DMOVEJ 1 0 0 0 0 0 [1] (deg,s)")
            assert person.asked

    run(session())


def test_what_is_typed_while_something_moves_waits_for_its_end(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            await person.begin(MOVE)
            person.interpreter.typed("DMOVEJ 5 0 0 0 0 0 [1] (deg,s)")
            await person.settled()
            assert person.taken().count("done") == 2
            assert person.world.stands() == pytest.approx([15, 0, 0, 0, 20, 0], abs=1e-3)

    run(session())


def test_stop_overtakes_and_drops_what_waits(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            await person.begin("MOVEJ 40 0 0 0 20 0 [5] (deg,s)")
            person.interpreter.typed(MOVE)
            await asyncio.sleep(1.0)
            person.interpreter.typed(".stop")
            took = await person.world.until(lambda: not person.world.moving)
            assert took < 0.6
            await person.settled()
            told = person.taken()
            assert "1 that waited is dropped" in told
            assert "stopped on its path" in told
            assert 0.0 < person.world.stands()[0] < 20.0
            assert person.interpreter.failed

    run(session())


def test_ctrl_c_stops_on_the_path_and_aborts_the_second_time(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            await person.begin("MOVEJ 40 0 0 0 20 0 [5] (deg,s)")
            await asyncio.sleep(1.0)
            person.interpreter.interrupt()
            await asyncio.sleep(0.01)
            person.interpreter.interrupt()
            await person.world.until(lambda: not person.world.moving)
            await person.settled()
            told = person.taken()
            assert "stopping on the path" in told
            assert "aborting" in told
            person.interpreter.interrupt()  # nothing moves, so that the interrupt has no effect
            assert person.taken() == ""
            await person.begin("DMOVEJ 20 0 0 0 0 0 [5] (deg,s)")
            person.interpreter.interrupt()
            # after a new motion, the first interrupt stops on the path again
            assert "stopping on the path" in person.taken()

    run(session())


def test_ctrl_c_answers_a_question_with_no(tmp_path):
    async def session():
        async with talking(tmp_path, asks=True) as person:
            await person.type(MOVE)
            person.interpreter.interrupt()
            await person.settled()
            assert "nothing moved" in person.taken()
            assert not person.asked

    run(session())


def test_hold_and_enter_goes_on(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            await person.begin(MOVE)
            person.interpreter.typed(".hold")
            await person.world.until(lambda: not person.world.moving)
            await asyncio.sleep(1.0)
            assert not person.world.moving
            person.interpreter.typed("")
            await person.settled()
            assert person.taken().endswith("done")
            assert person.world.stands() == pytest.approx([10, 0, 0, 0, 20, 0], abs=1e-4)

    run(session())


def test_override(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            assert await person.type(".override") == "override 100 %"
            await person.type(".override 50%")
            since = asyncio.get_running_loop().time()
            await person.type(MOVE)
            assert asyncio.get_running_loop().time() - since > 1.8
            assert "the override is from 1 to 100" in await person.type(".override 0")
            assert "isn't a percentage" in await person.type(".override fast")

    run(session())


def test_findings_are_those_of_the_editor(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            told = await person.type("MOVJE 10 0 0")
            assert "Y0202" in told
            assert "did you mean MOVEJ?" in told
            told = await person.type("MOVEJ 10 0 0 0 20 0 [0.01] (deg,s)")
            assert "error Y06" in told
            assert person.world.stands() == pytest.approx([0] * 6, abs=1e-4)
            assert person.interpreter.failed

    run(session())


def test_declarations_stay_and_are_listed(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            assert (
                await person.type("FRAME {TABLE} 800 200 300 0 0 90 (mm,deg) {B}")
                == "it is valid from now on"
            )
            assert "{TABLE}  800.000 200.000 300.000 mm" in await person.type(".frames")
            assert "in {TABLE}" in await person.type(".where table")
            assert "{FLANGE} " in await person.type(".where {B} flange")

    run(session())


def test_where_and_joints(tmp_path):
    async def session():
        async with talking(tmp_path, joints=[10, 0, 0, 0, 20, 0]) as person:
            assert await person.type(".joints") == (
                "J1 10.000 deg, J2 0.000 deg, J3 0.000 deg, J4 0.000 deg, J5 20.000 deg, J6 0.000 deg"
            )
            assert (await person.type(".where")).startswith("{TCP} ")
            assert "Y0301" in await person.type(".where {NOWHERE}")
            assert "at most two frames" in await person.type(".where A B C")

    run(session())


def test_plan_moves_nothing(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            assert "MOVEJ  1.00 s" in await person.type(f".plan {MOVE}")
            assert "nothing moves" in await person.type(".plan LET A = 3")
            assert "a command is missing" in await person.type(".plan")
            assert person.world.stands() == pytest.approx([0] * 6, abs=1e-4)

    run(session())


def test_back_takes_the_last_motion_back(tmp_path):
    async def session():
        async with talking(tmp_path, joints=[0, 0, 0, 0, 30, 0]) as person:
            await person.type("DMOVE {TCP} 0 0 -50 0 0 0 [2] (mm,deg,s) {B}", ".back")
            assert person.world.stands() == pytest.approx([0, 0, 0, 0, 30, 0], abs=1e-3)
            assert "Y1614" in await person.type(".back")

    run(session())


def test_plot_draws_what_was_planned_last(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            assert await person.type(".plot") == "nothing has been planned yet"
            await person.type(f".plan {MOVE}", ".plot way.png")
            assert (tmp_path / "way.png").read_bytes().startswith(b"\x89PNG")
            assert "must end with" in await person.type(".plot way.txt")
            assert "can't be written" in await person.type(".plot nowhere/way.png")

    run(session())


def test_outputs_and_inputs(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            assert "no INPUT and no OUTPUT" in await person.type(".io")
            await person.type("INPUT DOOR M11", "OUTPUT GRIP M1 OFF")
            assert await person.type(".set grip on") == "GRIP is 1"
            assert await person.type(".io") == "DOOR  input  0\nGRIP  output  1"
            assert "Y02" in await person.type(".set NOTHING ON")
            assert "it is written" in await person.type(".set GRIP")
            assert "DOOR is an input of a real controller" in await person.type(".set DOOR ON")
            assert "M12 is an input of a real controller" in await person.type(".set M12 ON")

    run(session())


def test_inputs_of_a_simulated_robot_are_set_by_hand(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            person.coordinator.surroundings = cell = SimulatedCell()
            cell.attach(Beside(person.world.machine))
            await person.type("INPUT DOOR M11", "OUTPUT GRIP M1 OFF")
            assert await person.type(".set door on") == "DOOR is 1"
            assert await person.type(".io") == "DOOR  input  1\nGRIP  output  0"
            assert await person.type(".set M12 2.5") == "M12 is 2.5"
            await asyncio.sleep(0.05)
            person.world.catch_up()
            assert person.world.machine.command("M12", 7).items == ("2.5",)

    run(session())


def test_mistyped_dot_commands(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            assert "did you mean .where?" in await person.type(".wehre")
            assert ".help lists them" in await person.type(".xyzzy")
            assert "there is no command" in await person.type(".")

    run(session())


def test_help_tells_of_every_command(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            told = await person.type(".help")
            assert all(f"  {one.line}" in told and one.summary in told for one in dot_commands().values())
            assert (await person.type(".help teach")).startswith(".teach NAME")
            assert "there is no command .nothing" in await person.type(".help nothing")

    run(session())


def test_another_client_owns_the_robot(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            await person.type(".release")
            other = person.coordinator.attach("pendant")
            other.session.own()
            told = await person.type(MOVE)
            assert "pendant owns the robot" in told
            assert person.world.stands() == pytest.approx([0] * 6, abs=1e-4)
            other.session.release()
            assert "done" in await person.type(MOVE)  # the motion makes the person the owner again

    run(session())


def test_messages_are_kept_for_the_log(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            await person.type(MOVE)
            told = await person.type(".log")
            assert "move" in told
            assert told.endswith("nothing is logged yet")
            assert "isn't a number" in await person.type(".log many")

    run(session())


def test_quit_ends_though_something_waits(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            person.interpreter.typed(".quit")
            assert person.interpreter.ended

    run(session())


def test_quit_brings_the_robot_to_rest(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            await person.begin("MOVEJ 40 0 0 0 20 0 [20] (deg,s)")
            person.interpreter.typed(".quit")
            assert await person.world.until(lambda: not person.world.moving) < 0.6
            assert person.world.stands()[0] < 20.0

    run(session())


def test_a_bug_of_ours_keeps_the_prompt(tmp_path, monkeypatch):
    async def session():
        async with talking(tmp_path) as person:
            monkeypatch.setattr(person.coordinator.planner, "offer", lambda *_: 1 / 0)
            told = await person.type(MOVE)
            assert "a bug of yarclang has ended this command: ZeroDivisionError" in told
            assert "test_interpreter.py" in told
            monkeypatch.undo()
            assert "done" in await person.type(MOVE)

    run(session())
