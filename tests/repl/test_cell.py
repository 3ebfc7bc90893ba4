"""Tests of a project's cell at the prompt: no planned motion collides with it."""

import numpy as np
import pytest
from coordinator.virtual import codes, coordinating, run
from repl.talking import talking

from yarclang.coordinator.live.steering import JointVelocity

TABLE = """\
units = "mm,deg"
[frames.TABLE]
parent = "B"
xyz = [0, 1174.4, 1300]
rpy = [0, 0, 0]

[[obstacles]]
name = "TABLE"
frame = "TABLE"
shape = "box"
size = [1200, 1200, 100]
"""
"""A table under {TCP}, which is at 0 1174.4 1764 mm in HOME; the table's top is at 1350 mm."""

BELOW = "DMOVE {TCP} 0 0 -600 0 0 0 [5] (mm,deg,s) {B}"
"""A motion to 186 mm below the table's top."""


@pytest.fixture
def project(tmp_path):
    (tmp_path / "yarc.toml").write_text('robot = "INDUSTRIAL6"\ncell = "cell.toml"\n')
    (tmp_path / "cell.toml").write_text(TABLE)
    return tmp_path


def test_without_a_cell_the_motion_is_possible(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            assert "done" in await person.type(BELOW)
            assert person.world.stands()[1] != 0.0

    run(session())


def test_a_motion_below_the_table_is_refused(project):
    async def session():
        async with talking(project) as person:
            assert "error Y0901" in await person.type(BELOW)
            assert person.world.stands() == pytest.approx([0] * 6, abs=1e-9)
            assert "done" in await person.type("MOVEJ_RPY {TCP} 0 0 300 0 0 0 [5] (mm,deg,s) {TABLE}")
            assert "done" in await person.type(".back")

    run(session())


def test_a_line_and_a_file_that_name_another_cell_are_refused(project):
    (project / "other.toml").write_text(TABLE)
    (project / "same.yarc").write_text('CELL "cell.toml"\nP0010 MOVEJ HOME [1] (s)\n')
    (project / "other.yarc").write_text('CELL "other.toml"\nP0010 MOVEJ HOME [1] (s)\n')

    async def session():
        async with talking(project) as person:
            assert "error Y1373" in await person.type('CELL "other.toml"')
            assert "error" not in await person.type('CELL "cell.toml"')
            assert "error Y1373" in await person.type(".load other.yarc")
            assert "1 commands" in await person.type(".load same.yarc")
            assert "error Y0901" in await person.type(BELOW)

    run(session())


@pytest.mark.parametrize("cell", ["cell = 5", 'cell = "nowhere.toml"', "cell = "])
def test_nothing_moves_where_the_cell_is_not_known(project, cell):
    (project / "yarc.toml").write_text(f"{cell}\n")

    async def session():
        async with coordinating(folder=project) as (world, _, client):
            made = await client.motion.offer("MOVEJ 5 0 0 0 0 0 [1] (deg,s)")
            assert made.value is None
            assert codes(made)[0] in ("Y1302", "Y1393")
            drive = await client.live.drive(JointVelocity(np.full(6, 0.1)))
            assert drive.value is None
            assert world.stands() == pytest.approx([0] * 6, abs=1e-9)

    run(session())


COMMENTED = """\
# The cell of the press.
units = "mm,deg"

[frames]
TABLE = { parent = "B", xyz = [0, 1174.4, 300], rpy = [0, 0, 0] }   # measured in May
PIN = { parent = "TABLE", xyz = [0, 0, 10], rpy = [0, 0, 0] }
FINGER = { parent = "FLANGE", xyz = [0, 0, 100], rpy = [0, 0, 0] }

[[obstacles]]   # the last one
name = "TABLE"
frame = "TABLE"
shape = "box"
size = [1200, 1200, 100]
"""


def test_a_frame_is_taught_into_the_cell(project):
    file = project / "cell.toml"
    file.write_text(COMMENTED)

    async def session():
        async with talking(project, joints=[0, 0, 0, 0, 30, 0], asks=False) as person:
            told = await person.type(".teach cell {PIN}")
            assert "- PIN = " in told
            assert "+ PIN = " in told
            assert "{PIN} moves by" in told
            assert "nothing was written" in await person.type("n")
            assert file.read_text() == COMMENTED
            assert "cell.toml is written" in await person.type(".teach cell {pin}", "y")
            lines = file.read_text().splitlines()
            assert [one for one in lines if not one.startswith("PIN")] == [
                one for one in COMMENTED.splitlines() if not one.startswith("PIN")
            ]
            assert 'parent = "TABLE"' in next(one for one in lines if one.startswith("PIN"))
            await person.type("MOVEJ 10 0 0 0 30 0 [1] (deg,s)")
            assert "done" in await person.type("MOVEL {TCP} 0 0 0 0 0 0 [2] (mm,deg,s) {PIN}")
            assert person.world.stands() == pytest.approx([0, 0, 0, 0, 30, 0], abs=1e-2)
            told = await person.type(".teach cell {NEW} {TABLE}", "y")
            assert "the frame {NEW} is written" in told
            assert file.read_text().startswith("\n".join(lines))
            assert "[frames.NEW]" in file.read_text()

    run(session())


@pytest.mark.parametrize(
    ("typed", "said"),
    [
        (".teach cell PIN", "a frame is taught into the cell"),
        (".teach cell {PIN} {B}", "{PIN} has the parent {TABLE} in cell.toml, and keeps it"),
        (".teach cell {FINGER}", "is attached to the flange"),
        (".teach cell {NEW} {FINGER}", "isn't a fixed frame of the cell"),
        (".teach cell {NEW} {NOWHERE}", "isn't a fixed frame of the cell"),
        (".teach cell {TCP}", "the edited file wouldn't contain the measured frame"),
    ],
)
def test_what_is_not_taught_into_the_cell(project, typed, said):
    file = project / "cell.toml"
    file.write_text(COMMENTED)

    async def session():
        async with talking(project) as person:
            assert said in await person.type(typed)
            assert file.read_text() == COMMENTED

    run(session())


def test_teaching_into_no_cell_or_a_changed_one(tmp_path_factory, project):
    async def session():
        async with talking(tmp_path_factory.mktemp("none")) as person:
            assert "there is no cell" in await person.type(".teach cell {PIN}")

    run(session())

    async def changed():
        async with talking(project) as person:
            await person.type(".teach cell {TABLE}")
            (project / "cell.toml").write_text(TABLE + "# by somebody else\n")
            assert "was changed by another program in the meantime" in await person.type("y")
            assert (project / "cell.toml").read_text().endswith("# by somebody else\n")

    run(changed())
