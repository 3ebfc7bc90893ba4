"""Tests of [[keep]] in a cell.toml, which gives rules for all motions."""

from dataclasses import replace

import pytest
from programs import codes, robot_of

import yarclang
from tests.certify.forging import Forger
from yarclang.certify.certifying import certify
from yarclang.collision.zones.possible import home_in_zones

UNITS = 'units = "mm,deg"\n'
FRAMES = """
[frames.CAMERA]
parent = "B"
xyz = [0, 1100, 200]
[frames.LAMP]
parent = "B"
xyz = [0, 1100, 4000]
[frames.CUP]
parent = "FLANGE"
xyz = [0, 100, 50]
"""
RULE = '[[keep]]\nframe = "TCP"\nrule = "seen"\nof = "CAMERA"\nangle = %s\nrange = [100, 4000]\n'
PROGRAM = """ROBOT INDUSTRIAL6
CELL "cell.toml"
DEFAULT {TCP} [50%] (mm,deg,s) {B}
P0010 MOVEJ 20 0 0 0 30 0
P0020 MOVEJ 0 0 0 0 0 0
"""


def made(folder, cell, program=PROGRAM):
    (folder / "cell.toml").write_text(UNITS + FRAMES + cell)
    found = yarclang.compile(program, folder=folder)
    return found.value, found.diagnostics


def test_all_motions_keep_to_a_rule_of_the_cell(tmp_path):
    result, found = made(tmp_path, RULE % 60)
    assert codes(found) == []
    assert result.text.count("\n; keep ") == 2
    for command in result.certificate.commands:
        (rule,) = command.kept
        assert rule.rule == "{TCP} SEEN 60 100 4000 (deg,mm) {CAMERA}"


def test_a_motion_that_breaks_it_is_refused_with_the_place_of_the_rule(tmp_path):
    _, found = made(tmp_path, RULE % 10)
    broken = [one for one in found if one.is_error]
    assert {one.code for one in broken} == {"Y0957"}
    assert "[[keep]] of the cell.toml" in broken[0].help


def test_a_rule_that_home_breaks_is_a_warning(tmp_path):
    robot = robot_of("INDUSTRIAL6")
    for rule in ("above", "facing"):
        entry = f'[[keep]]\nframe = "TCP"\nrule = "{rule}"\n'
        entry += "distance = 3000\n" if rule == "above" else "angle = 10\n"
        (tmp_path / "cell.toml").write_text(UNITS + FRAMES + entry)
        planned = yarclang.plan(PROGRAM, folder=tmp_path).value
        (one,) = home_in_zones(robot, planned.program.cell)
        assert one.code == "Y0914"
        assert one.span is not None
    assert "the point is 146.3 deg off the axis, and 2,119.18 mm away" in one.message


AWAY = """ROBOT INDUSTRIAL6
CELL "cell.toml"
INPUT CURTAIN M11
DEFAULT {TCP} [50%] (mm,deg,s) {B}
SUB AWAY
  P0010 MOVEJ 0 0 0 0 AWAY_TO 0
END
ON CURTAIN OFF CALL AWAY
P0020 MOVEJ 20 0 0 0 0 0
P0030 MOVEJ HOME
"""


@pytest.mark.parametrize(("to", "wrong"), [(10, []), (60, ["Y0479"])])
def test_ways_out_keep_to_it_as_well(tmp_path, to, wrong):
    rule = '[[keep]]\nframe = "TCP"\nrule = "upright"\nangle = 30\n'
    _, found = made(tmp_path, rule, AWAY.replace("AWAY_TO", str(to)))
    broken = [one for one in found if one.is_error]
    assert [one.code for one in broken] == wrong
    assert all("KEEP" in one.message for one in broken), broken


def test_the_same_rule_in_the_program_counts_once(tmp_path):
    inner = PROGRAM.replace("P0020", "KEEP {TCP} SEEN 60 100 4000 (deg,mm) {CAMERA}\nP0020") + "END\n"
    result, found = made(tmp_path, RULE % 60, inner)
    assert codes(found) == []
    assert [len(one.kept) for one in result.certificate.commands] == [1, 1]
    assert result.text.count("\n; keep ") == 2


@pytest.mark.parametrize(
    ("entry", "code", "part"),
    [
        ('frame = "TCP"\nrule = "upright"', "Y1304", "angle"),
        ('frame = "TCP"\nrule = "above"', "Y1304", "distance"),
        ('frame = "TCP"\nrule = "upright"\nangle = 3\ndistance = 2', "Y1305", "distance"),
        ('frame = "TCP"\nrule = "upright"\nangle = 3\nrange = [1, 2]', "Y1305", "range"),
        ('frame = "TCP"\nrule = "sideways"\nangle = 3', "Y1308", "upright"),
        ('frame = "TCP"\nrule = "upright"\nangle = 0.01', "Y1308", "0.1 to 175 deg"),
        ('frame = "TCP"\nrule = "upright"\nangle = 179', "Y1308", "179 deg"),
        ('frame = "TCP"\nrule = "seen"\nangle = 9\nrange = [5]', "Y1309", "2 values"),
        ('frame = "TCP"\nrule = "seen"\nangle = 9\nrange = [0, 5]', "Y1308", "from 0 to 5 mm"),
        ('frame = "TCP"\nrule = "seen"\nangle = 9\nrange = [9, 5]', "Y1308", "from 9 to 5 mm"),
        ('frame = "CAMERA"\nrule = "upright"\nangle = 9', "Y1371", "doesn't move with the robot"),
        ('frame = "TCP"\nof = "CUP"\nrule = "upright"\nangle = 9', "Y1371", "the robot carries"),
        ('frame = "CAP"\nrule = "upright"\nangle = 9', "Y1329", "CAP"),
        ('frame = "TCP"\nof = "TCP"\nrule = "upright"\nangle = 9', "Y1329", "TCP"),
        ('rule = "upright"\nangle = 9', "Y1304", "frame"),
        ('frame = "TCP"\nangle = 9', "Y1304", "rule"),
        ('frame = "TCP"\nrule = "upright"\nangle = 9\nunits = "mm,inch"', "", ""),
        ('frame = "TCP"\nrule = "upright"\nangle = "nine"', "Y1306", "angle"),
        ('frame = "TCP"\nrule = "upright"\nangle = nan', "", ""),
    ],
)
def test_a_wrong_entry_is_one_finding(tmp_path, entry, code, part):
    result, found = made(tmp_path, f"[[keep]]\n{entry}\n")
    assert result is None or not result.text
    wrong = [one for one in found if one.is_error]
    assert len(wrong) == 1
    if code:
        assert wrong[0].code == code
        assert part in wrong[0].message + wrong[0].help


def test_an_entry_that_stands_twice_is_a_finding(tmp_path):
    _, found = made(tmp_path, RULE % 60 + RULE % 60)
    assert [one.code for one in found if one.is_error] == ["Y1311"]


def test_a_text_without_the_rules_of_the_cell_is_refused(tmp_path):
    result, _ = made(tmp_path, RULE % 60)
    robot = robot_of("INDUSTRIAL6")
    forger = Forger.of(result.text)
    for at in (forger.find("; keep 0 .*"), forger.find("; keep 1 .*")):
        judged = certify(forger.drop(at).text, result.plan.program, robot, robot.tolerance)
        assert judged.value is None or any(one.is_error for one in judged.diagnostics)


@pytest.mark.parametrize("field", ["own", "spot", "axis"])
def test_the_judge_derives_the_points_and_axes_of_rules_itself(tmp_path, field):
    inside = PROGRAM.replace("P0020", "KEEP {TCP} FACING 90 (deg) {LAMP}\nP0020") + "END\n"
    result, found = made(tmp_path, RULE % 60, inside)
    assert codes(found) == []
    program, robot = result.plan.program, robot_of("INDUSTRIAL6")

    def moved(keep):
        x, y, z = getattr(keep.region, field)
        return replace(keep, region=replace(keep.region, **{field: (x + 1e-6, y, z)}))

    step = program.steps[1]
    other = replace(program, steps=(program.steps[0], replace(step, keeps=tuple(map(moved, step.keeps)))))
    zones = tuple(
        one if one.keep is None else replace(one, keep=moved(one.keep), region=moved(one.keep).region)
        for one in program.cell.zones
    )
    for wrong in (other, replace(program, cell=replace(program.cell, zones=zones))):
        judged = certify(result.text, wrong, robot, robot.tolerance)
        assert "Y1161" in codes(judged.diagnostics)
