"""Tests of poses that can't be reached without a collision: the finding says which change would help, and the
change does.
"""

import re

import numpy as np
import pytest
from floors import exercises
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from programs import planned

from tests.motion.avoid.cells import box, loading
from tests.motion.test_routes import applied
from tests.robot.made_arms import DATA, REAL, made
from yarclang.motion.avoid import changes
from yarclang.motion.leading import solving

HEAD = 'CELL "cell.toml"\nDEFAULT {TCP} [MIN] (mm,deg,s) {B}\n'
WANTED = {"Y0501", "Y0502", "Y0925"}


def said(text, *obstacles, robot="INDUSTRIAL6"):
    return [
        one for one in planned(HEAD + text, robot, load_cell=loading(*obstacles))[1] if one.code in WANTED
    ]


@pytest.fixture(scope="module")
def ur5(tmp_path_factory):
    """Fixture: the folder of an arm with three parallel axes."""
    name = next(name for name in REAL if "ur5" in name)
    folder = tmp_path_factory.mktemp("arm") / "ur5"
    file, arguments, _ = REAL[name]
    made(DATA / file, folder, *arguments)
    return str(folder)


def test_a_tool_that_points_the_wrong_way_is_the_cause(ur5):
    """The tool would point upwards, through the table. None of the UR5's configurations is free."""
    table = box("TABLE", [0.5, 0, 0.05], [0.6, 0.6, 0.1])
    text = "P0010 MOVEJ_RPY 500 0 120 0 0 0\n"
    (one,) = said(text, table, robot=ur5)
    assert one.code == "Y0925"
    assert one.help.startswith(
        "the tool's z may point in the wrong direction: the pose would be free with the tool "
        "turned by 180 deg about its "
        "x (500 0 120 180 0 0 in mm and deg)"
    )
    assert (one.fix.title, one.fix.by_choice) == ("turn the tool by 180 deg about its x", True)
    assert "P0010 MOVEJ_RPY 500 0 120 180 0 0\n" in applied(HEAD + text, one.fix)
    assert said("P0010 MOVEJ_RPY 500 0 120 180 0 0\n", table, robot=ur5) == []


def test_a_move_of_a_few_mm_is_said_with_its_numbers():
    table = box("TABLE", [0, 0.9, 0.75], [0.6, 0.6, 0.1])
    text = "FRAME {TABLE} 0 900 800 0 0 0\nP0010 MOVEJ_RPY 0 0 20 0 0 0 {TABLE}\n"
    (one,) = said(text, table)
    assert one.help.startswith(
        "the pose would be free 50 mm along z of the tool (0 0 70 0 0 0 in mm and deg); "
    )
    assert said(text.replace("0 0 20", "0 0 70"), table) == []


def test_a_pose_that_no_change_frees_says_so():
    block = box("BLOCK", [0.9, 0, 0.9], [0.8, 0.8, 0.8])
    (one,) = said("P0010 MOVEJ_RPY 900 0 900 0 0 -90\n", block)
    assert one.fix is None
    assert one.help.startswith(
        "the pose stays blocked with z reversed, turned about z, and moved by up to 50 mm: "
    )


def test_what_isnt_written_as_numbers_has_no_fix(ur5):
    table = box("TABLE", [0.5, 0, 0.05], [0.6, 0.6, 0.1])
    (one,) = said("LET X = 500 (mm)\nP0010 MOVEJ_RPY $X 0 120 0 0 0\n", table, robot=ur5)
    assert "180 deg about its x" in one.help
    assert one.fix is None


@pytest.mark.parametrize(
    ("line", "numbers"),
    [
        ("P0010 MOVEJ_RPY 500 0 120 0 0 0 (mm,rad)", "500 0 120 3.141593 0 0"),
        ("P0010 MOVEJ_RPY 0.5 0 .12 0 0 0 (m,deg)", "0.5 0 0.12 180 0 0"),
        ("P0010 MOVEJ_RPY 50 +0 12. 0 0 0 (cm,deg)", "50 0 12 180 0 0"),
    ],
)
def test_a_fix_has_the_units_of_its_line(ur5, line, numbers):
    table = box("TABLE", [0.5, 0, 0.05], [0.6, 0.6, 0.1])
    (one,) = said(f"{line}\n", table, robot=ur5)
    (edit,) = one.fix.edits
    assert edit.text == numbers
    assert said(applied(HEAD + line + "\n", one.fix).splitlines()[-1] + "\n", table, robot=ur5) == []


def test_another_way_point_is_left_alone(ur5):
    table = box("TABLE", [0.5, 0, 0.05], [0.6, 0.6, 0.1])
    found = said("P0010 MOVEJ_SPLINE_RPY 500 0 400 180 0 0; 500 0 120 0 0 0\n", table, robot=ur5)
    assert [one.fix for one in found] == [None]
    assert found[0].message.startswith("waypoint 2: ")
    assert "180 deg about its x" in found[0].help


def test_it_is_looked_for_only_at_the_first_lines(monkeypatch):
    counted = []
    whole = changes.helpful_changes
    monkeypatch.setattr(solving, "helpful_changes", lambda *given: counted.append(given) or whole(*given))
    block = box("BLOCK", [0.9, 0, 0.9], [0.8, 0.8, 0.8])
    lines = "".join(f"P{10 * number:04d} MOVEJ_RPY 900 0 900 0 0 -{number}\n" for number in range(1, 41))
    assert len(said(lines, block)) == 40
    assert len(counted) == 20
    counted.clear()
    assert len(said("REPEAT 10\nP0010 MOVEJ_RPY 900 0 900 0 0 -90\nEND\n", block)) >= 1
    assert len(counted) == 1


NUMBER = st.integers(-180, 180).map(lambda value: value / 2)


@exercises(said=0.1, fixed=0.05)
@given(
    at=st.tuples(st.integers(-1500, 1500), st.integers(-1500, 1500), st.integers(0, 1800)),
    turned=st.tuples(NUMBER, NUMBER, NUMBER),
    size=st.integers(100, 700),
)
@settings(max_examples=120, deadline=None, suppress_health_check=[HealthCheck.filter_too_much])
def test_what_is_said_to_help_helps(tally, at, turned, size):
    """The pose that a fix writes can be reached, and is free in some configuration."""
    numbers = " ".join(f"{value:g}" for value in (*at, *turned))
    text = f"P0010 MOVEJ_RPY {numbers}\n"
    around = box("AROUND", np.array(at) / 1e3 + [0, 0, -size / 2e3], [0.4, 0.4, size / 1e3])
    found = said(text, around)
    tally.count("said", bool(found))
    if not found:
        return
    (one,) = found
    helps = re.search(r"the pose would be (free|in reach) ", one.help)
    tally.count("fixed", one.fix is not None)
    assert (one.fix is not None) == (helps is not None)
    if one.fix is not None:
        line = applied(HEAD + text, one.fix).splitlines()[-1] + "\n"
        assert said(line, around) == []
