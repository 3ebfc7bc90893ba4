"""Tests of calibration through the API: touches at the robot's position, display and writing of results,
rights, and refusals.
"""

import asyncio
import shutil
import tomllib

import numpy as np
import pytest
from coordinator.virtual import run
from pendant.at_robot import pendant
from pendant.test_jogging import pressed, trial
from scipy.spatial.transform import Rotation

from yarclang.pendant.accounts.roles import Role
from yarclang.robot.description import load_robot
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.robot.kinematics.inverse import branches
from yarclang.simulator.commissioning import stand

TIP = np.array([0.02, 0.13, 0.21])
POINT = np.array([0.0, 1.1, 1.3])
TILTS = ((0, 0, 0), (30, 0, 0), (-30, 0, 0), (0, 30, 0))
CELL = (
    'units = "mm,deg"  # of all\n'
    "\n"
    "[frames.TABLE]\n"
    'parent = "B"\n'
    "xyz = [0, 900, 800]\n"
    "rpy = [0, 0, 0]\n"
    "\n"
    "[frames.FIXTURE]\n"
    'parent = "TABLE"\n'
    "xyz = [10, 0, 0]\n"
)
POINTS = ((0.0, 1.2, 0.9), (0.2, 1.2, 0.9), (0.0, 1.4, 0.9))


def at(monkeypatch, tmp_path, work, **options):
    async def whole():
        async with pendant(monkeypatch, tmp_path, **options) as place:
            await work(place)

    run(whole())


def put(place, position, turn=(0, 0, 0), tip=(0.0, 0.0, 0.0)):
    """Move the simulated robot so that the tip is at a position [m], with the given roll, pitch and yaw
    [deg].
    """
    robot, pose = place.world.robot, np.eye(4)
    pose[:3, :3] = Rotation.from_euler("xyz", turn, degrees=True).as_matrix()
    pose[:3, 3] = np.array(position) - pose[:3, :3] @ np.array(tip)
    found, there = branches(robot.chain, pose[None])
    inside = (found[0] >= robot.limits.lower) & (found[0] <= robot.limits.upper)
    reached = found[0][there[0] & inside.all(axis=1)]
    q = reached[np.argmin(np.abs(reached).max(axis=1))]
    np.testing.assert_allclose(flange_poses(robot.chain, q[None])[0], pose, atol=1e-9)
    stand(place.world.machine, robot, q)


async def begin(who, kind="tip", **fields):
    named = (
        {"name": "TORCH"}
        if kind == "tip"
        else {"name": "NEST", "tool": "{FLANGE}"}
        if kind == "frame"
        else {}
    )
    return await who.post("/api/calibration", {"calibration": {"kind": kind, **named, **fields}})


async def touch(who, **fields):
    version = (await who.get("/api/calibration")).told["version"]
    return await who.post("/api/calibration/touch", {"version": version, **fields})


async def write(who, to, **fields):
    """Propose a result, then write it. Return both replies."""
    version = (await who.get("/api/calibration")).told["version"]
    asked = {"version": version, "to": to, **fields}
    made = await who.post("/api/calibration/propose", asked)
    if made.status != 200:
        return made, None
    return made, await who.post("/api/calibration/write", {**asked, "known": made.told["known"]})


async def touched_tip(place, who, tilts=TILTS, **fields):
    assert (await begin(who, **fields)).status == 200
    for tilt in tilts:
        put(place, POINT, tilt, TIP)
        told = await touch(who)
        assert told.status == 200, told.content
    return told.told


async def touched_frame(place, who, points=POINTS, **fields):
    assert (await begin(who, "frame", **fields)).status == 200
    for point in points:
        put(place, point)
        told = await touch(who)
        assert told.status == 200, told.content
    return told.told


def with_pin(place, name="anna"):
    who = place.logged_in(name, Role.SERVICE)
    who.session.pin_until = asyncio.get_running_loop().time() + 1e6
    return who


def own_robot(tmp_path, change=lambda text: text):
    ours = load_robot("industrial6").value
    folder = shutil.copytree(ours.folder, tmp_path / "arm")
    file = folder / "robot.toml"
    file.write_bytes(change(file.read_bytes().decode()).encode())
    return folder


def test_a_tip_from_the_first_touch_to_the_file(monkeypatch, tmp_path):
    folder = own_robot(tmp_path)

    async def work(place):
        anna = with_pin(place)
        assert (await anna.get("/api/calibration")).told["kind"] == ""
        assert "pointed object" in (await begin(anna)).told["next"]
        seen = []
        for tilt in TILTS:
            put(place, POINT, tilt, TIP)
            seen.append((await touch(anna)).told)
        assert [one["needed"] for one in seen] == [3, 2, 1, 0]
        assert [one["ready"] for one in seen] == [False] * 3 + [True]
        # After two touches that differ only by a turn about one axis, the tip's coordinate along the axis is
        # unknown. The advice says which turn helps.
        assert seen[1]["spread"][0]["value"] == "not known"
        assert seen[1]["spread"][0]["label"] == "tip along x of {FLANGE}"
        assert "about y" in seen[1]["advice"] or "about z" in seen[1]["advice"]
        assert "TORCH" in seen[3]["result"][0]
        assert "20.000 130.000 210.000" in seen[3]["result"][0]
        assert max(one["residual"] for one in seen[3]["touches"]) < 0.01
        # A touch beside the point is marked as the worst one, and can be replaced.
        put(place, POINT + np.array([0.003, 0, 0]), (0, -30, 0), TIP)
        worse = (await touch(anna)).told
        assert [one["worst"] for one in worse["touches"]].index(True) == 4
        assert worse["findings"][0]["code"] == "Y1904"
        put(place, POINT, (0, -30, 0), TIP)
        assert (await touch(anna, at=4)).told["findings"] == []
        before = (folder / "robot.toml").read_text()
        made, written = await write(anna, "robot")
        assert made.told["file"] == "arm/robot.toml"
        assert made.told["before"] == before
        assert "[frames.TORCH]" in made.told["after"]
        assert "restart" in made.told["then"]
        assert written.status == 200, written.content
        assert (folder / "robot.toml").read_text() == made.told["after"]
        np.testing.assert_allclose(
            load_robot(str(folder)).value.flange_from_frame["TORCH"][:3, 3], TIP, atol=2e-6
        )
        assert [one["file"] for one in (await anna.get("/api/trash")).told["deleted"]] == ["arm/robot.toml"]
        assert any("TORCH" in detail for _, action, detail, _ in place.deeds() if action.endswith("change"))

    at(monkeypatch, tmp_path, work, robot=str(folder))


def test_an_old_tip_keeps_its_orientation_and_is_asked_for(monkeypatch, tmp_path):
    new = (
        "\r\n"
        "[frames.mount]\r\n"
        'parent = "FLANGE"\r\n'
        "xyz = [0, 0, 50]\r\n"
        "rpy = [0, 0, 90]\r\n"
        "\r\n"
        "[frames.torch]\r\n"
        'parent = "mount"\r\n'
        "xyz = [1, 2, 3]\r\n"
        "rpy = [10, 0, 0]\r\n"
    )
    folder = own_robot(tmp_path, lambda text: text.replace("\n", "\r\n") + new)

    async def work(place):
        anna = with_pin(place)
        await touched_tip(place, anna)
        refused, _ = await write(anna, "robot")
        assert (refused.status, refused.told["code"]) == (409, "exists")
        made, written = await write(anna, "robot", replace=True)
        assert written.status == 200
        assert "moves by" in made.told["what"]
        assert "turns by 0.000" in made.told["what"]
        text = (folder / "robot.toml").read_bytes().decode()
        assert text.count("\r\n") == text.count("\n")
        pose = load_robot(str(folder)).value.flange_from_frame["TORCH"]
        np.testing.assert_allclose(pose[:3, 3], TIP, atol=2e-6)

    at(monkeypatch, tmp_path, work, robot=str(folder))


def test_a_robot_of_the_library_is_shown_and_not_written(monkeypatch, tmp_path):
    async def work(place):
        anna = with_pin(place)
        await touched_tip(place, anna, name="TCP")
        made, written = await write(anna, "robot", replace=True)
        assert "isn't in the project" in made.told["obstacle"]
        assert made.told["before"] != made.told["after"]
        assert written.status in (400, 409)
        program = tmp_path / "a.yarc"
        program.write_bytes(b"DEFAULT {TCP} [50%] (mm,deg,s) {B}\r\nP0010 MOVEJ 10 0 0 0 -20 0\r\n")
        assert (await anna.ask("DELETE", "/api/calibration")).status == 200
        await touched_tip(place, anna)
        made, written = await write(anna, "program", file="a.yarc")
        assert written.status == 200, written.content
        assert b"FRAME {TORCH} 20 130 210 0 0 0 {FLANGE}\r\n" in program.read_bytes()
        refused, _ = await write(anna, "program", file="a.yarc")
        assert refused.told["code"] == "exists"
        made, written = await write(anna, "program", file="a.yarc", replace=True)
        assert written.status == 200, written.content

    at(monkeypatch, tmp_path, work)


@pytest.mark.parametrize("form", ["plain", "crlf", "metres", "inline", "own units", "quaternion", "no units"])
def test_a_frame_of_the_cell(monkeypatch, tmp_path, form):
    forms = {
        "plain": CELL,
        "crlf": CELL.replace("\n", "\r\n"),
        "metres": 'units = "m,rad"\n[frames.nest]\nparent = "B"\nxyz = [0, 0.9, 0.8]\nrpy = [0, 0, 0]\n',
        "inline": 'units = "mm,deg"\nframes = { NEST = { parent = "B", xyz = [0, 0, 5] } }\n',
        "own units": (
            'units = "mm,deg"\n'
            "[frames.TABLE]\n"
            'parent = "B"\n'
            "xyz = [0, 900, 800]\n"
            "[frames.NEST]\n"
            'parent = "TABLE"\n'
            'units = "in,rad"\n'
            "xyz = [1, 2, 3]\n"
            "rpy = [0, 0, 1]\n"
        ),
        "quaternion": (
            'units = "mm,deg"\n'
            "[frames.NEST]\n"
            'parent = "B"\n'
            "xyz = [0, 0, 5]\n"
            "quat = [0, 0, 0, 1]  # as measured\n"
        ),
        "no units": '[joints]\n[frames.NEST]\nparent = "B"\n',
    }
    cell = tmp_path / "cell.toml"
    cell.write_bytes(forms[form].encode())
    (tmp_path / "yarc.toml").write_text('cell = "cell.toml"\n')

    async def work(place):
        anna = with_pin(place)
        told = await touched_frame(place, anna)
        assert "a fourth point" in told["result"][0]
        made, written = await write(anna, "cell")
        if form not in ("plain", "crlf"):
            assert made.told["code"] == "exists"
            made, written = await write(anna, "cell", replace=True)
        if form == "inline":
            assert "form" in made.told["code"], made.told
            assert "[frames.NAME]" in made.told["help"]
            assert cell.read_bytes() == forms[form].encode()
            return
        assert written.status == 200, written.content
        text = cell.read_bytes().decode()
        assert text.count("\r\n") == (text.count("\n") if form == "crlf" else 0)
        table = {name.upper(): one for name, one in tomllib.loads(text)["frames"].items()}["NEST"]
        turn = Rotation.from_euler("xyz", table["rpy"], degrees=form not in ("metres", "own units"))
        np.testing.assert_allclose(turn.as_matrix(), np.eye(3), atol=1e-5)
        wanted = {"metres": [0, 1.2, 0.9], "own units": [0, 300 / 25.4, 100 / 25.4]}.get(form, [0, 1200, 900])
        np.testing.assert_allclose(table["xyz"], wanted, atol=1e-4)

    at(monkeypatch, tmp_path, work)


def test_what_hangs_on_a_frame_and_what_is_another_file_by_now(monkeypatch, tmp_path):
    (tmp_path / "cell.toml").write_text(CELL)
    (tmp_path / "yarc.toml").write_text('cell = "cell.toml"\n')

    async def work(place):
        anna = with_pin(place)
        await touched_frame(place, anna, name="table")
        version = (await anna.get("/api/calibration")).told["version"]
        asked = {"version": version, "to": "cell", "replace": True}
        made = (await anna.post("/api/calibration/propose", asked)).told
        assert "{FIXTURE} are attached to it" in made["what"]
        (tmp_path / "cell.toml").write_text(CELL + "# somebody else\n")
        late = await anna.post("/api/calibration/write", {**asked, "known": made["known"]})
        assert (late.status, late.told["code"]) == (409, "changed")
        assert (tmp_path / "cell.toml").read_text() == CELL + "# somebody else\n"
        (tmp_path / "cell.toml").write_text("frames = 5\n[")
        broken, _ = await write(anna, "cell", replace=True)
        assert broken.status == 409
        for text in (
            "frames = 5\n",
            "frames = []\n",
            "units = 5\n",
            "[frames]\nTABLE = 5\n",
            "[frames.TABLE]\nparent = 5\n",
            'units = "mm,bananas"\n',
            "[[frames]]\n",
        ):
            (tmp_path / "cell.toml").write_text(text)
            odd, _ = await write(anna, "cell", replace=True)
            assert odd.status in (200, 409), text
            if odd.status == 409:
                assert (tmp_path / "cell.toml").read_text() == text
        (tmp_path / "cell.toml").unlink()
        assert (await write(anna, "cell"))[0].status == 409

    at(monkeypatch, tmp_path, work)


def test_points_that_say_little_and_points_that_say_nothing(monkeypatch, tmp_path):
    async def work(place):
        anna = place.logged_in("anna", Role.PROGRAMMER)
        near = ((0.0, 1.2, 0.9), (0.02, 1.2, 0.9), (0.0, 1.23, 0.9))
        told = await touched_frame(place, anna, near)
        rows = {one["label"]: one for one in told["spread"]}
        assert rows["turned about z"]["value"] == f"{np.degrees(np.sqrt(2) * 0.5 / 20):.2f} deg"
        assert not rows["turned about z"]["enough"]
        assert "the point on x is only 20 mm from the origin" in told["advice"]
        assert "30 mm beside the x axis" in told["advice"]
        version = told["version"]
        # Only the last touch can be removed: without the origin, the point on x would become the origin.
        assert [one["can_go"] for one in told["touches"]] == [False, False, True]
        for at in (0, 1):
            refused = await anna.post("/api/calibration/remove", {"version": version, "at": at})
            assert (refused.status, refused.told["code"]) == (409, "order")
        told = (await anna.post("/api/calibration/remove", {"version": version, "at": 2})).told
        assert (told["needed"], told["ready"]) == (1, False)
        put(place, (0.1, 1.2, 0.9))
        told = (await touch(anna)).told
        assert not told["ready"]
        assert told["findings"][0]["code"] == "Y1903"
        # A second touch at the same position is refused, because it adds no information.
        same = await touch(anna)
        assert (same.status, same.told["code"]) == (409, "same")
        refused, _ = await write(anna, "program", file="a.yarc")
        assert refused.told["code"] == "result"

    at(monkeypatch, tmp_path, work)


def test_offsets_and_which_motors_have_to_be_referenced(monkeypatch, tmp_path):
    folder = own_robot(tmp_path)

    async def work(place):
        anna = with_pin(place)
        robot = place.world.robot
        assert (await begin(anna, "home", marks={"J2": 0.0})).status == 200
        told = (await touch(anna)).told
        assert "the reading of J2 is off by +0.5000 deg" in told["result"][0]
        assert "approach it again" in told["advice"]
        await touch(anna)
        stand(place.world.machine, robot, np.radians([0, 0.502, 0, 0, 0, 0]))
        told = (await touch(anna)).told
        assert "offset of J2" in told["spread"][0]["label"]
        with monkeypatch.context() as loose:
            unreferenced(loose, place, 2, "closed_loop")
            refused = await touch(anna)
            assert refused.told["error"].startswith("motor 2 is not enabled")
        unreferenced(monkeypatch, place, 1)
        assert (await touch(anna)).status == 200  # motor 1 doesn't move J2
        unreferenced(monkeypatch, place, 2)
        refused = await touch(anna)
        assert refused.told["error"].startswith("motor 2 is not homed")
        made, written = await write(anna, "robot")
        assert "settings" in made.told["then"]
        assert written.status == 200
        offsets = load_robot(str(folder)).value.actuation.offset
        assert np.abs(offsets[1:3]).min() > 1000.0
        # A second result is refused until the restart: it would be computed with the old offsets, and undo
        # the first one.
        await begin(anna, "home", marks={"J1": 1.0}, anew=True)
        monkeypatch.undo()

    at(monkeypatch, tmp_path, work, robot=str(folder), joints=[0, 0.5, 0, 0, 0, 0])


def test_offsets_that_are_not_loaded_yet_are_not_taken_back(monkeypatch, tmp_path):
    folder = own_robot(tmp_path)

    async def work(place):
        anna = with_pin(place)
        for joint, status in (("J2", 200), ("J1", 409)):
            assert (
                await anna.post(
                    "/api/calibration", {"calibration": {"kind": "home", "marks": {joint: 0.1}}, "anew": True}
                )
            ).status == 200
            await touch(anna)
            made, _ = await write(anna, "robot")
            assert made.status == status, made.content
        assert made.told["code"] == "stale"
        assert "restart" in made.told["help"]

    at(monkeypatch, tmp_path, work, robot=str(folder))


def unreferenced(monkeypatch, place, number, bit="homed"):
    kind = type(place.service.watched.attached)
    ask = kind.ask

    async def lost(attached, order):
        told = await ask(attached, order)
        if hasattr(told, "motors"):
            motors = tuple(one.model_copy(update={bit: one.number != number}) for one in told.motors)
            return told.model_copy(update={"motors": motors})
        return told

    monkeypatch.setattr(kind, "ask", lost)


def test_nobody_touches_while_the_robot_moves(monkeypatch, tmp_path):
    async def work(place):
        anna = place.logged_in("anna", Role.PROGRAMMER)
        await begin(anna)
        await anna.post("/api/control")
        offer = (await anna.order("offer", text="MOVEJ 20 0 0 0 0 0 [4] (deg,s)")).told["offer"]
        going = asyncio.ensure_future(anna.order("go", offer=offer["number"]))
        await asyncio.sleep(1.5)
        refused = await touch(anna)
        assert (refused.status, refused.told["code"]) == (409, "moving")
        await going
        await asyncio.sleep(0.1)
        assert (await touch(anna)).status == 200
        unreferenced(monkeypatch, place, 2)
        assert (await touch(anna)).told["code"] == "homed"

    at(monkeypatch, tmp_path, work)


def test_two_pages_of_one_person_and_the_end_of_a_session(monkeypatch, tmp_path):
    async def work(place):
        anna = place.logged_in("anna", Role.PROGRAMMER)
        vera = place.logged_in("vera", Role.VIEWER)
        told = (await begin(anna)).told
        one = {"version": told["version"]}
        both = await asyncio.gather(*(anna.post("/api/calibration/touch", one) for _ in range(2)))
        assert sorted(answer.status for answer in both) == [200, 409]
        assert {answer.told.get("code") for answer in both} == {None, "changed"}
        again = await begin(anna, name="OTHER")
        assert (again.status, again.told["code"]) == (409, "going")
        seen = (await vera.get("/api/calibration")).told
        assert (seen["mine"], seen["by"], len(seen["touches"])) == (False, "anna", 1)
        touching = asyncio.ensure_future(touch(anna))
        await asyncio.sleep(0)
        assert (await anna.post("/api/logout")).status == 200
        assert (await touching).status in (401, 409)
        assert (await anna.get("/api/calibration")).status == 401
        assert (await vera.get("/api/calibration")).told["kind"] == ""

    at(monkeypatch, tmp_path, work)


def test_who_may_and_what_is_forged(monkeypatch, tmp_path):
    (tmp_path / "cell.toml").write_text(CELL)
    (tmp_path / "yarc.toml").write_text('cell = "cell.toml"\n')

    async def work(place):
        paul, vera, olaf = (
            place.logged_in(*one)
            for one in (("paul", Role.PROGRAMMER), ("vera", Role.VIEWER), ("olaf", Role.OPERATOR))
        )
        for who in (vera, olaf):
            assert (await begin(who)).status == 403
            assert (await touch(who)).status == 403
            assert (await who.ask("DELETE", "/api/calibration")).status == 403
        assert (await place.browser().get("/api/calibration")).status == 401
        told = await touched_frame(place, paul)
        made, written = await write(paul, "cell")
        assert made.status == 200
        # a programmer may see the proposal, but only a service user may write it
        assert written.status == 403
        nopin = place.logged_in("sven", Role.SERVICE)
        await touched_frame(place, nopin)
        made, written = await write(nopin, "cell")
        assert (written.status, written.told["code"]) == (403, "pin")
        assert (tmp_path / "cell.toml").read_text() == CELL
        assert (await paul.ask("DELETE", "/api/calibration")).status == 200
        for name in ("", "B", "{TCP}", "FLANGE", "Ärger", "A B", "x" * 61, "]\n[a", "../x", '"'):
            assert (await begin(paul, "frame", name=name)).status == 409, name
        assert (await begin(paul, "frame", name="x" * 81)).status == 400
        assert (await begin(paul, "frame", tool="{B}")).status == 409
        assert (await begin(paul, name="FLANGE")).status == 409
        for marks, status in (
            ({}, 400),
            ({"J9": 0}, 409),
            ({"J1": 1e9}, 409),
            ({"J1": "0"}, 400),
            ({f"J{n}": 0 for n in range(99)}, 400),
        ):
            assert (await begin(paul, "home", marks=marks)).status == status
        assert (await begin(paul)).status == 200
        now = (await paul.get("/api/calibration")).told["version"]
        forged = [
            ({"version": now, "joints": [0] * 6}, 400),
            ({"version": now, "at": -1}, 400),
            ({"version": now, "at": 7}, 409),
            ({"version": now + 1}, 409),
            ({"version": 1e300}, 400),
            ({}, 400),
        ]
        for asked, status in forged:
            assert (await paul.post("/api/calibration/touch", asked)).status == status, asked
        for to, file in (
            ("program", "../a.yarc"),
            ("program", ".hidden.yarc"),
            ("program", "cell.toml"),
            ("program", "x\0.yarc"),
            ("cell", ""),
        ):
            refused, _ = await write(paul, to, file=file)
            assert refused.status == 409, (to, file)
        assert told["mine"]

    at(monkeypatch, tmp_path, work)


def test_looking_at_a_tip_keeps_it_where_it_is(monkeypatch, tmp_path):
    async def work(place, anna, line):
        told = await touched_tip(place, anna)
        robot = place.world.robot

        def tip():
            pose = flange_poses(robot.chain, np.radians(place.world.stands())[None])[0]
            return pose[:3, :3] @ TIP + pose[:3, 3]

        async def goes(press, **asked):
            made = await anna.post("/api/calibration/look", {"version": told["version"], **asked})
            offer = (await anna.order("offer", text=made.told["text"])).told["offer"]
            assert offer is not None
            tips = []
            for _ in range(100):
                heard = await pressed(line, press, {"go": offer["number"]}, 0.2)
                tips.append(tip())
                if any(one.get("state") == "reached" for one in heard):
                    line.say({"release": press})
                    return np.array(tips)
            raise AssertionError("it doesn't arrive")

        back = await goes(1, distance=40.0)
        assert np.linalg.norm(back[-1] - POINT) == pytest.approx(0.04, abs=2e-5)
        tilted = await goes(2, distance=40.0, axis="y", tilt=-20.0)
        assert np.linalg.norm(tilted - back[-1], axis=1).max() < 1e-4
        assert (await anna.order("declarations")).told["declarations"] == []

    trial(monkeypatch, tmp_path, work)


@pytest.mark.parametrize("order", [(0, 1, 2), (0, 2, 1)])
def test_looking_at_a_frame_stays_on_the_side_of_the_tool(monkeypatch, tmp_path, order):
    """With the points in the wrong order, z of the frame points into the touched body. The motion still stays
    outside.
    """
    (tmp_path / "cell.toml").write_text(
        'units = "mm,deg"\n[frames.PIN]\nparent = "FLANGE"\nxyz = [0, 0, -100]\n'
    )
    (tmp_path / "yarc.toml").write_text('cell = "cell.toml"\n')

    async def work(place, anna, line):
        assert (await begin(anna, "frame", tool="PIN")).status == 200
        for at_ in order:
            put(place, POINTS[at_], (0, 0, 0), (0, 0, -0.1))
            told = await touch(anna)
        made = await anna.post("/api/calibration/look", {"version": told.told["version"], "at": 1})
        assert ("points into the surface" in made.told["what"]) == (order[1] == 2)
        offered = (await anna.order("offer", text=made.told["text"])).told
        offer = offered["offer"]
        assert offer, [one["message"] for one in offered["findings"]]
        assert (await anna.order("go", offer=offer["number"])).told["well"]
        pose = flange_poses(place.world.robot.chain, np.radians(place.world.stands())[None])[0]
        above = np.array(POINTS[order[1]]) + np.array([0, 0, 0.05])
        np.testing.assert_allclose(pose[:3, 3] + pose[:3, :3] @ [0, 0, -0.1], above, atol=2e-5)

    trial(monkeypatch, tmp_path, work)


def test_touches_are_bounded(monkeypatch, tmp_path):
    async def work(place):
        anna = place.logged_in("anna", Role.PROGRAMMER)
        await begin(anna)
        for number in range(41):
            stand(place.world.machine, place.world.robot, np.radians([number / 10, 0, 0, 0, 0, 0]))
            last = await touch(anna)
        assert (last.status, last.told["code"]) == (409, "most")

    at(monkeypatch, tmp_path, work)
