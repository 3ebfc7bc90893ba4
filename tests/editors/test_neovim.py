"""Tests in Neovim, without a screen: our findings appear, and a fix can be applied."""

import json
import os
import runpy
import subprocess
import sys
from pathlib import Path

from conftest import HERE

MADE = runpy.run_path(str(HERE.parent / "editors" / "grammar.py"))
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


def test_the_syntax_file_has_the_words_of_today(rewrite_golden):
    if rewrite_golden:
        MADE["VIM"].write_text(MADE["vim_syntax"](), encoding="utf-8")
    assert MADE["VIM"].read_text(encoding="utf-8") == MADE["vim_syntax"]()


def test_words_have_their_colours(tool, tmp_path):
    program = tmp_path / "p.yarc"
    line = 'P0010 MOVEJ_RPY_LSPB {TCP} 1.5 [MIN] (mm,deg) {B} BLEND 5 ! "x" 5'
    program.write_text(f"{line}\nREPEAT I 4\nLET A = SIN($B)\n")
    asked = {
        (1, "P0010"): "yarcIndex",
        (1, "MOVEJ_RPY_LSPB"): "yarcCommand",
        (1, "{TCP}"): "yarcFrame",
        (1, "1.5"): "yarcNumber",
        (1, "deg"): "yarcUnit",
        (1, "BLEND"): "yarcOption",
        (1, '"x"'): "yarcComment",
        (2, "REPEAT"): "yarcBlock",
        (3, "LET"): "yarcDeclaration",
        (3, "SIN"): "yarcFunction",
        (3, "$B"): "yarcVariable",
    }
    lines = program.read_text().splitlines()
    places = [(row, lines[row - 1].index(piece) + 1) for row, piece in asked]
    names = ",".join(f"synIDattr(synID({row},{column},1),'name')" for row, column in places)
    out = tmp_path / "out"
    subprocess.run(
        [
            tool("nvim"),
            *("--headless", "-u", "NONE", "-i", "NONE", "-n", "--cmd", f"set rtp^={PLUGIN}"),
            *("--cmd", "filetype plugin on", "--cmd", "syntax on", str(program)),
            *("-c", f"call writefile([{names}], '{out}')", "-c", "qall!"),
        ],
        check=True,
        timeout=60,
        capture_output=True,
    )
    assert dict(zip(asked, out.read_text().split("\n"), strict=False)) == asked
