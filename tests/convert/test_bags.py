"""Tests of converting bags of ROS 1 and ROS 2, written by rosbags; without rosbags, there is a finding."""

import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from programs import codes, robot_of
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from tests.convert.conversions import commands, timetables
from yarclang.cli.yarc import main
from yarclang.convert.bag import is_bag
from yarclang.convert.convert import convert_bag
from yarclang.convert.course import Wishes

JOINTS = [f"J{number}" for number in range(1, 7)]
GOAL = "control_msgs/msg/FollowJointTrajectoryGoal"
NOETIC, JAZZY = get_typestore(Stores.ROS1_NOETIC), get_typestore(Stores.ROS2_JAZZY)
for _store in (NOETIC, JAZZY):
    _store.register(get_types_from_msg("trajectory_msgs/JointTrajectory trajectory\n", GOAL))
KINDS = ["bag", "sqlite3", "mcap"]


def header(store, stamp=0.0):
    types = store.types
    time = types["builtin_interfaces/msg/Time"](sec=int(stamp), nanosec=round(stamp % 1 * 1e9))
    extra = {"seq": 0} if store is NOETIC else {}
    return types["std_msgs/msg/Header"](stamp=time, frame_id="", **extra)


def trajectory(store, times, positions, velocities=None, names=JOINTS):
    types = store.types
    nothing = np.empty(0)
    points = []
    for number, (time, q) in enumerate(zip(times, positions, strict=True)):
        duration = types["builtin_interfaces/msg/Duration"](sec=int(time), nanosec=round(time % 1 * 1e9))
        rates = nothing if velocities is None else np.array(velocities[number], dtype=float)
        points.append(
            types["trajectory_msgs/msg/JointTrajectoryPoint"](
                positions=np.array(q, dtype=float), velocities=rates, accelerations=nothing, effort=nothing,
                time_from_start=duration,
            )
        )  # fmt: skip
    kind = types["trajectory_msgs/msg/JointTrajectory"]
    return kind(header=header(store), joint_names=list(names), points=points)


def state(store, stamp, q, velocity=None):
    rates = np.empty(0) if velocity is None else np.array(velocity, dtype=float)
    return store.types["sensor_msgs/msg/JointState"](
        header=header(store, stamp), name=JOINTS, position=np.array(q, dtype=float), velocity=rates,
        effort=np.empty(0),
    )  # fmt: skip


def written(folder, kind, messages):
    """Write a bag with (topic, seconds, message) in order; return its path."""
    if kind == "bag":
        path, store = folder / "arm.bag", NOETIC
        writer = Writer1(path)
    else:
        path, store = folder / "arm", JAZZY
        writer = Writer2(path, version=9, storage_plugin=StoragePlugin[kind.upper()])
    with writer:
        known = {}
        for topic, seconds, make in messages:
            message = make(store)
            name = message.__msgtype__
            if topic not in known:
                known[topic] = writer.add_connection(topic, name, typestore=store)
            encode = store.serialize_ros1 if kind == "bag" else store.serialize_cdr
            writer.write(known[topic], int(seconds * 1e9), encode(message, name))
    return path


def plan(times, positions, velocities=None, names=JOINTS):
    return lambda store: trajectory(store, times, positions, velocities, names)


def turned(*angles):
    return [[np.radians(angle), 0, 0, 0, 0, 0] for angle in angles]


def imported(path, **wishes):
    result = convert_bag(path, robot_of("INDUSTRIAL6"), Wishes(beside="arm", **wishes))
    return result.value, result.diagnostics


@pytest.mark.parametrize("kind", KINDS)
def test_trajectories_keep_their_times(tmp_path, kind):
    names = JOINTS[::-1]
    first = plan([0, 1.25, 2.000000001], [one[::-1] for one in turned(0, 10, 20)], names=names)
    velocities = [[0] * 6, [0.1, 0, 0, 0, 0, 0], [0] * 6]
    second = plan([0, 1, 3], turned(20, 30, 35), velocities)
    path = written(tmp_path, kind, [("/plan", 1, first), ("/plan", 9, second)])
    made, found = imported(path)
    assert codes(found) == []
    assert commands(made.text) == ["MOVEJ", "MOVEJ_TIMED", "MOVEJ_TIMED"]
    (times, q, none, _), (later, _, rates, _) = timetables(made)
    assert times.tolist() == [1.25, 2.000000001]
    assert np.degrees(q[:, 0]) == pytest.approx([10, 20])
    assert none is None
    assert later.tolist() == [1, 3]
    assert rates[:, 0] == pytest.approx([0.1, 0], abs=1e-8)


@pytest.mark.parametrize("kind", KINDS)
def test_messages_around_trajectories_and_other_topics(tmp_path, kind):
    inner = plan([0, 1, 2], turned(0, 10, 20))
    goal = lambda store: store.types[GOAL](trajectory=inner(store))  # noqa: E731
    noise = lambda store: state(store, 5.0, [0] * 6)  # noqa: E731
    path = written(tmp_path, kind, [("/joint_states", 1, noise), ("/goal", 2, goal)])
    made, found = imported(path)
    assert codes(found) == []
    assert commands(made.text) == ["MOVEJ", "MOVEJ_TIMED"]


@pytest.mark.parametrize("kind", KINDS)
def test_a_recording_of_joint_states(tmp_path, kind):
    stamps = [100.0, 100.5, 100.5, 101.25]
    messages = [
        ("/joint_states", stamp, lambda store, stamp=stamp, q=q: state(store, stamp, q, [0] * 6))
        for stamp, q in zip(stamps, turned(0, 5, 5, 9), strict=True)
    ]
    path = written(tmp_path, kind, messages)
    found = imported(path)[1]
    assert (codes(found), "/joint_states (sensor_msgs/msg/JointState)" in found[0].help) == (["Y1515"], True)
    made, found = imported(path, topic="/joint_states")
    assert codes(found) == []
    ((times, *_),) = timetables(made)
    assert times.tolist() == [0.5, 1.25]


def test_one_topic_of_several(tmp_path):
    one, other = plan([0, 1, 2], turned(0, 1, 2)), plan([0, 1, 3], turned(0, 5, 9))
    path = written(tmp_path, "bag", [("/a", 1, one), ("/b", 2, other)])
    assert len(timetables(imported(path)[0])) == 2
    ((times, *_),) = timetables(imported(path, topic="/b")[0])
    assert times.tolist() == [1, 3]
    made, found = imported(path, topic="/c")
    assert made is None
    assert (codes(found), "no topic /c" in found[0].message) == (["Y1515"], True)


def test_other_joints_of_a_bag(tmp_path):
    path = written(tmp_path, "bag", [("/plan", 1, plan([0, 1], turned(0, 1), names=[*JOINTS[:5], "wrist"]))])
    assert codes(imported(path)[1]) == ["Y1511"]
    made, found = imported(path, joints=(*JOINTS[:5], "wrist"))
    assert (codes(found), commands(made.text)) == ([], ["MOVEJ", "MOVEJ"])


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("share", [0.0, 0.3, 0.9])
def test_damaged_bags(tmp_path, kind, share):
    path = written(tmp_path, kind, [("/plan", 1, plan([0, 1, 2], turned(0, 1, 2)))])
    file = path if kind == "bag" else next(one for one in path.iterdir() if one.suffix in {".db3", ".mcap"})
    content = file.read_bytes()
    file.write_bytes(content[: int(share * len(content))])
    made, found = imported(path)
    if made is None:
        assert [one.is_error for one in found] == [True]
        assert codes(found) == ["Y1515"]
    else:  # sqlite reads a file in which only unused pages are missing
        assert commands(made.text) == ["MOVEJ", "MOVEJ_TIMED"]


@pytest.mark.parametrize("kind", KINDS)
def test_any_byte_may_be_wrong(tmp_path, kind):
    path = written(tmp_path, kind, [("/plan", 1, plan([0, 1, 2], turned(0, 1, 2)))])
    file = path if kind == "bag" else next(one for one in path.iterdir() if one.suffix in {".db3", ".mcap"})
    content = file.read_bytes()
    random = np.random.default_rng(1)
    for _ in range(25):
        wrong = bytearray(content)
        wrong[random.integers(len(wrong))] ^= 1 << random.integers(8)
        file.write_bytes(wrong)
        made, found = imported(path)
        assert (made is None) == any(one.is_error for one in found)


def test_the_command_reads_bags(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    written(tmp_path, "bag", [("/plan", 1, plan([0, 1, 3], turned(0, 10, 20)))])
    written(tmp_path, "mcap", [("/plan", 1, plan([0, 1, 3], turned(0, 10, 20)))])
    inside = next(Path("arm").glob("*.mcap"))
    for file in ("arm.bag", "arm", str(inside)):
        assert is_bag(Path(file))
        made = CliRunner().invoke(main, ["import", file, "--robot", "INDUSTRIAL6", "-o", "out.yarc"])
        assert (made.exit_code, made.stdout) == (0, "written to out.yarc; plan it with yarc check\n")
        assert "MOVEJ_TIMED" in Path("out.yarc").read_text()
    made = CliRunner().invoke(main, ["import", "none.bag", "--robot", "INDUSTRIAL6"])
    assert (made.exit_code, "none.bag can't be read: no such file" in made.stderr) == (1, True)


def test_without_the_package(tmp_path, monkeypatch):
    path = written(tmp_path, "bag", [("/plan", 1, plan([0, 1], turned(0, 1)))])
    for name in [one for one in sys.modules if one.split(".")[0] == "rosbags"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "rosbags", None)
    made, found = imported(path)
    assert made is None
    assert (codes(found), "pip install 'yarclang[bags]'" in found[0].help) == (["Y1515"], True)
