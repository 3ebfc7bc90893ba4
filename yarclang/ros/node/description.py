"""A program that writes the robot's URDF, for launch files that need it before the nodes start:

    PYTHONPATH=lib /usr/bin/python3 -m yarclang.ros.node.description [ROBOT]

The URDF is written to standard output. The program waits up to a minute until the robot is served.
"""

from __future__ import annotations

import sys
import time
from typing import Any, Dict

from yarclang.client import Gone, Refused, Robot

PATIENCE = 60.0
"""Longest wait for a robot that isn't served yet [s]."""


def described(robot: str | None, patience: float = PATIENCE) -> Dict[str, Any]:
    """Return the description of a robot: the reply of its process to the order `model`.

    Args:
        robot: path of a socket, or name of a process or of its robot, as for `yarclang.client.Robot`; None or
            empty for the only one.
        patience: longest wait until the robot is served [s].

    Raises:
        ValueError: the robot isn't served, doesn't reply, or can't be described; the text names the remedy.
    """
    ends = time.monotonic() + patience
    told = False
    while True:
        try:
            with Robot(robot or None, name="description") as served:
                return served.ask("model")
        except (Gone, OSError) as error:
            if time.monotonic() >= ends:
                raise ValueError(f"{error}. Start it as the same user: yarc serve --robot NAME") from None
            if not told:
                sys.stderr.write(f"{error}; waiting for it\n")
            told = True
        except Refused as error:
            raise ValueError(f"{error}{error.help and '. ' + error.help}") from None
        time.sleep(min(0.5, patience))


def main() -> int:
    """Write the URDF of the robot named on the command line to standard output. Return the exit status."""
    if {"-h", "--help"} & set(sys.argv[1:]) or len(sys.argv) > 2:
        sys.stdout.write(__doc__ or "")
        return 0 if len(sys.argv) == 2 else 2
    try:
        model = described(sys.argv[1] if len(sys.argv) > 1 else None)
    except ValueError as error:
        sys.stderr.write(f"{error}\n")
        return 1
    except KeyboardInterrupt:
        return 130
    sys.stdout.buffer.write(model["urdf"].encode())
    return 0


if __name__ == "__main__":
    sys.exit(main())
