"""Find robots: the folder of the standard library, and the summary of each robot in it."""

from __future__ import annotations

import difflib
from pathlib import Path
from typing import Any

from yarclang.consulted import is_file, is_folder
from yarclang.frozen import frozen
from yarclang.named import by_name

DESCRIPTION = "robot.toml"


@frozen
class RobotSummary:
    """A robot of the standard library; `size` is its number of joints."""

    name: str
    title: str
    folder: Path
    size: int


def stdlib_folder() -> Path:
    """Return the folder of the standard library: `stdlib` inside the installed package, or beside it in a
    checkout.
    """
    package = Path(__file__).resolve().parents[1]
    installed = package / "stdlib"
    return installed if installed.is_dir() else package.parent / "stdlib"


def list_robots() -> tuple[RobotSummary, ...]:
    """Return the robots of the standard library by name. Only the robot.toml of each robot is read, and
    nothing else is checked.

    Raises:
        NamedTwice: two folders contain robots with the same name.
    """
    summaries = (_summary(path) for path in sorted((stdlib_folder() / "robots").glob(f"*/{DESCRIPTION}")))
    found = ((one.name, one.folder.name, one) for one in summaries if one is not None)
    return tuple(by_name("robot", found).values())


def find_robot(name_or_path: str) -> tuple[Path | None, str]:
    """Find the robot.toml of a robot that is given by its name (in any case) or by a path.

    A name of the standard library takes precedence over a folder of that name.

    Returns:
        The path and an empty text. If there is no such robot: None and the most similar name, which is empty
        if no name is similar.
    """
    robots = stdlib_folder() / "robots"
    names = [path.parent.name for path in robots.glob(f"*/{DESCRIPTION}")]
    name = name_or_path.lower()
    if name in names:
        return robots / name / DESCRIPTION, ""
    try:
        path = Path(name_or_path)
        if is_folder(path):
            return path / DESCRIPTION, ""
        if is_file(path) or path.suffix.lower() == ".toml" or len(path.parts) > 1:
            return path, ""
    except (OSError, ValueError):
        pass
    near = difflib.get_close_matches(name, names, 1, 0.5)
    return None, near[0].upper() if near else ""


def _summary(path: Path) -> RobotSummary | None:
    import tomllib

    try:
        data: dict[str, Any] = tomllib.loads(path.read_text(encoding="utf-8"))
        return RobotSummary(
            str(data["name"]).upper(), str(data.get("title", "")), path.parent, len(data["joints"])
        )
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None  # `load_robot` reports the mistakes of a robot that isn't listed
