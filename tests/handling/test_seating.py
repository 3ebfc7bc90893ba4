"""Tests of finding wrong places: a part that begins in the air or inside another body, or a gripper deep in
its part. In all these cases, a frame in the cell.toml is probably wrong.
"""

import pytest
from programs import codes

from tests.handling.carrying import PICK, PUT, made

VACUUM = '\n[[sensors]]\ninput = "GOOD"\nkind = "vacuum"\ngripper = "GRIP"\n'


def told(found, code):
    return [one for one in found.diagnostics if one.code == code]


def raised(z):
    """Return the changed place of the part in the cell, z [mm] above the right one."""
    return f"0\nxyz = [0, 0, {z}]"


def test_a_part_that_begins_in_the_air_is_reported_where_it_is_taken(tmp_path):
    found = made(tmp_path, PICK + PUT, margin=raised(12))
    (one,) = told(found, "Y0946")
    assert one.severity == "warning"
    assert one.span.line == 6
    assert "BOX has no support when the program starts: TRACK, the nearest body, is 12 mm away" in one.message
    assert found.value is not None


def test_a_part_that_begins_in_something_is_reported(tmp_path):
    (one,) = told(made(tmp_path, PICK + PUT, margin=raised(-8)), "Y0946")
    assert "BOX is 8 mm deep in TRACK when the program starts" in one.message


@pytest.mark.parametrize("z", [-0.9, 0, 4.9])
def test_drawings_need_not_be_exact(tmp_path, z):
    assert "Y0946" not in codes(made(tmp_path, PICK + PUT, margin=raised(z)).diagnostics)


def test_the_margin_of_what_it_lies_on_counts_as_touching(tmp_path):
    found = made(tmp_path, PICK + PUT, margin="8\nxyz = [0, 0, 12]")
    assert "Y0946" not in codes(found.diagnostics)


def test_of_several_of_a_kind_the_first_one_is_reported(tmp_path):
    gone = PUT.replace("P0090", "P0085 SET TAKEN ON\nP0090")
    found = made(tmp_path, f"REPEAT 2\n{PICK}{gone}END\n", count=2, margin=raised(12))
    (one,) = told(found, "Y0946")
    assert "BOX 1" in one.message


def test_fingers_are_around_a_part_and_hardly_beyond_its_middle(tmp_path):
    assert "Y0947" not in codes(made(tmp_path, PICK + PUT).diagnostics)
    found = made(tmp_path, PICK + PUT, margin=raised(14))
    (one,) = told(found, "Y0947")
    assert one.severity == "note"
    assert one.span.line == 6
    assert "FINGERS is 44 mm deep in BOX when the gripper closes" in one.message
    assert "may be wrong by about 44 mm" in one.help


def test_a_cup_lies_on_its_part(tmp_path):
    """A cup with a vacuum sensor doesn't reach around its part, so that a depth of 30 mm, which suits
    fingers, is too deep.
    """
    (one,) = told(made(tmp_path, PICK + PUT, VACUUM), "Y0947")
    assert "FINGERS is 30 mm deep in BOX" in one.message
    for z, is_reported in ((-26, False), (-24, True)):
        found = made(tmp_path, PICK + PUT, VACUUM, margin=raised(z))
        assert ("Y0947" in codes(found.diagnostics)) is is_reported


def test_a_part_that_is_taken_again_is_not_at_its_start(tmp_path):
    high = PUT.replace("P0060 MOVEL 0 0 0", "P0060 MOVEL 0 0 12")
    again = PICK.replace("FEEDER", "PUT").replace("MOVEL 0 0 0 ", "MOVEL 0 0 12 ").replace("P00", "P01")
    found = made(tmp_path, PICK + high + again + "P0150 SET GRIP OFF\n")
    assert "Y0946" not in codes(found.diagnostics)
    assert "Y0943" in codes(found.diagnostics)
