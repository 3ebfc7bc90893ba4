"""Immutable value classes, equivalent to `dataclass(frozen=True, slots=True)` but created in a tenth of the
time.

The compiler creates about 350 such classes at each start. `dataclass` compiles six methods for each class,
which took a fifth of the start. Here all classes share five methods, and `__init__` is compiled when the
first object is created.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import MISSING, Field, FrozenInstanceError, dataclass, field, fields
from operator import attrgetter
from typing import Any, TypeVar, dataclass_transform, overload

T = TypeVar("T")

_set = object.__setattr__


@overload
@dataclass_transform(frozen_default=True, field_specifiers=(field,))
def frozen(cls: type[T], /) -> type[T]: ...


@overload
@dataclass_transform(frozen_default=True, field_specifiers=(field,))
def frozen(*, eq: bool = True) -> Callable[[type[T]], type[T]]: ...


def frozen(cls: type[T] | None = None, /, *, eq: bool = True) -> Any:
    """Convert a class with annotations to an immutable value class.

    The class is a dataclass for `dataclasses.fields`, `replace`, `asdict` and pattern matching. Methods that
    the class defines itself are kept.

    Args:
        cls: the class.
        eq: True if values are compared and hashed by their fields; otherwise each object equals only itself.
    """
    if cls is None:
        return lambda decorated: _made(decorated, eq=eq)
    return _made(cls, eq=eq)


def _made(cls: type[Any], *, eq: bool) -> type[Any]:
    own = frozenset(name for name, content in cls.__dict__.items() if content is not None)
    made: Any = dataclass(init=False, repr=False, eq=False, slots=True)(cls)
    if "__init__" not in own:
        made.__init__ = _first_init(made)
    if "__repr__" not in own:
        made.__repr__ = _repr
    if eq:
        key = _key(tuple(one.name for one in fields(made) if one.compare))
        if "__eq__" not in own:
            made.__eq__ = _equality(key)
        if "__hash__" not in own:
            made.__hash__ = _hash_of(key)
    made.__setattr__ = _refuse_to_set
    made.__delattr__ = _refuse_to_delete
    made.__getstate__ = _state
    made.__setstate__ = _set_state
    return made  # type: ignore[no-any-return]


def _first_init(cls: Any) -> Callable[..., None]:
    """Return an `__init__` that compiles the final `__init__`, replaces itself by it, and calls it."""

    def __init__(self: Any, *args: Any, **named: Any) -> None:  # noqa: N807
        cls.__init__ = _init(cls)
        cls.__init__(self, *args, **named)

    return __init__


def _init(cls: Any) -> Callable[..., None]:
    """Compile the `__init__` of a class: a parameter for each field, and a call of `__post_init__`."""
    known: dict[str, Any] = {"_made_anew": _MADE_ANEW}
    parameters, lines = ["self"], []
    for one in fields(cls):
        name, given = one.name, one.name
        default = _default(one)
        if default is MISSING:
            parameters.append(name)
        else:
            known[f"_default_{name}"] = default
            parameters.append(f"{name}=_default_{name}")
            if default is _MADE_ANEW:
                known[f"_make_{name}"] = one.default_factory
                given = f"_make_{name}() if {name} is _made_anew else {name}"
        known[f"_set_{name}"] = getattr(cls, name).__set__  # quicker than setting by name
        lines.append(f"    _set_{name}(self, {given})")
    if hasattr(cls, "__post_init__"):
        lines.append("    self.__post_init__()")
    text = f"def __init__({', '.join(parameters)}):\n" + ("\n".join(lines) or "    pass")
    exec(text, known)
    made: Callable[..., None] = known["__init__"]
    made.__qualname__ = f"{cls.__qualname__}.__init__"
    return made


_MADE_ANEW = object()
"""Represents a default value that is created anew for each object."""


def _default(one: Field[Any]) -> object:
    return one.default if one.default_factory is MISSING else _MADE_ANEW


def _key(names: tuple[str, ...]) -> Callable[[Any], Any]:
    """Return a function that returns the given fields of an object as a tuple, for comparison."""
    if not names:
        return lambda _: ()
    return attrgetter(*names, names[0]) if len(names) == 1 else attrgetter(*names)


def _equality(key: Callable[[Any], Any]) -> Callable[[Any, object], Any]:
    def __eq__(self: Any, other: object) -> Any:  # noqa: N807
        return key(self) == key(other) if other.__class__ is self.__class__ else NotImplemented

    return __eq__


def _hash_of(key: Callable[[Any], Any]) -> Callable[[Any], int]:
    def __hash__(self: Any) -> int:  # noqa: N807
        return hash(key(self))

    return __hash__


def _repr(self: Any) -> str:
    shown = ", ".join(f"{one.name}={getattr(self, one.name)!r}" for one in fields(self) if one.repr)
    return f"{type(self).__qualname__}({shown})"


def _refuse_to_set(self: Any, name: str, _: object) -> None:
    raise FrozenInstanceError(f"cannot assign to field {name!r} of {type(self).__name__}")


def _refuse_to_delete(self: Any, name: str) -> None:
    raise FrozenInstanceError(f"cannot delete field {name!r} of {type(self).__name__}")


def _state(self: Any) -> list[Any]:
    """Return the state of an object for pickle and copy."""
    return [getattr(self, one.name) for one in fields(self)]


def _set_state(self: Any, state: list[Any]) -> None:
    for one, content in zip(fields(self), state, strict=True):
        _set(self, one.name, content)
