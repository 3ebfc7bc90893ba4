"""Tests of a page's analyst (language server): the filter of its messages, attacks on the filter, and the
life of the analyst's process.
"""

import contextlib
import json
import os
import signal
import time
from pathlib import Path

import pytest
from coordinator.virtual import run
from hypothesis import given, settings
from hypothesis import strategies as st
from pendant.at_robot import pendant
from pendant.process import PASSWORD, Api, first, serving

from yarclang.highlight.words import words
from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.passing import MOST_ASKED, MOST_OPEN, NOTIFICATIONS, REQUESTS, Passing
from yarclang.runtime.actions import Trouble

WRONG = "P0010 MOVEJ 20 0 0 0 30 0 [6] (deg,s)\nP0020 MOVEJ HOEM [6] (deg,s)\n"


def inside_of(folder):
    def inside(name):
        place = (folder / name).resolve()
        if not place.is_relative_to(folder):
            raise Trouble("outside", "", "")
        return place

    return inside


def said(method, params=None, number=None):
    content = {"jsonrpc": "2.0", "method": method, "params": params or {}}
    return json.dumps(content if number is None else content | {"id": number})


def opening(uri, text=WRONG):
    return said("textDocument/didOpen", {"textDocument": {"uri": uri, "version": 1, "text": text}})


@pytest.fixture
def passing(tmp_path):
    folder = (tmp_path / "project").resolve()
    folder.mkdir()
    (tmp_path / "secret.yarc").write_text("")
    (folder / "link.yarc").symlink_to(tmp_path / "secret.yarc")
    made = Passing(folder, inside_of(folder))
    made.folder = folder
    return made


@pytest.mark.parametrize(
    "uri",
    [
        "file:///etc/passwd",
        "file:///etc/passwd.yarc",
        "yarc:///../secret.yarc",
        "yarc:///%2e%2e/secret.yarc",
        "yarc:///a/%2E%2E/%2e%2e/secret.yarc",
        "yarc:////etc/secret.yarc",
        "yarc:///%2fetc/secret.yarc",
        "yarc:///link.yarc",
        "yarc://host/a.yarc",
        "yarc:///a.yarc?x",
        "yarc:///a.yarc#x",
        "yarc:///a.toml",
        "yarc:///%ff.yarc",
        "yarc:///%00.yarc",
        "yarc:a.yarc",
        "yarc://[/a.yarc",
        "http://localhost/a.yarc",
        "untitled:a.yarc",
        "/a.yarc",
        "",
        "yarc:///" + "a" * 5000 + ".yarc",
    ],
)
def test_files_elsewhere_are_refused(passing, uri):
    """A page can neither open files outside of the project, nor ask about a file that it hasn't opened."""
    with pytest.raises((Trouble, ValueError)) as refused:
        passing.to_analyst(opening(uri))
    assert isinstance(refused.value, Trouble) or "null" in str(refused.value)
    with pytest.raises(Trouble):
        passing.to_analyst(
            said(
                "textDocument/hover",
                {"textDocument": {"uri": uri}, "position": {"line": 0, "character": 0}},
                1,
            )
        )


@pytest.mark.parametrize(
    "text",
    [
        "",
        "nonsense",
        "[]",
        "null",
        "{}",
        '{"method": 7}',
        '{"method": "textDocument/hover", "params": {}}',
        "[" * 100_000,
        '{"method": "initialize", "params": ' + '{"a":' * 5000 + "1" + "}" * 5000 + "}",
        '{"method": "\\ud800"}',
        said("workspace/executeCommand", {"command": "yarc.view"}, 1),
        said("workspace/didChangeWatchedFiles", {}),
        said("workspace/didChangeWorkspaceFolders", {}),
        said("textDocument/definition", {}, 1),
        said("completionItem/resolve", {}, 1),
        said("shutdown", {}, 1),
        said("exit"),
        said("initialize", {"rootUri": "file:///", "capabilities": {}}, 1),
        said("initialize"),
        said("initialized", {}, 1),
        said("textDocument/didOpen", {"textDocument": {"uri": "yarc:///a.yarc", "version": 1}}),
        said("textDocument/didOpen", {"textDocument": {"uri": "yarc:///a.yarc", "version": -1, "text": ""}}),
        said("$/cancelRequest", {"id": 1e300}),
        said("$/cancelRequest", {"id": True}),
    ],
)
def test_other_messages_are_refused(passing, text):
    with pytest.raises(Trouble) as refused:
        passing.to_analyst(text)
    assert len(refused.value.what) < 300


WORDS = st.sampled_from(
    [*REQUESTS, *NOTIFICATIONS, "exit", "uri", "text", "textDocument", "position", "yarc:///a.yarc"]
)
VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=5) | WORDS,
    lambda one: st.lists(one, max_size=4) | st.dictionaries(WORDS | st.text(max_size=5), one, max_size=5),
    max_leaves=12,
)


@given(st.sampled_from([*REQUESTS, *NOTIFICATIONS]), VALUES, st.none() | st.integers(-2, 2))
@settings(max_examples=300, deadline=None)
def test_whatever_passes_is_about_files_of_the_project(method, params, number):
    """Any message is either refused, or passed to the analyst with no other files than those that the page
    has open.
    """
    folder = Path("/nowhere/project")
    passing = Passing(folder, inside_of(folder))
    content = {"method": method, "params": params} | ({} if number is None else {"id": number})
    try:
        made = passing.to_analyst(json.dumps(content))
    except Trouble:
        return
    assert made["method"] in (*REQUESTS, *NOTIFICATIONS)
    uri = made["params"].get("textDocument", {}).get("uri")
    assert uri is None or uri == (folder / "a.yarc").as_uri()


def test_bounds(passing):
    for number in range(MOST_OPEN):
        made = passing.to_analyst(opening(f"yarc:///{number}/%C3%A4 %25.yarc"))
        assert made["params"]["textDocument"]["uri"] == (passing.folder / str(number) / "ä %.yarc").as_uri()
    with pytest.raises(Trouble, match="are open"):
        passing.to_analyst(opening("yarc:///more.yarc"))
    asked = {"textDocument": {"uri": "yarc:///0/%C3%A4 %25.yarc"}}
    for number in range(MOST_ASKED):
        passing.to_analyst(said("textDocument/formatting", asked, number))
    with pytest.raises(Trouble, match="too many requests"):
        passing.to_analyst(said("textDocument/formatting", asked, 1000))


def test_what_an_analyst_says_is_for_its_page_alone(passing):
    place = passing.to_analyst(opening("yarc:///a.yarc"))["params"]["textDocument"]["uri"]
    ask = {
        "textDocument": {"uri": "yarc:///a.yarc"},
        "range": {"start": {"line": 0, "character": 0}, "end": {"line": 0, "character": 1}},
    }
    passing.to_analyst(said("textDocument/codeAction", ask, 5))
    edit = {"changes": {place: [{"range": ask["range"], "newText": "x"}]}}
    actions = [
        {"title": "good", "edit": edit},
        {"title": "runs", "edit": edit, "command": {"command": "x", "title": "x"}},
        {"title": "elsewhere", "edit": {"changes": {"file:///etc/passwd": []}}},
        {"title": "both", "edit": {"changes": edit["changes"] | {"file:///etc/passwd": []}}},
        {"title": "makes files", "edit": {"documentChanges": [{"kind": "create", "uri": place}]}},
        {"title": "nothing"},
    ]
    told = passing.to_page({"id": 5, "result": actions})
    assert [one["title"] for one in told["result"]] == ["good"]
    assert list(told["result"][0]["edit"]["changes"]) == ["yarc:///a.yarc"]
    # the request with this id has been answered before
    assert passing.to_page({"id": 5, "result": actions}) is None
    finding = {
        "range": ask["range"],
        "message": f"{passing.folder}/b.yarc:3: wrong",
        "code": "Y1",
        "severity": 1,
    }
    publish = "textDocument/publishDiagnostics"
    told = passing.to_page({"method": publish, "params": {"uri": place, "diagnostics": [finding]}})
    assert told["params"]["uri"] == "yarc:///a.yarc"
    assert told["params"]["diagnostics"][0]["message"] == "b.yarc:3: wrong"
    assert (
        passing.to_page({"method": publish, "params": {"uri": "file:///b.yarc", "diagnostics": []}}) is None
    )
    show = {"method": "window/showDocument", "id": 1, "params": {"uri": "http://evil.example"}}
    assert passing.to_page(show) is None
    assert passing.reply(show)["error"]


def test_roles_and_words(monkeypatch, tmp_path):
    async def whole():
        async with pendant(monkeypatch, tmp_path) as place:
            viewer = place.logged_in("vera", Role.VIEWER)
            told = (await viewer.get("/api/language")).told
            assert tuple(told["commands"]) == words().commands
            nobody = place.browser()
            assert (await nobody.get("/api/language")).status == 401
            for browser, code in (
                (viewer, 4403),
                (place.logged_in("olaf", Role.OPERATOR), 4403),
                (nobody, 4401),
            ):
                socket = browser.socket("/api/analyst")
                assert await socket.hear() is None
                assert socket.code == code

    run(whole())


# the process


class Page:
    """A page's end of the WebSocket."""

    def __init__(self, api):
        self.line = api.socket("/api/analyst")

    def say(self, text):
        self.line.send(text)

    def until(self, method, within=60.0, **wanted):
        end = time.monotonic() + within
        while True:
            told = json.loads(self.line.recv(timeout=max(0.0, end - time.monotonic())))
            if told.get("method") == method and wanted.items() <= told["params"].items():
                return told["params"]
            if method == "answer" and "id" in told:
                return told

    def begin(self, uri="yarc:///bend.yarc", text=WRONG):
        self.until("yarc/begun")
        self.say(said("initialize", number=0))
        self.until("answer")
        self.say(said("initialized"))
        self.say(opening(uri, text))

    def findings(self):
        found = self.until("textDocument/publishDiagnostics")
        while not found["diagnostics"]:
            found = self.until("textDocument/publishDiagnostics")
        return found


def begun(api):
    """Return a page that has an analyst. Try again for a while, because the place of an analyst that has
    ended becomes free only a moment later.
    """
    from websockets.exceptions import ConnectionClosed

    for _ in range(100):
        page = Page(api)
        with contextlib.suppress(ConnectionClosed):
            page.until("yarc/begun")
            return page
        time.sleep(0.1)
    raise AssertionError("no place has become free")


def analysts_of(process):
    """Return the analysts among the child processes of a pendant."""
    found = []
    for place in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError, IndexError):
            status = (place / "stat").read_text().rpartition(")")[2].split()
            if (
                int(status[1]) == process.pid
                and status[0] != "Z"
                and b"\0lsp\0" in (place / "cmdline").read_bytes()
            ):
                found.append(int(place.name))
    return found


def none_left(process):
    end = time.monotonic() + 10.0
    while analysts_of(process):
        assert time.monotonic() < end
        time.sleep(0.05)


def test_the_life_of_analysts(tmp_path):
    from websockets.exceptions import ConnectionClosed

    with serving(tmp_path) as (url, token, process):
        anna = first(url, token)
        page = Page(anna)
        page.begin()
        found = page.findings()
        assert (found["uri"], found["version"]) == ("yarc:///bend.yarc", 1)
        assert any("HOEM" in one["message"] for one in found["diagnostics"])
        (pid,) = analysts_of(process)
        assert os.getpriority(os.PRIO_PROCESS, pid) == 10
        line = found["diagnostics"][0]["range"]
        page.say(
            said("textDocument/codeAction", {"textDocument": {"uri": "yarc:///bend.yarc"}, "range": line}, 1)
        )
        fixes = page.until("answer")["result"]
        assert "HOME" in fixes[0]["edit"]["changes"]["yarc:///bend.yarc"][0]["newText"]
        # A request that pages may not send is refused, and the page can continue.
        page.say(said("workspace/executeCommand", {"command": "x"}, 2))
        assert "isn't accepted from pages" in page.until("yarc/refused")["error"]
        page.say("{" * 100_000)
        page.until("yarc/refused")
        # A second page gets an analyst of its own. An analyst that is killed is restarted, but only once.
        other = Page(anna)
        other.begin("yarc:///other.yarc")
        other.findings()
        both = analysts_of(process)
        assert len(both) == 2
        os.kill(pid, signal.SIGKILL)
        page.begin()
        assert page.findings()["diagnostics"]
        (again,) = set(analysts_of(process)) - set(both)
        os.kill(again, signal.SIGKILL)
        assert "ended twice" in page.until("yarc/ended")["text"]
        with pytest.raises(ConnectionClosed):
            page.line.recv(timeout=10)
        # A message that is too long closes only the WebSocket of the page that has sent it.
        with contextlib.suppress(ConnectionClosed):
            other.say("x" * (2 << 20))
            while True:
                other.line.recv(timeout=10)
        none_left(process)
        # At most four analysts run at the same time.
        pages = [begun(anna) for _ in range(4)]
        with pytest.raises(ConnectionClosed) as refused:
            Page(anna).line.recv(timeout=10)
        assert refused.value.rcvd.code == 4409
        pages[0].line.close()
        end = time.monotonic() + 10.0
        while len(analysts_of(process)) > 3:
            assert time.monotonic() < end
            time.sleep(0.05)
        # When the session ends, its analysts end.
        anna.call("POST", "/api/logout", {})
        none_left(process)
        # When the server ends, in whatever way, the analysts end as well.
        again = Api(url)
        again.call("POST", "/api/login", {"user": "anna", "password": PASSWORD})
        Page(again).until("yarc/begun")
        (last,) = analysts_of(process)
        process.kill()
        end = time.monotonic() + 20.0
        while (
            Path(f"/proc/{last}/status").exists() and "zombie" not in Path(f"/proc/{last}/status").read_text()
        ):
            assert time.monotonic() < end
            time.sleep(0.05)
