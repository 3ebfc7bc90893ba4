"""Tests of the robot's scene in a run's log. Another library reads the messages, and they fit Foxglove's
schemas. No viewer opens them here.
"""

import base64
import dataclasses
import json

import numpy as np
import pytest
from mcap.reader import make_reader
from report.runs.made_up_runs import ANCHOR, made, whole

from tests.robot.made_arms import DATA, REAL
from tests.robot.made_arms import made as made_arm
from yarclang.collision.placing import place
from yarclang.collision.scene import scene_of
from yarclang.report.runs.log import read_run
from yarclang.report.runs.records import read_records
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.runtime import log_scene
from yarclang.runtime.log import RunLog
from yarclang.runtime.log_scene import EACH, LoggedScene, scene_schemas
from yarclang.runtime.sample import Sample
from yarclang.transforms import quaternion_rotation

# Fields of the schemas that Foxglove publishes (foxglove/schemas, jsonschema).
TRANSFORM = {"timestamp", "parent_frame_id", "child_frame_id", "translation", "rotation"}
ENTITY = {
    *("timestamp", "frame_id", "id", "lifetime", "frame_locked", "metadata", "arrows", "cubes"),
    *("spheres", "cylinders", "lines", "triangles", "texts", "models"),
}
PRIMITIVES = {
    "cubes": {"pose", "size", "color"},
    "spheres": {"pose", "size", "color"},
    "cylinders": {"pose", "size", "color", "bottom_scale", "top_scale"},
    "models": {"pose", "scale", "color", "override_color", "url", "media_type", "data"},
}


def fits(value, schema, path="$"):
    """Check a value against a JSON schema: types, limits, and exactly the fields of the schema."""
    match schema["type"]:
        case "object":
            assert isinstance(value, dict), path
            assert set(value) == set(schema["properties"]), path
            for name, one in value.items():
                fits(one, schema["properties"][name], f"{path}.{name}")
        case "array":
            assert isinstance(value, list), path
            for number, one in enumerate(value):
                fits(one, schema["items"], f"{path}[{number}]")
        case "number":
            assert type(value) in (int, float), path
            assert np.isfinite(value), path
        case "integer":
            assert type(value) is int, path
            assert schema.get("minimum", value) <= value <= schema.get("maximum", value), path
        case "string":
            assert type(value) is str, path
        case "boolean":
            assert type(value) is bool, path
        case other:
            raise AssertionError(other)


def pose_of(said):
    pose = np.eye(4)
    pose[:3, :3] = quaternion_rotation(np.array([said["orientation"][one] for one in "xyzw"]))
    pose[:3, 3] = [said["position"][one] for one in "xyz"]
    return pose


def placed(message):
    """Return base_from_frame of all frames in a message. Check that each frame comes once, after
    its parent.
    """
    found = {"B": np.eye(4)}
    for one in message["transforms"]:
        assert one["child_frame_id"] not in found
        step = pose_of({"position": one["translation"], "orientation": one["rotation"]})
        found[one["child_frame_id"]] = found[one["parent_frame_id"]] @ step
    return found


@pytest.fixture(scope="module")
def read(tmp_path_factory):
    """Fixture: the messages of a run's log by topic, as read by another library, with the names and schemas
    of the topics.
    """
    path, _ = whole(tmp_path_factory.mktemp("run") / "a.mcap", *made())
    found, schemas = {}, {}
    with path.open("rb") as stream:
        for schema, channel, message in make_reader(stream, validate_crcs=True).iter_messages():
            found.setdefault(channel.topic, []).append((message.log_time, json.loads(message.data)))
            schemas[channel.topic] = (
                schema.name,
                schema.encoding,
                channel.message_encoding,
                json.loads(schema.data),
            )
    return path, found, schemas


def test_the_names_and_forms_are_those_of_foxglove(read):
    _, found, schemas = read
    assert schemas["/transforms"][:3] == ("foxglove.FrameTransforms", "jsonschema", "json")
    assert schemas["/robot"][:3] == ("foxglove.SceneUpdate", "jsonschema", "json")
    for topic in ("/transforms", "/robot"):
        for _, message in found[topic]:
            fits(message, schemas[topic][3])
    for _, message in found["/transforms"]:
        assert set(message) == {"transforms"}
        assert all(set(one) == TRANSFORM for one in message["transforms"])
    ((_, message),) = found["/robot"]
    assert set(message) == {"deletions", "entities"}
    for entity in message["entities"]:
        assert set(entity) == ENTITY
        for kind, fields in PRIMITIVES.items():
            assert all(set(one) == fields for one in entity[kind])


def test_frames_follow_the_positions(read):
    _, found, _ = read
    robot = made()[0].robot
    positions = dict(found["/positions"])
    moments = found["/transforms"]
    assert len(moments) > 20
    assert moments[0][0] == found["/positions"][0][0]
    for wall, message in moments:
        q = np.deg2rad([positions[wall]["actual_joints"][f"{name}_deg"] for name in robot.joint_names])
        frames = placed(message)
        flange = flange_poses(robot.chain, q[None])[0]
        assert frames["FLANGE"] == pytest.approx(flange, abs=3e-6)
        assert frames["TCP"] == pytest.approx(flange @ robot.flange_from_frame["TCP"], abs=3e-6)
        stamp = message["transforms"][0]["timestamp"]
        assert stamp["sec"] * 10**9 + stamp["nsec"] == wall
    gaps = np.diff([wall for wall, _ in moments]) / 1e9
    assert gaps.min() >= EACH - 1e-6


@pytest.mark.parametrize("name", ["INDUSTRIAL6", "panda", "ur5-gripper", "two-dofs"])
def test_bodies_are_where_the_collision_check_has_them(name, tmp_path):
    robot = made()[0].robot if name == "INDUSTRIAL6" else made_arm(DATA / REAL[name][0], tmp_path / name)
    shown = LoggedScene(robot)
    message = shown.bodies(0)
    fits(message, scene_schemas()[log_scene.BODIES][1])
    q = robot.home + np.linspace(0.1, 0.4, robot.size)
    frames = placed(shown.transforms(0, q))
    own = [
        (one.link, placed_at)
        for one in robot.shapes
        for placed_at in [one.base_from_shape]
        if type(one.shape).__name__ in ("Box", "Sphere", "Cylinder")
    ]
    scene = scene_of(robot, None).value
    turn, shift = place(scene, q[None]).turn[:, 0], place(scene, q[None]).shift[:, 0]
    joints = {one.link: one.joint for one in robot.shapes}
    wanted = sorted(
        tuple(np.round(turn[joints[link]] @ at[:3, 3] + shift[joints[link]], 4)) for link, at in own
    )
    told = []
    for entity in message["entities"]:
        if entity["id"].split(" (")[0] not in joints:
            continue
        capsules = {id(one) for one in entity["cylinders"]} if len(entity["spheres"]) >= 2 else set()
        for kind in ("cubes", "spheres", "cylinders"):
            for one in entity[kind]:
                if kind == "spheres" and capsules:
                    continue
                told.append(tuple((frames[entity["frame_id"]] @ pose_of(one["pose"]))[:3, 3]))
    for place_ in wanted:
        assert any(np.linalg.norm(np.subtract(place_, one)) < 3e-4 for one in told), (name, place_)


def test_a_mesh_is_in_the_log_unless_it_is_large_or_has_changed(tmp_path, monkeypatch):
    robot = made_arm(DATA / REAL["panda"][0], tmp_path / "panda")
    models = [one for entity in LoggedScene(robot).bodies(0)["entities"] for one in entity["models"]]
    meshes = [one.shape for one in robot.shapes if hasattr(one.shape, "digest")]
    assert meshes
    readable = [one for one in meshes if one.path.suffix.lower() in (".stl", ".obj")]
    assert len(models) == len(readable) > 0
    assert {base64.b64decode(one["data"]) for one in models} == {one.path.read_bytes() for one in readable}
    changed = dataclasses.replace(
        robot,
        shapes=tuple(
            dataclasses.replace(one, shape=dataclasses.replace(one.shape, digest="0" * 64))
            if hasattr(one.shape, "digest")
            else one
            for one in robot.shapes
        ),
    )
    assert not any(entity["models"] for entity in LoggedScene(changed).bodies(0)["entities"])
    monkeypatch.setattr(log_scene, "_LARGEST_MESH", 100)
    assert not any(entity["models"] for entity in LoggedScene(robot).bodies(0)["entities"])


def test_all_meshes_together_are_bounded(tmp_path, monkeypatch):
    robot = made_arm(DATA / REAL["panda"][0], tmp_path / "panda")
    monkeypatch.setattr(log_scene, "_LARGEST_MESHES", 200_000)
    models = [one for entity in LoggedScene(robot).bodies(0)["entities"] for one in entity["models"]]
    assert sum(len(base64.b64decode(one["data"])) for one in models) <= 200_000


def test_names_of_joints_don_t_hide_other_frames():
    robot = made()[0].robot
    twisted = dataclasses.replace(robot, joint_names=("B", "TCP", "FLANGE", *robot.joint_names[3:]))
    frames = placed(LoggedScene(twisted).transforms(0, robot.home))
    assert frames["FLANGE"] == pytest.approx(flange_poses(robot.chain, robot.home[None])[0], abs=3e-6)
    assert "TCP (joint)" in frames


def test_our_own_reader_leaves_them_out(read):
    path, found, _ = read
    topics = {topic for topic, _ in read_records(path.read_bytes()).messages}
    assert topics == {one[1:] for one in found} - {"transforms", "robot"}
    run = read_run(str(path))
    assert run.diagnostics == ()
    assert run.value.unread == 0


def test_a_sample_that_is_no_number_makes_no_frame(tmp_path):
    job = made()[0]
    log = RunLog.open(tmp_path / "a.mcap", job, "10.0.0.1:1025", version="1.2.3", anchor=ANCHOR)
    n = job.robot.size
    log.take(Sample(ANCHOR.clock + 1.0, 0.5, np.full(n, np.nan), np.zeros(n)))
    log.take(Sample(ANCHOR.clock + 2.0, 1.5, np.zeros(n), np.zeros(n)))
    log.close()
    assert log.problem == ""
    with log.path.open("rb") as stream:
        topics = [channel.topic for _, channel, _ in make_reader(stream).iter_messages()]
    assert topics.count("/transforms") == 1
    assert topics.count("/positions") == 2
