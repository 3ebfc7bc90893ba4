"""Tests of registries whose names must be unique: a second entry with a name raises, in any file."""

import importlib
import shutil
import sys
from pathlib import Path

import pytest
from programs import robot_of

from yarclang import findings
from yarclang.commands import builtin
from yarclang.commands import registry as command_registry
from yarclang.findings import CATALOGUE
from yarclang.lint import registry as rule_registry
from yarclang.lint import rules
from yarclang.motion import profile, profiles
from yarclang.named import NamedTwice, by_name
from yarclang.repl import dot, dots
from yarclang.robot import library

CODE = 'Finding("{code}", "{name}", "error", "forged", "Forged, so that another finding would be gone.")'
RULE = (
    "from yarclang.lint.rule import Rule\nfrom yarclang.findings import Finding\nRULE = Rule("
    + CODE
    + ", 1, 2, (), ())"
)


@pytest.fixture
def forge(tmp_path, monkeypatch):
    """Return a function that adds a module to a package, as if somebody had added the file."""

    def add(package, name, text):
        (tmp_path / f"{name}.py").write_text(text)
        monkeypatch.setattr(package, "__path__", [*package.__path__, str(tmp_path)])
        monkeypatch.delitem(sys.modules, f"{package.__name__}.{name}", raising=False)

    loaded = set(sys.modules)
    yield add
    for name in set(sys.modules) - loaded:
        if "forged" in name:
            del sys.modules[name]


def test_things_keep_their_order():
    assert list(by_name("letter", [("B", "one", 1), ("A", "two", 2)]).items()) == [("B", 1), ("A", 2)]


def test_both_places_of_a_name_are_said():
    with pytest.raises(NamedTwice, match="the letter B stands twice: in one and in two"):
        by_name("letter", [("B", "one", 1), ("B", "two", 2)])


def test_a_code_that_stands_in_two_families(forge):
    forge(
        findings,
        "y99_forged",
        f"from yarclang.findings import Finding\nFINDINGS = ({CODE.format(code='Y0401', name='forged')},)",
    )
    with pytest.raises(
        NamedTwice,
        match=r"finding Y0401 stands twice: in yarclang\.findings\.y04\w+ and in yarclang\.findings\.y99_forged",  # noqa: E501
    ):
        findings._catalogue()


def test_the_catalogue_is_made_at_import():
    """The catalogue is made at import, so that a duplicate code is found whenever yarclang starts."""
    again = importlib.util.module_from_spec(findings.__spec__)
    findings.__spec__.loader.exec_module(again)
    assert again.CATALOGUE == CATALOGUE
    assert again.CATALOGUE is not CATALOGUE


@pytest.mark.parametrize(
    ("code", "name", "said"),
    [
        ("Y0401", "forged", "finding Y0401 stands twice: in yarclang.findings and in"),
        ("Y1299", CATALOGUE["Y0401"].name, f"finding {CATALOGUE['Y0401'].name} stands twice"),
    ],
)
def test_a_rule_with_a_code_or_name_that_is_taken(forge, code, name, said):
    forge(rules, "forged", RULE.format(code=code, name=name))
    with pytest.raises(NamedTwice, match=said):
        rule_registry.everything.__wrapped__()


@pytest.mark.parametrize("name", ["STOP", "MOVJ"], ids=["of a command", "that a command had before"])
def test_a_command_whose_name_is_taken(forge, name):
    text = (Path(builtin.__path__[0]) / "stop.py").read_text(encoding="utf-8")
    assert 'name="STOP"' in text
    forge(builtin, "forged", text.replace('name="STOP"', f'name="{name}"'))
    # calls the function behind the cache, so that the forged module is found
    with pytest.raises(NamedTwice, match=f"the command {name} stands twice"):
        command_registry._found.__wrapped__()


def test_profiles_whose_files_differ_by_case(forge):
    forge(profiles, "POLY5", "")
    with pytest.raises(NamedTwice, match="the profile POLY5 stands twice"):
        profile.profile_names()


def test_a_profile_that_has_the_name_of_another(forge):
    text = (Path(profiles.__path__[0]) / "poly5.py").read_text(encoding="utf-8")
    forge(profiles, "forged", text)
    with pytest.raises(ValueError, match=r"the profile of forged\.py calls itself POLY5"):
        profile.load_profile.__wrapped__("FORGED")


def test_every_profile_has_the_name_of_its_file():
    names = profile.profile_names()
    assert "LSPB" in names
    assert [profile.load_profile(name).name for name in names] == list(names)


def test_two_robots_of_one_name(tmp_path, monkeypatch):
    for folder in ("one", "other"):
        shutil.copytree(robot_of("INDUSTRIAL6").folder, tmp_path / "robots" / folder)
    monkeypatch.setattr(library, "stdlib_folder", lambda: tmp_path)
    with pytest.raises(NamedTwice, match="the robot INDUSTRIAL6 stands twice: in one and in other"):
        library.list_robots()


def test_a_dot_command_whose_name_is_taken(forge):
    forge(dots, "forged", "from yarclang.repl.dots.help import COMMANDS")
    with pytest.raises(NamedTwice, match=r"the dot command \.help stands twice"):
        dot.dot_commands.__wrapped__()
