"""Tests of the changes since the last commit, and of hostile repositories that try to make git run
a program.
"""

import os
import shutil
import subprocess
from pathlib import Path

import pytest
from coordinator.virtual import run
from pendant.at_robot import pendant

from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.project import asking_git
from yarclang.pendant.project.folder import ProjectFolder
from yarclang.pendant.project.git import Git
from yarclang.runtime.actions import Trouble

pytestmark = pytest.mark.skipif(shutil.which("git") is None, reason="there is no git")

AUTHOR = {
    "GIT_AUTHOR_NAME": "Änne <x>", "GIT_AUTHOR_EMAIL": "a@example.org", "GIT_COMMITTER_NAME": "b",
    "GIT_COMMITTER_EMAIL": "b@example.org", "GIT_CONFIG_GLOBAL": "/dev/null", "GIT_CONFIG_NOSYSTEM": "1",
}  # fmt: skip


def git(folder, *words):
    return subprocess.run(
        ["git", "-C", str(folder), *words],
        env=os.environ | AUTHOR,
        check=True,
        capture_output=True,
        timeout=30,
    ).stdout.decode()


def repository(tmp_path, files=None):
    root = tmp_path / "project"
    root.mkdir()
    git(root, "init", "-q")
    for name, text in (files or {"a.yarc": "one\n", "sub/b c.yarc": "two\n", "程序.yarc": "three\n",
        ".gitignore": "*.log\n"}).items():  # fmt: skip
        (root / name).parent.mkdir(exist_ok=True)
        (root / name).write_text(text)
    git(root, "add", "-A")
    git(root, "commit", "-qm", "First\n\nMore")
    return root


def asked(tmp_path):
    return Git(ProjectFolder(tmp_path / "project", tmp_path / "state" / "pendant.db"))


def test_what_has_changed(tmp_path):
    root = repository(tmp_path)
    known = asked(tmp_path)
    state = known.state()
    assert (state.changes, state.commit.who, state.commit.subject) == ({}, "Änne x", "First")
    assert state.commit.when.endswith("+00:00")
    (root / "a.yarc").write_text("One\n")  # the length of the file stays the same
    (root / "sub" / "b c.yarc").unlink()
    (root / "new.yarc").write_text("")
    (root / "run.log").write_text("ignored")
    (root / "added").write_text("x")
    git(root, "add", "added")
    (root / "程序.yarc").write_bytes(b"three\r\n")  # other line endings don't count as a change
    assert known.state().changes == {
        "a.yarc": "changed",
        "added": "new",
        "new.yarc": "new",
        "sub/b c.yarc": "deleted",
    }
    assert known.difference("a.yarc") == ("one\n", "One\n")
    assert known.difference("new.yarc") == ("", "")
    assert known.difference("sub/b c.yarc") == ("two\n", "")
    with pytest.raises(Trouble):
        known.difference("gone")
    with pytest.raises(Trouble):
        known.difference("../a")
    inner = Git(
        ProjectFolder(root / "sub", tmp_path / "state" / "pendant.db")
    )  # the project is a subfolder of the repository
    assert inner.state().changes == {"b c.yarc": "deleted"}


def test_where_there_is_no_commit_or_no_repository(tmp_path):
    (tmp_path / "project").mkdir()
    known = asked(tmp_path)
    assert known.state() is None
    git(tmp_path / "project", "init", "-q")
    (tmp_path / "project" / "a.yarc").write_text("one\n")
    state = known.state()
    assert (state.commit, state.changes) == (None, {"a.yarc": "new"})
    with pytest.raises(Trouble, match="no commit"):
        known.difference("a.yarc")


@pytest.mark.parametrize(
    "trap",
    ["fsmonitor", "filter", "process", "textconv", "external", "hooks", "ssh", "pager", "promisor", "bare",
        "submodule", "signature", "alternates"],
)  # fmt: skip
def test_a_hostile_repository_runs_nothing(tmp_path, trap):
    """Each trap would create a file if git executed it."""
    canary = tmp_path / "canary"
    script = tmp_path / "script"
    script.write_text(f"#!/bin/sh\ntouch {canary}\ncat\n")
    script.chmod(0o755)
    root = repository(tmp_path)
    match trap:
        case "fsmonitor":
            git(root, "config", "core.fsmonitor", str(script))
        case "filter":
            for word in ("clean", "smudge"):
                git(root, "config", f"filter.evil.{word}", str(script))
            (root / ".git" / "info" / "attributes").write_text("* filter=evil\n")
        case "process":
            git(root, "config", "filter.evil.process", str(script))
            (root / ".gitattributes").write_text("* filter=evil\n")
        case "textconv":
            git(root, "config", "diff.evil.textconv", str(script))
            git(root, "config", "diff.evil.command", str(script))
            (root / ".gitattributes").write_text("* diff=evil\n")
        case "external":
            git(root, "config", "diff.external", str(script))
        case "hooks":
            git(root, "config", "core.hooksPath", str(tmp_path))
            for name in ("post-index-change", "reference-transaction", "pre-auto-gc", "fsmonitor-watchman"):
                shutil.copy(script, tmp_path / name)
        case "ssh":
            git(root, "config", "core.sshCommand", str(script))
            git(root, "remote", "add", "origin", "ssh://nowhere.example/x")
        case "pager":
            git(root, "config", "core.pager", str(script))
            git(root, "config", "pager.ls-tree", str(script))
        case "promisor":
            git(root, "config", "core.repositoryformatversion", "1")
            git(root, "config", "extensions.partialClone", "origin")
            git(root, "config", "remote.origin.url", f"ext::{script}")
            git(root, "config", "remote.origin.promisor", "true")
            git(root, "config", "protocol.ext.allow", "always")
            blob = git(root, "rev-parse", "HEAD:a.yarc").strip()
            (root / ".git" / "objects" / blob[:2] / blob[2:]).unlink()
        case "bare":  # a bare repository, made of files that a programmer could upload
            shutil.move(root / ".git", tmp_path / "bare")
            for one in (tmp_path / "bare").iterdir():
                shutil.move(one, root / one.name)
            with (root / "config").open("a") as file:
                file.write(f"[core]\n bare = false\n worktree = .\n fsmonitor = {script}\n")
        case "submodule":
            sub = root / "module"
            sub.mkdir()
            git(sub, "init", "-q")
            git(sub, "config", "core.fsmonitor", str(script))
            (sub / "x").write_text("x")
            git(sub, "add", "x")
            git(sub, "commit", "-qm", "x")
            git(root, "add", "module")
            git(root, "commit", "-qm", "module")
            canary.unlink(missing_ok=True)
        case "signature":
            git(root, "config", "gpg.program", str(script))
            git(root, "config", "log.showSignature", "true")
        case "alternates":
            git(root, "config", "core.alternateRefsCommand", str(script))
            (root / ".git" / "objects" / "info" / "alternates").write_text(f"{tmp_path}/none\n/dev/zero\n")
    (root / "a.yarc").write_text("One\n")
    known = asked(tmp_path)
    for do in (known.state, lambda: known.difference("a.yarc"), known.state):
        try:
            do()
        except Trouble as refused:
            told = refused.what
            assert "Traceback" not in told
    assert not canary.exists()


def test_a_folder_of_another_user(tmp_path, monkeypatch):
    if os.getuid() != 0:
        pytest.skip("only root can give a folder away")
    root = repository(tmp_path)
    for one in (root, root / ".git"):
        os.chown(one, 12345, 12345)
    monkeypatch.setenv("HOME", str(tmp_path))
    with pytest.raises(Trouble, match="another user") as refused:
        asked(tmp_path).state()
    assert "safe.directory" in refused.value.remedy


def test_git_that_hangs_floods_or_is_missing(tmp_path, monkeypatch):
    root = repository(tmp_path)
    known = asked(tmp_path)
    fake = tmp_path / "bin" / "git"
    fake.parent.mkdir()
    monkeypatch.setenv("PATH", f"{fake.parent}:{os.environ['PATH']}")
    for script, words in (("sleep 60 & sleep 60", "takes more"), ("yes", "outputs more than"),
        ("echo fatal: bad object >&2; exit 128", "bad object")):  # fmt: skip
        fake.write_text(f"#!/bin/sh\n{script}\n")
        fake.chmod(0o755)
        # On a busy computer it takes a while to start a program that replies.
        monkeypatch.setattr(asking_git, "_LONGEST", 0.5 if script.startswith("sleep") else 30.0)
        with pytest.raises(Trouble, match=words):
            known.state()
    monkeypatch.setenv("PATH", str(Path(root)))
    with pytest.raises(Trouble, match="isn't installed"):
        known.state()


def test_who_changed_what(monkeypatch, tmp_path):
    root = repository(tmp_path)
    (tmp_path / "state").mkdir()

    async def work():
        async with pendant(monkeypatch, tmp_path / "state", project=root) as place:
            pia, vic = place.logged_in("pia", Role.PROGRAMMER), place.logged_in("vic", Role.VIEWER)
            known = (await vic.get("/api/files/a.yarc")).told["sha256"]
            await pia.ask("PUT", "/api/files/a.yarc", {"text": "more\n", "known": known})
            await pia.ask(
                "PUT", "/api/files/a.yarc", {"text": "late\n", "known": known}
            )  # this request is refused, so it doesn't count as a change
            paul = place.logged_in("paul", Role.PROGRAMMER)
            await paul.post("/api/files/delete", {"file": "sub/b c.yarc"})
            await paul.ask("PUT", "/api/files/new.yarc", {"text": "", "known": None})
            await pia.ask("PUT", "/api/files/tried", {"text": "", "known": known})
            (root / "new.yarc").write_text("by an editor")
            (root / "other.yarc").write_text("")
            told = (await vic.get("/api/git")).told
            assert told["there"], told
            assert told["commit"]["subject"] == "First"
            assert [(one["file"], one["kind"], one["by"], one["outside"]) for one in told["changes"]] == [
                ("a.yarc", "changed", ["pia"], False),
                ("new.yarc", "new", ["paul"], True),
                ("other.yarc", "new", [], True),
                ("sub/b c.yarc", "deleted", ["paul"], False),
            ]
            told = (await vic.get("/api/git/difference/a.yarc")).told
            assert (told["base"], told["text"]) == ("one\n", "more\n")

    run(work())
