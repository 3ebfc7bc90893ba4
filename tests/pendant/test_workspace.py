"""Tests of the workspace: drafts become changes of the files, limits need the PIN, programs that have errors
with a draft are named, and nobody can circumvent the checks.
"""

import asyncio
import hashlib
import os
import shutil
import subprocess
import sys
import time

import pytest
from coordinator.virtual import run
from hypothesis import given, settings
from hypothesis import strategies as st
from pendant.at_robot import pendant

from yarclang.pendant import apart
from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.accounts.sessions import Session
from yarclang.pendant.messages.workspace import EntryChange, EntryValues
from yarclang.pendant.workspace import checks as checking
from yarclang.pendant.workspace import judging
from yarclang.pendant.workspace.changing import with_entries
from yarclang.pendant.workspace.checks import Checks, Question
from yarclang.robot.library import find_robot
from yarclang.runtime.actions import Trouble
from yarclang.source import SourceFile

CELL = """# a cell with comments
units = "mm,deg,s"   # of all

[[obstacles]]
name = "BLOCK"   # a block
shape = "box"
frame = "B"
xyz = [900, -900, 100]
size = [200, 200, 200]

[[zones]]
name = "ROOM"
rule = "allowed"
shape = "box"
frame = "B"
size = [9000, 9000, 9000]
"""
UP = "P0010 MOVEJ 0 0 0 0 30 0 [4] (deg,s)\nP0020 MOVEJ HOME [4] (deg,s)\n"
WALL = {"name": "WALL", "rule": "forbidden", "shape": "box", "frame": "B", "size": [9000, 9000, 9000]}


def sha256(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def at(monkeypatch, tmp_path, work, cell=CELL, robot=False, named="cell.toml"):
    """Run a test coroutine with a pendant in a project with a cell. With `robot`, the project has a robot of
    its own.
    """
    project = tmp_path / "project"
    project.mkdir()
    (tmp_path / "state").mkdir()
    options = {}
    if robot:
        shutil.copytree(find_robot("INDUSTRIAL6")[0].parent, project / "arm")
        options["robot"] = str(project / "arm")
    if cell is not None:
        (project / "cell.toml").write_bytes(cell.encode())
        (project / "yarc.toml").write_text(f'cell = "{named}"\n')
    (project / "up.yarc").write_text(UP)

    async def whole():
        async with pendant(monkeypatch, tmp_path / "state", project=project, **options) as place:
            await work(place, project)

    run(whole())


async def pinned(place, name="sue"):
    browser = place.logged_in(name, Role.SERVICE)
    browser.session.pin_until = 1e9
    return browser


def change(project, table, number, **values):
    return {
        "known": sha256(project / "cell.toml"),
        "entries": [{"table": table, "at": number, "values": values or None}],
    }


BLOCK = {"name": "BLOCK", "shape": "box", "frame": "B", "xyz": [900, -900, 100], "size": [200, 200, 200]}


def test_a_draft_changes_only_what_it_says_and_is_kept_in_the_audit_trail(monkeypatch, tmp_path):
    async def work(place, project):
        sue = await pinned(place)
        shown = (await sue.get("/api/workspace")).told
        assert [(one["table"], one["values"]["name"]) for one in shown["entries"]] == [
            ("obstacles", "BLOCK"),
            ("zones", "ROOM"),
        ]
        assert (shown["cell"], shown["why"], shown["metre"]) == ("cell.toml", "", 0.001)
        assert shown["joints"][0]["lower"] == -170
        assert "outside of the project" in shown["robot_why"]
        draft = change(project, "obstacles", 0, **BLOCK | {"xyz": [900.5, -900, 100], "margin": 5})
        (told,) = (await sue.post("/api/workspace/draft", draft)).told["files"]
        assert told["before"] == CELL
        assert told["refused"] == ""
        assert told["after"] == CELL.replace("[900, -900, 100]", "[900.5, -900, 100]").replace(
            "size = [200, 200, 200]\n", "size = [200, 200, 200]\nmargin = 5\n"
        )
        saved = await sue.post("/api/workspace/save", draft)
        assert saved.status == 200
        assert (project / "cell.toml").read_text() == told["after"]
        (deed,) = [one for one in place.deeds() if one[1] == "file change"]
        assert (
            "xyz of obstacle BLOCK from [900, -900, 100] to [900.5, -900, 100]; margin of obstacle BLOCK "
            "from none to 5"
        ) in deed[2]
        assert "programs not checked" in deed[2]
        assert (await sue.get("/api/trash")).told["deleted"][0]["file"] == "cell.toml"
        again = await sue.post("/api/workspace/save", draft)
        assert (again.status, again.told["code"], again.told["sha256"]) == (
            409,
            "changed",
            sha256(project / "cell.toml"),
        )
        # The robot respects the new zone at once.
        assert (await sue.post("/api/orders/own")).status == 200
        wall = change(project, "zones", None, **WALL)
        assert (await sue.post("/api/workspace/save", wall)).status == 200
        offer = (await sue.order("offer", text="MOVEJ 0 0 0 0 30 0 [4] (deg,s)")).told
        assert offer["offer"] is None
        assert "WALL" in offer["findings"][0]["message"]
        # When the zone is removed, the same motion is offered again.
        shown = (await sue.get("/api/workspace")).told
        number = next(one["at"] for one in shown["entries"] if one["values"]["name"] == "WALL")
        assert (await sue.post("/api/workspace/save", change(project, "zones", number))).status == 200
        assert (await sue.order("offer", text="MOVEJ 0 0 0 0 30 0 [4] (deg,s)")).told["offer"] is not None

    at(monkeypatch, tmp_path, work)


def test_only_service_users_with_a_pin_at_rest(monkeypatch, tmp_path):
    async def work(place, project):
        pia, sue, vic = (
            place.logged_in(name, role)
            for name, role in (("pia", Role.PROGRAMMER), ("sue", Role.SERVICE), ("vic", Role.VIEWER))
        )
        draft = change(project, "obstacles", 0)
        assert (await vic.get("/api/workspace")).status == 200
        assert (await vic.post("/api/workspace/draft", draft)).status == 403
        assert (await pia.post("/api/workspace/draft", draft)).status == 200
        refused = await pia.post("/api/workspace/save", draft)
        assert (refused.status, refused.told["code"]) == (403, None)
        refused = await sue.post("/api/workspace/save", draft)
        assert (refused.status, refused.told["code"]) == (403, "pin")
        sue.session.pin_until = 1e9
        place.service.watched.showing._under_way = "up.yarc"
        refused = await sue.post("/api/workspace/save", draft)
        assert refused.status == 409
        assert "under way" in refused.told["error"]
        place.service.watched.showing._under_way = ""
        place.service.accounts.sessions.end(sue.session)
        assert (await sue.post("/api/workspace/save", draft)).status == 401
        assert (project / "cell.toml").read_text() == CELL

    at(monkeypatch, tmp_path, work)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        (WALL | {"size": [-1, 1, 1]}, "size"),
        (WALL | {"size": [1, 1]}, "3 values"),
        (WALL | {"name": "BLOCK"}, "BLOCK is already used for the "),
        (WALL | {"name": "x\" ]\n[units"}, "can't write"),
        (WALL | {"name": "ÄÖ"}, "can't write"),
        (WALL | {"frame": "NOWHERE"}, "isn't a frame"),
        (WALL | {"rule": "joyful"}, "rule"),
        (WALL | {"radius": 5}, "doesn't take"),
        (WALL | {"watch": ["the moon"]}, "no link"),
        (WALL | {"units": "parsec"}, "no unit"),
    ],
)  # fmt: skip
def test_what_no_cell_may_say_isnt_saved(monkeypatch, tmp_path, values, said):
    async def work(place, project):
        sue = await pinned(place)
        draft = change(project, "zones", None, **values)
        (told,) = (await sue.post("/api/workspace/draft", draft)).told["files"]
        assert told["refused"]
        import re

        assert any(re.search(said, one["message"] + str(one["help"])) for one in told["findings"]), told[
            "findings"
        ]
        assert (await sue.post("/api/workspace/save", draft)).status == 409
        assert (project / "cell.toml").read_text() == CELL

    at(monkeypatch, tmp_path, work)


@pytest.mark.parametrize("number", ["NaN", "1e308", "Infinity", "-1e10", '"1"', "null", "[1]"])
def test_numbers_that_are_none(monkeypatch, tmp_path, number):
    async def work(place, project):
        sue = await pinned(place)
        raw = (
            '{"known": "%s", "entries": [{"table": "zones", "at": 0, "values": {"name": "A", "size": [1, '
            "%s, 1]}}]}"
        )
        told = await sue.post(
            "/api/workspace/draft", raw=(raw % (sha256(project / "cell.toml"), number)).encode()
        )
        assert told.status == 400

    at(monkeypatch, tmp_path, work)


FORMS = {
    "inline": (
        'units = "mm"\nobstacles = [{ name = "A", shape = "sphere", frame = "B", radius = 5 }]\n',
        True,
        False,
    ),
    "crlf": (CELL.replace("\n", "\r\n"), True, True),
    "mark": ("\ufeff" + CELL, True, True),
    "dotted": (
        (
            'units = "mm"\n'
            "[[obstacles]]\n"
            'name = "A"\n'
            'shape = "sphere"\n'
            'frame = "B"\n'
            "radius = 5\n"
            "[frames]\n"
            'F.parent = "B"\n'
        ),
        True,
        True,
    ),
    "no zones": ('units = "mm,deg"\n', None, True),
}


@pytest.mark.parametrize("form", FORMS)
def test_files_in_other_forms_are_changed_or_refused_in_words(monkeypatch, tmp_path, form):
    text, changes, adds = FORMS[form]

    async def work(place, project):
        sue = await pinned(place)
        shown = (await sue.get("/api/workspace")).told
        if changes:
            values = {key: value for key, value in shown["entries"][0]["values"].items() if value is not None}
            made = await sue.post(
                "/api/workspace/save", change(project, "obstacles", 0, **values | {"margin": 7})
            )
            assert made.status == 200, made.told
            assert b"margin = 7" in (project / "cell.toml").read_bytes()
        added = await sue.post(
            "/api/workspace/draft",
            change(project, "obstacles", None, name="NEW", shape="sphere", frame="B", radius=3),
        )
        assert (added.status == 200) is adds, added.told
        if not adds:
            assert "Program" in added.told["help"]
        elif form != "no zones":
            assert added.told["files"][0]["after"].startswith(
                (project / "cell.toml").read_bytes().decode().rstrip()
            )
        if form == "crlf":
            assert (project / "cell.toml").read_bytes().count(b"\r\n") == (
                project / "cell.toml"
            ).read_bytes().count(b"\n")

    at(monkeypatch, tmp_path, work, cell=text)


def test_a_thousand_obstacles(monkeypatch, tmp_path):
    many = CELL + "".join(
        (
            "\n"
            "[[obstacles]]\n"
            f'name = "S{one}"\n'
            'shape = "sphere"\n'
            'frame = "B"\n'
            f"xyz = [{3000 + one}, 0, 0]\n"
            "radius = 5\n"
        )
        for one in range(1000)
    )

    async def work(place, project):
        sue = await pinned(place)
        begun = time.perf_counter()
        assert len((await sue.get("/api/workspace")).told["entries"]) == 1002
        drafts = change(project, "obstacles", None, name="NEW", shape="sphere", frame="B", radius=3)
        assert (await sue.post("/api/workspace/draft", drafts)).status == 200
        near = (await sue.post("/api/workspace/distances", {})).told
        assert len(near["pairs"]) == 8
        assert (
            "too long to check"
            in (await sue.post("/api/workspace/distances", {"draft": drafts})).told["what"]
        )
        assert time.perf_counter() - begun < 30.0

    at(monkeypatch, tmp_path, work, cell=many)


def test_a_new_cell_is_made_and_kept_to(monkeypatch, tmp_path):
    async def work(place, project):
        sue = await pinned(place)
        assert "there is no cell" in (await sue.get("/api/workspace")).told["why"]
        for name in ("../cell.toml", ".hidden.toml", "cell.txt", "no/folder/cell.toml"):
            assert (await sue.post("/api/workspace/cell", {"file": name})).status == 409
        assert not (project / "yarc.toml").exists()
        made = await sue.post("/api/workspace/cell", {"file": "cell.toml"})
        assert made.status == 200
        assert (project / "yarc.toml").read_text() == 'cell = "cell.toml"\n'
        assert (await sue.get("/api/workspace")).told["cell"] == "cell.toml"
        assert (await sue.post("/api/workspace/cell", {"file": "other.toml"})).status == 409

    at(monkeypatch, tmp_path, work, cell=None)


def test_a_cell_outside_of_the_project_is_shown_and_left_alone(monkeypatch, tmp_path):
    (tmp_path / "far").mkdir()
    (tmp_path / "far" / "cell.toml").write_text(CELL)

    async def work(place, project):
        sue = await pinned(place)
        shown = (await sue.get("/api/workspace")).told
        assert len(shown["entries"]) == 2
        assert "outside of the project" in shown["why"]
        draft = {
            "known": sha256(tmp_path / "far" / "cell.toml"),
            "entries": [{"table": "zones", "at": 0, "values": None}],
        }
        assert (await sue.post("/api/workspace/save", draft)).status == 409
        assert (tmp_path / "far" / "cell.toml").read_text() == CELL

    at(monkeypatch, tmp_path, work, named="../far/cell.toml")


@pytest.mark.parametrize("broken", [CELL.replace('frame = "B"', 'frame = "Z"', 1), CELL + "[[[", None])
def test_a_broken_cell_is_shown_to_be_repaired(monkeypatch, tmp_path, broken):
    async def work(place, project):
        sue = await pinned(place)
        assert (await sue.get("/api/scene")).told["notes"] == []
        if broken is None:
            (project / "cell.toml").unlink()
        else:
            (project / "cell.toml").write_text(broken)
        # the scene says that the cell is missing, so that it doesn't look like free space
        if broken is None or broken.endswith("[[["):
            notes = (await sue.get("/api/scene")).told["notes"]
            assert any("without the cell" in one for one in notes)
        shown = (await sue.get("/api/workspace")).told
        assert shown["cell"] is not None
        assert (await sue.post("/api/workspace/distances", {})).status == 200
        assert (await sue.post("/api/workspace/cell", {"file": "other.toml"})).status == 409
        if broken is None:
            assert "isn't there" in shown["why"]
            return
        assert any(one["severity"] == "error" for one in shown["findings"])
        if "[[[" not in broken:
            assert (
                await sue.post("/api/workspace/save", change(project, "obstacles", 0, **BLOCK))
            ).status == 200
            assert (project / "cell.toml").read_text() == CELL

    at(monkeypatch, tmp_path, work)


def test_limits_of_joints(monkeypatch, tmp_path):
    async def work(place, project):
        sue = await pinned(place)
        shown = (await sue.get("/api/workspace")).told
        path = project / "arm" / "robot.toml"
        before = path.read_text()
        assert shown["robot"] == "arm/robot.toml"
        assert not shown["robot_waits"]
        least = shown["joints"][0]["least"]
        for lower, upper, said in ((100, 100, "isn't below"), (10, 170, "HOME"), (-5000, 170, "J1")):
            if lower == -5000 and least is None:
                continue
            draft = {"robot_known": sha256(path), "limits": [{"joint": "J1", "lower": lower, "upper": upper}]}
            refused = await sue.post("/api/workspace/save", draft)
            assert refused.status == 409
            assert said in refused.told["error"]
        draft = {"robot_known": sha256(path), "limits": [{"joint": "J1", "lower": -100, "upper": 120.5}]}
        saved = (await sue.post("/api/workspace/save", draft)).told
        assert "when the robot is served again" in saved["told"]
        assert path.read_text() == before.replace("[-170, 170]  # deg", "[-100, 120.5]  # deg", 1)
        assert (await sue.get("/api/workspace")).told["robot_waits"]
        assert "position of J1 from [-170, 170] to [-100, 120.5]" in place.deeds()[-1][2]
        # Until the restart no program is proved, because the description isn't that of the running robot.
        loaded = (await sue.order("load", file="up.yarc")).told
        assert loaded["program"] is None
        assert "has changed since the robot was served" in loaded["findings"][0]["message"]

    at(monkeypatch, tmp_path, work, robot=True)


def test_distances_follow_the_draft_and_measure_true(monkeypatch, tmp_path):
    async def work(place, project):
        vic = place.logged_in("vic", Role.VIEWER)
        near = (await vic.post("/api/workspace/distances", {})).told["pairs"]
        assert near
        assert all(len(one["points"]) in (0, 6) for one in near)
        for one in near:
            if one["points"] and one["distance"] > 0:
                gap = (
                    sum((a - b) ** 2 for a, b in zip(one["points"][:3], one["points"][3:], strict=True))
                    ** 0.5
                )
                assert abs(1000 * gap - one["distance"]) < 0.1
        draft = change(project, "obstacles", 0, **BLOCK | {"xyz": [0, 600, 400], "margin": 20})
        moved = (await vic.post("/api/workspace/distances", {"draft": draft})).told["pairs"]
        assert any("BLOCK" in (one["first"], one["second"]) and one["margin"] == 20 for one in moved), moved
        assert (
            await vic.post("/api/workspace/distances", {"draft": draft | {"known": "0" * 64}})
        ).status == 409

    at(monkeypatch, tmp_path, work)


def test_a_check_is_asked_for_named_in_the_audit_trail_and_ends_with_its_session(monkeypatch, tmp_path):
    async def work(place, project):
        sue, pia, vic = (
            await pinned(place),
            place.logged_in("pia", Role.PROGRAMMER),
            place.logged_in("vic", Role.VIEWER),
        )
        asked = []

        async def judged_at_once(self, check):
            asked.append(check.question)
            if len(asked) == 1:
                await asyncio.sleep(1000.0)
            told = {"file": "up.yarc", "held": True, "holds": False}
            check.programs.append(checking.JudgedProgram.model_validate(told))
            check.state = "done"

        monkeypatch.setattr(Checks, "_run", judged_at_once)
        draft = change(project, "obstacles", 0)
        assert (await vic.post("/api/workspace/check", draft)).status == 403
        begun = (await pia.post("/api/workspace/check", draft)).told
        assert (begun["state"], begun["mine"], begun["of"]) == ("running", True, 1)
        await asyncio.sleep(0.1)
        assert not (await vic.get("/api/workspace/check")).told["mine"]
        assert (await sue.post("/api/workspace/check", draft)).status == 409
        await sue.ask("DELETE", "/api/workspace/check")
        assert place.service.checks.is_busy  # the running check is another user's
        place.service.accounts.sessions.end(pia.session)
        await asyncio.sleep(0.1)
        assert (await sue.get("/api/workspace/check")).told["state"] == "cancelled"
        assert (await sue.post("/api/workspace/check", draft)).status == 200
        await asyncio.sleep(0.1)
        assert asked[1].files == ("up.yarc",)
        assert asked[1].cell == str(project / "cell.toml")
        assert "BLOCK" not in asked[1].drafts[str(project / "cell.toml")]
        assert (await sue.post("/api/workspace/save", draft)).status == 200
        assert "1 of 1 programs can no longer be proved, 0 not checked" in place.deeds()[-1][2]

    at(monkeypatch, tmp_path, work)


# the rules can't be bypassed


def test_programmers_change_no_description_by_way_of_files(monkeypatch, tmp_path):
    async def work(place, project):
        os.link(project / "cell.toml", project / "innocent.txt")
        (project / "link.txt").symlink_to("cell.toml")
        (project / "sub").mkdir()
        (project / "sub" / "box.STL").write_bytes(b"solid")
        (project / "odd.cell").write_text("")
        (project / "script.inputs.toml").write_text("")
        (project / "arm" / "notes.md").write_text("of the robot")
        pia = place.logged_in("pia", Role.PROGRAMMER)
        sue = await pinned(place)
        deleted = (await sue.post("/api/files/delete", {"file": "sub"})).told["number"]
        known = sha256(project / "cell.toml")
        tries = [
            ("PUT", "/api/files/cell.toml", {"text": "", "known": known}),
            ("PUT", "/api/files/innocent.txt", {"text": "", "known": known}),
            ("PUT", "/api/files/link.txt", {"text": "", "known": known}),
            ("PUT", "/api/files/new.TOML", {"text": "", "known": None}),
            ("PUT", "/api/files/arm/notes.md", {"text": "", "known": sha256(project / "arm" / "notes.md")}),
            ("PUT", "/api/files/arm/new.yarc", {"text": "", "known": None}),
            ("POST", f"/api/upload/cell.toml?known={known}", {}),
            ("POST", "/api/upload/yarc2.toml", {}),
            ("POST", "/api/files/copy", {"file": "odd.cell", "to": "sub.toml"}),
            ("POST", "/api/files/rename", {"file": "cell.toml", "to": "cell.txt"}),
            ("POST", "/api/files/rename", {"file": "odd.cell", "to": "a.toml"}),
            ("POST", "/api/files/rename", {"file": "script.inputs.toml", "to": "script.toml"}),
            ("POST", "/api/files/rename", {"file": "arm", "to": "leg"}),
            ("POST", "/api/files/rename", {"file": "link.txt", "to": "other.txt"}),
            ("POST", "/api/files/delete", {"file": "yarc.toml"}),
            ("POST", "/api/files/delete", {"file": "arm"}),
            ("POST", "/api/files/delete", {"file": "innocent.txt"}),
            ("POST", "/api/files/restore", {"number": deleted}),
            ("POST", "/api/files/folder", {"file": "arm/more"}),
        ]
        before = sorted((str(one), one.stat().st_mtime_ns) for one in project.rglob("*") if one.exists())
        for method, path, body in tries:
            refused = await pia.ask(method, path, body)
            assert refused.status == 403, path
            assert "describes the robot or its cell" in refused.told["error"]
        assert (
            sorted((str(one), one.stat().st_mtime_ns) for one in project.rglob("*") if one.exists()) == before
        )
        await asyncio.sleep(0.1)
        refusals = [one for one in place.deeds() if one[0] == "pia" and one[3].startswith("refused")]
        assert len(refusals) == len(tries)
        # A service user needs the PIN. After entering it, the change is allowed.
        sue.session.pin_until = 0.0
        refused = await sue.ask("PUT", "/api/files/cell.toml", {"text": "", "known": known})
        assert (refused.status, refused.told["code"]) == (403, "pin")
        sue.session.pin_until = 1e9
        assert (
            await sue.ask("PUT", "/api/files/cell.toml", {"text": CELL + "\n", "known": known})
        ).status == 200
        assert (await sue.post("/api/files/restore", {"number": deleted})).status == 200
        # All other files can be changed by a programmer.
        for method, path, body in (
            ("PUT", "/api/files/a.yarc", {"text": UP, "known": None}),
            ("PUT", "/api/files/b.inputs.toml", {"text": "", "known": None}),
            ("POST", "/api/files/rename", {"file": "a.yarc", "to": "c.yarc"}),
            ("POST", "/api/files/folder", {"file": "jobs"}),
            ("POST", "/api/files/copy", {"file": "cell.toml", "to": "jobs/cell.txt"}),
            ("POST", "/api/files/delete", {"file": "jobs"}),
        ):
            assert (await pia.ask(method, path, body)).status == 200, path

    at(monkeypatch, tmp_path, work, robot=True)


def test_a_cell_of_any_name_is_guarded(monkeypatch, tmp_path):
    async def work(place, project):
        (project / "yarc.toml").write_text('cell = "around.txt"\n')
        (project / "cell.toml").rename(project / "around.txt")
        pia = place.logged_in("pia", Role.PROGRAMMER)
        answers = [
            await pia.ask(
                "PUT", "/api/files/around.txt", {"text": "", "known": sha256(project / "around.txt")}
            ),
            await pia.post("/api/files/delete", {"file": "around.txt"}),
        ]
        assert [one.status for one in answers] == [403, 403]

    at(monkeypatch, tmp_path, work)


def test_killed_while_it_saves_the_file_is_whole(monkeypatch, tmp_path):
    async def work(place, project):
        sue = await pinned(place)
        draft = change(project, "obstacles", 0)

        def killed(*_):
            raise KeyboardInterrupt

        monkeypatch.setattr("yarclang.pendant.project.draft.Draft.stand_in_place", killed)
        with pytest.raises(KeyboardInterrupt):
            await sue.post("/api/workspace/save", draft)
        assert (project / "cell.toml").read_text() == CELL
        assert [one for one in project.iterdir() if one.name.startswith(".yarc")] == []

    at(monkeypatch, tmp_path, work)


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.tuples(st.sampled_from(["change", "remove", "add"]), st.integers(0, 3), st.floats(-1e6, 1e6)),
        max_size=6),
    st.sampled_from(["\n", "\r\n"]),
)  # fmt: skip
def test_drafts_say_what_they_mean(steps, ending):
    """If the text with a draft is read back, it has exactly the entries of the draft, in order."""
    import tomllib

    text = "# kept\n" + "".join(
        f'[[zones]]\nname = "Z{one}"  # {one}\nxyz = [{one}, 0, 0]\n\n' for one in range(4)
    )
    wanted: dict = {one: {"name": f"Z{one}", "xyz": [one, 0, 0]} for one in range(4)}
    changes, added, seen = [], [], set()
    for what, at_, number in steps:
        values = {"name": "N", "xyz": [number, 0.0, 0.0]}
        if what == "add":
            changes.append(
                EntryChange(table="zones", at=None, values=EntryValues(name="N", xyz=(number, 0.0, 0.0)))
            )
            added.append(values)
        elif at_ not in seen:
            seen.add(at_)
            gone = what == "remove"
            changes.append(
                EntryChange(
                    table="zones",
                    at=at_,
                    values=None if gone else EntryValues(name="N", xyz=(number, 0.0, 0.0)),
                )
            )
            wanted[at_] = None if gone else values
    after, _ = with_entries(SourceFile("cell.toml", text.replace("\n", ending)), changes)
    found = tomllib.loads(after).get("zones", [])
    assert found == [one for one in wanted.values() if one is not None] + added
    assert after.startswith("# kept")


# programs


def question(project, draft, files=None, joints=None):
    found = files or tuple(sorted(one.name for one in project.glob("*.yarc")))
    return Question(
        project,
        found,
        "INDUSTRIAL6",
        str(project / "cell.toml"),
        {str(project / "cell.toml"): draft},
        joints,
        "d",
    )


def session(user="sue"):
    return Session(
        id=user, token="", user=user, role=Role.SERVICE, address="", agent="", opened=0.0, seen=0.0
    )


async def judged(checks, asked, within=90.0):
    checks.begin(session(), asked)
    async with asyncio.timeout(within):
        while checks.is_busy:
            await asyncio.sleep(0.05)
    return checks.shown(session())


def test_programs_that_no_longer_hold_are_named(tmp_path):
    (tmp_path / "cell.toml").write_text(CELL)
    (tmp_path / "yarc.toml").write_text('cell = "cell.toml"\n')
    (tmp_path / "up.yarc").write_text(UP)
    (tmp_path / "broken.yarc").write_text("P0010 MOVEJ 999 0 0 0 0 0 [4] (deg,s)\n")
    (tmp_path / "module.yarc").write_text("SUB A\n  P0010 STOP\nEND\n")
    files = {one: one.read_bytes() for one in tmp_path.iterdir()}
    wall = CELL + (
        "\n"
        "[[zones]]\n"
        'name = "WALL"\n'
        'rule = "forbidden"\n'
        'shape = "half-space"\n'
        'frame = "B"\n'
        "xyz = [0, 0, 9000]\n"
        "normal = [0, 0, -1]\n"
        'watch = ["tcp"]\n'
    )

    async def work():
        checks = Checks()
        shown = await judged(checks, question(tmp_path, wall, joints=(0.0,) * 6))
        assert (shown.state, shown.broken, shown.unjudged) == ("done", 1, 1)
        (first, second) = shown.programs
        assert (first.file, first.held, first.holds, first.line) == (
            "up.yarc",
            True,
            False,
            1,
        )
        assert "WALL" in first.message
        assert (second.file, second.held) == ("broken.yarc", False)
        assert any("WALL" in one for one in shown.standing)
        assert checks.outcome("d") == "1 of 2 programs can no longer be proved, 1 not checked"
        assert checks.outcome("another one") == "programs not checked"
        shown = await judged(checks, question(tmp_path, CELL + "# the same\n", joints=(9.0,) + (0.0,) * 5))
        assert (shown.broken, [one.holds for one in shown.programs]) == (0, [False, True])

    asyncio.run(work())
    assert {one: one.read_bytes() for one in tmp_path.iterdir()} == files


def test_programs_are_proved_with_other_limits(tmp_path):
    shutil.copytree(find_robot("INDUSTRIAL6")[0].parent, tmp_path / "arm")
    path = tmp_path / "arm" / "robot.toml"
    (tmp_path / "up.yarc").write_text(UP)
    (tmp_path / "turn.yarc").write_text(UP.replace("MOVEJ 0", "MOVEJ 90"))
    draft = path.read_text().replace("[-170, 170]", "[-80, 80]", 1)
    asked = Question(
        tmp_path,
        ("turn.yarc", "up.yarc"),
        str(tmp_path / "arm"),
        None,
        {str(path): draft},
        (1.5,) + (0.0,) * 5,
        "d",
    )
    shown = asyncio.run(judged(Checks(), asked))
    assert [(one.file, one.held, one.holds) for one in shown.programs] == [
        ("turn.yarc", True, False),
        ("up.yarc", None, True),
    ]
    assert shown.standing == ("J1 is 5.944 deg beyond its limits",)


DIES = """
import json, sys
asked = json.load(sys.stdin)
print(json.dumps({"standing": []}), flush=True)
for number, file in enumerate(asked["files"]):
    print(json.dumps({"at": number}), flush=True)
    if file == "dies": sys.exit(1)
    if file == "hangs":
        import time; time.sleep(1000)
    if file == "talks": print("x" * 3000000, flush=True)
    print(json.dumps({"file": file, "held": None, "holds": True}), flush=True)
print(json.dumps({"done": True}), flush=True)
"""


def test_what_dies_or_hangs_is_left_out(monkeypatch, tmp_path):
    monkeypatch.setattr(checking, "MOST_EACH", 1.5)

    async def work():
        checks = Checks((sys.executable, "-c", DIES))
        shown = await judged(checks, question(tmp_path, "", ("a", "dies", "b", "hangs", "talks", "c")), 30.0)
        assert shown.state == "done"
        assert shown.unjudged == 3
        assert {one.file for one in shown.programs if one.holds} == {"a", "b", "c"}
        shown = await judged(Checks((sys.executable, "-c", "exit")), question(tmp_path, "", ("a",) * 9), 30.0)
        assert shown.state == "failed"
        shown = await judged(Checks(("/no/such/file",)), question(tmp_path, "", ("a",)), 30.0)
        assert shown.state == "failed"
        assert "can't be started" in shown.what

    asyncio.run(work())


def test_one_check_at_a_time_and_it_ends_with_its_session(tmp_path):
    async def work():
        checks = Checks((sys.executable, "-c", DIES))
        checks.begin(session(), question(tmp_path, "", ("hangs",)))
        with pytest.raises(Trouble, match="sue is already checking programs"):
            checks.begin(session("tom"), question(tmp_path, "", ("a",)))
        checks.cancel("tom")
        assert checks.is_busy
        await asyncio.sleep(0.3)
        task = checks._last.task
        checks.cancel("sue")
        async with asyncio.timeout(10.0):
            await asyncio.gather(task, return_exceptions=True)
        assert checks.shown(session()).state == "cancelled"
        shown = await judged(checks, question(tmp_path, "", ("a",)), 20.0)
        assert shown.state == "done"

    asyncio.run(work())


def test_the_process_has_little_priority_and_bounded_memory(tmp_path, monkeypatch):
    (tmp_path / "says.py").write_text(
        "import os, resource, sys\n"
        "def main():\n"
        "    print(os.nice(0), *resource.getrlimit(resource.RLIMIT_AS), sys.argv[1:])\n"
    )
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    command = apart.command_of("says", ("a", "-b"), 300_000_000, nice=15)
    told = subprocess.run(command, capture_output=True, text=True, timeout=30, check=True).stdout
    assert told.split(maxsplit=3) == ["15", "300000000", "300000000", "['a', '-b']\n"]
    assert Checks()._command == apart.command_of(judging.__name__, (), checking.MOST_MEMORY, nice=15)
