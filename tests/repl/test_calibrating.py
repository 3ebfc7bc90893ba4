"""Tests of calibration at the prompt, with a simulated robot that touches known places."""

import shutil

import numpy as np
import pytest
from coordinator.virtual import run
from repl.talking import talking

from yarclang.robot.description import load_robot

TILTS = ("0 0 0", "30 0 0", "-30 0 0", "0 30 0")
AT = "MOVEJ_RPY {{TRUE}} 0 1100 1300 {} [3] (mm,deg,s) {{B}}"


def test_the_tip_of_a_tool(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            await person.type("FRAME {TRUE} 20 130 210 0 0 0 (mm,deg) {FLANGE}")
            assert "0 of 4: move the tool's tip" in await person.type(".calibrate tcp torch")
            for number, tilt in enumerate(TILTS, 1):
                assert "done" in await person.type(AT.format(tilt))
                told = await person.type(".touch")
                assert f"{number} of 4" in told or number == 4
            assert "{TORCH} is at 20.00" in told
            assert "it is valid" in await person.type(".done")
            line = person.coordinator.lines.declarations[-1].split()
            assert line[1] == "{TORCH}"
            assert [float(word) for word in line[2:5]] == pytest.approx([20, 130, 210], abs=0.02)
            assert "no calibration is in progress" in await person.type(".touch")

    run(session())


def test_touches_that_tell_nothing(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            await person.type(".calibrate tcp torch", ".touch", ".touch", ".touch")
            assert "Y1902" in await person.type(".touch")
            assert "no result yet" in await person.type(".done")
            assert "3 of 4" in await person.type(".untouch")
            assert "discarded" in await person.type(".cancel")

    run(session())


def test_a_frame(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            await person.type(".calibrate frame table")
            for place in ("0 1250 900", "200 1250 900", "0 1350 900"):
                told = await person.type(f"MOVEJ_RPY {{TCP}} {place} 0 0 0 [3] (mm,deg,s) {{B}}", ".touch")
            assert "{TABLE} is found" in told
            await person.type(".done")
            frame = person.interpreter.scope().frame("TABLE")
            np.testing.assert_allclose(frame.transform[:3, 3], [0, 1.25, 0.9], atol=1e-5)
            np.testing.assert_allclose(frame.transform[:3, :3], np.eye(3), atol=1e-4)
            assert "isn't a frame on the flange" in await person.type(".calibrate frame other table")

    run(session())


def test_offsets_of_a_robot_of_ones_own(tmp_path):
    ours = load_robot("industrial6").value
    folder = shutil.copytree(ours.folder, tmp_path / "arm")

    async def session():
        async with talking(tmp_path, robot=str(folder), joints=[0, 0.5, 0, 0, 0, 0]) as person:
            assert "move J2 to its mark" in await person.type(".calibrate home J2 0")
            assert "the reading of J2 is off by +0.5000 deg" in await person.type(".touch")
            told = await person.type(".done")
            assert "+ a0 = [0, 12833.94, 14654.35, 0, 0, 0]  # counts" in told
            assert "is written" in await person.type("y")

    run(session())
    robot = load_robot(str(folder)).value
    np.testing.assert_allclose(robot.actuation.offset[1:3], [12833.94, 14654.35])


def test_the_standard_library_is_not_changed(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            await person.type(".calibrate home J2 0", ".touch")
            assert "which can't be changed" in await person.type(".done")

    run(session())


@pytest.mark.parametrize(
    ("text", "word"),
    [
        (".calibrate", ".calibrate takes"),
        (".calibrate tcp", "one name"),
        (".calibrate home", "joints and their positions"),
        (".calibrate home J9 0", "no joint J9"),
        (".calibrate home J1 x", "isn't a position"),
        (".done", "no calibration"),
    ],
)
def test_misuse(tmp_path, text, word):
    async def session():
        async with talking(tmp_path) as person:
            assert word in await person.type(text)

    run(session())
