"""Test that the name of a profile is only in its own file."""

import ast
from pathlib import Path

import yarclang
from yarclang.motion.profile import TIMETABLE, load_profile, profile_names

ROOT = Path(yarclang.__file__).parent
KNOWN = {
    ("semantics/names/commands.py", "LSPB"),  # the profile of a command without a suffix
    ("motion/profile.py", "SCURVE"),  # the law for paths that are too short for their speed
}
SPOKEN_OF = ("findings/", "lint/rules/", "commands/builtin/", "motion/profiles/", "campaign/", "independent/")
"""Folders that may contain names of profiles: they contain example programs or draw programs. `independent/`
checks the properties of laws.
"""


def named():
    """Yield the places in the code at which a string is the name of a profile, or of a command with a
    profile.
    """
    for path in ROOT.rglob("*.py"):
        place = path.relative_to(ROOT).as_posix()
        if place.startswith(SPOKEN_OF):
            continue
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Constant) and isinstance(node.value, str) and " " not in node.value:
                last = node.value.rpartition("_")[2]
                if last in profile_names():
                    yield place, last


def test_no_code_names_a_profile():
    assert set(named()) == KNOWN


def test_a_timetable_has_a_profile_of_its_own():
    assert load_profile("") is TIMETABLE
    assert not TIMETABLE.has_jerk_limit
