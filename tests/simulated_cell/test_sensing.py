"""Tests of a cell's sensors while a robot moves parts."""

import numpy as np
import pytest
from conftest import EXAMPLES
from simulator.machines import robot_machine

from yarclang.cell.description import Names, read_cell
from yarclang.pipeline.inputs import Options, open_program
from yarclang.pipeline.stages import compile_module
from yarclang.robot.description import load_robot
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.simulated_cell.inputs import Inputs
from yarclang.simulated_cell.playing import SimulatedCell
from yarclang.simulated_cell.script import Change
from yarclang.simulated_cell.sensing import ARRIVES_AFTER, Sensing
from yarclang.simulator.beside import Beside
from yarclang.source import SourceFile

HEAD = """units = "mm,deg"
[frames.GRIPPER]
parent = "FLANGE"
xyz = [0, 150, 0]
[inputs]
SEEN = "M11"
HELD = "M12"
[outputs.GRIP]
variable = "M1"
grips = "GRIPPER"
reach = 20
[outputs.TAKE]
variable = "M2"
removes = "B"
reach = 100
"""


def cell_with(*texts):
    robot = load_robot("INDUSTRIAL6").value
    made = read_cell(SourceFile("cell.toml", HEAD + "".join(texts)), EXAMPLES, Names(lambda _: False, robot))
    assert made.value is not None
    assert made.diagnostics == ()
    return robot, made.value


def grip_at(robot, cell, q):
    """Return the gripper's position [mm]."""
    flange = flange_poses(robot.chain, q[None])[0]
    return (flange @ cell.grips["M1"].flange_from_grip)[:3, 3] * 1000.0


def near(place, shape="sphere", radius=30, count=1):
    x, y, z = place
    return f"""[[parts]]
name = "BALL"
shape = "{shape}"
radius = {radius}
frame = "B"
xyz = [{x}, {y}, {z}]
count = {count}
"""


def proximity(place, **keys):
    x, y, z = place
    more = "".join(f"{key} = {value}\n" for key, value in keys.items())
    return (
        "[[sensors]]\n"
        'input = "SEEN"\n'
        'kind = "proximity"\n'
        'frame = "B"\n'
        f"xyz = [{x}, {y}, {z}]\n"
        "range = 10\n"
        f"{more}"
    )


VACUUM = '[[sensors]]\ninput = "HELD"\nkind = "vacuum"\ngripper = "GRIP"\n'


def test_a_part_is_seen_taken_and_followed_by_the_next():
    robot, cell = cell_with()
    q = robot.home
    away = q.copy()
    away[0] += 1.0
    place = grip_at(robot, cell, q)
    # only the part is near the sensor, which looks at the part's far side
    robot, cell = cell_with(near(place, count=2), proximity((place[0], place[1] + 35, place[2])), VACUUM)
    sensing = Sensing(robot, cell)
    assert sensing.look(away, 0.0) == {"M11": 1.0, "M12": 0.0}
    sensing.output_changed("M1", 1.0, q)
    assert sensing.look(q, 1.0) == {"M11": 1.0, "M12": 1.0}
    assert sensing.look(away, 2.0) == {"M11": 0.0, "M12": 1.0}
    assert sensing.look(away, 2.0 + ARRIVES_AFTER - 0.01)["M11"] == 0.0
    assert sensing.look(away, 2.0 + ARRIVES_AFTER)["M11"] == 1.0
    sensing.output_changed("M1", 0.0, away)
    assert sensing.look(away, 3.0) == {"M11": 1.0, "M12": 0.0}
    assert len(sensing.parts.items) == 2
    assert not sensing.parts.expected


def test_a_machine_takes_parts_away():
    robot, cell = cell_with(near((0, 50, 0)), proximity((0, 85, 0)))
    sensing = Sensing(robot, cell)
    q = robot.home
    assert sensing.look(q, 0.0)["M11"] == 1.0
    sensing.output_changed("M2", 0.0, q)
    assert sensing.look(q, 0.1)["M11"] == 1.0
    sensing.output_changed("M2", 1.0, q)
    assert sensing.look(q, 0.2)["M11"] == 0.0


def test_the_robot_is_seen_and_what_stands_still_is_not():
    robot, cell = cell_with()
    wrist = flange_poses(robot.chain, robot.home[None])[0][:3, 3] * 1000.0
    robot, cell = cell_with(
        proximity(wrist),
        "[[obstacles]]\n"
        'name = "WALL"\n'
        'shape = "box"\n'
        'frame = "B"\n'
        "size = [4000, 50, 4000]\n"
        "xyz = [0, -2500, 0]\n",
        "[[sensors]]\n"
        'input = "HELD"\n'
        'kind = "proximity"\n'
        'frame = "B"\n'
        "xyz = [0, -2500, 0]\n"
        "range = 10\n"
        "inverted = true\n",
    )
    sensing = Sensing(robot, cell)
    away = robot.home.copy()
    away[0] += 1.5
    assert sensing.look(robot.home, 0.0) == {"M11": 1.0, "M12": 1.0}
    assert sensing.look(away, 1.0) == {"M11": 0.0, "M12": 1.0}


def test_a_sensor_on_the_flange_sees_parts_and_not_what_carries_it():
    robot, cell = cell_with()
    place = grip_at(robot, cell, robot.home)
    beam = (
        '[[sensors]]\ninput = "SEEN"\nkind = "beam"\nframe = "GRIPPER"\nxyz = [-40, 0, 0]\nto = [40, 0, 0]\n'
    )
    for part, seen in (("", 0.0), (near(place), 1.0)):
        robot, cell = cell_with(part, beam)
        sensing = Sensing(robot, cell)
        assert sensing.look(robot.home, 0.0)["M11"] == seen
        away = robot.home.copy()
        away[0] += 1.0
        assert sensing.look(away, 0.1)["M11"] == 0.0
        sensing.output_changed("M1", 1.0, robot.home)
        assert sensing.look(away, 0.2)["M11"] == seen


def test_what_the_arm_moves_is_where_its_kinematics_say():
    robot, cell = cell_with(VACUUM)
    sensing = Sensing(robot, cell)
    for q in np.random.default_rng(1).uniform(-2.0, 2.0, (50, 6)):
        assert sensing.flange(q) == pytest.approx(flange_poses(robot.chain, q[None])[0], abs=1e-12)


def test_an_edge_of_a_sensor_ends_what_a_person_has_set_but_not_what_is_stuck():
    inputs = Inputs([Change("M12", 1.0, at=0.0, stuck=True)])
    inputs.start(0.0)
    for variable in ("M11", "M12"):
        inputs.sense(variable, 0.0, 0.0)
        inputs.set(variable, 1.0, 1.0)
        inputs.sense(variable, 0.0, 2.0)
    assert inputs.values == {"M11": 1.0, "M12": 1.0}
    for variable in ("M11", "M12"):
        inputs.sense(variable, 1.0, 3.0)
        inputs.sense(variable, 0.0, 4.0)
    assert inputs.values == {"M11": 0.0, "M12": 1.0}


@pytest.mark.parametrize("step", [0.5, 0.013])
def test_sensors_look_at_exact_times_however_time_passes(step):
    opened = open_program(str(EXAMPLES / "05_pick_and_place.yarc"), Options()).value
    program = compile_module(opened.module, opened.request).value.program
    robot, machine = robot_machine("INDUSTRIAL6", False)
    heard = []
    cell = SimulatedCell([Change("M11", 0.0, at=0.255)], cell=program.cell, robot=robot)
    begin = machine.now
    machine.variables.watch("M", 11, lambda value: heard.append((round(machine.now - begin, 6), value)))
    cell.attach(Beside(machine))
    machine.command("#1J=100000", 7)
    while machine.now < begin + 1.0:
        machine.advance(step)
    assert heard[:2] == [(0.0, 1.0), (0.255, 0.0)]


@pytest.mark.parametrize("turn", [0, 30])
def test_a_beam_sees_a_part_wherever_it_goes_through_it(turn):
    """A beam also sees a part if it goes through its very middle, where rounding makes the distance of beam
    and middle tiny rather than zero.
    """
    part = (
        "[[parts]]\n"
        'name = "BOX"\n'
        'shape = "box"\n'
        "size = [60, 60, 60]\n"
        'frame = "B"\n'
        "xyz = [420, 800, {}]\n"
        "rpy = [0, 0, {}]\n"
    )
    beam = (
        "[[sensors]]\n"
        'input = "SEEN"\n'
        'kind = "beam"\n'
        'frame = "B"\n'
        "xyz = [320, {y}, 610]\n"
        "to = [520, {y}, 610]\n"
    )
    for z in (610, 600, 639, 645):
        for y in (800, 790, 771, 850):
            robot, cell = cell_with(part.format(z, turn), beam.format(y=y))
            seen = Sensing(robot, cell).look(np.zeros(robot.size), 0.0)["M11"]
            assert bool(seen) == (abs(z - 610) < 30 and abs(y - 800) < 40)
