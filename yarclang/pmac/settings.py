"""The settings that a controller needs for a robot, before they are printed as text."""

from __future__ import annotations

from collections.abc import Iterator

from yarclang.frozen import frozen
from yarclang.pmac.variables import ARMED, WATCHED


@frozen
class IVariable:
    """An I-variable, its value as printed, and its purpose."""

    name: str
    value: str
    remark: str

    @property
    def line(self) -> str:
        """Return the line of the text."""
        return f"{self.name}={self.value} ; {self.remark}"


@frozen
class AxisDefinition:
    """A motor's position in counts as a sum of axes and an offset, such as `2.5X-3.0Y+100.0`."""

    motor: int
    terms: str

    @property
    def line(self) -> str:
        """Return the line of the text."""
        return f"#{self.motor}->{self.terms}"


@frozen
class MDefinition:
    """An M-variable and the register that it refers to."""

    variable: str
    address: str

    @property
    def line(self) -> str:
        """Return the line of the text."""
        return f"{self.variable}->{self.address}"


@frozen
class Plc:
    """A PLC program: its number, and the statements that a listing of it shows."""

    number: int
    listing: tuple[str, ...]

    @property
    def lines(self) -> tuple[str, ...]:
        """Return the lines of the text that load the PLC program."""
        return (f"OPEN PLC {self.number} CLEAR", *self.listing, "CLOSE")


@frozen
class ControllerSettings:
    """All settings that a controller needs for a robot.

    `robot`, `title` and `fingerprint` identify the robot; `system` is the coordinate system. `motors` are the
    I-variables of the motors, `globals` those of the coordinate system and the controller. `feedback` is the
    PLC that computes the joint positions, `guard` the PLC that holds the motion when the rotary buffer runs
    low or the streaming computer falls silent, and `plcs` (I5) enables both.
    """

    robot: str
    title: str
    fingerprint: str
    system: int
    axes: tuple[AxisDefinition, ...]
    registers: tuple[MDefinition, ...]
    motors: tuple[IVariable, ...]
    globals: tuple[IVariable, ...]
    feedback: Plc
    guard: Plc
    plcs: IVariable

    @property
    def text(self) -> str:
        """Return the text to download."""
        return "".join(f"{line}\n" for line in self._lines())

    def _lines(self) -> Iterator[str]:
        yield f"; settings of a Turbo PMAC for {self.robot}: {self.title}"
        yield f"; robot {self.fingerprint}"
        yield "; download once, look at the result, then SAVE"
        yield "CLOSE ALL"
        yield from ("", "; axis definitions: counts = K J q + a0", f"&{self.system}")
        yield from (one.line for one in self.axes)
        yield from ("", "; positions of the motors, in 1/(Ixx08*32) count, and the rotary's state")
        yield from (one.line for one in self.registers)
        yield from ("", "; motors")
        yield from (one.line for one in self.motors)
        yield from ("", "; coordinate system and controller")
        yield from (one.line for one in self.globals)
        yield from ("", "; feedback: joint positions in axis units, the inverse of the same matrix")
        yield from self.feedback.lines
        yield from ("", "; guard: holds the motion when the rotary buffer runs low while a program is armed,")
        yield "; and when the computer that streams says nothing for as long as it has promised to"
        yield (
            f"; to go on after it has held ({ARMED} or {WATCHED} is 2 then): refill the buffer, "
            f"{ARMED}=1, then R"
        )
        yield f"{ARMED}=0"
        yield f"{WATCHED}=0"
        yield from self.guard.lines
        yield self.plcs.line
        yield from (f"ENABLE PLC {plc.number}" for plc in (self.feedback, self.guard))
