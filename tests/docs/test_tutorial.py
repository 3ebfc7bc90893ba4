"""Tests of the tutorial and the chapter on commissioning: their files are written, their commands are run in
the order of the pages, and the output is compared.

`pytest tests/docs/test_tutorial.py --rewrite-golden` writes the present output into the pages.
"""

import os
import re
import shutil
import signal
import socket
import subprocess
import sys
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
CHAPTERS = {
    "tutorial": ["first-program", "pick-and-place", "your-arm", "teach", "run", "find-a-fault"],
    "commissioning": ["network", "guard"],
}
"""Pages of each chapter that show commands, in order: later ones use files that earlier ones make."""
SAID = {
    "yarc view": r"http://127\.0\.0\.1:\d+",
    "yarc pendant": r"http://127\.0\.0\.1:\d+",
    "yarc sim": r"127\.0\.0\.1:\d+",
}
"""Commands that run until Ctrl-C, and patterns of the text that they print once they serve."""
PORT = "127.0.0.1:1025"
"""The simulator's address in the pages; the tests replace it by one with a free port."""
_BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
_NAME = re.compile(r"[!#] (\S+\.(?:yarc|toml|txt))")


def environment(folder):
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    return {**os.environ, "PATH": path, "XDG_RUNTIME_DIR": str(folder), "XDG_STATE_HOME": str(folder)}


@contextmanager
def served(command, folder, home):
    """Run a command that serves, and end it with Ctrl-C. Check that it reports that it serves, and that it
    ends cleanly.
    """
    word = " ".join(command.split()[:2])
    more = {"yarc view": "--no-browser --port 0", "yarc pendant": "--port 0 --data users"}.get(word, "")
    with subprocess.Popen(
        ["bash", "-c", f"exec {command} {more}"],
        cwd=folder,
        env=environment(home),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    ) as process:
        said = ""
        try:
            while not re.search(SAID[word], said) and (line := process.stdout.readline()):
                said += line
            yield
        finally:
            os.killpg(process.pid, signal.SIGINT)
            said += process.communicate(timeout=60.0)[0]
    assert re.search(SAID[word], said), said
    assert "error" not in said
    assert process.returncode == 0, said


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def done(text, folder, home):
    """Return the page with the present output of its commands."""
    ran = []
    address = f"127.0.0.1:{free_port()}"
    with ExitStack() as serving:

        def today(block):
            language, body = block[1], block[2]
            if language == "console":
                commands = [line[2:] for line in body.splitlines() if line.startswith("$ ")]
                assert commands, f"a console block without a command: {body}"
                ran.extend(commands)
                return "```console\n" + "".join(f"$ {each}\n{output(each)}" for each in commands) + "```"
            if language == "sh":
                for command in body.splitlines():
                    ran.append(command)
                    started = command if "sim" not in command else f"{command} --port {address.split(':')[1]}"
                    serving.enter_context(served(started, folder, home))
            elif name := _NAME.match(body):
                path = folder / name[1]
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(body, encoding="utf-8")
            return block[0]

        def output(command):
            shown = subprocess.run(
                ["bash", "-c", command.replace(PORT, address)],
                cwd=folder,
                env=environment(home),
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                check=False,
                timeout=300.0,
            ).stdout
            return shown.replace(address, PORT).replace(f"{folder}/", "")

        now = _BLOCK.sub(today, text)
    assert ran
    return now


@pytest.mark.parametrize("chapter", CHAPTERS)
def test_chapter(tmp_path, rewrite_golden, chapter):
    home = tmp_path / "home"
    home.mkdir(mode=0o700)
    folder = tmp_path / "robots"
    folder.mkdir()
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    for name in CHAPTERS[chapter]:
        path = ROOT / "docs" / chapter / f"{name}.md"
        old = path.read_text(encoding="utf-8")
        now = done(old, folder, home)
        assert "Traceback" not in now
        if rewrite_golden:
            path.write_text(now, encoding="utf-8")
        else:
            assert old.splitlines() == now.splitlines(), path.name


def test_every_page_with_commands_is_done():
    shown = {
        f"{chapter}/{path.stem}"
        for chapter in CHAPTERS
        for path in (ROOT / "docs" / chapter).glob("*.md")
        if {"console", "sh"} & {block[1] for block in _BLOCK.finditer(path.read_text(encoding="utf-8"))}
    }
    assert shown == {f"{chapter}/{name}" for chapter, names in CHAPTERS.items() for name in names}
