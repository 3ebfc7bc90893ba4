"""Processes of this user on this computer that control a robot, and the paths of their sockets."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from pathlib import Path

from yarclang.runtime.transports.lock import Holder, holder_of, own_holders
from yarclang.runtime.transports.private import MASTERS, ControlError, answers, check_private, folder

_NAME = re.compile(r"(?P<robot>.+)-(?P<pid>[0-9]{1,10})")


@dataclass(frozen=True, slots=True)
class Run:
    """A run on this computer: its `name`, such as `industrial6-4711`; its robot and process number; and the
    path of its control socket.
    """

    name: str
    robot: str
    pid: int
    path: Path


def find_runs() -> tuple[Run, ...]:
    """Return the runs of this user whose processes are alive, in the order of their names.

    They are searched for in our own folder of sockets. Runs that were started with another XDG_RUNTIME_DIR or
    TMPDIR have other folders, which are searched as well: each run reports its folder to processes that ask
    for its controller's lock.

    Raises:
        ControlError: our own folder can't be trusted.
    """
    place = folder()
    remove_stale(place)
    return _alive({place, *(path for one in own_holders() if (path := _folder_of(one)) is not None)})


def the_run(name: str | None = None) -> Run:
    """Return the only run, or the run that `name` selects by its full name, its robot, or its process number.

    Raises:
        ControlError: there is no such run, or several.
    """
    runs = find_runs()
    if not runs:
        raise ControlError(
            "no yarc run on this computer", "address a controller itself with --to tcp://HOST:PORT"
        )
    fitting = [
        run for run in runs if name is None or name.lower() in (run.name.lower(), run.robot, str(run.pid))
    ]
    if len(fitting) == 1:
        return fitting[0]
    names = ", ".join(run.name for run in fitting or runs)
    if not fitting:
        raise ControlError(f"there is no run {name!r}", f"there is {names}")
    raise ControlError(f"there are several runs: {names}", "choose one with --run NAME")


def run_on(host: str, port: int) -> Run | None:
    """Return the run of this user that drives a controller; None if there is none.

    Raises:
        ControlError: our own folder can't be trusted.
    """
    holder = holder_of(host, port)
    if holder is None or holder.peer is None or not holder.is_ours:
        return None
    places = {path for path in (folder(), _folder_of(holder)) if path is not None}
    return next((run for run in _alive(places) if run.pid == holder.peer.pid), None)


def _alive(places: set[Path]) -> tuple[Run, ...]:
    """Return the runs whose sockets are in these folders and that are alive."""
    found = {run.name: run for place in places for run in _runs_in(place) if answers(run.path)}
    return tuple(found[name] for name in sorted(found))


def _folder_of(holder: Holder) -> Path | None:
    """Return the folder of a run's socket, if only our user may enter it."""
    if holder.folder is None:
        return None
    try:
        check_private(holder.folder)
    except ControlError:
        return None
    return holder.folder


def _runs_in(place: Path) -> list[Run]:
    """Return a run for each socket in a folder, even if its process is dead."""
    named = [(path, _NAME.fullmatch(path.stem)) for path in sorted(place.glob("*.sock"))]
    return [Run(path.stem, name["robot"], int(name["pid"]), path) for path, name in named if name]


def remove_stale(place: Path) -> None:
    """Remove the sockets of dead processes, including the sockets for masters."""
    for path in (*place.glob("*.sock"), *place.glob(f"*{MASTERS}")):
        named = _NAME.fullmatch(path.stem)
        try:
            if named is not None:
                os.kill(int(named["pid"]), 0)
        except (ProcessLookupError, OverflowError):
            path.unlink(missing_ok=True)
        except PermissionError:
            pass
