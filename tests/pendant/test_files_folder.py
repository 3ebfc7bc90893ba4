"""Tests of the project's folder: no path leads out of it, no file is lost, and deleted files can
be restored.
"""
# ruff: noqa: PTH105, PTH115, PTH118, PTH119, PTH120, PTH208, PTH211 - the system is asked by itself, apart from the class and its ways

import errno
import os
import stat
import threading
import unicodedata
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as some

from yarclang.pendant.project import draft, folder, trash
from yarclang.pendant.project.folder import Changed, ProjectFolder
from yarclang.pendant.project.names import MOST_PATH
from yarclang.runtime.actions import Trouble

SECRET = b"secret of another folder"


def made(tmp_path, data="state"):
    """Return a project's folder that contains traps, such as links to a secret file outside."""
    root = tmp_path / "project"
    (root / "sub" / "deep").mkdir(parents=True)
    (root / ".git").mkdir()
    (root / ".git" / "config").write_bytes(SECRET)
    (root / "a.yarc").write_bytes(b"a")
    (root / "sub" / "b.yarc").write_bytes(b"b")
    outside = tmp_path / "outside"
    outside.mkdir()
    (outside / "secret").write_bytes(SECRET)
    (root / "link").symlink_to(outside / "secret")
    (root / "out").symlink_to(outside)
    (root / "up").symlink_to("..")
    (root / "sub" / "round").symlink_to("../sub")
    (root / "loop").symlink_to("loop")
    (root / "inner").symlink_to("sub")
    (root / "hidden").symlink_to(".git")
    os.mkfifo(root / "pipe")
    database = tmp_path / data / "pendant.db"
    database.parent.mkdir(parents=True, exist_ok=True)
    database.write_bytes(SECRET)
    return ProjectFolder(root, database)


WORDS = [
    "",
    ".",
    "..",
    "sub",
    "deep",
    "a.yarc",
    "b.yarc",
    "link",
    "out",
    "up",
    "round",
    "loop",
    "inner",
    "hidden",
    "pipe",
]
WORDS += [".git", "config", "secret", "project", "outside", "state", "pendant.db", "x\0", "é", "e\u0301",
    "\udcff", "\n", "~", "%2e%2e", "..\\.."]  # fmt: skip
NAMES = some.lists(some.sampled_from(WORDS) | some.text(max_size=4), min_size=1, max_size=6)


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(NAMES, some.sampled_from(["", "/", "//", "{root}/", "{outside}/"]), NAMES)
def test_no_path_leads_out(tmp_path_factory, parts, start, more):
    """Files are read, written, renamed and deleted only in the project; other paths are refused. The
    operating system decides which paths are in the project.
    """
    tmp_path = tmp_path_factory.getbasetemp() / "paths"
    if not tmp_path.exists():
        tmp_path.mkdir()
        made(tmp_path)
    project = ProjectFolder(tmp_path / "project", tmp_path / "state" / "pendant.db")
    name = start.format(root=project.root, outside=tmp_path / "outside") + "/".join(parts)
    allowed = is_inside(project.root, name)
    for do in (
        lambda: project.read(name)[0],
        lambda: project.write(name, b"mine", None),
        lambda: project.copy(name, f"copy-{os.urandom(4).hex()}").size,
        lambda: project.make_folder(name),
        lambda: project.rename("a.yarc", name),
        lambda: project.rename("/".join(more), name),
        lambda: project.restore(project.delete(name, "eve").number),
    ):
        try:
            told = do()
        except Trouble:
            continue
        assert allowed, name
        assert told != SECRET
    assert (tmp_path / "outside" / "secret").read_bytes() == SECRET
    assert (tmp_path / "project" / ".git" / "config").read_bytes() == SECRET
    assert (tmp_path / "state" / "pendant.db").read_bytes() == SECRET
    assert sorted(os.listdir(tmp_path)) == ["outside", "project", "state"]
    assert os.listdir(tmp_path / "outside") == ["secret"]


def is_inside(root, name):
    """Return True if a path is in the project according to the operating system. This doesn't use the tested
    code.
    """
    if "\0" in name or name.startswith("/") or any(one in ("", ".", "..") for one in name.split("/")):
        return False
    try:
        parent = os.path.realpath(os.path.join(root, os.path.dirname(name)))
        last = os.path.basename(name).encode()
    except (OSError, ValueError):
        return False
    inside = (parent + "/").startswith(str(root) + "/")
    return inside and "/." not in parent[len(str(root)) :] and not last.startswith(b".")


@pytest.mark.parametrize("name", ["a.yarc", "sub/b.yarc", "inner/b.yarc", "sub/round/b.yarc"])
def test_what_is_inside_is_read(tmp_path, name):
    assert made(tmp_path).read(name)[0] in (b"a", b"b")


def test_a_folder_that_becomes_a_link_meanwhile(tmp_path):
    """While files in a folder are read and written, another thread replaces the folder by a link that leads
    out, thousands of times.
    """
    project = made(tmp_path)
    there, ends = project.root / "swap", threading.Event()
    (tmp_path / "outside" / "file").write_bytes(SECRET)
    real = project.root / "real"
    real.mkdir()
    (real / "file").write_bytes(b"mine")
    there.symlink_to("real")

    def exchange():
        count = 0
        while not ends.is_set():
            os.symlink("../outside" if count % 2 else "real", project.root / "next")
            os.replace(project.root / "next", there)
            count += 1

    thread = threading.Thread(target=exchange)
    thread.start()
    try:
        read = set()
        for count in range(1000):
            try:
                read.add(project.read("swap/file")[0])
                project.write(f"swap/new{count}", b"mine", None)
            except Trouble:
                read.add(None)
    finally:
        ends.set()
        thread.join(10.0)
    assert read == {b"mine", None}
    assert sorted(os.listdir(tmp_path / "outside")) == ["file", "secret"]


@pytest.mark.parametrize("data", ["project/data", "project", "project/sub/deep"])
def test_the_pendants_own_files_are_out_of_reach(tmp_path, data):
    project = made(tmp_path, data)
    inside = (data + "/pendant.db").removeprefix("project/")
    top = inside.partition("/")[0]
    (project.root / "hard").hardlink_to(tmp_path / data / "pendant.db")
    listed = [one.file for one in project.entries(1000)[0]]
    assert inside not in listed
    assert "hard" not in listed
    with pytest.raises(Trouble, match="pendant itself"):
        project.path(inside)
    for name in (inside, "hard", top):
        for do in (
            lambda name=name: project.read(name),
            lambda name=name: project.write(name, b"", None),
            lambda name=name: project.rename(name, "other"),
            lambda name=name: project.delete(name, "eve"),
        ):
            with pytest.raises(Trouble):
                do()
    with pytest.raises(Trouble):
        project.write(inside.replace(".db", ".db-wal"), b"", None)
    assert (tmp_path / data / "pendant.db").read_bytes() == SECRET


@pytest.mark.parametrize(
    "name",
    ["x" * 256, "é" * 128, ("a\n"
        "b"), "a\x1b[31m", "con ", " a", "end.", ".git", ".hidden/a", "a\u202eb", "\u200b.git", "a\\b",
            "x/" * 600 + "y"],
)  # fmt: skip
def test_names_that_nothing_new_gets(tmp_path, name):
    project = made(tmp_path)
    for do in (
        lambda: project.write(name, b"", None),
        lambda: project.make_folder(name),
        lambda: project.rename("a.yarc", name),
        lambda: project.copy("a.yarc", name),
    ):
        with pytest.raises(Trouble) as refused:
            do()
        assert "\n" not in refused.value.what
        assert "\x1b" not in refused.value.what


@pytest.mark.parametrize(
    "name",
    ["Ünïcode.yarc", "程序.yarc", "برنامج.yarc", "می‌خواهم.yarc", "👩‍🔧.yarc", "n" * 255, "é" * 127, "-r", "a b",  # noqa: E501
        "$(x)", "'\";--"],
)  # fmt: skip
def test_names_in_any_script(tmp_path, name):
    project = made(tmp_path)
    told = project.write(name, b"text", None)
    project.write(name, b"more", told.sha256)
    assert name in [one.file for one in project.entries(1000)[0]]
    project.rename(name, "sub/other")
    assert project.read("sub/other")[0] == b"more"
    number = project.delete("sub/other", "anna").number
    assert project.restore(number) == "sub/other"


def test_twins_of_names_are_refused(tmp_path):
    """A new file is refused if its name looks like that of another file, here or on another
    operating system.
    """
    project = made(tmp_path)
    project.write("Straße é.yarc", b"", None)
    for twin in (unicodedata.normalize("NFD", "Straße é.yarc"), "STRASSE É.yarc", "straße é.YARC"):
        with pytest.raises(Trouble, match="looks like"):
            project.write(twin, b"", None)
    project.rename("Straße é.yarc", "strasse é.yarc")  # another form of the file's own name is allowed
    assert "strasse é.yarc" in os.listdir(project.root)


def test_only_what_is_known_is_replaced(tmp_path):
    project = made(tmp_path)
    (project.root / "a.yarc").chmod(0o640)
    known = project.read("a.yarc")[1].sha256
    told = project.write("a.yarc", b"second", known)
    assert stat.S_IMODE((project.root / "a.yarc").stat().st_mode) == 0o640
    for wrong in (known, None):
        with pytest.raises(Changed) as refused:
            project.write("a.yarc", b"third", wrong)
        assert refused.value.sha256 == told.sha256
    with pytest.raises(Trouble, match="deleted meanwhile"):
        project.write("gone.yarc", b"", known)
    assert project.read("a.yarc")[0] == b"second"


def test_what_is_changed_is_kept_as_it_was(tmp_path, monkeypatch):
    files = made(tmp_path)
    known = files.read("sub/b.yarc")[1].sha256
    with pytest.raises(Changed):
        files.change("sub/b.yarc", b"new", "0" * 64, "anna")
    assert files.trash.kept() == ()
    files.change("sub/b.yarc", b"new", known, "anna")
    assert files.read("sub/b.yarc")[0] == b"new"
    (kept,) = files.trash.kept()
    assert (kept.file, kept.user, kept.is_folder) == ("sub/b.yarc", "anna", False)
    assert files.restore(kept.number) == "sub/b (2).yarc"
    assert files.read("sub/b (2).yarc")[0] == b"b"
    # If the old version can't be saved, the file isn't changed.
    known = files.read("sub/b.yarc")[1].sha256

    def full(*_):
        raise OSError(errno.ENOSPC, "")

    monkeypatch.setattr(trash, "_write", full)
    with pytest.raises(Trouble):
        files.change("sub/b.yarc", b"newer", known, "anna")
    assert files.read("sub/b.yarc")[0] == b"new"


def test_of_two_who_save_at_once_one_wins(tmp_path):
    project = made(tmp_path)
    for known in (project.read("a.yarc")[1].sha256, None):
        name = "a.yarc" if known else "new.yarc"
        start, won, lost = threading.Barrier(8), [], []

        def save(number, name=name, known=known, start=start, won=won, lost=lost):
            start.wait(10.0)
            try:
                won.append(project.write(name, b"text %d" % number, known).sha256)
            except Changed as refused:
                lost.append(refused.sha256)

        threads = [threading.Thread(target=save, args=(number,)) for number in range(8)]
        for one in threads:
            one.start()
        for one in threads:
            one.join(20.0)
        assert len(won) == 1
        assert lost == won * 7
        assert project.read(name)[1].sha256 == won[0]


def test_nothing_is_overwritten(tmp_path):
    project = made(tmp_path)
    for do in (
        lambda: project.rename("a.yarc", "sub/b.yarc"),
        lambda: project.copy("a.yarc", "sub/b.yarc"),
        lambda: project.rename("sub", "sub/deep/sub"),
        lambda: project.rename("sub/deep", "inner"),
        lambda: project.make_folder("sub"),
        lambda: project.rename("gone", "x"),
        lambda: project.rename("pipe", "x"),
        lambda: project.delete("gone", "anna"),
        lambda: project.write("nowhere/x", b"", None),
    ):
        with pytest.raises(Trouble):
            do()
    assert (project.read("a.yarc")[0], project.read("sub/b.yarc")[0]) == (b"a", b"b")


@pytest.mark.parametrize(("number", "words"),
    [(errno.ENOSPC, "no room"), (errno.EROFS, "read-only"), (errno.EACCES, "permission"),
        (errno.EIO, "reading or writing failed")])  # fmt: skip
@pytest.mark.parametrize("where", ["write", "fsync", "replace", "link", "rename", "open"])
def test_a_disk_that_fails(tmp_path, monkeypatch, number, words, where):
    """An error of the disk gives one clear message, and no file is lost."""
    project = made(tmp_path)
    before = sorted(os.listdir(project.root))
    known = project.read("a.yarc")[1].sha256
    real = getattr(os, where)

    def failing(*arguments, **named):
        reads = where == "open" and not arguments[1] & os.O_WRONLY
        if reads or (where == "fsync" and stat.S_ISDIR(os.fstat(arguments[0]).st_mode)):
            return real(*arguments, **named)
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(os, where, failing)
    refused = []
    for do in (
        lambda: project.write("a.yarc", b"second", known),
        lambda: project.write("new.yarc", b"first", None),
        lambda: project.copy("a.yarc", "copy.yarc"),
        lambda: project.rename("sub", "other"),
        lambda: project.delete("a.yarc", "anna"),
    ):
        try:
            do()
        except Trouble as trouble:
            refused.append(trouble.what)
    monkeypatch.undo()
    assert len(refused) >= (1 if where in ("rename", "replace") else 2)
    assert all(words in one for one in refused)
    gone = {one.file for one in project.trash.kept()}
    found = set(os.listdir(project.root))
    assert not [one for one in found if one.startswith(".yarc")]
    assert found | gone | ({"sub"} if "other" in found else set()) >= set(before)
    if "a.yarc" in found:
        assert project.read("a.yarc")[0] in (b"a", b"second")


def test_without_files_without_names(tmp_path, monkeypatch):
    """Everything works on a file system that supports neither unnamed files nor hard links."""
    project = made(tmp_path)
    monkeypatch.setattr(draft, "_NAMELESS", 0)

    def refused(*_, **__):
        raise OSError(errno.EPERM, "no links here")

    monkeypatch.setattr(os, "link", refused)
    told = project.write("new.yarc", b"first", None)
    with pytest.raises(Changed):
        project.write("new.yarc", b"third", None)
    project.write("new.yarc", b"second", told.sha256)
    project.rename("new.yarc", "sub/new.yarc")
    with pytest.raises(Trouble):
        project.rename("a.yarc", "sub/new.yarc")
    assert project.read("sub/new.yarc")[0] == b"second"
    assert not [one for one in os.listdir(project.root) if one.startswith(".yarc")]


@pytest.mark.parametrize("other_disk", [False, True])
def test_what_was_deleted_comes_back_after_a_restart(tmp_path, monkeypatch, other_disk):
    project = made(tmp_path)
    (project.root / "sub" / "b.yarc").chmod(0o755)
    if other_disk:
        real = os.rename

        def rename(old, new, *, src_dir_fd=None, dst_dir_fd=None):
            if trash._CONTENT in (old, new) and not str(old).endswith(".part"):
                raise OSError(errno.EXDEV, "another disk")
            real(old, new, src_dir_fd=src_dir_fd, dst_dir_fd=dst_dir_fd)

        monkeypatch.setattr(os, "rename", rename)
    first = project.delete("sub", "anna").number
    assert not (project.root / "sub").exists()
    assert (tmp_path / "outside" / "secret").exists()
    again = ProjectFolder(project.root, tmp_path / "state" / "pendant.db")
    assert [(one.file, one.user, one.is_folder) for one in again.trash.kept()] == [("sub", "anna", True)]
    again.make_folder("sub")
    assert again.restore(first) == "sub (2)"
    assert again.read("sub (2)/b.yarc")[0] == b"b"
    assert stat.S_IMODE((project.root / "sub (2)" / "b.yarc").stat().st_mode) == 0o755
    assert os.readlink(project.root / "sub (2)" / "round") == "../sub"
    with pytest.raises(Trouble, match="this file is no longer kept"):
        again.restore(first)
    for number in ("", "..", "../../project", "/"):
        with pytest.raises(Trouble):
            again.restore(number)
    number = again.delete("link", "anna").number  # deletes the link, not its target
    assert (tmp_path / "outside" / "secret").read_bytes() == SECRET
    assert again.restore(number) == "link"
    assert not [one for one in os.listdir(project.root) if one.startswith(".yarc")]


@pytest.mark.parametrize("at", ["before", "while"])
def test_a_deletion_that_is_killed_halfway(tmp_path, monkeypatch, at):
    """If the computer is switched off during a deletion, the hidden file reappears after the next start."""
    project = made(tmp_path)

    class Off(BaseException):
        pass

    def off(*_, **__):
        raise Off

    monkeypatch.setattr(trash, "_write" if at == "before" else "carried", off)
    real, dead = os.rename, []

    def rename(old, new, **named):
        if dead or new == trash._CONTENT:
            dead.append(new)
            raise Off if len(dead) > 1 else OSError(errno.EXDEV, "another disk")
        real(old, new, **named)

    monkeypatch.setattr(os, "rename", rename)
    monkeypatch.setattr(trash.shutil, "rmtree", lambda *_, **__: None)
    with pytest.raises(Off):
        project.delete("sub", "anna")
    monkeypatch.undo()
    again = ProjectFolder(project.root, tmp_path / "state" / "pendant.db")
    assert again.read("sub/b.yarc")[0] == b"b"
    assert again.trash.kept() == ()
    assert os.listdir(tmp_path / "state" / "trash") == []


def test_what_is_kept_is_bounded(tmp_path, monkeypatch):
    project = made(tmp_path)
    monkeypatch.setattr(trash, "MOST_KEPT", 5)
    monkeypatch.setattr(trash, "MOST_SIZE", 20)
    monkeypatch.setattr(trash, "LARGEST", 10)
    for number in range(8):
        project.write(f"{number}", b"xyz", None)
        project.delete(f"{number}", "anna")
    assert [one.file for one in project.trash.kept()] == ["7", "6", "5", "4", "3"]
    for number in (10, 11):
        project.write(f"{number}", b"0123456789", None)
        project.delete(f"{number}", "anna")
    assert [one.file for one in project.trash.kept()] == ["11", "10"]
    project.write("large", b"0123456789x", None)
    with pytest.raises(Trouble, match="kept for undo"):
        project.delete("large", "anna")
    assert project.read("large")[0] == b"0123456789x"
    monkeypatch.setattr(trash, "MOST_AGE", -1.0)
    assert ProjectFolder(project.root, tmp_path / "state" / "pendant.db").trash.kept() == ()


def test_what_is_listed(tmp_path, monkeypatch):
    project = made(tmp_path)
    (project.root / os.fsdecode(b"\xff.yarc")).write_bytes(b"")
    (project.root / "loop.yarc").symlink_to("loop.yarc")
    (project.root / "to_b.yarc").symlink_to("sub/b.yarc")
    listed = [one.file for one in project.entries(1000)[0]]
    assert listed == ["a.yarc", "sub", "sub/b.yarc", "sub/deep", "to_b.yarc"]
    assert project.entries(2)[1]
    monkeypatch.setattr("yarclang.pendant.project.tree.MOST_SEEN", 3)
    deep = project.root / Path(*["d"] * 100)
    deep.mkdir(parents=True)
    assert project.entries(1000)[1]


def test_a_folder_of_very_many_files_is_cut(tmp_path, monkeypatch):
    project = made(tmp_path)
    monkeypatch.setattr("yarclang.pendant.project.tree.MOST_IN_FOLDER", 500)
    for number in range(1500):
        os.close(os.open(project.root / "sub" / f"{number}.txt", os.O_CREAT))
    found, cut = project.entries(10_000)
    assert (len(found) < 520, cut) == (True, True)
    assert (len(project.entries(100)[0]), project.entries(100)[1]) == (100, True)
    assert [one.file for one in project.programs(10)[0]] == ["a.yarc", "sub/b.yarc"]


def test_large_and_changing_files(tmp_path):
    project = made(tmp_path)
    with (project.root / "huge").open("wb") as file:
        file.truncate(1 << 40)
    with pytest.raises(Trouble, match="at most 1,048,576") as refused:
        project.read("huge")
    assert refused.value.code == "large"
    with pytest.raises(Trouble):
        project.copy("huge", "copy")
    with pytest.raises(Trouble, match="kept for undo"):
        project.delete("huge", "anna")
    assert folder.MOST_TEXT == 1 << 20
    assert MOST_PATH < 4096
