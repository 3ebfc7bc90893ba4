"""What README.md shows is what happens: its programs are written to files, its commands run, their output compared.

`pytest tests/test_readme.py --rewrite-golden` puts the output of today into README.md.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
README = ROOT / "README.md"
_PROGRAM = re.compile(r"^```yarc\n(! (\S+)\n.*?)^```$", re.DOTALL | re.MULTILINE)
_SESSION = re.compile(r"^```console\n(.*?)^```$", re.DOTALL | re.MULTILINE)
_LINK = re.compile(r"\]\(([^)#:]+)\)")


def run(command: str, folder: Path) -> str:
    """Standard output and standard error of a command, as a person sees them."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    shown = subprocess.run(
        ["bash", "-c", command],
        cwd=folder,
        env={**os.environ, "PATH": path},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    return shown.stdout


def test_sessions(tmp_path, rewrite_golden):
    text = README.read_text(encoding="utf-8")
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    for program, name in _PROGRAM.findall(text):
        (tmp_path / name).write_text(program, encoding="utf-8")

    def today(session: re.Match[str]) -> str:
        commands = [line[2:] for line in session[1].splitlines() if line.startswith("$ ")]
        return (
            "```console\n" + "".join(f"$ {command}\n{run(command, tmp_path)}" for command in commands) + "```"
        )

    now = _SESSION.sub(today, text)
    if rewrite_golden:
        README.write_text(now, encoding="utf-8")
    assert README.read_text(encoding="utf-8").splitlines() == now.splitlines()


def test_links_lead_somewhere():
    missing = [
        link for link in _LINK.findall(README.read_text(encoding="utf-8")) if not (ROOT / link).exists()
    ]
    assert missing == []
