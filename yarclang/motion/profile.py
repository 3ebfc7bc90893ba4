"""What a profile is: a law of motion along a path, and its form on a grid of segments."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from yarclang.hir import Array
from yarclang.motion import profiles


@dataclass(frozen=True, slots=True)
class Profile:
    """A law of motion.

    `law` maps time as a share u (N,) of the duration to the share s (N,) of the way.
    `control` (n segments, ramp of m segments) gives the control values (n + 3,) of s on a grid: three zeros
    first, three ones last. `longest_ramp` (n) is the longest ramp that n segments leave room for, at least 1; a
    law that needs no ramps has 1. `strain` (n, m) says how the peaks of velocity, acceleration and jerk
    over distance in units of segments grow with the ramp, to compare ramps.
    """

    name: str
    summary: str
    law: Callable[[Array], Array]
    control: Callable[[int, int], Array]
    longest_ramp: Callable[[int], int]
    strain: Callable[[int, int], tuple[float, float, float]]


def profile_names() -> tuple[str, ...]:
    """The names of all profiles: each file of motion/profiles is one. Imports none of them."""
    return tuple(sorted(module.name.upper() for module in iter_modules(profiles.__path__)))


@cache
def load_profile(name: str) -> Profile:
    """The profile of a name in upper case."""
    loaded: Profile = import_module(f"{profiles.__name__}.{name.lower()}").PROFILE
    return loaded
