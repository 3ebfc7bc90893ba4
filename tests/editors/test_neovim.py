"""Neovim itself, without a screen: our findings show, and a fix applies."""

import json
import os
import subprocess
import sys
from pathlib import Path

from conftest import HERE

PLUGIN = HERE.parent / "editors" / "neovim"
PROGRAM = "ROBOT INDUSTRIAL6\nP0010 MOVEJ 20 0 0 0 0 0 [2] (deg,s)\nP0020 MOVEEJ 10 0 0 0 0 0 [2] (deg,s)\n"


def test_findings_show_and_a_fix_applies(tool, tmp_path):
    program = tmp_path / "p.yarc"
    program.write_text(PROGRAM)
    out = tmp_path / "told.json"
    yarc = Path(sys.executable).with_name("yarc")
    setup = f"lua require('yarc').setup({{ path = {str(yarc)!r} }})"
    subprocess.run(
        [
            tool("nvim"),
            *("--headless", "-u", "NONE", "-i", "NONE", "-n"),
            *("--cmd", f"set rtp^={PLUGIN}", "--cmd", "filetype plugin on", "--cmd", "syntax on"),
            *("--cmd", setup),
            str(program),
            *("-c", f"luafile {Path(__file__).with_name('neovim.lua')}"),
        ],
        env={**os.environ, "YARC_TEST_OUT": str(out), "HOME": str(tmp_path), "XDG_STATE_HOME": str(tmp_path)},
        check=True,
        timeout=240,
        capture_output=True,
    )
    told = json.loads(out.read_text())
    assert told["filetype"] == "yarc"
    assert [(one["line"], one["code"]) for one in told["before"]] == [(3, "Y0202")]
    assert told["actions"]
    assert told["cleared"], told
    assert told["after"] == []
    assert "P0020 MOVEJ 10" in program.read_text()
    assert told["hover"]
