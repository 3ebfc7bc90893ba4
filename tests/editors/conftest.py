"""Programs that the editors' tests need: without them a test is skipped with the reason, or fails where
they must be there.
"""

import os
import shutil
from pathlib import Path

import pytest

EDITORS = Path(__file__).resolve().parents[2] / "editors"


def absent(what):
    """Skip a test; with YARCLANG_REQUIRE_TOOLS=1, as in .ci/run, fail."""
    if os.environ.get("YARCLANG_REQUIRE_TOOLS") == "1":
        pytest.fail(f"{what} is missing", pytrace=False)
    pytest.skip(f"{what} is missing")


@pytest.fixture(scope="session")
def tool():
    """A function: the path of a program, which must be there."""

    def find(name):
        return shutil.which(name) or absent(name)

    return find


@pytest.fixture(scope="session")
def vscode(tool):
    """The folder of the extension, with its packages installed."""
    tool("node")
    tool("npm")
    folder = EDITORS / "vscode"
    if not (folder / "node_modules" / "vscode-textmate").is_dir():
        absent("editors/vscode/node_modules (npm ci)")
    return folder
