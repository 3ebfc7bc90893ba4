"""Fixtures for programs that the editors' tests need. If one is missing, the test is skipped with the reason,
or fails in .ci/run.
"""

import os
import shutil
from pathlib import Path

import pytest

EDITORS = Path(__file__).resolve().parents[2] / "editors"


def absent(what):
    """Skip the test, or make it fail if YARCLANG_REQUIRE_TOOLS=1 is set, as in .ci/run."""
    if os.environ.get("YARCLANG_REQUIRE_TOOLS") == "1":
        pytest.fail(f"{what} is missing", pytrace=False)
    pytest.skip(f"{what} is missing")


@pytest.fixture(scope="session")
def tool():
    """Return a function that returns the path of a program, which must exist."""

    def find(name):
        return shutil.which(name) or absent(name)

    return find


@pytest.fixture(scope="session")
def vscode(tool):
    """Return the folder of the extension, with its npm packages installed."""
    tool("node")
    tool("npm")
    folder = EDITORS / "vscode"
    if not (folder / "node_modules" / "vscode-textmate").is_dir():
        absent("editors/vscode/node_modules (npm ci)")
    return folder
