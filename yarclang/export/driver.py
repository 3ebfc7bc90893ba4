"""Export yarclang's ROS nodes as a package that works on a computer without yarclang.

The package consists of files of yarclang's standard library, and of the modules of the nodes from this
installation.
"""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from yarclang.export.package import Package
from yarclang.robot.library import stdlib_folder

NAME = "yarc_driver"
_PACKAGE = '''"""The part of yarclang that the ROS nodes need. Written by yarc export --driver."""
'''


def driver_package() -> Package:
    """Return the ROS package `yarc_driver`, which can be built with catkin (ROS 1) and ament (ROS 2)."""
    template = stdlib_folder() / "ros" / NAME
    found = {
        path.relative_to(template).as_posix(): path.read_bytes()
        for path in sorted(template.rglob("*"))
        if path.is_file() and path.suffix != ".pyc"
    }
    programs = frozenset(path for path in found if Path(path).parent == Path("scripts"))
    own = files("yarclang")
    for folder in ("", "ros/"):
        found[f"lib/yarclang/{folder}__init__.py"] = _PACKAGE.encode()
    found["lib/yarclang/client.py"] = own.joinpath("client.py").read_bytes()
    for module in own.joinpath("ros", "node").iterdir():
        if module.name.endswith(".py"):
            found[f"lib/yarclang/ros/node/{module.name}"] = module.read_bytes()
    return Package(NAME, dict(sorted(found.items())), programs)
