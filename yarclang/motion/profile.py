"""Define motion profiles: the completed share of a path over time, also on a grid of segments."""

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
"""The free parameters of a motion profile on a grid of segments: the lengths of its ramps and blends
[segments].

Which parameters there are depends on the kind of profile.
"""

NO_FORM = np.zeros((1, 0), dtype=np.int64)
"""The forms of a motion profile without free parameters: a single, empty form."""


@frozen
class Law:
    """A motion profile (law of motion) along one path.

    Attributes:
        pure: function from the share u (N,) of the duration to the share s (N,) of the path.
        control: function that returns the control values (n + 3,) of s for n segments and a form: three
            zeros first, three ones last.
        forms: function that returns the forms (K, f) that fit into n segments; the form that is most
            similar to `pure` comes first.
        strain: function that returns the peaks (K, 3) of velocity, acceleration and jerk for n segments
            and forms (K, f), by which forms are compared. The units are the length of the path and the
            duration of a segment.
        scaled: function of n, a form for n segments, and n'; it returns the most similar form for n'
            segments.
        shortest: the shortest duration [s] within the limits, if the limits determine the profile's
            shape; otherwise None.
    """

    pure: Callable[[Array], Array]
    control: Callable[[int, Form], Array]
    forms: Callable[[int], NDArray[np.int64]]
    strain: Callable[[int, NDArray[np.int64]], Array]
    scaled: Callable[[int, Form, int], Form] = lambda had, form, gets: form  # noqa: ARG005
    shortest: float | None = None


@frozen
class NoLaw:
    """The place `s` of a path, from 0 to 1, at which the search for a motion profile gives up."""

    s: float


def _without_law(path: Path, bounds: Bounds) -> Law | NoLaw:  # noqa: ARG001
    """Raise an error: a motion along a timetable has no motion profile, since the table prescribes the
    joints' positions over time.
    """
    raise TypeError("a timetable has no law")


@frozen
class Profile:
    """A kind of motion profile, which makes a law of motion for a path.

    Attributes:
        name: the name in upper case, as programs write it.
        summary: one line for lists of profiles.
        law: function that makes the law for a path and the limits to keep; it returns NoLaw if none is
            found.
        is_stretched: True if a longer motion has the form of the shortest one, stretched in time.
        has_jerk_limit: False for a law whose acceleration may jump.
        has_cruise: True if most of the path is traversed at one speed, which a command may set.
        needs_search: False if a law exists along any path.
        longest_segment: the longest segment that is used in the search for a motion's shortest duration [s].
            With longer segments, the spline would follow the law too coarsely.
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
    """Return the names of all profiles, from the file names in motion/profiles. The files aren't imported.

    Raises:
        NamedTwice: two files have one name in upper case.
    """
    names = ((module.name.upper(), module.name, None) for module in iter_modules(profiles.__path__))
    return tuple(sorted(by_name("profile", names)))


FOR_SHORT = "SCURVE"
"""The profile for a path that is too short to reach its speed. The limits alone determine its ramps."""

TIMETABLE = Profile("", "as the timetable says", _without_law, has_jerk_limit=False)
"""The profile of a motion along a timetable."""


def profiles_with(fits: Callable[[Profile], bool]) -> str:
    """Return the command suffixes of all profiles for which `fits` is True, as messages list them."""
    *first, last = [f"_{name}" for name in profile_names() if fits(load_profile(name))]
    return f"{', '.join(first)} or {last}" if first else last


@cache
def load_profile(name: str) -> Profile:
    """Return the profile with a name in upper case; `TIMETABLE` for the empty name.

    Raises:
        ValueError: the profile's name isn't that of its file.
    """
    if not name:
        return TIMETABLE
    loaded: Profile = import_module(f"{profiles.__name__}.{name.lower()}").PROFILE
    if loaded.name != name:
        raise ValueError(f"the profile of {name.lower()}.py calls itself {loaded.name}")
    return loaded
