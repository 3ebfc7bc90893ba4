"""Test that the bundled libraries of the pages are exactly what `bundles/` builds, without manual changes."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MADE_OF = ROOT / "bundles"
KEPT = ROOT / "yarclang" / "pendant" / "pages" / "bundles"


def test_bundles_are_what_their_sources_make(tmp_path):
    npm = shutil.which("npm")
    if npm is None or not (MADE_OF / "node_modules" / "three").is_dir():
        if os.environ.get("YARCLANG_REQUIRE_TOOLS") == "1":
            pytest.fail("bundles/node_modules is missing (npm ci)", pytrace=False)
        pytest.skip("bundles/node_modules is missing (npm ci)")
    subprocess.run([npm, "run", "--silent", "build", "--", f"--outdir={tmp_path}"], cwd=MADE_OF, check=True)
    assert {one.name for one in KEPT.iterdir()} == {"codemirror.js", "three.js"}
    for one in KEPT.iterdir():
        assert (tmp_path / one.name).read_bytes() == one.read_bytes(), "run `npm run build` in bundles/"
