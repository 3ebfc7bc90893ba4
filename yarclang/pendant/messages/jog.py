"""Messages of a page while a button is held."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from yarclang.coordinator.messages.message import Message, Number
from yarclang.pendant.messages.people import Name


class Step(Message):
    """A step. `axis` is a joint, or an axis of the frame `Press.axes`: x, y or z for a translation; a, b or c
    for a rotation about x, y or z. `by` is the length of the step [mm or deg].
    """

    axis: Name
    by: Annotated[float, Field(ge=-100.0, le=100.0)]


class Press(Message):
    """The requested motion while a button is pressed, sent 20 times a second.

    Exactly one of `velocity`, `twist`, `step`, `go` and `home` is given. `press` is a new, larger number for
    each press of a button. A press that has ended never moves the robot again.
    """

    press: Annotated[int, Field(ge=1)]
    beat: int
    velocity: dict[str, Number] | None = None
    """Velocities by the names of the joints [deg/s or mm/s]."""
    twist: Annotated[tuple[Number, ...], Field(min_length=6, max_length=6)] | None = None
    """Velocity along x, y, z [mm/s] and about x, y, z [deg/s], in the axes of `axes`."""
    step: Step | None = None
    go: Annotated[int, Field(ge=1, le=1 << 53)] | None = None
    """Number of an offer of this session. The offer is carried out while the button is pressed. After a
    release, the robot rests on its path.
    """
    home: (
        Annotated[tuple[Annotated[int, Field(ge=1, le=32)], ...], Field(min_length=1, max_length=32)] | None
    ) = None
    """Motors that search their homes one after the other while the button is pressed; a release ends the
    search. Only for service users who have entered their PIN.
    """
    axes: Name = "{B}"
    """The frame whose axes are used: a stationary one, or the moving frame itself."""
    moving: Name = "{TCP}"
    share: Annotated[float, Field(gt=0.0, le=1.0)] = 1.0
    """Share of the robot's jog speed and of the joints' velocity limits that the jog may use."""


class LetGo(Message):
    """Release of the button. The robot comes to rest on its path at once."""

    release: Annotated[int, Field(ge=1)]
    end: bool = False
    """True: an offer that rests on its path ends as well, because the user leaves the page."""


class Jogging(Message):
    """State of a press.

    `moves`: the robot moves, and if an obstacle limits the motion, `why` names it. `reached`: the step is
    complete. `ended`: the press has ended, and `why` is the reason.
    """

    press: int
    state: Literal["moves", "reached", "ended"]
    why: str
    help: str = ""
    code: str = ""
    """`pin` if the PIN must be entered first; otherwise empty."""
    lag_s: float = 0.0
