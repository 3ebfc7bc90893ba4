"""Tests of zones, from the text of a cell to the finding or the certificate: violations are refused, and
plans respect slow zones.
"""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from programs import codes, compiled

from yarclang.certify.certifying import certify
from yarclang.certify.claims import Claims
from yarclang.certify.motion.speed import KEPT
from yarclang.collision.zones import speed
from yarclang.collision.zones.speed import Fastest
from yarclang.motion.profile import profile_names
from yarclang.pipeline.cells import cell_loader
from yarclang.robot.description import load_robot
from yarclang.robot.kinematics.fk import tool_poses

HEAD = 'CELL "cell.toml"\nDEFAULT {TCP} [MIN] (mm,deg,s) {B}\nJOINTS A 20 10 -40 0 -30 0\nSTART A\n'


def zone(**keys):
    lines = [f"{key} = {_toml(value)}" for key, value in {"name": "Z", **keys}.items()]
    return "\n".join(["[[zones]]", *lines, ""])


def _toml(value):
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_toml(one)}" for key, one in value.items()) + " }"
    return json.dumps(value)


SLOW = zone(rule="slow", shape="box", frame="B", xyz=[0, 1000, 1200], size=[700, 1000, 1000], speed=100)


def with_cell(tmp_path, cell, program, robot="INDUSTRIAL6", head=HEAD):
    (tmp_path / "cell.toml").write_text('units = "mm,deg,s"\n' + cell)
    return compiled(head + program, robot, load_cell=cell_loader(tmp_path, load_robot(robot).value))


@pytest.mark.parametrize(
    ("keys", "line", "code", "message"),
    [
        (
            {"rule": "allowed", "shape": "half-space", "normal": [0, 0, 1], "xyz": [0, 0, 1050],
                "frame": "B"},
            "P0010 DMOVE 0 0 -100 0 0 0",
            "Y0907",
            r"\{TCP\} is [\d.]+ mm outside of the zone Z, from [\d.]+ s to [\d.]+ s after its start \(\d+ % to 100 %\); worst at .* in \{B\}",  # noqa: E501
        ),
        (
            {"rule": "allowed", "shape": "cylinder", "radius": 900, "length": 4000, "frame": "B",
                "watch": ["arm"]},
            "P0010 MOVEJ 20 10 -40 0 30 0",
            "Y0907",
            r"link_6 is [\d.]+ mm outside of the zone Z",
        ),
        (
            {"rule": "forbidden", "shape": "sphere", "radius": 100, "frame": "B", "xyz": [0, 900, 1100]},
            "P0010 MOVEJ -20 10 -40 0 -30 0",
            "Y0908",
            r"\{TCP\} is [\d.]+ mm inside of the zone Z",
        ),
        (
            {"rule": "forbidden", "shape": "half-space", "normal": [0, 1, 0], "xyz": [0, 400, 0],
                "frame": "B", "watch": ["elbow"]},
            "P0010 MOVEJ 20 -30 -40 0 -30 0",
            "Y0908",
            r"the elbow is [\d.]+ mm inside of the zone Z",
        ),
        (
            {"rule": "forbidden", "shape": "half-space", "normal": [0, 0, -1], "xyz": [0, 0, 200],
                "margin": 900, "frame": "B"},
            "P0010 DMOVE 0 0 -100 0 0 0",
            "Y0908",
            r"comes within [\d.]+ mm of the border of the zone Z, whose margin is 900 mm",
        ),
        (
            {"rule": "allowed", "shape": "joints", "joints": {"J1": [0, 30]}},
            "P0010 MOVEJ -10 10 -40 0 -30 0",
            "Y0909",
            r"J1 is at -10 deg, 10 deg outside of the window of the zone Z, from",
        ),
        (
            {"rule": "forbidden", "shape": "joints", "joints": {"J1": [0, 10], "J2": [-10, 90]}},
            "P0010 MOVEJ -10 10 -40 0 -30 0",
            "Y0909",
            r"J1 and J2 are in the forbidden window of the zone Z, from",
        ),
        (
            {"rule": "posture", "shape": "sphere", "radius": 100, "frame": "B", "xyz": [0, 900, 1100],
                "joints": {"J5": [-10, 90]}},
            "P0010 MOVEJ -20 10 -40 0 -30 0",
            "Y0910",
            r"J5 is at -30 deg, 20 deg outside of the window of the zone Z while \{TCP\} is in it",
        ),
    ],
)  # fmt: skip
def test_what_breaks_a_zone_is_refused(tmp_path, keys, line, code, message):
    value, found = with_cell(tmp_path, zone(**keys), line)
    assert value is None
    (finding,) = [one for one in found if one.is_error]
    assert finding.code == code
    assert re.search(message, finding.message), finding.message
    assert (finding.span.line, bool(finding.help)) == (5, True)


def test_a_planner_that_sees_no_speed_is_refused(tmp_path, monkeypatch):
    """The judge bounds speeds itself, so an error in the planner's search isn't certified."""
    text = "P0010 MOVEL 100 1100 1400 -100 0 0 [V {}]"
    assert with_cell(tmp_path, SLOW, text.format(99))[0] is not None
    none = Fastest(np.zeros(9), np.full(9, -1), np.zeros(9))
    monkeypatch.setattr(speed._Search, "made", lambda self: none)
    assert with_cell(tmp_path, SLOW, text.format(99))[0] is not None
    value, found = with_cell(tmp_path, SLOW, text.format(101))
    assert value is None
    assert codes([one for one in found if one.is_error]) == ["Y0911"]


LINES = {
    "joints": "MOVEJ{} -20 10 -40 0 -30 0",
    "curve": "MOVEJ_SPLINE{} 0 10 -40 0 -20 0; -20 10 -40 0 -30 0",
    "line": "MOVEL{} 100 1100 1400 -100 0 0",
    "frame curve": "MOVEL_SPLINE{} 100 1150 1450 -100 0 0; 0 1100 1400 -100 0 0",
}


@pytest.mark.parametrize("time", ["[MIN]", "[50%]"])
@pytest.mark.parametrize("kind", LINES)
@pytest.mark.parametrize("profile", profile_names())
def test_plans_keep_to_slow_zones(tmp_path, profile, kind, time):
    """With each law, the text is certified, and as fast as the zone allows."""
    line = f"P0010 {LINES[kind].format('_' + profile)} {time}"
    value, found = with_cell(tmp_path, SLOW, line)
    assert value is not None, found
    (command,) = value.certificate.commands
    assert (command.zone_speed.zone, command.zone_speed.part) == ("Z", "{TCP}")
    assert 0.97 < command.zone_speed.share <= 1.0 + KEPT
    free, _ = with_cell(tmp_path, SLOW.replace("speed = 100", "speed = 5000"), line)
    assert value.plan.duration > 1.2 * free.plan.duration


def test_blends_in_slow_zones(tmp_path):
    lines = (
        "P0010 DMOVE 0 0 -100 0 0 0 BLEND 20\nP0020 DMOVE 150 0 0 0 0 0 BLEND 20\nP0030 DMOVE 0 0 100 0 0 0"
    )
    value, found = with_cell(tmp_path, SLOW, lines)
    assert value is not None, found
    assert codes(found) == []
    assert [command.zone_speed.share <= 1.0 + KEPT for command in value.certificate.commands] == [True] * 3
    assert max(command.zone_speed.share for command in value.certificate.commands) > 0.9


@pytest.mark.parametrize("line", ["DMOVE 0 0 -200 0 0 0 [0.7]", "DMOVE 0 0 -200 0 0 0 [V 150]"])
def test_a_time_that_is_too_short_is_told_with_one_that_works(tmp_path, line):
    value, found = with_cell(tmp_path, SLOW, f"P0010 {line}")
    assert value is None
    (finding,) = found
    assert finding.code == "Y0912"
    assert re.search(
        r"\{TCP\} would move at [\d,.]+ mm/s in the zone Z, [\d.]+ % above the 100 mm/s", finding.message
    )
    (fix,) = [one for one in (finding.fix,) if one]
    (edit,) = fix.edits
    text = HEAD + f"P0010 {line[: line.index('[')]}{edit.text}"
    value, found = with_cell(tmp_path, SLOW, text, head="")
    assert value is not None, found
    assert value.certificate.commands[0].zone_speed.share > 0.95


def test_a_time_that_is_long_enough_stays(tmp_path):
    value, _ = with_cell(tmp_path, SLOW, "P0010 DMOVE 0 0 -200 0 0 0 [5]")
    assert value.plan.duration == pytest.approx(5.0)
    assert value.certificate.commands[0].zone_speed.share < 0.8


def test_outside_of_a_slow_zone_nothing_is_slower(tmp_path):
    line = "P0010 MOVEJ 60 -30 -40 0 -30 0"
    far = SLOW.replace("[0, 1000, 1200]", "[0, -1000, 1200]")
    one, _ = with_cell(tmp_path, far, line)
    other, _ = with_cell(tmp_path, "", line)
    assert one.plan.duration == other.plan.duration
    assert one.certificate.commands[0].zone_speed is None


def test_the_certificate_judges_by_itself(tmp_path):
    """A text that was planned without the zone is refused if the zone exists."""
    value, _ = with_cell(tmp_path, "", "P0010 DMOVE 0 0 -200 0 0 0")
    slow, _ = with_cell(tmp_path, SLOW, "P0010 DMOVE 0 0 -200 0 0 0")
    robot = load_robot("INDUSTRIAL6").value
    program = replace(value.program, cell=slow.program.cell)
    judged = certify(
        value.text, program, robot, robot.tolerance, Claims({0: value.plan.motions[0].waypoints})
    )
    (finding,) = [one for one in judged.diagnostics if one.is_error]
    assert finding.code == "Y0911"
    assert re.search(
        r"\{TCP\} moves at [\d.]+ mm/s in the zone Z, where 100 mm/s are allowed", finding.message
    )
    judged = certify(slow.text, program, robot, robot.tolerance, Claims({0: slow.plan.motions[0].waypoints}))
    assert "Y0911" not in codes(judged.diagnostics)


def test_the_certificate_tells_how_near_it_comes(tmp_path):
    floor = zone(
        rule="allowed", shape="half-space", frame="B", normal=[0, 0, 1], xyz=[0, 0, 1063], watch=["tcp"]
    )
    value, found = with_cell(tmp_path, floor, "P0010 MOVEJ -20 10 -40 0 -30 0\nP0020 MOVEJ 0 10 -40 0 30 0")
    assert codes(found) == []
    first, second = value.certificate.commands
    assert (first.zone_clearance.first, first.zone_clearance.second) == ("{TCP}", "Z")
    assert 0.043 < first.zone_clearance.distance < 0.0505
    told = first.to_json()
    assert told["zone_clearance"]["bodies"] == ["{TCP}", "Z"]
    assert told["zone_speed"] is None
    assert second.zone_clearance.distance == pytest.approx(first.zone_clearance.distance, abs=0.007)
    # The reported place has about this distance, and no other place has a smaller one.
    for command, motion in zip((first, second), value.plan.motions, strict=True):
        at, distance = command.zone_clearance.at, command.zone_clearance.distance
        times = np.append(np.linspace(0.0, motion.curve.duration, 500), at)
        q = motion.curve.sample(times)[0]
        robot = value.plan.robot
        above = tool_poses(robot.chain, q, robot.flange_from_frame["TCP"])[:, 2, 3] - 1.063
        assert distance <= above.min() + 1e-9
        assert above[-1] - above.min() < 0.15 * above.min()


def test_the_frame_that_is_moved_is_the_tool(tmp_path):
    """A longer tool violates a zone that a shorter one respects."""
    floor = zone(rule="allowed", shape="half-space", frame="B", normal=[0, 0, 1], xyz=[0, 0, 950])
    frame = "FRAME {ROD} 0 600 0 0 0 0 {FLANGE}\n"
    assert codes(with_cell(tmp_path, floor, f"{frame}P0010 MOVEJ 0 10 -40 0 -30 0")[1]) == []
    (finding,) = with_cell(tmp_path, floor, f"{frame}P0010 MOVEJ {{ROD}} 0 10 -40 0 -30 0")[1]
    assert finding.code == "Y0907"
    assert finding.message.startswith("{ROD} is")


def test_many_motions_of_two_tools(tmp_path):
    """Each command is judged with its own tool."""
    floor = zone(rule="allowed", shape="half-space", frame="B", normal=[0, 0, 1], xyz=[0, 0, 950])
    lines = ["FRAME {ROD} 0 600 0 0 0 0 {FLANGE}"]
    for number in range(1, 5):
        tool = "{ROD}" if number == 3 else "{TCP}"
        lines.append(f"P{number:04d} MOVEJ {tool} {10 * number} 10 -40 0 -30 0")
    found = with_cell(tmp_path, floor, "\n".join(lines))[1]
    assert [(one.code, one.span.line) for one in found] == [("Y0907", 8)]


def test_a_loop_is_one_finding(tmp_path):
    floor = zone(rule="allowed", shape="half-space", frame="B", normal=[0, 0, 1], xyz=[0, 0, 1050])
    loop = "REPEAT 3\n  P0010 DMOVE 0 0 -100 0 0 0\n  P0020 DMOVE 0 0 100 0 0 0\nEND"
    found = with_cell(tmp_path, floor, loop)[1]
    errors = [one for one in found if one.is_error]
    assert codes(errors) == ["Y0907", "Y0907"]
    assert all(one.message.endswith("2 more times)") for one in errors)


def test_the_gripper_is_watched_with_its_room(tmp_path):
    gripper = (
        "[[obstacles]]\n"
        'name = "JAWS"\n'
        'shape = "box"\n'
        'frame = "FLANGE"\n'
        "xyz = [0, 150, 0]\n"
        "size = [40, 100, 40]\n"
    )
    wall = zone(rule="forbidden", shape="half-space", frame="B", normal=[0, 1, 0], xyz=[0, 1060, 0])
    line = "P0010 MOVEJ 0 10 -40 0 30 0"
    assert codes(with_cell(tmp_path, wall, line)[1]) == []
    (finding,) = with_cell(tmp_path, wall + gripper, line)[1]
    assert finding.code == "Y0908"
    assert "JAWS is" in finding.message


def test_zones_cost_nothing_where_there_are_none(tmp_path):
    value, _ = with_cell(tmp_path, "", "P0010 MOVEJ 0 10 -40 0 -30 0")
    (command,) = value.certificate.commands
    assert command.zone_clearance is None
    assert command.zone_speed is None
    assert np.isfinite(command.duration)


def test_a_joint_motion_into_a_zone_may_go_round_it(tmp_path):
    ball = zone(rule="forbidden", shape="sphere", radius=100, frame="B", xyz=[0, 900, 1100])
    line = "P0010 MOVEJ -20 10 -40 0 -30 0"
    (finding,) = with_cell(tmp_path, ball, line)[1]
    assert finding.fix is not None
    assert [edit.text for edit in finding.fix.edits] == ["MOVEJ_AVOID"]
    assert finding.help.startswith("write MOVEJ_AVOID")
    round_it = with_cell(tmp_path, ball, line.replace("MOVEJ", "MOVEJ_AVOID"))[1]
    assert not [one for one in round_it if one.is_error]
    straight = zone(
        rule="forbidden", shape="half-space", normal=[0, 0, -1], xyz=[0, 0, 200], margin=900, frame="B"
    )
    (finding,) = with_cell(tmp_path, straight, "P0010 DMOVE 0 0 -100 0 0 0")[1]
    assert finding.fix is None  # there is no other way for a line


def test_no_way_round_is_advised_to_a_target_in_a_zone(tmp_path):
    ball = zone(rule="forbidden", shape="sphere", radius=100, frame="B", xyz=[0, 900, 1100])
    (finding,) = with_cell(tmp_path, ball, "P0010 MOVEJ 0 7.6 -68.5 0 60.9 0")[1]
    assert finding.code == "Y0908"
    assert "100 %)" in finding.message
    assert finding.fix is None
    assert finding.help.startswith("the target itself is there, so no detour helps: move the target away")
    assert "AVOID" not in finding.help
    found = with_cell(tmp_path, ball, "P0010 MOVEJ 0 7.6 -68.5 0 60.9 0\nP0020 MOVEJ A")[1]
    assert found[1].help.startswith(
        "the motion begins there, so no detour helps: begin elsewhere (at START, or where the motion before"
    )
    assert found[1].fix is None


def test_no_way_round_is_advised_to_a_target_in_an_obstacle(tmp_path):
    post = (
        "[[obstacles]]\n"
        'name = "POST"\n'
        'shape = "box"\n'
        "size = [300, 300, 300]\n"
        'frame = "B"\n'
        "xyz = [0, 900, 1100]\n"
    )
    (finding,) = with_cell(tmp_path, post, "P0010 MOVEJ 0 7.6 -68.5 0 60.9 0")[1]
    assert finding.code == "Y0901"
    assert finding.fix is None
    assert finding.help.startswith("the target itself is there")
    assert "or correct the obstacle in the cell.toml" in finding.help
