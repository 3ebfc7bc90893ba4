"""Tests of THIRD_PARTY.md: it names the licences of all installed libraries, as their packages state them."""

import re
import sys
from importlib.metadata import version
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PAGE = ROOT / "THIRD_PARTY.md"
sys.path.insert(0, str(ROOT / "requirements"))

import licences  # noqa: E402

ROWS = dict(re.findall(r"^\| ([^|]+) \| ([^|]+) \|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE))


def test_every_library_has_a_row_and_a_licence():
    wanted = {*licences.required(), *licences.bundled()}
    assert len(licences.required()) > 30
    assert wanted == set(ROWS) - {"library"}
    assert all(ROWS[name].strip() for name in wanted)


@pytest.mark.parametrize("name", licences.required())
def test_the_licence_is_that_of_the_package(name):
    if version(name) not in licences.required()[name]:
        pytest.skip(f"{name} is installed in another version than the pinned one")
    assert ROWS[name] == licences.licence_of(name)


def test_bundles():
    assert {ROWS[name] for name in licences.bundled()} == {"MIT"}
    assert "three" in licences.bundled()


def test_a_library_without_a_licence_is_an_error(monkeypatch):
    monkeypatch.setattr(licences, "WITHOUT_METADATA", {})
    with pytest.raises(LookupError, match="cmeel-qhull names no licence"):
        licences.licence_of("cmeel-qhull")
    with pytest.raises(LookupError, match="isn't installed"):
        licences.licence_of("no-such-library-of-ours")
