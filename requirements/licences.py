"""Write THIRD_PARTY.md: the libraries that come with a normal install, and their licences by their own
metadata.

Run it with the Python of the development environment after requirements/run.txt has changed:
`python requirements/licences.py > THIRD_PARTY.md`. tests/test_licences.py compares both.
"""

from __future__ import annotations

import json
import re
from importlib.metadata import PackageNotFoundError, metadata
from pathlib import Path

ROOT = Path(__file__).parent.parent
REQUIRED = re.compile(r"^([A-Za-z0-9._-]+)==([^ \\]+)", re.MULTILINE)
CLASSIFIER = re.compile(r"License :: (?:OSI Approved :: )?(.*)")

WITHOUT_METADATA = {"cmeel-qhull": "Qhull licence: free to copy and change, with its notices"}
"""Licences of libraries whose metadata has none, from the licence text that they bring."""

HEAD = """# Licences of what is installed

yarclang itself is under [Apache 2.0](LICENSE). A normal install (`requirements/run.txt`) brings the libraries below,
each under its own licence. What is said here is what their packages say of themselves; their full texts are in the
folders `*.dist-info` of the environment. Extras (`pendant`, `view`, `bags`, `fleet`, `xacro`, `docs`) bring more:
`pip show NAME` says the licence of each. The table is made by `requirements/licences.py`.

| library | licence |
|---|---|
"""  # noqa: E501

BUNDLES = """
The pendant's pages have these libraries in them, bundled into `yarclang/pendant/pages/bundles`, with their notices:

| library | licence |
|---|---|
"""  # noqa: E501


def required() -> dict[str, frozenset[str]]:
    """Return the libraries of a normal install with their versions; some have one for each version of
    Python.
    """
    found: dict[str, set[str]] = {}
    for name, version in REQUIRED.findall((ROOT / "requirements/run.txt").read_text(encoding="utf-8")):
        found.setdefault(name, set()).add(version)
    return {name: frozenset(versions) for name, versions in sorted(found.items())}


def licence_of(name: str) -> str:
    """Return the licence that an installed library names: as an expression, in a line, or by a classifier.

    Raises:
        LookupError: the library isn't installed, or names no licence.
    """
    try:
        told = metadata(name)
    except PackageNotFoundError:
        raise LookupError(f"{name} isn't installed: install requirements/dev.txt") from None
    line = told.get("License") or ""
    if expression := told.get("License-Expression") or (line if line and "\n" not in line else ""):
        return " ".join(expression.split())
    named = [CLASSIFIER.fullmatch(one) for one in told.get_all("Classifier") or []]
    if found := [one[1] for one in named if one is not None]:
        return ", ".join(found)
    if name in WITHOUT_METADATA:
        return WITHOUT_METADATA[name]
    raise LookupError(f"{name} names no licence: look into its files, and add it to WITHOUT_METADATA")


def bundled() -> dict[str, str]:
    """Return the libraries in the pendant's pages with their licences; esbuild only makes the bundles."""
    packages = json.loads((ROOT / "bundles/package-lock.json").read_text(encoding="utf-8"))["packages"]
    names = {path.removeprefix("node_modules/"): told for path, told in packages.items() if path}
    return {name: told["license"] for name, told in sorted(names.items()) if "esbuild" not in name}


def text() -> str:
    """Return the page."""
    rows = [f"| {name} | {licence_of(name)} |\n" for name in required()]
    more = [f"| {name} | {licence} |\n" for name, licence in bundled().items()]
    return HEAD + "".join(rows) + BUNDLES + "".join(more)


if __name__ == "__main__":
    print(text(), end="")  # noqa: T201  (it is a script)
