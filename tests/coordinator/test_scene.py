"""Tests of the description of the robot and its surroundings for programs that draw them: it agrees with the
files, and clients are told of each change.
"""

import asyncio
import shutil
import xml.etree.ElementTree as ET
from pathlib import Path
from urllib.parse import unquote, urlsplit

import numpy as np
import pinocchio
import pytest
from coordinator.virtual import coordinating, done, run
from handling.carrying import CELL, GIVEN, HEAD, PICK, PUT
from programs import robot_of

from yarclang.cell.description import Names, load_cell
from yarclang.coordinator import scene as module
from yarclang.coordinator.attached import Here
from yarclang.coordinator.messages import events, orders
from yarclang.coordinator.scene import model_described, scene_described
from yarclang.handling.parts import first_parts
from yarclang.robot.description import load_robot
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.runtime.actions import Trouble
from yarclang.semantics.declared.meanings import is_word

FLOOR = """
[[zones]]
name = "FLOOR"
rule = "allowed"
shape = "half-space"
frame = "B"
normal = [0, 3, 4]
xyz = [0, 0, -5000]
watch = ["tcp"]
"""
ALL = (
    """
units = "mm,deg,s"

[[obstacles]]
name = "BOX"
shape = "box"
frame = "B"
xyz = [1000, 0, 100]
rpy = [0, 0, 90]
size = [100, 200, 300]

[[obstacles]]
name = "ROD"
shape = "cylinder"
frame = "B"
xyz = [2000, 0, 0]
radius = 20
length = 400

[[obstacles]]
name = "CUP"
shape = "mesh"
frame = "FLANGE"
file = "a cup.stl"
xyz = [0, 0, 500]

[[zones]]
name = "SLOW"
rule = "slow"
shape = "sphere"
frame = "B"
xyz = [0, 0, 0]
radius = 100
speed = 250

[[zones]]
name = "ELBOW_UP"
rule = "allowed"
shape = "joints"
joints = { J1 = [-100, 100] }
"""
    + FLOOR
)
TRIANGLE = (
    "solid a\n"
    " facet normal 0 0 1\n"
    " outer loop\n"
    " vertex 0 0 0\n"
    " vertex 10 0 0\n"
    " vertex 0 10 0\n"
    " endloop\n"
    " endfacet\n"
    "endsolid a\n"
)


def joint_positions(robot, seed=0):
    drawn = np.random.default_rng(seed)
    lower, upper = (
        np.where(np.isfinite(one), one, default)
        for one, default in ((robot.limits.lower, -3.0), (robot.limits.upper, 3.0))
    )
    return drawn.uniform(lower, upper)


@pytest.fixture
def meshed(tmp_path):
    """Return INDUSTRIAL6 with a mesh whose name needs an escape, a missing mesh, and a finger whose joint
    isn't an axis of the robot.
    """
    folder = tmp_path / "with meshes"
    shutil.copytree(robot_of("INDUSTRIAL6").folder, folder)
    (folder / "a cup.stl").write_text(TRIANGLE)
    (path,) = folder.glob("*.urdf")
    root = ET.parse(path)
    first = next(root.iter("link"))
    for name in ("a cup.stl", "missing.stl"):
        geometry = ET.SubElement(ET.SubElement(first, "visual"), "geometry")
        ET.SubElement(geometry, "mesh", filename=name)
    ET.SubElement(root.getroot(), "link", name="finger")
    joint = ET.SubElement(root.getroot(), "joint", name="finger_joint", type="prismatic")
    for tag, given in (("parent", {"link": first.get("name")}), ("child", {"link": "finger"})):
        ET.SubElement(joint, tag, given)
    ET.SubElement(joint, "axis", xyz="0 0 1")
    ET.SubElement(joint, "limit", lower="0", upper="0.1", effort="1", velocity="1")
    root.write(path)
    table = (folder / "robot.toml").read_text()
    (folder / "robot.toml").write_text(f'ignored_joints = ["finger_joint"]\n{table}')
    found = load_robot(str(folder))
    assert found.value is not None, [one.message for one in found.diagnostics]
    return found.value


@pytest.mark.parametrize("name", ["INDUSTRIAL6", "TRACKED_MANIPULATOR"])
def test_the_model_is_the_robot(name):
    robot = robot_of(name)
    told = model_described(robot)
    assert told.name == robot.name
    model = pinocchio.buildModelFromXML(told.urdf)
    assert list(model.names)[1:] == [one.name for one in told.joints] == list(robot.joint_names)
    data = model.createData()
    for seed in range(5):
        q = joint_positions(robot, seed)
        pinocchio.framesForwardKinematics(model, data, q)
        base, flange, tool = (
            data.oMf[model.getFrameId(link)].homogeneous for link in (told.base, told.flange, told.tool)
        )
        wanted = flange_poses(robot.chain, q[None])[0]
        np.testing.assert_allclose(np.linalg.inv(base) @ flange, wanted, atol=1e-9)
        tcp = robot.flange_from_frame.get("TCP", np.eye(4))
        np.testing.assert_allclose(np.linalg.inv(base) @ tool, wanted @ tcp, atol=1e-9)
    for at, one in enumerate(told.joints):
        unit = robot.axis_units[at]
        for said, limit in (
            (one.lower, robot.limits.lower[at]),
            (one.upper, robot.limits.upper[at]),
            (one.velocity, robot.limits.velocity[at]),
            (one.acceleration, robot.limits.acceleration[at]),
        ):
            assert (said is None) == (not np.isfinite(limit))
            assert said is None or said * unit == pytest.approx(limit)


def test_meshes_are_files_and_joints_that_are_no_axes_stand_still(meshed):
    told = model_described(meshed)
    names = [one.get("filename") for one in ET.fromstring(told.urdf).iter("mesh")]
    (uri,) = [one for one in names if one.startswith("file://")]
    assert Path(unquote(urlsplit(uri).path)).read_text() == TRIANGLE
    assert [one.code for one in told.findings] == ["Y1537"]
    assert "missing.stl" in told.findings[0].message
    model = pinocchio.buildModelFromXML(told.urdf)
    assert model.nq == meshed.size
    assert model.existFrame("finger")


def test_links_without_visual_shapes_look_like_their_collision_shapes(meshed):
    (path,) = meshed.folder.glob("*.urdf")
    root = ET.parse(path)
    told = 0
    for link in root.iter("link"):
        for one in link.findall("visual"):
            link.remove(one)
        for shape in link.iterfind("collision/geometry/*"):
            told += 3 if shape.tag == "capsule" else 1
    ET.SubElement(
        ET.SubElement(ET.SubElement(next(root.iter("link")), "collision"), "geometry"),
        "mesh",
        filename="a cup.stl",
        scale="2 2 2",
    )
    root.write(path)
    robot = load_robot(str(meshed.folder)).value
    made = ET.fromstring(model_described(robot).urdf)
    links = {link.get("name"): link for link in made.iter("link")}
    shown = [one for link in links.values() for one in link.findall("visual")]
    assert len(shown) == told + 1 > 5
    for link in links.values():
        both = [
            [
                (
                    shape.tag,
                    *map(
                        float,
                        " ".join(
                            value for key, value in sorted(shape.attrib.items()) if key != "filename"
                        ).split(),
                    ),
                )
                for shape in link.iterfind(f"{tag}/geometry/*")
            ]
            for tag in ("visual", "collision")
        ]
        assert sorted(both[0]) == sorted(both[1])
    assert all(
        one.find("geometry/mesh") is None or one.find("geometry/mesh").get("filename").startswith("file:")
        for one in shown
    )


def test_a_robot_that_has_changed_is_not_described_as_the_one_that_is_served(meshed):
    (path,) = meshed.folder.glob("*.urdf")
    root = ET.parse(path)
    next(joint for joint in root.iter("joint") if joint.get("type") == "revolute").find("origin").set(
        "xyz", "1 2 3"
    )
    root.write(path)
    with pytest.raises(Trouble, match="has changed since it was served"):
        model_described(meshed)
    path.write_text("<robot")
    with pytest.raises(Trouble, match="can't be read"):
        model_described(meshed)


def cell_of(folder, text):
    (folder / "cell.toml").write_text(text)
    (folder / "a cup.stl").write_text(TRIANGLE)
    read = load_cell(folder / "cell.toml", Names(is_word, robot_of("INDUSTRIAL6")))
    assert read.value is not None
    assert not [one.message for one in read.diagnostics]
    return read.value


def told_of(cell):
    return scene_described(robot_of("INDUSTRIAL6"), cell, first_parts(cell), "", ())


def test_the_scene_is_the_cell(tmp_path):
    cell = cell_of(tmp_path, ALL)
    told = told_of(cell)
    links = model_described(robot_of("INDUSTRIAL6"))
    found = {one.name: one for one in told.items}
    assert {name: (one.kind, one.rule, one.frame) for name, one in found.items()} == {
        "BOX": ("body", None, links.base),
        "ROD": ("body", None, links.base),
        "CUP": ("body", None, links.flange),
        "FLOOR": ("zone", "allowed", links.base),
        "SLOW": ("zone", "slow", links.base),
    }
    assert found["SLOW"].speed == 250.0
    assert found["BOX"].shape.size == (0.1, 0.2, 0.3)
    np.testing.assert_allclose(
        found["BOX"].pose, [[0, -1, 0, 1], [1, 0, 0, 0], [0, 0, 1, 0.1], [0, 0, 0, 1]], atol=1e-9
    )
    assert (found["ROD"].shape.radius, found["ROD"].shape.length) == (0.02, 0.4)
    cup = found["CUP"].shape
    assert cup.mesh.startswith("file:///")
    assert cup.mesh.endswith("a%20cup.stl")
    assert cup.scale == (0.001, 0.001, 0.001)
    # The border contains the point in the cell's file, and its z axis is the normal.
    plane = np.array(found["FLOOR"].pose)
    np.testing.assert_allclose(plane[:3, 2], [0.0, 0.6, 0.8], atol=1e-9)
    assert (np.array([0.0, 0.0, -5.0]) - plane[:3, 3]) @ plane[:3, 2] == pytest.approx(0.0, abs=1e-8)
    assert np.linalg.det(plane) == pytest.approx(1.0)
    assert told.notes == ("the zone ELBOW_UP is a window of joint positions, which can't be drawn",)


def test_what_cant_be_shown_is_said_and_the_number_is_bounded(tmp_path, monkeypatch):
    cell = cell_of(tmp_path, ALL)
    (tmp_path / "a cup.stl").unlink()
    monkeypatch.setattr(module, "MOST_ITEMS", 2)
    told = told_of(cell)
    assert len(told.items) == 2
    assert told.notes[0] == "2 more bodies, zones and parts are left out: at most 2 are sent"
    assert any("CUP isn't shown" in one for one in told.notes)


def test_the_version_is_that_of_the_content(tmp_path):
    first = told_of(cell_of(tmp_path, ALL))
    assert told_of(cell_of(tmp_path, ALL + "# the same\n")).version == first.version
    assert told_of(cell_of(tmp_path, ALL.replace("1000", "1001"))).version != first.version


def changes(listening):
    return sum(isinstance(one, events.SceneChanged) for one in listening.waiting())


def test_who_watches_hears_of_each_change(tmp_path):
    cell = CELL.format(**GIVEN)
    (tmp_path / "cell.toml").write_text(cell)

    async def watched():
        async with coordinating(folder=tmp_path) as (_, coordinator, client):
            watcher, listening = Here(coordinator, "watcher"), coordinator.subscribe()

            async def scene():
                told = await watcher.ask(orders.AskScene())
                return {one.name: one for one in told.items}, told

            _, told = await scene()
            assert (told.cell, told.items) == (None, ())
            assert not changes(listening)
            await done(client, 'CELL "cell.toml"\nDEFAULT {GRIPPER} [50%] (mm,deg,s) {B}')
            await asyncio.sleep(0.1)
            assert changes(listening)
            items, told = await scene()
            assert told.cell == str(tmp_path / "cell.toml")
            assert items["BOX"].kind == "part"
            lies = items["BOX"]
            await scene()
            assert not changes(listening)
            await client.parts.put("BOX", "{GRIPPER}", np.eye(4))
            await asyncio.sleep(0.1)
            assert changes(listening)
            items, _ = await scene()
            assert items["BOX"].frame != lies.frame
            (tmp_path / "cell.toml").write_text(cell + FLOOR)
            items, _ = await scene()
            await asyncio.sleep(0.1)
            assert changes(listening)
            assert "FLOOR" in items
            (tmp_path / "cell.toml").write_text("[[obstacles")
            items, _ = await scene()
            # a file that can't be read: the last valid cell is shown, which motions still respect
            assert "FLOOR" in items

    run(watched())


def test_parts_go_with_the_gripper_while_a_program_runs(tmp_path):
    (tmp_path / "cell.toml").write_text(CELL.format(**GIVEN))
    (tmp_path / "yarc.toml").write_text('robot = "INDUSTRIAL6"\n')
    (tmp_path / "all.yarc").write_text(HEAD + PICK + PUT)

    async def watched():
        async with coordinating(folder=tmp_path) as (_, coordinator, client):
            owner, watcher = Here(coordinator, "owner"), Here(coordinator, "watcher")
            listening = coordinator.subscribe()
            client.session.release()
            await owner.ask(orders.Own())
            loaded = await owner.ask(orders.Load(file=str(tmp_path / "all.yarc")))
            running = asyncio.create_task(owner.ask(orders.Run(program=loaded.program.number, approach=True)))

            async def box():
                told = await watcher.ask(orders.AskScene())
                return {one.name: (one.carried, np.array(one.pose)) for one in told.items}.get("BOX")

            seen = []
            while not running.done():
                await asyncio.sleep(0.2)
                if changes(listening) or not seen:
                    seen.append(await box())
            assert (await running).well
            seen.append(await box())
            carried = [one[0] for one in seen]
            first, last = carried.index(True), len(carried) - carried[::-1].index(True)
            assert 0 < first < last < len(carried)
            assert all(carried[first:last])
            np.testing.assert_allclose(seen[0][1][:3, 3], [0.3, 0.85, 0.65], atol=1e-9)
            np.testing.assert_allclose(seen[last][1][:3, 3], [-0.25, 0.9, 0.7], atol=1e-4)
            # The place was computed during the program. Afterwards the coordinator reports the same place.
            np.testing.assert_allclose(seen[last][1], seen[-1][1], atol=1e-4)
            assert seen[-1][0] is False
            (kept,) = (await watcher.ask(orders.AskParts(cell=str(tmp_path / "cell.toml")))).parts
            np.testing.assert_allclose(kept.pose, seen[-1][1], atol=1e-9)

    run(watched())


def test_a_cell_of_the_program_that_was_run_is_read_again(tmp_path):
    two, _, _ = ALL.partition('[[obstacles]]\nname = "CUP"')
    (tmp_path / "cell.toml").write_text(two)
    (tmp_path / "up.yarc").write_text('CELL "cell.toml"\nP0010 MOVEJ 0 0 0 0 5 0 [1] (deg,s)\n')

    async def watched():
        async with coordinating(folder=tmp_path) as (_, coordinator, client):
            client.session.leave()
            mine, listening = Here(coordinator, "anna"), coordinator.subscribe()
            await mine.ask(orders.Own())
            loaded = await mine.ask(orders.Load(file=str(tmp_path / "up.yarc"), here=True))
            assert (await mine.ask(orders.AskScene())).cell is None
            assert not changes(listening)
            assert (await mine.ask(orders.Run(program=loaded.program.number))).well
            await asyncio.sleep(0.1)
            assert changes(listening)
            before = await mine.ask(orders.AskScene())
            assert before.cell == str(tmp_path / "cell.toml")
            (tmp_path / "cell.toml").write_text(two.replace('"ROD"', '"PIPE"'))
            after = await mine.ask(orders.AskScene())
            assert "PIPE" in {one.name for one in after.items}
            assert after.version != before.version
            for broken in ("[[obstacles", 'units = "mm,deg,s"\n[[obstacles]]\nname = "A"\n'):
                (tmp_path / "cell.toml").write_text(broken)
                told = await mine.ask(orders.AskScene())
                assert [one.name for one in told.items] == [one.name for one in before.items]
                assert "as it was when the program was loaded" in told.notes[0]
            (tmp_path / "cell.toml").unlink()
            assert (await mine.ask(orders.AskScene())).items == told.items

    run(watched())
