"""Tests of what an offer says about parts."""

from tests.handling.carrying import CELL, GIVEN, PICK
from yarclang.coordinator.describing import offer_described
from yarclang.coordinator.lines import Lines
from yarclang.coordinator.offers import Planner
from yarclang.repl.answers import offer_text
from yarclang.robot.description import load_robot


def test_the_offer_of_a_set_names_the_part_that_it_takes(tmp_path):
    (tmp_path / "cell.toml").write_text(CELL.format(**{**GIVEN, "count": 2}))
    robot = load_robot("INDUSTRIAL6").value
    planner = Planner(robot, tmp_path, cell=str(tmp_path / "cell.toml"))
    made = planner.offer("DEFAULT {GRIPPER} [50%] (mm,deg,s) {B}\n" + PICK, Lines(), robot.home, 1)
    assert made.value is not None, made.diagnostics
    told = offer_described(made.value, robot)
    assert told.parts == ("takes BOX 1",)
    assert offer_text(told).endswith("takes BOX 1")
    still = planner.offer("SET GRIP OFF", Lines(), robot.home, 2).value
    assert offer_described(still, robot).parts == ()
