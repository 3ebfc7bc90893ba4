"""Tests of the recipes in docs/ci.md and of the hooks for pre-commit: they do what is written there."""

import json
import re
import shlex
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
import yaml
from conftest import HERE

ROOT = HERE.parent
HOOKS = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text())
RECIPES = [
    yaml.safe_load(text)
    for text in re.findall(r"```yaml\n(.*?)```", (ROOT / "docs" / "ci.md").read_text(), re.DOTALL)
]
GOOD = "P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)\n"
UGLY = "p0010   movej 10 0 0 0 0 0 [2] (deg,s)\n"
BAD = "P0010 MOVEK\n"
BESIDE = str(Path(sys.executable).parent)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "yarc.toml").write_text('robot = "INDUSTRIAL6"\n')
    (tmp_path / "README.md").write_text("programs\n")
    return tmp_path


def shell(line, folder):
    environment = {"PATH": f"{BESIDE}:/usr/bin:/bin", "HOME": str(folder)}
    return subprocess.run(
        line, shell=True, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )


def hook(name, folder, *args):
    """Run a hook as pre-commit does: its entry with the arguments and the matching files, in the repository's
    top folder.

    Return True if it fails or changes files, or None if no file matches.
    """
    (found,) = (one for one in HOOKS if one["id"] == name)
    files = [path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()]
    matching = sorted(path for path in files if re.search(found["files"], path))
    if not matching:
        return None
    before = {path: (folder / path).read_bytes() for path in matching}
    run = shell(shlex.join([*shlex.split(found["entry"]), *args, *matching]), folder)
    changed = any((folder / path).read_bytes() != content for path, content in before.items())
    return run.returncode != 0 or changed


def test_hooks_are_complete():
    assert {one["id"] for one in HOOKS} == {"yarc-check", "yarc-fmt"}
    for one in HOOKS:
        assert {"id", "name", "description", "entry", "language", "files"} <= set(one)
        assert one["language"] == "python"


@pytest.mark.parametrize(
    ("name", "text", "args", "fails"),
    [
        ("yarc-check", GOOD, (), False),
        ("yarc-check", BAD, (), True),
        ("yarc-check", "P0010 MOVEJ HOME [5] (s)\n", (), False),
        ("yarc-check", "P0010 MOVEJ HOME [5] (s)\n", ("--strict",), True),
        ("yarc-check", BAD, ("--no-plan",), True),
        ("yarc-fmt", GOOD, (), False),
        ("yarc-fmt", UGLY, (), True),
    ],
)
def test_hooks(name, text, args, fails, folder):
    (folder / "in" / "a folder").mkdir(parents=True)
    (folder / "in" / "a folder" / "p.yarc").write_text(text)
    assert hook(name, folder, *args) == fails
    assert (folder / "in" / "a folder" / "p.yarc").read_text() == (GOOD if name == "yarc-fmt" else text)


def test_hooks_without_programs(folder):
    assert hook("yarc-check", folder) is None


def test_the_recipe_names_hooks_that_there_are():
    (configuration,) = (one for one in RECIPES if "repos" in one)
    (repository,) = configuration["repos"]
    assert {one["id"] for one in repository["hooks"]} == {one["id"] for one in HOOKS}


def lines_of(recipe):
    if "jobs" in recipe:
        return [step["run"] for step in recipe["jobs"]["check"]["steps"] if "run" in step]
    return recipe["robot programs"]["script"]


@pytest.mark.parametrize(
    ("kind", "text", "fails"),
    [
        ("jobs", GOOD, []),
        ("jobs", BAD, ["yarc check", "yarcc"]),
        ("robot programs", BAD, ["yarc check", "yarcc"]),
        ("robot programs", UGLY, ["yarc fmt"]),
    ],
)
def test_the_recipes_lines_run(kind, text, fails, folder):
    (recipe,) = (one for one in RECIPES if kind in one)
    (folder / "p.yarc").write_text(text)
    lines = [line for line in lines_of(recipe) if not line.startswith("pip ")]
    assert len(lines) == 3
    failed = [line for line in lines if shell(line, folder).returncode != 0]
    assert [" ".join(line.split()[: 1 + line.startswith("yarc ")]) for line in failed] == fails
    assert (folder / "build" / "p.pmc").is_file() == (text != BAD)
    if kind == "jobs":
        results = json.loads((folder / "findings.sarif").read_text())["runs"][0]["results"]
        assert bool(results) == (text == BAD)
    else:
        tests = ElementTree.fromstring((folder / "findings.xml").read_text())
        assert bool(tests.findall(".//failure")) == (text == BAD)


def test_annotations(folder):
    (folder / "p.yarc").write_text(BAD)
    assert shell("yarc check --format github .", folder).stdout.startswith("::error file=p.yarc,line=1")
