"""Reader of the settings text that yarc prints, and of no other text.

Every line must have the one form that is allowed in its place. Comments (after `;`) and empty lines are
allowed anywhere: they are removed before a line is sent.
"""

from __future__ import annotations

import re
from fractions import Fraction
from typing import NoReturn

from yarclang.certify.pmac.settings.text import Definition, Listing, Number, Pointer, Setting, SettingsText
from yarclang.certify.read.lines import Refusal, shown
from yarclang.certify.read.text import Unreadable
from yarclang.pmac.controller import TurboPmac, turbo_pmac
from yarclang.pmac.requests import MOST_LINE
from yarclang.pmac.variables import (
    ARMED,
    ECHO,
    FEEDBACK_PLC,
    GUARD_PLC,
    HEARTBEAT,
    ROTARY_FULL,
    WATCHED,
    actual_position,
    commanded_position,
    motor_variable,
    rotary_full,
    system_variable,
)
from yarclang.robot.model import Robot

MOTOR_VARIABLES = (8, 13, 14, 15, 16, 17, 19, 20, 21, 22, 90)
"""The Ixx that the text must set for each motor, in this order."""

_ODD = re.compile(r"[^\x20-\x7E\n]")
_TITLE = re.compile(r"; settings of a Turbo PMAC for (\S+):(?: .*)?")
_ROBOT = re.compile(r"; robot (\S*)")
_HEADER = re.compile(r"; *(settings of|robot)\b")
_VALUE = r"[0-9]{1,15}(?:\.[0-9]{1,30})?"
_TERM = re.compile(rf"([-+]?)({_VALUE})([A-Z]?)")
_SETTING = re.compile(rf"(I[0-9]{{1,4}})=(-?{_VALUE})")
_ASSIGNMENT = re.compile(r"P[0-9]{1,4}=\S+")


def read_settings(text: str, robot: Robot) -> SettingsText | Unreadable:
    """Read a whole settings text.

    Args:
        text: a text that yarc has printed, and that may have been saved or edited.
        robot: the robot that the text must be for, with the motors, axes and coordinate system that it must
            name.

    Returns:
        The content, or the first line that differs from what yarc prints.
    """
    if found := _ODD.search(text):
        line = text.count("\n", 0, found.start()) + 1
        name = f"the character 0x{ord(found[0]):02X}" + " (a carriage return)" * (found[0] == "\r")
        return Unreadable(line, f"has {name}; only printable ASCII and line feeds are allowed", "Y1170")
    if not text.endswith("\n"):
        return Unreadable(
            text.count("\n") + 1, "doesn't end with a line feed: the text is cut short", "Y1170"
        )
    try:
        return _read(_Lines(text), robot)
    except Refusal as refusal:
        return Unreadable(*refusal.args)


def _read(lines: _Lines, robot: Robot) -> SettingsText:
    controller = turbo_pmac(robot)
    name = lines.header(_TITLE, "; settings of a Turbo PMAC for ...")
    if lines.header(_ROBOT, "; robot ...") != robot.fingerprint or name != robot.name:
        then = " as it was then" * (name == robot.name)
        lines.refuse(
            f"says that the settings are for {shown(name)}{then}, not for {robot.name} as it is now", "Y1171"
        )
    lines.expect("CLOSE ALL", f"&{controller.coordinate_system}")
    definitions = tuple(_definition(lines, motor, controller) for motor in controller.motors)
    pointers = tuple(_pointers(lines, controller))
    settings = {name: _setting(lines, name) for name in _names(controller)}
    feedback = _feedback(lines, len(controller.feedback))
    lines.expect(f"{ARMED}=0", f"{WATCHED}=0", code="Y1175")
    guard = _guard(lines, controller.coordinate_system)
    settings["I5"] = _setting(lines, "I5")
    lines.expect(f"ENABLE PLC {FEEDBACK_PLC}", f"ENABLE PLC {GUARD_PLC}", code="Y1175")
    lines.end()
    return SettingsText(definitions, pointers, settings, feedback, guard)


def _definition(lines: _Lines, motor: int, controller: TurboPmac) -> Definition:
    wanted = f"#{motor}->"
    content = lines.take(wanted)
    if not content.startswith(wanted):
        lines.misplaced(wanted)
    counts: dict[str, Number] = {}
    offset: Number | None = None
    place = begin = len(wanted)
    while place < len(content) or place == begin:
        term = _TERM.match(content, place)
        if term is None or (place > begin and not term[1]) or offset:
            lines.refuse(f"has {shown(content[place:])}; expected: a term with an axis")
        sign, value, axis = term.groups()
        if not axis and counts:
            offset = _number(sign, value)
        elif axis not in controller.axes or axis in counts:
            lines.refuse(f"has the term {term[0]}, and may name each of {' '.join(controller.axes)} once")
        else:
            counts[axis] = _number(sign, value)
        place = term.end()
    offset = offset or Number(Fraction(0), Fraction(0))
    return Definition(lines.last, motor, content[begin:], counts, offset)


def _number(sign: str, text: str) -> Number:
    return Number(Fraction(sign.replace("+", "") + text), Fraction(1, 10 ** len(text.partition(".")[2])))


def _pointers(lines: _Lines, controller: TurboPmac) -> list[Pointer]:
    pointers = []
    for motor in controller.motors:
        for variable, address in (commanded_position(motor), actual_position(motor)):
            lines.expect(f"{variable}->{address}", code="Y1173")
            pointers.append(Pointer(lines.last, variable, address))
    variable, address = rotary_full(controller.coordinate_system)
    lines.expect(f"{variable}->{address}", code="Y1175")
    return [*pointers, Pointer(lines.last, variable, address)]


def _names(controller: TurboPmac) -> list[str]:
    """Return the I-variables that the text must set, in order, except I5."""
    system = controller.coordinate_system
    return [
        *(motor_variable(motor, number) for motor in controller.motors for number in MOTOR_VARIABLES),
        *("I10", "I8", "I42", "I16", "I17"),
        *(system_variable(system, number) for number in (13, 50, 94, 95)),
    ]


def _setting(lines: _Lines, name: str) -> Setting:
    content = lines.take(f"{name}=")
    found = _SETTING.fullmatch(content)
    if found is None or found[1] != name:
        lines.misplaced(f"{name}=")
    return Setting(lines.last, name, found[2], Fraction(found[2]), lines.remark)


def _feedback(lines: _Lines, size: int) -> Listing:
    lines.expect(f"OPEN PLC {FEEDBACK_PLC} CLEAR")
    statements, places = [], []
    for _ in range(size):
        content = lines.take("a feedback variable, P and its number,")
        if _ASSIGNMENT.fullmatch(content) is None:
            lines.misplaced("a feedback variable, P and its number,")
        statements.append(content)
        places.append(lines.last)
    lines.expect(f"{ECHO}={HEARTBEAT}", code="Y1175")
    statements.append(f"{ECHO}={HEARTBEAT}")
    places.append(lines.last)
    lines.expect("CLOSE")
    return Listing(FEEDBACK_PLC, tuple(statements), tuple(places))


def _guard(lines: _Lines, system: int) -> Listing:
    """Read the guard PLC, which counts its scans as a heartbeat and can stop the motion by a hold.

    The PLC commands a hold in two cases, once each. In the first case, the guard is armed, and the controller
    no longer reports the rotary buffer as full. In the second case, the streaming computer is watched, and
    its timer (Isx12) has run down.
    """
    lines.expect(f"OPEN PLC {GUARD_PLC} CLEAR", code="Y1175")
    hold = f'CMD"&{system}H"'
    statements = (
        f"{HEARTBEAT}={HEARTBEAT}+1",
        f"IF({ARMED}=1)",
        f"IF({ROTARY_FULL}=0)",
        f"{ARMED}=2",
        hold,
        "ENDIF",
        "ENDIF",
        f"IF({WATCHED}=1)",
        f"IF(I{5012 + 100 * system}<0)",
        f"{WATCHED}=2",
        hold,
        "ENDIF",
        "ENDIF",
    )
    places = []
    for statement in statements:
        lines.expect(statement, code="Y1175")
        places.append(lines.last)
    lines.expect("CLOSE", code="Y1175")
    return Listing(GUARD_PLC, statements, tuple(places))


class _Lines:
    """A position in the settings text, from which lines are read without their comments.

    Attributes:
        last: number of the last line returned, from 1.
        remark: the comment of this line.
    """

    def __init__(self, text: str) -> None:
        self._lines = text.split("\n")[:-1]
        self._taken = ""
        self._place = 0
        self.last = 0
        self.remark = ""

    def header(self, shape: re.Pattern[str], wanted: str) -> str:
        """Read a line of the header, which must be the very next line, and return its first group."""
        content = self._lines[self._place] if self._place < len(self._lines) else ""
        found = shape.fullmatch(content)
        self._place += 1
        self.last, self._taken = self._place, content
        if found is None:
            self.misplaced(wanted)
        return found[1]

    def take(self, wanted: str) -> str:
        """Return the next line with content; `wanted` describes the expected line."""
        if not self._go_on():
            self.last = len(self._lines)
            self.refuse(f"is the last one; expected after it: {shown(wanted)}")
        return self._taken

    def expect(self, *wanted: str, code: str = "Y1170") -> None:
        """Read lines that must equal the given ones; `code` is the finding if they do not."""
        for line in wanted:
            if not self._go_on():
                self.last = len(self._lines)
                self.refuse(f"is the last one; expected after it: {shown(line)}", code)
            if self._taken != line:
                self.misplaced(line, code)

    def end(self) -> None:
        """Check that no content is left."""
        if self._go_on():
            self.refuse(f"is {shown(self._taken)}, after the end of the settings")

    def misplaced(self, wanted: str, code: str = "Y1170") -> NoReturn:
        """Refuse the last line that was read, since another line is expected in its place."""
        self.refuse(f"is {shown(self._taken)}; expected: {shown(wanted)}", code)

    def refuse(self, reason: str, code: str = "Y1170") -> NoReturn:
        """End the reading.

        Raises:
            Refusal: always, for the last line.
        """
        raise Refusal(self.last, reason, code)

    def _go_on(self) -> bool:
        """Move to the next line with content, without its comment; return False at the end."""
        while self._place < len(self._lines):
            line = self._lines[self._place]
            self._place += 1
            self.last = self._place
            if _HEADER.match(line):
                self.refuse(f"is a line of the header after the header: {shown(line)}")
            content, _, remark = line.partition(";")
            if taken := content.rstrip(" "):
                if len(taken) > MOST_LINE:
                    self.refuse(f"has {len(taken)} characters, and the controller takes {MOST_LINE}")
                self._taken, self.remark = taken, remark.strip(" ")
                return True
        return False
