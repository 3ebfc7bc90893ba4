"""The number of convex pieces of bodies in `yarc inspect`."""

from __future__ import annotations

from pathlib import Path

import pytest

from yarclang.collision.scene import scene_of
from yarclang.pipeline.checking import check_text
from yarclang.pipeline.inputs import Options
from yarclang.pipeline.places import labels_of, matching
from yarclang.report.inspection.as_json import inspected_json
from yarclang.report.inspection.convex import divided_bodies
from yarclang.report.inspection.inspected import inspect_step, study
from yarclang.report.inspection.text import sections_of
from yarclang.source import SourceFile

EXAMPLES = Path(__file__).parents[3] / "examples"

TEXT = """\
ROBOT INDUSTRIAL6
CELL "made.toml"
DEFAULT {TCP} [50%] (mm,deg,s) {B}
P0010 MOVEJ 10 0 0 0 30 0
P0020 WAIT [1]
"""

CELL = """\
units = "mm,deg"
[[obstacles]]
name = "ONE"
shape = "mesh"
file = "gun.stl"
frame = "B"
xyz = [-3000, 0, 0]
pieces = 8
[[obstacles]]
name = "HULL"
shape = "mesh"
file = "gun.stl"
frame = "B"
xyz = [-4000, 0, 0]
pieces = 1
[[obstacles]]
name = "WHOLE"
shape = "mesh"
file = "gun.stl"
frame = "B"
xyz = [-5000, 0, 0]
"""


@pytest.fixture(scope="module")
def studied(tmp_path_factory: pytest.TempPathFactory):
    folder = tmp_path_factory.mktemp("divided")
    (folder / "gun.stl").write_bytes((EXAMPLES / "32_weld_gun.stl").read_bytes())
    (folder / "made.toml").write_text(CELL)
    return study(check_text(SourceFile("made.yarc", TEXT), folder, Options()))


def found(studied, place):
    return inspect_step(studied, matching(labels_of(studied.program), place)[0])


def test_bodies_in_pieces_are_listed_with_their_numbers(studied):
    one = found(studied, "P0010")
    # the bodies of the collision check, counted independently
    bodies = [body.name for body in scene_of(one.robot, studied.program.cell).value.bodies]
    count = bodies.count("ONE")
    assert 1 < count <= 8
    assert inspected_json(one)["convex_pieces"] == {
        "ONE": {"count": count, "most": 8},
        "HULL": {"count": 1, "most": 1},
    }
    lines = sections_of(one)[0].lines
    assert f"ONE is represented by {count} convex pieces, of at most 8" in lines
    assert "HULL is represented by 1 convex piece, of at most 1" in lines
    assert not any("WHOLE" in line for line in lines)


def test_a_command_without_motion_and_a_robot_without_pieces_list_none(studied):
    wait = found(studied, "P0020")
    assert wait.divided == ()
    assert inspected_json(wait)["convex_pieces"] == {}
    assert divided_bodies(wait.robot, None) == ()
