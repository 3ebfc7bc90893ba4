"""Check that every library is installed in the oldest version that pyproject.toml allows. A bound
that can't be installed would never be tested.
"""

import re
import sys
import tomllib
from importlib.metadata import version
from pathlib import Path

NUMBERS = re.compile(r"\d+")


def numbers(text: str) -> list[int]:
    """Return the numbers of a version without trailing zeros, so that 8.1 equals 8.1.0."""
    found = [int(number) for number in NUMBERS.findall(text)]
    while found and found[-1] == 0:
        found.pop()
    return found


def main(*extras: str) -> int:
    """Compare the bounds of the dependencies, and of the given extras, with the installed versions."""
    project = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))["project"]
    wanted = [
        *project["dependencies"],
        *(one for extra in extras for one in project["optional-dependencies"][extra]),
    ]
    wrong = []
    tried = 0
    for one in wanted:
        if one.startswith("yarclang["):
            continue
        name, least = re.match(r"([\w.-]+)>=([\w.]+)", one).groups()
        tried += 1
        if numbers(version(name)) != numbers(least):
            wrong.append(f"{name}: {least} is allowed, {version(name)} is the oldest that could be installed")
    print("\n".join(wrong or [f"{tried} bounds are the versions that are installed"]))
    return 1 if wrong or not tried else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
