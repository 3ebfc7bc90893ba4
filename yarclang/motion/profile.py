"""What a profile is: a law of motion along a path, and its form on a grid of segments."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from importlib import import_module
from pkgutil import iter_modules

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion import profiles
from yarclang.motion.limits import Bounds
from yarclang.motion.path import Path
from yarclang.named import by_name

Form = tuple[int, ...]
"""What a law leaves open on a grid, in segments: how long its ramps and its blends are. Each law has its own."""

NO_FORM = np.zeros((1, 0), dtype=np.int64)
"""The forms of a law that leaves nothing open: one, and empty."""


@frozen
class Law:
    """A law of motion along one path.

    `pure` maps time as a share u (N,) of the duration to the share s (N,) of the way.
    `control` (n segments, form) gives the control values (n + 3,) of s on a grid: three zeros first, three ones last.
    `forms` (n) are the forms (K, f) that n segments leave room for, the one that is nearest to the pure law
    first. `strain` (n, forms (K, f)) tells the peaks (K, 3) of velocity, acceleration and jerk over
    distance in units of segments, to compare forms. `scaled` (n, form, n') is the form for n' segments that is most like one for n.
    `shortest` [s] is the duration for which the limits shape the law; None if its shape doesn't depend on them.
    """

    pure: Callable[[Array], Array]
    control: Callable[[int, Form], Array]
    forms: Callable[[int], NDArray[np.int64]]
    strain: Callable[[int, NDArray[np.int64]], Array]
    scaled: Callable[[int, Form, int], Form] = lambda had, form, gets: form  # noqa: ARG005
    shortest: float | None = None


@frozen
class NoLaw:
    """The place `s` of a path, from 0 to 1, at which the search for a law gives up."""

    s: float


def _without_law(path: Path, bounds: Bounds) -> Law | NoLaw:  # noqa: ARG001
    """Refuse to make a law: a timetable says itself where the joints are at which time."""
    raise TypeError("a timetable has no law")


@frozen
class Profile:
    """A law of motion for every path.

    `law` makes the one for a path and the limits that it shall keep; NoLaw if none is found. `is_stretched` says that the shortest time decides the
    form, and a longer one stretches it. `has_jerk_limit` is False for a law whose acceleration may jump. `has_cruise` says
    that most of the way goes at one speed, which can be asked for. `needs_search` is False for a law that is found along any path. `longest_segment` [s]
    is the longest segment that does the law justice where time is what counts.
    """

    name: str
    summary: str
    law: Callable[[Path, Bounds], Law | NoLaw]
    is_stretched: bool = False
    has_jerk_limit: bool = True
    has_cruise: bool = False
    needs_search: bool = False
    longest_segment: float = math.inf


def profile_names() -> tuple[str, ...]:
    """Return the names of all profiles: each file of motion/profiles is one. Imports none of them.

    Raises:
        NamedTwice: two files have one name in upper case.
    """
    names = ((module.name.upper(), module.name, None) for module in iter_modules(profiles.__path__))
    return tuple(sorted(by_name("profile", names)))


FOR_SHORT = "SCURVE"
"""The profile of a way that is too short to reach its speed: its ramps are as long as the limits want."""

TIMETABLE = Profile("", "as the timetable says", _without_law, has_jerk_limit=False)
"""The profile of a motion along a timetable."""


def profiles_with(fits: Callable[[Profile], bool]) -> str:
    """Return the suffixes of all profiles that are fit for something, as messages list them."""
    *first, last = [f"_{name}" for name in profile_names() if fits(load_profile(name))]
    return f"{', '.join(first)} or {last}" if first else last


@cache
def load_profile(name: str) -> Profile:
    """Return the profile of a name in upper case; `TIMETABLE` for the empty name.

    Raises:
        ValueError: the profile calls itself otherwise than its file.
    """
    if not name:
        return TIMETABLE
    loaded: Profile = import_module(f"{profiles.__name__}.{name.lower()}").PROFILE
    if loaded.name != name:
        raise ValueError(f"the profile of {name.lower()}.py calls itself {loaded.name}")
    return loaded
