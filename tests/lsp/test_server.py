"""The server in a separate process, as editors talk to it."""

import asyncio
import json
import socket
import subprocess
import time
from pathlib import Path
from shutil import copytree

import pytest
from click.testing import CliRunner
from lsprotocol import types
from pytest_lsp import make_test_lsp_client

from tests.lsp.driven import COMMAND, LONGEST, Editor, capabilities, run
from yarclang.cli.yarc import main as yarc

HEAD = "ROBOT INDUSTRIAL6\nDEFAULT {TCP} [50%] (mm,deg,s) {B}\n"
QUICK = HEAD + "P0010 MOVEJ 10 0 0 0 0 0 [0.05]\nP0020 MOVEJ HOME\n"
TYPO = HEAD + "P0010 MOVJE HOME\n"
FINE = HEAD + "P0010 MOVEJ 10 0 0 0 0 0\nP0020 MOVEJ HOME\n"


def codes(found: list[types.Diagnostic]) -> list[str]:
    return [str(one.code) for one in found]


def test_findings_are_sent_to_who_does_not_ask(tmp_path: Path):
    async def work(one: Editor) -> None:
        document = one.open(tmp_path / "a.yarc", QUICK)
        (found,) = await one.until(document, lambda found: codes(found) == ["Y0601"])
        assert found.range.start.line == 2
        assert found.source == "yarc"
        one.write(document, TYPO)
        await one.until(document, lambda found: codes(found) == ["Y0202"])
        one.write(document, FINE)
        await one.until(document, lambda found: not found)
        params = types.DocumentDiagnosticParams(document)
        assert not (await one.client.text_document_diagnostic_async(params)).items

    run(work, capabilities(pull=False))


def test_nothing_flickers_while_somebody_types(tmp_path: Path):
    """After an edit elsewhere, the first message still contains the findings of planning, in their line."""

    async def work(one: Editor) -> None:
        document = one.open(tmp_path / "a.yarc", QUICK)
        await one.until(document, lambda found: codes(found) == ["Y0601"])
        one.write(document, "! a remark\n" + QUICK)
        await one.client.wait_for_notification(types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
        (found,) = one.client.diagnostics[document.uri]
        assert (found.code, found.range.start.line) == ("Y0601", 3)

    run(work, capabilities(pull=False))


def test_findings_are_asked_for_and_never_sent(tmp_path: Path):
    async def work(one: Editor) -> None:
        document = one.open(tmp_path / "a.yarc", QUICK)
        found = await one.pulled(document)
        assert codes(found) == ["Y0601"]
        params = types.CodeActionParams(document, found[0].range, types.CodeActionContext(found))
        actions = await one.client.text_document_code_action_async(params)
        assert actions
        fix = next(action for action in actions if action.is_preferred)
        assert "Y0601" in fix.title
        (edit,) = fix.edit.changes[document.uri]
        lines = QUICK.split("\n")
        start, end = edit.range.start, edit.range.end
        line = lines[2][: start.character] + edit.new_text + lines[2][end.character :]
        one.write(document, "\n".join([*lines[:2], line, *lines[3:]]))
        assert "Y0601" not in codes(await one.pulled(document))
        hover = await one.client.text_document_hover_async(types.HoverParams(document, types.Position(2, 8)))
        assert "- takes 0." in hover.contents.value
        assert one.client.diagnostics == {}

    run(work, capabilities(pull=True, refresh=False))


def test_planned_findings_follow_for_who_can_ask_again(tmp_path: Path):
    """If planning takes longer than a client should wait, the findings that need no planning come first."""
    body = "P0001 MOVEJ 0 -10 -20 0 -60 0\n" + "".join(
        f"P{10 * n:04d} MOVEL {n % 7 * 20} 1000 {1060 + n % 5 * 10} -90 0 0\n" for n in range(1, 80)
    )

    async def work(one: Editor) -> None:
        document = one.open(tmp_path / "a.yarc", HEAD + body + "P9999 MOVEJ 10 0 0 0 0 0 [0.001]\n")
        first = await one.pulled(document)
        if "Y0601" not in codes(first):
            await one.refreshed.wait()
            assert "Y0601" in codes(await one.pulled(document))

    run(work, capabilities(pull=True))


def test_descriptions_and_their_users(tmp_path: Path):
    """cell.toml has its own findings. If an open module changes without being saved, the findings of its
    program change.
    """

    async def work(one: Editor) -> None:
        cell = one.open(tmp_path / "cell.toml", '[frames.A]\nparent = "C"\nxyz = [0, 0, 0]\n')
        assert await one.pulled(cell)
        robot = one.open(tmp_path / "robot.toml", "name = 1\n")
        assert await one.pulled(robot)
        module = "SUB OUT\n  P0010 MOVEJ 9 0 0 0 0 0 [2] (deg,s)\nEND\n"
        (tmp_path / "tool.yarc").write_text(module)
        user = one.open(tmp_path / "a.yarc", HEAD + "USE TOOL\nP0010 CALL TOOL.OUT\n")
        assert codes(await one.pulled(user)) == []
        opened = one.open(tmp_path / "tool.yarc", module)
        one.write(opened, module.replace("SUB OUT", "SUB AWAY"))
        assert codes(await one.pulled(user)) == ["Y0210"]
        one.write(opened, module)
        assert codes(await one.pulled(user)) == []

    run(work, capabilities(pull=True, refresh=False))


def test_users_of_a_changed_table(tmp_path: Path):
    """An open table of waypoints is read as it is in the editor. Its errors are reported in the programs
    that name it.
    """
    rows = "time,J1,J2,J3,J4,J5,J6\n1,5,0,0,0,0,0\n3,9,0,0,0,0,0\n"
    (tmp_path / "path.csv").write_text(rows)

    async def work(one: Editor) -> None:
        user = one.open(tmp_path / "a.yarc", HEAD + 'P0010 MOVEJ_TIMED "path.csv" (deg,s)\n')
        assert codes(await one.pulled(user)) == []
        table = one.open(tmp_path / "path.csv", rows)
        assert codes(await one.pulled(table)) == []
        one.write(table, rows.replace("9", "nine"))
        (found,) = await one.pulled(user)
        assert (found.code, "path.csv:3: 'nine' is not a number" in found.message) == ("Y1382", True)
        one.write(table, rows)
        assert codes(await one.pulled(user)) == []

    run(work, capabilities(pull=True, refresh=False))


def test_users_of_a_changed_robot_and_project(tmp_path: Path):
    """An open robot.toml and an open yarc.toml are read as they are in the editor, before they are saved."""
    library = Path(__file__).resolve().parents[2] / "stdlib" / "robots" / "industrial6"
    copytree(library, tmp_path / "arm")
    description = (tmp_path / "arm" / "robot.toml").read_text()
    (tmp_path / "yarc.toml").write_text('robot = "arm/robot.toml"\n')

    async def work(one: Editor) -> None:
        user = one.open(tmp_path / "a.yarc", "P0010 MOVEJ AWAY [5] (s)\n")
        assert codes(await one.pulled(user)) == ["Y0205"]
        robot = one.open(tmp_path / "arm" / "robot.toml", description)
        one.write(robot, description.replace("[positions]", "[positions]\nAWAY = [9, 0, 0, 0, 0, 0]", 1))
        assert codes(await one.pulled(robot)) == []
        assert codes(await one.pulled(user)) == []
        project = one.open(tmp_path / "yarc.toml", 'robot = "arm/robot.toml"\n')
        one.write(project, "rbot = 3\n")
        assert codes(await one.pulled(project)) == ["Y1393"]
        assert codes(await one.pulled(user)) == ["Y1393"]  # robot.toml is open, but not saved
        one.write(project, 'robot = "INDUSTRIAL6"\n[findings]\nY0205 = "error"\n')
        assert codes(await one.pulled(user)) == ["Y0205"]  # the changed yarc.toml names a robot without AWAY

    run(work, capabilities(pull=True, refresh=False))


def test_the_cell_of_an_open_project(tmp_path: Path):
    """The cell that an open yarc.toml names is used, and an open cell file is read as it is in the editor."""
    cell = 'units = "mm,deg"\n[frames.TABLE]\nparent = "B"\nxyz = [0, 900, 800]\n'
    (tmp_path / "cell.toml").write_text(cell)
    (tmp_path / "yarc.toml").write_text('robot = "INDUSTRIAL6"\n')

    async def work(one: Editor) -> None:
        user = one.open(tmp_path / "a.yarc", HEAD + "P0010 MOVEJ_RPY {TCP} 0 0 300 0 0 0 [5] {TABLE}\n")
        assert codes(await one.pulled(user)) == ["Y0301"]
        project = one.open(tmp_path / "yarc.toml", 'robot = "INDUSTRIAL6"\n')
        one.write(project, 'robot = "INDUSTRIAL6"\ncell = "cell.toml"\n')
        assert codes(await one.pulled(project)) == []
        assert codes(await one.pulled(user)) == []
        around = one.open(tmp_path / "cell.toml", cell)
        one.write(around, cell.replace("TABLE", "BENCH"))
        assert codes(await one.pulled(user)) == ["Y0301"]
        one.write(project, 'robot = "INDUSTRIAL6"\ncell = "nowhere.toml"\n')
        assert codes(await one.pulled(project)) == ["Y1302"]
        assert "Y1302" in codes(await one.pulled(user))

    run(work, capabilities(pull=True, refresh=False))


def test_over_a_port(tmp_path: Path):
    async def work() -> None:
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = free.getsockname()[1]
        server = await asyncio.create_subprocess_exec(*COMMAND, "--tcp", str(port))
        client = make_test_lsp_client()
        try:
            async with asyncio.timeout(LONGEST):
                while True:
                    try:
                        await client.start_tcp("127.0.0.1", port)
                        break
                    except OSError:
                        await asyncio.sleep(0.05)
                await client.initialize_session(
                    types.InitializeParams(
                        capabilities=capabilities(pull=True, refresh=False), workspace_folders=None
                    )
                )
                one = Editor(client)
                assert codes(await one.pulled(one.open(tmp_path / "a.yarc", TYPO))) == ["Y0202"]
                await client.shutdown_session()
                await client.stop()
                await server.wait()
        finally:
            if server.returncode is None:
                server.kill()

    asyncio.run(work())


def test_a_web_page_is_sent_away_from_the_port(tmp_path: Path):
    """The body of a web page's POST is a valid message of the protocol, but isn't answered. The next editor
    is served.
    """
    asked = json.dumps({"jsonrpc": "2.0", "id": 1, "method": "initialize", "params": {"capabilities": {}}})
    body = f"Content-Length: {len(asked)}\r\n\r\n{asked}"
    page = f"POST / HTTP/1.1\r\nHost: x\r\nContent-Length: {len(body)}\r\n\r\n{body}"
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    server = subprocess.Popen([*COMMAND, "--tcp", str(port)], stderr=subprocess.DEVNULL)
    try:
        for said, answered in ((page, False), (body, True)):
            with connected(port) as wire:
                wire.sendall(said.encode())
                wire.settimeout(LONGEST)
                try:
                    answer = wire.recv(100)
                except ConnectionError:
                    answer = b""
                assert answer.startswith(b"Content-Length") == answered
    finally:
        server.kill()
        server.wait()


def connected(port: int) -> socket.socket:
    until = time.monotonic() + LONGEST
    while True:
        try:
            return socket.create_connection(("127.0.0.1", port))
        except OSError:
            assert time.monotonic() < until
            time.sleep(0.05)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("--tcp", "here"), "neither PORT nor HOST:PORT"),
        (("--tcp", "70000"), "neither PORT"),
        (("--tcp", "0"), "neither PORT"),
        (("--stdio", "--tcp", "1"), "choose one"),
    ],
)
def test_wrong_usage(arguments: tuple[str, ...], told: str):
    done = CliRunner().invoke(yarc, ["lsp", *arguments])
    assert done.exit_code == 2
    assert told in done.output


def test_a_port_that_is_taken():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        done = CliRunner().invoke(yarc, ["lsp", "--tcp", str(taken.getsockname()[1])])
    assert done.exit_code == 1
    assert "choose another port" in done.output


def test_a_client_that_goes_away_ends_the_server():
    done = subprocess.run(COMMAND, input=b"", capture_output=True, timeout=LONGEST, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, b"", b"")


def test_nothing_grows_with_edits(tmp_path: Path):
    """A line is changed back and forth, with requests in between; the server's memory stays constant."""

    async def work(one: Editor) -> None:
        document = one.open(tmp_path / "a.yarc", FINE)
        status = Path(f"/proc/{one.client._server.pid}/status")
        held = []
        for number in range(1_000):
            line = types.Range(types.Position(2, 0), types.Position(3, 0))
            text = f"P0010 MOVEJ {number % 80} 0 0 0 0 0\n"
            one.change(document, [types.TextDocumentContentChangePartial(range=line, text=text)])
            if number % 20 == 0:
                await one.pulled(document)
                await one.client.text_document_hover_async(types.HoverParams(document, types.Position(2, 7)))
            if number % 200 == 199:
                kilobytes = next(row for row in status.read_text().splitlines() if row.startswith("VmRSS"))
                held.append(int(kilobytes.split()[1]) / 1024)
        assert held[-1] - held[1] < 12, held

    run(work, capabilities(pull=True, refresh=False))
