"""Tests of tools and frames: places of their declarations, effects of a payload on torques (compared with
Pinocchio), and changes of robot.toml.
"""

import json

import numpy as np
import pinocchio as pin
import pytest
from coordinator.virtual import run
from hypothesis import given, settings
from hypothesis import strategies as st
from pendant.at_robot import pendant

from tests.collision.test_bodies import changed
from tests.robot.heavy_chains import heavy
from tests.robot.test_dynamics import heavy_industrial6
from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.messages.tools import Payload
from yarclang.pendant.payloads import proposed, robot_file, with_payload
from yarclang.pendant.project.folder import ProjectFolder
from yarclang.robot.description import load_robot
from yarclang.robot.dynamics import holding_torques
from yarclang.robot.payload import worst_holding
from yarclang.runtime.actions import Trouble
from yarclang.transforms import rpy_rotation

TOOL = '[tools.Gripper]  # two fingers\nframe = "TCP"\nmass = 1.80  # weighed\n\n'


def described(tmp_path, tool=TOOL):
    """Return the description of a robot with masses and a tool, in a project."""
    heavy_industrial6(tmp_path)
    return changed(tmp_path, ("gravity = [0, 9.81, 0]", ""), ("[positions]", f"{tool}[positions]"))


def project_of(tmp_path):
    return ProjectFolder(tmp_path, tmp_path / "data" / "pendant.db")


def at(monkeypatch, tmp_path, work, **options):
    async def whole():
        async with pendant(monkeypatch, tmp_path, **options) as place:
            await work(place)

    run(whole())


# torques


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 7))
def test_no_pose_within_the_limits_is_worse_than_the_worst(seed, size):
    arm = heavy(seed, size)
    random = np.random.default_rng(seed)
    lower, upper = -random.uniform(0.1, 3.0, size), random.uniform(0.1, 3.0, size)
    worst = worst_holding(arm.chain, arm.dynamics, lower, upper)
    assert ((worst.q >= lower - 1e-12) & (worst.q <= upper + 1e-12)).all()
    # At each reported pose, Pinocchio computes the reported torque.
    theirs = arm.rnea(worst.q, np.zeros((size, size)), np.zeros((size, size)))
    assert np.diag(theirs) == pytest.approx(worst.torque, abs=1e-9 * (1.0 + np.abs(theirs).max()))
    tried = random.uniform(lower, upper, (3000, size))
    seen = np.abs(holding_torques(arm.chain, arm.dynamics, tried)).max(axis=0)
    assert (np.abs(worst.torque) >= seen - 1e-6).all()


def test_payloads_are_pinocchios(tmp_path):
    """Holding torques, at the present and at the worst poses, equal Pinocchio's. The payload is written into
    robot.toml and read back; in Pinocchio it is appended as a body.
    """
    robot = load_robot(described(tmp_path)).value
    project = project_of(tmp_path)
    plain = pin.buildModelFromUrdf(str(robot.folder / robot.urdf))
    flange = plain.frames[plain.getFrameId("flange", pin.FrameType.BODY)]
    frame = robot.flange_from_frame["TCP"]
    turn = frame[:3, :3]

    @settings(max_examples=15, deadline=None)
    @given(
        st.floats(0.0, 900.0, allow_subnormal=False),
        st.tuples(*[st.floats(-800.0, 800.0).map(lambda value: round(value, 3))] * 3),
        st.integers(0, 2**32 - 1),
        st.booleans(),
    )
    def check(mass, center, seed, with_inertia):
        random = np.random.default_rng(seed)
        edges = random.uniform(0.05, 0.4, 3)
        box = mass / 12.0 * (np.sum(edges**2) - edges**2)
        axes = rpy_rotation(random.uniform(-3, 3, 3))
        tensor = axes @ np.diag(box) @ axes.T
        parts = [tensor[at] for at in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
        here = random.uniform(robot.limits.lower, robot.limits.upper)
        payload = Payload(
            tool="GRIPPER",
            mass=mass,
            center_mm=center,
            inertia=tuple(parts) if with_inertia and mass else None,
        )
        told = proposed(robot, project, payload, here, None)
        assert told.sound, told.findings
        model = pin.buildModelFromUrdf(str(robot.folder / robot.urdf))
        model.appendBodyToJoint(
            flange.parentJoint,
            pin.Inertia(mass, turn @ (np.array(center) * 1e-3) + frame[:3, 3], np.zeros((3, 3))),
            flange.placement,
        )
        data = model.createData()
        one = next(found for found in told.torques if found.what == "here")
        theirs = pin.computeGeneralizedGravity(model, data, here)
        assert one.then == pytest.approx(theirs, abs=1e-5)
        reach = next(found for found in told.torques if found.what == "reach")
        for joint, (torque, q) in enumerate(zip(reach.then, reach.at, strict=True)):
            there = pin.computeGeneralizedGravity(model, data, np.array(q) * robot.axis_units)
            assert there[joint] == pytest.approx(torque, rel=1e-3, abs=0.02)

    check()


# robot.toml


def test_a_payload_leaves_all_else_to_the_byte(tmp_path):
    folder = described(tmp_path)
    file = tmp_path / "arm" / "robot.toml"
    file.write_bytes(file.read_bytes().replace(b"\n", b"\r\n"))
    robot, project = load_robot(folder).value, project_of(tmp_path)
    found = robot_file(robot, project)
    assert (found.file, found.why_not) == ("arm/robot.toml", "")
    before = found.text
    assert with_payload(found, Payload(tool="gripper", mass=1.8)) == before
    after = with_payload(found, Payload(tool="GRIPPER", mass=2.25, center_mm=(0, 20.5, 0)))
    wanted = before.replace(
        "mass = 1.80  # weighed\r\n", "mass = 2.25  # weighed\r\ncenter_of_mass = [0, 20.5, 0]\r\n"
    )
    assert after == wanted
    # Without a mass, the center of mass is removed as well, and the result can be loaded.
    file.write_text(after, newline="")
    empty = with_payload(robot_file(robot, project), Payload(tool="GRIPPER", mass=0.0))
    assert "center_of_mass" not in empty
    file.write_text(empty, newline="")
    assert load_robot(folder).value.tools[0].mass == 0.0
    # A new tool is written at the end, if its frame is on the flange.
    added = with_payload(robot_file(robot, project), Payload(tool="cup", frame="flange", mass=1.0))
    assert (
        added == empty + '\r\n[tools.CUP]\r\nframe = "FLANGE"\r\nmass = 1\r\ncenter_of_mass = [0, 0, 0]\r\n'
    )
    with pytest.raises(Trouble, match="has no tool CUP"):
        with_payload(robot_file(robot, project), Payload(tool="CUP", mass=1.0))
    lost = proposed(robot, project, Payload(tool="CUP", frame="NOWHERE", mass=1.0), robot.home, None)
    assert (lost.sound, lost.findings[0].code, lost.torques) == (False, "Y1329", ())
    no_body = Payload(tool="GRIPPER", mass=1.0, inertia=(1.0, 0.1, 0.1, 0.0, 0.0, 0.0))
    assert proposed(robot, project, no_body, robot.home, None).findings[0].code == "Y0932"


def test_forms_that_a_small_change_cannot_reach(tmp_path):
    robot = load_robot(described(tmp_path, "")).value
    file = tmp_path / "arm" / "robot.toml"
    payload = Payload(tool="GRIPPER", frame="TCP", mass=2.5)
    for text in ("tools = { GRIPPER = { mass = 1 } }\n", "tools.GRIPPER.mass = 1\n"):
        file.write_text(text)
        assert "mass = 2.5" in with_payload(robot_file(robot, project_of(tmp_path)), payload)
    for text in ("tools = 3\n", "tools = { CUP = { mass = 1 } }\n", "tools = [[1]]\n"):
        file.write_text(text)
        with pytest.raises(Trouble, match="by the pendant") as refused:
            with_payload(robot_file(robot, project_of(tmp_path)), payload)
        assert "by hand" in refused.value.remedy
    file.write_text("= nothing")
    with pytest.raises(Trouble, match="can't be read"):
        with_payload(robot_file(robot, project_of(tmp_path)), Payload(tool="GRIPPER", mass=2.5))


# the API

PROGRAM = "P0010 MOVEJ 20 0 -60 0 30 0 [2] (deg,s)\nP0020 MOVEJ HOME [2] (deg,s)\n"


def test_a_payload_is_shown_and_written(monkeypatch, tmp_path):
    folder = described(tmp_path)
    (tmp_path / "bend.yarc").write_text(PROGRAM)

    async def work(place):
        anna, bea = place.logged_in("anna"), place.logged_in("bea", Role.PROGRAMMER)
        cyn = place.logged_in("cyn", Role.OPERATOR)
        told = (await cyn.get("/api/tools")).told
        origins = {one["name"]: one["origin"] for one in told["frames"]}
        assert origins == {"{B}": "urdf", "{FLANGE}": "urdf", "{TCP}": "robot.toml"}
        assert (told["file"], told["why_not"], told["restart"], told["checked"]) == (
            "arm/robot.toml",
            "",
            False,
            True,
        )
        assert [(one["name"], one["mass"]) for one in told["tools"]] == [("Gripper", 1.8)]
        number = (await bea.order("load", file="bend.yarc")).told["program"]["number"]
        entered = {"tool": "GRIPPER", "mass": 80.0, "center_mm": [0, 100, 0], "program": number}
        assert (await cyn.post("/api/tools/payload", entered)).status == 403
        shown = (await bea.post("/api/tools/payload", entered)).told
        assert shown["sound"]
        here, reach, program = shown["torques"]
        assert [one["what"] for one in (here, reach, program)] == ["here", "reach", "program"]
        assert abs(reach["now"][1]) + 100.0 < abs(reach["then"][1])
        assert abs(here["then"][1]) <= abs(reach["then"][1])
        assert abs(program["now"][1]) < abs(program["then"][1])
        assert set(program["where"]) <= {"P0010", "P0020"}
        save = {**entered, "known": shown["known"]}
        assert (await bea.post("/api/tools/payload/save", save)).status == 403
        refused = await anna.post("/api/tools/payload/save", save)
        assert (refused.status, refused.told["code"]) == (403, "pin")
        anna.session.pin_until = float("inf")
        # Change the file on the disk, then restore it.
        file = tmp_path / "arm" / "robot.toml"
        text = file.read_text()
        file.write_text(text + "# later\n")
        refused = await anna.post("/api/tools/payload/save", save)
        assert (refused.status, refused.told["code"]) == (409, "changed")
        file.write_text(text)
        made = await anna.post("/api/tools/payload/save", save)
        assert (made.status, made.told["restart"]) == (200, True)
        assert file.read_text() == shown["after"]
        kept = (await anna.get("/api/trash")).told["deleted"]
        assert [one["file"] for one in kept] == ["arm/robot.toml"]
        assert (await cyn.get("/api/tools")).told["restart"]
        # A program is refused, because its proof with the changed description wouldn't be valid for the
        # running robot.
        loaded = (await bea.order("load", file="bend.yarc")).told
        assert loaded["program"] is None
        assert [one["code"] for one in loaded["findings"]] == ["Y1392"]
        assert "has changed since the robot was served" in loaded["findings"][0]["message"]
        deeds = [
            (user, json.loads(detail)["what"])
            for user, action, detail, _ in place.deeds()
            if action == "file change"
        ]
        assert deeds == [("anna", "mass of tool GRIPPER: 80 kg")]
        # Values that can't be a mass are refused.
        bad = (1e6, -1.0, "NaN", "1e400", None, "heavy", True, [1])
        for mass in bad:
            assert (await bea.post("/api/tools/payload", {**entered, "mass": mass})).status == 400, mass
        assert (await bea.post("/api/tools/payload", raw=b'{"tool": "GRIPPER", "mass": NaN}')).status == 400
        for wrong in (
            {"center_mm": [0, 0, 10_001]},
            {"center_mm": [0, 0]},
            {"tool": "a]\nname = 'X'"},
            {"tool": ""},
            {"inertia": [1]},
            {"program": -1},
        ):
            assert (await bea.post("/api/tools/payload", {**entered, **wrong})).status == 400, wrong
        assert (await bea.post("/api/tools/payload", {**entered, "program": 999})).status == 409

    at(monkeypatch, tmp_path, work, robot=folder)


def test_a_robot_of_the_library_is_shown_and_left_alone(monkeypatch, tmp_path):
    async def work(place):
        anna = place.logged_in("anna")
        anna.session.pin_until = float("inf")
        told = (await anna.get("/api/tools")).told
        assert told["tools"] == []
        assert "copy that folder into the project" in told["why_not"]
        assert told["without_mass"] == ["J1", "J2", "J3", "J4", "J5", "J6"]
        assert not told["checked"]
        entered = {"tool": "CUP", "frame": "TCP", "mass": 5}
        shown = (await anna.post("/api/tools/payload", entered)).told
        assert shown["after"].endswith('[tools.CUP]\nframe = "TCP"\nmass = 5\ncenter_of_mass = [0, 0, 0]\n')
        here = next(one for one in shown["torques"] if one["what"] == "here")
        assert here["now"] == [0] * 6
        assert max(map(abs, here["then"])) > 10.0  # only the torque of the tool
        refused = await anna.post("/api/tools/payload/save", {**entered, "known": shown["known"]})
        assert (refused.status, refused.told["code"]) == (409, "outside")

    at(monkeypatch, tmp_path, work)


def test_where_frames_come_from(monkeypatch, tmp_path):
    (tmp_path / "cell.toml").write_text(
        'units = "mm,deg,s"\n'
        "[frames.TABLE]\n"
        'parent = "B"\n'
        "xyz = [100, 0, 0]\n"
        "[frames.CUP]\n"
        'parent = "FLANGE"\n'
        "xyz = [0, 0, 9]\n"
    )

    async def work(place):
        bea = place.logged_in("bea", Role.PROGRAMMER)
        await bea.post("/api/control")
        lines = ['CELL "cell.toml"', "FRAME {HERE} 1 2 3 0 0 0 (mm,deg) {B}"]
        made = (await bea.order("adopt", declarations=lines)).told
        assert made["holds"], made
        told = (await bea.get("/api/tools")).told
        origins = {one["name"]: (one["origin"], one["on_flange"]) for one in told["frames"]}
        assert origins["{TABLE}"] == ("cell.toml", False)
        assert origins["{CUP}"] == ("cell.toml", True)
        assert origins["{HERE}"] == ("session", False)

    at(monkeypatch, tmp_path, work)
