"""Tests of the benchmarks: these scripts run rarely, so all names that they use must still exist."""

import json
import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[1] / "benchmarks"
NEEDS = {"peer_rtb": "roboticstoolbox", "peer_search": "roboticstoolbox", "motion": "ruckig", "run": "pyperf"}
"""Scripts that import a library with which they compare; it may be missing in this environment."""

SCRIPTS = sorted(
    path.stem for path in FOLDER.glob("*.py") if find_spec(NEEDS.get(path.stem, "yarclang")) is not None
)
ASKED = (
    ("stages", "3", "5"),
    ("plan", "3", "5"),
    ("cost", "4", "5", "lines"),
    ("task", "3", "5"),
    ("edits", "10", "5"),
)


def _python(*arguments):
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=FOLDER,
        env={**os.environ, "PYTHONPATH": str(FOLDER.parent)},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("script", SCRIPTS)
def test_a_benchmark_finds_what_it_imports(script):
    _python("-c", f"import runpy; runpy.run_path({str(FOLDER / (script + '.py'))!r}, run_name='imported')")


@pytest.mark.parametrize("asked", ASKED, ids=lambda asked: asked[0])
def test_what_the_main_ratios_measure_can_be_measured(asked):
    assert json.loads(_python("inside.py", *asked))
