"""Tests in Emacs, in batch mode with Eglot: our findings appear, and a fix can be applied."""

import json
import os
import subprocess
import sys
from pathlib import Path

from conftest import HERE

PROGRAM = "ROBOT INDUSTRIAL6\nP0010 MOVEJ 20 0 0 0 0 0 [2] (deg,s)\nP0020 MOVEEJ 10 0 0 0 0 0 [2] (deg,s)\n"
MODE = HERE.parent / "editors" / "emacs"


def test_findings_show_and_a_fix_applies(tool, tmp_path):
    program = tmp_path / "p.yarc"
    program.write_text(PROGRAM)
    out = tmp_path / "told.json"
    settings = {
        "YARC_TEST_OUT": str(out),
        "YARC_TEST_FILE": str(program),
        "YARC_TEST_PROGRAM": str(Path(sys.executable).with_name("yarc")),
        "HOME": str(tmp_path),
    }
    run = subprocess.run(
        [
            tool("emacs"),
            *("--batch", "-L", str(MODE), "--eval", "(package-initialize)"),
            *("-l", str(Path(__file__).with_name("emacs.el"))),
        ],
        env={**os.environ, **settings},
        timeout=240,
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    told = json.loads(out.read_text())
    assert told["mode"] == "yarc-mode"
    assert [one["line"] for one in told["before"]] == [3]
    assert "MOVEEJ is no command" in told["before"][0]["text"]
    assert told["cleared"]
    assert "P0020 MOVEJ 10" in program.read_text()


def test_the_mode_compiles_without_warnings(tool, tmp_path):
    copy = tmp_path / "yarc-mode.el"
    copy.write_bytes((MODE / "yarc-mode.el").read_bytes())
    command = [tool("emacs"), "--batch", "--eval", "(setq byte-compile-error-on-warn t)"]
    run = subprocess.run(
        [*command, "-f", "batch-byte-compile", str(copy)], capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
