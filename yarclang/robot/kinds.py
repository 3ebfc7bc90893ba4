"""Find all kinds of controllers: the packages `yarclang/backend_*`, and entry points of other packages."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules

from yarclang.named import by_name
from yarclang.robot.controller import Kind, SignalVariable

DEFAULT = "turbo-pmac"
"""Kind of controller for a robot.toml that doesn't name a kind."""

GROUP = "yarclang.backends"
"""Group of the entry points by which other packages add kinds of controllers. The name of an entry point is
that of the kind; its value is the module that defines `KIND` and `BACKEND`.
"""

_plugged: dict[str, str] = {}


def kind_of(name: str) -> Kind | None:
    """Return the kind of controller with a name, or None if there is none."""
    if name in _plugged:
        return _loaded(_plugged[name])
    if name in _included():
        return _included()[name]
    module = _elsewhere().get(name)
    return None if module is None else _loaded(module)


def known_signal(text: str) -> SignalVariable:
    """Return the controller variable that `text` names, in upper case, as an input or output.

    All kinds of controllers are tried, since the robot isn't known.
    """
    found = [kind.signal(text) for name in kind_names() if (kind := kind_of(name)) is not None]
    return next((one for one in found if one.name is not None), found[0])


def title_of(name: str) -> str:
    """Return the name of a kind of controller for people, with its article, or `name` if there is no such
    kind.
    """
    kind = kind_of(name)
    return name if kind is None else kind.title


def kind_names() -> tuple[str, ...]:
    """Return the names of all kinds in alphabetical order."""
    return tuple(sorted({*_included(), *_elsewhere(), *_plugged}))


def module_of(name: str) -> str:
    """Return the name of the module that defines the `BACKEND` of a kind of controller.

    Raises:
        KeyError: there is no such kind.
    """
    if name in _plugged:
        return _plugged[name]
    for package in _packages():
        if import_module(f"{package}.kind").KIND.name == name:
            return f"{package}.backend"
    return _elsewhere()[name]


@contextmanager
def plugged(name: str, module: str) -> Iterator[None]:
    """Register another kind of controller for the duration of the context.

    Args:
        name: the kind's name.
        module: the name of the module that defines its `KIND` and its `BACKEND`.
    """
    _plugged[name] = module
    try:
        yield
    finally:
        del _plugged[name]


@cache
def _packages() -> tuple[str, ...]:
    return tuple(
        sorted(
            f"yarclang.{one.name}"
            for one in iter_modules([str(Path(__file__).parents[1])])
            if one.ispkg and one.name.startswith("backend_")
        )
    )


@cache
def _included() -> dict[str, Kind]:
    kinds = [(package, _loaded(f"{package}.kind")) for package in _packages()]
    return by_name("kind of controller", [(kind.name, package, kind) for package, kind in kinds])


@cache
def _elsewhere() -> dict[str, str]:
    from importlib.metadata import entry_points

    return {one.name: one.value for one in entry_points(group=GROUP)}


def _loaded(module: str) -> Kind:
    kind: Kind = import_module(module).KIND
    return kind
