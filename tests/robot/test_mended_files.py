"""Tests of files that other programs accept, or nearly: they are repaired with a note. Where Pinocchio reads
the original, it checks the result.
"""

import numpy as np
import pinocchio as pin
import pytest

from tests.robot.made_arms import made, yarc
from tests.robot.trap_arms import LARGE, Y, arm, follows, joint, link, poses, robot, written
from yarclang.robot.kinematics import flange_poses
from yarclang.robot.kinematics.search import within

SIX = tuple(f"joint_{number}" for number in range(1, 7))


def fixed(name, parent, child, xyz=(0, 0, 0)):
    return joint(name, parent, child, xyz, kind="fixed")


def on_foot(inside):
    """Return an arm with a further link on its foot."""
    return robot(arm(), link("k", inside, shape=False), fixed("to_k", "base_link", "k"))


def picture(shape, material=""):
    return f"<visual><geometry>{shape}</geometry>{material}</visual>"


def body(shape):
    return f"<collision><geometry>{shape}</geometry></collision>"


def bare(*more):
    """Return an arm of six joints without the links flange and tool0."""
    parts = [link("base_link")]
    for name, parent, child, xyz, axis in LARGE:
        parts += [link(child), joint(name, parent, child, xyz, axis)]
    return robot(*parts, *more)


BOX = '<box size="1 1 1"/>'
COLOR = '<color rgba="{}"/>'
LIMITS = 'lower="-2.5" upper="2.5"'
MENDED = {
    # text, note, True if Pinocchio can read the original
    "limits of inf": (robot(arm()).replace(LIMITS, 'lower="-inf" upper="inf"'), "12 infinite limits",
        False),
    "limits of 1e308": (robot(arm()).replace(LIMITS, 'lower="-1e308" upper="1e308"'), "12 infinite limits",
        True),
    "effort of inf": (robot(arm()).replace('effort="500"', 'effort="inf"'), "6 infinite limits", False),
    "tabs in numbers": (robot(arm()).replace('xyz="0 0 0.78"', 'xyz="0\t0 0.78"'),
        "lists of numbers with tabs", False),
    "line ends in numbers": (robot(arm()).replace('xyz="0 0 0.78"', "xyz='\n"
        "0\r\n"
        "0\n"
        "0.78 '"), "1 lists of numbers", False),
    "a capsule of version 1.0": (
        on_foot(body('<capsule radius="0.01" length="0.1"/>')).replace(' version="1.1"', ""),
        "1 capsules are kept",
        True,
    ),
    "a cylinder that is only drawn and has no size": (
        on_foot(picture('<cylinder radius="0" length="1"/>')),
        "1 shapes without a size",
        True,
    ),
    "a ball that collides and has no size": (on_foot(body('<sphere radius="0"/>')), "1 shapes without a size",
        True),
    "a disc": (on_foot(body('<cylinder radius="0.1" length="0"/>')), "1 collision shapes with a side of 0",
        True),
    "a picture without a shape": (on_foot("<visual><geometry/></visual>"), "1 visuals without a shape",
        True),
    "a picture without a file": (on_foot(picture('<mesh filename=""/>')), "1 visuals without a shape", True),
    "a picture of scale 0": (on_foot(picture('<mesh filename="a.stl" scale="0 0 0"/>')), "1 visuals", True),
    "a material without a name": (on_foot(picture(BOX, f"<material>{COLOR.format('0 0 0 1')}</material>")),
        "1 materials", True),
    "a material twice": (
        robot(2 * f'<material name="a">{COLOR.format("0 0 0 1")}</material>', arm()),
        "1 materials that are repeated",
        False,
    ),
    "colours up to 255": (
        robot(f'<material name="a">{COLOR.format("255 127.5 0 1")}</material>', arm()),
        "1 colours from 0 to 255",
        True,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", MENDED)
def test_what_is_mended_is_the_same_arm(name, tmp_path):
    text, note, readable = MENDED[name]
    file = written(tmp_path, text)
    result = yarc("robot", "new", file, "--yes", "-o", tmp_path / "s")
    assert result.exit_code == 0, result.output
    assert note in result.output
    arm_ = made(file, tmp_path / "r", "--tcp", "0,0,0")
    assert arm_.joint_names == SIX
    original = text if readable else robot(arm())
    q = within(arm_.chain, arm_.limits, 100)
    true = poses(original, "base_link", "tool0", SIX, q)
    np.testing.assert_allclose(flange_poses(arm_.chain, q), true, atol=1e-9)


def test_the_floor_of_files_that_pinocchio_reads():
    readable = 0
    for text, _, said in MENDED.values():
        try:
            pin.buildModelFromXML(text)
        except ValueError:
            assert not said
            continue
        readable += 1
    assert readable >= 8


def test_limits_without_an_end_are_guesses_and_an_endless_effort_is_unknown(tmp_path):
    text = robot(arm()).replace(LIMITS, 'lower="-inf" upper="Infinity"').replace('"500"', '"1e30"')
    arm_ = made(written(tmp_path, text), tmp_path / "r")
    np.testing.assert_allclose(arm_.limits.upper, np.pi)
    toml = (tmp_path / "r/robot.toml").read_text()
    assert toml.count("position = [-180, 180]  # guess:") == 6
    assert "effort at most" not in toml


def test_a_capsule_is_seen_and_a_disc_has_a_thickness(tmp_path):
    made(written(tmp_path, MENDED["a capsule of version 1.0"][0]), tmp_path / "r")
    copy = (tmp_path / "r/arm.urdf").read_text()
    assert 'version="1.1"' in copy
    made(written(tmp_path, MENDED["a disc"][0]), tmp_path / "s")
    assert '<cylinder radius="0.1" length="0.001"/>' in (tmp_path / "s/arm.urdf").read_text()


def test_a_colour_keeps_its_hue(tmp_path):
    made(written(tmp_path, MENDED["colours up to 255"][0]), tmp_path / "r")
    assert 'rgba="1 0.5 0 1"' in (tmp_path / "r/arm.urdf").read_text()


@pytest.mark.parametrize(
    ("text", "code"),
    [
        (on_foot("<collision><geometry/></collision>"), "Y1356"),
        (on_foot(body('<sphere radius="-1"/>')), "Y1346"),
        (on_foot(body('<mesh filename=""/>')), "Y13"),
        (robot(arm()).replace(LIMITS, 'lower="nan" upper="2.5"'), "Y1345"),
        (robot(arm()).replace(LIMITS, 'lower="inf" upper="2.5"'), "Y1316"),
    ],
)
def test_what_collides_or_means_nothing_is_not_mended(text, code, tmp_path):
    result = yarc("robot", "new", written(tmp_path, text), "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 1
    assert code in result.output
    assert not (tmp_path / "r").exists()


# ------------------------------------------------------------------------ which link, which format

GRIPPERS = (
    "hand", "panda_hand", "onrobot_rg2_base_link", "robotiq_85_base_link", "wsg_50_base_link", "suction_cup",
        "vacuum_tool", "gripper_base",
    "palm", "EOAT", "welding_torch", "spindle", "ft_sensor_link", "camera_link",
)  # fmt: skip


@pytest.mark.parametrize("name", GRIPPERS)
def test_no_grippers_base_is_the_flange(name, tmp_path):
    made(written(tmp_path, bare(link(name), fixed("g", "link_6", name, (0, 0, 0.1)))), tmp_path / "r")
    assert 'flange = "link_6"' in (tmp_path / "r/robot.toml").read_text()


@pytest.mark.parametrize("names", [("hand_finger1", "hand_finger2"), ("g1", "g2")])
def test_what_fingers_move_on_is_no_flange_whatever_its_name(names, tmp_path):
    fingers = [
        link(name[::-1]) + joint(name, "thing", name[::-1], (0, side, 0), Y, "prismatic")
        for name, side in zip(names, (0.1, -0.1), strict=True)
    ]
    arm_ = made(
        written(tmp_path, bare(link("thing"), fixed("g", "link_6", "thing"), *fingers)), tmp_path / "r"
    )
    assert arm_.joint_names == SIX
    assert 'flange = "link_6"' in (tmp_path / "r/robot.toml").read_text()


@pytest.mark.parametrize("name", ["link_7", "adapter", "eef", "link_ee"])
def test_one_more_link_is_the_flange(name, tmp_path):
    made(written(tmp_path, bare(link(name), fixed("g", "link_6", name, (0, 0, 0.1)))), tmp_path / "r")
    assert f'flange = "{name}"' in (tmp_path / "r/robot.toml").read_text()


@pytest.mark.parametrize("kind", ["floating", "planar"])
def test_a_joint_of_vehicles_in_the_middle_of_an_arm_asks(kind, tmp_path):
    text = robot(arm()).replace('name="joint_3" type="revolute"', f'name="joint_3" type="{kind}"')
    file = written(tmp_path, text)
    result = yarc("robot", "new", file, "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 1
    assert "Y1365" in result.output
    assert "joint_1, joint_2" in result.output
    assert made(file, tmp_path / "s", "--base", "link_3").size == 3


def test_a_follower_above_a_vehicle_asks_nothing(tmp_path):
    text = robot(
        link("rail"), link("slide"),
            joint("rail_joint", "rail", "slide", axis=Y, kind="prismatic", more=follows("joint_1")),
                arm(base=("slide", "planar"))
    )  # fmt: skip
    assert made(written(tmp_path, text), tmp_path / "r").joint_names == SIX


@pytest.mark.parametrize("comment", ["<!-- from <sdf version='1.6'> -->", "<!-- <mujoco> -->\n<!---->"])
def test_another_format_in_a_comment_is_none(comment, tmp_path):
    assert made(written(tmp_path, comment + robot(arm())), tmp_path / "r").size == 6


@pytest.mark.parametrize("text", ["<!-- <robot> --><sdf version='1.6'/>", "<?xml version='1.0'?>\n<mujoco/>"])
def test_another_format_after_a_comment_is_one(text, tmp_path):
    result = yarc("robot", "new", written(tmp_path, text), "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 1
    assert "format, not a URDF" in result.output
