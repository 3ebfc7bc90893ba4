"""The session of docs/simulator.md with `yarc sim`: two terminals and a client, on a free port.

`pytest tests/cli/test_simulator_page.py --rewrite-golden` writes the present output into the page.
"""

import os
import re
import signal
import subprocess
import sys
from pathlib import Path

PAGE = Path(__file__).resolve().parents[2] / "docs" / "simulator.md"
_CLIENT = re.compile(r"^```python\n(# (\w+\.py): .*?)^```$", re.DOTALL | re.MULTILINE)
_SIMULATOR = re.compile(r"^```console simulator\n\$ (.*?)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
_SESSION = re.compile(r"^```console client\n(.*?)^```$", re.DOTALL | re.MULTILINE)
_PORT = "1025"


def started(command, folder):
    """Start a command whose two outputs are read as one."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    return subprocess.Popen(
        ["bash", "-c", command],
        cwd=folder,
        env={**os.environ, "PATH": path},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def test_session(tmp_path, rewrite_golden):
    text = PAGE.read_text(encoding="utf-8")
    ((client, name),) = _CLIENT.findall(text)
    ((command, _),) = _SIMULATOR.findall(text)
    ((session),) = _SESSION.findall(text)
    asked = [line[2:] for line in session.splitlines() if line.startswith("$ ")]
    with started(f"exec {command} --port 0", tmp_path) as simulator:
        try:
            listens = simulator.stdout.readline()
            found = re.search(r":(\d+),", listens)
            assert found, listens + simulator.stdout.read()
            port = found[1]
            assert client.count(_PORT) == 1
            (tmp_path / name).write_text(client.replace(_PORT, port), encoding="utf-8")
            outputs = [started(each, tmp_path).communicate(timeout=60)[0] for each in asked]
        finally:
            simulator.send_signal(signal.SIGINT)
            rest = simulator.communicate(timeout=20)[0]
    assert (simulator.returncode, rest) == (0, "stopped\n")
    listens = listens.replace(port, _PORT)
    answers = "".join(f"$ {each}\n{output}" for each, output in zip(asked, outputs, strict=True))
    now = _SIMULATOR.sub(lambda _: f"```console simulator\n$ {command}\n{listens}```", text)
    now = _SESSION.sub(lambda _: f"```console client\n{answers}```", now)
    if rewrite_golden:
        PAGE.write_text(now, encoding="utf-8")
    assert PAGE.read_text(encoding="utf-8").splitlines() == now.splitlines()
