"""Tests of KEEP rules in the picture of a program."""

from types import SimpleNamespace

import numpy as np
import pytest
from view.stages import EXAMPLES, stage_of

from yarclang.report.solids import cone
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.view.door import Door, opened
from yarclang.view.figures import instant_html, key_html, notes_html
from yarclang.view.picture import Picture
from yarclang.view.rule_nodes import RuleNodes
from yarclang.view.rules import MOST_SHOWN
from yarclang.view.switches import Switches

HEAD = """\
ROBOT INDUSTRIAL6
FRAME {TABLE} 0 500 200 0 20 0 (mm,deg) {B}
FRAME {CUP} 0 0 80 0 0 0 (mm,deg) {TCP}
DEFAULT {TCP} [50%] (mm,deg,s) {B}
P0010 MOVEJ_RPY -450 850 800 0 0 0
"""
AXIS = np.array([np.sin(np.radians(20.0)), 0.0, np.cos(np.radians(20.0))])


def kept(rule: str) -> str:
    return f"{HEAD}KEEP {rule} {{TABLE}}\n  P0020 MOVEJ_RPY -300 850 900 0 30 0\nEND\n"


RULES = {
    "UPRIGHT": "{CUP} UPRIGHT 60 (deg)",
    "ABOVE": "{CUP} ABOVE -50 (mm)",
    "FACING": "{CUP} FACING 170 100 2000 (deg,mm)",
    "SEEN": "{CUP} SEEN 85 100 2000 (deg,mm)",
}


def cup(stage, q):
    tcp = tool_poses(stage.robot.chain, q[None], stage.robot.flange_from_frame["TCP"])[0]
    up = np.eye(4)
    up[2, 3] = 0.08
    return tcp @ up


@pytest.mark.parametrize("kind", RULES)
def test_a_rule_holds_during_its_motions_and_has_the_figures_of_its_frames(kind):
    stage = stage_of(kept(RULES[kind]))
    (rule,) = stage.rules.shown
    first, second = (one for one in stage.pieces if one.moves)
    assert stage.rules.at((first.begins + first.ends) / 2.0) == []
    now = (second.begins + second.ends) / 2.0
    assert stage.rules.at(now) == [0]
    q = stage.track.at(np.array([now]))[0][0]
    frame, found = cup(stage, q), rule.at(stage.robot, q)
    table = np.array([0.0, 0.5, 0.2])
    way = frame[:3, 3] - table
    match kind:
        case "UPRIGHT":
            wanted = [np.degrees(np.arccos(frame[:3, 2] @ AXIS))]
            apex, axis, tip = frame[:3, 3], AXIS, frame[:3, 3] + 0.3 * frame[:3, 2]
        case "ABOVE":
            wanted = [1e3 * way @ AXIS]
            apex, axis, tip = frame[:3, 3] - (way @ AXIS + 0.05) * AXIS, AXIS, frame[:3, 3]
        case "FACING":
            wanted = [np.degrees(np.arccos(-way @ frame[:3, 2] / np.linalg.norm(way)))]
            wanted.append(1e3 * np.linalg.norm(way))
            apex, axis, tip = frame[:3, 3], frame[:3, 2], table
        case _:
            wanted = [np.degrees(np.arccos(way @ AXIS / np.linalg.norm(way))), 1e3 * np.linalg.norm(way)]
            apex, axis, tip = table, AXIS, frame[:3, 3]
    assert [float(one.values[0]) for one in found.quantities] == pytest.approx(wanted, abs=1e-6)
    surface = found.base_from_surface
    assert surface[:3, 3] == pytest.approx(apex, abs=1e-9)
    assert surface[:3, 2] == pytest.approx(axis, abs=1e-9)
    assert surface[:3, :3].T @ surface[:3, :3] == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(surface[:3, :3]) == pytest.approx(1.0)
    assert found.pointer[1] == pytest.approx(tip, abs=1e-9)
    assert found.pointer[0] == pytest.approx(apex, abs=1e-9)
    assert found.is_kept
    text = instant_html(stage, now, None)
    assert f"{wanted[0]:.2f} {'mm' if kind == 'ABOVE' else 'deg'}" in text
    assert "keeps to" not in instant_html(stage, first.begins, None)
    assert "rules of KEEP" in key_html(stage)


def test_a_broken_rule_is_said_to_be_broken():
    stage = stage_of(kept("{CUP} UPRIGHT 5 (deg)"))
    second = [one for one in stage.pieces if one.moves][-1]
    text = instant_html(stage, second.ends, None)
    # {TABLE} is rotated by 20 deg about y, and the goal by 30 deg
    assert "10.00 deg, BROKEN" in text


@pytest.mark.parametrize("angle", [0.1, 20.0, 90.0, 175.0])
def test_a_cone_has_its_angle_and_its_distances(angle):
    solid = cone(np.radians(angle), 0.3, 1.2)
    distance = np.linalg.norm(solid.vertices, axis=1)
    assert distance.min() == pytest.approx(0.3)
    assert distance.max() == pytest.approx(1.2)
    turned = np.degrees(np.arctan2(np.hypot(*solid.vertices.T[:2]), solid.vertices[:, 2]))
    assert turned.max() == pytest.approx(angle)


def test_rules_of_the_cell_are_drawn_as_rules_and_not_as_zones(tmp_path):
    cell = """\
units = "mm,deg,s"
[[keep]]
frame = "TCP"
rule = "above"
distance = 100
[[keep]]
frame = "FLANGE"
rule = "seen"
angle = 170
"""
    (tmp_path / "cell.toml").write_text(cell)
    from yarclang.pipeline.inputs import Options
    from yarclang.source import SourceFile
    from yarclang.view.opening import program_stage

    text = HEAD.replace("INDUSTRIAL6\n", 'INDUSTRIAL6\nCELL "cell.toml"\n', 1)
    stage = program_stage(SourceFile("made.yarc", text), tmp_path, Options()).value
    assert stage.rules.at(stage.duration / 2.0) == [0, 1]
    assert not [one for one in stage.items if one.kind == "zone"]
    assert "can't be shown" not in notes_html(stage)
    q = stage.track.at(np.array([0.0]))[0][0]
    flange = tool_poses(stage.robot.chain, q[None], np.eye(4))[0]
    assert stage.rules.shown[1].at(stage.robot, q).pointer[1] == pytest.approx(flange[:3, 3])


def nested(count):
    rules = [f"KEEP {{TCP}} UPRIGHT {100 - number} (deg)" for number in range(count)]
    return "\n".join((HEAD, *rules, "P0020 MOVEJ_RPY -300 850 900 0 0 0", *("END" for _ in rules), ""))


def test_only_so_many_rules_are_shown_at_once():
    stage = stage_of(nested(MOST_SHOWN + 3))
    text = instant_html(stage, stage.duration, None)
    assert text.count("UPRIGHT") == MOST_SHOWN
    assert "3 more rules" in text


class Scene:
    """A scene that records its nodes in a list."""

    def __init__(self):
        self.nodes = {}

    def add(self, name, *_, **__):
        node = SimpleNamespace(visible=True, remove=lambda: self.nodes.pop(name))
        self.nodes[name] = node
        return node

    add_mesh_simple = add_line_segments = add


def test_nodes_exist_only_while_their_rule_holds_and_obey_their_switch():
    stage = stage_of(kept(RULES["UPRIGHT"]))
    scene, switches = Scene(), Switches()
    nodes = RuleNodes(scene, stage, switches)
    assert "rule" in switches.groups
    q = stage.track.at(np.array([stage.duration]))[0][0]
    nodes.move_to(0.0, q)
    assert not scene.nodes
    nodes.move_to(stage.duration, q)
    assert len(scene.nodes) == 2
    nodes.move_to(stage.duration - 0.01, q)
    assert len(scene.nodes) == 2
    switches.switch("rule", False)
    assert not any(one.visible for one in scene.nodes.values())
    nodes.move_to(0.0, q)
    assert not scene.nodes
    nodes.move_to(stage.duration, q)
    assert not any(one.visible for one in scene.nodes.values())
    switches.switch("rule", True)
    assert all(one.visible for one in scene.nodes.values())


def test_viser_draws_them():
    stage = stage_of((EXAMPLES / "33_camera_in_sight.yarc").read_text())
    with opened(Door("127.0.0.1", 0)) as server:
        picture = Picture(server, stage)
        for time in (0.0, stage.duration, 0.0, stage.duration / 1.5):
            picture.move_to(time)
        assert "rule" in picture.switches.groups
        assert len(picture._rules._nodes) == 1
