"""Tests of backups of the project: a restore gives the same files, a hostile zip changes nothing, and the
files that a restore replaces are saved.
"""

import asyncio
import errno
import hashlib
import io
import json
import os
import signal
import stat
import struct
import subprocess
import sys
import tempfile
import time
import tracemalloc
import zipfile
import zlib
from contextlib import suppress
from pathlib import Path

import pytest
from coordinator.virtual import run
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pendant.at_robot import pendant, scope_of

from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.backup import backups
from yarclang.pendant.backup.applying import apply
from yarclang.pendant.backup.bounds import MANIFEST
from yarclang.pendant.backup.comparing import judged, plan_of
from yarclang.pendant.backup.reading import content, entries_of
from yarclang.pendant.backup.writing import About, selected, zipped
from yarclang.pendant.project import draft, room
from yarclang.pendant.project.folder import ProjectFolder
from yarclang.runtime.actions import Trouble

ABOUT = About("1", "INDUSTRIAL6", "abc", "2026-01-02T03:04:05+00:00")
PROGRAM = "P0010 MOVEJ 20 0 0 0 30 0 [6] (deg,s)\nP0020 MOVEJ HOME [6] (deg,s)\n"


def project(top, files):
    folder = top / "project"
    for name, data in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    folder.mkdir(parents=True, exist_ok=True)
    return ProjectFolder(folder, top / "data" / "pendant.db")


def contents(folder):
    return {
        str(one.relative_to(folder)): one.read_bytes()
        for one in folder.rglob("*")
        if one.is_file() and not any(part.startswith(".") for part in one.relative_to(folder).parts)
    }


def backup_of(folder, *, logs=True):
    return b"".join(zipped(folder, selected(folder, logs=logs), ABOUT))


class Zip:
    """A zip in an unnamed file, opened like an uploaded one."""

    def __init__(self, data):
        self.file = tempfile.TemporaryFile()  # noqa: SIM115 - it is closed with its object
        self.file.write(data)
        self.file.flush()
        self.handle = self.file.fileno()


def look(data):
    held = Zip(data)
    return judged(held.handle)


def restore(folder, data, *, remove=True):
    held = Zip(data)
    backup = judged(held.handle)
    plan = plan_of(folder, backup)
    return apply(folder, held.handle, backup, plan.digest, "anna", ABOUT, remove=remove)


def zip_of(*entries, method=zipfile.ZIP_DEFLATED):
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", method) as archive:
        for name, data in entries:
            archive.writestr(name, data)
    return made.getvalue()


def refusal(data):
    with pytest.raises(Trouble) as caught:
        look(data)
    assert caught.value.code == "hostile"
    assert len(caught.value.what) < 400
    return caught.value.what


# backups made by the pendant itself

NAME = st.text(st.sampled_from("abÄé€ 🤖-_(),'%"), min_size=1, max_size=6).filter(
    lambda name: name == name.strip()
)
PATH = st.lists(NAME, min_size=1, max_size=4).map("/".join)
CONTENT = st.one_of(st.binary(max_size=300), st.integers(1, 4).map(lambda count: b"x" * (count * 70_000)))


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    before=st.dictionaries(PATH, CONTENT, max_size=8), after=st.dictionaries(PATH, CONTENT, max_size=8),
        remove=st.booleans()
)  # fmt: skip
def test_a_restore_and_its_undo_give_the_same_files(before, after, remove):
    with tempfile.TemporaryDirectory() as top:
        folder = project(Path(top), {})
        for tree in (before, after):
            for one in folder.root.rglob("*"):
                if one.is_file():
                    one.unlink()
            for name, data in tree.items():
                with suppress(OSError):
                    (folder.root / name).parent.mkdir(parents=True, exist_ok=True)
                    (folder.root / name).write_bytes(data)
            kept = contents(folder.root)
            if tree is before:
                saved, wanted = backup_of(folder), kept
        refused = ""
        try:
            done = restore(folder, saved, remove=remove)
        except Trouble as trouble:  # a file has the path of a folder of the backup, or a similar name
            refused = trouble.what
        if refused:
            assert "can't be restored" in refused or "no files" in refused
            assert contents(folder.root) == kept
            return
        found = contents(folder.root)
        extra = {name: data for name, data in kept.items() if name not in wanted}
        assert found == wanted | ({} if remove else extra)
        if done.undo:
            kept_zip = (Path(top) / "data" / "trash" / done.undo / "content").read_bytes()
            restore(folder, kept_zip)
        assert contents(folder.root) == kept


def test_what_is_in_a_backup(tmp_path):
    folder = project(
        tmp_path,
        {"a.yarc": b"x" * 200_000, "sub/b.toml": b"", "run.mcap": b"log", ".git/config": b"secret",
            "bad\\name": b"1"},
    )  # fmt: skip
    (folder.root / "empty" / "inner").mkdir(parents=True)
    (folder.root / "link.yarc").symlink_to("a.yarc")
    (folder.root / "out.yarc").symlink_to("/etc/passwd")
    os.mkfifo(folder.root / "pipe")
    data = backup_of(folder, logs=False)
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        assert archive.testzip() is None
        lines = [json.loads(line) for line in archive.read(MANIFEST).splitlines()]
        assert sorted(archive.namelist()) == sorted(["a.yarc", "empty/inner/", "sub/b.toml",
            MANIFEST])  # fmt: skip
    assert {one["file"]: one["sha256"] for one in lines if "sha256" in one} == {
        name: hashlib.sha256((folder.root / name).read_bytes()).hexdigest()
        for name in ("a.yarc", "sub/b.toml")
    }
    assert (lines[0]["robot"], lines[0]["yarclang"], lines[0]["logs"]) == ("INDUSTRIAL6", "1", False)
    assert [one["file"] for one in lines if "why" in one] == ["bad\\name", "link.yarc"]
    # Files that the backup has left out aren't removed.
    (folder.root / "new.yarc").write_bytes(b"")
    done = restore(folder, data)
    assert done.removed == ("new.yarc",)
    assert (folder.root / "run.mcap").exists()
    other = project(tmp_path / "other", {})
    restore(other, data)
    assert (other.root / "empty" / "inner").is_dir()


def test_links_and_what_they_lead_to(tmp_path):
    """A file is restored only under its own name. A file whose path leads through a link is refused, because
    it would be written a second time.
    """
    folder = project(tmp_path, {"m.yarc": b"old", "sub/x.yarc": b"x"})
    for name, target in (("a.yarc", "m.yarc"), ("z.yarc", "m.yarc"), ("way", "sub")):
        (folder.root / name).symlink_to(target)
    data = backup_of(folder)
    (folder.root / "m.yarc").write_bytes(b"new")
    restore(folder, data)
    assert (folder.root / "m.yarc").read_bytes() == b"old"
    assert (folder.root / "a.yarc").is_symlink()
    plan = plan_of(
        folder, look(zip_of(("way/y", b"1"), ("sub/y", b"2"), ("a.yarc", b"other"), ("z.yarc", b"old")))
    )
    assert {one.file for one in plan.conflicts} == {"way/y", "a.yarc"}


def test_a_file_that_changes_or_goes_while_it_is_read(tmp_path):
    folder = project(tmp_path, {name: os.urandom(1_000_000) for name in "abc"})
    pieces = zipped(folder, selected(folder, logs=True), ABOUT)
    begun = [next(pieces), next(pieces)]
    with (folder.root / "a").open("r+b") as file:
        file.truncate(600_000)
    (folder.root / "c").unlink()
    backup = look(b"".join([*begun, *pieces]))
    assert set(backup.files) == {"a", "b"}
    assert backup.edited == ()
    assert {one.file: one.changing for one in backup.manifest.files} == {"a": True, "b": False}
    assert [one.file for one in backup.manifest.left_out] == ["c"]


def test_memory_is_flat_both_ways(tmp_path):
    folder = project(tmp_path, {"big": b"", "zeros": b""})
    with (folder.root / "big").open("wb") as file:
        for _ in range(48):
            file.write(os.urandom(1 << 20))
    with (folder.root / "zeros").open("wb") as file:
        file.truncate(200 << 20)
    tracemalloc.start()
    try:
        with (tmp_path / "saved.zip").open("w+b") as saved:
            for piece in zipped(folder, selected(folder, logs=True), ABOUT):
                saved.write(piece)
            saved.flush()
            judged(saved.fileno())
        assert tracemalloc.get_traced_memory()[1] < 12e6
    finally:
        tracemalloc.stop()


# hostile zips


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("/etc/passwd", "isn't in the project's folder"),
        ("../x", "isn't in the project's folder"),
        ("a/../../x", "isn't in the project's folder"),
        ("a//x", "isn't in the project's folder"),
        ("..\\x", "hidden"),
        ("a\\x", "backslash"),
        ("C:/x", "drive"),
        ("a\nb", "control character"),
        ("a\x7fb", "control character"),
        (".git/hooks/x", "hidden"),
        ("a/.x", "hidden"),
        ("a\u202excod.yarc", "direction"),
        ("a ", "blank"),
        ("a./x", "dot"),
        ("x" * 256, "255"),
        ("x/" * 60 + "y", "folders"),
        ("/".join(["y" * 200] * 6), "bytes"),
    ],
)
def test_hostile_names(name, why):
    assert why in refusal(zip_of(("good.yarc", b"1"), (name, b"2")))


def test_names_that_look_like_others():
    with pytest.warns(UserWarning, match="Duplicate"):
        assert "twice" in refusal(zip_of(("a", b"1"), ("a", b"2")))
    assert "looks like" in refusal(zip_of(("a", b"1"), ("A", b"2")))
    assert "looks like" in refusal(zip_of(("\u00e4/x", b"1"), ("a\u0308/y", b"2")))
    assert "a file and a folder" in refusal(zip_of(("a", b"1"), ("a/b", b"2")))
    assert "a file and a folder" in refusal(zip_of(("a/b", b"1"), ("a", b"2")))


def info(name, mode=stat.S_IFREG | 0o644, **fields):
    made = zipfile.ZipInfo(name)
    made.create_system, made.external_attr = 3, mode << 16
    for key, value in fields.items():
        setattr(made, key, value)
    return made


def test_hostile_kinds():
    assert "a link" in refusal(zip_of((info("a", stat.S_IFLNK | 0o777), b"/etc/passwd")))
    for kind in (stat.S_IFCHR, stat.S_IFIFO, stat.S_IFSOCK, stat.S_IFBLK):
        assert "not a file" in refusal(zip_of((info("a", kind | 0o600), b"")))
    assert "folder" in refusal(zip_of((info("a", stat.S_IFDIR | 0o755), b"")))
    assert "method 12" in refusal(zip_of((info("a", compress_type=zipfile.ZIP_BZIP2), b"x" * 100)))
    assert "method 14" in refusal(zip_of((info("a", compress_type=zipfile.ZIP_LZMA), b"x" * 100)))
    assert "second name" in refusal(zip_of((info("a", extra=struct.pack("<2H", 0x7075, 5) + b"12345"), b"")))
    assert "no files" in refusal(zip_of())
    assert "list" in refusal(zip_of((MANIFEST, b"[" * 100_000)))
    for text in (b"{}", b"\n" * 10**6, b"{" * 10**5, b'{"format": 2}', b""):
        assert "list" in refusal(zip_of((MANIFEST, text)))


class Raw:
    """A zip that is put together byte by byte, with possibly false data. Each entry is (name, claimed size,
    claimed CRC, packed bytes, method, flags).
    """

    def __init__(self):
        self.body, self.rows = b"", []

    def local(self, name, packed, size, crc, method=8, flags=0x800, extra=b""):
        raw = name if isinstance(name, bytes) else name.encode()
        at = len(self.body)
        self.body += struct.pack("<4s5H3L2H", b"PK\3\4", 20, flags, method, 0, 33, crc, len(packed), size,
            len(raw), len(extra)) + raw + extra + packed  # fmt: skip
        self.row(raw, len(packed), size, crc, at, method, flags)
        return at

    def row(self, raw, packed, size, crc, at, method=8, flags=0x800, extra=b""):
        self.rows.append(struct.pack("<4s6H3L5H2L", b"PK\1\2", 20, 20, flags, method, 0, 33, crc, packed,
            size, len(raw), len(extra), 0, 0, 0, 0, at) + raw + extra)  # fmt: skip

    def done(self, *, count=None, before=b"", after=b""):
        rows = b"".join(self.rows)
        number = len(self.rows) if count is None else count
        begins = len(self.body) + len(before)
        end = struct.pack("<4s4H2LH", b"PK\5\6", 0, 0, number, number, len(rows), begins, 0)
        return self.body + before + rows + end + after


def deflated(data):
    made = zlib.compressobj(9, wbits=-15)
    return made.compress(data) + made.flush()


def test_zips_made_by_hand():
    text = b"P0010 MOVEJ HOME\n"
    packed, crc = deflated(text), zlib.crc32(text)
    good = Raw()
    good.local("a.yarc", packed, len(text), crc)
    assert list(look(good.done()).files) == ["a.yarc"]
    assert "after its end" in refusal(good.done(after=b"x"))
    assert "outside of all entries" in refusal(good.done(before=b"hidden"))
    assert "fewer entries" in refusal(good.done(count=2))
    assert "outside of all entries" in refusal(good.done(count=0))
    assert "zip64" in refusal(good.done(count=0xFFFF))
    assert "its directory" in refusal(b"prefix" + good.done())
    assert "is truncated" in refusal(good.done()[:-5])
    # claimed size too small; too large; wrong checksum; invalid stream; bytes after the end of the stream
    for size, check, stream in (
        (len(text) - 1, crc, packed),
        (len(text) + 1, crc, packed),
        (4, crc, packed),
        (len(text), crc ^ 1, packed),
        (len(text), crc, b"\xff" * 20),
        (len(text), crc, packed + b"hidden"),
        (len(text), crc, packed[:-2]),
    ):
        lie = Raw()
        lie.local("a.yarc", stream, size, check)
        assert "isn't the" in refusal(lie.done()), (size, check, stream)
    claims = Raw()
    claims.local("a.yarc", packed, 4_000_000_000, crc)
    assert "at most 1,073,741,824" in refusal(claims.done())
    sum_ = Raw()
    for number in range(3):
        sum_.local(f"{number}", packed, 1_000_000_000, crc)
    assert "2,000,000,000 bytes together" in refusal(sum_.done())
    ratio = Raw()
    ratio.local("a", packed, 900_000_000, crc)
    assert "at most 200 times" in refusal(ratio.done())
    for flags, why in ((0x801, "encrypted"), (0x2800, "encrypted"), (0x820, "method 8")):
        one = Raw()
        one.local("a", packed, len(text), crc, flags=flags)
        assert why in refusal(one.done())
    for name, flags, why in ((b"\xff\xfe", 0x800, "UTF-8"), ("ä".encode(), 0, "UTF-8"),
        (b"a\0b", 0x800, "isn't the name"), (b"", 0x800, "isn't the name")):  # fmt: skip
        one = Raw()
        one.local(name, packed, len(text), crc, flags=flags)
        assert why in refusal(one.done()), name
    # The local header has another name, size or method than the directory.
    for offset, value in ((30, b"b"), (22, b"\1"), (8, b"\0")):
        raw = bytearray(good.done())
        raw[offset : offset + 1] = value
        assert "in its local header" in refusal(bytes(raw)), offset


def test_bombs_of_overlapping_entries():
    # "zbsm" bomb: many entries of the directory for the same bytes.
    kernel = deflated(b"\0" * 1_000_000)
    crc = zlib.crc32(b"\0" * 1_000_000)
    full = Raw()
    at = full.local("a", kernel, 1_000_000, crc)
    for number in range(100):
        full.row(f"a{number}".encode(), len(kernel), 1_000_000, crc, at)
    assert "shares bytes" in refusal(full.done())
    # Quoted overlap: the content of an entry is the local header of the next entry.
    quoted = Raw()
    first = quoted.local("a", b"", 0, 0, method=0)
    second = quoted.local("b", kernel, 1_000_000, crc)
    quoted.rows[0] = b""
    quoted.rows = [row for row in quoted.rows if row]
    quoted.row(b"a", len(quoted.body) - second, len(quoted.body) - second, 0, first, method=0)
    assert "in its local header" in refusal(quoted.done())


def test_a_hundred_thousand_entries_and_a_bomb_take_no_time(tmp_path):
    many = Raw()
    many.rows = [b"x" * 46] * 65_000
    assert "65,000 entries" in refusal(many.done())
    deep = deflated(b"\0" * 150_000_000)
    bomb = Raw()
    bomb.local("a", deep, 10_000, 0)
    tracemalloc.start()
    refusal(bomb.done())
    assert tracemalloc.get_traced_memory()[1] < 5e6
    tracemalloc.stop()


@settings(max_examples=300, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_a_zip_with_any_byte_turned_is_refused_or_the_same(data):
    whole = zip_of(("a.yarc", b"P0010 MOVEJ HOME\n" * 9), ("sub/b.toml", b"x = 1\n"))
    raw = bytearray(whole)
    for _ in range(data.draw(st.integers(1, 3))):
        place = data.draw(st.integers(0, len(raw) - 1))
        raw[place] = data.draw(st.integers(0, 255))
    raw = raw[: data.draw(st.integers(len(raw) - 3, len(raw)))]
    held = Zip(bytes(raw))
    try:
        found = judged(held.handle)
    except Trouble:
        return
    known = {hashlib.sha256(b"P0010 MOVEJ HOME\n" * 9).hexdigest(), hashlib.sha256(b"x = 1\n").hexdigest()}
    assert set(found.hashes.values()) <= known
    for entry in entries_of(held.handle, len(raw)):
        assert sum(map(len, content(held.handle, entry))) == entry.size


# errors while a backup is restored


def test_conflicts_with_what_is_there(tmp_path):
    folder = project(tmp_path, {"dir/x": b"1", "file": b"2", "Name": b"3"})
    (folder.root / "out").symlink_to("/tmp")
    backup = look(zip_of(("dir", b""), ("file/y", b""), ("name", b""), ("out/z", b""), ("ok", b"")))
    plan = plan_of(folder, backup)
    assert {one.file for one in plan.conflicts} == {"dir", "file/y", "name", "out/z"}
    before = contents(folder.root)
    with pytest.raises(Trouble, match="can't be restored"):
        apply(folder, 0, backup, plan.digest, "anna", ABOUT, remove=True)
    assert contents(folder.root) == before


def test_a_full_disk_in_the_middle(tmp_path, monkeypatch):
    folder = project(tmp_path, {f"{name}.yarc": b"new" * 1000 for name in "abcdef"})
    saved = backup_of(folder)
    for name in "abcdef":
        (folder.root / f"{name}.yarc").write_bytes(b"old")
    before, count = contents(folder.root), 0
    write = draft.Draft.write

    def full(self, data):
        nonlocal count
        count += 1
        if count == 3:
            raise OSError(errno.ENOSPC, "")
        write(self, data)

    with monkeypatch.context() as patch:
        patch.setattr(draft.Draft, "write", full)
        with pytest.raises(Trouble, match=r"2 of 6 files are restored.*no room"):
            restore(folder, saved)
    found = contents(folder.root)
    assert sorted(found.values()) == sorted([b"old"] * 4 + [b"new" * 1000] * 2)
    kept = folder.trash.kept()[0]
    restore(folder, (tmp_path / "data" / "trash" / kept.number / "content").read_bytes())
    assert contents(folder.root) == before
    # With too little space on the disk, the restore doesn't begin.
    with monkeypatch.context() as patch:
        patch.setattr(room, "KEPT", 1 << 60)
        with pytest.raises(Trouble, match=r"the restored files .* are free on the disk"):
            restore(folder, saved)
    assert contents(folder.root) == before


KILLED = """
import sys
from pathlib import Path
from yarclang.pendant.backup.applying import apply
from yarclang.pendant.backup.comparing import judged, plan_of
from yarclang.pendant.backup.writing import About
from yarclang.pendant.project.folder import ProjectFolder
top = Path(sys.argv[1])
folder = ProjectFolder(top / "project", top / "data" / "pendant.db")
with (top / "saved.zip").open("rb") as saved:
    backup = judged(saved.fileno())
    print("ready", flush=True)
    apply(folder, saved.fileno(), backup, plan_of(folder, backup).digest, "anna", About("1", "R", "f", "2026-01-02T03:04:05+00:00"), remove=True)
"""  # noqa: E501


def test_a_kill_in_the_middle_leaves_old_or_new(tmp_path):
    folder = project(tmp_path, {f"{number}.yarc": b"new" * 30_000 for number in range(300)})
    (tmp_path / "saved.zip").write_bytes(backup_of(folder))
    old = {f"{number}.yarc": b"old" for number in range(300)} | {"gone.yarc": b"extra"}
    halves = 0
    for count in (-1, 0, 100):
        for name, data in old.items():
            (folder.root / name).write_bytes(data)
        with subprocess.Popen(
            [sys.executable, "-c", KILLED, str(tmp_path)],
            stdout=subprocess.PIPE,
            cwd=Path(__file__).parents[1],
        ) as process:
            process.stdout.readline()
            end = time.monotonic() + 60.0
            while sum(one.stat().st_size > 10 for one in folder.root.glob("[0-9]*")) <= count and process.poll() is None:  # fmt: skip  # noqa: E501
                assert time.monotonic() < end
            process.send_signal(signal.SIGKILL)
            process.wait(30)
        again = ProjectFolder(folder.root, tmp_path / "data" / "pendant.db")
        found = contents(folder.root)
        assert all(found[f"{number}.yarc"] in (b"old", b"new" * 30_000) for number in range(300))
        halves += len(set(found.values()) - {b"extra"}) == 2
        if found != old:
            kept = again.trash.kept()[0]
            assert kept.file.startswith("before restore")
            restore(again, (tmp_path / "data" / "trash" / kept.number / "content").read_bytes())
        assert contents(folder.root) == old
    assert halves, "no kill came in the middle"


# over the API


def at(monkeypatch, tmp_path, work):
    place = tmp_path / "project"
    place.mkdir()
    (tmp_path / "state").mkdir()

    async def whole():
        async with pendant(monkeypatch, tmp_path / "state", project=place) as made:
            await work(made, place)

    run(whole())


def serviced(place, name="sam"):
    sam = place.logged_in(name, Role.SERVICE)
    sam.session.pin_until = 1e9
    return sam


def test_from_a_backup_to_its_undo(monkeypatch, tmp_path):
    async def work(place, folder):
        (folder / "a.yarc").write_text(PROGRAM)
        (folder / "yarc.toml").write_text("")
        sam = serviced(place)
        saved = await sam.get("/api/backup")
        assert (saved.status, saved.headers["content-type"]) == (200, "application/zip")
        (folder / "a.yarc").write_text("other")
        (folder / "b.yarc").write_text("new")
        (folder / "yarc.toml").unlink()
        plan = (await sam.post("/api/backup/upload", raw=saved.content)).told
        assert [(one["file"], one["what"]) for one in plan["files"]] == [("a.yarc", "changed"),
            ("b.yarc", "extra"), ("yarc.toml", "new")]  # fmt: skip
        assert (plan["restart"], plan["notes"], plan["robot"]) == (["yarc.toml"], [], "INDUSTRIAL6")
        wanted = {"number": plan["number"], "digest": plan["digest"], "remove": True}
        sam.session.pin_until = -1.0
        assert (await sam.post("/api/backup/restore", wanted)).told["code"] == "pin"
        sam.session.pin_until = 1e9
        (folder / "c.yarc").write_text("somebody else")
        refused = await sam.post("/api/backup/restore", wanted)
        assert (refused.status, refused.told["code"]) == (409, "changed")
        (folder / "c.yarc").unlink()
        done = await sam.post("/api/backup/restore", wanted)
        assert (done.told["written"], done.told["removed"], done.told["restart"]) == (2, 1, ["yarc.toml"])
        assert contents(folder) == {"a.yarc": PROGRAM.encode(), "yarc.toml": b""}
        about = (await sam.get("/api/backup/about")).told
        assert [one["number"] for one in about["undo"]] == [done.told["undo"]]
        assert "isn't in the project" in about["notes"][0]
        plan = (await sam.post("/api/backup/undo", {"number": done.told["undo"]})).told
        assert (plan["undoes"], plan["extra"], plan["changed"], plan["new"]) == (True, 1, 1, 1)
        wanted = {"number": plan["number"], "digest": plan["digest"], "remove": True}
        assert (await sam.post("/api/backup/restore", wanted)).status == 200
        assert contents(folder) == {"a.yarc": b"other", "b.yarc": b"new"}
        assert (await sam.post("/api/backup/restore", wanted)).told["code"] == "missing"
        deeds = [(action, outcome.partition(":")[0]) for _, action, _, outcome in place.deeds()]
        assert sorted(deeds) == [("backup", "done"), *[("restore", "done")] * 3, ("restore", "refused")]

    at(monkeypatch, tmp_path, work)


def test_only_service_and_only_at_rest(monkeypatch, tmp_path):
    async def work(place, folder):
        (folder / "a.yarc").write_text(PROGRAM)
        sam = serviced(place)
        saved = (await sam.get("/api/backup")).content
        pia = place.logged_in("pia", Role.PROGRAMMER)
        for method, path in (("GET", ""), ("GET", "/about"), ("POST", "/upload"), ("GET", "/plan"),
            ("POST", "/restore"), ("POST", "/undo"), ("POST", "/forget")):  # fmt: skip
            assert (await pia.ask(method, f"/api/backup{path}", raw=saved)).status == 403, path
        plan = (await sam.post("/api/backup/upload", raw=saved)).told
        await sam.post("/api/control")
        number = (await sam.order("load", file="a.yarc", approach=True)).told["program"]["number"]
        going = asyncio.ensure_future(sam.order("run", program=number))
        await asyncio.sleep(2.0)
        wanted = {"number": plan["number"], "digest": plan["digest"], "remove": False}
        refused = await sam.post("/api/backup/restore", wanted)
        assert (refused.status, refused.told["code"]) == (409, "Y1601"), refused.told
        await going
        assert (await sam.post("/api/backup/restore", wanted)).told["written"] == 0
        # sam can't restore an upload of tom's. The upload is discarded when tom's session ends.
        tom = serviced(place, "tom")
        plan = (await tom.post("/api/backup/upload", raw=saved)).told
        wanted["number"] = plan["number"]
        assert (await sam.post("/api/backup/restore", wanted)).told["code"] == "missing"
        await tom.post("/api/logout")
        assert place.service.backups._waiting is None

    at(monkeypatch, tmp_path, work)


def test_uploads_that_are_broken_off_or_come_together(monkeypatch, tmp_path):
    async def work(place, folder):
        sam = serviced(place)
        (folder / "a.yarc").write_text(PROGRAM)
        saved = (await sam.get("/api/backup")).content
        held = asyncio.Event()
        sent = []

        async def receive():
            if not sent:
                sent.append(1)
                return {"type": "http.request", "body": saved[:100], "more_body": True}
            await held.wait()
            return {"type": "http.disconnect"}

        answers = []

        async def send(message):
            answers.append(message)

        scope = scope_of("http", "/api/backup/upload", sam.headers(), "http", "POST")
        first = asyncio.ensure_future(place.app(scope, receive, send))
        await asyncio.sleep(0.1)
        assert (await sam.post("/api/backup/upload", raw=saved)).told["code"] == "busy"
        held.set()
        await first
        assert answers[0]["status"] == 409
        assert (await sam.post("/api/backup/upload", raw=saved[:-1])).told["code"] == "hostile"
        plan = (await sam.post("/api/backup/upload", raw=saved)).told
        assert plan["same"] == 1
        assert sorted(one.name for one in (tmp_path / "state").iterdir() if "restore" in one.name) == []
        # An upload that isn't restored is discarded after a time.
        monkeypatch.setattr(backups, "_WAITS", 2.0)
        await sam.post("/api/backup/upload", raw=saved)
        await asyncio.sleep(3.0)
        assert (await sam.get("/api/backup/plan")).told["code"] == "missing"

    at(monkeypatch, tmp_path, work)


def test_clients_that_stop_reading(monkeypatch, tmp_path):
    async def work(place, folder):
        (folder / "a.yarc").write_bytes(os.urandom(2_000_000))
        monkeypatch.setattr("yarclang.pendant.web.backup._SILENCE", 2.0)
        sam = serviced(place)

        async def send(message):
            if message["type"] == "http.response.body":
                await asyncio.Future()

        async def receive():
            return await asyncio.Future()

        scope = scope_of("http", "/api/backup", sam.headers(), "http", "GET")
        stuck = [asyncio.ensure_future(place.app(dict(scope), receive, send)) for _ in range(2)]
        await asyncio.sleep(0.1)
        assert (await sam.get("/api/backup")).told["code"] == "busy"
        await asyncio.sleep(3.0)
        assert all(one.done() for one in stuck)
        assert [one.exception() for one in stuck] == [None, None]
        assert (await sam.get("/api/backup")).status == 200
        assert [outcome for _, action, _,
            outcome in place.deeds() if action == "backup"].count("broken off") == 2  # fmt: skip

    at(monkeypatch, tmp_path, work)
