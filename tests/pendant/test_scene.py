"""Tests of the three-dimensional scene through the API: links are where the kinematics place them, meshes are
complete, and parts move with the gripper.
"""

import asyncio
import gzip
import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from coordinator.virtual import run
from hypothesis import given, settings
from hypothesis import strategies as st
from pendant.at_robot import pendant
from scipy.spatial.transform import Rotation

from yarclang.coordinator.messages.events import Began, OutputSet, Told
from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.scene.meshes import blob_of
from yarclang.pendant.scene.placements import moved_links, packed
from yarclang.report.solids import solid_of
from yarclang.robot.description import load_robot
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.shapes import Box, Cylinder, Sphere
from yarclang.transforms import quaternions

NEAR = """
units = "mm,deg,s"

[[obstacles]]
name = "POST"
shape = "box"
frame = "B"
xyz = [-400, 800, 1500]
size = [100, 600, 3000]
"""
HOSTILE = "<img src=x onerror=alert(1)>"
EXAMPLES = Path(__file__).parents[2] / "examples"


def unpacked(content):
    """Return the corners, triangles and normals of a mesh in its binary format."""
    count, triangles = np.frombuffer(content, "<u4", 2)
    corners = np.frombuffer(content, "<f4", 3 * count, 8).reshape(-1, 3)
    faces = np.frombuffer(content, "<u4", 3 * triangles, 8 + 12 * count).reshape(-1, 3)
    begins = 8 + 12 * count + 12 * triangles
    normals = np.frombuffer(content, np.int8, 3 * count, begins).reshape(-1, 3)
    assert len(content) == begins + 3 * count
    return corners, faces, normals / 127.0


def pose_of(link):
    """Return the matrix of a position and a quaternion, computed by scipy."""
    made = np.eye(4)
    made[:3, :3], made[:3, 3] = Rotation.from_quat(link[3:]).as_matrix(), link[:3]
    return made


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from(["INDUSTRIAL6", "TRACKED_MANIPULATOR"]),
    st.lists(st.floats(-7.0, 7.0), min_size=9, max_size=9),
)
def test_links_stand_where_the_kinematics_have_them(name, values):
    robot = load_robot(name).value
    q = np.array([values[: robot.size], [0.0] * robot.size])
    links = packed(moved_links(robot.chain, q))
    assert np.abs(links[1] - [0, 0, 0, 0, 0, 0, 1]).max() < 1e-12
    flange = pose_of(links[0, -1]) @ robot.chain.base_from_flange
    assert np.abs(flange - flange_poses(robot.chain, q[:1])[0]).max() < 1e-9
    # A joint doesn't move the links before it.
    other = q.copy()
    other[:, -1] += 0.3
    assert np.abs(packed(moved_links(robot.chain, other))[:, :-1] - links[:, :-1]).max() == 0.0


@settings(max_examples=100, deadline=None)
@given(
    st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3),
    st.sampled_from([0.0, 1e-9, 1.0, math.pi - 1e-9, math.pi]),
)
def test_quaternions_of_all_turns(axis, angle):
    length = float(np.linalg.norm(axis))
    turn = Rotation.from_rotvec(
        np.array(axis) / length * angle if length > 1e-3 else [0.0, 0.0, angle]
    ).as_matrix()
    found = quaternions(turn[None])[0]
    assert np.abs(Rotation.from_quat(found).as_matrix() - turn).max() < 1e-9
    assert abs(np.linalg.norm(found) - 1.0) < 1e-12


@pytest.mark.parametrize(
    ("shape", "volume"),
    [(Box(np.array([0.2, 0.3, 0.4])), 0.024), (Cylinder(0.1, 0.5), 0.0157), (Sphere(0.1), 0.0042)],
)
def test_a_mesh_keeps_its_body(shape, volume):
    """A mesh has the volume and the outward normals of its shape."""
    blob = blob_of(solid_of(shape))
    corners, faces, normals = unpacked(blob.content)
    if blob.packed:
        assert gzip.decompress(blob.packed) == blob.content
    three = corners[faces].astype(float)
    assert np.einsum(
        "ij,ij->i", three[:, 0], np.cross(three[:, 1], three[:, 2])
    ).sum() / 6.0 == pytest.approx(volume, rel=0.03)
    across = np.cross(three[:, 1] - three[:, 0], three[:, 2] - three[:, 0])
    assert np.abs(np.linalg.norm(normals, axis=1) - 1.0).max() < 0.02
    for side in range(3):
        assert (np.einsum("ij,ij->i", normals[faces[:, side]], across) > 0.0).all()
    if isinstance(shape, Box):
        assert len(corners) == 24
        assert np.abs(normals).max(axis=1).min() > 0.99


def scene(monkeypatch, tmp_path, work, **options):
    async def whole():
        async with pendant(monkeypatch, tmp_path, **options) as place:
            await work(place, place.logged_in("vera", Role.VIEWER))

    run(whole())


def test_a_scene_of_the_robot(monkeypatch, tmp_path):
    async def work(place, vera):
        told = (await vera.get("/api/scene")).told
        assert told["joints"] == list(place.world.robot.joint_names)
        assert {"robot"} <= {item["kind"] for item in told["items"]}
        assert {"B", "FLANGE", "TCP"} <= {one["name"] for one in told["axes"]}
        for item in told["items"]:
            mesh = await vera.get(f"/api/scene/mesh/{item['mesh']}")
            corners, faces, _ = unpacked(mesh.content)
            assert faces.max() < len(corners)
            assert "immutable" in mesh.headers["cache-control"]
            again = await vera.get(
                f"/api/scene/mesh/{item['mesh']}", headers=[("if-none-match", mesh.headers["etag"])]
            )
            assert (again.status, again.content) == (304, b"")
        # The display names the same version of the scene, and the links are displaced according to its joint
        # positions.
        line = vera.socket("/api/robot")
        display = await line.until(lambda one: one.get("event") == "display")
        assert display["scene"] == told["version"]
        robot = place.world.robot
        q = np.array(display["joints"]) * robot.axis_units
        links = np.array(display["links"]).reshape(-1, 7)
        flange = pose_of(links[-1]) @ robot.chain.base_from_flange
        assert np.abs(flange - flange_poses(robot.chain, q[None])[0]).max() < 1e-5
        assert np.abs(np.array(display["flange"]).reshape(4, 4) - flange).max() < 1e-5
        await line.close()

    scene(monkeypatch, tmp_path, work)


def test_placements(monkeypatch, tmp_path):
    async def work(place, vera):
        robot = place.world.robot
        rows = np.random.default_rng(1).uniform(-90.0, 90.0, (50, robot.size))
        told = await vera.post("/api/scene/placements", {"joints": rows.tolist()})
        links = np.frombuffer(told.content, "<f4").reshape(50, robot.size, 7)
        for row, one in zip(rows, links, strict=True):
            flange = pose_of(one[-1]) @ robot.chain.base_from_flange
            assert np.abs(flange - flange_poses(robot.chain, (row * robot.axis_units)[None])[0]).max() < 1e-5
        for wrong in (
            [[1.0]],
            [[0.0] * 40],
            [[1e300] * 6],
            [["0"] * 6],
            [[0.0] * 6] * 5001,
            "x",
            [[None] * 6],
        ):
            refused = await vera.post("/api/scene/placements", {"joints": wrong})
            assert refused.status == 400, wrong
            assert refused.told["help"]
        assert (await vera.post("/api/scene/placements", {"joints": []})).content == b""
        for nowhere in ("x", "..%2f..%2fetc%2fpasswd", "0" * 24, HOSTILE, "a" * 4000):
            assert (await vera.get(f"/api/scene/mesh/{nowhere}")).status == 404

    scene(monkeypatch, tmp_path, work)


def test_nobody_sees_it_without_a_login(monkeypatch, tmp_path):
    async def work(place, vera):
        mesh = (await vera.get("/api/scene")).told["items"][0]["mesh"]
        stranger = place.browser()
        assert (await stranger.get("/api/scene")).status == 401
        assert (await stranger.get(f"/api/scene/mesh/{mesh}")).status == 401
        assert (await stranger.post("/api/scene/placements", {"joints": []})).status == 401

    scene(monkeypatch, tmp_path, work)


def test_the_cost_is_paid_once(monkeypatch, tmp_path):
    """If twenty pages request the scene at once, it is made only once."""
    from yarclang.pendant.scene import scenery

    drawn, made = scenery.drawn, []
    monkeypatch.setattr(scenery, "drawn", lambda *given: made.append(1) or drawn(*given))

    async def work(place, vera):
        told = await asyncio.gather(*(vera.get("/api/scene") for _ in range(20)))
        assert len({one.content for one in told}) == 1
        lines = [vera.socket("/api/robot") for _ in range(20)]
        await asyncio.sleep(5.0)
        assert len(made) == 1
        await asyncio.gather(*(line.close() for line in lines))

    scene(monkeypatch, tmp_path, work)


def test_parts_are_where_the_gripper_has_them(monkeypatch, tmp_path):
    """Parts are shown where the coordinator reports them. During a program, the outputs of the program move
    them.
    """
    (tmp_path / "cell.toml").write_text((EXAMPLES / "05_pick_and_place.toml").read_text())
    (tmp_path / "yarc.toml").write_text('robot = "INDUSTRIAL6"\ncell = "cell.toml"\n')

    async def work(place, vera):
        def blank(told):
            return next(one for one in told["items"] if one["name"] == "BLANK 1")

        first = (await vera.get("/api/scene")).told
        assert blank(first)["joint"] == 0
        assert np.allclose(np.reshape(blank(first)["pose"], (3, 4))[:, 3], [0.3, 0.85, 0.65])
        anna = place.logged_in("anna", Role.PROGRAMMER)
        await anna.post("/api/control")
        line = vera.socket("/api/robot")
        told = await anna.order("place-part", part="BLANK 1", at="frame", frame="{GRIPPER}", pose=[0] * 6)
        assert told.status == 200, told.told
        # All pages are told that the scene has changed.
        await line.until(
            lambda one: one.get("event") == "display" and one["scene"] not in ("", first["version"])
        )
        second = (await vera.get("/api/scene")).told
        robot = place.world.robot
        assert blank(second)["joint"] == robot.size
        gripper = np.eye(4)
        gripper[:3] = np.reshape(
            next(one for one in second["axes"] if one["name"] == "GRIPPER")["pose"], (3, 4)
        )
        assert np.allclose(np.reshape(blank(second)["pose"], (3, 4)), gripper[:3], atol=1e-6)
        # An output of a program opens the gripper. The part stays where the robot is at that moment.
        scenery, showing = place.service.scenery, place.service.watched.showing
        showing._under_way = "a program"
        scenery.hear(OutputSet(time_s=0.0, name="GRIP", variable="M1", value=0.0))
        third = (await vera.get("/api/scene")).told
        showing._under_way = ""
        assert blank(third)["joint"] == 0
        here = flange_poses(robot.chain, showing.joints[None])[0]
        there = here @ np.linalg.inv(robot.chain.base_from_flange) @ gripper
        assert np.allclose(np.reshape(blank(third)["pose"], (3, 4)), there[:3], atol=1e-5)
        await line.close()

    scene(monkeypatch, tmp_path, work)


def test_what_stops_a_jog_is_lit_until_the_next_one(monkeypatch, tmp_path):
    """The body that has stopped a jog is highlighted until the next jog. It is taken from the coordinator's
    list of bodies, not from the wording of the message.
    """
    (tmp_path / "cell.toml").write_text(NEAR)
    (tmp_path / "yarc.toml").write_text('robot = "INDUSTRIAL6"\ncell = "cell.toml"\n')

    async def work(place, vera):
        showing = place.service.watched.showing
        anna = place.logged_in("anna", Role.PROGRAMMER)
        await anna.post("/api/control")
        line, jog = vera.socket("/api/robot"), anna.socket("/api/jog")
        for _ in range(200):
            if showing.stopped_by:
                break
            beat = await jog.until(lambda one: "beat" in one)
            jog.say({"press": 1, "beat": beat["beat"], "velocity": {"J1": 30.0}})
        assert "POST" in showing.stopped_by
        assert len(showing.stopped_by) == 2
        told = await line.until(lambda one: one.get("event") == "message" and one["stopped_by"])
        assert tuple(told["stopped_by"]) == showing.display().stopped_by
        scenery = place.service.scenery
        scenery.hear(Began(time_s=0.0, name="jog", duration_s=0.0, waits=0, client="x"))
        assert showing.display().stopped_by == ()
        scenery.hear(Told(time_s=0.0, text="link_5 would come too close to TABLE"))
        assert showing.display().stopped_by == ()
        await jog.close()
        await line.close()

    scene(monkeypatch, tmp_path, work)


async def loaded(browser, file):
    assert (await browser.post("/api/control")).status == 200
    told = (await browser.order("load", file=file, approach=True)).told
    assert told["program"] is not None, told
    return told["program"]["number"]


def test_a_loaded_program_stands_in_its_own_cell(monkeypatch, tmp_path):
    """A program with a cell is shown in this cell, although the session has none: with feeder, press and
    gripper, and with the parts at each time of the program.
    """
    for one in EXAMPLES.glob("05_pick_and_place.*"):
        (tmp_path / one.name).write_text(one.read_text())

    async def work(place, vera):
        otto = place.logged_in("otto", Role.OPERATOR)
        number = await loaded(otto, "05_pick_and_place.yarc")
        live = (await otto.get("/api/scene")).told
        assert "obstacle" not in {item["kind"] for item in live["items"]}
        told = (await otto.get(f"/api/scene?program={number}")).told
        names = {item["name"] for item in told["items"]}
        assert {"TRACK", "PRESS_TABLE", "FINGERS", "BLANK 1", "BLANK 3"} <= names
        assert told["tool"] == "GRIPPER"
        assert {"B", "FEEDER", "PRESS", "GRIPPER"} == {one["name"] for one in told["axes"] if one["matters"]}
        # At each time, the part has exactly one place. While the gripper carries it, it moves with the
        # gripper.
        course = (await otto.order("course", program=number)).told
        first = [item for item in told["items"] if item["name"] == "BLANK 1"]
        spans = sorted((item["begins_s"] or 0.0, item["ends_s"] or 1e9, item["joint"]) for item in first)
        assert [joint for _, _, joint in spans] == [0, place.world.robot.size, 0]
        assert all(one[1] == other[0] for one, other in itertools.pairwise(spans))
        assert spans[-1][1] < course["course"]["times"][-1]
        # The gripper takes the part where it lay before.
        robot = place.world.robot
        taken = min(course["course"]["times"], key=lambda time: abs(time - spans[1][0]))
        q = np.array(course["course"]["joints"][course["course"]["times"].index(taken)]) * robot.axis_units
        lying, held = (
            np.vstack([np.reshape(one["pose"], (3, 4)), [0, 0, 0, 1]])
            for one in sorted(first, key=lambda one: one["begins_s"] or 0.0)[:2]
        )
        there = flange_poses(robot.chain, q[None])[0] @ np.linalg.inv(robot.chain.base_from_flange) @ held
        assert np.abs(there - lying).max() < 1e-3
        for item in told["items"]:
            assert (await otto.get(f"/api/scene/mesh/{item['mesh']}")).status == 200

    scene(monkeypatch, tmp_path, work)


def test_a_program_is_drawn_once_for_its_own_session_only(monkeypatch, tmp_path):
    from yarclang.pendant.scene import programs

    (tmp_path / "p.yarc").write_text("ROBOT INDUSTRIAL6\nP0010 MOVEJ 5 0 0 0 0 0 [2] (deg,s)\n")
    drawn, made = programs.drawn, []
    monkeypatch.setattr(programs, "drawn", lambda *given: made.append(1) or drawn(*given))

    async def work(place, vera):
        otto = place.logged_in("otto", Role.OPERATOR)
        number = await loaded(otto, "p.yarc")
        told = await asyncio.gather(*(otto.get(f"/api/scene?program={number}") for _ in range(20)))
        assert {one.status for one in told} == {200}
        assert len(made) == 1
        other = place.logged_in("olga", Role.SERVICE)
        assert (await other.get(f"/api/scene?program={number}")).status == 409
        assert (await other.order("status")).status == 200
        assert (await other.get(f"/api/scene?program={number}")).status == 409
        assert (await place.browser().get(f"/api/scene?program={number}")).status == 401
        for wrong in ("", "x", "-1", "1e3", "٣", "9" * 5000, f"{number}%20", "%00"):
            refused = await otto.get(f"/api/scene?program={wrong}")
            assert (refused.status, bool(refused.told["help"])) == (400, True), wrong
        assert (await otto.get(f"/api/scene?program={number + 1}")).status == 409
        # Nothing is stored for a session that has ended.
        kept = place.service.program_scenes
        assert (len(kept._kept), len(kept._loads)) == (1, 1)
        place.service.accounts.sessions.end(otto.session)
        assert (len(kept._kept), len(kept._loads)) == (0, 0)

    scene(monkeypatch, tmp_path, work)


def test_a_coordinator_in_another_process_has_the_same_program(tmp_path):
    """A program that a coordinator in another process has loaded is compiled again here. If its text has
    changed, it is refused, so that it isn't shown as the proved program.
    """
    from yarclang.coordinator.course import course_described
    from yarclang.coordinator.loading import Source, load
    from yarclang.coordinator.messages.orders import Load
    from yarclang.pendant.scene.programs import _again
    from yarclang.runtime.actions import Trouble

    robot, file = load_robot("INDUSTRIAL6").value, tmp_path / "p.yarc"
    file.write_text("ROBOT INDUSTRIAL6\nP0010 MOVEJ 5 0 0 0 0 0 [2] (deg,s)\n")
    here = load(Source(str(file)), robot).value
    course, order = course_described(here, 2), Load(file=str(file))
    assert _again(robot, order, course, None).program.source == here.program.source
    file.write_text(file.read_text().replace("MOVEJ 5", "MOVEJ 6"))
    with pytest.raises(Trouble, match="has changed since it was loaded"):
        _again(robot, order, course, None)
