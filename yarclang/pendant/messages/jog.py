"""Messages that are sent while a button is held."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from yarclang.coordinator.messages.message import Message, Number
from yarclang.pendant.messages.people import Name


class Step(Message):
    """A step of a fixed length: a joint's name, or x, y, z, a, b, c of `axes`, and the length [mm or deg]."""

    axis: Name
    by: Annotated[float, Field(ge=-100.0, le=100.0)]


class Press(Message):
    """The wanted motion as long as a button is pressed, sent 20 times a second.

    One of `velocity`, `twist`, `step`, `go` and `home` is given. `press` is a new, larger number each time
    something is pressed; one that has ended never moves the robot again.
    """

    press: Annotated[int, Field(ge=1)]
    beat: int
    velocity: dict[str, Number] | None = None
    """Joints and how fast they move [deg/s or mm/s]."""
    twist: Annotated[tuple[Number, ...], Field(min_length=6, max_length=6)] | None = None
    """Along x, y, z [mm/s] and about them [deg/s], in the axes of `axes`."""
    step: Step | None = None
    go: Annotated[int, Field(ge=1, le=1 << 53)] | None = None
    """The number of an offer of this session: it is carried out while this is pressed, and rests on its path
    in between.
    """
    home: (
        Annotated[tuple[Annotated[int, Field(ge=1, le=32)], ...], Field(min_length=1, max_length=32)] | None
    ) = None
    """Motors that search their homes, one after the other, as long as this is pressed; letting go ends it.
    For service users with their PIN.
    """
    axes: Name = "{B}"
    """The frame whose axes are meant: one that stands still, or the moving frame itself."""
    moving: Name = "{TCP}"
    share: Annotated[float, Field(gt=0.0, le=1.0)] = 1.0
    """Of the robot's jog speed, and of the joints' velocity limits."""


class LetGo(Message):
    """A pressed button was let go: the robot comes to rest on its path at once."""

    release: Annotated[int, Field(ge=1)]
    end: bool = False
    """True: an offer that rests on its path is ended as well, since its page is left."""


class Jogging(Message):
    """State of a jog: `moves`, with the obstacle to its target in `why`, or `ended`, with the reason."""

    press: int
    state: Literal["moves", "reached", "ended"]
    why: str
    help: str = ""
    code: str = ""
    """`pin`: the PIN is needed first."""
    lag_s: float = 0.0
