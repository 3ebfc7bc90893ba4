"""Tests of `frozen`: it makes the same classes as `dataclass(frozen=True, slots=True)`."""

from __future__ import annotations

import copy
import pickle
from dataclasses import FrozenInstanceError, asdict, dataclass, field, fields, is_dataclass, replace

import pytest

from yarclang.frozen import frozen


@frozen
class Point:
    """A point."""

    x: float
    y: float = 0.0
    tags: list[str] = field(default_factory=list, compare=False, repr=False)

    @property
    def sum(self) -> float:
        return self.x + self.y


@frozen
class One:
    """A value with one field."""

    x: object


@frozen
class Nothing:
    """A value without fields."""


@frozen(eq=False)
class Thing:
    """An object that equals only itself."""

    name: str


@frozen
class Spot(Point):
    """A named point that checks its values and has its own `repr`."""

    name: str = ""

    def __post_init__(self) -> None:
        if self.x < 0:
            raise ValueError("negative")

    def __repr__(self) -> str:
        return f"<{self.name}>"


def as_dataclass(cls):
    """Return the same class, made by `dataclass`."""
    names = {name: content for name, content in cls.__dict__.items() if name in ("__doc__", "__module__")}
    names |= {"__annotations__": dict(cls.__annotations__), "__qualname__": cls.__qualname__}
    for one in fields(cls):
        again = field(default_factory=list, compare=one.compare, repr=one.repr)
        if one.name in cls.__annotations__:
            names |= {one.name: again if one.default_factory is list else one.default}
    names = {
        name: content for name, content in names.items() if repr(content) != repr(fields(One)[0].default)
    }
    return dataclass(frozen=True, slots=True)(type(cls.__name__, (), names))


@pytest.mark.parametrize("cls", [Point, One, Nothing])
def test_it_is_told_compared_and_hashed_as_a_dataclass(cls):
    other = as_dataclass(cls)
    values = (1.5, 2.0)[: len([one for one in fields(cls) if one.name != "tags"])]
    ours, theirs = cls(*values), other(*values)
    assert repr(ours) == repr(theirs)
    assert ours == cls(*values)
    assert hash(ours) == hash(cls(*values))
    assert ours != theirs
    assert ours.__eq__(theirs) is NotImplemented
    assert cls.__slots__ == other.__slots__
    assert cls.__match_args__ == other.__match_args__
    assert not hasattr(ours, "__dict__")
    assert is_dataclass(ours)


def test_the_first_and_every_other_object_takes_the_same_arguments():
    for _ in range(2):
        assert (Point(1.0).y, Point(1.0, 2.0).sum, Point(y=1.0, x=2.0).x) == (0.0, 3.0, 2.0)
        for wrong in ((), (1.0, 2.0, [], 4.0)):
            with pytest.raises(TypeError, match=r"__init__\(\)"):
                Point(*wrong)
        with pytest.raises(TypeError, match="z"):
            Point(1.0, z=2.0)
    assert Point(1.0).tags is not Point(1.0).tags


def test_nothing_of_it_can_be_changed():
    point = Point(1.0)
    for name in ("x", "sum", "z"):
        with pytest.raises(FrozenInstanceError):
            setattr(point, name, 2.0)
        with pytest.raises(FrozenInstanceError):
            delattr(point, name)
    assert point.x == 1.0


def test_fields_that_are_not_compared_do_not_count():
    assert Point(1.0, tags=["a"]) == Point(1.0, tags=["b"])
    assert hash(Point(1.0, tags=["a"])) == hash(Point(1.0))
    assert "tags" not in repr(Point(1.0))
    assert Point(1.0) != Point(2.0)
    assert (One(1) == One(1.0), One(None) == One(0)) == (True, False)


def test_a_thing_equals_only_itself():
    thing = Thing("a")
    assert thing != Thing("a")
    assert thing == thing  # noqa: PLR0124
    assert {thing: 1}[thing] == 1


def test_it_is_copied_replaced_and_kept():
    point = Point(1.0, tags=["a"])
    assert replace(point, y=3.0) == Point(1.0, 3.0)
    assert asdict(point) == {"x": 1.0, "y": 0.0, "tags": ["a"]}
    for again in (copy.copy(point), copy.deepcopy(point), pickle.loads(pickle.dumps(point))):
        assert (again, again.tags) == (point, ["a"])
        with pytest.raises(FrozenInstanceError):
            again.x = 2.0


def test_a_class_of_its_own_methods_and_of_a_base():
    spot = Spot(1.0, name="A")
    assert (repr(spot), spot.sum) == ("<A>", 1.0)
    assert spot != Point(1.0)
    assert [one.name for one in fields(Spot)] == ["x", "y", "tags", "name"]
    assert Spot.__slots__ == ("name",)
    for _ in range(2):
        with pytest.raises(ValueError, match="negative"):
            Spot(-1.0)
    match spot:
        case Spot(x, y, _, name):
            assert (x, y, name) == (1.0, 0.0, "A")
