"""Tests of a simulated camera: it reports a part's place in counts of its frame; in runs, cameras also lie,
stall, repeat themselves or answer late.
"""

import asyncio
import math

import numpy as np
import pytest
from coordinator.virtual import coordinating, run
from hypothesis import given
from hypothesis import strategies as st
from programs import codes, source

from yarclang.cell.description import Names, read_cell
from yarclang.cell.model import Parts
from yarclang.coordinator.loading import Source
from yarclang.coordinator.signals import receive_values
from yarclang.handling.parts import first_parts
from yarclang.robot.description import load_robot
from yarclang.runtime.notices import Wanted
from yarclang.semantics.declared.meanings import is_word
from yarclang.simulated_cell.camera import Camera, CameraForm
from yarclang.simulated_cell.cameras import load_cameras, read_cameras
from yarclang.simulated_cell.playing import SimulatedCell
from yarclang.simulated_cell.script import Known
from yarclang.simulator.beside import Beside
from yarclang.transforms import rpy_rotation

ROBOT = load_robot("INDUSTRIAL6").value
CELL = """units = "mm,deg"
[frames]
TRAY = {{ parent = "B", xyz = [1000, 200, 300], rpy = [0, 0, 90] }}
HAND = {{ parent = "FLANGE", xyz = [0, 0, 100] }}
[[parts]]
name = "BOX"
shape = "box"
frame = "TRAY"
xyz = {xyz}
rpy = [0, 0, {rz}]
size = [40, 40, 40]
"""
ALL = {"found": "SEEN", "x": "X", "y": "Y", "z": "Z", "rz": "A"}
RANGES = (("SEEN", 0, 1), ("X", -20000, 20000), ("Y", -20000, 20000), ("Z", 0, 20000), ("A", -18000, 18000))
WANTED = Wanted(4, "P0010 WAIT", RANGES, ("SEEN",))


def cell_of(xyz=(10, 20, 30), rz=15.0):
    made = read_cell(source(CELL.format(xyz=list(xyz), rz=rz), "cell.toml"), None, Names(is_word, ROBOT))
    assert made.diagnostics == ()
    return made.value


def camera(cell, frame="TRAY", does=(), **registers):
    return Camera(CameraForm("eye", "BOX", cell.frames[frame], registers or ALL, 0.01, 0.3, tuple(does)))


def nowhere():
    raise AssertionError("this camera stands still")


@given(st.tuples(st.floats(-150, 150), st.floats(-150, 150), st.floats(0, 150)), st.floats(-179.9, 179.9))
def test_it_tells_the_place_in_its_frame(xyz, rz):
    cell = cell_of(xyz, rz)
    eye = camera(cell)
    eye.wanted(WANTED, 10.0)
    assert eye.next_due == pytest.approx(10.3)
    assert eye.answers(10.29, first_parts(cell), nowhere) == []
    (given_,) = eye.answers(10.31, first_parts(cell), nowhere)
    assert (given_.camera, given_.number, given_.values["SEEN"]) == ("eye", 4, 1)
    told = [given_.values[name] / 100.0 for name in ("X", "Y", "Z", "A")]
    assert told == pytest.approx([*xyz, rz], abs=0.0051)
    assert eye.next_due == math.inf


def test_one_that_the_robot_carries():
    cell = cell_of()
    eye = camera(cell, "HAND")
    flange = np.eye(4)
    # the camera's frame, 100 mm along the flange's z axis, has its origin at the part's
    part = first_parts(cell).items[0].transform
    flange[:3, :3] = rpy_rotation([0.0, 0.0, 0.3])
    flange[:3, 3] = part[:3, 3] - [0.0, 0.0, 0.1]
    eye.wanted(WANTED, 0.0)
    (found,) = eye.answers(1.0, first_parts(cell), lambda: flange)
    assert [found.values[name] for name in ("X", "Y", "Z")] == [0, 0, 0]
    assert found.values["A"] == round((90.0 + 15.0 - math.degrees(0.3)) * 100.0)


@pytest.mark.parametrize("xyz", [(300, 0, 0), (0, -201, 0), (0, 0, -1)])
def test_what_it_cannot_tell_is_not_found(xyz):
    eye = camera(cell := cell_of(xyz))
    eye.wanted(WANTED, 0.0)
    (found,) = eye.answers(1.0, first_parts(cell), nowhere)
    assert dict(found.values) == {"SEEN": 0, "X": -20000, "Y": -20000, "Z": 0, "A": -18000}


def test_a_held_part_or_none_is_not_found():
    cell = cell_of()
    held = Parts(tuple(one.__class__(one.part, 1, one.pose, "M1") for one in first_parts(cell).items))
    for parts in (held, Parts(())):
        eye = camera(cell)
        eye.wanted(WANTED, 0.0)
        (found,) = eye.answers(1.0, parts, nowhere)
        assert found.values["SEEN"] == 0


def test_questions_for_others_are_left_to_them():
    eye = camera(cell_of(), x="X")
    for wanted in (
        None,
        Wanted(1, "P1", RANGES, ("SEEN",)),
        Wanted(1, "P1", RANGES, ()),
        Wanted(1, "P1", RANGES, ("X", "JOB")),
        Wanted(1, "P1", (("SEEN", 0, 1),), ("SEEN",)),
    ):
        eye.wanted(wanted, 0.0)
        assert eye.next_due == math.inf


def test_what_bad_cameras_do():
    cell = cell_of()
    eye = camera(cell, does=["nothing", "late", "twice", "far", "nonsense"])
    parts = first_parts(cell)

    def asked(number, at):
        eye.wanted(Wanted(number, "P1", RANGES, ("SEEN",)), at)
        return [(one.number, one.values["X"]) for one in eye.answers(at + 0.9, parts, nowhere)]

    assert asked(1, 0.0) == []
    assert asked(2, 1.0) == []
    eye.wanted(None, 2.0)
    assert [one.number for one in eye.answers(2.9, parts, nowhere)] == [2]
    assert asked(3, 3.0) == [(3, 1000), (3, 1000)]
    assert asked(4, 4.0)[0][1] > 20000
    assert asked(5, 5.0) == [(5, "somewhere")]
    assert asked(6, 6.0) == [(6, 1000)]


KNOWN = Known({}, {}, frozenset({"P0010"}), registers=frozenset({"SEEN", "X"}))


@pytest.mark.parametrize(
    ("text", "code", "said"),
    [
        ('part = "BIX"\nframe = "TRAY"\nx = "X"', "Y1617", "No part of the cell is named BIX"),
        ('part = "BOX"\nframe = "TREY"\nx = "X"', "Y1617", "No frame of the cell is named TREY"),
        ('part = "BOX"\nframe = "TRAY"\nx = "Z"', "Y1617", "no register Z that is filled from outside"),
        ('part = "BOX"\nframe = "TRAY"\nx = "X"\ny = "x"', "Y1618", "stands twice"),
        ('part = "BOX"\nframe = "TRAY"', "Y1618", "fills no register"),
        ('frame = "TRAY"\nx = "X"', "Y1304", "part"),
        ('part = "BOX"\nframe = "TRAY"\nx = "X"\ndoes = ["lie"]', "Y1308", "does"),
        ('part = "BOX"\nframe = "TRAY"\nx = "X"\nunit = 0', "Y1308", "unit"),
        ('part = "BOX"\nframe = "TRAY"\nx = "X"\ncolour = 3', "Y1305", "colour"),
    ],
)
def test_what_is_wrong_in_a_script_is_said(text, code, said):
    made = read_cameras(source(f"[[cameras]]\n{text}\n", "s.toml"), KNOWN, cell_of())
    assert code in codes(made.diagnostics), made.diagnostics
    assert said in " ".join(f"{one.message} {one.help}" for one in made.diagnostics)


def test_a_script_has_cameras_and_a_controller_has_none(tmp_path):
    text = '[[cameras]]\npart = "box"\nframe = "{tray}"\nx = "x"\nfound = "SEEN"\n'
    (tmp_path / "s.toml").write_text(text)
    (form,) = load_cameras(tmp_path / "s.toml", KNOWN, cell_of()).value
    assert (form.part, form.frame.name, dict(form.registers)) == ("BOX", "TRAY", {"found": "SEEN", "x": "X"})
    made = read_cameras(source(text), Known({}, {}, has_places=False), cell_of())
    assert "which a controller doesn't know" in made.diagnostics[0].message
    assert read_cameras(source("[[inputs]]\n"), KNOWN, None).value == ()


PICK = """ROBOT INDUSTRIAL6
REGISTER SEEN 0..1 OUTSIDE
REGISTER X -20000..20000 OUTSIDE
REGISTER BAD 0..99
P0010 MOVEJ 2 0 0 0 0 0 [0.5] (deg,s)
LOOP
  P0020 WAIT SEEN = 1 AND X > -20000 [1] (s) ELSE
    P0030 SET BAD = BAD + 1
  END
  WHEN SEEN = 1
    P0040 EXIT
  END
UNTIL BAD > 9
P0050 SAY "X is {X} after {BAD}"
P0060 MOVEJ 0 0 0 0 0 0 [0.5] (deg,s)
"""


@pytest.mark.parametrize(
    ("does", "bad"),
    [
        ([], 0),
        (["nothing", "nothing"], 2),
        (["late", "late", "answer"], 2),
        (["twice"], 0),
        (["far", "nonsense"], 2),
    ],
)
def test_a_program_with_a_camera_in_a_run(tmp_path, does, bad):
    """Wrong answers only cost passes; none of their values gets into a register."""
    (tmp_path / "cell.toml").write_text(CELL.format(xyz=[12, 0, 30], rz=0))
    (tmp_path / "yarc.toml").write_text('robot = "INDUSTRIAL6"\ncell = "cell.toml"\n')
    (tmp_path / "p.yarc").write_text(PICK)

    async def whole():
        async with coordinating(folder=tmp_path) as (world, coordinator, client):
            cell = coordinator.planner.cell
            form = CameraForm(
                "eye", "BOX", cell.frames["TRAY"], {"found": "SEEN", "x": "X"}, 0.01, 0.2, tuple(does)
            )
            surroundings = SimulatedCell(cell=cell, robot=world.robot, cameras=[form])
            surroundings.attach(Beside(world.machine))
            coordinator.surroundings = surroundings
            receive_values(surroundings, coordinator.values, asyncio.get_running_loop().call_soon_threadsafe)
            program = (await client.files.load(Source(str(tmp_path / "p.yarc")))).value

            async def goes_on():
                """Let the machine's time pass: time passes only when the machine is asked, and this WAIT asks
                nothing.
                """
                while True:
                    world.catch_up()
                    await asyncio.sleep(0.01)

            passing = asyncio.create_task(goes_on())
            ended = await client.motion.run(program, approach=True)
            passing.cancel()
            assert ended.well, ended
            return dict(ended.registers)

    held = run(whole())
    assert held["SEEN"] == 1
    assert held["X"] == 1200
    assert held["BAD"] == bad
