"""Tests of parts from the cell's file to the certificate.

A held part moves with the gripper, a released part stays, and any other contact is refused.
"""

import json
import re

import numpy as np
import pytest
from programs import codes

from tests.handling.carrying import PICK, PUT, made
from yarclang.certify.certifying import certify


def told(found, code):
    return [one for one in found.diagnostics if one.code == code]


def test_a_part_is_brought_from_place_to_place(tmp_path):
    found = made(tmp_path, PICK + PUT)
    assert found.value is not None
    assert codes(found.diagnostics) == []
    carries = {one.index: one.carries for one in found.value.certificate.commands}
    assert carries == {
        "P0010": (), "P0020": (), "P0040": ("BOX",), "P0050": ("BOX",), "P0060": ("BOX",), "P0080": (),
            "P0090": (),
    }  # fmt: skip
    near = {one.index: one.clearance for one in found.value.certificate.commands}
    assert "BOX" in (near["P0050"].first, near["P0050"].second)


def test_a_gripper_that_closes_on_nothing_is_told(tmp_path):
    found = made(tmp_path, PICK.replace("0 0 0 0 0 0 [1]", "0 0 60 0 0 0 [1]") + PUT)
    (one,) = told(found, "Y0940")
    assert "BOX, the nearest part, is 30 mm away, and the gripper's reach is 15 mm" in one.message
    assert all(not one.carries for one in found.value.certificate.commands)


def test_a_part_that_is_never_put_down_is_told(tmp_path):
    found = made(tmp_path, PICK + "P0090 MOVEJ READY\n")
    (one,) = told(found, "Y0941")
    assert one.span.line == 6
    assert "BOX is taken here" in one.message


def test_a_part_that_is_put_into_something_is_an_error(tmp_path):
    found = made(tmp_path, PICK + PUT.replace("P0060 MOVEL 0 0 0", "P0060 MOVEL 0 0 -12"))
    assert found.value is None
    (one,) = told(found, "Y0942")
    assert "BOX is put down 12 mm deep in TABLE" in one.message


def test_a_part_that_is_let_go_in_the_air_is_told(tmp_path):
    found = made(tmp_path, PICK + PUT.replace("P0060 MOVEL 0 0 0", "P0060 MOVEL 0 0 12"))
    (one,) = told(found, "Y0943")
    assert "TABLE, the nearest body, is 12 mm away" in one.message
    assert found.value is not None


def test_a_gripper_moves_at_rest_only(tmp_path):
    found = made(tmp_path, PICK.replace("[1] {FEEDER}\nP0030", "[1] {FEEDER} BLEND 5\nP0030") + PUT)
    assert found.value is None
    assert "Y0944" in codes(found.diagnostics)


def test_what_is_held_is_held_against_the_cell(tmp_path):
    post = (
        "\n"
        "[[obstacles]]\n"
        'name = "POST"\n'
        'shape = "cylinder"\n'
        'frame = "B"\n'
        "xyz = [25, {}, 700]\n"
        "radius = 20\n"
        "length = 300\n"
    )
    ways = [made(tmp_path, PICK + PUT, post.format(y)) for y in (620, 915)]
    assert [one.value is not None for one in ways] == [True, False]
    messages = " ".join(one.message for one in ways[1].diagnostics)
    assert re.search(r"(BOX|FINGERS) penetrates POST by [\d.]+ mm", messages)
    # a longer box collides where a shorter one doesn't
    slim = (
        "\n"
        "[[obstacles]]\n"
        'name = "POST"\n'
        'shape = "cylinder"\n'
        'frame = "B"\n'
        "xyz = [480, 850, 900]\n"
        "radius = 20\n"
        "length = 400\n"
    )
    for size, is_free in ((60, True), (420, False)):
        found = made(tmp_path, PICK + PUT, slim, size=size)
        assert (found.value is not None) is is_free
        if not is_free:
            assert "BOX penetrates" in " ".join(one.message for one in told(found, "Y0901"))


def test_what_was_put_down_stays_in_the_way(tmp_path):
    back = "P0100 MOVEJ_RPY 0 0 0 0 0 0 {PUT}\n"
    assert (
        "Y0925" in codes(made(tmp_path, PICK + PUT + back).diagnostics)
        or made(tmp_path, PICK + PUT + back).value is None
    )
    gone = PUT.replace("P0090", "P0085 SET TAKEN ON\nP0090")
    assert made(tmp_path, PICK + gone + back).value is not None


def test_the_next_part_comes_when_one_is_taken_away(tmp_path):
    again = "P0110 MOVEJ_RPY 0 0 0 0 0 0 {FEEDER}\n"
    gone = PUT.replace("P0090", "P0085 SET TAKEN ON\nP0090")
    assert made(tmp_path, PICK + gone + again).value is not None
    assert made(tmp_path, PICK + gone + again, count=2).value is None
    found = made(tmp_path, f"REPEAT 2\n{PICK}{gone}END\n", count=2)
    assert found.value is not None
    assert {name for one in found.value.certificate.commands for name in one.carries} == {"BOX 1", "BOX 2"}
    found = made(tmp_path, f"REPEAT 3\n{PICK}{gone}END\n", count=2)
    assert "all parts are taken" in " ".join(one.message for one in told(found, "Y0940"))


def test_a_part_may_touch_what_it_lies_on_and_not_go_through(tmp_path):
    """A part may touch the table that it lies on, even within the table's margin, but not move into it."""
    margin = "\n"
    assert made(tmp_path, PICK + PUT, margin, margin=8).value is not None
    down = PICK.replace("P0040 MOVEL 0 0 120", "P0040 MOVEL 0 0 -4")
    found = made(tmp_path, down + PUT.replace("P0050", "P0045 MOVEL 0 0 120 0 0 0 [1] {FEEDER}\nP0050"))
    assert found.value is None
    assert "BOX" in " ".join(one.message for one in told(found, "Y0901"))


def test_a_gripper_touches_its_part_on_the_way_in_and_out_alone(tmp_path):
    """The gripper may touch its part only while it approaches or leaves it.

    A later motion through the released box is refused, because the fingers had already left the box.
    """
    out = PUT.replace(
        "P0090 MOVEJ READY",
        "P0090 MOVEL 200 0 120 0 0 0 [1.2] {PUT}\n"
        "P0100 MOVEL 200 0 0 0 0 0 [1.2] {PUT}\n"
        "P0110 MOVEL 0 0 0 0 0 0 [2] {PUT}",
    )
    found = made(tmp_path, PICK + out)
    assert found.value is None
    assert {(one.code, one.span.line) for one in found.diagnostics if one.is_error} >= {("Y0901", 14)}
    # the approach has two motions, and the fingers are around the box in the slow one
    slow = PICK.replace("P0020", "P0015 MOVEL 0 0 20 0 0 0 [1] {FEEDER}\nP0020").replace(
        "P0040", "P0035 MOVEL 0 0 20 0 0 0 [1] {FEEDER}\nP0040"
    )
    assert made(tmp_path, slow + PUT).value is not None


def test_after_a_when_both_worlds_are_proved(tmp_path):
    either = f"WHEN GOOD ON\n{PICK}{PUT.replace('P0090 MOVEJ READY', 'P0090 MOVEJ READY')}END\n"
    at_feeder = "P0110 MOVEJ_RPY 0 0 0 0 0 0 {FEEDER}\n"
    at_table = "P0110 MOVEJ_RPY 0 0 0 0 0 0 {PUT}\n"
    assert made(tmp_path, either).value is not None
    assert made(tmp_path, either + at_feeder).value is None
    assert made(tmp_path, either + at_table).value is None


def test_a_text_is_judged_with_the_parts_where_they_are(tmp_path):
    """The judge follows the parts itself, and refuses a text that carries a box through a wall, whatever the
    planner knew.
    """
    free = made(tmp_path, PICK + PUT)
    wall = (
        "\n"
        "[[obstacles]]\n"
        'name = "WALL"\n'
        'shape = "box"\n'
        'frame = "B"\n'
        "xyz = [25, 1000, 700]\n"
        "size = [10, 200, 180]\n"
    )
    blocked = made(tmp_path, PICK + PUT, wall)
    assert blocked.value is None
    from yarclang.pipeline.cells import cell_loader
    from yarclang.robot.description import load_robot

    robot = load_robot("INDUSTRIAL6").value
    cell = cell_loader(tmp_path, robot)("cell.toml", None).value
    from dataclasses import replace

    program = replace(free.value.program, cell=cell)
    judged = certify(free.value.text, program, robot, robot.tolerance)
    assert any("WALL" in one.message and one.is_error for one in judged.diagnostics)


def test_a_heavier_part_asks_for_more(tmp_path):
    from yarclang.handling.surroundings import load_cases
    from yarclang.handling.walk import handling_of

    found = made(tmp_path, PICK + PUT)
    program, robot = found.value.program, found.value.plan.robot
    assert robot.dynamics is not None
    handling = handling_of(robot, program.cell, program.steps)
    stand = handling.first()
    assert load_cases(robot, handling.around(stand.parts)) == (robot.dynamics,)
    step = next(at for at, one in enumerate(program.steps) if getattr(one.origin, "index", "") == "P0030")
    place = found.value.certificate.commands[1]
    q = found.value.plan.motions[1].curve.sample(np.array([place.duration]))[0][0]
    stand, grasp = handling.passed(stand, step, q)
    assert grasp is not None
    assert grasp.moved == ("BOX",)
    (loaded,) = load_cases(robot, handling.around(stand.parts))
    assert loaded.mass[-1] == pytest.approx(robot.dynamics.mass[-1] + 0.8)


@pytest.mark.parametrize(
    ("more", "code"),
    [
        (
            '[[parts]]\nname = "A"\nshape = "box"\nframe = "GRIPPER"\nsize = [10, 10, 10]\ncount = 2\n',
            "Y1308",
        ),
        ('[[parts]]\nname = "TRACK"\nshape = "box"\nframe = "B"\nsize = [10, 10, 10]\n', "Y1311"),
        ('[[parts]]\nname = "A"\nshape = "box"\nframe = "B"\nsize = [10, 10, 10]\ncount = 0\n', "Y1308"),
        ('[[parts]]\nname = "A"\nshape = "box"\nframe = "B"\nsize = [10, 10, 10]\nmass = -1\n', "Y1308"),
        ('[[parts]]\nname = "A"\nshape = "box"\nframe = "B"\nsize = [10, 10, 10]\ncount = 1.5\n', "Y1306"),
        ('[outputs.OTHER]\nvariable = "M3"\ngrips = "FEEDER"\n', "Y1374"),
        ('[outputs.OTHER]\nvariable = "M3"\nremoves = "GRIPPER"\n', "Y1374"),
        ('[outputs.OTHER]\nvariable = "M3"\ngrips = "GRIPPER"\nremoves = "PUT"\n', "Y1305"),
        ('[outputs.OTHER]\nvariable = "M3"\nreach = 10\n', "Y1305"),
        ('[outputs.OTHER]\nvariable = "M3"\ngrips = "GRIPER"\n', "Y1329"),
        ('[outputs.OTHER]\nvariable = "M3"\ngrips = "GRIPPER"\nreach = -1\n', "Y1308"),
    ],
)
def test_a_mistake_in_the_file_is_told_at_its_line(tmp_path, more, code):
    found = made(tmp_path, PICK + PUT, more)
    assert found.value is None
    assert code in codes(found.diagnostics)
    assert all(one.span is not None for one in found.diagnostics if one.code == code)


def test_the_certificate_is_plain_data(tmp_path):
    found = made(tmp_path, PICK + PUT)
    assert json.dumps(found.value.certificate.to_json())


def test_a_gripper_takes_no_computed_value(tmp_path):
    found = made(tmp_path, "REGISTER N 0..1\n" + PICK.replace("SET GRIP ON", "SET GRIP = N") + PUT)
    (one,) = told(found, "Y0949")
    assert "GRIP moves parts (M1)" in one.message
    assert found.value is None


def test_a_loop_that_leaves_a_part_elsewhere_is_an_error(tmp_path):
    program = "INPUT DOOR M11\nP0005 MOVEJ READY\nLOOP\n" + PICK + PUT + "UNTIL DOOR ON\n"
    found = made(tmp_path, program)
    (one,) = told(found, "Y0948")
    assert "BOX isn't where it was when the loop began" in one.message
    assert found.value is None


def test_a_loop_that_brings_a_part_back_is_proved(tmp_path):
    back = PUT.replace("{PUT}", "{FEEDER}")
    found = made(tmp_path, "INPUT DOOR M11\nP0005 MOVEJ READY\nLOOP\n" + PICK + back + "UNTIL DOOR ON\n")
    assert not [one for one in found.diagnostics if one.is_error], found.diagnostics
    assert [one.carries for one in found.value.certificate.commands].count(("BOX",)) == 3
