"""Markers for RViz: the URDF has the robot's kinematics, and markers are at the cell's bodies."""

import json
from dataclasses import fields
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from programs import robot_of

import yarclang
from yarclang.cell.description import Names, load_cell
from yarclang.coordinator.scene import model_described, scene_described
from yarclang.handling.parts import first_parts
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.ros.node import markers
from yarclang.ros.node.kinematics import Kinematics, inverse, placed, quaternion, times
from yarclang.ros.node.markers import Marker, fill, ghost_markers, scene_markers, thinned
from yarclang.semantics.declared.meanings import is_word
from yarclang.transforms import roll_pitch_yaw
from yarclang.view import colours

ROOT = Path(yarclang.__file__).parents[1]
EXAMPLES = ROOT / "examples"
ROBOTS = sorted(one.parent.name.upper() for one in (ROOT / "stdlib" / "robots").glob("*/robot.toml"))
SLIDING = """<robot name="s"><material name="red"><color rgba="1 0 0 1"/></material>
<link name="world"/><link name="base"/><link name="a"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
<link name="b"><visual><origin xyz="0 0 1"/><geometry><box size="1 2 3"/></geometry><material name="red"/></visual>
<collision><geometry><sphere radius="9"/></geometry></collision></link>
<joint name="root" type="fixed"><parent link="world"/><child link="base"/><origin xyz="5 6 7" rpy="0 0 1.5707963267948966"/></joint>
<joint name="j" type="prismatic"><parent link="base"/><child link="a"/><axis xyz="0 3 4"/></joint>
<joint name="k" type="continuous"><parent link="a"/><child link="b"/></joint></robot>"""  # noqa: E501


def rows(pose):
    return np.array(pose)


def drawn_joints(robot, seed):
    lower, upper = (
        np.where(np.isfinite(one), one, default)
        for one, default in ((robot.limits.lower, -3.0), (robot.limits.upper, 3.0))
    )
    return np.random.default_rng(seed).uniform(lower, upper)


@pytest.mark.parametrize("name", ROBOTS)
def test_the_kinematics_are_the_robots(name):
    robot = robot_of(name)
    told = model_described(robot)
    kinematics = Kinematics(told.urdf, told.base)
    for seed in range(10):
        q = drawn_joints(robot, seed)
        poses = kinematics.poses(dict(zip(robot.joint_names, q.tolist(), strict=True)))
        wanted = flange_poses(robot.chain, q[None])[0]
        np.testing.assert_allclose(rows(poses[told.flange]), wanted, atol=1e-9)
        tcp = robot.flange_from_frame.get("TCP", np.eye(4))
        np.testing.assert_allclose(rows(poses[told.tool]), wanted @ tcp, atol=1e-9)


def test_a_sliding_joint_and_a_base_that_is_not_the_root():
    kinematics = Kinematics(SLIDING, "base")
    poses = kinematics.poses({"j": 0.5, "k": np.pi / 2})
    np.testing.assert_allclose(rows(poses["b"])[:3, 3], [0.0, 0.3, 0.4], atol=1e-12)
    np.testing.assert_allclose(rows(poses["b"])[:3, :3], [[1, 0, 0], [0, 0, -1], [0, 1, 0]], atol=1e-12)
    np.testing.assert_allclose(rows(poses["base"]), np.eye(4), atol=1e-12)
    np.testing.assert_allclose(rows(poses["world"])[:3, 3], [-6.0, 5.0, -7.0], atol=1e-12)
    assert [(one.link, one.shape.type, one.colour) for one in kinematics.bodies] == [
        ("a", "sphere", None),
        ("b", "box", (1.0, 0.0, 0.0, 1.0)),
    ]


@pytest.mark.parametrize("seed", range(20))
def test_rotations_agree_with_ours(seed):
    drawn = np.random.default_rng(seed)
    rpy = drawn.uniform(-np.pi, np.pi, 3) * (1.0, 0.5, 1.0)
    if seed < 4:  # no turn or half turns, where the quaternion has a single component
        rpy = np.array([(0, 0, 0), (np.pi, 0, 0), (0, 0, np.pi), (np.pi, 0, np.pi)][seed], dtype=float)
    pose = placed((1.0, 2.0, 3.0), tuple(rpy.tolist()))
    again = placed((1.0, 2.0, 3.0), tuple(roll_pitch_yaw(rows(pose)[:3, :3]).tolist()))
    np.testing.assert_allclose(rows(again), rows(pose), atol=1e-9)
    x, y, z, w = quaternion(pose)
    turned = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    np.testing.assert_allclose(turned, rows(pose)[:3, :3], atol=1e-9)
    np.testing.assert_allclose(rows(times(pose, inverse(pose))), np.eye(4), atol=1e-12)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("<robot", "no XML"),
        (SLIDING.replace('child link="a"', 'child link="base"'), "don't form a tree"),
        (SLIDING.replace('child link="b"', 'child link="world"'), "don't form a tree"),
        (SLIDING.replace('child link="b"', 'child link="c"'), "don't form a tree"),
        (SLIDING.replace('"0 3 4"', '"0 nan 4"'), "xyz='0 nan 4'"),
        (SLIDING.replace('"0 3 4"', '"0 0 0"'), "no direction"),
        (SLIDING.replace('"1 2 3"', '"1 2"'), "size='1 2' of <box>"),
        (SLIDING.replace('name="base"', 'name="bases"'), "don't form a tree"),
        ("<robot><link name='a'/></robot>", "no link 'base'"),
        ("", "no XML"),
    ],
)
def test_what_is_no_description_is_refused(text, said):
    with pytest.raises(ValueError, match=said):
        Kinematics(text, "base")


def scene_of(name, robot="INDUSTRIAL6"):
    robot = robot_of(robot)
    cell = load_cell(EXAMPLES / name, Names(is_word, robot)).value
    told = scene_described(robot, cell, first_parts(cell), "", ())
    return cell, json.loads(told.model_dump_json())


def item(kind, **shape):
    pose = np.eye(4)
    pose[:3, 3] = 1.0, 2.0, 3.0
    return {
        "name": "A",
        "kind": kind,
        "rule": "forbidden" if kind == "zone" else None,
        "speed": None,
        "sure": True,
        "carried": False,
        "frame": "base_link",
        "pose": pose.tolist(),
        "shape": {"size": None, "radius": None, "length": None, "mesh": None, "scale": None, **shape},
    }


def shown(*items):
    return scene_markers({"items": items})


@pytest.mark.parametrize(
    "name", ["cell.toml", "05_pick_and_place.toml", "12_machine_cell.toml", "13_vacuum_cell.toml"]
)
def test_all_of_a_cell_is_drawn_and_named(name):
    cell, scene = scene_of(name)
    made = scene_markers(scene)
    assert made[0] == Marker(action=markers.DELETE_ALL)
    assert [one.id for one in made] == list(range(len(made)))
    assert len({(one.namespace, one.id) for one in made}) == len(made)
    names = " ".join(one.text for one in made)
    for one in (*cell.obstacles, *cell.zones, *(part.body for part in cell.parts)):
        assert one.name in names
    for one in made[1:]:
        assert one.frame_id
        assert all(np.isfinite(one.scale))
        assert one.namespace != "zones" or one.colour[3] < 1.0
        assert 0.0 <= min(one.colour) <= max(one.colour) <= 1.0


def test_a_capsule_is_a_cylinder_with_two_spheres_and_a_name_above():
    _, body, *ends, name = shown(item("body", type="capsule", radius=0.1, length=0.6))
    assert (body.type, body.scale) == (markers.CYLINDER, (0.2, 0.2, 0.6))
    assert [one.pose[2][3] for one in ends] == pytest.approx([2.7, 3.3])
    assert {one.type for one in ends} == {markers.SPHERE}
    assert name.text == "A"
    assert name.pose[2][3] == pytest.approx(3.0 + 0.3 + 0.1 + 0.06)


@pytest.mark.parametrize(("rule", "side"), [("allowed", 1.0), ("forbidden", -1.0), ("slow", 1.0)])
def test_a_half_space_is_a_plane_with_an_arrow_to_where_the_tool_may_be(rule, side):
    told = {**item("zone", type="half-space"), "rule": rule}
    told["pose"] = placed((0.0, 0.0, 0.5), (0.3, 0.4, 0.5))
    _, plane, arrow, name = shown(told)
    normal = rows(told["pose"])[:3, 2]
    np.testing.assert_allclose(rows(arrow.pose)[:3, 0], side * normal, atol=1e-12)
    assert np.linalg.det(rows(arrow.pose)) == pytest.approx(1.0)
    assert plane.scale[2] < 0.01 < plane.scale[0]
    # the arrow is on the plane, at its upper corner
    there = np.linalg.inv(rows(plane.pose)) @ rows(arrow.pose)[:, 3]
    np.testing.assert_allclose([*np.abs(there[:2]), there[2]], [1.08, 1.08, 0.0], atol=1e-12)
    assert rows(arrow.pose)[2, 3] > 1.0
    assert name.text.startswith("A: ")


def test_parts_that_may_be_elsewhere_and_slow_zones_say_so():
    sure, unsure = (
        shown({**item("part", type="box", size=[1.0, 1.0, 1.0]), "sure": one}) for one in (True, False)
    )
    assert sure[1].colour[3] == 1.0
    assert unsure[1].colour[3] < 1.0
    assert unsure[2].text == "A?"
    slow = shown({**item("zone", type="sphere", radius=1.0), "rule": "slow", "speed": 250.0})
    assert slow[2].text == "A: slow, 250 mm/s"


def test_shapes_without_extent_and_too_many_names_are_left_out():
    assert len(shown(item("body", type="capsule", radius=0.1, length=0.0))) == 4  # two spheres, a name
    many = shown(*[item("body", type="sphere", radius=0.1)] * 500)
    assert sum(one.type == markers.TEXT for one in many) == markers.MOST_NAMES
    assert len(many) == 1 + 500 + markers.MOST_NAMES


def test_colours_are_those_of_our_own_pictures():
    pairs = [
        (markers.BODY, colours.OBSTACLE),
        (markers.CARRIED, colours.TOOL),
        (markers.PART, colours.PART),
        (markers.GHOST, colours.GHOST),
        *((markers.ZONES[rule], colours.ZONES[rule]) for rule in colours.ZONES),
    ]
    for one, other in pairs:
        assert tuple(round(255 * part) for part in one[:3]) == other


@pytest.mark.parametrize("name", ROBOTS)
def test_the_ghost_is_the_path_of_the_tool_and_the_robot_at_its_end(name):
    robot = robot_of(name)
    told = model_described(robot)
    kinematics = Kinematics(told.urdf, told.base)
    course = np.linspace(drawn_joints(robot, 1), drawn_joints(robot, 2), 129)
    made = ghost_markers(kinematics, told.tool, robot.joint_names, course.tolist())
    assert made[0].action == markers.DELETE_ALL
    path = made[1]
    tcp = robot.flange_from_frame.get("TCP", np.eye(4))
    np.testing.assert_allclose(path.points, (flange_poses(robot.chain, course) @ tcp)[:, :3, 3], atol=1e-9)
    assert path.type == markers.LINE_STRIP
    ghost = made[2:]
    start = kinematics.poses(dict(zip(robot.joint_names, course[0].tolist(), strict=True)))
    assert {one.frame_id for one in made[1:]} == {told.base}
    poses = kinematics.poses(dict(zip(robot.joint_names, course[-1].tolist(), strict=True)))
    moved = [body for body in kinematics.bodies if not np.allclose(start[body.link], poses[body.link])]
    assert 4 < len(moved) < len(kinematics.bodies)
    for one, body in zip(ghost, moved, strict=True):
        np.testing.assert_allclose(
            rows(one.pose), rows(poses[body.link]) @ rows(body.link_from_shape), atol=1e-12
        )
        assert one.colour[3] < 1.0


def test_no_plan_draws_nothing_and_a_long_one_is_thinned():
    robot = robot_of("INDUSTRIAL6")
    told = model_described(robot)
    kinematics = Kinematics(told.urdf, told.base)
    assert ghost_markers(kinematics, told.tool, robot.joint_names, []) == (Marker(action=markers.DELETE_ALL),)
    long = [[one / 1e4] * 6 for one in range(10_000)]
    path = ghost_markers(kinematics, told.tool, robot.joint_names, long)[1]
    assert len(path.points) == markers.MOST_POINTS
    assert thinned(long, 500)[0] == long[0]
    assert thinned(long, 500)[-1] == long[-1]
    alone = ghost_markers(kinematics, told.tool, robot.joint_names, long[:1])[1]
    assert len(alone.points) == 2
    for wrong in ([[0.0] * 5], [[0.0] * 7]):
        with pytest.raises(ValueError, match="other joints"):
            ghost_markers(kinematics, told.tool, robot.joint_names, wrong)
    with pytest.raises(ValueError, match="no link 'elsewhere'"):
        ghost_markers(kinematics, "elsewhere", robot.joint_names, long)


def test_messages_get_all_fields():
    def message():
        three = lambda: SimpleNamespace(x=None, y=None, z=None)  # noqa: E731
        return SimpleNamespace(
            header=SimpleNamespace(frame_id=None),
            pose=SimpleNamespace(position=three(), orientation=SimpleNamespace(x=0, y=0, z=0, w=0)),
            scale=three(),
            color=SimpleNamespace(r=None, g=None, b=None, a=None),
        )

    made = Marker(
        "parts",
        3,
        markers.MESH,
        "base",
        placed((1.0, 2.0, 3.0)),
        (1.0, 1.0, 1.0),
        (0.1, 0.2, 0.3, 0.4),
        ((5.0, 6.0, 7.0),),
        "text",
        "file:///a.stl",
    )
    told = fill(message(), made, SimpleNamespace)
    assert (told.ns, told.id, told.type, told.action, told.header.frame_id) == ("parts", 3, 10, 0, "base")
    assert (told.pose.position.x, told.pose.position.z, told.pose.orientation.w) == (1.0, 3.0, 1.0)
    assert (told.color.r, told.color.a, told.scale.y) == (0.1, 0.4, 1.0)
    assert (told.points[0].y, told.text, told.mesh_resource) == (6.0, "text", "file:///a.stl")
    assert told.frame_locked is True
    assert len(fields(Marker)) == 11
